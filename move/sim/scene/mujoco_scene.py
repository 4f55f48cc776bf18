"""Any MuJoCo environment as a scene whose object, target and camera can be moved while it runs.

    MujocoScene     the wrapper that the motions of `move.sim.motion.wrappers` move
    simulation      where an environment keeps its MuJoCo model and data
    lifted, touched when the pick phase ends

`move.moving` puts it together; how each kind of body is moved is in `movers.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from operator import attrgetter
from typing import Annotated, Any, SupportsFloat

import gymnasium
import mujoco
import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from move.errors import BadInput
from move.sim.configuration import Box, SpatialConfiguration, Vector, vector
from move.sim.scene.movers import Camera, Mover, located, mover

LIFTED = 0.02  # metres above the lowest place of its episode at which an object counts as lifted
STREAM = 2  # with a seed given to `reset`: the motions draw from another generator than the environment
PLACES = (("model", "data", mujoco.mj_kinematics),  # Gymnasium, Gymnasium-Robotics, Meta-World, OGBench
          ("sim.model._model", "sim.data._data", mujoco.mj_kinematics),  # robosuite
          ("physics.model.ptr", "physics.data.ptr", mujoco.mj_step1),  # dm_control by shimmy
          ("_env.physics.model.ptr", "_env.physics.data.ptr", mujoco.mj_step1))  # gym-aloha
"""Where a model, its data, and what makes them fit after a move: dm_control steps with forces computed beforehand."""


def _about_its_start(angles: tuple[float, float]) -> tuple[float, float]:
    if not -math.inf < angles[0] <= 0 <= angles[1] < math.inf:
        raise ValueError("allowed are two numbers of radians, at most 0 and at least 0")
    return angles


ANYWHERE = Box((-math.inf,) * 3, (math.inf,) * 3)
Angles = Annotated[tuple[float, float], AfterValidator(_about_its_start)]  # radians, around where an episode starts


def simulation(env: gymnasium.Env) -> tuple[mujoco.MjModel, mujoco.MjData, Callable[..., None]]:
    """The MuJoCo model and data of `env`, and the function of both that is called after something was moved.

    Raises:
        BadInput: none of `PLACES` has them.
    """
    base = env.unwrapped
    for model, data, settle in PLACES:
        try:
            found = attrgetter(model)(base), attrgetter(data)(base)
        except (AttributeError, ReferenceError):  # dm_control drops the physics of the last episode
            continue
        if isinstance(found[0], mujoco.MjModel) and isinstance(found[1], mujoco.MjData):
            return *found, settle
    raise BadInput(f"env: {type(base).__name__} shows no MuJoCo model and data; allowed are environments with both as "
                   f"{', '.join(f'{model} and {data}' for model, data, _ in PLACES)}")


class Space(BaseModel):
    """What moves in a scene of one's own, and where: the ranges that its motions keep to. Metres and radians.

    A box without a height has infinite ones: heights are left to physics, or stay what they are.
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    object: str
    object_range: Box
    target: str | None = None
    target_range: Box = ANYWHERE
    goal: str | None = None
    camera: str | None = None
    camera_range: Angles = (0.0, 0.0)
    camera_around: tuple[float, float] = (0.0, 0.0)
    yaw_range: Angles = (0.0, 0.0)
    clearance: float = Field(default=0.0, ge=0, allow_inf_nan=False)
    freeze_distance: float = Field(default=0.0, ge=0, allow_inf_nan=False)
    object_steps: int = Field(default=30, gt=0)
    target_steps: int = Field(default=200, gt=0)
    target_dimensions: int = 2
    yaw_speed_scale: float = 1.0

    @property
    def placed_point(self) -> str:
        """What is placed: the object."""
        return self.object

    @property
    def target_point(self) -> str:
        """Where it is placed: the target."""
        return self.target or self.object

    @property
    def has_target(self) -> bool:
        """Whether there is a target apart from the object."""
        return self.target is not None

    @property
    def has_yaw(self) -> bool:
        """Whether the object turns."""
        return self.yaw_range[1] > self.yaw_range[0]

    def allows(self, configuration: SpatialConfiguration, distance: float) -> bool:
        """Whether object and target are `distance` metres apart in the plane."""
        return not self.has_target or math.dist(configuration.object_position[:2],
                                                configuration.target_position[:2]) >= distance


