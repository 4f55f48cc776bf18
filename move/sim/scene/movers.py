"""How what is called by a name in a MuJoCo model is moved: free, sliding, mocap and fixed bodies, sites, cameras."""

from __future__ import annotations

import itertools
import math

import mujoco
import numpy as np

from move.errors import BadInput, one_of
from move.sim.configuration import Box, Vector

Frame = tuple[np.ndarray, np.ndarray, np.ndarray]  # of a body: position (3,), axes as columns (3, 3), quaternion (4,)
KINDS = "sites of the world, and its free, sliding, mocap and fixed bodies"
FREE, SLIDE = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_SLIDE)


def located(model: mujoco.MjModel, data: mujoco.MjData, what: str, name: str) -> tuple[str, int, np.ndarray]:
    """The kind ("body" or "site"), number and live position (metres) of "body:NAME", "site:NAME" or NAME.

    Raises:
        BadInput: the model has none of that name; `what` says what it was wanted for.
    """
    names = {"body": [model.body(number).name for number in range(1, model.nbody)],
             "site": [model.site(number).name for number in range(model.nsite)]}
    kind, _, rest = name.rpartition(":") if name.startswith(("body:", "site:")) else ("", "", name)
    kinds = [kind] if kind else ["body", "site"]
    for kind in kinds:
        if rest and rest in names[kind]:
            number = getattr(model, kind)(rest).id
            return kind, number, (data.xpos if kind == "body" else data.site_xpos)[number]
    one_of(what, name, [each for kind in kinds for each in names[kind] if each])
    raise BadInput(f"{what}: {name!r} given; allowed is the name of a body or of a site")


class Mover:
    """Something that can be put in another place.

    `start` is its position when the episode began, `where` the present one, both (3,), metres; `where` is a live view.
    """

    start: np.ndarray
    where: np.ndarray

    def put(self, position: Vector | np.ndarray, yaw: float) -> None:
        """Put it at `position` (metres) at rest, turned by `yaw` (radians) from its start."""
        raise NotImplementedError

    def put_back(self) -> None:
        """Undo what was written into the model; what is in the data the environment resets itself."""


def stands(model: mujoco.MjModel, body: int) -> bool:
    """Whether nothing can move a body: the world, or what is fixed to it."""
    return not model.body_weldid[body] and model.body_mocapid[model.body_rootid[body]] < 0


def frame_of(data: mujoco.MjData, body: int) -> Frame:
    """Where a body is."""
    return data.xpos[body].copy(), data.xmat[body].reshape(3, 3).copy(), data.xquat[body].copy()


def mover(model: mujoco.MjModel, data: mujoco.MjData, what: str, name: str, within: Box, turns: bool) -> Mover:
    """What moves the body or site called `name` over the range `within`.

    Raises:
        BadInput: no such name, or a body or a site that cannot be moved so; `what` says what it was wanted for.
    """
    kind, number, where = located(model, data, what, name)
    body = number if kind == "body" else int(model.site_bodyid[number])
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    joints = [int(each) for each in model.jnt_type[first : first + count]] if count else []
    mocap = int(model.body_mocapid[body])
    if kind == "body" and joints == [FREE]:
        return FreeBody(model, data, first, where, within)
    if kind == "body" and mocap >= 0:
        return Placed(data.mocap_pos[mocap], data.mocap_quat[mocap], where)
    carrier = int(model.body_parentid[body]) if kind == "body" else body
    if not stands(model, carrier):
        free = (model.body(each).name for each in range(1, model.nbody) if stands(model, model.body_parentid[each]))
        raise BadInput(f"{what}: {name!r} given, which {model.body(carrier).name!r} carries; allowed are {KINDS}: "
                       f"{', '.join(filter(None, free))}")
    if kind == "site":
        model.site_sameframe[number] = 0  # or one that was made at its body's origin stays there, whatever is written
        return Placed(model.site_pos[number], model.site_quat[number], where, frame_of(data, carrier))
    if not joints:
        return Placed(model.body_pos[number], model.body_quat[number], where, frame_of(data, carrier))
    slides = [first + place for place, each in enumerate(joints) if each == SLIDE]
    axes = data.xaxis[slides].T.copy()  # (3, slides), in the world
    reached = axes @ np.linalg.pinv(axes) if slides else np.zeros((3, 3))
    for axis in range(3):
        moves = within.low[axis] < within.high[axis] and math.isfinite(within.low[axis])
        if moves and not np.allclose(reached[axis], np.eye(3)[axis], atol=1e-6):
            raise BadInput(f"{what}: {name!r} given, whose joints do not move it along {'xyz'[axis]}; allowed are "
                           f"{KINDS}, or a box without extent there")
    if turns:
        raise BadInput(f"yaw_range: given with {name!r}, which slides; allowed with bodies that are free, mocap or "
                       "fixed")
    turning = [first + place for place, each in enumerate(joints) if each != SLIDE]
    if turning and (turning[0] < slides[-1] or np.abs(model.jnt_pos[turning]).max() > 1e-6):
        raise BadInput(f"{what}: {name!r} given, which a joint turns before others slide it, or about another point "
                       "than its own; allowed are bodies that slide first")
    _refuse_beyond_joints(model, data, slides, np.linalg.pinv(axes), what, name, within, where)
    return SlidingBody(model, data, slides, axes, where)


