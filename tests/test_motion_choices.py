"""MOVE's motions as one chooses them, as data; that parts move so is in test_gymnasium."""

import numpy as np
import pytest
from shared import plan

from move.sim.collect import attempts, surrounded
from move.sim.motion.wrappers import Motions
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task


def test_a_rotation_can_be_left_out_where_there_is_one():
    chosen = plan(task="assembly", moving=("object", "target", "camera"))
    assert chosen.motions_used == Motions(yaw_speed=0.0)
    assert plan(task="assembly", moving=("rotation",)).motions_used == Motions(
        object_speed=0, target_speed=0, camera_speed=0)
    episode = next(attempts(chosen, 0))
    assert episode.grasp.object_yaw == episode.start.object_yaw


@pytest.mark.parametrize("task", ["pick-place", "assembly"])
def test_under_the_constant_law_all_that_moves_is_as_fast_in_every_demonstration(task):
    chosen = plan(task=task, speed_law="constant")
    for seed in range(2):
        scene = Scene(task)
        moving = surrounded(scene, chosen)
        moving.reset(seed=seed)
        found = {}
        while moving is not scene:
            found[type(moving).__name__] = np.linalg.norm(moving.velocity)
            moving = moving.env
        scales = {"ObjectTranslation": 0.03, "TargetTranslation": 0.03, "CameraMotion": Motions().camera_speed}
        if task == "assembly":
            scales["ObjectRotation"] = Motions().yaw_speed * get_task(task).yaw_speed_scale
        assert found == pytest.approx({name: 2 / 7 * most for name, most in scales.items()})


@pytest.mark.parametrize("same", [
    {"speed_law": "beta"},
    {"object_speed": 0.03}, {"target_speed": 0.03}, {"camera_speed": Motions().camera_speed},
    {"moving": ("camera", "object", "target")}, {"moving": ["object", "target", "camera"]},
])
def test_choosing_what_is_so_anyway_is_the_same_collection(same):
    assert plan(**same) == plan() and plan(**same).model_dump(exclude_defaults=True) == plan().model_dump(
        exclude_defaults=True)


def test_without_a_choice_motions_are_what_they_were():
    assert plan().motions_used == Motions()
    given = Motions(object_speed=0.09)
    assert plan(motions=given).motions_used == given
