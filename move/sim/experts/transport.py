"""Where a held object goes next, task by task: what the phase expert does once it has closed the gripper.

Every function reads the scene and returns a `Leg`: a point of what is held, where that point should go, and how far
the gripper should turn meanwhile. The expert moves the hand by the difference, so a slip in the grip is corrected.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from move.sim.configuration import Vector
from move.sim.geometry import limited, shifted, wrapped
from move.sim.scene.scene import Scene

UNWIND_STEP = math.radians(3.0)  # radians the gripper turns a step while it carries
SQUARE_STEP = math.radians(4.0)  # radians the gripper turns a step to bring the hammer square
WALL_TOP = 0.19  # metres, height at which the puck clears the wall
WALL_END = 0.79  # metres, y behind the wall


@dataclass(frozen=True)
class Leg:
    """A point of what is held, where it should go (metres), and the gripper's turn on the way (radians)."""

    held: Vector
    goal: Vector
    turn: float = 0.0


Memory = set[str]
"""What a carry remembers from step to step; empty whenever the object was grasped anew."""

Carry = Callable[[Scene, Memory], Leg]


def _read(scene: Scene, name: str) -> Vector:
    return tuple(scene.point(name).tolist())


def straight(scene: Scene, memory: Memory) -> Leg:
    """Straight to the target."""
    return Leg(_read(scene, scene.task.object_point), _read(scene, "target"))


def along_table(scene: Scene, memory: Memory) -> Leg:
    """To the target along the table, the hand no lower than it may go."""
    held, goal = _read(scene, scene.task.object_point), _read(scene, "target")
    lowest = held[2] + 0.05 - float(scene.hand[2])  # metres; the hand stays at 0.05
    return Leg(held, (goal[0], goal[1], max(goal[2], lowest)))


def over_wall(scene: Scene, memory: Memory) -> Leg:
    """Up in front of the wall, across it, then to the target."""
    held, goal = _read(scene, scene.task.object_point), _read(scene, "target")
    if held[1] >= WALL_END:
        return Leg(held, goal)
    if held[2] < WALL_TOP - 0.02 and held[1] < WALL_END - 0.02:
        return Leg(held, (held[0], held[1], WALL_TOP + 0.03))
    return Leg(held, (goal[0], goal[1], max(held[2], WALL_TOP)))


def into_hoop(scene: Scene, memory: Memory) -> Leg:
    """Up to the height of the hoop, then across to its middle."""
    held, hoop = _read(scene, scene.task.object_point), _read(scene, "body:hooplink")
    if held[2] < 0.295 and math.dist(held[:2], hoop[:2]) > 0.03:
        return Leg(held, (held[0], held[1], 0.33))
    return Leg(held, (hoop[0], hoop[1], 0.315))


def onto_peg(scene: Scene, memory: Memory) -> Leg:
    """The ring up, over the peg and down on it; the wrist unwinds on the way, for the peg is round."""
    ring, top = _read(scene, "site:RoundNut"), _read(scene, "body:peg+0,0,0.05")
    aside = math.dist(ring[:2], top[:2])
    turn = -limited(scene.gripper_yaw, UNWIND_STEP) if ring[2] > 0.09 and aside > 0.03 else 0.0
    if aside <= 0.012 or (aside <= 0.02 and ring[2] <= 0.1):
        return Leg(ring, (top[0], top[1], ring[2] - 0.06), turn)
    if ring[2] < 0.135 and aside > 0.015:
        return Leg(ring, (ring[0], ring[1], 0.17), turn)
    return Leg(ring, (top[0], top[1], 0.15), turn)


def off_peg(scene: Scene, memory: Memory) -> Leg:
    """Straight up."""
    held = _read(scene, scene.task.object_point)
    return Leg(held, shifted(held, (0.0, 0.0, 0.1)))


def onto_box(scene: Scene, memory: Memory) -> Leg:
    """The lid up, over the box and down on it."""
    lid, goal = _read(scene, scene.task.object_point), _read(scene, "target")
    aside = math.dist(lid[:2], goal[:2])
    if lid[2] < 0.125 and aside > 0.05:
        return Leg(lid, (lid[0], lid[1], 0.16))
    return Leg(lid, (goal[0], goal[1], 0.14 if aside > 0.02 else 0.10))


def onto_nail(scene: Scene, memory: Memory) -> Leg:
    """The hammer up, square to the nail, its face in front of it, then straight on."""
    head, nail = _read(scene, "geom:HammerHead"), _read(scene, "body:nail_link")
    face = shifted(head, (0.0, 0.072, 0.0), scene.object_yaw)
    askew = abs(wrapped(scene.object_yaw, math.pi))
    aside, gap = (abs(face[0] - nail[0]), abs(face[2] - nail[2])), nail[1] - face[1]
    if max(aside) > 0.03:
        memory.discard("strike")
    if max(aside) < 0.012 and askew < math.radians(6.0) and gap < 0.12:
        memory.add("strike")
    goal = _hammer_goal(face, head, nail, gap, "strike" in memory)
    return Leg(face, goal, _square(scene) if head[2] > 0.045 else 0.0)


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


CARRIES: dict[str, Carry] = {
    "pick-place": straight,
    "push": along_table,
    "assembly": onto_peg,
    "box-close": onto_box,
    "hammer": onto_nail,
    "pick-place-wall": over_wall,
    "disassemble": off_peg,
    "basketball": into_hoop,
}
"""For each task with a grasp, where the held object goes next."""
