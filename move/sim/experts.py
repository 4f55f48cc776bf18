"""Scripted experts: one with phases and hysteresis, and Meta-World's own policies.

An expert reads the scene and returns the next action. The phase expert closes the loop on the object it holds, so a
slip of the grip is corrected rather than mistaken for a loss; Meta-World's policies decide afresh at every step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
from metaworld.policies import ENV_POLICY_MAP

from move.errors import BadInput
from move.sim.configuration import Vector
from move.sim.scene import Scene
from move.sim.tasks import Task

GAIN = 15.0  # action per metre of error
ABOVE = 0.08  # metres over the grip height while approaching


class Expert(Protocol):
    """Whatever demonstrates a task."""

    def reset(self) -> None:
        """Forget the last episode."""

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (action_size,), float32."""


def carry_straight(scene: Scene) -> Vector:
    """Where the object should go next: straight to the target (metres)."""
    return tuple(scene.point("target"))


CARRY: dict[str, Callable[[Scene], Vector]] = {"pick-place": carry_straight}
"""For each task, where the held object should go next."""


class PhaseExpert:
    """Approach from above, descend, close, carry; a dropped object starts it over.

    Each phase ends on one condition and is left backwards only on a clearly worse one (hysteresis). While carrying,
    the hand moves by the distance between the held object and where it should be.
    """

    def __init__(self, task: Task) -> None:
        self.task, self.grip, self.carry = task, task.grip, CARRY[task.name]
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self.phase, self.count = "approach", 0

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (4,), float32."""
        hand, held = scene.hand.tolist(), scene.point(self.task.object_point).tolist()
        grip = [p + o for p, o in zip(held, self.grip.offset, strict=True)]
        aside, above = math.dist(hand[:2], grip[:2]), hand[2] - held[2] - self.grip.height
        self._change_phase(aside, above)
        goal = self._goal(scene, hand, held, grip, aside)
        effort = self.grip.opening if self.phase in ("approach", "descend") else self.grip.effort
        moves = [min(1.0, max(-1.0, GAIN * (there - here))) for there, here in zip(goal, hand, strict=True)]
        return np.array([*moves, effort], np.float32)

    def _change_phase(self, aside: float, above: float) -> None:
        if self.phase == "carry" and (aside > 0.06 or above > 0.05):
            self.phase = "approach"
        if self.phase == "approach" and aside < 0.015:
            self.phase, self.count = "descend", 0
        if self.phase == "descend":
            self.count += 1
            if aside > 0.03:
                self.phase = "approach"
            elif (above < 0.012 and aside < 0.008) or self.count > 30:
                self.phase, self.count = "close", 0
        if self.phase == "close":
            self.count += 1
            if self.count > self.grip.closing_steps:
                self.phase = "carry"

    def _goal(self, scene: Scene, hand: list[float], held: list[float], grip: list[float], aside: float) -> Vector:
        """Where the hand should go (metres)."""
        height = held[2] + self.grip.height
        if self.phase == "carry":
            wanted = self.carry(scene)
            return tuple(h + w - o for h, w, o in zip(hand, wanted, held, strict=True))
        if self.phase == "close":
            return (grip[0], grip[1], hand[2])
        if self.phase == "descend":
            return (grip[0], grip[1], height - 0.01)
        level = height + ABOVE
        if aside > 0.06:  # come in from above: no need to go down early
            level = max(level, min(hand[2], held[2] + 0.3))
        return (grip[0], grip[1], level)


class MetaworldExpert:
    """Meta-World v3's scripted policy, given the observation it was written for."""

    def __init__(self, task: Task) -> None:
        self.task, self.policy = task, ENV_POLICY_MAP[task.metaworld]()

    def reset(self) -> None:
        """Nothing to forget: the policy has no memory."""

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (4,), float32."""
        observation = np.zeros(39)
        observation[:3], observation[3] = scene.hand, scene.opening
        observation[4:7] = scene.point(self.task.object_point)
        observation[36:] = scene.point("target")
        return np.clip(self.policy.get_action(observation), -1.0, 1.0).astype(np.float32)


EXPERTS = {"phase": PhaseExpert, "metaworld": MetaworldExpert}


def make_expert(name: str, task: Task) -> Expert:
    """The expert called `name` for `task`.

    Raises:
        BadInput: an unknown name.
    """
    if name not in EXPERTS:
        raise BadInput(f"expert: {name!r} given; allowed are {', '.join(EXPERTS)}")
    return EXPERTS[name](task)
