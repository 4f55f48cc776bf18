"""A LeRobot policy in a process of its own: what the two sides say to each other, and what is refused, in one line.

The other side is a script run by this Python with a policy of a few lines; with LeRobot itself it is tried by
`make test-lerobot`.
"""

import io
import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_cli import move

from move.errors import BadInput
from move.exchange import lerobot_policy, lerobot_server
from move.exchange.lerobot_policy import LeRobotAgent
from move.exchange.lerobot_server import read_message, write_message
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation
from move.machine import gl_problem
from move.sim.tasks import get_task

PYTHON, TASK = Path(sys.executable), get_task("pick-place")
needs_gl = pytest.mark.skipif(gl_problem() is not None, reason="no GL library on this machine")
FAKE = """
import json, runpy, sys
server = runpy.run_path({server!r})
import numpy as np

class Told:
    "Answers with the number of the step and of the episode, and writes down what it is given."
    inputs, action_size = {inputs!r}, {action_size}
    def reset(self, task):
        self.steps, self.notes = 0, open({notes!r}, "w")
        self.notes.write(json.dumps(["reset", task, sys.argv[1:]]) + chr(10))
    def act(self, observations):
        self.steps += 1
        newest = observations["observation.state"]
        self.notes.write(json.dumps({{name: [list(a.shape), str(a.dtype), float(a.sum())]
                                     for name, a in observations.items()}}) + chr(10))
        self.notes.flush()
        {mischief}
        return np.array([[5.0, -0.5, self.steps / 1000, episode / 10] for episode in range(len(newest))])

server["serve"](Told(), sys.stdin.buffer, sys.stdout.buffer)
"""
NUMBERS = {"observation.state": (27,), "observation.environment_state": (27,)}
PICTURES = {"observation.state": (2,), "observation.images.camera": (3, 32, 32)}


@pytest.fixture
def told(tmp_path, monkeypatch):
    """An agent of the fake policy, and what was noted there."""
    (tmp_path / "config.json").write_text("{}")
    (tmp_path / "model.safetensors").write_text("")
    notes, agents = tmp_path / "notes", []

    def make(inputs=NUMBERS, action_size=4, mischief="pass", script=FAKE) -> LeRobotAgent:
        monkeypatch.setattr(lerobot_policy, "SERVER", tmp_path / "fake.py")
        (tmp_path / "fake.py").write_text(script.format(server=lerobot_server.__file__, inputs=inputs, notes=str(notes),
                                                        action_size=action_size, mischief=mischief))
        agents.append(LeRobotAgent(tmp_path, PYTHON, seed=7))
        return agents[-1]

    make.notes = lambda: [json.loads(line) for line in notes.read_text().splitlines()]
    yield make
    for agent in agents:
        agent.close()


def test_messages_come_back_as_they_were_sent():
    stream = io.BytesIO()
    arrays = {"a": np.arange(6, dtype=np.float32).reshape(2, 3)[:, ::2], "b": np.zeros((0, 4), np.uint8)}
    write_message(stream, {"what": "act", "é": [1]}, arrays)
    write_message(stream, {"what": "reset"})
    stream.seek(0)
    header, read = read_message(stream)
    assert header == {"what": "act", "é": [1]} and list(read) == ["a", "b"]
    assert all(np.array_equal(read[name], arrays[name]) and read[name].dtype == arrays[name].dtype for name in arrays)
    assert read_message(stream) == ({"what": "reset"}, {})
    with pytest.raises(EOFError):
        read_message(stream)


@pytest.mark.parametrize("header, error", [
    ({"arrays": {"a": ["|O", [1]]}}, ValueError), ({"arrays": {"a": ["<f4", [-1]]}}, ValueError),
    ({"arrays": {"a": ["<f4", [1000]]}}, EOFError)])
def test_what_is_no_message_is_refused(header, error):
    text = json.dumps(header).encode()
    with pytest.raises(error):
        read_message(io.BytesIO(struct.pack("<I", len(text)) + text))
    with pytest.raises(ValueError, match="a header of"):
        read_message(io.BytesIO(b"\xff\xff\xff\xff"))


