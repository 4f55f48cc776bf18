"""Where a grasped object goes next: what the phase expert does once it has closed the gripper.

    straight      to the target: Pick-Place
    along_table   to the target, low: Push
    over_wall     Pick-Place-Wall
    into_hoop     Basketball
    onto_peg      Assembly
    upwards       off the peg: Disassembly
    onto_box      Box-Close
    onto_nail     Hammer

Each makes a `Transport`, a function of the scene that returns a `Waypoint`: a point of what is held, where that point
should go, and how far the gripper should turn meanwhile. The expert moves the hand by the difference, so a slip in the
grip is corrected. Points are named as in `Scene.point`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from move.sim.configuration import Vector, vector
from move.sim.geometry import limited, shifted, wrapped

if TYPE_CHECKING:
    from move.sim.scene.scene import Scene

UNWIND_STEP = math.radians(3.0)  # radians the gripper turns a step while it brings a ring to its peg
SQUARE_STEP = math.radians(4.0)  # radians the gripper turns a step to bring a hammer square


@dataclass(frozen=True)
class Waypoint:
    """A point of what is held, where it should go (metres), and the gripper's turn on the way (radians)."""

    held: Vector
    goal: Vector
    turn: float = 0.0


TransportState = set[str]
"""What a transport remembers from step to step; empty whenever the object was grasped anew."""

Transport = Callable[["Scene", TransportState], Waypoint]


def read(scene: Scene, name: str) -> Vector:
    """Position of a named point as three numbers (metres)."""
    return vector(scene.point(name))


def straight(held: str) -> Transport:
    """Transport: the point `held` straight to the target."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        return Waypoint(read(scene, held), read(scene, "target"))

    return transport


def along_table(held: str) -> Transport:
    """Transport: the point `held` to the target along the table, the hand no lower than it may go."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here, goal = read(scene, held), read(scene, "target")
        lowest = here[2] + 0.05 - float(scene.hand[2])  # metres; the hand stays at 0.05
        return Waypoint(here, (goal[0], goal[1], max(goal[2], lowest)))

    return transport


def over_wall(held: str, top: float, behind: float) -> Transport:
    """Transport: the point `held` up to the height `top`, across to y = `behind` (metres), then to the target."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here, goal = read(scene, held), read(scene, "target")
        if here[1] >= behind:
            return Waypoint(here, goal)
        if here[2] < top - 0.02 and here[1] < behind - 0.02:
            return Waypoint(here, (here[0], here[1], top + 0.03))
        return Waypoint(here, (goal[0], goal[1], max(here[2], top)))

    return transport


def into_hoop(ball: str, hoop: str) -> Transport:
    """Transport: `ball` up to the height of `hoop`, then across to its middle."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here, there = read(scene, ball), read(scene, hoop)
        if here[2] < 0.295 and math.dist(here[:2], there[:2]) > 0.03:
            return Waypoint(here, (here[0], here[1], 0.33))
        return Waypoint(here, (there[0], there[1], 0.315))

    return transport


def onto_peg(ring: str, top: str) -> Transport:
    """Transport: `ring` up, over the peg's `top` and down on it; the wrist unwinds on the way, for the peg is round."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here, there = read(scene, ring), read(scene, top)
        aside = math.dist(here[:2], there[:2])
        turn = -limited(scene.gripper_yaw, UNWIND_STEP) if here[2] > 0.09 and aside > 0.03 else 0.0
        if aside <= 0.012 or (aside <= 0.02 and here[2] <= 0.1):
            return Waypoint(here, (there[0], there[1], here[2] - 0.06), turn)
        if here[2] < 0.135 and aside > 0.015:
            return Waypoint(here, (here[0], here[1], 0.17), turn)
        return Waypoint(here, (there[0], there[1], 0.15), turn)

    return transport


def upwards(held: str) -> Transport:
    """Transport: the point `held` straight up."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here = read(scene, held)
        return Waypoint(here, shifted(here, (0.0, 0.0, 0.1)))

    return transport


def onto_box(lid: str) -> Transport:
    """Transport: `lid` off the table, across to the target above the box's walls, and down until it is on."""

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        here, goal = read(scene, lid), read(scene, "target")
        aside = math.dist(here[:2], goal[:2])
        if here[2] < 0.02 or (here[2] < 0.125 and 0.05 < aside < 0.2):
            return Waypoint(here, (here[0], here[1], 0.16))
        return Waypoint(here, (goal[0], goal[1], 0.14 if aside > 0.04 else 0.06))

    return transport


def onto_nail(head: str, face: Vector, nail: str) -> Transport:
    """Transport: the hammer up, square to `nail`, its face (`face` metres from its `head`) before it, then straight on.

    The state holds "strike" while the hammer is on its way into the nail.
    """

    def transport(scene: Scene, state: TransportState) -> Waypoint:
        middle, there = read(scene, head), read(scene, nail)
        front = shifted(middle, face, scene.object_yaw)
        askew = abs(wrapped(scene.object_yaw, math.pi))
        aside, gap = (abs(front[0] - there[0]), abs(front[2] - there[2])), there[1] - front[1]
        if max(aside) > 0.03:
            state.discard("strike")
        if max(aside) < 0.012 and askew < math.radians(6.0) and gap < 0.12:
            state.add("strike")
        goal = _hammer_goal(front, middle, there, gap, "strike" in state)
        return Waypoint(front, goal, _square(scene) if middle[2] > 0.045 else 0.0)

    return transport


def _hammer_goal(face: Vector, head: Vector, nail: Vector, gap: float, striking: bool) -> Vector:
    if striking:
        return (nail[0], nail[1] + 0.14, nail[2])
    if gap < 0.03:
        return (face[0], nail[1] - 0.08, max(face[2], nail[2]))
    if head[2] < 0.06:
        return (face[0], face[1], nail[2])
    return (nail[0], nail[1] - 0.07, nail[2])


def _square(scene: Scene) -> float:
    """The turn that brings what is held to yaw 0, by the grip as measured (an integrator would swing)."""
    wanted = -wrapped(scene.object_yaw - scene.hand_yaw, math.pi)
    return limited(wrapped(wanted - scene.gripper_yaw), SQUARE_STEP)
