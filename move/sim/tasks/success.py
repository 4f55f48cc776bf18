"""Success conditions: Meta-World's own, evaluated on the scene as it stands, wherever it was moved.

    near             a point close enough to another: Pick-Place, Push, Pick-Place-Wall, Box-Close, Faucet-Open
    around           a ring around a peg, under its top: Assembly
    joint_beyond     a joint far enough: Hammer, Window-Open
    higher           a point lifted: Disassembly
    in_hoop          the ball at the hoop: Basketball
    both, touching   Hammer's strict condition, which Meta-World does not have
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np


class Reading(Protocol):
    """What a success condition may read of a scene."""

    def point(self, name: str) -> np.ndarray:
        """Position of a named point, shape (3,), metres."""

    def joint(self, name: str) -> float:
        """Position of a named joint, metres or radians."""

    def touches(self, first: str, second: str) -> bool:
        """Whether "body:NAME" (all of it) or "body:NAME-GEOM" (but for that geom) is in contact with another."""


Success = Callable[[Reading], bool]


def near(point: str, target: str, distance: float) -> Success:
    """Success condition: `point` is at most `distance` metres from `target`."""

    def condition(scene: Reading) -> bool:
        return math.dist(scene.point(point), scene.point(target)) <= distance

    return condition


def around(ring: str, top: str, distance: float) -> Success:
    """Success condition: `ring` is less than `distance` metres from `top` in the plane, and lower."""

    def condition(scene: Reading) -> bool:
        x, y, z = (scene.point(top) - scene.point(ring)).tolist()
        return math.hypot(x, y) < distance and z > 0.0

    return condition


def joint_beyond(joint: str, position: float) -> Success:
    """Success condition: `joint` is beyond `position` (metres or radians)."""

    def condition(scene: Reading) -> bool:
        return scene.joint(joint) > position

    return condition


def higher(point: str, height: float) -> Success:
    """Success condition: `point` is more than `height` metres above the table's zero."""

    def condition(scene: Reading) -> bool:
        return float(scene.point(point)[2]) > height

    return condition


def in_hoop(ball: str, hoop: str, height: float, distance: float) -> Success:
    """Success condition: `ball` at most `distance` metres from the hoop's middle at `height`, z counted twice."""

    def condition(scene: Reading) -> bool:
        (x, y, z), (hoop_x, hoop_y, _) = scene.point(ball).tolist(), scene.point(hoop).tolist()
        return math.hypot(x - hoop_x, y - hoop_y, 2 * (z - height)) <= distance

    return condition


def both(first: Success, second: Success) -> Success:
    """Success condition: both hold in the same step."""

    def condition(scene: Reading) -> bool:
        return first(scene) and second(scene)

    return condition


def touching(first: str, second: str) -> Success:
    """Success condition: `first` and `second`, bodies or parts of them, are in contact."""

    def condition(scene: Reading) -> bool:
        return scene.touches(first, second)

    return condition
