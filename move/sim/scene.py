"""The scene: a Meta-World task whose spatial configuration is set on reset and can be moved while it runs.

This is the only file that touches MuJoCo's model and data. Meta-World supplies the model, its starting pose and the
limits of the hand; stepping, success and observation happen here, without Meta-World's rewards and samplers.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import gymnasium
import mujoco
import numpy as np
from gymnasium.spaces import Box as BoxSpace
from metaworld.env_dict import ALL_V3_ENVIRONMENTS

from move.errors import BadInput
from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.observe import LANDMARKS, Painter, keypoint_names, keypoint_slices, keypoints
from move.sim.tasks import Mount, Task, get_task

OBSERVATIONS = ("keypoints", "rgb")
EPISODE_STEPS = 200  # the authors' limit
SUCCESS_STEPS = 10  # an episode ends after this many successful steps (the authors' rule)
HAND_STEP = 0.01  # metres that the hand's goal moves for an action of 1
SUBSTEPS = 5  # MuJoCo steps an environment step, as in Meta-World
SETTLE_STEPS = 50  # environment steps given to the hand to reach its start, as in Meta-World
REACH = 0.3  # metres between hand and object beyond which contacts are not looked up
DOWN = np.array([1.0, 0.0, 1.0, 0.0]) / np.sqrt(2.0)  # orientation of a hand that points down
OBJECT, LEFT, RIGHT, PALM = 1, 2, 3, 4  # what a contact is between


class World:
    """A task's compiled model, shared by all its scenes (its meshes take 21 MB).

    Each scene writes its own target into the model before it steps or draws (`claim`), so scenes of one task can be
    stepped in turn within one thread.
    """

    def __init__(self, task: Task) -> None:
        environment = ALL_V3_ENVIRONMENTS[task.metaworld]()
        environment._set_task_called, environment._freeze_rand_vec = True, False
        environment.reset()
        self.model: mujoco.MjModel = environment.model
        self.start = environment.init_qpos.copy()
        self.hand_low, self.hand_high = environment.mocap_low.tolist(), environment.mocap_high.tolist()
        self.owner: Scene | None = None
        self.sides = self._contact_sides(task)
        self._painters: dict[int, Painter] = {}

    def painter(self, size: int) -> Painter:
        """The painter for pictures of `size` pixels, made once."""
        if size not in self._painters:
            self._painters[size] = Painter(self.model, size)
        return self._painters[size]

    def joint_addresses(self, body: str) -> tuple[int, int]:
        """Where the free joint of `body` stands in the positions and in the velocities."""
        joint = self.model.body(body).jntadr[0]
        return int(self.model.jnt_qposadr[joint]), int(self.model.jnt_dofadr[joint])

    def _contact_sides(self, task: Task) -> list[int]:
        """For each geom whether it is the object's, a finger's or the hand's (0 for all others)."""
        owners = {"leftclaw": LEFT, "leftpad": LEFT, "rightclaw": RIGHT, "rightpad": RIGHT, "hand": PALM}
        bodies = {self.model.body(name).id: side for name, side in owners.items()}
        bodies[self.model.body(task.object_mounts[0].name).id] = OBJECT
        return [self._side(int(body), bodies) for body in self.model.geom_bodyid]

    def _side(self, body: int, sides: dict[int, int]) -> int:
        while body and body not in sides:
            body = int(self.model.body_parentid[body])
        return sides.get(body, 0)


@cache
def shared_world(task: Task) -> World:
    """The world of `task`, compiled once a process."""
    return World(task)