def _refuse_beyond_joints(model: mujoco.MjModel, data: mujoco.MjData, slides: list[int], along: np.ndarray, what: str,
                          name: str, within: Box, where: np.ndarray) -> None:
    """Refuse a range that the limits of the joints do not let a body reach, for physics would fight the motion."""
    low, high = (np.where(np.isfinite(corner), corner, where) for corner in (within.low, within.high))
    corners = np.array(list(itertools.product(*zip(low, high, strict=True)))) - where
    for joint, reach in zip(slides, along @ corners.T, strict=True):
        least, most = model.jnt_range[joint] - data.qpos[model.jnt_qposadr[joint]]
        if model.jnt_limited[joint] and (reach.min() < least - 1e-6 or reach.max() > most + 1e-6):
            raise BadInput(f"{what}: {name!r} is to slide from {reach.min():.3f} to {reach.max():.3f} m from where it "
                           f"is; its joint {model.joint(joint).name!r} allows {least:.3f} to {most:.3f}")


class FreeBody(Mover):
    """A body with a free joint: its height and how it lies are left to physics, unless `within` bounds the height."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joint: int, where: np.ndarray, within: Box) -> None:
        at, speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self.where, self.start = where, where.copy()
        self.place, self.quaternion = data.qpos[at : at + 3], data.qpos[at + 3 : at + 7]
        self.velocity, self.yaw = data.qvel[speed : speed + 6], 0.0
        self.flat = math.isinf(within.low[2])

    def put(self, position: Vector | np.ndarray, yaw: float) -> None:
        """Put it there; of what lies in the plane the fall goes on."""
        if self.flat:
            self.place[:2], fall = position[:2], self.velocity[2]
            self.velocity[:] = 0.0
            self.velocity[2] = fall
        else:
            self.place[:], self.velocity[:] = position, 0.0
        if yaw != self.yaw:
            self.quaternion[:], self.yaw = turned(self.quaternion, yaw - self.yaw), yaw


class SlidingBody(Mover):
    """A body of the world on slide joints, such as those of a puck; what is across all of them stays."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, joints: list[int], axes: np.ndarray,
                 where: np.ndarray) -> None:
        self.where, self.start, self.positions, self.speeds = where, where.copy(), data.qpos, data.qvel
        at = model.jnt_qposadr[joints]
        self.origin, self.slides = where.tolist(), list(zip(
            at.tolist(), model.jnt_dofadr[joints].tolist(), data.qpos[at].tolist(), np.linalg.pinv(axes).tolist(),
            strict=True))  # of each joint: its addresses, its position at the start, what a metre along x, y, z adds

    def put(self, position: Vector | np.ndarray, yaw: float) -> None:
        """Put it there."""
        dx, dy, dz = (there - begun for there, begun in zip(position, self.origin, strict=True))
        for at, speed, zero, (along_x, along_y, along_z) in self.slides:
            self.positions[at] = zero + along_x * dx + along_y * dy + along_z * dz
            self.speeds[speed] = 0.0


class Placed(Mover):
    """What is written where it stands: a mocap body, or what is fixed in the world (a body, a site, a camera).

    Args:
        place: the position to write, shape (3,), a view of the model or of the data.
        quaternion: the orientation to write, shape (4,), likewise.
        where: the live position in the world, shape (3,), metres.
        frame: position, axes and quaternion of the body that it is fixed to; the world's by default.
    """

    def __init__(self, place: np.ndarray, quaternion: np.ndarray, where: np.ndarray, frame: Frame | None = None
                 ) -> None:
        self.place, self.quaternion, self.where = place, quaternion, where
        origin, axes, facing = frame or (np.zeros(3), np.eye(3), np.array([1.0, 0.0, 0.0, 0.0]))
        self.start, self.first, self.axes = where.copy(), (place.copy(), quaternion.copy()), axes.T.copy()
        self.offset = self.axes @ origin
        back, up = np.empty(4), np.empty(4)  # the frame's inverse, and the start turned half around
        mujoco.mju_negQuat(back, facing)
        mujoco.mju_mulQuat(up, facing, quaternion)
        self.across = np.empty(4)
        mujoco.mju_mulQuat(self.across, back, turned(up, math.pi))

    def put(self, position: Vector | np.ndarray, yaw: float) -> None:
        """Put it there."""
        self.place[:] = self.axes @ position - self.offset
        if yaw:  # a turn's quaternion is linear in the cosine and the sine of half its angle
            self.quaternion[:] = math.cos(yaw / 2) * self.first[1] + math.sin(yaw / 2) * self.across

    def put_back(self) -> None:
        """Write what stood there when the episode began."""
        self.place[:], self.quaternion[:] = self.first


class Camera:
    """A camera that goes about a vertical axis and on looking at what it looked at.

    One that a body carries is carried along as before; what it goes is meant for where the body was at the start.

    Args:
        name: the camera's.
        around: x and y of the axis, metres.

    Raises:
        BadInput: no camera of that name.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, name: str, around: tuple[float, float]) -> None:
        names = [model.camera(number).name for number in range(model.ncam)]
        if not names:
            raise BadInput(f"camera: {name!r} given; this model has none, so allowed is None")
        one_of("camera", name, names)
        view = model.camera(name)
        frame = frame_of(data, int(view.bodyid[0]))
        self.placed = Placed(view.pos, view.quat, frame[0] + frame[1] @ view.pos, frame)
        x, y, self.height = self.placed.start.tolist()
        self.axis, self.away = around, (x - around[0], y - around[1])

    def put(self, angle: float) -> None:
        """Put it at `angle` (radians) from where the environment has it."""
        cos, sin = math.cos(angle), math.sin(angle)
        (x, y), (away_x, away_y) = self.axis, self.away
        self.placed.put((x + cos * away_x - sin * away_y, y + sin * away_x + cos * away_y, self.height), angle)

    def put_back(self) -> None:
        """Write what the model held when the episode began."""
        self.placed.put_back()


def turned(quaternion: np.ndarray, angle: float) -> np.ndarray:
    """A quaternion turned by `angle` (radians) about the world's vertical."""
    result = np.empty(4)
    mujoco.mju_mulQuat(result, np.array([math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)]), quaternion)
    return result
