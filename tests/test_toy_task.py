"""A task that the package does not know, added as its users would: one entry, and nothing else."""

import ast
import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from recipes import tiny
from shared import plan as any_plan

import move.sim
from move.learn.agents import Agent, Nothing
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
from move.sim.collect import collect
from move.sim.configuration import Box
from move.sim.methods import METHODS
from move.sim.scene.scene import Scene
from move.sim.tasks import TASKS
from move.sim.tasks.ranges import SIDE, WIDE_HAND, fixed
from move.sim.tasks.success import joint_beyond, near
from move.sim.tasks.task import GraspParameters, MovableBody, PushParameters, Task
from move.sim.tasks.transport import TransportState, Waypoint, read
from move.study.run import run
from move.study.spec import PolicyRun


def backwards(scene: Scene, state: TransportState) -> Waypoint:
    """A little up first, so that the block does not drag, then to the target at that height."""
    here, goal = read(scene, "body:obj"), read(scene, "target")
    if here[2] > 0.03:
        state.add("lifted")
    return Waypoint(here, (goal[0], goal[1], 0.04) if "lifted" in state else (here[0], here[1], 0.06))


TOY = Task(
    name="push-back",
    title="Push-Back",
    metaworld="push-back-v3",
    object_range=Box((-0.1, 0.75, 0.0199), (0.1, 0.85, 0.0199)),
    target_range=Box((-0.1, 0.5, 0.02), (0.1, 0.6, 0.02)),
    hand_range=WIDE_HAND,
    camera_range=SIDE,
    object_bodies=(MovableBody("free", "obj"),),
    target_bodies=(MovableBody("site", "goal"),),
    object_point="body:obj",
    keypoints=("body:obj", "target"),
    success=near("body:obj", "target", 0.07),
    fixed=fixed((0.0, 0.8, 0.0199), (0.0, 0.55, 0.02)),
    manipulation=GraspParameters(backwards),
    target_dimensions=2,
)


BUTTON = Task(  # whose joint runs from 0 to -0.06 m
    name="button-press",
    title="Button-Press",
    metaworld="button-press-v3",
    object_range=Box((-0.1, 0.8, 0.115), (0.1, 0.9, 0.115)),
    camera_range=SIDE,
    object_bodies=(MovableBody("body", "box", joint="btnbox_joint"),),
    object_point="body:button+0,-0.193,0",
    keypoints=("body:button+0,-0.193,0",),
    success=joint_beyond("btnbox_joint", -0.045),
    fixed=fixed((0.0, 0.85, 0.115)),
    manipulation=PushParameters("box", offset=(0.0, -0.05, 0.0), stroke=(0.0, 0.15, 0.0), above=0.1,
                                joint="btnbox_joint", enough=-0.07, lost=0.1),
)


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> Task:
    """The toy task, known for the duration of a test."""
    monkeypatch.setitem(TASKS, TOY.name, TOY)
    return TOY


plan = partial(any_plan, task=TOY.name, method="static", timesteps=600)


class Nearest(Agent):
    """An agent that does what was done where the keypoints were most like those it sees."""

    observation_horizon = 1

    def __init__(self, demonstrations) -> None:
        self.seen, self.done = demonstrations.observations, demonstrations.actions

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray) -> np.ndarray:
        nearest = [np.abs(self.seen - frame).sum(1).argmin() for (frame,) in observations]
        return self.done[nearest][:, None]


@pytest.mark.parametrize("expert, least", [("phase", 0.9), ("metaworld", 0.5)])
@pytest.mark.parametrize("method", ["static", "adc", "move"])
def test_every_method_and_both_experts_demonstrate_a_new_task(toy, method, expert, least):
    made, record = collect(plan(method=method, expert=expert), seed=0)
    assert made.timesteps == 600 and made.actions.shape[1] == toy.action_size
    assert record.generation_rate >= least
    moved = [start.object_position != grasp.object_position
             for start, grasp in zip(record.starts, record.grasps, strict=True)]
    assert all(moved) if method != "static" else not any(moved)


@pytest.mark.parametrize("method", ["static", "adc", "move"])
def test_every_method_demonstrates_a_task_whose_joint_opens_towards_negative_positions(monkeypatch, method):
    monkeypatch.setitem(TASKS, BUTTON.name, BUTTON)
    _, record = collect(plan(task=BUTTON.name, method=method, timesteps=400), seed=0)
    assert record.generation_rate >= 0.9
    scene = Scene(BUTTON)
    scene.reset(seed=0)
    assert not BUTTON.success(scene)


def test_an_agent_solves_a_new_task_from_keypoints(toy):
    made, record = collect(plan(), seed=1)
    whole = record.starts[:-1]  # the last demonstration is cut
    rows = evaluate(Nearest(made), toy, Evaluation(starts="own"), own=whole)
    assert len(rows) == len(whole) >= 4 and all(row["success"] for row in rows)
    assert not any(row["success"] for row in evaluate(Nothing(), toy, Evaluation(starts="own"), own=whole))


def test_a_policy_of_the_package_is_trained_and_tried_on_a_new_task(toy, tmp_path):
    training = tiny(mlp_width=16, mlp_depth=1)
    evaluation = Evaluation(episodes=2)
    spec = PolicyRun(task=toy.name, seed=0, collection=plan(method="move", timesteps=200),
                   training=training, evaluation=evaluation)
    rows = run(spec, tmp_path / "results", scratch=tmp_path / "runs").rows
    wanted = [trial.configuration.object_position[0] for trial in starts(toy, evaluation)]
    assert [row["object_x"] for row in rows] == pytest.approx(wanted)


def constants(path: Path) -> set[str]:
    """The strings of a file, docstrings excepted."""
    tree = ast.parse(path.read_text())
    documented = {
        id(node.body[0].value) for node in ast.walk(tree)
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and isinstance(node.body[0], ast.Expr)
    }
    return {node.value for node in ast.walk(tree)
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documented}


@pytest.mark.parametrize("room", ["sim", "learn", "study", "cli"])
def test_only_the_methods_name_methods(room):
    folder = Path(move.__file__).parent / room
    names = {name for name in METHODS if name != "move"}  # which is the package's name, and MOVE what is usual
    naming = {path.relative_to(folder).parts[0] for path in folder.rglob("*.py") if names & constants(path)}
    assert naming == ({"methods"} if room == "sim" else set())


def test_only_the_tasks_name_tasks():
    folder = Path(move.sim.__file__).parent
    names = "|".join(name for task in TASKS.values() for name in (task.name, task.title, task.metaworld))
    naming = {path.relative_to(folder).parts[0] for path in folder.rglob("*.py")
              if any(re.search(rf"\b({names})\b", text) for text in constants(path))}
    assert naming == {"tasks"}
