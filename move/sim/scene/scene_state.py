"""What can be read of a scene: points, yaws, joints, contacts.

Points are named "target", "body:NAME", "site:NAME", "geom:NAME", or "body:NAME+x,y,z" for the point at that offset
(metres) in the body's frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import mujoco
import numpy as np

from move.sim.geometry import wrapped
from move.sim.observe import LANDMARKS
from move.sim.scene.shared_model import World, yaw_of
from move.sim.tasks.task import Task


class Readable:
    """The reading half of a scene: everything here is a function of MuJoCo's present state.

    Args:
        task: whose object is meant by "the object".
        world: the compiled model.
        target: position of the target, shape (3,), metres; kept as a live view.
    """

    def __init__(self, task: Task, world: World, target: np.ndarray) -> None:
        self.task, self._world, self._model = task, world, world.model
        self._data = mujoco.MjData(world.model)
        self._orientations: dict[str, np.ndarray] = {}
        self._points: dict[str, np.ndarray | Callable[[], np.ndarray]] = {"target": target}
        self._touching: dict[str, frozenset[int]] = {}

    @property
    def hand(self) -> np.ndarray:
        """Position of the hand, shape (3,), metres."""
        return self.point("body:hand")

    @property
    def hand_yaw(self) -> float:
        """Yaw of the hand as it is, radians; `gripper_yaw` is where it should be."""
        matrix = self._orientation("hand")
        return math.atan2(-matrix[1], matrix[4])

    @property
    def object_yaw(self) -> float:
        """Yaw of the object as it lies or is held, relative to Meta-World's pose, radians."""
        movable = self.task.object_bodies[0]
        return wrapped(self.body_yaw(movable.name) - movable.yaw)

    def body_yaw(self, name: str) -> float:
        """Yaw of a named body, radians."""
        return yaw_of(self._orientation(name))

    def _orientation(self, body: str) -> np.ndarray:
        """Rotation matrix of a body, nine numbers row by row; a live view."""
        if body not in self._orientations:
            self._orientations[body] = self._data.xmat[self._model.body(body).id]
        return self._orientations[body]

    def joint(self, name: str) -> float:
        """Position of a named hinge or slide, radians or metres."""
        return float(self._data.qpos[self._world.hinge_or_slide(name)[0]])

    def touches(self, first: str, second: str) -> bool:
        """Whether two of "body:NAME" or "body:NAME-GEOM" (without what is at GEOM's place) are in contact."""
        one, other = (self._geoms(name) for name in (first, second))
        return any((a in one and b in other) or (b in one and a in other) for a, b in self._data.contact.geom.tolist())

    def _geoms(self, name: str) -> frozenset[int]:
        if name not in self._touching:
            self._touching[name] = self._world.geoms(name)
        return self._touching[name]

    @property
    def opening(self) -> float:
        """Opening of the gripper from 0 to 1, as Meta-World observes it."""
        gap = self.point("body:rightclaw") - self.point("body:leftclaw")
        return float(min(1.0, max(0.0, np.sqrt(gap @ gap) / 0.1)))

    def point(self, name: str) -> np.ndarray:
        """Position of a named point, shape (3,), metres: "target", "body:NAME", "site:NAME", "geom:NAME".

        "body:NAME+x,y,z" is the point at that offset in the body's frame. The array may be a live view: copy it to
        keep it.
        """
        if name not in self._points:
            self._points[name] = self._view(name)
        found = self._points[name]
        return found() if callable(found) else found

    def _view(self, name: str) -> np.ndarray | Callable[[], np.ndarray]:
        if name in LANDMARKS:
            return np.array(LANDMARKS[name])
        kind, element = name.split(":")
        if kind == "site":
            return self._data.site_xpos[self._model.site(element).id]
        if kind == "geom":
            return self._data.geom_xpos[self._model.geom(element).id]
        element, _, offset = element.partition("+")
        position = self._data.xpos[self._model.body(element).id]
        return self._attached(element, position, offset) if offset else position

    def _attached(self, body: str, position: np.ndarray, offset: str) -> Callable[[], np.ndarray]:
        matrix = self._orientation(body).reshape(3, 3)
        vector = np.array([float(value) for value in offset.split(",")])
        return lambda: position + matrix @ vector
