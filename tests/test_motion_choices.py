"""MOVE's motions as one chooses them: how fast each part moves, and which parts move."""

import numpy as np
import pytest
from shared import plan

from move.sim.collect import attempts, collect, surrounded
from move.sim.coverage import configurations
from move.sim.motion.wrappers import Motions
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.study.kinds import policy_run
from move.study.labels import grid
from move.study.profiles import load_profile


def steps(seen, *columns: str) -> np.ndarray:
    """How far a part went in each timestep of each demonstration."""
    places = [rows[list(columns)].to_numpy() for _, rows in seen.groupby("episode")]
    return np.concatenate([np.linalg.norm(np.diff(place, axis=0), axis=1) for place in places])


PARTS = {"object": ("object_x", "object_y"), "target": ("target_x", "target_y", "target_z"),
         "camera": ("camera_angle",)}


@pytest.mark.parametrize("part, usual, other", [
    ("object", 0.03, 0.1), ("target", 0.03, 0.005), ("camera", 0.01745, 0.1)])
def test_a_part_moves_at_most_as_fast_as_is_chosen_and_the_others_as_before(part, usual, other):
    before, after = (configurations(plan(**choice), seed=1) for choice in ({}, {f"{part}_speed": other}))
    assert steps(before, *PARTS[part]).max() <= usual + 1e-4
    fastest = steps(after, *PARTS[part]).max()
    assert fastest <= other + 1e-9 and (fastest > usual) == (other > usual)
    start = after.groupby("episode").first()[["object_x", "target_x", "camera_angle"]]
    assert start.iloc[0].tolist() == before.groupby("episode").first()[list(start)].iloc[0].tolist()


@pytest.mark.parametrize("moving", [("object",), ("target",), ("object", "camera")])
def test_only_what_is_chosen_moves(moving):
    seen = configurations(plan(moving=moving), seed=2)
    for column in PARTS["object"]:  # afterwards the hand has it
        seen[column] = seen[column].where(seen.phase == "pick")
    moved = {part for part, columns in PARTS.items() if np.nanmax(steps(seen, *columns)) > 0}
    assert moved == set(moving)


def test_a_rotation_can_be_left_out_where_there_is_one():
    chosen = plan(task="assembly", moving=("object", "target", "camera"))
    assert chosen.motions_used == Motions(yaw_speed=0.0)
    assert plan(task="assembly", moving=("rotation",)).motions_used == Motions(
        object_speed=0, target_speed=0, camera_speed=0)
    episode = next(attempts(chosen, 0))
    assert episode.grasp.object_yaw == episode.start.object_yaw


def test_a_rotation_turns_as_fast_as_is_chosen():
    usual, fast = (next(attempts(plan(task="assembly", **choice), 0)) for choice in ({}, {"yaw_speed": 0.02}))
    turned = [episode.grasp.object_yaw - episode.start.object_yaw for episode in (usual, fast)]
    assert usual.start == fast.start and abs(turned[1]) > abs(turned[0]) > 0


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


def test_speeds_are_an_axis_and_the_usual_one_reuses_the_run_that_exists():
    smoke = load_profile("smoke")

    def base(**settings):
        return policy_run(smoke, task="push", method="move", seed=0, timesteps=100, **settings)

    runs = grid(base, object_speed=(0.01, 0.03, 0.1))
    assert [run.labels["object_speed"] for run in runs] == [0.01, 0.03, 0.1]
    assert [run.spec.collection.motions_used.object_speed for run in runs] == [0.01, 0.03, 0.1]
    assert runs[1].spec == base() and len({run.spec.hash for run in runs}) == 3


def test_a_profile_can_choose_motions_for_all_its_runs():
    profile = load_profile("smoke").model_copy(
        update={"collection": {"move": {"object_speed": 0.01, "moving": ["object", "target"]}}})
    made = [policy_run(profile, task="push", method=method, seed=0, timesteps=100).collection
            for method in ("static", "move")]
    assert (made[0].object_speed, made[0].moving) == (None, None)
    assert (made[1].object_speed, made[1].moving) == (0.01, ("object", "target"))


def test_the_same_seed_and_choice_collect_the_same_bytes():
    first, second = (collect(plan(object_speed=0.1, timesteps=150), seed=2)[0] for _ in range(2))
    assert np.array_equal(first.observations, second.observations)
