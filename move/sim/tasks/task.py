"""What a task is: what is moved, over which ranges, what is seen as keypoints, how it is done and what success means.

The scene, the motions and the experts read a `Task`; they hold no knowledge of any one task, and a task knows nothing
of them. The ten tasks of the paper are in `move.sim.tasks`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from move.choices import Place
from move.errors import BadInput, one_of
from move.sim.configuration import Box, SpatialConfiguration, Vector
from move.sim.tasks.feasibility import Reachable, anywhere
from move.sim.tasks.ranges import HALF_CIRCLE, NO_TARGET, WIDE_HAND
from move.sim.tasks.success import Success
from move.sim.tasks.transport import Transport

FACTORS = {
    "object": frozenset({"object"}),
    "object+hand": frozenset({"object", "hand"}),
    "object+target": frozenset({"object", "target", "hand"}),
    "all": frozenset({"object", "target", "hand", "camera"}),
}
"""Which parts of the configuration are random; the others stay at the task's fixed ones. Table 1 has all but the
second, which the grasp-point experiments have. The object's yaw, where a task has one, goes with the object; in table 1
the hand's start goes with the target."""

MAX_CANDIDATES = 1000

EPISODE_STEPS = 200  # the authors' limit
SUCCESS_STEPS = 10  # an episode ends after this many successful steps (the authors' rule)


@dataclass(frozen=True)
class MovableBody:
    """One MuJoCo body or site that is written when the object or the target moves.

    `kind` is "free" (a body with a free joint), "body" (a body fixed in the world) or "site" (one of the world's);
    `offset` in metres is turned with the object and added to the position; `yaw` in radians is the stock orientation;
    `joint` names a joint that is put back to 0 whenever the element is moved, so a moved handle cannot open by itself.
    """

    kind: str
    name: str
    offset: Vector = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    joint: str | None = None


@dataclass(frozen=True)
class GraspParameters:
    """How the phase expert grips, and where it takes what it holds; the gripper's commands are in [-1, 1]."""

    transport: Transport
    offset: Vector = (0.0, 0.0, 0.0)  # from the object's point, in the object's frame, metres
    height: float = 0.03  # hand above the object's point while gripping, metres
    gripper_command: float = 1.0  # while closing and holding
    opening: float = 0.0  # gripper command while approaching
    closing_steps: int = 8
    ceiling: float = 0.3  # hand no higher than this above the object's point once it comes near, metres
    patience: int = 60  # steps of descending after which it closes wherever it is
    otherwise: tuple[Vector, ...] = ()  # offsets tried in turn where the hand cannot go to the first


@dataclass(frozen=True)
class PushParameters:
    """How the phase expert works a handle without gripping it: with a closed hand, from a start, along a stroke."""

    frame: str  # the body whose yaw the offset and the stroke turn with
    offset: Vector  # of the hand from the handle when the stroke begins, metres
    stroke: Vector  # where the hand pushes from there, metres
    above: float  # hand above the start while approaching, metres
    joint: str  # that opens
    enough: float  # position of the joint at which the hand stops, metres or radians; below 0 where it opens that way
    lost: float = 0.06  # metres in the plane from the start at which a stroke has missed the handle


