"""Data efficiency: a curve that is shifted by a factor says that factor, and what no curve reaches is not made up."""

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

from move.statistics.data_efficiency import data_efficiency, isotonic, needed
from move.statistics.training_noise import TrainingNoise

BUDGETS = (5000, 10_000, 20_000, 40_000)


def curve(rates, budgets=BUDGETS, configurations=100):
    return {size: (np.arange(configurations) < round(rate * configurations))[None].astype(float)
            for size, rate in zip(budgets, rates, strict=True)}


def test_a_static_curve_that_is_twice_as_far_right_needs_twice_the_timesteps():
    found = data_efficiency(curve((0.1, 0.2, 0.4, 0.6)), curve((0.2, 0.4, 0.6, 0.7)), 20_000)
    assert found.ratio == pytest.approx(2)
    assert found.low <= 2 + 1e-9 and found.high >= 2 - 1e-9


def test_more_than_is_above_a_number_only_where_statics_largest_budget_says_so():
    found = data_efficiency(curve((0.1, 0.2, 0.3), BUDGETS[:3]), curve((0.4, 0.5, 0.7, 0.8)), 20_000)
    assert str(found) == "> 1 [> 1, > 1]" and found.most == 1
    assert found.surely(found.low, 1.0) > 1 and found.p_value(1.0) == pytest.approx(2 / 1000)
    assert found.surely(found.low, 2.0) == 1 and found.p_value(2.0) == 1


def test_the_p_value_agrees_with_the_interval():
    rising = [data_efficiency(curve((0.1, 0.2, 0.4, 0.6)), curve((0.2, 0.3, 0.4 + more, 0.9)), 20_000,
                              TrainingNoise(0.003, 20)) for more in (0.0, 0.05, 0.1, 0.15, 0.2, 0.25)]
    values = [found.p_value(1.0) for found in rising]
    assert values == sorted(values, reverse=True) and values[0] > 0.5 and values[-1] < 0.05
    assert [value < 0.05 for value in values] == [found.low > 1 for found in rising]


def test_a_level_that_static_has_from_the_start_is_at_most_its_smallest_budget():
    found = data_efficiency(curve((0.6, 0.7, 0.8, 0.9)), curve((0.1, 0.2, 0.3, 0.4)), 20_000)
    assert found.ratio == pytest.approx(0.25) and str(found).startswith("<= 0.25")


def test_rising_sequences_are_fitted_as_scipy_fits_one():
    rates = np.random.default_rng(0).random((50, 5)).round(1)
    assert isotonic(rates) == pytest.approx(np.array([isotonic_regression(each).x for each in rates]))


def test_a_dip_of_a_curve_does_not_count_as_a_loss_of_success():
    budgets, rates = np.array(BUDGETS), np.array([0.1, 0.5, 0.3, 0.8])
    assert needed(budgets, rates, 0.39) < needed(budgets, rates, 0.41) <= 40_000
    assert needed(budgets, rates, 0.4) == pytest.approx(10_000)  # of 0.5 and 0.3 the fit makes 0.4 twice


def test_noise_of_trainings_widens_the_interval():
    static, move = curve((0.1, 0.2, 0.4, 0.6)), curve((0.2, 0.3, 0.5, 0.7))
    sure = data_efficiency(static, move, 20_000)
    unsure = data_efficiency(static, move, 20_000, TrainingNoise(0.01, 20))
    assert unsure.high - unsure.low > sure.high - sure.low


def test_one_budget_is_refused():
    with pytest.raises(ValueError, match="two budgets or more"):
        data_efficiency(curve((0.5,), (5000,)), curve((0.5,), (5000,)), 5000)
