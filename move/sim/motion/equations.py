"""Equations 1 to 3 of the paper: how things move, as pure functions of time.

A motion starts somewhere, has a constant velocity and bounces at the limits of its range, so its position at any
time, past or future, is known without stepping through the times between. Time is counted in steps of the
environment. Nothing here knows the simulator.
"""

from __future__ import annotations

import math

import numpy as np

from move.choices import SpeedLaw
from move.sim.configuration import Box, Disc, Vector, reflect, vector

BETA = (2.0, 5.0)  # alpha and beta of every speed's Beta distribution (paper, after equation 1)
MEAN_SPEED = BETA[0] / sum(BETA)  # as a share of the largest, under every law


def sample_speed(rng: np.random.Generator, maximum: float, law: SpeedLaw = "beta") -> float:
    """A speed v * v_max with v ~ Beta(2, 5), in the unit of `maximum` per step (equations 1 to 3).

    The other laws have the same mean, and are ours: "uniform" draws v between 0 and twice the mean, "constant" is the
    mean itself.

    >>> round(sample_speed(np.random.default_rng(0), 0.035, "constant"), 6)
    0.01
    """
    if law == "constant":
        return maximum * MEAN_SPEED
    return maximum * float(rng.beta(*BETA) if law == "beta" else rng.uniform(0.0, 2 * MEAN_SPEED))


def sample_direction(rng: np.random.Generator, dimensions: int) -> Vector:
    """A unit vector, uniform on the circle in the table's plane (2) or on the sphere (3) (equation 1)."""
    if dimensions == 2:
        angle = rng.uniform(0.0, 2.0 * math.pi)
        return (math.cos(angle), math.sin(angle), 0.0)
    normal = rng.normal(size=3)
    return vector(normal / np.linalg.norm(normal))


def sample_sign(rng: np.random.Generator) -> int:
    """The direction of a rotation: -1 or 1, each half of the time (equation 2)."""
    return int(rng.integers(2)) * 2 - 1


def translate(start: Vector, velocity: Vector, time: float, region: Box | Disc) -> Vector:
    """Position after `time` steps of constant velocity, bouncing at the limits of `region` (equation 1).

    Args:
        start: position at time 0, in metres, inside the region.
        velocity: metres per step.
        time: steps; negative times trace the same path backwards.
        region: a box (each axis bounces by itself) or a disc (the motion runs to and fro on its chord).

    >>> x, y, z = translate((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), 7, Box((0, 0, 0), (0.5, 0.5, 0)))
    >>> round(x, 6)
    0.3
    """
    if isinstance(region, Box):
        return region.reflect(vector(p + time * v for p, v in zip(start, velocity, strict=True)))
    speed = math.hypot(velocity[0], velocity[1])
    if speed == 0:
        return start
    direction = (velocity[0] / speed, velocity[1] / speed)
    behind, ahead = chord(start, direction, region)
    along = reflect(time * speed, -behind, ahead)
    return (start[0] + along * direction[0], start[1] + along * direction[1], start[2])


def chord(point: Vector, direction: tuple[float, float], disc: Disc) -> tuple[float, float]:
    """How far (metres) one can go from `point` inside `disc` against and along the unit `direction`."""
    x, y = point[0] - disc.centre[0], point[1] - disc.centre[1]
    middle = -(x * direction[0] + y * direction[1])
    half = math.sqrt(max(0.0, middle**2 - (x * x + y * y) + disc.radius**2))
    return max(0.0, half - middle), max(0.0, half + middle)


def turn(start: float, angular_velocity: float, time: float, low: float, high: float) -> float:
    """Angle after `time` steps of constant angular velocity, bouncing at `low` and `high` (equations 2 and 3).

    Used for the object's yaw and for the camera's angle on its cylinder; all angles in radians, `angular_velocity`
    in radians per step.
    """
    return reflect(start + time * angular_velocity, low, high)
