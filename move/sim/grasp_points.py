"""Where demonstrations begin or grasp: random configurations, the preliminary experiments' grasp points, or places."""

from __future__ import annotations

import math

import numpy as np

from move.sim.configuration import Box, Disc, Vector, vector
from move.sim.placement import Placement, places
from move.sim.tasks.task import Task

CIRCLE = Disc((-0.05, 0.65), 0.15)  # figure 5; metres
CIRCLE_POINTS = 20
SPARSE_SIDE = 3  # 3 x 3 points, figure 1


def sparse_points(task: Task) -> list[Vector]:
    """Nine grasp points: the centres of a 3 x 3 division of the object's range (metres).

    >>> from move.sim.tasks import get_task
    >>> [round(value, 3) for value in sparse_points(get_task("pick-place"))[0]]
    [-0.15, 0.55, 0.02]
    """
    low, high = task.object_range.low, task.object_range.high
    ticks = [
        [low[axis] + (high[axis] - low[axis]) * (index + 0.5) / SPARSE_SIDE for index in range(SPARSE_SIDE)]
        for axis in (0, 1)
    ]
    return [(x, y, low[2]) for x in ticks[0] for y in ticks[1]]


def circle_points(task: Task) -> list[Vector]:
    """Twenty grasp points evenly on the circle (metres)."""
    angles = [2 * math.pi * index / CIRCLE_POINTS for index in range(CIRCLE_POINTS)]
    (x, y), radius = CIRCLE.centre, CIRCLE.radius
    return [(x + radius * math.cos(a), y + radius * math.sin(a), task.object_range.low[2]) for a in angles]


def grasp_point(
    protocol: str, task: Task, index: int, seed: int, placement: Placement | None = None
) -> Vector | None:
    """Where demonstration `index` has to grasp (metres), the same for every method; None if anywhere ("random").

    Args:
        placement: the places of the protocol "placed".
    """
    if protocol == "random":
        return None
    if placement:
        return places(placement, task.object_range, seed)[index % placement.places]
    if protocol == "dense":
        return task.object_range.sample(np.random.default_rng([index, seed]))
    points = sparse_points(task) if protocol == "sparse" else circle_points(task)
    return points[index % len(points)]


def motion_region(protocol: str, task: Task) -> Box | Disc:
    """Where the object may move: the task's range, or inside the circle (figure 5)."""
    return CIRCLE if protocol == "circle" else task.object_range


def hand_near(task: Task, spread: float, rng: np.random.Generator) -> Vector:
    """A hand's start (metres) from the box of half-side `spread` around the task's fixed hand, within its limits."""
    if not spread:
        return task.fixed.hand_position
    from move.sim.scene.shared_model import shared_world

    place, (low, high) = np.array(task.fixed.hand_position), np.array(shared_world(task).hand_limits)
    return vector(place + rng.uniform(np.maximum(-spread, low - place), np.minimum(spread, high - place)))
