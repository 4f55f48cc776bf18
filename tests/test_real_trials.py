"""Exact statistics against slow, obvious ones."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from move.errors import BadInput
from move.realworld import trials as t
from move.statistics.intervals import exact_interval


@pytest.mark.parametrize(("successes", "n"), [(0, 30), (1, 30), (7, 30), (30, 30), (3, 7)])
def test_exact_interval_solves_its_definition(successes, n):
    low, high = exact_interval(successes, n)
    if successes:
        assert stats.binom.sf(successes - 1, n, low) == pytest.approx(0.025)
    if successes < n:
        assert stats.binom.cdf(successes, n, high) == pytest.approx(0.025)
    assert (low == 0) == (successes == 0) and (high == 1) == (successes == n)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.02, 0.98))
def test_exact_interval_covers_at_least_as_often_as_it_says(rate):
    inside = [low <= rate <= high for low, high in (exact_interval(k, 30) for k in range(31))]
    assert stats.binom.pmf(np.arange(31), 30, rate)[inside].sum() >= 0.95


@pytest.mark.parametrize("bad", [(-1, 30), (31, 30), (0, 0)])
def test_impossible_counts_are_refused(bad):
    with pytest.raises(BadInput, match=r"allowed are 0\.\.trials"):
        exact_interval(*bad)


def test_the_papers_comparisons():
    table = t.comparisons().set_index(["first", "second"])
    assert len(table) == 6
    assert table.loc[("static 35k", "move 35k"), "fisher"] == pytest.approx(0.052, abs=0.001)
    assert table.loc[("static 35k", "move 35k"), "barnard"] < 0.05
    assert table.loc[("static 75k", "move 75k"), "fisher"] == pytest.approx(0.40, abs=0.005)
    equal = table.loc[("move 35k", "static 75k")]
    assert equal["fisher"] == 1 and equal["low"] == pytest.approx(-equal["high"]) and equal["high"] > 0.2


def test_comparison_of_nothing_with_nothing():
    assert t.compare((0, 30), (0, 30))["barnard"] == 1.0 and t.compare((30, 30), (30, 30))["fisher"] == 1.0


def test_power_is_that_of_scipys_fisher_test():
    n, a, b = 9, 0.2, 0.7
    slow = sum(
        stats.binom.pmf(i, n, a) * stats.binom.pmf(j, n, b)
        for i, j in product(range(n + 1), repeat=2)
        if stats.fisher_exact([[i, n - i], [j, n - j]]).pvalue <= 0.05)
    assert t.power(a, b, trials=n) == pytest.approx(slow, rel=1e-9)


def test_smallest_detectable_is_just_enough():
    rise = t.minimum_detectable_effect(7 / 30)
    assert t.power(7 / 30, 7 / 30 + rise) >= 0.8 > t.power(7 / 30, 7 / 30 + rise - 0.005)
    assert np.isnan(t.minimum_detectable_effect(0.95)), "a rise beyond 1 cannot be found"
    assert t.minimum_detectable_effect(7 / 30, trials=100) < rise


def test_power_table_columns():
    table = t.power_table([0.1, 0.3], trials=(30, 60))
    assert len(table) == 4 and np.allclose(table["rate_needed"], table["base"] + table["detectable_rise"])


@pytest.mark.parametrize(("successes", "score", "n"), [(1, 5, 6), (2, 9, 7), (0, 3, 5), (3, 9, 3)])
def test_score_distributions_against_every_ordering(successes, score, n):
    ways: dict[tuple, int] = {}
    for rest in product(range(3), repeat=n - successes):
        if sum(rest) + 3 * successes == score:
            kind = tuple(rest.count(value) for value in range(3))
            ways[kind] = ways.get(kind, 0) + 1
    table = t.score_distributions(successes, score, n)
    assert {(r.zero, r.one, r.two): pytest.approx(r.weight * sum(ways.values())) for r in table.itertuples()} == ways
    for r in table.itertuples():
        points = [0] * r.zero + [1] * r.one + [2] * r.two + [3] * r.three
        assert len(points) == n and sum(points) == score and np.std(points, ddof=1) == pytest.approx(r.sd)


@given(st.integers(0, 30))
def test_score_bounds_are_reached_and_not_passed(successes):
    least, most = t.score_bounds(successes)
    assert (least, most) == (3 * successes, 3 * successes + 2 * (30 - successes))
    assert len(t.score_distributions(successes, least)) == len(t.score_distributions(successes, most)) == 1
    for score in (least - 1, most + 1):
        with pytest.raises(BadInput, match="allowed are"):
            t.score_distributions(successes, score)


def test_real_table_is_the_papers():
    table = t.real_table()
    assert (100 * table["rate"]).round(1).tolist() == [3.3, 23.3, 23.3, 36.7]
    assert ((table["score_low"] <= table["normalised"]) & (table["normalised"] <= table["score_high"])).all()
    assert table["readings"].tolist() == [2, 4, 8, 8]
