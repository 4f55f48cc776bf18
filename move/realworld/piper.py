"""The AgileX PIPER arm: joint limits and forward kinematics.

The flange is what the arm reports; a gripper's finger tips lie further along the flange's z axis.
"""

from __future__ import annotations

import re

import numpy as np
from scipy.spatial.transform import Rotation

# Joint limits in rad, (6, 2): lowest and highest, from the maker's SDK.
LIMITS_RAD = np.array([[-2.62, 2.62], [0.0, 3.14], [-2.97, 0.0], [-1.75, 1.75], [-1.22, 1.22], [-2.09, 2.09]])

SLACK_RAD = 0.1
ITERATIONS, DOWN_M = 80, 0.15  # of `reach`; what "the flange looks down" weighs against the position

# Modified Denavit-Hartenberg parameters of the maker (firmware S-V1.6-3 on):
# a (m), alpha (rad), d (m), theta offset (rad).
DH = np.array([[0.0, 0.0, 0.123, 0.0], [0.0, -np.pi / 2, 0.0, np.deg2rad(-172.22)],
               [0.28503, 0.0, 0.0, np.deg2rad(-102.78)], [-0.02198, np.pi / 2, 0.25075, 0.0],
               [0.0, -np.pi / 2, 0.0, 0.0], [0.0, np.pi / 2, 0.091, 0.0], ])


def flange_transform(joints_rad: np.ndarray) -> np.ndarray:
    """Pose of the flange in the frame of the arm's base.

    Args:
        joints_rad: (T, 6) rad.

    Returns:
        (T, 4, 4) homogeneous transforms, lengths in m.
    """
    pose = np.broadcast_to(np.eye(4), (len(joints_rad), 4, 4))
    for (a, alpha, d, offset), angle in zip(DH, np.asarray(joints_rad, dtype=float)[:, :6].T, strict=True):
        c, s = np.cos(angle + offset), np.sin(angle + offset)
        ca, sa = np.cos(alpha), np.sin(alpha)
        link = np.zeros((len(c), 4, 4))
        link[:, 0, 0], link[:, 0, 1], link[:, 0, 3] = c, -s, a
        link[:, 1, 0], link[:, 1, 1], link[:, 1, 2], link[:, 1, 3] = s * ca, c * ca, -sa, -d * sa
        link[:, 2, 0], link[:, 2, 1], link[:, 2, 2], link[:, 2, 3] = s * sa, c * sa, ca, d * ca
        link[:, 3, 3] = 1
        pose = pose @ link
    return pose


def forward_kinematics(joints_rad: np.ndarray) -> np.ndarray:
    """Pose of the flange as x, y, z (m) and roll, pitch, yaw (rad, fixed axes x-y-z).

    Args:
        joints_rad: (T, 6) rad.

    Returns:
        (T, 6); NaN where a joint is not finite.
    """
    joints_rad = np.asarray(joints_rad, dtype=float)
    finite = np.isfinite(joints_rad).all(axis=1)
    pose, found = flange_transform(joints_rad[finite]), np.full((len(joints_rad), 6), np.nan)
    if finite.any():
        turned = Rotation.from_matrix(pose[:, :3, :3]).as_euler("xyz")
        found[finite] = np.column_stack([pose[:, :3, 3], turned])
    return found


def reach(points_m: np.ndarray) -> np.ndarray:
    """Joint angles that bring the flange to points, pointing down as far as the limits allow.

    Damped least squares with a numerical Jacobian, all points at once.

    Args:
        points_m: (T, 3), in the frame of the arm's base.

    Returns:
        (T, 6) rad, within `LIMITS_RAD`.
    """
    points_m, down = np.asarray(points_m, dtype=float), DOWN_M
    joints = np.tile([0.0, 1.6, -1.6, 0.0, 0.9, 0.0], (len(points_m), 1))
    joints[:, 0] = np.arctan2(points_m[:, 1], points_m[:, 0])
    down_axis = np.array([0.0, 0.0, -1.0])

    def task(angles: np.ndarray) -> np.ndarray:
        pose = flange_transform(angles)
        return np.hstack([pose[:, :3, 3], down * pose[:, :3, 2]])

    wanted = np.hstack([points_m, np.tile(down * down_axis, (len(points_m), 1))])
    for step in range(ITERATIONS):
        if step == ITERATIONS * 2 // 3:  # the last third cares about the position alone
            down = down * 0.05
            wanted[:, 3:] = down * down_axis
        here = task(joints)
        jacobian = np.stack([(task(joints + 1e-5 * np.eye(6)[j]) - here) / 1e-5 for j in range(6)], axis=2)
        turned = np.swapaxes(jacobian, 1, 2)
        change = np.linalg.solve(turned @ jacobian + 1e-4 * np.eye(6), turned @ (wanted - here)[:, :, None])[:, :, 0]
        joints = np.clip(joints + np.clip(change, -0.3, 0.3), LIMITS_RAD[:, 0], LIMITS_RAD[:, 1])
    return joints


def is_piper(robot: str | None) -> bool:
    """Whether what a data set calls its arm is a PIPER; the longer PIPER-X, -L and -H have other kinematics.

    >>> [is_piper(name) for name in ("piper", "bi_piper_follower", "Cobot Magic", "piper_x", "so100", None)]
    [True, True, True, False, False, False]
    """
    words = set(re.split(r"[^a-z0-9]+", (robot or "").lower()))
    return ("piper" in words or {"cobot", "magic"} <= words) and not words & {"x", "l", "h"}


def outside_limits(joints_rad: np.ndarray) -> float:
    """Share of timesteps with a joint outside PIPER's limits by more than `SLACK_RAD`.

    Args:
        joints_rad: (T, 6) rad.
    """
    low, high = LIMITS_RAD.T
    return float(((joints_rad < low - SLACK_RAD) | (joints_rad > high + SLACK_RAD)).any(axis=1).mean())
