"""The hand's start in the preliminary protocols: alike by default, or a place of its own for each demonstration."""

from functools import partial
from itertools import islice

import numpy as np
import pytest
from shared import plan as any_plan

from move.sim.collect import attempts, collect, hand_near
from move.sim.grasp_points import grasp_point
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task

TASK = get_task("pick-place")
SPREAD = 0.03  # metres


plan = partial(any_plan, method="static", timesteps=7000, factors="object", protocol="sparse", hand_spread=SPREAD)


def distinct(demonstrations) -> int:
    """How many demonstrations differ from all others in what is seen or done."""
    ends = demonstrations.episode_ends
    spans = [slice(start, end) for start, end in zip([0, *ends[:-1]], ends, strict=True)]
    return len({(demonstrations.observations[span].tobytes(), demonstrations.actions[span].tobytes())
                for span in spans})


@pytest.fixture(scope="module")
def data_sets():
    """By the spread of the hand: figure 1's static data sets of two seeds, more than once round its nine points."""
    return {spread: [collect(plan(hand_spread=spread, timesteps=1000), seed) for seed in range(2)]
            for spread in (0.0, SPREAD)}


def test_seeds_are_repetitions_only_with_starts_of_their_own(data_sets):
    seeds = {spread: {made.fingerprint for made, _ in found} for spread, found in data_sets.items()}
    assert (len(seeds[0.0]), len(seeds[SPREAD])) == (1, 2)


def test_every_demonstration_is_another(data_sets):
    assert all(distinct(made) == made.episodes for made, _ in data_sets[SPREAD])
    alike, _ = data_sets[0.0][0]
    assert distinct(alike) < alike.episodes


def test_hands_start_all_over_the_spread_and_within_their_limits(data_sets):
    starts = np.array([start.hand_position for _, record in data_sets[SPREAD] for start in record.starts])
    drawn = np.array([hand_near(TASK, SPREAD, np.random.default_rng(seed)) for seed in range(100)])
    for aside in (starts - TASK.fixed.hand_position, drawn - TASK.fixed.hand_position):
        assert np.abs(aside).max() <= SPREAD and (np.ptp(aside, axis=0) > SPREAD).all()
    assert (np.ptp(drawn, axis=0) > 1.9 * SPREAD).all()
    low, high = (np.array(limit) for limit in Scene().hand_limits)
    wide = np.array([hand_near(TASK, 1.0, np.random.default_rng(seed)) for seed in range(300)])
    assert (wide >= low).all() and (wide <= high).all(), "a spread is cut at the hand's limits"
    assert (wide.min(axis=0) < low + 0.02).all() and (wide.max(axis=0) > high - 0.02).all()


def test_the_scene_begins_where_the_record_says():
    first = [next(attempts(plan(hand_spread=spread), 0)) for spread in (0.0, SPREAD)]
    places = [Scene().reset(options={"configuration": episode.start})[0] for episode in first]
    assert all(np.array_equal(place, episode.observations[0]) for place, episode in zip(places, first, strict=True))
    assert not np.array_equal(*places)


@pytest.mark.parametrize("protocol", ["sparse", "dense", "circle"])
def test_methods_share_starts_and_keep_their_grasp_points(protocol):
    tried = {method: list(islice(attempts(plan(method=method, protocol=protocol), 3), 8))
             for method in ("static", "move")}
    for number, pair in enumerate(zip(*tried.values(), strict=True)):
        assert pair[0].start.hand_position == pair[1].start.hand_position
        for episode in pair:
            assert episode.succeeded
            assert episode.grasp.object_position == pytest.approx(grasp_point(protocol, TASK, number, 3), abs=2e-3)
    hands = {episode.start.hand_position for episode in tried["static"]}
    assert len(hands) == 8 and TASK.fixed.hand_position not in hands
