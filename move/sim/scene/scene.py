"""The scene: a Meta-World task whose spatial configuration is set on reset and can be moved while it runs.

Meta-World supplies the model, its starting pose and the limits of the hand; stepping, success and observation happen
here, without Meta-World's rewards and samplers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, get_args

import gymnasium
import mujoco
import numpy as np
from gymnasium.spaces import Box as BoxSpace

from move.choices import Drawing
from move.errors import BadInput, one_of
from move.machine import gl_problem
from move.sim.configuration import SpatialConfiguration, Vector, vector
from move.sim.geometry import limited
from move.sim.observe import IMAGE_SIZE, ObservationKind, keypoint_names, keypoint_slices, keypoints
from move.sim.scene import checks
from move.sim.scene.scene_state import Readable
from move.sim.scene.shared_model import LEFT, OBJECT, PALM, RIGHT, shared_world, stands
from move.sim.tasks import DEFAULT_TASK, FACTORS, TASKS, Task, get_task

OBSERVATIONS: tuple[str, ...] = get_args(ObservationKind)
RENDER_MODES = ("rgb_array",)
HAND_STEP = 0.01  # metres that the hand's goal moves for an action of 1
YAW_STEP = math.radians(6.0)  # radians that the gripper's goal turns for an action of 1
YAW_LIMIT = math.radians(100.0)  # of the gripper's goal, to both sides; radians
SUBSTEPS = 5  # MuJoCo steps an environment step, as in Meta-World
SETTLE_STEPS = 50  # environment steps given to the hand to reach its start, as in Meta-World
REACH = 0.3  # metres between hand and object beyond which contacts are not looked up
DOWN = np.array([1.0, 0.0, 1.0, 0.0]) / np.sqrt(2.0)  # orientation of a hand that points down, at yaw 0
STATE = mujoco.mjtState.mjSTATE_INTEGRATION  # all that decides what MuJoCo does next
OF_THE_PROCESS = ("task", "_world", "_model", "_data", "_points", "_touching")  # made anew where a scene is unpickled


class Scene(Readable, gymnasium.Env):
    """A task of the paper as a Gymnasium environment whose object, target and camera can be moved at any time.

    Actions are four numbers in [-1, 1]: three displacements of the hand's goal (1 = 0.01 m) and the gripper's
    command; where the task turns the gripper a fifth: the change of its goal's yaw (1 = 6 degrees, at most 100 to each
    side). An observation is the keypoint vector (float32, metres, camera frame) or an RGB image (uint8). The reward
    is 1 on a successful step. `info` holds "success" and "phase" ("pick", from the grasp on "place"), and what else the
    task records ("strict_success" of Hammer, "metaworld_success" of Box-Close). The episode limit is left to
    Gymnasium's TimeLimit and to the loops of this package. A scene can be pickled and copied, also within an episode.

    Args:
        task: a name in `move.sim.tasks.TASKS`.
        observation: "keypoints" or "rgb".
        image_size: pixels along each side of an image.
        render_mode: None or "rgb_array".
        factors: what a reset draws unless its options say otherwise: a key of `move.sim.tasks.FACTORS`.
        drawing: of images: "plain", or "full" with shadows, reflections, sky and multisampling.

    Raises:
        BadInput: an unknown name, an impossible size, or "rgb" without a GL library.
    """

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 80}
    phase: str
    steps: int

    def __init__(self, task: str | Task = DEFAULT_TASK, observation: str = "keypoints", image_size: int = IMAGE_SIZE,
                 render_mode: str | None = None, factors: str = "all", drawing: Drawing = "plain") -> None:
        one_of("observation", observation, OBSERVATIONS)
        one_of("render_mode", render_mode, (None, *RENDER_MODES))
        one_of("factors", factors, FACTORS)
        one_of("drawing", drawing, get_args(Drawing))
        task, self._target = task if isinstance(task, Task) else get_task(task), np.zeros(3)
        super().__init__(task, shared_world(task), self._target)
        self.observation, self.image_size, self.render_mode = observation, checks.picture_side(image_size), render_mode
        self.factors, self.drawing = factors, drawing
        self._mocap: list[float] = []  # the hand's goal, metres; nothing before the first reset
        self._keypoint_names = keypoint_names(self.task.keypoints)
        self.keypoint_slices = keypoint_slices(self.task.keypoints)
        self.action_space = BoxSpace(-1.0, 1.0, (self.task.action_size,), np.float32)
        self.observation_space = self._observation_space()
        self._configuration = self.task.fixed

    def _observation_space(self) -> BoxSpace:
        if self.observation == "rgb":
            if problem := gl_problem():  # GL itself is opened by the first image: a process may be forked before
                raise BadInput(problem)
            return BoxSpace(0, 255, (self.image_size, self.image_size, 3), np.uint8)
        return BoxSpace(-np.inf, np.inf, (3 * len(self._keypoint_names),), np.float32)

    # starting ------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Start an episode in `options["configuration"]`, or in one sampled from `options["factors"]` or the scene's.

        The hand is driven to its start as Meta-World does, the object held where it belongs.

        Raises:
            BadInput: unknown options or factors, or a configuration that is none.
        """
        super().reset(seed=seed)
        chosen = checks.reset_options(options)
        configuration = chosen.get("configuration") or self.task.sample(
            self.np_random, chosen.get("factors") or self.factors)
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:] = self._world.start
        self.steps, self.phase, self.touched, self.held, self.success = 0, "pick", False, False, False
        self.recorded_steps, self.gripper_yaw = dict.fromkeys(dict(self.task.recorded), 0), 0.0
        self.recorded = dict.fromkeys(self.recorded_steps, False)
        self._configuration = configuration
        self._world.active_scene = None  # what stands in the model is the last episode's
        self._load_state()
        self._drive_hand(configuration.hand_position)
        self.move_object(configuration.object_position, configuration.object_yaw)
        mujoco.mj_forward(self._model, self._data)
        return self.observe(), self._info()

    def _drive_hand(self, position: Vector) -> None:
        self._mocap = list(position)
        for _ in range(SETTLE_STEPS):
            self._data.mocap_pos[0], self._data.mocap_quat[0] = position, DOWN
            self._data.ctrl[:] = (-1.0, 1.0)
            self.move_object(self._configuration.object_position, self._configuration.object_yaw)
            mujoco.mj_step(self._model, self._data, nstep=SUBSTEPS)

    def _load_state(self) -> None:
        """Write this scene's target, and an object that stands in the model, unless they are there already."""
        if self._world.active_scene is self:
            return
        self._world.active_scene = self
        self.move_target(self._configuration.target_position)
        for movable in self.task.object_bodies:
            if movable.kind != "free":
                self._world.place(movable, self._configuration.object_position, self._configuration.object_yaw)

    # running -------------------------------------------------------------------------------------------------------

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Advance by one step and observe; never terminates by itself (Meta-World's convention).

        Raises:
            BadInput: before the first reset, or an action that is not as many finite numbers as the action space has.
        """
        self.advance(action)
        return self.observe(), float(self.success), False, False, self._info()

    def advance(self, action: np.ndarray) -> None:
        """Advance by one step without observing: the hand's goal moves, MuJoCo runs, success is judged."""
        if not self._mocap:
            raise BadInput("step before the first reset; allowed is reset() first")
        self._load_state()
        numbers = checks.action_numbers(action, self.task.action_size)
        dx, dy, dz, command, *turn = (min(1.0, max(-1.0, value)) for value in numbers)
        low, high = self._world.hand_limits
        for axis, change in enumerate((dx, dy, dz)):
            self._mocap[axis] = min(high[axis], max(low[axis], self._mocap[axis] + HAND_STEP * change))
        self._data.mocap_pos[0] = self._mocap
        self._data.ctrl[:] = (command, -command)
        if self.task.turns_gripper:
            self._turn_gripper(*turn)
        mujoco.mj_step(self._model, self._data, nstep=SUBSTEPS)
        mujoco.mj_kinematics(self._model, self._data)
        self.steps += 1
        self._look_up_contacts()
        self.success = self.touched and self.task.success(self)
        for name, condition in self.task.recorded:
            self.recorded[name] = self.touched and condition(self)
            self.recorded_steps[name] += self.recorded[name]

    def _turn_gripper(self, turn: float) -> None:
        self.gripper_yaw = limited(self.gripper_yaw + YAW_STEP * turn, YAW_LIMIT)
        cos, sin = math.cos(self.gripper_yaw / 2), math.sin(self.gripper_yaw / 2)
        self._data.mocap_quat[0] = np.array([cos, -sin, cos, sin]) / np.sqrt(2.0)  # DOWN turned about the vertical

    def _look_up_contacts(self) -> None:
        """Note whether the hand touches the object and whether both fingers hold it; the first hold ends the pick.

        Where the task is done without a grasp, the first touch ends it.
        """
        self.held = False
        offset = self.point(self.task.object_point) - self.hand
        if offset @ offset > REACH**2:
            return
        sides, met = self._world.sides, set()
        for first, second in self._data.contact.geom.tolist():
            pair = (sides[first], sides[second])
            if OBJECT in pair:
                met.add(sum(pair) - OBJECT)
        self.touched = self.touched or bool(met & {LEFT, RIGHT, PALM})
        self.held = {LEFT, RIGHT} <= met
        if self.held if self.task.grasps else self.touched:
            self.phase = "place"

    def _info(self) -> dict[str, Any]:
        return {"success": self.success, "phase": self.phase, **self.recorded}

    # moving --------------------------------------------------------------------------------------------------------

    def move_object(self, position: Vector, yaw: float) -> None:
        """Put the object at `position` (metres) and `yaw` (radians), at rest."""
        for movable in self.task.object_bodies:
            if movable.kind == "free":
                at, speed = self._world.free_joint(movable.name)
                where, turn = stands(movable, position, yaw)
                self._data.qpos[at : at + 7] = (*where, *turn)
                self._data.qvel[speed : speed + 6] = 0.0
            else:
                self._load_state()
                self._world.place(movable, position, yaw)
            if movable.joint:
                at, speed = self._world.hinge_or_slide(movable.joint)
                self._data.qpos[at] = self._data.qvel[speed] = 0.0
        self._configuration = replace(self._configuration, object_position=vector(position), object_yaw=yaw)

    def move_target(self, position: Vector) -> None:
        """Put the target at `position` (metres)."""
        self._target[:] = position
        self._configuration = replace(self._configuration, target_position=vector(position))
        self._load_state()
        for movable in self.task.target_bodies:
            self._world.place(movable, position, 0.0)

    def move_camera(self, angle: float) -> None:
        """Put the camera at `angle` (radians) on its cylinder."""
        self._configuration = replace(self._configuration, camera_angle=angle)

    @contextmanager
    def with_target_at(self, target: Vector) -> Iterator[None]:
        """For a while, any reader of the scene finds the target at `target` (metres); nothing may be stepped."""
        true = self._configuration.target_position
        self.move_target(target)
        mujoco.mj_kinematics(self._model, self._data)
        try:
            yield
        finally:
            self.move_target(true)
            mujoco.mj_kinematics(self._model, self._data)

    # reading -------------------------------------------------------------------------------------------------------

    @property
    def hand_limits(self) -> tuple[Vector, Vector]:
        """Lowest and highest position of the hand's goal, metres."""
        return self._world.hand_limits

    @property
    def configuration(self) -> SpatialConfiguration:
        """The configuration as last set: object and target where they were put, the camera where it is."""
        return self._configuration

    def keypoints(self) -> np.ndarray:
        """The keypoint vector in the camera's frame, float32, metres; `keypoint_slices` names its parts."""
        world = np.array([self.point(name) for name in self._keypoint_names])
        return keypoints(world, self._configuration.camera_angle)

    def observe(self) -> np.ndarray:
        """The observation of the present state: keypoints or image."""
        return self.render_image(self.image_size) if self.observation == "rgb" else self.keypoints()

    def render_image(self, size: int) -> np.ndarray:
        """The camera's image, shape (size, size, 3), uint8."""
        self._load_state()
        mujoco.mj_camlight(self._model, self._data)
        return self._world.renderer(size, self.drawing).render(self._data, self._configuration.camera_angle)

    def refresh(self) -> np.ndarray:
        """The observation after something was moved between steps."""
        mujoco.mj_kinematics(self._model, self._data)
        return self.observe()

    def render(self) -> np.ndarray | None:
        """The image that Gymnasium's render mode asks for, or None."""
        return self.render_image(self.image_size) if self.render_mode == "rgb_array" else None

    # keeping -------------------------------------------------------------------------------------------------------

    def __getstate__(self) -> dict[str, Any]:
        """All that is the scene's own: the task by its name where it has one, MuJoCo's state as numbers."""
        physics = np.empty(mujoco.mj_stateSize(self._model, STATE))
        mujoco.mj_getState(self._model, self._data, physics, STATE)
        own = {name: value for name, value in vars(self).items() if name not in OF_THE_PROCESS}
        return own | {"task": self.task.name if TASKS.get(self.task.name) is self.task else self.task,
                      "physics": physics}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Stand where the other scene stood, in this process's model."""
        own = dict(state)
        task, physics = own.pop("task"), own.pop("physics")
        task = task if isinstance(task, Task) else get_task(task)
        super().__init__(task, shared_world(task), own["_target"])
        vars(self).update(own)
        mujoco.mj_setState(self._model, self._data, physics, STATE)
        self._load_state()
        mujoco.mj_kinematics(self._model, self._data)
