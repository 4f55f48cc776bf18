"""A task's compiled MuJoCo model, shared by all its scenes, and the addresses of what is moved in it."""

from __future__ import annotations

import math
from functools import cache

import mujoco
import numpy as np

from move.choices import Drawing
from move.sim.configuration import Vector, vector
from move.sim.geometry import turned
from move.sim.observe import Renderer
from move.sim.tasks.task import MovableBody, Task

OBJECT, LEFT, RIGHT, PALM = 1, 2, 3, 4  # what a contact is between
HAND_BODIES = {"leftclaw": LEFT, "leftpad": LEFT, "rightclaw": RIGHT, "rightpad": RIGHT, "right_hand": PALM}


class World:
    """A task's compiled model, shared by all its scenes (its meshes take 21 MB).

    What is no free body stands in the model itself: each scene writes its own into it before it steps or renders
    (`Scene._load_state`), so scenes of one task can be stepped in turn within one thread; `active_scene` did last.
    """

    def __init__(self, task: Task) -> None:
        from metaworld.env_dict import ALL_V3_ENVIRONMENTS  # slow to import, and drawing stored results needs none

        environment = ALL_V3_ENVIRONMENTS[task.metaworld]()
        self.model: mujoco.MjModel = environment.model
        sites = self.model.site_pos.copy()
        environment._set_task_called, environment._freeze_rand_vec = True, False
        environment.reset()
        self.model.site_pos[:] = sites  # Meta-World's reset writes world coordinates into sites of moved bodies
        self.start = environment.init_qpos.copy()
        self.hand_limits = vector(environment.mocap_low), vector(environment.mocap_high)  # of the hand's goal, metres
        self.active_scene: object | None = None
        self.sides = self._contact_sides(task)
        self._addresses: dict[str, tuple[int, int]] = {}
        self._renderers: dict[tuple[int, Drawing], Renderer] = {}

    def renderer(self, size: int, drawing: Drawing = "plain") -> Renderer:
        """The renderer for images of `size` pixels drawn in one way, made once."""
        if (size, drawing) not in self._renderers:
            self._renderers[size, drawing] = Renderer(self.model, size, drawing)
        return self._renderers[size, drawing]

    def free_joint(self, body: str) -> tuple[int, int]:
        """Where the free joint of `body` stands in the positions and in the velocities."""
        if body not in self._addresses:
            self._addresses[body] = self._joint(int(self.model.body(body).jntadr[0]))
        return self._addresses[body]

    def hinge_or_slide(self, joint: str) -> tuple[int, int]:
        """Where the joint called `joint` stands in the positions and in the velocities."""
        if joint not in self._addresses:
            self._addresses[joint] = self._joint(self.model.joint(joint).id)
        return self._addresses[joint]

    def _joint(self, number: int) -> tuple[int, int]:
        return int(self.model.jnt_qposadr[number]), int(self.model.jnt_dofadr[number])

    def place(self, movable: MovableBody, position: Vector, yaw: float) -> None:
        """Write a fixed body or a site of the world into the model: `position` in metres, `yaw` in radians."""
        where, turn = stands(movable, position, yaw)
        if movable.kind == "site":
            self.model.site(movable.name).pos = where
            return
        body = self.model.body(movable.name)
        body.pos, body.quat = where, turn

    def geoms(self, name: str) -> frozenset[int]:
        """Numbers of the geoms of "body:NAME" and its descendants; of "body:NAME-GEOM" those elsewhere than GEOM."""
        body, _, without = name.removeprefix("body:").partition("-")
        sides = {self.model.body(body).id: OBJECT}
        found = (geom for geom, owner in enumerate(self.model.geom_bodyid) if self._side(int(owner), sides))
        if not without:
            return frozenset(found)
        place = self.model.geom(without).pos
        return frozenset(geom for geom in found if not np.array_equal(self.model.geom_pos[geom], place))

    def _contact_sides(self, task: Task) -> list[int]:
        """For each geom whether it is the object's, a finger's or the hand's (0 for all others)."""
        bodies = {self.model.body(name).id: side for name, side in HAND_BODIES.items()}
        bodies[self.model.body(task.object_bodies[0].name).id] = OBJECT
        return [self._side(int(body), bodies) for body in self.model.geom_bodyid]

    def _side(self, body: int, sides: dict[int, int]) -> int:
        while body and body not in sides:
            body = int(self.model.body_parentid[body])
        return sides.get(body, 0)


def stands(movable: MovableBody, position: Vector, yaw: float) -> tuple[list[float], tuple[float, float, float, float]]:
    """Position (metres) and quaternion of `movable` when what it belongs to is at `position` and `yaw` (radians)."""
    where = [value + offset for value, offset in zip(position, turned(movable.offset, yaw), strict=True)]
    half = (movable.yaw + yaw) / 2
    return where, (math.cos(half), 0.0, 0.0, math.sin(half))


def yaw_of(matrix: np.ndarray) -> float:
    """Yaw (radians) of a rotation matrix laid out in nine numbers, row by row."""
    return math.atan2(matrix[3], matrix[0])


@cache
def shared_world(task: Task) -> World:
    """The world of `task`, compiled once a process."""
    return World(task)
