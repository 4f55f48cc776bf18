"""What a policy sees: keypoints in the camera's frame, or an RGB image rendered in software.

Images use the fast settings unless they are drawn in "full": no shadows, reflections, skybox or multisampling, and
nothing is drawn that lies outside of the picture; the offscreen buffer is no larger than the image. Without a GL
library keypoints still work; `move.machine.gl_problem` says what is missing.
"""

from __future__ import annotations

import atexit
import itertools
import math
import os
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from move.choices import Drawing
from move.errors import BadInput
from move.machine import before_drawing, gl_problem
from move.sim.scene import camera

ObservationKind = Literal["keypoints", "rgb"]
SAMPLES = 4  # of a pixel where images are multisampled, MuJoCo's default
SHADOW_SIZE = 1024  # pixels along a side of the shadow map; MuJoCo's 4096 costs twice the time and looks the same here
NEAR_ENOUGH = 0.001  # metres outside of the picture from which something is out of view
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))  # of a box, in half sides
IMAGE_SIZE = 96  # pixels along a side, where nothing else is chosen


@dataclass(frozen=True)
class ObservationSpec:
    """What is seen of a timestep: keypoints, or an RGB image of `image_size` pixels along each side, drawn in a way."""

    kind: ObservationKind = "keypoints"
    image_size: int = IMAGE_SIZE
    drawing: Drawing = "plain"


KEYPOINTS = ObservationSpec()

ROBOT_POINTS = ("site:rightEndEffector", "site:leftEndEffector", "body:hand")
LANDMARKS = {  # corners of the table's working area: they tell the policy where the camera is
    "landmark:front-left": (-0.6, 0.3, 0.0),
    "landmark:front-right": (0.6, 0.3, 0.0),
    "landmark:back-right": (0.6, 0.9, 0.0),
    "landmark:back-left": (-0.6, 0.9, 0.0),
}


def keypoint_names(task_points: tuple[str, ...]) -> tuple[str, ...]:
    """Names of a task's keypoints in order: robot, task, landmarks; each takes three coordinates."""
    return (*ROBOT_POINTS, *task_points, *LANDMARKS)


def keypoint_slices(task_points: tuple[str, ...]) -> dict[str, slice]:
    """Where each named keypoint stands in the keypoint vector; the slices cover the vector exactly.

    >>> keypoint_slices(("body:obj", "target"))["target"]
    slice(12, 15, None)
    """
    names = keypoint_names(task_points)
    slices = {name: slice(3 * index, 3 * index + 3) for index, name in enumerate(names)}
    covered = [index for part in slices.values() for index in range(part.start, part.stop)]
    assert covered == list(range(3 * len(names))), f"keypoints {names} do not cover their vector once"
    return slices


def keypoints(world_points: np.ndarray, camera_angle: float) -> np.ndarray:
    """World points (n, 3) to the keypoint vector (3 n,) float32: metres to the right, up and forward of the camera."""
    return camera.to_camera_frame(world_points, camera_angle).astype(np.float32).ravel()


class Renderer:
    """Renders square RGB images of any scene that shares one compiled model.

    Args:
        drawing: "plain", or "full" with shadows, reflections, skybox and as many samples a pixel as MuJoCo takes.

    Raises:
        BadInput: no GL library can be used, or the process was forked from one that drew.
    """

    opened_in: ClassVar[int | None] = None  # the process that opened GL

    def __init__(self, model, size: int, drawing: Drawing = "plain") -> None:
        import mujoco

        if problem := gl_problem():
            raise BadInput(problem)
        Renderer.opened_in = Renderer.opened_in or os.getpid()
        _check_process()
        model.vis.quality.offsamples = SAMPLES if drawing == "full" else 0
        model.vis.quality.shadowsize = SHADOW_SIZE
        model.vis.global_.offwidth = model.vis.global_.offheight = size
        model.vis.global_.fovy = math.degrees(camera.FIELD_OF_VIEW)
        before_drawing()
        self._renderer = mujoco.Renderer(model, size, size)
        atexit.register(self._renderer.close)  # before the interpreter takes GL away
        for flag in ("SHADOW", "REFLECTION", "SKYBOX"):
            self._renderer.scene.flags[getattr(mujoco.mjtRndFlag, f"mjRND_{flag}")] = int(drawing == "full")
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        self._camera.lookat[:] = camera.LOOK_AT
        self._camera.distance = math.hypot(camera.RADIUS, camera.HEIGHT)
        self._camera.elevation = -math.degrees(math.atan2(camera.HEIGHT, camera.RADIUS))
        self.boxes = Boxes(model) if drawing == "plain" else None  # what is out of view throws shadows into it

    def render(self, data, camera_angle: float) -> np.ndarray:
        """The image seen from `camera_angle` (radians), shape (size, size, 3), uint8."""
        _check_process()
        self._camera.azimuth = math.degrees(camera_angle) + 180.0
        self._renderer.update_scene(data, camera=self._camera)
        if self.boxes:
            self.boxes.hide_unseen(self._renderer.scene, data, camera_angle)
        return self._renderer.render().copy()


class Boxes:
    """Boxes around a model's geoms and sites, which say what a camera cannot see.

    The robot's meshes have 67,000 faces, and drawing in software costs as much for a face out of view as for others.
    """

    def __init__(self, model) -> None:
        import mujoco

        sites = np.repeat(model.site_size.sum(axis=1, keepdims=True), 3, axis=1)
        middles = np.concatenate([model.geom_aabb[:, :3], np.zeros_like(sites)])
        halves = np.concatenate([model.geom_aabb[:, 3:], sites]) + NEAR_ENOUGH
        self._corners = middles[:, None] + halves[:, None] * CORNERS  # (geoms and sites, 8, 3), metres
        planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
        self._endless = np.concatenate([planes, np.zeros(model.nsite, bool)])
        self._first = {int(mujoco.mjtObj.mjOBJ_GEOM): 0, int(mujoco.mjtObj.mjOBJ_SITE): model.ngeom}
        self._nothing = int(mujoco.mjtGeom.mjGEOM_NONE)

    def hide_unseen(self, scene, data, camera_angle: float) -> None:
        """Leave out of an updated MjvScene what lies beyond one side of the square picture; no pixel changes."""
        unseen = self.unseen(data, camera_angle)
        for geom in scene.geoms[: scene.ngeom]:
            first = self._first.get(geom.objtype)
            if first is not None and unseen[first + geom.objid]:
                geom.type = self._nothing

    def unseen(self, data, camera_angle: float) -> np.ndarray:
        """Which geoms and then sites have all corners of their box beyond one side of the picture: booleans."""
        places = np.concatenate([data.geom_xpos, data.site_xpos])[:, None]
        turns = np.concatenate([data.geom_xmat, data.site_xmat]).reshape(-1, 3, 3)
        corners = self._corners @ turns.transpose(0, 2, 1) + places
        right, up, forward = np.moveaxis(camera.to_camera_frame(corners, camera_angle), -1, 0)
        edge = math.tan(camera.FIELD_OF_VIEW / 2) * forward
        sides = np.stack([right > edge, -right > edge, up > edge, -up > edge])
        return np.asarray(sides.all(axis=2).any(axis=0)) & ~self._endless


def _check_process() -> None:
    """Refuse to draw in a fork of a process that drew: GL's threads are not in it, and it would wait for ever."""
    if Renderer.opened_in != os.getpid():
        raise BadInput("images were drawn before this process was forked; allowed is to spawn it (context='spawn') "
                       "or to draw nothing before")
