"""ADC, the second baseline: object and target jump to a fresh place as the gripper comes near, once each."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np

from move.sim.configuration import Vector
from move.sim.scene.scene import Scene

JUMP_DISTANCE = 0.2  # metres between gripper and object or target at which it jumps


class Jumps(gymnasium.Wrapper):
    """ADC: object (pick phase) and target (placement phase) jump once each to a fresh random place.

    They do so when the gripper, the point midway between its fingers, comes within 0.2 m.
    """

    def __init__(self, env: gymnasium.Env, target: bool = True) -> None:
        super().__init__(env)
        self.scene: Scene = env.unwrapped
        self.jumping = {"pick", "place"} if target and self.scene.task.has_target else {"pick"}

    def reset(self, **keywords: Any) -> tuple[np.ndarray, dict]:
        """Start an episode with all jumps still to come."""
        self.left = set(self.jumping)
        return self.env.reset(**keywords)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Jump if it is time, then step."""
        phase = self.scene.phase
        if phase in self.left and self._near(phase):
            self.left.remove(phase)
            self._jump(phase)
        return self.env.step(action)

    def _near(self, phase: str) -> bool:
        point = self.scene.task.object_point if phase == "pick" else self.scene.task.target_point
        fingers = (self.scene.point("site:leftEndEffector") + self.scene.point("site:rightEndEffector")) / 2
        return math.dist(fingers, self.scene.point(point)) < JUMP_DISTANCE

    def _jump(self, phase: str) -> None:
        scene, task = self.scene, self.scene.task
        for _ in range(1000):
            drawn = task.sample(scene.np_random, "object" if phase == "pick" else "object+target")
            if phase == "place":
                if self._clear(drawn.target_position):
                    return scene.move_target(drawn.target_position)
                continue
            kept = replace(scene.configuration, object_position=drawn.object_position, object_yaw=drawn.object_yaw)
            if task.allows(kept, task.separation):
                return scene.move_object(kept.object_position, kept.object_yaw)

    def _clear(self, place: Vector) -> bool:
        """Whether a target at `place` would not appear inside the object or the hand that holds it."""
        least = self.scene.task.jump_clearance
        points = (self.scene.point(self.scene.task.object_point), self.scene.hand)
        return not least or all(math.dist(point[:2], place[:2]) >= least for point in points)
