"""What can be set as the authors have it: hand, camera and target, traced-back steps, failures, drawing, their list."""

import json
import math
from itertools import islice

import numpy as np
import pytest

from move.errors import BadInput
from move.learn.agents import Nothing
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
from move.paper import PAPER_TASKS
from move.sim.collect import CollectionRecord, attempts, collect
from move.sim.collection import Collection
from move.sim.coverage import configurations
from move.sim.scene import camera
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.sim.tasks.listed import listed_configurations
from move.study import stored

TASK = get_task("pick-place")
ANYWHERE = {"task": "pick-place", "timesteps": 600, "factors": "object+hand", "protocol": "sparse", "fixed": "authors"}


def begun(count=12, **changes):
    return list(islice(attempts(Collection(**{**ANYWHERE, **changes}), 0), count))


def test_hands_start_anywhere_in_their_range_alike_for_both_methods():
    static, move = begun(method="static"), begun(method="move", object_steps=35)
    hands = np.array([episode.start.hand_position for episode in static])
    assert [episode.start.hand_position for episode in move] == [tuple(hand) for hand in hands]
    assert all(TASK.hand_range.contains(tuple(hand)) for hand in hands)
    assert (np.ptp(hands, axis=0) > 0.6 * (np.array(TASK.hand_range.high) - TASK.hand_range.low)).all()


@pytest.mark.parametrize("method", ["static", "move"])
def test_camera_and_target_are_where_the_authors_have_them(method):
    for episode in begun(3, method=method):
        assert episode.start.target_position == (0.0, 0.85, 0.2)
        assert camera.position(episode.start.camera_angle) == pytest.approx((0.6, 0.295, 0.8), abs=0.005)


def test_the_object_comes_from_as_many_steps_away_as_asked():
    for steps in (20, 35):
        for episode in begun(6, method="move", object_steps=steps):
            gone = math.dist(episode.start.object_position, episode.grasp.object_position)
            assert 0 < gone <= 0.03 * steps


def test_failures_are_kept_where_asked():
    common = {"task": "assembly", "method": "move", "timesteps": 1200, "expert": "metaworld"}
    without, record = collect(Collection(**common), 0)
    kept, all_of_them = collect(Collection(**common, keep_failures=True), 0)
    assert record.generation_rate < 1 and all_of_them.generation_rate == 1
    assert kept.timesteps == without.timesteps == 1200
    assert max(kept.lengths) == 200 > max(without.lengths)
    seen = configurations(Collection(**common, keep_failures=True), 0)
    assert len(seen) == 1200 and seen.episode.nunique() == kept.episodes


def test_of_a_failure_that_never_grasped_the_record_has_a_start_and_no_grasp():
    start, place = TASK.fixed, TASK.fixed.object_position[:2]
    record = CollectionRecord(2, 2, 20, 10.0, 1.0, [place], 1.0, [start, start], [start], [0, 0], [])
    whole = stored._whole(stored._shortened(json.loads(json.dumps(record.content()))))
    assert {len(column) for column in whole["starts"].values()} == {2}
    assert {len(column) for column in whole["grasps"].values()} == {1}
    assert CollectionRecord(1, 1, 20, 20.0, 1.0, [], 1.0, [start], [], [0], []).content()["grasps"] == {}


# evaluation ------------------------------------------------------------------------------------------------------


def test_a_grid_draws_the_hand_where_it_is_a_factor():
    tried = Evaluation(starts="grid", grid_side=8, factors="object+hand", points="sparse", fixed="authors")
    listed = starts(TASK.variant("authors"), tried)
    assert listed == starts(TASK.variant("authors"), tried) and len(listed) == 64 + 9
    hands = np.array([start.configuration.hand_position for start in listed])
    assert len({tuple(hand) for hand in hands}) == len(hands) and all(map(TASK.hand_range.contains, hands))
    assert {start.configuration.target_position for start in listed} == {(0.0, 0.85, 0.2)}
    places = [start.configuration.object_position for start in listed]
    assert places == [start.configuration.object_position for start in starts(TASK, Evaluation(
        starts="grid", grid_side=8, points="sparse"))]


def test_a_grid_draws_the_hand_near_its_place_where_asked():
    near = starts(TASK, Evaluation(starts="grid", grid_side=6, factors="object", hand_within=0.03))
    aside = np.array([start.configuration.hand_position for start in near]) - TASK.fixed.hand_position
    assert np.abs(aside).max() <= 0.03 and (np.abs(aside).max(axis=0) > 0.02).all()
    alike = starts(TASK, Evaluation(starts="grid", grid_side=6, factors="object"))
    assert {start.configuration.hand_position for start in alike} == {TASK.fixed.hand_position}


def test_an_evaluation_begins_where_the_authors_camera_is():
    angles = []
    evaluate(Nothing(), TASK, Evaluation(starts="grid", grid_side=1, factors="object+hand", fixed="authors"),
             callback=lambda index, scene: angles.append(scene.configuration.camera_angle))
    assert set(angles) == {TASK.authors_fixed.camera_angle}


@pytest.mark.parametrize("name", sorted(set(PAPER_TASKS) - {"pick-place-wall"}))
def test_the_authors_list_has_twenty_configurations_off_the_rim(name):
    task, found = get_task(name), listed_configurations(get_task(name))
    assert len(found) == 20 == len({configuration.hand_position + configuration.object_position
                                    for configuration in found})
    low, high = task.object_range.low, task.object_range.high
    for configuration in found:
        x, y, z = configuration.object_position
        assert low[0] < x and low[1] < y < high[1] and z == low[2]
        assert x < high[0] or name in ("assembly", "disassemble"), "theirs run on to x = 0.13 m"
        assert task.yaw_range[0] <= configuration.object_yaw <= task.yaw_range[1]
        if task.has_target:
            assert all(a <= b <= c for a, b, c in zip(task.target_range.low, configuration.target_position,
                                                      task.target_range.high, strict=True))
    angles = np.array([configuration.camera_angle for configuration in found])
    outside = np.mean((angles < task.camera_range[0]) | (angles > task.camera_range[1]))
    assert outside == {"push": 0.55, "disassemble": 0.3}.get(name, 0.0), "tried where no demonstration's camera stood"


def test_the_list_is_as_the_authors_counters_make_it():
    first, second = listed_configurations(TASK)[:2]
    assert first.object_position == (-0.18, 0.52, 0.02) and second.target_position == (-0.1, 0.8, 0.3)
    assert first.hand_position == (-0.13, 0.56, 0.3) and first.camera_angle == pytest.approx(3 * math.pi / 21)
    box = listed_configurations(get_task("box-close"))
    assert box[1].object_position == pytest.approx((-0.28, 0.42 + 0.02, -0.059))
    assert box[0].camera_angle == pytest.approx(20 * math.pi / 21)


def test_no_list_of_pick_place_wall_is_published():
    with pytest.raises(BadInput, match="pick-place-wall"):
        listed_configurations(get_task("pick-place-wall"))


# drawing ---------------------------------------------------------------------------------------------------------


def test_full_drawing_casts_shadows_and_leaves_plain_images_as_they_were():
    scenes = {drawing: Scene("pick-place", "rgb", 64, drawing=drawing) for drawing in ("plain", "full")}
    before = scenes["plain"].reset(options={"configuration": TASK.fixed})[0]
    full = scenes["full"].reset(options={"configuration": TASK.fixed})[0]
    assert np.abs(full.astype(int) - before).mean() > 5
    assert np.array_equal(scenes["plain"].reset(options={"configuration": TASK.fixed})[0], before)
