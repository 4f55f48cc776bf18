"""Intervals cover as often as they say, count configurations once, and know that another training differs."""

import numpy as np
import pytest

from move.statistics import estimates as statistics
from move.statistics.estimates import (
    difference,
    holm,
    mean_difference,
    pooled_noise,
    relative_gain,
    success_rate,
    unpaired_difference,
)
from move.statistics.over_tasks import over_tasks
from move.statistics.simulation import coverage, like_noise, outcomes

DRAWS = 2000


CASES = [(seeds, deviation, rate) for seeds in (1, 3, 5) for deviation, rate in ((0.03, 0.9), (0.08, 0.5), (0.2, 0.4))]


@pytest.mark.parametrize(("seeds", "deviation", "rate"), CASES)
def test_a_rates_interval_covers_as_often_as_it_says(seeds, deviation, rate):
    rng, covered = np.random.default_rng([seeds, int(100 * deviation)]), 0
    for draw in range(DRAWS):
        cell = outcomes(rng, rate, deviation, seeds, rng.standard_normal(100))
        if draw % 10 == 0:
            pooled = like_noise(rng, rate, deviation, 100)
        found = success_rate(cell, pooled)
        covered += found.low <= rate <= found.high
    assert 0.93 <= covered / DRAWS <= 0.97


@pytest.mark.parametrize(("seeds", "deviation", "rate"), CASES)
def test_a_differences_interval_covers_as_often_as_it_says(seeds, deviation, rate):
    rng, covered, other = np.random.default_rng([seeds, int(100 * deviation), 1]), 0, rate - 0.1
    for draw in range(DRAWS):
        hard = rng.standard_normal(100)
        cells = [outcomes(rng, value, deviation, seeds, hard) for value in (rate, other)]
        if draw % 10 == 0:
            pooled = like_noise(rng, rate, deviation, 100)
        found = difference(*cells, pooled)
        covered += found.low <= rate - other <= found.high
    assert 0.93 <= covered / DRAWS <= 0.97


@pytest.mark.parametrize(("seeds", "deviation", "rate"), CASES)
def test_an_unpaired_differences_interval_covers_as_often_as_it_says(seeds, deviation, rate):
    rng, covered, other = np.random.default_rng([seeds, int(100 * deviation), 2]), 0, rate - 0.1
    for draw in range(DRAWS):
        cells = [outcomes(rng, value, deviation, seeds, rng.standard_normal(100)) for value in (rate, other)]
        if draw % 10 == 0:
            pooled = like_noise(rng, rate, deviation, 100)
        found = unpaired_difference(*cells, pooled)
        covered += found.low <= rate - other <= found.high
    assert 0.93 <= covered / DRAWS <= 0.98


@pytest.mark.parametrize("seeds", [2, 3])
def test_a_relative_gains_interval_covers_at_least_as_often_as_it_says(seeds):
    rng, covered, noise = np.random.default_rng(seeds), 0, like_noise(np.random.default_rng(0), 0.4, 0.05, 100)
    for _ in range(500):
        pairs = []
        for _ in range(10):
            hard = rng.standard_normal(100)
            pairs.append(tuple(outcomes(rng, value, 0.05, seeds, hard) for value in (0.52, 0.4)))
        found = relative_gain(pairs, noise)
        covered += found.low <= 0.3 <= found.high
    assert 0.94 <= covered / 500 <= 1


def test_a_relative_gain_is_of_the_mean_rates_and_knows_that_both_are_uncertain():
    pairs = tasks_with(10, 20, 30)
    found, apart = relative_gain(pairs), mean_difference(pairs)
    assert found.value == pytest.approx(0.4) and found.low < 0.4 < found.high and found.episodes == 600
    assert found.low < apart.low / 0.5 and found.high > apart.high / 0.5  # these take the second rate as certain
    with pytest.raises(ValueError, match="a mean rate of 0"):
        relative_gain([(np.ones((1, 9)), np.zeros((1, 9)))])


def test_simulated_outcomes_have_the_rate_and_the_spread_asked_for():
    rng = np.random.default_rng(0)
    rates = outcomes(rng, 0.4, 0.2, 4000, rng.standard_normal(1000)).mean(axis=1)
    assert rates.mean() == pytest.approx(0.4, abs=0.03) and rates.std() == pytest.approx(0.2, abs=0.01)
    with pytest.raises(ValueError, match="smaller deviation"):
        outcomes(rng, 0.9, 0.4, 3, np.zeros(5))


def test_an_interval_that_knows_episodes_alone_covers_too_seldom():
    table = coverage([1, 3], [0.2], 0.4, 200).set_index(["interval", "seeds"])
    assert table.covered["ours"].min() > 0.9 and table.covered["episodes alone"].max() < 0.7
    assert (table.half_width["ours"] > 2 * table.half_width["episodes alone"]).all()


@pytest.mark.parametrize("seeds", [1, 3])
def test_a_configuration_tried_by_several_seeds_counts_once(seeds):
    outcomes = np.arange(40) < 26  # no training noise at all: every seed succeeds at the same configurations
    once, again = success_rate(outcomes[None]), success_rate(np.repeat(outcomes[None], seeds, axis=0))
    assert again.high - again.low >= 0.95 * (once.high - once.low)
    assert again.episodes == 40 * seeds


