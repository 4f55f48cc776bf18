"""What a motion asks of the scene that it moves.

Two classes are such a scene: `Scene`, of this package's tasks, and `MujocoScene`, around anybody's MuJoCo environment.
A third needs the members below and nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.tasks.task import Task

if TYPE_CHECKING:
    from move.sim.scene.mujoco_scene import Space


class Movable(Protocol):
    """A scene whose object, target and camera can be put anywhere at any time."""

    @property
    def task(self) -> Task | Space:
        """Where its parts may go, and for how long."""

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
