"""Intervals cover as often as they say, count configurations once, and include that another training differs."""

import numpy as np
import pytest
from scipy import stats

from move.statistics.data_efficiency import data_efficiency
from move.statistics.estimates import (
    difference,
    holm,
    mean_difference,
    paired_contrast,
    rate_interval,
    relative_gain,
    success_rate,
    unpaired_difference,
)
from move.statistics.over_tasks import over_tasks
from move.statistics.simulation import coverage, like_noise, outcomes
from move.statistics.spread import Spread
from move.statistics.training_noise import UNKNOWN, TrainingNoise, moderated, training_noise_of

UNEQUAL = np.array([0.02, 0.04, 0.06, 0.08, 0.10])  # by how much trainings differ, one cell so and the next so
LAWS, STUDIES, TASKS = 100, 20, 10  # what like cells tell is drawn anew so often, for so many studies each


def unequal(seeds: int, rates: tuple[float, ...], tasks: int = 1, paired: bool = True):
    """For each law: the law, and for each rate successes (studies * tasks, seeds, configurations)."""
    rng = np.random.default_rng([seeds, len(rates), tasks])
    for _ in range(LAWS):
        hard = rng.standard_normal((len(rates), STUDIES * tasks, 100))
        yield like_noise(rng, rates[0], UNEQUAL, 100), [
            outcomes(rng, rate, rng.choice(UNEQUAL, STUDIES * tasks), seeds, hard[0 if paired else place]).astype(float)
            for place, rate in enumerate(rates)]


def covered(inside: list) -> float:
    return float(np.concatenate(inside).mean())


@pytest.mark.parametrize("seeds", [1, 2, 3, 5])
@pytest.mark.parametrize("rate", [0.5, 0.8])
def test_a_rates_interval_covers_as_often_as_it_says_where_cells_are_unequal(seeds, rate):
    inside = []
    for noise, (cells,) in unequal(seeds, (rate,)):
        low, high = rate_interval(cells, noise)
        inside.append((low <= rate) & (rate <= high))
    assert 0.93 <= covered(inside) <= 0.97


@pytest.mark.parametrize("seeds", [1, 2, 3, 5])
def test_intervals_of_a_difference_and_of_a_mean_over_tasks_cover_as_often_as_they_say_where_cells_are_unequal(seeds):
    inside, means = [], []
    for noise, (first, second) in unequal(seeds, (0.5, 0.4), TASKS):
        value, spread = paired_contrast((first, second), (1, -1), noise)
        inside.append(np.abs(value - 0.1) <= spread.half_width)
        mean = value.reshape(-1, TASKS).mean(axis=1)
        whole = Spread(*(part.reshape(-1, TASKS).sum(axis=1) for part in spread)).times(1 / TASKS)
        means.append(np.abs(mean - 0.1) <= whole.half_width)
    assert 0.93 <= covered(inside) <= 0.97 and 0.93 <= covered(means) <= 0.97


@pytest.mark.parametrize("seeds", [1, 3])
def test_an_unpaired_differences_and_a_gains_intervals_cover_as_often_as_they_say(seeds):
    apart, gained = [], []
    for noise, (first, second) in unequal(seeds, (0.5, 0.4), TASKS, paired=False):
        for one, other in zip(first[:10], second[:10], strict=True):
            found = unpaired_difference(one, other, noise)
            apart.append([found.low <= 0.1 <= found.high])
        for pairs in zip(first.reshape(STUDIES, TASKS, seeds, 100)[:4],
                         second.reshape(STUDIES, TASKS, seeds, 100)[:4], strict=True):
            gain = relative_gain(list(zip(*pairs, strict=True)), noise)
            gained.append([gain.low <= 0.25 <= gain.high])
    assert 0.93 <= covered(apart) <= 0.97 and 0.92 <= covered(gained) <= 0.98  # 1,000 and 400 studies


