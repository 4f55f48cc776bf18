"""Scripted experts that work in phases with hysteresis, and the table of all experts.

An expert reads the scene and returns the next action. Each phase ends on one condition and is left backwards only on a
clearly worse one. The phase expert closes the loop on the object it holds, so a slip of the grip is corrected rather
than mistaken for a loss; Meta-World's policies (`move.sim.experts.metaworld`) decide afresh at every step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np

from move.errors import one_of
from move.sim.configuration import Vector, vector
from move.sim.experts.metaworld import MetaworldExpert
from move.sim.geometry import past, shifted, turned, wrapped
from move.sim.scene.scene import YAW_STEP, Scene
from move.sim.tasks.task import GraspParameters, PushParameters, Task
from move.sim.tasks.transport import TransportState

GAIN = 15.0  # action per metre of error
PUSH_GAIN = 25.0  # the same while a handle is worked
ABOVE = 0.08  # metres over the grip height while approaching
CLIMB = 0.08  # metres under the approach height at which the hand first goes up
ASKEW = math.radians(8.0)  # radians between gripper and object at which a grip may begin


class Expert(Protocol):
    """Whatever demonstrates a task."""

    def reset(self) -> None:
        """Forget the last episode."""

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (action_size,), float32."""


def towards(goal: Vector, hand: Vector, gain: float) -> list[float]:
    """Displacement of the hand's goal in [-1, 1] that takes the hand (metres) to `goal` (metres)."""
    return [min(1.0, max(-1.0, gain * (there - here))) for there, here in zip(goal, hand, strict=True)]


class GraspExpert:
    """Approach from above, descend, close, transport; a dropped object starts it over.

    In transport the hand moves by the distance between the held object and where it should be. Where the task turns
    the gripper, it follows the object's yaw until it has closed.
    """

    def __init__(self, task: Task, parameters: GraspParameters) -> None:
        self.task, self.parameters = task, parameters
        self.offsets = (self.parameters.offset, *self.parameters.otherwise)
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self.phase, self.count, self.offset = "approach", 0, self.parameters.offset
        self.transport_state: TransportState = set()

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (action_size,), float32."""
        hand, held = vector(scene.hand), vector(scene.point(self.task.object_point))
        grip = self._grip_point(scene, held)
        aside, above = math.dist(hand[:2], grip[:2]), hand[2] - held[2] - self.parameters.height
        turn = self._turn_to_object(scene)
        self._change_phase(aside, above, abs(turn) < ASKEW)
        if self.phase == "transport":
            waypoint = self.parameters.transport(scene, self.transport_state)
            goal = vector(h + w - o for h, w, o in zip(hand, waypoint.goal, waypoint.held, strict=True))
            turn = waypoint.turn
        else:
            goal = self._goal(hand, held, grip, aside)
        command = self.parameters.opening if self.phase in ("approach", "descend") else self.parameters.gripper_command
        turns = [min(1.0, max(-1.0, turn / YAW_STEP))] if self.task.turns_gripper else []
        return np.array([*towards(goal, hand, GAIN), command, *turns], np.float32)

    def _grip_point(self, scene: Scene, held: Vector) -> Vector:
        if not self.task.has_yaw:
            return shifted(held, self.offset)
        yaw = scene.object_yaw
        if self.phase == "approach" and self.parameters.otherwise:
            nearest = scene.hand_limits[0][1] + 0.005  # metres; how near to the robot the hand can go
            reached = (offset for offset in self.offsets if held[1] + turned(offset, yaw)[1] >= nearest)
            self.offset = next(reached, self.offset)
        return shifted(held, self.offset, yaw)

    def _turn_to_object(self, scene: Scene) -> float:
        """How far the gripper's goal is from the object's yaw (radians); it grips alike turned by half a circle."""
        if not self.task.turns_gripper:
            return 0.0
        return wrapped(scene.object_yaw, math.pi) - scene.gripper_yaw

    def _change_phase(self, aside: float, above: float, square: bool) -> None:
        if self.phase == "transport" and (aside > 0.06 or above > 0.05):
            self.phase, self.transport_state = "approach", set()
        if self.phase == "approach" and aside < 0.015 and square:
            self.phase, self.count = "descend", 0
        if self.phase == "descend":
            self.count += 1
            if aside > 0.03:
                self.phase = "approach"
            elif (above < 0.012 and aside < 0.008) or self.count > self.parameters.patience:
                self.phase, self.count = "close", 0
        if self.phase == "close":
            self.count += 1
            if self.count > self.parameters.closing_steps:
                self.phase = "transport"

    def _goal(self, hand: Vector, held: Vector, grip: Vector, aside: float) -> Vector:
        """Where the hand should go before the transport (metres)."""
        height = held[2] + self.parameters.height
        if self.phase == "close":
            return (grip[0], grip[1], hand[2])
        if self.phase == "descend":
            return (grip[0], grip[1], height - 0.01)
        level = height + ABOVE
        if aside > 0.06:  # come in from above: no need to go down early
            level = max(level, min(hand[2], held[2] + self.parameters.ceiling))
        return (grip[0], grip[1], level)


class PushExpert:
    """Approach from above, descend next to the handle, push it with the closed hand until it is open enough.

    A missed handle starts it over.
    """

    def __init__(self, task: Task, parameters: PushParameters) -> None:
        self.task, self.parameters = task, parameters
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self.phase = "approach"

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (action_size,), float32."""
        hand, handle = vector(scene.hand), vector(scene.point(self.task.object_point))
        yaw = scene.body_yaw(self.parameters.frame)
        start = shifted(handle, self.parameters.offset, yaw)
        aside, above = math.dist(hand[:2], start[:2]), hand[2] - start[2]
        self._change_phase(aside, above)
        done = past(scene.joint(self.parameters.joint), self.parameters.enough) >= 0
        goal = hand if done else self._goal(start, yaw, hand, aside)
        gain = GAIN if self.phase == "approach" else PUSH_GAIN
        return np.array([*towards(goal, hand, gain), 1.0], np.float32)

    def _change_phase(self, aside: float, above: float) -> None:
        if self.phase == "stroke" and (above > 0.06 or aside > self.parameters.lost):
            self.phase = "approach"
        if self.phase == "approach" and aside < 0.02:
            self.phase = "descend"
        if self.phase == "descend":
            if aside > 0.05:
                self.phase = "approach"
            elif above < 0.015:
                self.phase = "stroke"

    def _goal(self, start: Vector, yaw: float, hand: Vector, aside: float) -> Vector:
        """Where the hand should go (metres)."""
        if self.phase == "stroke":
            return shifted(start, self.parameters.stroke, yaw)
        if self.phase == "descend":
            return start
        level = start[2] + self.parameters.above
        if hand[2] < level - CLIMB and aside > 0.06:  # over the object, not through it
            return (hand[0], hand[1], level)
        return (start[0], start[1], max(level, hand[2]) if aside > 0.06 else level)


def phase_expert(task: Task) -> Expert:
    """The expert with phases: one that grasps, or one that works a handle."""
    if isinstance(task.manipulation, GraspParameters):
        return GraspExpert(task, task.manipulation)
    return PushExpert(task, task.manipulation)


EXPERTS: dict[str, Callable[[Task], Expert]] = {"phase": phase_expert, "metaworld": MetaworldExpert}


def make_expert(name: str, task: Task) -> Expert:
    """The expert called `name` for `task`.

    Raises:
        BadInput: an unknown name.
    """
    one_of("expert", name, EXPERTS)
    return EXPERTS[name](task)