@dataclass(frozen=True)
class ScriptedPolicy:
    """What Meta-World's scripted policy of a task needs besides the scene turned into the object's frame."""

    object_offset: Vector = (0.0, 0.0, 0.0)  # from the object's point to what Meta-World observes, metres
    hard_coded: tuple[str, Vector] | None = None  # a point, and where the policy takes it to be in x and y, metres
    squares_lifted: bool = False  # whether the gripper brings the object to yaw 0 once it is lifted


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
    object_bodies: tuple[MovableBody, ...]  # the first is the object's own body
    object_point: str  # the point that experts, motions and keypoints mean by "the object"
    keypoints: tuple[str, ...]  # after fingers and hand; names as in Scene.point
    success: Success
    fixed: SpatialConfiguration  # what is not randomised stays here
    manipulation: GraspParameters | PushParameters
    scripted_policy: ScriptedPolicy = ScriptedPolicy()
    target_range: Box = NO_TARGET
    target_bodies: tuple[MovableBody, ...] = ()  # none: the task has no target apart from its object
    hand_range: Box = WIDE_HAND
    camera_range: tuple[float, float] = HALF_CIRCLE
    yaw_range: tuple[float, float] = (0.0, 0.0)
    yaw_speed_scale: float = 1.0  # of the motions' largest yaw speed
    turns_gripper: bool = False  # whether the action has a fifth part, the gripper's yaw
    separation: float = 0.15
    clearance: float = 0.12
    reachable: Reachable = anywhere
    object_steps: int = 30  # the object moves for this many steps, unless it is grasped before
    target_steps: int = 90  # the target moves from the grasp until this step
    target_dimensions: int = 3  # 2: moves in the table's plane
    target_point: str = "target"  # where the placed point has to go
    placed_point: str = ""  # of the held object; named where there is a freeze distance
    freeze_distance: float = 0.0  # the target stands still while the placed point is nearer in the plane, metres
    jump_clearance: float = 0.0  # a jumping target stays this far in the plane from the object, metres
    recorded: tuple[tuple[str, Success], ...] = ()  # other conditions by name, recorded next to success
    version: int = 1  # raised whenever what decides the task's runs changes; it makes their hashes new
    timesteps: int = 20_000  # Table 5
    authors_fixed: SpatialConfiguration | None = None  # `fixed` in the authors' code, where that is another

    @property
    def action_size(self) -> int:
        """Parts of an action: displacement (3), gripper command and, where the gripper turns, its yaw."""
        return 5 if self.turns_gripper else 4

    @property
    def has_target(self) -> bool:
        """Whether there is a target apart from the object."""
        return bool(self.target_bodies)

    @property
    def has_yaw(self) -> bool:
        """Whether the object's yaw is varied."""
        return self.yaw_range[1] > self.yaw_range[0]

    @property
    def grasps(self) -> bool:
        """Whether the pick phase ends with a grasp; otherwise it ends with the first touch."""
        return isinstance(self.manipulation, GraspParameters)

    def variant(self, fixed: Place = "package", object_steps: int | None = None) -> Task:
        """This task with what is not random where the authors have it, or with its object moving for other steps.

        Raises:
            BadInput: the authors' places are not known for this task.
        """
        if fixed == "authors" and self.authors_fixed is None:
            raise BadInput(f"fixed: 'authors' given for {self.name}, whose places are not known; allowed: package")
        changes: dict[str, Any] = {} if object_steps is None else {"object_steps": object_steps}
        if fixed == "authors":
            changes["fixed"] = self.authors_fixed
        return replace(self, **changes) if changes else self

    def budget(self, most_timesteps: int) -> int:
        """The paper's budget of a data set (table 5), but at most `most_timesteps`, in timesteps."""
        return min(self.timesteps, most_timesteps)

    def allows(self, configuration: SpatialConfiguration, distance: float) -> bool:
        """Whether object and target are `distance` metres apart in the plane, and everything within reach."""
        return self._apart(configuration, distance) and self.reachable(configuration)

    def _apart(self, configuration: SpatialConfiguration, distance: float) -> bool:
        if not self.has_target:
            return True
        return math.dist(configuration.object_position[:2], configuration.target_position[:2]) >= distance

    def sample(self, rng: np.random.Generator, factors: str = "all") -> SpatialConfiguration:
        """Sample a configuration: the `factors` (a key of FACTORS) are random, the rest is the task's fixed one.

        Raises:
            BadInput: unknown factors, or no allowed configuration among a thousand candidates.
        """
        one_of("factors", factors, FACTORS)
        for _ in range(MAX_CANDIDATES):
            candidate = self._candidate(rng, factors)
            if self.allows(candidate, self.separation):
                return candidate
        raise BadInput(f"{self.name}: no configuration has object and target {self.separation} m apart")

    def _candidate(self, rng: np.random.Generator, factors: str) -> SpatialConfiguration:
        free, fixed = FACTORS[factors], self.fixed
        return SpatialConfiguration(
            object_position=self.object_range.sample(rng),
            target_position=self.target_range.sample(rng) if "target" in free else fixed.target_position,
            hand_position=self.hand_range.sample(rng) if "hand" in free else fixed.hand_position,
            camera_angle=float(rng.uniform(*self.camera_range)) if "camera" in free else fixed.camera_angle,
            object_yaw=float(rng.uniform(*self.yaw_range)),
        )


def acceptance_rate(task: Task, rng: np.random.Generator, n: int) -> float:
    """Share of `n` configurations with object and target apart that the reach and clearance filter keeps.

    >>> from move.sim.tasks import get_task
    >>> acceptance_rate(get_task("pick-place"), np.random.default_rng(0), 100)
    1.0
    """
    kept = tried = 0
    while tried < n:
        candidate = task._candidate(rng, "all")
        if task._apart(candidate, task.separation):
            tried += 1
            kept += task.reachable(candidate)
    return kept / n
