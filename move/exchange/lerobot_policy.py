"""A policy that LeRobot trained, tried in these scenes: it runs in a process of LeRobot's own environment.

It is asked for one action a step, for all episodes at once, as in LeRobot's own evaluation; how many observations it
remembers and how many actions it plans ahead is its own affair. An episode that has ended keeps its last observation
there, so that the others keep their places.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Any, BinaryIO, Self, cast

import numpy as np
from gymnasium.spaces import Box

from move.errors import BadInput
from move.exchange.export import CAMERA, ENVIRONMENT, STATE
from move.exchange.lerobot_server import Message, read_message, write_message
from move.paths import BUILD
from move.sim.observe import KEYPOINTS, ObservationSpec
from move.sim.scene.scene import Scene

PYTHON = BUILD / "lerobot-venv" / "bin" / "python"  # made by `make test-lerobot`
SERVER = Path(__file__).with_name("lerobot_server.py")
INSIDE = (".", "pretrained_model", "checkpoints/last/pretrained_model")  # of what LeRobot's training writes
PATIENCE = 10.0  # seconds that the process has to end


class LeRobotAgent:
    """What acts in an evaluation: the policy of a checkpoint, served by `python`; to be used as a context.

    Args:
        checkpoint: the output folder of `lerobot-train`, or one of its checkpoints.
        python: a Python that has LeRobot.
        seed: of what the policy draws.

    Raises:
        BadInput: no such checkpoint or Python, inputs that the exports do not have, or whatever went wrong there.
    """

    action_steps, observation_horizon = 1, 1

    def __init__(self, checkpoint: Path, python: Path = PYTHON, seed: int = 0) -> None:
        folder = _policy_folder(checkpoint)
        if not python.exists():
            raise BadInput(f"no Python at {python}; --lerobot-python names one that has LeRobot (`make test-lerobot` "
                           f"makes {PYTHON})")
        self._said = tempfile.TemporaryFile()
        self._process = subprocess.Popen([python, "-I", SERVER, folder, str(seed)], stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, stderr=self._said)
        try:
            hello, _ = self._answer("hello")
            self.inputs = {name: tuple(shape) for name, shape in hello["inputs"].items()}
            self.action_size = hello["action_size"]
            self.observation = self._checked_inputs()
        except BaseException:
            self.close()
            raise

    def _checked_inputs(self) -> ObservationSpec:
        """What it sees of a scene."""
        unknown = set(self.inputs) - {STATE, ENVIRONMENT, CAMERA}
        _, *sides = self.inputs.get(CAMERA, (3,))
        if unknown or not self.inputs or len(set(sides)) > 1:
            shapes = ", ".join(f"{name} {shape}" for name, shape in self.inputs.items())
            raise BadInput(f"a policy that sees {shapes or 'nothing'}; allowed is one trained on `move export`")
        return ObservationSpec("rgb", sides[0]) if sides else KEYPOINTS

    def start(self, scenes: list[Scene]) -> None:
        """Begin all episodes.

        Raises:
            BadInput: a task with other actions or keypoints than the policy's.
        """
        scene = scenes[0]
        if scene.task.action_size != self.action_size:
            raise BadInput(f"a policy of {self.action_size} actions; {scene.task.name} has {scene.task.action_size}")
        space = cast(Box, scene.observation_space)
        self._seen = np.zeros((len(scenes), *space.shape), space.dtype)
        for name, values in self._named().items():
            if name != CAMERA and values.shape[1:] != self.inputs[name]:
                raise BadInput(f"a policy that sees {name} of {self.inputs[name]} numbers; {scene.task.name} has "
                               f"{values.shape[1:]}")
        self._send({"what": "reset", "task": scene.task.name})

    def _named(self) -> dict[str, np.ndarray]:
        """The newest observations of all episodes under LeRobot's names, as `move export` gives them."""
        nothing = np.zeros((len(self._seen), 2), np.float32)
        images = self.observation.kind == "rgb"
        named = {STATE: nothing, CAMERA: self._seen} if images else {STATE: self._seen, ENVIRONMENT: self._seen}
        return {name: named[name] for name in self.inputs}

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """One action for each running episode, (running, 1, action_size), clipped to [-1, 1]."""
        assert observations is not None, "it has an observation horizon of 1"
        self._seen[running] = observations[:, 0]
        self._send({"what": "act"}, self._named())
        _, arrays = self._answer("actions")
        actions, wanted = arrays.get("actions", np.empty(0)), (len(scenes), self.action_size)
        if actions.shape != wanted:
            raise BadInput(f"LeRobot: actions of shape {actions.shape} came; wanted is {wanted}")
        return np.clip(actions[running][:, None], -1, 1)

    # the process ---------------------------------------------------------------------------------------------------

    def _send(self, header: dict[str, Any], arrays: dict[str, np.ndarray] | None = None) -> None:
        try:
            write_message(cast(BinaryIO, self._process.stdin), header, arrays)
        except BrokenPipeError:
            self._answer("error")  # if it said why

    def _answer(self, what: str) -> Message:
        try:
            header, arrays = read_message(cast(BinaryIO, self._process.stdout))
        except (EOFError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise BadInput(f"LeRobot's process ended or said what was not understood: {self._last_line()}") from error
        if header.get("what") != what or what == "error":
            raise BadInput(f"LeRobot: {header.get('line', header)}")
        return header, arrays

    def _last_line(self) -> str:
        self._said.seek(0)
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        return lines[-1][:500] if lines else "it said nothing"

    def close(self) -> None:
        """End the process."""
        for stream in (self._process.stdin, self._process.stdout):
            try:
                cast(BinaryIO, stream).close()
            except BrokenPipeError:
                pass
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._said.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _policy_folder(checkpoint: Path) -> Path:
    for inside in INSIDE:
        if (checkpoint / inside / "config.json").is_file() and (checkpoint / inside / "model.safetensors").is_file():
            return (checkpoint / inside).resolve()
    raise BadInput(f"no LeRobot policy in {checkpoint}; allowed is a folder that lerobot-train wrote")
