"""The 20 configurations a task on which the authors evaluate, as their environments list them, and their rule.

Configuration n takes the n-th entry of every list, each list running round by itself: five x by four y of the object,
20 targets, ten x by four y by five z of the hand, 20 camera angles, 20 yaws. Where their counter is raised between two
parts of a reset, the later parts are ahead by one or two (`ahead`). No Pick-Place-Wall with the wide ranges is in their
code. Push's cameras go all the way round and six of Disassembly's beyond its half of the circle: there their policies
are tried on views that no demonstration showed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from move.errors import BadInput
from move.sim.configuration import Box, SpatialConfiguration, vector
from move.sim.tasks.task import Task

Numbers = Sequence[float] | np.ndarray
COUNT = 20
HAND = ((-0.28, -0.18, -0.13, -0.08, 0.0, 0.08, 0.13, 0.18, 0.23, 0.28), (0.52, 0.54, 0.56, 0.58),
        (0.22, 0.26, 0.30, 0.34, 0.38))  # metres
CENTRE = ((-0.18, -0.115, -0.05, 0.015, 0.08), (0.52, 0.607, 0.693, 0.78))  # of Pick-Place's object; metres
WRENCH = ((-0.32, -0.21, -0.1, 0.01, 0.13), (0.52, 0.57, 0.62, 0.68))  # metres
TURNS = (-55, -50, -45, -40, -35, -30, -25, -15, -10, -5, 0, 10, 15, 25, 30, 35, 40, 45, 50, 55)  # degrees
STEPS = np.arange(1, COUNT + 1) / (COUNT + 1)  # of a range without its ends

GOALS = (  # of Pick-Place; metres
    (-0.1, 0.8, 0.05), (-0.1, 0.8, 0.3), (-0.1, 0.9, 0.05), (-0.1, 0.9, 0.3), (0.1, 0.8, 0.05), (0.1, 0.8, 0.3),
    (0.1, 0.9, 0.05), (0.1, 0.9, 0.3), (0.0, 0.85, 0.175), (-0.05, 0.85, 0.1), (0.05, 0.85, 0.25), (-0.075, 0.8, 0.1),
    (0.075, 0.9, 0.15), (-0.025, 0.85, 0.05), (0.025, 0.85, 0.3), (-0.05, 0.8, 0.15), (0.05, 0.9, 0.2),
    (0.0, 0.83, 0.18), (0.0, 0.87, 0.22), (-0.08, 0.82, 0.28),
)
PUSH_HEIGHTS = (0.01, 0.02, 0.01, 0.02, 0.01, 0.02, 0.01, 0.02, 0.013, 0.015, 0.017, 0.015, 0.015, 0.015, 0.015, 0.012,
                0.014, 0.016, 0.018, 0.016)  # metres; in the plane Push's targets are Pick-Place's
PUSH_CAMERA = tuple(math.pi * part for part in (
    1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 5 / 6, 1, 7 / 6, 5 / 4, 4 / 3, 3 / 2, 5 / 3, 7 / 4, 11 / 6, 0, 1 / 8,
    3 / 8, 5 / 8, 7 / 8))  # radians


@dataclass(frozen=True)
class Lists:
    """What a task's environment lists: places in metres, angles in radians; heights are the task's own."""

    places: Sequence[tuple[float, float]]  # of the object
    camera: Numbers
    targets: Sequence[tuple[float, ...]] = ()  # without a height: the task's
    yaws: Numbers = (0.0,)
    hand: tuple[Numbers, Numbers, Numbers] = HAND
    ahead: int = 0  # of hand and camera, before object and target
    yaw_ahead: int = 0


def _together(xs: Numbers, ys: Numbers) -> list[tuple[float, float]]:
    """The n-th x with the n-th y, both running round."""
    return [(float(xs[n % len(xs)]), float(ys[n % len(ys)])) for n in range(COUNT)]


def _product(box: Box) -> list[tuple[float, float]]:
    """Five x by four y, evenly from 2 cm inside the box, y fastest (metres)."""
    xs, ys = (np.linspace(box.low[axis] + 0.02, box.high[axis] - 0.02, count) for axis, count in ((0, 5), (1, 4)))
    return [(float(x), float(y)) for x in xs for y in ys]


def _lists(task: Task) -> Lists:
    half = math.pi * STEPS
    match task.name:
        case "pick-place":
            return Lists(_together(*CENTRE), half, GOALS, ahead=2)
        case "push":
            hand = ((-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, -0.25, -0.05, 0.25), (0.5, 0.55, 0.6, 0.65),
                    (0.2, 0.25, 0.3, 0.35, 0.4))
            goals = [(x, y, height) for (x, y, _), height in zip(GOALS, PUSH_HEIGHTS, strict=True)]
            return Lists(_together(*CENTRE), PUSH_CAMERA, goals, hand=hand, ahead=2)
        case "assembly":
            targets = _together((-0.28, -0.18, -0.08, 0.02, 0.13), (0.77, 0.81, 0.85, 0.88))
            return Lists(_together(*WRENCH), half, targets, np.radians(TURNS))
        case "box-close":
            return Lists(_product(task.object_range), half[::-1], _product(task.target_range),
                         math.radians(90) * STEPS - math.radians(45), (np.linspace(0.32, 0.48, 10), *HAND[1:]))
        case "hammer":
            places = _together(np.linspace(-0.28, 0.28, 5), np.linspace(0.42, 0.48, 4))
            return Lists(places, half, _product(task.target_range), np.linspace(-math.pi / 3, math.pi / 3, 10))
        case "window-open":
            places = _together((-0.08, -0.03, 0.03, 0.08), (0.62, 0.69, 0.75, 0.82, 0.88))
            yaws = np.radians(146 / 19 * np.arange(COUNT) - 58)
            return Lists(places, half - math.pi / 3, yaws=yaws, hand=(HAND[0], (0.47, 0.49, 0.51, 0.53), HAND[2]),
                         ahead=1, yaw_ahead=1)
        case "faucet-open":
            places = _together((-0.18, -0.08, 0.0, 0.08, 0.18), (0.62, 0.66, 0.79, 0.83))
            return Lists(places, half - math.pi / 2, yaws=np.radians(176 / 20 * np.arange(COUNT) - 178), yaw_ahead=1)
        case "disassemble":
            return Lists(_together(*WRENCH), half, yaws=np.radians(TURNS))
        case "basketball":
            xs = (-0.28, -0.15, 0.0, 0.15, 0.28)
            return Lists(_together(xs, (0.52, 0.57, 0.62, 0.68)), half / 2, _together(xs, (0.82, 0.84, 0.86, 0.88)),
                         ahead=2)
    raise BadInput(f"starts: 'listed' given for {task.name}, of which the authors' code has no list")


def listed_configurations(task: Task) -> list[SpatialConfiguration]:
    """The authors' 20 configurations of a task, positions in metres, angles in radians.

    They do not pass this package's reach and clearance filter: some may be impossible.

    Raises:
        BadInput: no list of that task is published.

    >>> from move.sim.tasks import get_task
    >>> listed_configurations(get_task("pick-place"))[1].object_position
    (-0.115, 0.607, 0.02)
    """
    lists = _lists(task)
    found = []
    for n in range(COUNT):
        object_height, target_height = task.object_range.low[2], task.target_range.low[2]
        x, y = lists.places[n]
        target = (*lists.targets[n], target_height)[:3] if lists.targets else task.fixed.target_position
        late = n + lists.ahead
        hand = vector(values[late % len(values)] for values in lists.hand)
        found.append(replace(
            task.fixed, object_position=(float(x), float(y), object_height),
            target_position=vector(target), hand_position=hand,
            camera_angle=float(lists.camera[late % COUNT]),
            object_yaw=float(lists.yaws[(n + lists.yaw_ahead) % len(lists.yaws)]),
        ))
    return found
