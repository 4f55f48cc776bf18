"""Success against distance: what is planted is found, intervals cover as often as they say, and the rule can fall."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import check_grad

from move.statistics import distance
from move.statistics.distance import Curve, Tries, fit, held_out
from move.statistics.intervals import jackknife
from move.statistics.motion_is_coverage import (
    at_equal_distance,
    findings_on_grids,
    findings_over_tasks,
    gain_of_two,
    strata,
    verdict,
)

TRUE = Curve(0.8, (0.06,), 3.0)
REACH = {"static": (0.2, 0.08, 0.14), "move": (0.02, 0.03, 0.05)}  # metres: the farthest places of figures 1, 3 and 5


def simulated(rng, curve=TRUE, seeds=3, rows=225, trainings=0.05, lead=0.0, move=None):
    """Three figures and two methods: MOVE has seen places that lie nearer; trainings differ in how high they come.

    Args:
        lead: of MOVE at equal distance.
        move: MOVE's own curve, where it has one.
    """
    parts = []
    for method, reach in REACH.items():
        law = move if move and method == "move" else curve
        for figure, farthest in enumerate(reach):
            for seed in range(seeds):
                apart = rng.uniform(0, farthest, rows)
                chance = Curve(law.top + trainings * rng.standard_normal(), law.radii, law.steepness).chance(
                    tries(apart, apart)) + lead * (method == "move")
                cell = f"{method} {figure}"
                parts.append(tries(apart, rng.random(rows) < chance, f"{cell} {seed}", cell, cell, method == "move"))
    return Tries(**{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])})


@pytest.fixture(autouse=True)
def one_search(monkeypatch):
    """Many take a minute, and what is simulated here one finds."""
    monkeypatch.setattr(distance, "STARTS", 1)
    monkeypatch.setattr(distance, "HOPS", 0)


def tries(apart, success, *labels):
    run, cell, group, move = labels or ("", "", "", False)
    ones = np.ones(len(apart))
    return Tries(apart, success, *(np.full(len(apart), label) for label in (run, cell, group)), move * ones, ones)


def test_the_radius_that_was_planted_is_found():
    found = fit(simulated(np.random.default_rng(0), seeds=10, trainings=0.0))
    assert found.radii[0] == pytest.approx(0.06, rel=0.04)
    assert found.top == pytest.approx(0.8, abs=0.02) and found.steepness == pytest.approx(3, rel=0.1)


def test_a_radius_is_found_for_each_factor_and_the_nearest_timestep_is_taken():
    rng = np.random.default_rng(1)
    apart, true = np.exp(rng.uniform(-4, 1, (8000, 4, 2))), Curve(0.9, (0.1, 0.6), 2.5)
    rows = tries(apart, np.zeros(len(apart)))
    rows = tries(apart, rng.random(len(apart)) < true.chance(rows))
    found = fit(rows)
    assert found.radii == pytest.approx(true.radii, rel=0.1) and found.steepness == pytest.approx(2.5, rel=0.1)
    slow = np.sqrt(((apart[:50] / np.array(true.radii)) ** 2).sum(axis=2).min(axis=1))
    assert true.scaled(apart[:50]) == pytest.approx(slow, rel=1e-4)


def test_many_searches_find_a_likelihood_that_one_does_not(monkeypatch):
    """Of five factors, as many as a task has."""
    rng, radii = np.random.default_rng(2), np.array([0.05, 0.6, 0.1, 0.9, 0.08])
    apart = rng.exponential(radii * rng.uniform(0.3, 1.5, 5), (400, 8, 5))
    truth, ones = Curve(0.9, tuple(radii), 4.0), np.ones(400)
    one = tries(apart, ones)
    one = replace(one, success=rng.random(400) < truth.chance(one))

    def likelihood(curve: Curve) -> float:
        return float(distance.log_likelihood(one.success, curve.chance(one)).sum())

    few = likelihood(distance.fit(one))
    monkeypatch.setattr(distance, "STARTS", 4)
    monkeypatch.setattr(distance, "HOPS", 8)
    many = likelihood(distance.fit(one))
    assert many > few + 0.1 and many > likelihood(truth)


def test_a_factor_that_decides_nothing_has_a_radius_beyond_all_distances():
    rng = np.random.default_rng(2)
    apart = rng.uniform(0, 0.15, (3000, 1, 2))
    found = fit(tries(apart, rng.random(3000) < TRUE.chance(tries(apart[..., 0, 0], apart[..., 0, 0]))))
    assert found.radii[0] == pytest.approx(0.06, rel=0.1) and found.radii[1] > 0.2


def test_the_gradient_is_the_losss():
    rows = simulated(np.random.default_rng(3), seeds=1)
    apart = np.stack([rows.apart, rows.apart[::-1]], axis=1)[:, :, None] * np.array([1.0, 3.0])
    point = np.array([1.0, 0.7, -2.5, -1.5])
    assert check_grad(lambda x: distance._loss(x, apart, rows)[0], lambda x: distance._loss(x, apart, rows)[1],
                      point) < 1e-5


def test_the_interval_of_the_radius_holds_the_truth_as_often_as_it_says_where_trainings_differ():
    """Leaving out random twelfths of the episodes, as if each were on its own, does not."""
    rng, inside = np.random.default_rng(4), {"run": [], "episodes": []}
    for _ in range(40):
        rows = simulated(rng, seeds=2, rows=60, trainings=0.15)
        for name, labels in (("run", rows.run), ("episodes", rng.integers(12, size=len(rows.run)))):
            _, low, high = jackknife(labels, lambda mask, rows=rows: np.log(fit(rows.where(mask)).radii[0]))
            inside[name].append(low <= np.log(0.06) <= high)
    assert 0.9 <= np.mean(inside["run"]) and np.mean(inside["episodes"]) < np.mean(inside["run"])


def test_a_cell_is_predicted_from_the_others_and_distance_is_what_does_it():
    found = held_out(simulated(np.random.default_rng(5), seeds=6))
    assert list(found.cell) == [f"{method} {figure}" for method in ("move", "static") for figure in range(3)]
    assert found.error < 0.03 and found.share < 0.25
    static = found.cell == "static 0"
    assert found.predicted[static] == pytest.approx(found.rate[static], abs=0.05)
    assert found.without[static] == pytest.approx(found.rate[~static].mean())


def test_what_motion_brings_besides_distance_is_told_apart_from_distance():
    rng = np.random.default_rng(6)
    for lead in (0.0, 0.15):
        rows = simulated(rng, seeds=10, lead=lead, trainings=0.0)
        raw = rows.success[rows.move == 1].mean() - rows.success[rows.move == 0].mean()
        equal = at_equal_distance(rows.success, rows.move, strata(rows, TRUE))
        assert raw > 0.25 and equal == pytest.approx(lead, abs=0.03)
    assert np.isnan(at_equal_distance(np.ones(2), np.array([0, 1]), np.array([0, 1])))


def test_two_curves_gain_where_there_are_two_and_not_where_there_is_one():
    rng = np.random.default_rng(7)
    assert abs(gain_of_two(simulated(rng, trainings=0.0)).mean()) < 0.005
    assert gain_of_two(simulated(rng, Curve(0.8, (0.12,), 3.0), move=Curve(0.5, (0.02,), 3.0))).mean() > 0.02


def test_the_rule_holds_for_the_law_and_falls_where_motion_brings_more():
    rng = np.random.default_rng(8)
    assert verdict(findings_on_grids(simulated(rng, seeds=2, trainings=0.02))) == "holds"
    led = findings_on_grids(simulated(rng, Curve(0.6, (0.06,), 3.0), seeds=2, trainings=0.02, lead=0.3))
    assert verdict(led) == "falls"
    assert {finding.what: finding.answer for finding in led}["MOVE minus static at equal distance"] == "no"


def test_where_all_but_one_episode_succeed_there_is_nothing_to_predict_and_the_share_of_it_has_no_end():
    rows = simulated(np.random.default_rng(10), seeds=2)
    success = np.ones_like(rows.success)
    success[5] = 0
    error, share = findings_on_grids(replace(rows, success=success))[:2]
    assert error.low >= 0 and error.answer == "yes" and error.high < 0.01
    assert share.low >= 0 and np.isinf(share.high) and share.answer == "open"


def over_tasks(rng, difficulty):
    """Ten tasks, each as high as it is easy; two factors, of which MOVE's data show more."""
    parts = []
    for task in range(10):
        for method, reach in (("static", 1.5), ("move", 0.5)):
            apart = rng.uniform(0, reach, (200, 2, 2)) * np.array([0.1, 0.6])
            rows = tries(apart, np.zeros(200))
            chance = Curve(0.9 - difficulty * task, (0.1, 0.6), 3.0).chance(rows)
            parts.append(tries(apart, rng.random(200) < chance, f"{task} {method}", f"{task} {method}", str(task),
                               method == "move"))
    return Tries(**{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])})


def test_over_tasks_the_rule_holds_where_tasks_are_alike_and_falls_where_they_are_not():
    rng = np.random.default_rng(9)
    for difficulty, said in ((0.0, "holds"), (0.085, "falls")):
        rows = over_tasks(rng, difficulty)
        findings = findings_over_tasks(rows, held_out(rows), fit(rows))
        assert verdict(findings) == said, findings
        assert findings[2].answer == "yes"  # at equal distance motion brings nothing in either
