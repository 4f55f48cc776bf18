"""How well places on a table cover it: which are repeated, how many there are in effect, what is next, what to expect.

Two places are as alike as success at their distance is to success on the spot, 1 / (1 + (distance / radius)^steepness)
(`move.statistics.distance`). Lengths are metres.
"""

from __future__ import annotations

import numpy as np

from move.statistics.distance import Curve

SAME_PLACE = 0.015  # places within this of one another are one: as exactly as a hand puts an object back
TICKS = 40  # along each side of the table's part, where holes are looked for and success is expected

Table = tuple[tuple[float, float], tuple[float, float]]
"""The low and the high corner, (x, y) each."""


def repetitions(places: np.ndarray) -> np.ndarray:
    """How many demonstrations each distinct place has, the most repeated first.

    Args:
        places: (N, 2), N at least 1.

    >>> repetitions(np.array([[0.0, 0.0], [0.001, 0.0], [0.1, 0.0]])).tolist()
    [2, 1]
    """
    from scipy.cluster.hierarchy import fcluster, linkage  # slow to import

    if len(places) == 1:
        return np.ones(1, int)
    labels = fcluster(linkage(places, "complete"), SAME_PLACE, "distance")
    return np.sort(np.unique(labels, return_counts=True)[1])[::-1]


def in_words(counts: np.ndarray) -> str:
    """Repetitions by the name that people give them.

    >>> in_words(np.array([10, 10, 10, 10, 10])), in_words(np.ones(50, int)), in_words(np.array([9, 2, 1]))
    ('5 places x 10', '50 places, each once', '3 places, of which 2 repeated, up to 9 times')
    """
    noun = f"{len(counts)} place{'s' * (len(counts) > 1)}"
    if counts.max() == 1:
        return f"{noun}, each once"
    if counts.min() > 1 and counts.max() - counts.min() <= 1:
        return f"{noun} x " + "-".join(map(str, sorted({int(counts.min()), int(counts.max())})))
    return f"{noun}, of which {(counts > 1).sum()} repeated, up to {counts.max()} times"


def effective_number(places: np.ndarray, curve: Curve) -> float:
    """How many places that teach nothing of one another say as much: N for N far apart, 1 where all are alike.

    Simpson's diversity of alike things (Leinster and Cobbold 2012, of order 2).

    >>> far, near = Curve(1.0, (0.05,), 4.0), np.zeros((10, 2))
    >>> round(effective_number(np.array([[0.0, 0.0], [9.0, 0.0]]), far), 2), effective_number(near, far)
    (2.0, 1.0)
    """
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    return float(1 / curve.left(apart).mean())


def spanned(places: np.ndarray) -> Table | None:
    """The part of the table that places span; None where all are one place or on one line, to `SAME_PLACE`.

    >>> spanned(np.array([[0.0, 0.0], [0.1, 0.1], [0.2, 0.2]])), spanned(np.array([[0.0, 0.0], [0.1, 0.1], [0.2, 0.0]]))
    (None, ((0.0, 0.0), (0.2, 0.1)))
    """
    low, high = places.min(axis=0), places.max(axis=0)
    across = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)[2][-1]  # the line's normal
    if len(places) < 3 or np.ptp(places @ across) <= SAME_PLACE:
        return None
    return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))


def ticks(table: Table) -> np.ndarray:
    """The centres of `TICKS` times `TICKS` equal cells of a rectangle, (cells, 2)."""
    share = (np.arange(TICKS) + 0.5) / TICKS
    x, y = (low + share * (high - low) for low, high in zip(*table, strict=True))
    return np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)


def nearest(points: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Distance from each of (K, 2) points to the nearest of (N, 2) places, (K,)."""
    from scipy.spatial import cKDTree  # slow to import

    return cKDTree(places).query(points)[0]


def inside(places: np.ndarray, table: Table) -> int:
    """How many of (N, 2) places lie in a rectangle or on its sides."""
    low, high = np.array(table)
    return int(((places >= low) & (places <= high)).all(axis=1).sum())


def next_places(places: np.ndarray, table: Table, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Where to put the next demonstrations: each in the middle of the largest hole that those before it leave.

    Returns:
        (count, 2) places, and how far each is from the nearest of those before it, (count,): the holes' radii.

    >>> table = ((0.0, 0.0), (1.0, 1.0))
    >>> [part.round(1).tolist() for part in next_places(np.array([[0.0, 0.0]]), table, 1)]
    [[[1.0, 1.0]], [1.4]]
    """
    points = ticks(table)
    left, chosen, radii = nearest(points, places), [], []
    for _ in range(count):
        place = int(left.argmax())
        chosen.append(points[place])
        radii.append(left[place])
        left = np.minimum(left, np.linalg.norm(points - points[place], axis=1))
    return np.array(chosen).reshape(-1, 2), np.array(radii)


def expected_success(places: np.ndarray, table: Table, curve: Curve) -> float:
    """Mean success over the table that the curve says after demonstrations at these places.

    >>> round(expected_success(np.array([[0.5, 0.5]]), ((0.0, 0.0), (1.0, 1.0)), Curve(0.9, (100.0,), 3.0)), 3)
    0.9
    """
    return float(curve.top * curve.left(nearest(ticks(table), places)).mean())
