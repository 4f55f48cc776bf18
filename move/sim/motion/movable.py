"""What a motion asks of what it moves: a scene, and the ranges of its task.

Two classes are such a scene: `Scene`, of this package's tasks, and `MujocoScene`, around anybody's MuJoCo environment.
A third needs the members below and nothing else.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from move.sim.configuration import Box, SpatialConfiguration, Vector


class Ranges(Protocol):
    """Where the parts of a scene may go and for how long; positions in metres, angles in radians. See `Task`."""

    @property
    def object_range(self) -> Box:
        """Where the object may be, metres."""

    @property
    def target_range(self) -> Box:
        """Where the target may be, metres."""

    @property
    def yaw_range(self) -> tuple[float, float]:
        """Which way the object may be turned, radians."""

    @property
    def camera_range(self) -> tuple[float, float]:
        """At which angles the camera may stand, radians."""

    @property
    def yaw_speed_scale(self) -> float:
        """Factor on the largest yaw speed of the motions."""

    @property
    def clearance(self) -> float:
        """The least distance of object and target in the plane, metres."""

    @property
    def object_steps(self) -> int:
        """How many steps the object moves, unless it is grasped before."""

    @property
    def target_steps(self) -> int:
        """Until which step the target moves, from the grasp on."""

    @property
    def target_dimensions(self) -> int:
        """3, or 2 for a target that moves in the table's plane."""

    @property
    def placed_point(self) -> str:
        """The point of the held object that has to go to the target; named where there is a freeze distance."""

    @property
    def target_point(self) -> str:
        """The point where it has to go."""

    @property
    def freeze_distance(self) -> float:
        """The target stands still while the placed point is nearer in the plane, metres."""

    @property
    def has_yaw(self) -> bool:
        """Whether the object may be turned."""

    @property
    def has_target(self) -> bool:
        """Whether there is a target."""

    def allows(self, configuration: SpatialConfiguration, distance: float) -> bool:
        """Whether object and target are `distance` metres apart in the plane, and everything within reach."""


class Movable(Protocol):
    """A scene whose object, target and camera can be put anywhere at any time."""

    @property
    def task(self) -> Ranges:
        """Where its parts may go."""

    @property
    def configuration(self) -> SpatialConfiguration:
        """Where its parts are: object and target as they were put last, the camera as it stands."""

    @property
    def phase(self) -> str:
        """ "pick" from the start of an episode, "place" from the grasp on."""

    @property
    def steps(self) -> int:
        """Steps of the episode so far."""

    @property
    def np_random(self) -> np.random.Generator:
        """What a motion draws its speed and direction from; seeded by `reset(seed=...)`."""

    def point(self, name: str) -> np.ndarray:
        """Position of a named point, shape (3,), metres."""

    def move_object(self, position: Vector, yaw: float) -> None:
        """Put the object at `position` (metres) and `yaw` (radians), at rest."""

    def move_target(self, position: Vector) -> None:
        """Put the target at `position` (metres)."""

    def move_camera(self, angle: float) -> None:
        """Put the camera at `angle` (radians) around the scene."""

    def advance(self, action: Any) -> None:
        """One step of the environment, of which nothing is returned."""