def test_every_step_all_episodes_are_asked_and_the_running_ones_act(told):
    agent = told()
    rows = evaluate(agent, TASK, Evaluation(episodes=3), agent.observation, batch_size=2)
    assert [row["steps"] for row in rows] == [200, 200, 200]
    notes = told.notes()  # those of the last batch, of one episode
    assert notes[0] == ["reset", "pick-place", [str(agent._process.args[3]), "7"]] and len(notes) == 201
    assert notes[1]["observation.state"] == notes[1]["observation.environment_state"]
    assert notes[1]["observation.state"][:2] == [[1, 27], "float32"] and notes[1] != notes[-1]


def test_actions_are_those_of_the_running_episodes_and_clipped(told):
    agent = told()

    class Three:
        task, observation_space = TASK, type("Space", (), {"shape": (27,), "dtype": np.float32})

    agent.start([Three()] * 3)
    agent.act([0, 1, 2], [Three()] * 3, np.ones((3, 1, 27), np.float32))
    actions = agent.act([2, 0], [Three()] * 3, np.full((2, 1, 27), 2, np.float32))
    np.testing.assert_allclose(actions, [[[1, -0.5, 0.002, 0.2]], [[1, -0.5, 0.002, 0.0]]], rtol=1e-6)
    assert told.notes()[-1]["observation.state"][2] == 27 * (2 + 1 + 2)  # episode 1 keeps what it saw last


@needs_gl
def test_a_policy_of_pictures_sees_them_and_a_state_of_nothing(told):
    agent = told(PICTURES)
    evaluate(agent, TASK, Evaluation(episodes=1), agent.observation)
    seen = told.notes()[1]
    assert seen["observation.state"] == [[1, 2], "float32", 0.0]
    assert seen["observation.images.camera"][:2] == [[1, 32, 32, 3], "uint8"] and agent.observation.kind == "rgb"


@pytest.mark.parametrize("how, message", [
    ({"inputs": {"observation.state": (14,)}}, r"sees observation.state of \(14,\) numbers; pick-place has \(27,\)"),
    ({"inputs": {"observation.images.wrist": (3, 32, 32)}}, "a policy that sees observation.images.wrist"),
    ({"inputs": {"observation.state": (2,), "observation.images.camera": (3, 32, 48)}}, "allowed is one trained on"),
    ({"inputs": {}}, "a policy that sees nothing"),
    ({"action_size": 7}, "a policy of 7 actions; pick-place has 4"),
    ({"mischief": "return newest"}, r"actions of shape \(2, 27\) came; wanted is \(2, 4\)"),
    ({"mischief": "return newest[:, :4] * np.nan"}, "action: .* given; allowed are 4 finite numbers"),
    ({"mischief": "1 / 0"}, "ended or said what was not understood: ZeroDivisionError: division by zero"),
    ({"mischief": "print('hello', flush=True)"}, "ended or said what was not understood"),
    ({"script": "import sys; sys.exit('no such module')"}, "no such module"),
    ({"script": ""}, "it said nothing"),
])
def test_what_goes_wrong_there_is_one_clear_line_here(told, how, message):
    with pytest.raises(BadInput, match=message) as problem:
        evaluate(told(**how), TASK, Evaluation(episodes=2))
    assert "\n" not in str(problem.value)


def test_the_server_tells_why_it_cannot_load_a_policy(tmp_path):
    done = subprocess.run([sys.executable, "-I", lerobot_server.__file__, str(tmp_path), "0"], input=b"",
                          capture_output=True, timeout=60)
    header, _ = read_message(io.BytesIO(done.stdout))
    assert header == {"what": "error", "line": "ModuleNotFoundError: No module named 'lerobot'"}


def test_by_hand(told, tmp_path, capsys):
    told().close()
    code, out, _ = move(capsys, "evaluate", "--lerobot", str(tmp_path), "--lerobot-python", sys.executable,
                        "--episodes", "2", "--json")
    evaluated = json.loads(out)
    assert code == 0 and evaluated["agent"] == "lerobot" and len(evaluated["rows"]) == 2
    for arguments, message in [
        (("--lerobot", "nowhere"), "no LeRobot policy in nowhere"),
        (("--lerobot", str(tmp_path), "--lerobot-python", "nowhere"), "no Python at nowhere"),
        (("policy", "--lerobot", str(tmp_path)), "more than one given"),
        (("--agent", "random", "--lerobot", str(tmp_path)), "more than one given"),
    ]:
        code, _, err = move(capsys, "evaluate", *arguments)
        assert code == 2 and message in err and err.count("\n") == 1
