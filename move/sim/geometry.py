"""Turning vectors and angles about the vertical; radians everywhere."""

from __future__ import annotations

import math

from move.sim.configuration import Vector


def turned(vector: Vector, yaw: float) -> Vector:
    """`vector` turned by `yaw` (radians) about the vertical.

    >>> [round(value, 6) for value in turned((1.0, 0.0, 0.5), math.pi / 2)]
    [0.0, 1.0, 0.5]
    """
    if yaw == 0.0:
        return vector
    cos, sin = math.cos(yaw), math.sin(yaw)
    x, y, z = vector
    return (cos * x - sin * y, sin * x + cos * y, z)


def shifted(point: Vector, vector: Vector, yaw: float = 0.0) -> Vector:
    """`point` plus `vector` turned by `yaw` (radians)."""
    dx, dy, dz = turned(vector, yaw)
    return (point[0] + dx, point[1] + dy, point[2] + dz)


def wrapped(angle: float, period: float = 2 * math.pi) -> float:
    """`angle` moved by whole periods into [-period/2, period/2) (radians).

    >>> wrapped(3.5, 2.0)
    -0.5
    """
    return (angle + period / 2) % period - period / 2


def limited(value: float, limit: float) -> float:
    """`value` cut to [-limit, limit]."""
    return min(limit, max(-limit, value))


def segment_distance(point: tuple[float, float], start: tuple[float, float], direction: tuple[float, float],
                     length: float) -> tuple[float, float]:
    """Distance from `point` to a segment in the plane, and how far along it the nearest place lies (metres).

    >>> segment_distance((1.0, 2.0), (0.0, 0.0), (1.0, 0.0), 5.0)
    (2.0, 1.0)
    """
    x, y = point[0] - start[0], point[1] - start[1]
    along = min(length, max(0.0, x * direction[0] + y * direction[1]))
    return math.hypot(x - along * direction[0], y - along * direction[1]), along


def past(position: float, limit: float) -> float:
    """How far a joint that opens from 0 towards `limit`, of either sign, is past it (metres or radians).

    >>> past(-0.15, -0.1) > 0 > past(0.05, 0.1)
    True
    """
    return math.copysign(1.0, limit) * position - abs(limit)
