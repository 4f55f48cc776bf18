"""Success conditions: Meta-World's own and the authors', evaluated on the scene as it is, wherever it was moved.

    near             a point close enough to another: Pick-Place, Push, Pick-Place-Wall, Faucet-Open
    closed           a lid on its box: Box-Close
    around           a ring around a peg, under its top: Assembly
    joint_beyond     a joint far enough: Hammer, Window-Open
    higher           a point lifted: Disassembly
    in_hoop          the ball at the hoop: Basketball
    both, touching   Hammer's strict condition, which Meta-World does not have
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from move.sim.geometry import past, wrapped

if TYPE_CHECKING:
    from move.sim.scene.scene_state import Readable

Success = Callable[["Readable"], bool]


def near(point: str, target: str, distance: float) -> Success:
    """Success condition: `point` is at most `distance` metres from `target`."""

    def condition(scene: Readable) -> bool:
        return math.dist(scene.point(point), scene.point(target)) <= distance

    return condition


def closed(lid: str, box: str, height: float, above: float, aside: float, yaw: float) -> Success:
    """Success condition: `lid` is on `box`, and as the box is turned (the authors' rule for Box-Close).

    Args:
        height: of a lid that is on, metres above the table's zero.
        above: largest distance from that height, metres.
        aside: largest distance from the box in the plane, metres.
        yaw: largest angle between lid and box, radians; a lid turned by half a turn is on as well.
    """

    def condition(scene: Readable) -> bool:
        (x, y, z), (box_x, box_y, _) = scene.point(lid).tolist(), scene.point(box).tolist()
        placed = abs(z - height) < above and math.hypot(x - box_x, y - box_y) < aside
        return placed and abs(wrapped(scene.object_yaw, math.pi)) < yaw

    return condition


def around(ring: str, top: str, distance: float) -> Success:
    """Success condition: `ring` is less than `distance` metres from `top` in the plane, and lower."""

    def condition(scene: Readable) -> bool:
        x, y, z = (scene.point(top) - scene.point(ring)).tolist()
        return math.hypot(x, y) < distance and z > 0.0

    return condition


def joint_beyond(joint: str, position: float) -> Success:
    """Success condition: `joint` is beyond `position` (metres or radians), on the side of its sign."""

    def condition(scene: Readable) -> bool:
        return past(scene.joint(joint), position) > 0

    return condition


def higher(point: str, height: float) -> Success:
    """Success condition: `point` is more than `height` metres above the table's zero."""

    def condition(scene: Readable) -> bool:
        return float(scene.point(point)[2]) > height

    return condition


def in_hoop(ball: str, hoop: str, height: float, distance: float) -> Success:
    """Success condition: `ball` at most `distance` metres from the hoop's middle at `height`, z counted twice."""

    def condition(scene: Readable) -> bool:
        (x, y, z), (hoop_x, hoop_y, _) = scene.point(ball).tolist(), scene.point(hoop).tolist()
        return math.hypot(x - hoop_x, y - hoop_y, 2 * (z - height)) <= distance

    return condition


def both(first: Success, second: Success) -> Success:
    """Success condition: both hold in the same step."""

    def condition(scene: Readable) -> bool:
        return first(scene) and second(scene)

    return condition


def touching(first: str, second: str) -> Success:
    """Success condition: `first` and `second`, bodies or parts of them, are in contact."""

    def condition(scene: Readable) -> bool:
        return scene.touches(first, second)

    return condition
