"""ADC jumps when the gripper comes near, and to a place that the task allows."""

import math

import pytest

from move.sim.collect import Collection, attempt_seed, collecting_env
from move.sim.experts.phase import make_expert
from move.sim.tasks import TASKS, get_task

NEAR = 0.2  # metres


@pytest.mark.parametrize("name", TASKS)
def test_object_and_target_jump_at_the_first_step_at_which_the_gripper_is_near(name: str) -> None:
    task = get_task(name)
    env = collecting_env(Collection(task=name, method="adc", timesteps=1))
    scene, expert, jumps = env.unwrapped, make_expert("phase", task), []
    for attempt in range(4):
        env.reset(seed=attempt_seed(0, attempt))
        expert.reset()
        jumped: set[str] = set()
        for step in range(150):
            action, phase, before = expert.action(scene), scene.phase, scene.configuration
            fingers = (scene.point("site:leftEndEffector") + scene.point("site:rightEndEffector")) / 2
            goal = scene.point(task.object_point if phase == "pick" else task.target_point)
            near = math.dist(fingers, goal) < NEAR
            env.step(action)
            after = scene.configuration
            moved = {part for part, changed in (("pick", before.object_position != after.object_position),
                                                ("place", before.target_position != after.target_position)) if changed}
            expected = {phase} if near and phase not in jumped and (phase == "pick" or task.has_target) else set()
            assert moved == expected, (attempt, step)
            jumped |= moved
            if phase == "pick" and moved:
                assert task.allows(after, task.separation)
        jumps.append(jumped)
    assert sum("pick" in jumped for jumped in jumps) >= 3  # the expert gets there
