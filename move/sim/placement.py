"""Where to place the object for each demonstration: rules that spread so many places over a range."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.choices import PlacementRule
from move.sim.configuration import Box, Vector


class Placement(BaseModel):
    """So many places by a rule; demonstrations take them in order, and from the first again after the last.

    random      each drawn uniformly
    jittered    one in each of as many cells of the same area, in random order
    halton      a scrambled Halton sequence, whose places fill the range evenly however many are used
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    rule: PlacementRule = Field(default="jittered", description="how places are chosen")
    places: int = Field(gt=0, le=10_000, description="how many there are")


def places(placement: Placement, box: Box, seed: int) -> tuple[Vector, ...]:
    """The places in the plane of `box`, at its lowest height (metres), in the order of the demonstrations.

    >>> box = Box((0, 0, 0), (0.3, 0.3, 0.1))
    >>> len(set(places(Placement(places=5), box, seed=0)))
    5
    """
    low, size = np.array(box.low[:2]), np.array(box.high[:2]) - box.low[:2]
    return tuple((float(x), float(y), box.low[2]) for x, y in low + size * _unit(placement, seed))


@cache
def _unit(placement: Placement, seed: int) -> np.ndarray:
    """Places in the unit square, a row each."""
    rng = np.random.default_rng([seed, placement.places, *placement.rule.encode()])
    if placement.rule == "random":
        return rng.random((placement.places, 2))
    if placement.rule == "halton":
        from scipy.stats import qmc  # slow to import

        return qmc.Halton(2, rng=rng).random(placement.places)
    return rng.permutation(_jittered(placement.places, rng))


def _jittered(number: int, rng: np.random.Generator) -> np.ndarray:
    """A place in each of `number` cells: columns as wide as they have cells, so that all cells have the same area."""
    columns = np.array_split(np.arange(number), round(math.sqrt(number)))
    left, found = 0.0, []
    for column in columns:
        cells, width = len(column), len(column) / number
        found.append(np.stack([left + width * rng.random(cells), (np.arange(cells) + rng.random(cells)) / cells], 1))
        left += width
    return np.concatenate(found)


def sheet(
    placement: Placement, box: Box, seed: int, demonstrations: int, speed: float = 0.0, seconds: float = 3.0
) -> list[dict[str, float]]:
    """What to do at a real table: one row a demonstration, in the unit of `box`, angles in degrees.

    Args:
        speed: the largest, in units of `box` a second; above 0 the object moves by MOVE's law, so that after `seconds`
            it is at its place: it starts at start_x, start_y, moves at `speed` towards `direction` (degrees from x
            to y) for `seconds` and bounces at the limits.
    """
    from move.sim.motion import equations

    rng, listed = np.random.default_rng([seed, 1]), places(placement, box, seed)
    rows: list[dict[str, float]] = []
    for number in range(demonstrations):
        place = listed[number % len(listed)]
        row: dict[str, float] = {"demonstration": number + 1, "x": round(place[0], 2), "y": round(place[1], 2)}
        if speed:
            drawn, (x, y, _) = equations.sample_speed(rng, speed), equations.sample_direction(rng, 2)
            start, before = (equations.translate(place, (-drawn * x, -drawn * y, 0.0), time, box)
                             for time in (seconds, seconds - 1e-3))
            turned = math.degrees(math.atan2(before[1] - start[1], before[0] - start[0]))
            row |= {"start_x": round(start[0], 2), "start_y": round(start[1], 2), "direction": round(turned, 1) % 360,
                    "speed": round(drawn, 3), "seconds": seconds}
        rows.append(row)
    return rows
