"""Where the orange is in camera frames, by its colour alone.

Deliberately simple: the centre of all orange pixels. It needs an orange that is the only orange thing in view and
is not hidden, a camera that does not move, and it measures on the image plane. Speeds in m/s need the size of a
pixel on the table, which is right only for a camera that looks straight down; otherwise they are in pixels per second.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.colors import rgb_to_hsv

from move.errors import BadInput
from move.realworld.episode import RobotEpisode
from move.realworld.workspace import grasp_step, stacked

HUE_DEG = (12.0, 45.0)
LEAST_SATURATION, LEAST_VALUE = 0.55, 0.35
LEAST_PIXELS = 6  # with fewer orange pixels the orange counts as hidden
GAP_STEPS = 5  # from one frame that is looked at to the next: a still orange's jitter of a part of a pixel stays small
CELLS_ACROSS = 16  # square cells along an image's width


def orange_mask(frames: np.ndarray) -> np.ndarray:
    """Which pixels are orange.

    Args:
        frames: (..., height, width, 3) uint8, red first.

    Returns:
        (..., height, width) bool: hue 12 to 45 degrees, saturation at least 0.55, value at least 0.35.
    """
    red, green, blue = np.moveaxis(frames, -1, 0)
    mask = (red >= green) & (green >= blue) & (blue <= red // 2)  # all that can be; a hue is slow to compute
    if not mask.any():
        return mask
    hue, saturation, value = rgb_to_hsv(frames[mask] / np.float32(255)).T
    low, high = HUE_DEG
    mask[mask] = (saturation >= LEAST_SATURATION) & (value >= LEAST_VALUE) & (360 * hue >= low) & (360 * hue <= high)
    return mask


def track_orange(frames: np.ndarray) -> np.ndarray:
    """Centre of the orange pixels of each frame.

    Args:
        frames: (T, height, width, 3) uint8.

    Returns:
        (T, 2) float64, row and column in pixels; NaN where hidden.
    """
    mask = np.stack([orange_mask(frame) for frame in frames])  # one at a time: this takes several times the memory
    count = mask.sum(axis=(1, 2)).astype(float)
    rows, columns = np.arange(mask.shape[1]), np.arange(mask.shape[2])
    total = np.column_stack([(mask.sum(axis=2) * rows).sum(axis=1), (mask.sum(axis=1) * columns).sum(axis=1)])
    count[count < LEAST_PIXELS] = np.nan
    return total / count[:, None]


def speeds(centres: np.ndarray, timestamps_s: np.ndarray) -> np.ndarray:
    """Speed between neighbouring frames, (T - 1,), in the unit of `centres` a second; NaN next to a hidden frame."""
    return np.linalg.norm(np.diff(centres, axis=0), axis=1) / np.diff(timestamps_s)


def object_places(episodes: Sequence[RobotEpisode], camera: str) -> pd.DataFrame:
    """Where the orange is in the image, from the start of each episode up to its grasp, every `GAP_STEPS`.

    Args:
        camera: name of a camera; episodes without it, or whose frames cannot be read, are left out.

    Returns:
        One row a frame: method, part, index, step, time_s, row and column (pixels, NaN where hidden), height and
        width of the image.
    """
    pieces = []
    for e in (e for e in episodes if camera in e.cameras):
        end = grasp_step(e.gripper) or e.timesteps
        try:
            there = e.cameras[camera].numbers() >= 0
            numbers = np.array([n for n in range(0, min(end, len(there)), GAP_STEPS) if there[n]], dtype=int)
            frames = e.cameras[camera].read(numbers)
        except BadInput:
            continue  # `checks` names it
        centres = track_orange(frames)
        pieces.append((e, {"step": numbers, "time_s": e.timestamps_s[numbers], "row": centres[:, 0],
                           "column": centres[:, 1], "height": frames.shape[1], "width": frames.shape[2]}))
    return stacked(pieces, ["step", "time_s", "row", "column", "height", "width"])


def object_speeds(places: pd.DataFrame, *, metres_per_pixel: float | None = None) -> pd.DataFrame:
    """Speed of the orange before it is grasped, one row an episode.

    Args:
        places: from `object_places`.
        metres_per_pixel: size of a pixel on the table; None leaves pixels.

    Returns:
        method, part, index, frames (looked at), seen (share with an orange), mean_speed, travelled, unit ("m" or "px";
        speeds are per second). Speeds are NaN where no two neighbouring frames show an orange.
    """
    rows = []
    for (method, part, index), looked in places.groupby(["method", "part", "index"], sort=False):
        centres = looked[["row", "column"]].to_numpy(float) * (metres_per_pixel or 1.0)
        times = looked["time_s"].to_numpy(float)
        pace = pd.Series(speeds(centres, times)).replace(np.inf, np.nan)
        rows.append({
            "method": method, "part": part, "index": index, "frames": len(looked),
            "seen": float(np.isfinite(centres[:, 0]).mean()), "mean_speed": pace.mean(),
            "travelled": (pace * np.diff(times)).sum(min_count=1), "unit": "m" if metres_per_pixel else "px",
        })
    return pd.DataFrame(rows, columns=["method", "part", "index", "frames", "seen", "mean_speed", "travelled", "unit"])


def seen_share(places: pd.DataFrame) -> float:
    """Share of the image's square cells in which the orange was seen at least once; needs no calibration.

    It says how many configurations a policy's camera has seen, but cells no orange can reach count as unseen: compare
    it between methods, do not read it alone.

    Args:
        places: from `object_places`, of one method and one camera.
    """
    seen = places.dropna(subset=["row"])
    if seen.empty:
        return 0.0
    side = float(seen["width"].iloc[0]) / CELLS_ACROSS
    down = int(np.ceil(float(seen["height"].iloc[0]) / side))
    visited = set(zip((seen["row"] // side).astype(int), (seen["column"] // side).astype(int), strict=True))
    return len(visited) / (CELLS_ACROSS * down)
