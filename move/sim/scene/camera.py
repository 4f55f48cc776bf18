"""The camera on its cylinder: where it is, how it looks at the scene, where a point is in its frame.

The cylinder is the authors': around the point (0, 0.6, 0.2) m, of radius sqrt(0.6^2 + 0.295^2) = 0.669 m, with the
camera 0.6 m above that point. Only the angle around the vertical axis varies (equation 3).
"""

from __future__ import annotations

import math

import numpy as np

LOOK_AT = (0.0, 0.6, 0.2)  # metres
RADIUS = math.hypot(0.6, 0.295)  # metres
HEIGHT = 0.6  # metres above the point looked at
FIELD_OF_VIEW = math.radians(45.0)  # vertical


def position(angle: float) -> np.ndarray:
    """Position of the camera at `angle` radians, shape (3,), in metres."""
    return np.array(
        [LOOK_AT[0] + RADIUS * math.cos(angle), LOOK_AT[1] + RADIUS * math.sin(angle), LOOK_AT[2] + HEIGHT]
    )


def axes(angle: float) -> np.ndarray:
    """The camera's right, up and forward unit vectors as rows, shape (3, 3)."""
    distance = math.hypot(RADIUS, HEIGHT)
    level, down = RADIUS / distance, HEIGHT / distance
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[-sin, cos, 0.0], [-down * cos, -down * sin, level], [-level * cos, -level * sin, -down]])


def to_camera_frame(points: np.ndarray, angle: float) -> np.ndarray:
    """World points (n, 3) in the camera's frame: right, up and forward distances, (n, 3), in metres.

    >>> to_camera_frame(np.array([LOOK_AT]), 1.0).round(3).tolist()
    [[-0.0, -0.0, 0.898]]
    """
    return (points - position(angle)) @ axes(angle).T
