"""The paper's motions around any MuJoCo environment."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import gymnasium

from move.errors import BadInput, one_of
from move.sim.configuration import Box, vector
from move.sim.motion.wrappers import SPEEDS, Motions, Part, with_motions
from move.sim.scene.mujoco_scene import MujocoScene, Space, lifted
from move.validation import build

Corners = Sequence[Sequence[float]]  # the lowest and the highest corner of a box, metres
Range = tuple[float, float]
QUARTER = (-math.pi / 4, math.pi / 4)  # radians
NEEDED: dict[Part, str] = {"target": "target", "camera": "camera", "rotation": "yaw_range"}


def moving(
    env: gymnasium.Env, object: str, within: Corners, *,
    target: str | None = None, target_within: Corners | None = None, goal: str | None = None,
    camera: str | None = None, camera_range: Range = QUARTER, camera_around: Range | None = None,
    yaw_range: Range = (0.0, 0.0), clearance: float = 0.0, freeze_distance: float = 0.0,
    object_steps: int = 30, target_steps: int = 200, phase: Callable[[MujocoScene], bool] = lifted,
    **motions: float | str,
) -> gymnasium.Env:
    """`env` with the paper's motions: the object moves until it is grasped, the target from then on, the camera always.

    Each episode draws speeds and directions anew (equations 1 to 3) and starts where `env` starts it. The actions, the
    observations and the rewards stay those of `env`; `info` gets "phase", which is "pick" or "place". The same
    `reset(seed=...)` draws the same motions.

    Args:
        env: a Gymnasium environment with a MuJoCo model.
        object: a body or a site by its name, or "body:NAME" or "site:NAME" where both have it: a free, sliding, mocap
            or fixed body of the world, or a site of the world. A free body's height is left to physics.
        within: where the object moves, ((x, y), (x, y)): the lowest and the highest corner, metres. All starts lie in
            it.
        target: what is moved from the grasp on, named as the object is; by default nothing.
        target_within: where the target moves; with three numbers a corner it moves in height too.
        goal: the attribute of `env.unwrapped` that holds the target's place (3 numbers) and moves with it, such as
            "goal" of Gymnasium-Robotics or "_target_pos" of Meta-World: rewards and observations are made from it.
        camera: a camera by its name, meant for one that stands still without this; by default none moves.
        camera_range: how far it goes about the vertical axis from where `env` has it, radians.
        camera_around: x and y of that axis, metres; by default the middle of `within`.
        yaw_range: how far the object turns from where an episode starts, radians; by default it does not.
        clearance: the least distance in the plane to which the object's motion may bring object and target, metres.
        freeze_distance: the target stands still while the object is nearer to it in the plane, metres.
        object_steps: how many steps the object moves, unless it is grasped before.
        target_steps: the step of the episode from which on the target stands still.
        phase: a function of the scene that ends the pick phase once it is true after a step: `lifted` (2 cm above its
            lowest place), `touched` of `move.sim.scene.mujoco_scene`, or one of your own.
        motions: fields of `Motions`: `object_speed`, `target_speed` (metres per step), `yaw_speed`, `camera_speed`
            (radians per step), each the largest; `speed_law`.

    Raises:
        BadInput: an environment without a MuJoCo model, a name that the model has not, a part that cannot be moved so,
            a range that is none, or a speed of what does not move; at a reset, a start outside its box.
    """
    if not isinstance(env, gymnasium.Env):
        raise BadInput(f"env: {type(env).__name__} given; allowed are Gymnasium environments")
    if (target is None) != (target_within is None):
        raise BadInput("target, target_within: one of them given; allowed are both or neither")
    if goal is not None and target is None:
        raise BadInput(f"goal: {goal!r} given without a target, which marks it; allowed is a goal with a target")
    if not callable(phase):
        raise BadInput(f"phase: {phase!r} given; allowed is a function of the scene, such as `lifted`")
    plane, yaws = _box("within", within, (2,)), _pair("yaw_range", yaw_range)
    moves = {"target": target is not None, "camera": camera is not None, "rotation": yaws != (0.0, 0.0)}
    chosen = _motions(motions, {part for part in NEEDED if not moves[part]})
    optional: dict[str, Any] = {}
    if target_within is not None:
        optional = {"target_range": _box("target_within", target_within), "target_dimensions": len(target_within[0])}
    space = build(Space, object=object, object_range=plane, target=target, goal=goal, camera=camera,
                  camera_range=_pair("camera_range", camera_range),
                  camera_around=_pair("camera_around", camera_around or plane.centre[:2]), yaw_range=yaws,
                  clearance=clearance, freeze_distance=freeze_distance, object_steps=object_steps,
                  target_steps=target_steps, **optional)
    farthest = max(math.dist(one, other) for one in _corners(plane) for other in _corners(space.target_range))
    if target is not None and clearance > farthest:
        raise BadInput(f"clearance: {clearance:g} given; object and target are never more than {farthest:g} m apart")
    moved = with_motions(MujocoScene(env, space, phase), chosen, "all")
    return gymnasium.wrappers.OrderEnforcing(moved, disable_render_order_enforcing=True)


def _corners(box: Box) -> list[tuple[float, float]]:
    """Its four corners in the plane."""
    return [(x, y) for x in (box.low[0], box.high[0]) for y in (box.low[1], box.high[1])]


def _pair(what: str, numbers: Sequence[float]) -> Range:
    try:
        low, high = map(float, numbers)
        if not math.isfinite(low + high):
            raise ValueError
    except (TypeError, ValueError) as error:
        raise BadInput(f"{what}: {numbers!r} given; allowed are two finite numbers") from error
    return low, high


def _motions(chosen: dict[str, float | str], still: set[Part]) -> Motions:
    """The motions with what was chosen, and 0 for what stands still, of which no speed may be chosen."""
    for name in chosen:
        one_of("moving", name, Motions.model_fields)
    for part in still:
        if SPEEDS[part] in chosen:
            raise BadInput(f"{SPEEDS[part]}: given, and no {part} moves; allowed with {NEEDED[part]}")
    return build(Motions, **{SPEEDS[part]: 0.0 for part in still}, **chosen)


def _box(what: str, corners: Corners, dimensions: tuple[int, ...] = (2, 3)) -> Box:
    """The box between two corners (metres), of any height where they have none."""
    try:
        low, high = ([float(value) for value in corner] for corner in corners)
        if len(low) == len(high) and len(low) in dimensions and all(map(math.isfinite, low + high)):
            return Box(vector((*low, -math.inf)[:3]), vector((*high, math.inf)[:3]))
    except (TypeError, ValueError) as error:
        if isinstance(error, BadInput):
            raise BadInput(f"{what}: {error}") from error
    allowed = " or ".join("((x, y), (x, y))" if size == 2 else "((x, y, z), (x, y, z))" for size in dimensions)
    raise BadInput(f"{what}: {corners!r} given; allowed are the lowest and the highest corner, {allowed}, in metres")