class Scene(gymnasium.Env):
    """A task of the paper as a Gymnasium environment whose object, target and camera can be moved at any time.

    Actions are four numbers in [-1, 1]: three displacements of the hand's goal (1 = 0.01 m) and the gripper's effort.
    An observation is the keypoint vector (float32, metres, camera frame) or an RGB picture (uint8). The reward is 1
    on a successful step. The episode limit is left to Gymnasium's TimeLimit and to the loops of this package.

    Args:
        task: a name in `move.sim.tasks.TASKS`.
        observation: "keypoints" or "rgb".
        image_size: pixels along each side of a picture.
        render_mode: None or "rgb_array".

    Raises:
        BadInput: an unknown task or observation, or "rgb" without a GL library.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 80}

    def __init__(self, task: str | Task = "pick-place", observation: str = "keypoints", image_size: int = 96,
                 render_mode: str | None = None) -> None:
        if observation not in OBSERVATIONS:
            raise BadInput(f"observation: {observation!r} given; allowed are {', '.join(OBSERVATIONS)}")
        self.task = task if isinstance(task, Task) else get_task(task)
        self.observation, self.image_size, self.render_mode = observation, image_size, render_mode
        self._world = shared_world(self.task)
        self._model, self._data = self._world.model, mujoco.MjData(self._world.model)
        self._target = np.zeros(3)
        self._points: dict[str, np.ndarray] = {"target": self._target}
        self._keypoint_names = keypoint_names(self.task.keypoints)
        self.keypoint_slices = keypoint_slices(self.task.keypoints)
        self.action_space = BoxSpace(-1.0, 1.0, (4,), np.float32)
        self.observation_space = self._observation_space()
        self._configuration = self.task.fixed

    def _observation_space(self) -> BoxSpace:
        if self.observation == "rgb":
            self._world.painter(self.image_size)
            return BoxSpace(0, 255, (self.image_size, self.image_size, 3), np.uint8)
        return BoxSpace(-np.inf, np.inf, (3 * len(self._keypoint_names),), np.float32)

    # starting ------------------------------------------------------------------------------------------------------

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Start an episode in `options["configuration"]`, or in one drawn from `options["factors"]` ("all").

        The hand is driven to its start as Meta-World does, the object held where it belongs.
        """
        super().reset(seed=seed)
        options = options or {}
        configuration = options.get("configuration")
        if configuration is None:
            configuration = self.task.sample(self.np_random, options.get("factors", "all"))
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:] = self._world.start
        self.steps, self.phase, self.touched, self.held, self.success = 0, "pick", False, False, False
        self._configuration = configuration
        self._world.owner = None  # what stands in the model is the last episode's
        self._claim()
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

    def _claim(self) -> None:
        """Write this scene's target into the shared model, unless it is there already."""
        if self._world.owner is not self:
            self._world.owner = self
            self.move_target(self._configuration.target_position)

    # running -------------------------------------------------------------------------------------------------------

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Advance by one step and observe; never terminates by itself (Meta-World's convention)."""
        self.advance(action)
        return self.observe(), float(self.success), False, False, self._info()

    def advance(self, action: np.ndarray) -> None:
        """Advance by one step without observing: the hand's goal moves, MuJoCo runs, success is judged."""
        self._claim()
        dx, dy, dz, effort = (min(1.0, max(-1.0, value)) for value in np.asarray(action, float).tolist())
        low, high = self._world.hand_low, self._world.hand_high
        for axis, change in enumerate((dx, dy, dz)):
            self._mocap[axis] = min(high[axis], max(low[axis], self._mocap[axis] + HAND_STEP * change))
        self._data.mocap_pos[0] = self._mocap
        self._data.ctrl[:] = (effort, -effort)
        mujoco.mj_step(self._model, self._data, nstep=SUBSTEPS)
        mujoco.mj_kinematics(self._model, self._data)
        self.steps += 1
        self._look_up_contacts()
        self.success = self.touched and self.task.success(self)

    def _look_up_contacts(self) -> None:
        """Note whether the hand touches the object and whether both fingers hold it; the first hold ends the pick."""
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
        if self.held:
            self.phase = "place"

    def _info(self) -> dict[str, Any]:
        return {"success": self.success, "phase": self.phase}

    # moving --------------------------------------------------------------------------------------------------------

    def move_object(self, position: Vector, yaw: float) -> None:
        """Put the object at `position` (metres) and `yaw` (radians), at rest."""
        for mount in self.task.object_mounts:
            self._write(mount, position, yaw)
        self._configuration = replace(self._configuration, object_position=tuple(position), object_yaw=yaw)

    def move_target(self, position: Vector) -> None:
        """Put the target at `position` (metres)."""
        self._target[:] = position
        for mount in self.task.target_mounts:
            self._write(mount, position, 0.0)
        self._configuration = replace(self._configuration, target_position=tuple(position))

    def move_camera(self, angle: float) -> None:
        """Put the camera at `angle` (radians) on its cylinder."""
        self._configuration = replace(self._configuration, camera_angle=angle)

    def _write(self, mount: Mount, position: Vector, yaw: float) -> None:
        place = [value + offset for value, offset in zip(position, mount.offset, strict=True)]
        half = (mount.yaw + yaw) / 2
        turn = (np.cos(half), 0.0, 0.0, np.sin(half))
        if mount.kind == "free":
            at, speed = self._world.joint_addresses(mount.name)
            self._data.qpos[at : at + 7] = (*place, *turn)
            self._data.qvel[speed : speed + 6] = 0.0
        elif mount.kind == "site":
            self._model.site(mount.name).pos = place
        else:
            self._model.body(mount.name).pos = place

    # reading -------------------------------------------------------------------------------------------------------

    @property
    def configuration(self) -> SpatialConfiguration:
        """The configuration as last set: object and target where they were put, the camera where it is."""
        return self._configuration

    @property
    def hand(self) -> np.ndarray:
        """Position of the hand, shape (3,), metres."""
        return self.point("body:hand")

    @property
    def opening(self) -> float:
        """Opening of the gripper from 0 to 1, as Meta-World observes it."""
        gap = self.point("body:rightclaw") - self.point("body:leftclaw")
        return float(min(1.0, max(0.0, np.sqrt(gap @ gap) / 0.1)))

    def point(self, name: str) -> np.ndarray:
        """Position of a named point, shape (3,), metres: "target", "body:NAME", "site:NAME", "geom:NAME".

        The array is a live view: copy it to keep it.
        """
        if name not in self._points:
            self._points[name] = self._view(name)
        return self._points[name]

    def _view(self, name: str) -> np.ndarray:
        if name in LANDMARKS:
            return np.array(LANDMARKS[name])
        kind, element = name.split(":")
        if kind == "site":
            return self._data.site_xpos[self._model.site(element).id]
        if kind == "geom":
            return self._data.geom_xpos[self._model.geom(element).id]
        return self._data.xpos[self._model.body(element).id]

    def keypoints(self) -> np.ndarray:
        """The keypoint vector in the camera's frame, float32, metres; `keypoint_slices` names its parts."""
        world = np.array([self.point(name) for name in self._keypoint_names])
        return keypoints(world, self._configuration.camera_angle)

    def observe(self) -> np.ndarray:
        """The observation of the present state: keypoints or picture."""
        return self.draw(self.image_size) if self.observation == "rgb" else self.keypoints()

    def draw(self, size: int) -> np.ndarray:
        """The camera's picture, shape (size, size, 3), uint8."""
        self._claim()
        mujoco.mj_camlight(self._model, self._data)
        return self._world.painter(size).draw(self._data, self._configuration.camera_angle)

    def refresh(self) -> np.ndarray:
        """The observation after something was moved between steps."""
        mujoco.mj_kinematics(self._model, self._data)
        return self.observe()

    def render(self) -> np.ndarray | None:
        """The picture that Gymnasium's render mode asks for, or None."""
        return self.draw(self.image_size) if self.render_mode == "rgb_array" else None

