"""Ranges that several tasks share: the authors' own, in metres and radians."""

import math

from move.sim.configuration import Box, SpatialConfiguration, Vector

WIDE_HAND = Box((-0.3, 0.5, 0.2), (0.3, 0.6, 0.4))
NO_TARGET = Box((0.0, 0.8, 0.0), (0.0, 0.8, 0.0))
HALF_CIRCLE = (0.0, math.pi)  # camera angles
SIDE = (-math.pi / 3, 2 * math.pi / 3)  # camera angles
WRENCH = ("site:RoundNut", "site:RoundNut-8", "body:peg+0,0,0.05")  # keypoints: ring, handle, top of the peg


def fixed(object_position: Vector, target_position: Vector = NO_TARGET.low, camera_angle: float = math.pi / 3
          ) -> SpatialConfiguration:
    """What is where while it is not random (metres): Meta-World's hand, the camera at 60 degrees (radians)."""
    return SpatialConfiguration(object_position, target_position, (0.0, 0.6, 0.2), camera_angle)
