"""ADC, the second baseline: object and target jump to fresh places as the gripper comes near."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, cast

import gymnasium
import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from move.sim.configuration import Vector
from move.sim.tasks import FACTORS, Task

if TYPE_CHECKING:
    from move.sim.scene.scene import Scene

JUMP_DISTANCE = 0.2  # metres between gripper and object or target at which it jumps


class Jumping(BaseModel):
    """When ADC's object and target jump."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    seen_steps: int = Field(
        default=0, ge=0, le=50,
        description="observations of a phase that show a place before what stands there may jump"
    )
    distance_from: Literal["fingers", "held"] = Field(
        default="fingers",
        description="what has to come near the target: the point between the fingers, or what they hold"
    )
    times: int = Field(default=1, ge=1, le=10, description="jumps a phase")
    required: bool = Field(
        default=False, description="whether a demonstration that lacks one of its jumps counts as failed"
    )


MENDED = Jumping(seen_steps=10, distance_from="held", required=True)
"""Every demonstration shows an old place and a new one in each phase. The hand moves 1 cm a step at most, so ten steps
show up to half of the 0.2 m in which it comes near."""

PERIODIC = MENDED.model_copy(update={"times": 2})
"""The same with two jumps a phase: of three, many demonstrations do not get all before they are done."""

JUMPS = {"as printed": Jumping(), "mended": MENDED, "periodic": PERIODIC}
"""Three readings of ADC: one jump a phase within 0.2 m, even at step 0; after ten steps of seeing; twice a phase."""


def jumping_phases(task: Task, factors: str) -> tuple[str, ...]:
    """The phases in which something jumps: "pick" (the object) and, where the target is random, "place" (the target).

    >>> from move.sim.tasks import get_task
    >>> jumping_phases(get_task("pick-place"), "object")
    ('pick',)
    """
    return ("pick", "place") if "target" in FACTORS[factors] and task.has_target else ("pick",)


class Jumps(gymnasium.Wrapper):
    """ADC: object (pick phase) and target (placement phase) jump to fresh random places, once each by default.

    They do so when the gripper, the point midway between its fingers, comes within 0.2 m. `info["jumps"]` counts the
    jumps of the episode.

    Args:
        env: a scene, wrapped or not.
        factors: what is random: a key of FACTORS.
        jumping: when they jump.
    """

    def __init__(self, env: gymnasium.Env, factors: str = "all", jumping: Jumping | None = None) -> None:
        super().__init__(env)
        self.scene: Scene = cast("Scene", env.unwrapped)
        self.jumping, self.phases = jumping or Jumping(), jumping_phases(self.scene.task, factors)

    def reset(self, **keywords: Any) -> tuple[np.ndarray, dict]:
        """Start an episode with all jumps still to come."""
        self.left = dict.fromkeys(self.phases, self.jumping.times)
        self.jumps, self.seen, self.seen_in = 0, 0, "pick"
        observation, info = self.env.reset(**keywords)
        return observation, info | {"jumps": 0}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict]:
        """Jump if it is time, then step."""
        phase = self.scene.phase
        self.seen = self.seen + 1 if phase == self.seen_in else 1
        self.seen_in = phase
        if self.left.get(phase) and self.seen >= self.jumping.seen_steps and self._near(phase):
            self.left[phase] -= 1
            self.seen = 0
            self.jumps += self._jump(phase)
        observation, reward, terminated, truncated, info = self.env.step(action)
        return observation, reward, terminated, truncated, info | {"jumps": self.jumps}

    def _near(self, phase: str) -> bool:
        scene, task = self.scene, self.scene.task
        there = scene.point(task.object_point if phase == "pick" else task.target_point)
        if phase == "place" and self.jumping.distance_from == "held":
            return math.dist(scene.point(task.placed_point or task.object_point), there) < JUMP_DISTANCE
        fingers = (scene.point("site:leftEndEffector") + scene.point("site:rightEndEffector")) / 2
        return math.dist(fingers, there) < JUMP_DISTANCE

    def _jump(self, phase: str) -> bool:
        """Move the object or the target; False where a thousand samples gave no allowed place."""
        scene, task = self.scene, self.scene.task
        for _ in range(1000):
            sampled = task.sample(scene.np_random, "object" if phase == "pick" else "object+target")
            if phase == "place":
                if self._clear(sampled.target_position):
                    scene.move_target(sampled.target_position)
                    return True
                continue
            kept = replace(scene.configuration, object_position=sampled.object_position, object_yaw=sampled.object_yaw)
            if task.allows(kept, task.separation):
                scene.move_object(kept.object_position, kept.object_yaw)
                return True
        return False

    def _clear(self, place: Vector) -> bool:
        """Whether a target at `place` would not appear inside the object or the hand that holds it."""
        least = self.scene.task.jump_clearance
        points = (self.scene.point(self.scene.task.object_point), self.scene.hand)
        return not least or all(math.dist(point[:2], place[:2]) >= least for point in points)