def test_one_training_is_not_certain_once_others_are_known_to_differ():
    cell = np.arange(100)[None] < 70
    noisy = pooled_noise([np.repeat([[1] * 50 + [0] * 50, [1] * 90 + [0] * 10], 2, axis=0)])
    alone, among = success_rate(cell), success_rate(cell, noisy)
    assert (alone.trainings, among.trainings) == ("unknown", "pooled")
    assert among.high - among.low > 2 * (alone.high - alone.low)


def test_pooled_noise_is_the_variance_that_trainings_have():
    rng = np.random.default_rng(5)
    cells = [outcomes(rng, 0.5, 0.1, 3, rng.standard_normal(100)) for _ in range(400)]
    noise = pooled_noise([*cells, cells[0][:1]])
    assert noise.degrees == 800 and noise.deviation == pytest.approx(0.1, abs=0.01)
    assert pooled_noise([cells[0][:1]]) == statistics.UNKNOWN


def test_pairing_makes_the_interval_narrow_where_configurations_decide_and_not_where_they_do_not():
    def width(first, second):
        found = difference(first, second)
        return found.high - found.low

    rng = np.random.default_rng(3)
    hard = rng.random((1, 200)) < 0.5
    first = hard ^ (rng.random((1, 200)) < 0.03)  # nearly the same configurations fail
    shuffled = first[:, rng.permutation(200)]  # the same rate, other configurations
    together, apart = width(first, hard), width(shuffled, hard)
    unpaired = 2 * 1.96 * np.sqrt(2 * 0.25 / 200)
    assert together < 0.45 * unpaired and 0.8 * unpaired < apart < 1.2 * unpaired
    never = unpaired_difference(first, hard)
    assert never.high - never.low == pytest.approx(unpaired, rel=0.1)
    assert unpaired_difference(first[:, :50], hard).value == pytest.approx(first[:, :50].mean() - hard.mean())


@pytest.mark.parametrize("seeds", [1, 3])
@pytest.mark.parametrize("outcome", [0, 1])
def test_no_interval_has_zero_width_nor_leaves_what_is_possible(seeds, outcome):
    same = np.full((seeds, 50), outcome)
    rate, none = success_rate(same), difference(same, same)
    assert 0 <= rate.low <= outcome <= rate.high <= 1 and rate.high - rate.low > 0.01
    assert none.low < 0 < none.high and none.p_value == pytest.approx(1)
    assert difference(same, 1 - same).high <= 1 and difference(same, 1 - same).low >= -1


def test_a_difference_needs_the_same_configurations():
    with pytest.raises(ValueError, match="20 and 21 configurations"):
        difference(np.ones((1, 20)), np.ones((1, 21)))
    with pytest.raises(ValueError, match="no episode"):
        success_rate(np.ones((1, 0)))


def test_the_mean_over_tasks_is_better_known_than_each_of_them():
    rng = np.random.default_rng(2)
    pairs = [(rng.random((1, 100)) < 0.6, rng.random((1, 100)) < 0.5) for _ in range(10)]
    each, mean = [difference(*pair) for pair in pairs], mean_difference(pairs)
    assert mean.value == pytest.approx(np.mean([one.value for one in each]))
    assert mean.high - mean.low == pytest.approx(np.mean([one.high - one.low for one in each]) / np.sqrt(10), rel=0.1)
    assert mean.p_value < 0.01


def tasks_with(*differences):
    """One pair of cells a task, 1 seed of 100 configurations, with those differences of percentage points."""
    return [(np.arange(100)[None] < 50 + points, np.arange(100)[None] < 50) for points in differences]


def test_over_tasks_gives_what_can_be_computed_by_hand():
    found = over_tasks(tasks_with(10, 20, 30, 40, 0, -10, 5, 5, 15, 25))
    assert found.mean_difference == pytest.approx(0.14) and found.tasks == 10
    assert found.iqm_second == pytest.approx(0.5)
    assert found.iqm_first == pytest.approx(0.5 + np.mean([5, 5, 10, 15, 20, 25]) / 100)
    assert found.improvement == pytest.approx(0.85)  # eight above, one below, one alike
    assert found.low < 0.14 < found.high and found.iqm_low < found.iqm_first - 0.5 < found.iqm_high
    assert found.improvement_low < 0.85 < found.improvement_high


def test_the_test_over_tasks_flips_signs_and_is_exact():
    assert over_tasks(tasks_with(*[10] * 10)).p_value == pytest.approx(2 / 2**10)
    assert over_tasks(tasks_with(10, -10, 10, -10)).p_value == pytest.approx(1)
    with pytest.raises(ValueError, match="2 tasks given"):
        over_tasks(tasks_with(1, 2))


def test_holm_makes_the_smallest_of_ten_ten_times_as_large():
    adjusted = holm([0.004, *[0.5] * 9])
    assert adjusted[0] == pytest.approx(0.04) and (adjusted[1:] == 1).all()


def test_holm_multiplies_each_p_by_how_many_are_not_smaller_and_keeps_their_order():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])  # by 3; by 1, but no less than the last; by 2
    assert holm([0.02, 0.001]) == pytest.approx([0.02, 0.002])