class MujocoScene(gymnasium.Wrapper):
    """An environment with its MuJoCo model and data, seen as a scene that motions move.

    `unwrapped` stays the environment itself. `info` gets "phase". What a motion writes into the model (fixed bodies,
    sites, cameras) is put back before each reset.

    Args:
        env: a Gymnasium environment with a MuJoCo model.
        task: what moves in it, and where.
        grasped: a function of this scene that ends the pick phase by being true after a step.

    Raises:
        BadInput: no MuJoCo model, a name that it has not, or a part that cannot be moved as `task` says.
    """

    phase: str
    steps: int

    def __init__(self, env: gymnasium.Env, task: Space, grasped: Callable[[MujocoScene], bool]) -> None:
        super().__init__(env)
        self.task, self.grasped, self.scene = task, grasped, self
        self._rng = np.random.default_rng()
        self._bind()
        names = (self.model, self.data)
        if task.target and _owner(*names, task.target) == _owner(*names, task.object):
            raise BadInput(f"target: {task.target!r} given, which is the object's own body; allowed is another one")

    def _bind(self) -> None:
        """Look everything up: an environment may compile a new model for each episode."""
        self.model, self.data, self._settle = simulation(self.env)
        task, names = self.task, (self.model, self.data)
        mujoco.mj_kinematics(*names)
        self._points: dict[str, np.ndarray] = {}  # live views
        self._object: Mover = mover(*names, "object", task.object, task.object_range, task.has_yaw)
        self._target = mover(*names, "target", task.target, task.target_range, False) if task.target else None
        self._camera = Camera(*names, task.camera, task.camera_around) if task.camera else None
        self._moved = False

    # Gymnasium ------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode where the environment starts it.

        Raises:
            BadInput: the object or the target starts outside its range.
        """
        task = self.task
        for part in (self._object, self._target, self._camera):
            if part:
                part.put_back()
        observation, info = self.env.reset(seed=seed, options=options)
        if seed is not None:
            self._rng = np.random.default_rng([STREAM, seed])
        self._bind()
        self.steps, self.phase, self.lowest = 0, "pick", float(self._object.start[2])
        self._configuration = self._start()
        if task.goal:  # what marks it may stand elsewhere until a picture is drawn
            self.move_target(self._configuration.target_position)
        return observation, info | {"phase": self.phase}

    def _start(self) -> SpatialConfiguration:
        task, here = self.task, vector(self._object.start)
        there = here
        if self._target:
            there = vector(self._goal() if task.goal else self._target.start)
        for what, place, within in (("within", here, task.object_range), ("target_within", there, task.target_range)):
            if not within.contains(place):
                flat = 2 if math.isinf(within.low[2]) else 3
                raise BadInput(f"{what}: {within.low[:flat]} to {within.high[:flat]} given, and this episode starts at "
                               f"({', '.join(f'{value:.3f}' for value in place[:flat])}); allowed is a box that holds "
                               "every start")
        return SpatialConfiguration(here, there, here, 0.0)

    def _goal(self) -> np.ndarray:
        """Where the environment itself has the target."""
        goal: Any = getattr(self.unwrapped, str(self.task.goal), None)
        if np.shape(goal) != (3,):
            raise BadInput(f"goal: {self.task.goal!r} given; allowed is an attribute of "
                           f"{type(self.unwrapped).__name__} that holds 3 numbers")
        return np.asarray(goal, float)

    def step(self, action: Any) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Step the environment with what was moved, then see whether the object was grasped."""
        if self._moved:
            self._settle(self.model, self.data)
            self._moved = False
        observation, reward, terminated, truncated, info = self.env.step(action)
        self.steps += 1
        if self.phase == "pick":
            self.lowest = min(self.lowest, self._object.where[2])
            if self.grasped(self):
                self.phase = "place"
        return observation, reward, terminated, truncated, info | {"phase": self.phase}

    # what a motion asks (see `Movable`) -------------------------------------------------------------------------------

    @property  # type: ignore[misc]  # a motion sets none
    def np_random(self) -> np.random.Generator:
        """The motions' own generator: what they draw does not change what the environment draws."""
        return self._rng

    @property
    def configuration(self) -> SpatialConfiguration:
        """Where object and target were put last; angles of object and camera from where the episode started."""
        return self._configuration

    def point(self, name: str) -> np.ndarray:
        """Position of "body:NAME", "site:NAME" or of the body or site called `name`, shape (3,), metres; a view."""
        if name not in self._points:
            self._points[name] = located(self.model, self.data, "point", name)[2]
        return self._points[name]

    def advance(self, action: Any) -> None:
        """Step, and return nothing."""
        self.step(action)

    def move_object(self, position: Vector, yaw: float) -> None:
        """Put the object at `position` (metres) at rest, turned by `yaw` (radians) from where the episode started."""
        self._object.put(position, yaw)
        self._configuration, self._moved = replace(self._configuration, object_position=position, object_yaw=yaw), True

    def move_target(self, position: Vector) -> None:
        """Put the target, and the environment's goal where `task` names one, at `position` (metres)."""
        if self._target:
            self._target.put(position, 0.0)
        if self.task.goal:
            setattr(self.unwrapped, self.task.goal, np.array(position))
        self._configuration, self._moved = replace(self._configuration, target_position=position), True

    def move_camera(self, angle: float) -> None:
        """Turn the camera by `angle` (radians) about the vertical, from where the environment has it."""
        if self._camera:
            self._camera.put(angle)
        self._configuration = replace(self._configuration, camera_angle=angle)


def _owner(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> int:
    """The body that is meant by a name; of what is fixed to the world itself, or of a site of it, a number of its own.
    """
    kind, number, _ = located(model, data, "object", name)
    body = number if kind == "body" else int(model.site_bodyid[number])
    return body if kind == "body" or model.body_weldid[body] else -1 - number


def lifted(scene: MujocoScene) -> bool:
    """Whether the object is 2 cm above the lowest place of its episode."""
    return scene.point(scene.task.object)[2] > scene.lowest + LIFTED


def touched(scene: MujocoScene) -> bool:
    """Whether something that can move touches the object: a gripper does, a table does not."""
    model = scene.model
    kind, number, _ = located(model, scene.data, "object", scene.task.object)
    owner = model.body_weldid[number if kind == "body" else model.site_bodyid[number]]
    pairs = model.body_weldid[model.geom_bodyid[scene.data.contact.geom]]  # 0: fixed in the world
    return any(owner in pair and all(pair) and pair[0] != pair[1] for pair in pairs.tolist())
