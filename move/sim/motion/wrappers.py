"""Motions as Gymnasium wrappers: what moves while the expert demonstrates, and in which phase of the task.

    with_motions          the paper's staged strategy: puts the motions below around a scene
    ObjectTranslation     equation 1 for the object, in the pick phase
    ObjectRotation        equation 2 for the object, in the pick phase
    TargetTranslation     equation 1 for the target, in the placement phase
    CameraMotion          equation 3, in both phases

A motion samples its speed and direction on reset from the scene's generator and moves its part before each step, so one
observation is made a step however many motions are stacked.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, TypeVar, cast, get_args

import gymnasium
import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.choices import SpeedLaw
from move.sim.configuration import Box, Disc, SpatialConfiguration, vector
from move.sim.motion import equations
from move.sim.motion.movable import Movable
from move.sim.tasks.task import FACTORS, Task

if TYPE_CHECKING:
    from move.sim.scene.mujoco_scene import Space
    from move.sim.scene.scene import Scene

MovableScene = TypeVar("MovableScene", bound=Movable)
Part = Literal["object", "rotation", "target", "camera"]
PARTS: tuple[Part, ...] = get_args(Part)
SPEEDS: dict[Part, str] = {"object": "object_speed", "rotation": "yaw_speed", "target": "target_speed",
                           "camera": "camera_speed"}
"""The field of Motions that holds each part's largest speed."""


class Motions(BaseModel):
    """Largest speeds of MOVE's motions, of which 0 leaves a motion out, and how an episode draws below them."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    object_speed: float = Field(default=0.03, ge=0, allow_inf_nan=False, description="metres per step")
    target_speed: float = Field(default=0.03, ge=0, allow_inf_nan=False, description="metres per step")
    yaw_speed: float = Field(math.radians(1.0), ge=0, allow_inf_nan=False, description="radians per step")
    camera_speed: float = Field(math.radians(1.0), ge=0, allow_inf_nan=False, description="radians per step")
    speed_law: SpeedLaw = Field(default="beta", description="how the speed of an episode is drawn: see sample_speed")


def scene_of(env: gymnasium.Env) -> Movable:
    """What moves in `env`: the first `scene` among its wrappers, or else the environment inside them all."""
    return env.get_wrapper_attr("scene") if env.has_wrapper_attr("scene") else cast(Movable, env.unwrapped)


class Motion(gymnasium.Wrapper):
    """One part of the scene that moves by a law of time while `moving` holds.

    Where the law would leave what the task allows (object and target nearer than its clearance, or something out of
    reach), the motion goes back the way it came; where that is not allowed either, it stands still for a step.
    """

    keeps_clear = True
    velocity: Any  # a step: metres along each axis, or radians

    def __init__(self, env: gymnasium.Env, maximum_speed: float, law: SpeedLaw = "beta") -> None:
        super().__init__(env)
        self.inner, self.scene = cast("Movable | Motion", env), scene_of(env)
        self.maximum_speed, self.law = maximum_speed, law

    def reset(self, **keywords: Any) -> tuple[np.ndarray, dict]:
        """Start an episode and sample this motion's speed and direction."""
        observation, info = self.env.reset(**keywords)
        self.start, self.clock, self.sense, self.moves = self.scene.configuration, 0, 1, 0
        self.sample(self.scene.np_random)
        return observation, info

    def step(self, action: np.ndarray) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict]:
        """Move this part, then step."""
        if self.moving():
            self._move()
        return self.env.step(action)

    def advance(self, action: np.ndarray) -> None:
        """Move this part, then advance without observing."""
        if self.moving():
            self._move()
        self.inner.advance(action)

    def _move(self) -> None:
        wanted = self.placed(self.clock + self.sense)
        self.moves += 1
        if not self._allowed(wanted):
            self.sense = -self.sense
            wanted = self.placed(self.clock + self.sense)
            if not self._allowed(wanted):
                return
        self.clock += self.sense
        self.apply(wanted)

    def _allowed(self, wanted: SpatialConfiguration) -> bool:
        return not self.keeps_clear or self.scene.task.allows(wanted, self.scene.task.clearance)

    def moving(self) -> bool:
        """Whether this part moves in the coming step."""
        raise NotImplementedError

    def sample(self, rng: np.random.Generator) -> None:
        """Sample a speed, by default w, u ~ Beta(2, 5) and a direction in {-1, 1}."""
        self.velocity = self.sample_speed(rng) * equations.sample_sign(rng)

    def sample_speed(self, rng: np.random.Generator) -> float:
        """A speed by this motion's law, at most `maximum_speed`."""
        return equations.sample_speed(rng, self.maximum_speed, self.law)

    def placed(self, time: float) -> SpatialConfiguration:
        """The scene's configuration with this part where its law has it at `time` (steps)."""
        raise NotImplementedError

    def apply(self, configuration: SpatialConfiguration) -> None:
        """Write this part of `configuration` into the scene."""
        raise NotImplementedError


class PickMotion(Motion):
    """What moves in the pick phase: until the object is grasped, for at most the task's `object_steps`.

    Where the task is done without a grasp, the first touch ends the pick phase.
    """

    def moving(self) -> bool:
        """Whether the pick phase lasts and steps are left."""
        return self.scene.phase == "pick" and self.moves < self.scene.task.object_steps

    def apply(self, configuration: SpatialConfiguration) -> None:
        """Put the object where `configuration` has it."""
        self.scene.move_object(configuration.object_position, configuration.object_yaw)


