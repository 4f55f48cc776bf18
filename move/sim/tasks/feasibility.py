"""The reach and clearance filter: which configurations a task can be done in at all.

One predicate a task, data of its registry entry. It is asked wherever a configuration comes about: static starts,
ADC's jumps, MOVE's motions and evaluations alike (`Task.allows`). Why it is needed: the hand is dragged by a soft
weld, whose steady error grows from 4 mm at y = 0.8 m to 7-12 cm at y = 1 m, so a handle far out cannot be pushed;
and an object that starts in contact with its target or with the robot's pedestal is thrown across the table.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.geometry import segment_distance, shifted, turned

Reachable = Callable[[SpatialConfiguration], bool]


def anywhere(configuration: SpatialConfiguration) -> bool:
    """No limit."""
    return True


def within_arm(radius: float, *offsets: Vector) -> Reachable:
    """The points at `offsets` from the object, in its frame, are at most `radius` metres from the robot's axis."""

    def predicate(configuration: SpatialConfiguration) -> bool:
        place, yaw = configuration.object_position, configuration.object_yaw
        return all(math.hypot(*shifted(place, offset, yaw)[:2]) <= radius for offset in offsets)

    return predicate


def beyond(offset: Vector, y_least: float) -> Reachable:
    """The point at `offset` from the object, in its frame, is no nearer to the robot than y = `y_least` metres."""

    def predicate(configuration: SpatialConfiguration) -> bool:
        return shifted(configuration.object_position, offset, configuration.object_yaw)[1] >= y_least

    return predicate


def apart_from(offset: Vector, distance: float) -> Reachable:
    """The object is at least `distance` metres in the plane from the point at `offset` from the target."""

    def predicate(configuration: SpatialConfiguration) -> bool:
        there = shifted(configuration.target_position, offset)
        return math.dist(configuration.object_position[:2], there[:2]) >= distance

    return predicate


def wrench_clear_of_target(length: float, ring: float, ring_gap: float, handle_gap: float) -> Reachable:
    """The target is clear of a wrench whose handle runs `length` metres from the object along its x axis.

    The gap is `ring_gap` metres where the nearest place is within `ring` metres of the object, else `handle_gap`.
    """

    def predicate(configuration: SpatialConfiguration) -> bool:
        direction = turned((1.0, 0.0, 0.0), configuration.object_yaw)[:2]
        distance, along = segment_distance(
            configuration.target_position[:2], configuration.object_position[:2], direction, length
        )
        return distance > (ring_gap if along <= ring else handle_gap)

    return predicate