@pytest.mark.parametrize("true", [1.0, 2.0])
def test_a_factors_interval_covers_as_often_as_it_says_where_cells_are_unequal(true):
    """Figure 4's design: three seeds at table 2's budget, one at the others."""
    rng, inside, budgets = np.random.default_rng(int(10 * true)), [], (5000, 10_000, 20_000, 40_000)
    for study in range(300):
        if study % 10 == 0:
            noise = like_noise(rng, 0.5, UNEQUAL, 100)
        hard = rng.standard_normal(100)
        static, move = ({size: outcomes(rng, round(0.4 + 0.1 * np.log2(more * size / 20_000), 3), rng.choice(UNEQUAL),
                                        3 if size == 20_000 else 1, hard).astype(float) for size in budgets}
                        for more in (1.0, true))
        found = data_efficiency(static, move, 20_000, noise, draws=400)
        inside.append([found.low <= true <= found.high])
    assert 0.92 <= covered(inside) <= 0.98


def test_one_seed_that_is_noisier_than_like_cells_is_still_covered_more_often_than_by_a_plain_pool():
    rng, ours, pool = np.random.default_rng(0), [], []
    for noise, _ in unequal(1, (0.5,)):
        hard = rng.standard_normal((STUDIES, 100))
        first, second = (outcomes(rng, rate, np.full(STUDIES, 0.10), 1, hard).astype(float) for rate in (0.5, 0.4))
        for law, inside in ((noise, ours), (TrainingNoise(0.034**2, 1000.0), pool)):
            value, spread = paired_contrast((first, second), (1, -1), law)
            inside.append(np.abs(value - 0.1) <= spread.half_width)
    assert covered(pool) < 0.75 and covered(ours) > 0.82


def test_three_seeds_that_differ_or_agree_by_chance_borrow_from_like_cells():
    rng, law = np.random.default_rng(1), TrainingNoise(0.0006, 5.0, 60)
    cells = outcomes(rng, 0.5, np.full(400, 0.03), 3, rng.standard_normal((400, 100))).astype(float)
    alone, with_law = (np.ptp(rate_interval(cells, noise), axis=0) for noise in (UNKNOWN, law))
    least, most = (np.quantile([with_law, alone], level, axis=1) for level in (0.05, 0.95))
    assert most[0] < 0.6 * most[1] and most[0] / least[0] < 1.5 < most[1] / least[1]


def test_a_spread_is_the_students_t_it_was_made_of_and_sums_of_many_are_normal():
    scale, degrees = Spread.of(np.array(4.0), 7).student
    assert (scale, degrees) == (pytest.approx(2), pytest.approx(7))
    many = Spread.total([Spread.of(np.array(4.0), 7)] * 200)
    assert many.half_width == pytest.approx(1.96 * np.sqrt(200 * 4 * 7 / 5), rel=0.01)
    alone, few = Spread.of(np.array(1.0), 2).half_width, Spread.of(np.array(1.0), 5).half_width
    assert (alone, few) == (pytest.approx(4.303, abs=1e-3), pytest.approx(2.571, abs=1e-3))


def test_the_law_of_unequal_cells_has_fewer_degrees_of_freedom_than_that_of_many_equal_ones():
    rng = np.random.default_rng(5)
    equal = training_noise_of(outcomes(rng, 0.5, np.full(300, 0.08), 3, rng.standard_normal((300, 100))))
    two = np.repeat([0.02, 0.16], 150)
    unlike = training_noise_of(outcomes(rng, 0.5, two, 3, rng.standard_normal((300, 100))))
    assert equal.repeats == unlike.repeats == 600 and unlike.degrees < equal.degrees
    for law, mean in ((equal, 0.08**2), (unlike, np.mean(two**2))):
        assert law.variance * law.degrees / (law.degrees - 2) == pytest.approx(mean, rel=0.2)


