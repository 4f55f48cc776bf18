"""Meta-World v3's scripted policies, called in the object's frame.

The policies know unturned scenes only. They are shown the scene turned about the hand so that the object stands at yaw
0, and their displacement is turned back. A policy that has a place of its task hard-coded is shown the scene
shifted as well, so that the true place stands where it expects it; everything else in it is relative. Which policy
needs what stands in its task (`Task.scripted_policy`).
"""

from __future__ import annotations

import math

import numpy as np
from metaworld.policies import ENV_POLICY_MAP

from move.sim.configuration import vector
from move.sim.geometry import limited, turned, wrapped
from move.sim.scene.scene import YAW_STEP, Scene
from move.sim.tasks.task import Task

LIFTED = 0.02  # metres over its starting height at which an object counts as lifted
TURN_BACK = math.radians(3.0)  # radians a step


class MetaworldExpert:
    """Meta-World v3's scripted policy, given the observation it was written for."""

    def __init__(self, task: Task) -> None:
        self.task, self.needs, self.policy = task, task.scripted_policy, ENV_POLICY_MAP[task.metaworld]()  # type: ignore[abstract]  # the map holds whole ones
        self.reset()

    def reset(self) -> None:
        """Forget at which height the object started; the policy itself has no memory."""
        self.height: float | None = None

    def action(self, scene: Scene) -> np.ndarray:
        """The next action in [-1, 1], shape (action_size,), float32."""
        yaw = scene.object_yaw if self.task.has_yaw else 0.0
        command = np.clip(self.policy.get_action(self._observation(scene, yaw)), -1.0, 1.0).tolist()
        moves = [limited(part, 1.0) for part in turned(tuple(command[:3]), yaw)]
        turns = [limited(self._turn(scene) / YAW_STEP, 1.0)] if self.task.turns_gripper else []
        return np.array([*moves, command[3], *turns], np.float32)

    def _observation(self, scene: Scene, yaw: float) -> np.ndarray:
        """Meta-World's 39 numbers: hand, opening, object and target, in the object's frame."""
        hand = scene.hand.copy()
        handle = scene.point(self.task.object_point) + self.needs.object_offset
        shift = np.zeros(3)
        if self.needs.hard_coded:
            name, expected = self.needs.hard_coded
            shift = np.array(expected) - _seen(scene.point(name), hand, yaw)
            shift[2] = 0.0
        observation = np.zeros(39)
        observation[:3], observation[3] = hand + shift, scene.opening
        observation[4:7] = _seen(handle, hand, yaw) + shift
        observation[36:] = _seen(scene.point(self.task.target_point), hand, yaw) + shift
        return observation

    def _turn(self, scene: Scene) -> float:
        """How far the gripper should turn: to the object's yaw, or back to 0 with a lifted object that has to be."""
        height = float(scene.point(self.task.object_point)[2])
        self.height = height if self.height is None else self.height
        if self.needs.squares_lifted and height > self.height + LIFTED:
            return -limited(scene.gripper_yaw, TURN_BACK)
        return wrapped(scene.object_yaw, math.pi) - scene.gripper_yaw


def _seen(point: np.ndarray, hand: np.ndarray, yaw: float) -> np.ndarray:
    """`point` (metres) turned by -`yaw` (radians) about `hand`."""
    if yaw == 0.0:
        return point
    return hand + np.array(turned(vector(point - hand), -yaw))
