"""The tasks as data: what is moved, over which ranges, what is seen as keypoints and what counts as success.

One frozen `Task` each, no subclasses. Ranges are the authors' own (metres, radians); names are those of Meta-World's
MuJoCo models. The scene reads these entries; it holds no knowledge of any task.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from move.errors import BadInput
from move.sim.configuration import Box, SpatialConfiguration, Vector

FACTORS = {
    "object": frozenset({"object"}),
    "object+target": frozenset({"object", "target", "hand"}),
    "all": frozenset({"object", "target", "hand", "camera"}),
}
"""The settings of Table 1: which parts of the configuration are random; the others stay at the task's fixed ones.
The object's yaw, where a task has one, goes with the object; the hand's start goes with the target."""

MAX_DRAWS = 1000


class Reading(Protocol):
    """What a success condition may read of a scene."""

    def point(self, name: str) -> np.ndarray:
        """Position of a named point, shape (3,), metres."""


Success = Callable[[Reading], bool]


def near(point: str, target: str, distance: float) -> Success:
    """Success condition: `point` is at most `distance` metres from `target`."""

    def condition(scene: Reading) -> bool:
        return math.dist(scene.point(point), scene.point(target)) <= distance

    return condition


@dataclass(frozen=True)
class Mount:
    """One MuJoCo element that is written when the object or the target moves.

    `kind` is "free" (a body with a free joint), "body" (a body fixed in the world) or "site"; `offset` in metres is
    added to the position; `yaw` in radians is the stock orientation of a free body.
    """

    kind: str
    name: str
    offset: Vector = (0.0, 0.0, 0.0)
    yaw: float = 0.0


@dataclass(frozen=True)
class Grip:
    """How the phase expert grips: the point and height over the object, effort in [-1, 1], steps spent closing."""

    offset: Vector = (0.0, 0.0, 0.0)  # from the object's point, in the object's frame, metres
    height: float = 0.03  # hand above the object's point while gripping, metres
    effort: float = 1.0
    opening: float = 0.0  # gripper command while approaching
    closing_steps: int = 8


@dataclass(frozen=True)
class Task:
    """One of the paper's tasks.

    Positions in metres, angles in radians, speeds per step. `separation` is the least distance in the plane between
    object and target that a random configuration may have, `clearance` the least that the motions may lead to.
    """

    name: str
    title: str  # as in Table 2
    metaworld: str  # Meta-World's name
    object_range: Box
    target_range: Box
    hand_range: Box
    camera_range: tuple[float, float]
    object_mounts: tuple[Mount, ...]
    target_mounts: tuple[Mount, ...]
    object_point: str  # the point that experts, motions and keypoints mean by "the object"
    keypoints: tuple[str, ...]  # after fingers and hand; names as in Scene.point
    success: Success
    fixed: SpatialConfiguration  # what is not randomised stays here
    grip: Grip
    yaw_range: tuple[float, float] = (0.0, 0.0)
    separation: float = 0.15
    clearance: float = 0.12
    object_steps: int = 30  # the object moves for this many steps, unless it is grasped before
    target_steps: int = 90  # the target moves from the grasp until this step
    target_dimensions: int = 3  # 2: moves in the table's plane
    timesteps: int = 20_000  # Table 5

    def allows(self, configuration: SpatialConfiguration, distance: float) -> bool:
        """Whether object and target are at least `distance` metres apart in the plane."""
        return math.dist(configuration.object_position[:2], configuration.target_position[:2]) >= distance

    def sample(self, rng: np.random.Generator, factors: str = "all") -> SpatialConfiguration:
        """Draw a configuration: the `factors` (a key of FACTORS) are random, the rest is the task's fixed one.

        Raises:
            BadInput: unknown factors, or no allowed configuration in a thousand draws.
        """
        if factors not in FACTORS:
            raise BadInput(f"factors: {factors!r} given; allowed are {', '.join(FACTORS)}")
        free, fixed = FACTORS[factors], self.fixed
        for _ in range(MAX_DRAWS):
            drawn = SpatialConfiguration(
                object_position=self.object_range.sample(rng),
                target_position=self.target_range.sample(rng) if "target" in free else fixed.target_position,
                hand_position=self.hand_range.sample(rng) if "hand" in free else fixed.hand_position,
                camera_angle=float(rng.uniform(*self.camera_range)) if "camera" in free else fixed.camera_angle,
                object_yaw=float(rng.uniform(*self.yaw_range)),
            )
            if self.allows(drawn, self.separation):
                return drawn
        raise BadInput(f"{self.name}: no configuration has object and target {self.separation} m apart")


WIDE_HAND = Box((-0.3, 0.5, 0.2), (0.3, 0.6, 0.4))

PICK_PLACE = Task(
    name="pick-place",
    title="Pick-Place",
    metaworld="pick-place-v3",
    object_range=Box((-0.2, 0.5, 0.02), (0.1, 0.8, 0.02)),
    target_range=Box((-0.1, 0.8, 0.05), (0.1, 0.9, 0.3)),
    hand_range=WIDE_HAND,
    camera_range=(0.0, math.pi),
    object_mounts=(Mount("free", "obj"),),
    target_mounts=(Mount("site", "goal"),),
    object_point="body:obj",
    keypoints=("body:obj", "target"),
    success=near("body:obj", "target", 0.07),
    fixed=SpatialConfiguration((-0.05, 0.65, 0.02), (0.1, 0.85, 0.2), (0.0, 0.6, 0.2), math.pi / 3),
    grip=Grip(offset=(-0.005, 0.0, 0.0)),
)

TASKS = {task.name: task for task in (PICK_PLACE,)}


def get_task(name: str) -> Task:
    """The task called `name`.

    Raises:
        BadInput: an unknown name.

    >>> get_task("pick-place").title
    'Pick-Place'
    """
    if name not in TASKS:
        raise BadInput(f"task: {name!r} given; allowed are {', '.join(TASKS)}")
    return TASKS[name]
