"""Where things are: ranges in metres and radians, and the spatial configuration of a scene."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from move.errors import BadInput

Vector = tuple[float, float, float]


def vector(values: Iterable[float]) -> Vector:
    """Three numbers as a Vector.

    >>> vector(np.array([1, 2, 3]))
    (1.0, 2.0, 3.0)
    """
    x, y, z = values
    return float(x), float(y), float(z)


@dataclass(frozen=True)
class Box:
    """An axis-aligned box of positions, `low` to `high`, in metres.

    Raises:
        BadInput: a low above its high.

    >>> Box((0, 0, 0), (1, 1, 0)).contains((0.5, 0.2, 0))
    True
    """

    low: Vector
    high: Vector

    def __post_init__(self) -> None:
        if any(low > high for low, high in zip(self.low, self.high, strict=True)):
            raise BadInput(f"range: low {self.low} is above high {self.high}; allowed is low <= high on every axis")

    @property
    def centre(self) -> Vector:
        """The middle of the box (metres)."""
        return vector((low + high) / 2 for low, high in zip(self.low, self.high, strict=True))

    def contains(self, position: Vector, margin: float = 1e-9) -> bool:
        """Whether `position` (metres) lies inside, up to `margin` metres."""
        return all(
            low - margin <= value <= high + margin
            for low, value, high in zip(self.low, position, self.high, strict=True)
        )

    def sample(self, rng: np.random.Generator) -> Vector:
        """A position drawn uniformly from the box (metres)."""
        return vector(rng.uniform(self.low, self.high))

    def reflect(self, position: Vector) -> Vector:
        """Fold a position that ran past the limits back into the box, as a bounce does (metres)."""
        return vector(
            reflect(value, low, high) for value, low, high in zip(position, self.low, self.high, strict=True)
        )


@dataclass(frozen=True)
class Disc:
    """A disc of positions in the table's plane: `centre` (x, y) and `radius`, in metres.

    Raises:
        BadInput: a radius that is not positive.
    """

    centre: tuple[float, float]
    radius: float

    def __post_init__(self) -> None:
        if not self.radius > 0:
            raise BadInput(f"disc: radius {self.radius} m; allowed is a radius above 0")

    def contains(self, position: Vector, margin: float = 1e-9) -> bool:
        """Whether `position` (metres; z is ignored) lies inside, up to `margin` metres."""
        return math.hypot(position[0] - self.centre[0], position[1] - self.centre[1]) <= self.radius + margin


@dataclass(frozen=True)
class SpatialConfiguration:
    """Everything that the paper varies: object pose, target position, hand and camera.

    Positions in metres in Meta-World's world frame, angles in radians. The yaw is relative to the pose that stock
    Meta-World uses. A task without a separate target ignores `target_position`.
    """

    object_position: Vector
    target_position: Vector
    hand_position: Vector
    camera_angle: float
    object_yaw: float = 0.0

    def columns(self) -> dict[str, float]:
        """One number a column: object_x ... hand_z in metres, object_yaw and camera_angle in radians."""
        parts = {"object": self.object_position, "target": self.target_position, "hand": self.hand_position}
        columns = {f"{name}_{axis}": float(value)
                   for name, position in parts.items() for axis, value in zip("xyz", position, strict=True)}
        return columns | {"object_yaw": float(self.object_yaw), "camera_angle": float(self.camera_angle)}


def reflect(value: float, low: float, high: float) -> float:
    """Fold `value` into [low, high] as a point that moves on a line and bounces at both ends.

    >>> reflect(1.25, 0.0, 1.0), reflect(-0.25, 0.0, 1.0), reflect(0.5, 0.0, 1.0)
    (0.75, 0.25, 0.5)
    """
    if low <= value <= high:
        return value
    width = high - low
    if width == 0:
        return low
    around = (value - low) % (2 * width)
    return low + (around if around <= width else 2 * width - around)