def test_equal_counts_differ_by_zero_and_by_no_minus_zero():
    rng = np.random.default_rng(2)
    first = rng.permuted(np.repeat([[1.0] * 37 + [0.0] * 63], 3, axis=0), axis=1)
    second = rng.permuted(first[:1], axis=1)
    for found in (difference(first, second), difference(second, first), mean_difference([(first, second)] * 3)):
        assert str(found.value) == "0.0" and found.p_value == 1


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
    table = coverage([1, 3], [0.12], 0.4, 400).set_index(["interval", "seeds"])
    assert table.covered["ours"].min() > 0.87 and table.covered["episodes alone"].max() < 0.8
    assert (table.half_width["ours"] > 1.6 * table.half_width["episodes alone"]).all()
    for seeds, half in table.half_width["episodes alone"].items():
        assert half == pytest.approx(1.96 * np.sqrt(0.4 * 0.6 / (100 * seeds)), rel=0.1)


@pytest.mark.parametrize("seeds", [1, 3])
def test_a_configuration_tried_by_several_seeds_counts_once(seeds):
    outcomes = np.arange(40) < 26  # no training noise at all: every seed succeeds at the same configurations
    once, again = success_rate(outcomes[None]), success_rate(np.repeat(outcomes[None], seeds, axis=0))
    assert again.high - again.low >= 0.95 * (once.high - once.low)
    assert again.episodes == 40 * seeds


def test_one_training_is_not_certain_once_others_are_known_to_differ():
    cell = np.arange(100)[None] < 70
    noisy = training_noise_of([np.repeat([[1] * 50 + [0] * 50, [1] * 90 + [0] * 10], 2, axis=0)])
    alone, among = success_rate(cell), success_rate(cell, noisy)
    assert (alone.trainings, among.trainings) == ("unknown", "like cells")
    assert among.high - among.low > 2 * (alone.high - alone.low)
    several = np.repeat(cell, 3, axis=0)
    assert [success_rate(several, law).trainings for law in (UNKNOWN, noisy)] == ["own", "moderated"]


def test_cells_of_one_seed_tell_nothing_and_those_at_the_ceiling_little():
    rng = np.random.default_rng(5)
    cells = list(outcomes(rng, 0.5, np.full(30, 0.1), 3, rng.standard_normal((30, 100))))
    law = training_noise_of(cells)
    assert training_noise_of([*cells, cells[0][:1], np.ones((3, 100))]) == law and law.repeats == 60
    assert training_noise_of([cells[0][:1]]) == UNKNOWN


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
    with pytest.raises(ValueError, match="20 and 21 configurations given"):
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
    half = over_tasks(tasks_with(*[10, -10] * 8))
    ends = stats.binom(16, 0.5).ppf([0.025, 0.975]) / 16  # of so many tasks drawn from as many, 5 and 11 at 90 %
    assert (half.improvement_low, half.improvement_high) == pytest.approx(tuple(ends)) == (0.25, 0.75)


def test_the_test_over_tasks_flips_signs_and_is_exact():
    assert over_tasks(tasks_with(*[10] * 10)).p_value == pytest.approx(2 / 2**10)
    assert over_tasks(tasks_with(10, -10, 10, -10)).p_value == pytest.approx(1)
    with pytest.raises(ValueError, match="2 tasks given"):
        over_tasks(tasks_with(1, 2))


def test_holm_multiplies_each_p_by_how_many_are_not_smaller_and_keeps_their_order():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])  # by 3; by 1, but no less than the last; by 2
    assert holm([0.02, 0.001]) == pytest.approx([0.02, 0.002])


def test_a_cell_whose_seeds_agree_by_chance_keeps_what_neither_training_nor_configuration_explains():
    cell = np.array([[1.0, 0.0] * 20, [0.0, 1.0] * 20])  # each seed succeeds in half, and elsewhere than the other
    variance, rest, _ = moderated(cell, TrainingNoise(0.0, 4.0))
    assert variance == rest > 0