class ObjectTranslation(PickMotion):
    """The object moves in the table's plane (equation 1).

    Args:
        env: a scene, wrapped or not.
        maximum_speed: v_max, metres per step.
        region: where it moves; the task's object range by default.
        arrive: the configured position is where the motion ends, after all its steps, and not where it starts; of a
            `Scene`.
        law: how its speed is drawn.
    """

    def __init__(self, env: gymnasium.Env, maximum_speed: float, region: Box | Disc | None = None,
                 arrive: bool = False, law: SpeedLaw = "beta") -> None:
        super().__init__(env, maximum_speed, law)
        self.region, self.arrive, self.keeps_clear = region or self.scene.task.object_range, arrive, not arrive

    def reset(self, **keywords: Any) -> tuple[np.ndarray, dict]:
        """Start an episode; an arriving object is traced back to where its motion begins."""
        observation, info = super().reset(**keywords)
        if not self.arrive:
            return observation, info
        self.clock = -self.scene.task.object_steps
        self.apply(self.placed(self.clock))
        return cast("Scene", self.scene).refresh(), info

    def sample(self, rng: np.random.Generator) -> None:
        """Sample v ~ Beta(2, 5) and a direction uniform on the circle."""
        speed = self.sample_speed(rng)
        self.velocity = vector(speed * part for part in equations.sample_direction(rng, 2))

    def placed(self, time: float) -> SpatialConfiguration:
        """The configuration with the object where it is after `time` steps."""
        there = equations.translate(self.start.object_position, self.velocity, time, self.region)
        return replace(self.scene.configuration, object_position=there)


class ObjectRotation(PickMotion):
    """The object turns about the vertical within the task's yaw range (equation 2); `maximum_speed` in rad/step."""

    def placed(self, time: float) -> SpatialConfiguration:
        """The configuration with the yaw after `time` steps."""
        yaw = equations.turn(self.start.object_yaw, self.velocity, time, *self.scene.task.yaw_range)
        return replace(self.scene.configuration, object_yaw=yaw)


class TargetTranslation(Motion):
    """The target moves from the grasp on, until the task's `target_steps` (equation 1).

    It stands still while the held object is about to be placed, within the task's `freeze_distance`.
    """

    def moving(self) -> bool:
        """Whether the object was grasped and the target may still move."""
        scene, task = self.scene, self.scene.task
        if scene.phase != "place" or scene.steps >= task.target_steps:
            return False
        if not task.freeze_distance:
            return True
        placed, there = scene.point(task.placed_point), scene.point(task.target_point)
        return math.dist(placed[:2], there[:2]) >= task.freeze_distance

    def sample(self, rng: np.random.Generator) -> None:
        """Sample v ~ Beta(2, 5) and a direction uniform on the sphere, or on the circle for a target on the table."""
        speed = self.sample_speed(rng)
        direction = equations.sample_direction(rng, self.scene.task.target_dimensions)
        self.velocity = vector(speed * part for part in direction)
        self.keeps_clear = False  # the object is in the hand

    def placed(self, time: float) -> SpatialConfiguration:
        """The configuration with the target where it is after `time` steps."""
        there = equations.translate(self.start.target_position, self.velocity, time, self.scene.task.target_range)
        return replace(self.scene.configuration, target_position=there)

    def apply(self, configuration: SpatialConfiguration) -> None:
        """Put the target there."""
        self.scene.move_target(configuration.target_position)


class CameraMotion(Motion):
    """The camera moves along its cylinder in both phases (equation 3); `maximum_speed` in radians per step."""

    keeps_clear = False

    def moving(self) -> bool:
        """Always."""
        return True

    def placed(self, time: float) -> SpatialConfiguration:
        """The configuration with the camera's angle after `time` steps."""
        angle = equations.turn(self.start.camera_angle, self.velocity, time, *self.scene.task.camera_range)
        return replace(self.scene.configuration, camera_angle=angle)

    def apply(self, configuration: SpatialConfiguration) -> None:
        """Put the camera there."""
        self.scene.move_camera(configuration.camera_angle)


def movable(task: Task | Space, factors: str) -> tuple[Part, ...]:
    """What can move: the object, its rotation where the task has a yaw, and what `factors` randomises of the rest.

    >>> from move.sim.tasks import get_task
    >>> movable(get_task("pick-place"), "all")
    ('object', 'target', 'camera')
    """
    able: dict[Part, bool] = {
        "object": True, "rotation": task.has_yaw, "target": task.has_target and "target" in FACTORS[factors],
        "camera": "camera" in FACTORS[factors]}
    return tuple(part for part in able if able[part])


def with_motions(scene: MovableScene, motions: Motions, factors: str, region: Box | Disc | None = None,
                 arrive: bool = False) -> MovableScene | Motion:
    """MOVE's staged strategy around `scene`: only what `factors` randomises moves, and only with a speed above 0."""
    able = movable(scene.task, factors)
    env, law = cast(gymnasium.Env, scene), motions.speed_law
    if motions.object_speed:
        env = ObjectTranslation(env, motions.object_speed, region, arrive, law)
    if motions.yaw_speed and "rotation" in able:
        env = ObjectRotation(env, motions.yaw_speed * scene.task.yaw_speed_scale, law)
    if motions.target_speed and "target" in able:
        env = TargetTranslation(env, motions.target_speed, law)
    if motions.camera_speed and "camera" in able:
        env = CameraMotion(env, motions.camera_speed, law)
    return cast("MovableScene | Motion", env)
