"""Verdicts follow from numbers by one rule, claims are data, and both change when the numbers do."""

import hashlib
import json
import math
import subprocess
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import git
from pydantic import ValidationError
from scipy import stats
from shared import refused

from move import paper, paths
from move.claims import claims as data
from move.claims import ledger, quantities
from move.claims.claims import claims, read
from move.claims.evidence import Evidence, chosen, over_seeds, placed
from move.claims.quantities import QUANTITIES, findings
from move.figures.page import parameters
from move.statistics.estimates import of_configurations, success_rate
from move.statistics.needed import Design, Seeds, Trials
from move.statistics.training_noise import TrainingNoise
from move.statistics.verdicts import VERDICTS, Contradiction, Finding, Missing, Untested, verdict
from move.study.profiles import Profile, load_profile

INFINITE = float("inf")
LAPTOP = load_profile("laptop")
YES, OPEN = Finding("yes", 0.3, 0.2, 0.4), Finding("open", 0.1, -0.1, 0.3)
NO, BARELY = Finding("no", -0.3, -0.4, -0.2), Finding("barely no", -0.11, -0.215, -0.005)


@pytest.mark.parametrize("finding, answer, size", [
    (YES, "yes", ""), (OPEN, "open", ""), (NO, "no", ""),
    (Finding("as large", 0.3, 0.2, 0.4, paper=0.4), "yes", ""),
    (Finding("smaller", 0.3, 0.2, 0.4, paper=0.41), "yes", "smaller"),
    (Finding("not told apart", 0.3, 0.2, 0.4, paper=0.45, paper_half_width=0.12), "yes", ""),
    (Finding("larger", 0.3, 0.2, 0.4, paper=0.05), "yes", "larger"),
    (Finding("smaller and unclear", 0.1, -0.1, 0.3, paper=0.5), "open", "smaller"),
    (Finding("the same", 0.0, -0.05, 0.05, above=-0.1, below=0.1, equal=0.0), "yes", ""),
    (Finding("nearly the same", 0.08, 0.01, 0.15, above=-0.1, below=0.1, equal=0.0), "open", ""),
    (Finding("not the same", 0.12, 0.01, 0.23, above=-0.1, below=0.1, equal=0.0), "no", ""),
    (Finding("surely not the same", 0.32, 0.23, 0.42, above=-0.1, below=0.1, equal=0.0), "no", ""),
    (Finding("no worse", -0.03, -0.09, 0.03, above=-0.1, equal=0.0), "yes", ""),
    (Finding("perhaps worse", -0.03, -0.15, 0.09, above=-0.1, equal=0.0), "open", ""),
    (Finding("more than", INFINITE, 1.5, INFINITE, above=1.0), "yes", ""),
    (Finding("more than the paper's", INFINITE, 2.5, INFINITE, above=1.0, paper=2.0), "yes", "larger"),
    (Finding("more than", INFINITE, 0.9, INFINITE, above=1.0), "open", ""),
    (Finding("more than, perhaps the paper's", INFINITE, 1.5, INFINITE, above=1.0, paper=2.0), "yes", ""),
    (Finding("above all that is claimed", 0.5, 0.4, 0.6, above=-0.1, below=0.1), "no", ""),
    (Finding("no end", 0.0, -0.05, INFINITE, above=-0.1, below=0.1), "open", ""),
    (Finding("a factor", 2.1, 1.6, 3.2, above=1.0, paper=5.0), "yes", "smaller"),
])
def test_a_finding_is_a_yes_a_no_or_open_and_may_exclude_the_papers_size(finding, answer, size):
    assert (finding.answer, finding.size) == (answer, size)


@pytest.mark.parametrize("items, join, expected", [
    ([YES], "every", "reproduced"),
    ([YES, YES], "every", "reproduced"),
    ([Finding("", 0.3, 0.2, 0.4, paper=0.5), YES], "every", "reproduced, smaller"),
    ([Finding("", 0.3, 0.2, 0.4, paper=0.1)], "mean", "reproduced, larger"),
    ([Finding("", 0.3, 0.2, 0.4, paper=0.1), Finding("", 0.3, 0.2, 0.4, paper=0.5)], "every", "reproduced"),
    ([YES, YES, OPEN], "every", "direction only"),
    ([Finding("", 0.05, -0.01, 0.11)] * 10, "every", "direction only"),  # none by itself, all together
    ([OPEN], "every", "undecided"),
    ([OPEN], "mean", "undecided"),
    ([Finding("", 0.3, 0.2, 0.4), Finding("", 0.4, 0.3, 0.53, above=0.5)], "every", "undecided"),  # unlike: no mean
    ([Finding("", 0.14, -0.01, 0.29, -0.1, 0.1, 0.0)] * 4, "every", "undecided"),  # alike: no direction
    ([OPEN, Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094)], "every", "undecided"),  # one of them had room
    ([Finding("", 0.03, -0.04, 0.11, paper=0.2, room=0.22)], "every", "undecided"),  # just enough
    ([Finding("", 0.02, -0.3, 0.34)] * 3, "every", "undecided"),
    ([Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094)], "every", "at the ceiling"),
    ([YES, Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094)], "every", "at the ceiling"),
    ([Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.5)], "every", "undecided"),
    ([Finding("", 0.06, 0.02, 0.08, paper=0.228, room=0.094)], "every", "reproduced, smaller"),  # a yes comes first
    ([NO], "every", "refuted here"),
    ([YES, NO], "every", "refuted here"),
    ([BARELY], "every", "refuted here"),
    ([YES, YES, YES, BARELY], "every", "direction only"),  # no longer a no after Holm's adjustment
    ([YES, BARELY], "every", "direction only"),  # of two as well
    ([YES, Finding("", -0.11, -0.5, -0.02)], "every", "refuted here"),  # its upper part is what counts
    ([Finding("", 0.19, 0.09, 0.29, -0.1, 0.1, 0.0), Finding("", 0.0, -0.05, 0.05, -0.1, 0.1, 0.0)], "every",
     "refuted here"),  # surely unequal, after Holm's adjustment too
    ([OPEN, OPEN, Finding("", 0.07, 0.04, 0.1, trend=True), Finding("", 0.07, -0.04, 0.1, trend=True)], "trend",
     "undecided"),
    ([Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094), NO], "some", "at the ceiling"),
    ([Finding("", 0.1, -0.1, 0.3, p_value=0.001)], "some", "undecided"),
    ([NO, NO, YES], "some", "reproduced"),
    ([Finding("", 0.11, 0.005, 0.215), OPEN, OPEN], "some", "undecided"),  # no longer a yes after Holm's adjustment
    ([NO, NO], "some", "refuted here"),
    ([NO, OPEN], "some", "undecided"),
    ([OPEN, OPEN, Finding("slope", 0.07, 0.04, 0.1, trend=True)], "trend", "direction only"),
    ([YES, OPEN, Finding("slope", 0.07, -0.04, 0.1, trend=True)], "trend", "undecided"),
    ([YES, YES, Finding("slope", 0.07, -0.04, 0.1, trend=True)], "trend", "reproduced"),
    ([Finding("", -0.05, -0.11, 0.01)] * 10, "every", "refuted here"),  # none by itself, all together
    ([OPEN, OPEN, Finding("slope", -0.07, -0.1, -0.04, trend=True)], "trend", "refuted here"),
    ([Finding("", 0.11, 0.005, 0.215), NO], "some", "undecided"),  # no open one is left that could have no room
    ([YES, Missing("a run", 1, 10.0)], "every", "not computed yet"),
    ([], "every", "not computed yet"),
    ([Untested("no robot")], "every", "not testable"),
    ([Untested("no such table", testable=True)], "every", "not built here"),
    ([Contradiction(4.0, (5.65, 1.34), "ratio")], "every", "contradicted by the paper"),
])
def test_a_verdict_follows_from_its_findings_and_from_how_they_are_joined(items, join, expected):
    assert verdict(items, join) == expected and expected in VERDICTS


def test_equal_rates_differ_by_zero_in_words_too():
    assert str(Finding("gain", -2.2e-16, -0.1, 0.1)) == "gain: 0 [-0.1, 0.1]"


def test_printed_numbers_that_round_to_what_is_said_contradict_nothing():
    assert not Contradiction(4.0, (1.3, 4.1), "ratio").stands


def test_what_would_decide_it_gets_cheaper_with_distance_and_is_as_precise_as_it_says():
    design = Design(1, 100, half_width=0.2, training_variance=0.00115, minutes=30.0, evaluation_minutes=4.0)
    minutes = [float(design.needed(distance).split("about ")[1].split()[0]) for distance in (0.1, 0.15, 0.2)]
    assert minutes == sorted(minutes, reverse=True) and minutes[0] > minutes[-1]
    assert design.forecast(1, 100) == pytest.approx(0.2)
    narrower = math.sqrt(((0.02 + 0.16) / 400 + 0.00115) / ((0.02 + 0.32) / 100 + 0.0023))  # measured on table 2
    assert design.forecast(2, 400) == pytest.approx(0.2 * narrower)
    assert (design.cost(3, 100), design.cost(2, 400)) == (60.0, 2 * (30.0 + 3 * 4.0))
    assert "would not decide" in Design(1, 100, 0.5, 0.05, 30.0, 4.0).needed(0.05)
    assert Trials(7 / 30, 7 / 30).needed(0.1).startswith("281 trials")
    assert Seeds(3, 0.2, 10.0).needed(0.1).startswith("25 seeds, about 220 core-minutes")
    assert Seeds(3, 0.1, 10.0).needed(0.2).startswith("4 seeds") and "would not decide" in Seeds(3, 0.9, 1.0).needed(0)
    undecided = Finding("a", 0.1, -0.1, 0.3, design=design)
    assert undecided.needed.startswith("a: ") and not Finding("a", 0.3, 0.2, 0.4, design=design).needed
    alike = Finding("a", 0.02, -0.1, 0.14, -0.1, 0.1, 0.0, design=design)
    assert alike.needed == f"a: {design.needed(0.08)}", "the nearer edge"


def test_what_would_decide_it_does_so_four_times_in_five():
    true, rng = 0.2, np.random.default_rng(0)
    trials = int(Trials(0.5, 0.3).needed(true).split()[0])
    rates = [rng.binomial(trials, rate, 20_000) / trials for rate in (0.5, 0.3)]
    error = np.sqrt(sum(rate * (1 - rate) for rate in rates) / trials)
    assert np.mean(rates[0] - rates[1] > 1.96 * error) == pytest.approx(0.8, abs=0.02)


def test_no_seed_narrows_what_configurations_make():
    assert Seeds(3, 0.25, 10.0, fixed=0.24).forecast(30) == pytest.approx(0.2411, abs=1e-4)
    assert "more configurations" in Seeds(3, 0.25, 10.0, fixed=0.24).needed(0.1)
    near = Design(5, 400, 0.03, 0.001, 30.0, 4.0).needed(0.01)
    assert near == "the runs there are would see 0.05 from the edge; it is nearer than that"
    places = np.tile(np.arange(9) < 6, (10, 1)).astype(float)  # each place is solved by all seeds or by none
    assert of_configurations([places], [1.0]).half_width == pytest.approx(success_rate(places).high - 6 / 9, rel=0.3)
    seeds = np.tile(np.arange(10) < 6, (9, 1)).T.astype(float)  # each seed solves all places or none
    assert of_configurations([seeds], [1.0]).half_width == 0
    chance = (np.random.default_rng(0).random((10, 400)) < 0.5).astype(float)  # no place is harder than another
    assert of_configurations([chance], [1.0]).half_width < 0.5 * 1.96 * math.sqrt(0.25 / 10 / 400)


def test_the_papers_numbers_have_the_noise_of_their_episodes():
    printed = data.Paper(one=[0.4], other=[0.2], episodes=60)
    assert printed.of_one(0) == pytest.approx({"paper": 0.2, "paper_half_width": 1.96 * math.sqrt(0.4 / 60)}, abs=1e-4)
    relative = 0.24 / 60 / 0.4**2 + 0.16 / 60 / 0.2**2
    assert printed.of_mean(gain=True) == pytest.approx({"paper": 1.0, "paper_half_width": 1.96 * 2 * relative**0.5},
                                                       abs=1e-4)
    assert data.Paper(one=[0.4], other=[0.2]).of_one(0)["paper_half_width"] == 0


def test_the_interval_over_seeds_is_students():
    found = over_seeds("it", [0.1, 0.2, 0.4, 0.3], data.Quantity(quantity="decay"))
    expected = stats.t.interval(0.95, 3, 0.25, stats.sem([0.1, 0.2, 0.4, 0.3]))
    assert (found.value, found.low, found.high) == pytest.approx((0.25, *expected))


def test_what_is_missing_costs_what_runs_from_pixels_like_it_have_cost_and_what_only_collects_its_collection():
    def made(observation, minutes, steps):
        return SimpleNamespace(seconds={"collect": 30.0, "train": 60 * minutes - 30.0}, spec=SimpleNamespace(
            observation=observation, training=SimpleNamespace(gradient_steps=steps)))

    evidence = Evidence(LAPTOP)
    stored = {"table2_main": [made("rgb", 10, 1000), made("rgb", 30, 2000), made("keypoints", 1, 5000),
                              made("rgb", 9, 300), made("keypoints", 1, 5000)],
              "table6_collection": [SimpleNamespace(seconds={"collect": 60.0 * minutes}) for minutes in (1, 3, 20)]}
    evidence.stored = lambda experiment: dict(enumerate(stored[experiment]))
    evidence.asked = lambda _: pd.DataFrame({
        "run": list("abbcd"), "steps": [2000, 4000, 4000, 0, 700], "stored": [False] * 4 + [True], "task": "push"})
    missing = evidence.missing("three of them", "table2_main", {"task": "push"})
    assert (missing.runs, missing.minutes) == (3, pytest.approx(6000 * 30 / 2000 + 3.0))


def test_the_claims_are_data_and_each_names_a_figure_and_quantities_that_exist():
    assert len(claims()) >= 36
    for each in claims():
        assert (paths.NOTEBOOKS / f"{each.figure}.ipynb").exists(), each
        assert each.place and {one.quantity for one in each.findings} <= set(QUANTITIES)
    assert set(QUANTITIES) == {one.quantity for each in claims() for one in each.findings}


def test_a_claim_that_is_asked_again_says_so_and_counts_whole():
    again = [each for each in claims() if each.figure.startswith("decided")]
    assert {each.number for each in again} == {7, 11, 13, 25, 26}
    for each in again:
        assert "new seeds, which alone count" in each.changed
        assert all(one.options == {"whole": True} for one in each.findings), each.number


def test_every_printed_value_in_the_claims_is_the_papers():
    for each in claims():
        known = paper.PAPER[paper.PAPER.experiment.isin([each.figure, "table2_main"])].value
        for one in each.findings:
            for value in (*one.paper.one, *one.paper.other):
                assert np.isclose(known, value).any(), (each.number, value)
            assert one.paper.episodes in (0, paper.EPISODES_A_RATE)
    ratio = paper.published("table6_collection", "mean_steps", condition="simulation").set_index("method").value
    length, = (one for one in claims()[29].findings)
    assert length.paper.value[0] == pytest.approx(ratio.move / ratio.static - 1, abs=1e-4)
    factors = paper.published("fig4_scaling", "timesteps", condition="equally good").pivot(
        index="task", columns="method", values="value")
    gains, = claims()[5].findings
    assert gains.paper.value == [factors.static[task] / factors.move[task] for task in gains.each["task"]]


def test_the_papers_mean_of_ten_tasks_is_known_to_five_points():
    rates = paper.published("table2_main").pivot(index="task", columns="method", values="value")
    printed = data.Paper(episodes=paper.EPISODES_A_RATE)
    assert printed.half_width(list(rates.move), list(rates.static)) == pytest.approx(0.048, abs=1e-3)


@pytest.mark.parametrize("text, complaint", [
    ("claims: []", "selections"),
    ("selections: {}\nclaims: [{number: 2, quote: a, place: b, figure: c, findings: [{quantity: rate}]}]", "1, 2, 3"),
    ("selections: {}\nclaims: [{number: 1, quote: a, place: b, figure: c, findings: []}]", "findings"),
    ("selections: {}\nclaims: [{number: 1, quote: a, place: b, figure: c, findings: [{quantity: r, more: 1}]}]",
     "more"),
    ("selections: {}\nclaims: [{number: 1, quote: a, place: b, figure: c, findings: [{quantity: r, selection: x}]}]",
     "selection 'x'"),
    ("selections: {}\nlists: {}\nclaims: [{number: 1, quote: a, place: b, figure: c, findings: [$x]}]", r"\$x"),
])
def test_what_is_no_list_of_claims_is_refused_in_one_line(text, complaint):
    with refused(complaint):
        read(text)


def test_the_hands_start_is_chosen_in_one_place():
    text = data.FILE.read_text()
    assert text.count("hand: anywhere") == 1
    other = read(text.replace("{hand: anywhere}", "{hand: one place}"))
    chosen_so = {each.number for each in other for one in each.findings if one.where.get("hand") == "one place"}
    assert {11, 12, 13, 15, 16, 17, 23} <= chosen_so


def test_episodes_over_a_grid_know_how_far_the_nearest_grasp_point_is_and_the_circle():
    rows = pd.DataFrame({"group": ["point", "grid", "grid"], "object_x": [-0.05, -0.05, 0.14],
                         "object_y": [0.65, 0.68, 0.65], "success": True})
    found = placed(rows)
    assert found.from_grasps.round(3).tolist() == [0.0, 0.03, 0.19]
    assert found.circle.tolist() == ["inside", "inside", "outside"]
    assert len(chosen(found, {"from_grasps": {"above": 0.05}})) == 1 == len(chosen(found, {"from_grasps":
                                                                                          {"at_most": 0.0}}))
    assert len(chosen(found, {"group": ["grid", "point"], "not a column": 1})) == 3


def test_the_papers_value_of_several_things_is_the_mean_of_its_values():
    several = [SimpleNamespace(value=value, low=value - 0.1, high=value + 0.1, paper=paper_value, above=0.0, below=None)
               for value, paper_value in ((0.2, 0.1), (0.4, 0.5), (0.3, 0.9))]
    mean = ledger._mean(several)
    assert (mean["value"], mean["paper"]) == pytest.approx((0.3, 0.5)) and mean["low"] < 0.3 < mean["high"]


def test_more_seeds_cost_what_all_parts_of_a_seed_have_cost(monkeypatch):
    spent = {"a": {"collect": 60.0, "train": 240.0, "evaluate": 60.0}, "b": {"collect": 60.0, "train": 300.0,
                                                                           "evaluate": 120.0}}
    evidence = Evidence(LAPTOP)
    monkeypatch.setattr(evidence, "stored", lambda experiment: {
        run: SimpleNamespace(seconds=seconds) for run, seconds in spent.items()})
    rows = pd.DataFrame({"run": ["a", "b"] * 50, "seed": [0, 1] * 50, "success": [True, False] * 50})
    found = evidence.with_seeds(Finding("it", 0.1, -0.1, 0.3), "table2_main", rows).design
    assert (found.seeds, found.half_width, found.minutes) == (2, pytest.approx(0.2), pytest.approx((6 + 8) / 2))
    assert found.fixed == 0 and evidence.with_seeds(Finding("", 0, 0, 0), "", rows, fixed=0.1).design.fixed == 0.1
    design = evidence.with_design(Finding("it", 0.1, -0.1, 0.3), "table2_main", [rows, rows]).design
    assert (design.seeds, design.configurations) == (2, 50)
    assert (design.half_width, design.minutes) == pytest.approx((0.2, 2 * 7.0))
    known = evidence.noise("table2_main")
    assert design.training_variance == pytest.approx(known.variance * known.degrees / (known.degrees - 2))  # at a half
    assert design.evaluation_minutes == pytest.approx(2 * 1.5 * 100 / 50)


def test_every_number_from_policies_knows_how_trainings_differ_and_how_much_room_it_had():
    """Of the shipped runs: where trainings differ much more, each interval is wider."""
    usual, noisy = Evidence(LAPTOP), Evidence(LAPTOP)
    noisy.noise = lambda experiment: TrainingNoise(10 * (known := usual.noise(experiment)).variance, known.degrees)
    tried, with_places = set(), set()
    for claim in claims():
        for each in claim.findings:
            if each.quantity in ("near_minus_far", "decay", "coverage", "lengths", "generation", "robot", "untested",
                                 "printed_ratio"):
                continue  # each seed gives a number of its own, or nothing is trained
            pairs = [QUANTITIES[each.quantity](evidence, each, each.experiment or claim.figure)
                     for evidence in (usual, noisy)]
            for one, other in zip(*pairs, strict=True):
                assert one.value == other.value and one.high - one.low < other.high - other.low or (
                    one.high == other.high == INFINITE and other.low < one.low), (claim.number, one, other)
                tried.add(each.quantity)
                with_places |= {each.quantity} if getattr(one.design, "fixed", 0) > 0 else set()
            if each.quantity == "difference":
                (one, *_), rows = pairs[0], usual.rows(each.experiment or claim.figure, each.where, each.other,
                                                       each.repetitions[0])
                assert one.room == pytest.approx(1 - rows.success.mean()), claim.number
    assert tried == {"rate", "failure", "difference", "mean_difference", "relative_gain", "budgets", "data_efficiency",
                     "ladder", "speeds"}
    assert {"rate", "failure"} <= with_places, "what configurations make of an interval, which no seed narrows"


@pytest.mark.parametrize("quantity", ["difference", "rate", "near_minus_far"])
@pytest.mark.parametrize("missing", [False, True])
def test_what_counts_as_a_whole_is_not_decided_before_its_last_run(quantity, missing):
    runs = [(variant, seed) for variant in "ba" for seed in range(4)]
    stored = range(len(runs) - missing)  # of "a", which every quantity is about, the last one or none
    asked = pd.DataFrame([{"run": place, "variant": variant, "seed": seed, "stored": place in stored, "steps": 1000}
                          for place, (variant, seed) in enumerate(runs)])
    rows = asked[asked.stored].drop(columns="stored").merge(
        pd.DataFrame({"trial": range(50), "group": "", "success": [True, False] * 25}), how="cross")
    evidence = Evidence(LAPTOP)
    vars(evidence).update(asked=lambda _: asked, stored=lambda _: {}, episodes=lambda _: rows, _minutes_a_step=0.01)
    each = data.Quantity(quantity=quantity, one={"variant": "a"}, other={"variant": "b"})
    whole, = QUANTITIES[quantity](evidence, each.model_copy(update={"options": {"whole": True}}), "decided")
    part, = QUANTITIES[quantity](evidence, each, "decided")
    assert isinstance(part, Finding) and isinstance(whole, Missing if missing else Finding)
    assert not missing or (whole.runs, whole.minutes) == (1, 10.0)


@pytest.mark.parametrize("profile, gl", [("laptop", True), ("laptop-keypoints", True), ("smoke", False),
                                         ("paper", True)])
def test_a_claim_that_a_profile_has_no_runs_for_says_so(profile, gl, tmp_path, monkeypatch):
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    monkeypatch.setattr("move.study.profiles.gl_problem", lambda: None if gl else "no GL")
    evidence = Evidence(load_profile(profile))
    for each in claims():
        if each.figure in parameters.with_runs():
            none = not parameters.runs(each.figure, evidence.profile)
            items = [item for item in findings(each, evidence) if not isinstance(item, Untested)]
            assert all(isinstance(item, Missing) for item in items), each
            said = [f"(profile {profile} has no runs for it" in item.what for item in items]
            assert said == [item.runs == 0 for item in items] and (all(said) or not none), each
            assert profile != "laptop" or not any(said), each


def test_intervals_of_demonstrations_are_those_of_drawing_each_tasks_anew():
    """Of the shipped runs, claims 30 (lengths) and 31 (shares that succeed), ten fixed tasks."""
    evidence, rng = Evidence(LAPTOP), np.random.default_rng(0)
    rows = evidence.rows("table6_collection", {"expert": "metaworld"})
    drawn = {}
    for method in ("move", "static"):
        of_tasks = [part for _, part in rows[rows.method == method].groupby("task")]
        assert len(of_tasks) == 10
        lengths = [part.steps[part.success.astype(bool)].to_numpy() for part in of_tasks]
        drawn[method] = [np.mean([rng.choice(values, (2000, len(values))).mean(axis=1) for values in each], axis=0)
                         for each in (lengths, [part.success.to_numpy(float) for part in of_tasks])]
    (longer,), (move, static) = (findings(claims()[number], evidence) for number in (29, 30))
    for item, draws in ((longer, drawn["move"][0] / drawn["static"][0] - 1), (move, drawn["move"][1]),
                        (static, drawn["static"][1])):
        low, high = np.quantile(draws, [0.025, 0.975])
        assert (item.low, item.high) == pytest.approx((low, high), abs=0.1 * (high - low)), item


@pytest.mark.parametrize("items, verdict_of, needed", [([OPEN], "undecided", 1), ([OPEN, NO], "refuted here", 0)])
def test_only_an_undecided_claim_says_what_would_decide_it(items, verdict_of, needed):
    design = Seeds(3, 0.2, 10.0)
    entry = ledger._entry(claims()[0], [replace(item, design=design) for item in items])
    assert (entry.verdict, len(entry.needed)) == (verdict_of, needed)


def test_a_trend_is_not_counted_among_the_answers_that_it_joins():
    entry = ledger._entry(claims()[27], [YES, OPEN, YES, Finding("slope", 0.07, 0.04, 0.1, trend=True)])
    assert ledger.as_table([entry]).evidence[0].startswith("yes 2, open 1, no 0 of 3; yes: 0.3")


def test_the_mean_of_factors_has_95_of_100_draws_and_takes_more_than_as_its_bound():
    draws = np.linspace(1, 3, 2001)
    factors = [SimpleNamespace(ratio=ratio, most=most, draws=each)
               for ratio, most, each in ((2.0, 8.0, draws), (INFINITE, 4.5, 9 * draws))]
    mean = quantities._mean_factor(factors, 1.0)
    assert (mean.value, mean.low, mean.high) == pytest.approx((3.0, *np.sqrt(4.5 * np.array([1.05, 2.95]))))


@pytest.mark.parametrize("change, complaint", [
    ({"quantity": "diference"}, "claim 4, quantity: 'diference' given; allowed are rate, failure, difference"),
    ({"one": {"metod": "move"}}, "claim 4, column 'metod' of table2_main given; allowed are "),
    ({"each": {"tusk": ["push"]}}, "claim 4, column 'tusk' of table2_main given; allowed are "),
])
def test_a_claim_about_what_is_not_there_is_refused_in_one_line(change, complaint):
    claim = claims()[3]
    with refused(complaint):
        findings(claim.model_copy(update={"findings": [claim.findings[0].model_copy(update=change)]}), Evidence(LAPTOP))


def test_a_value_that_no_run_has_is_named_with_what_there_is():
    claim = claims()[3]
    item, = findings(claim.model_copy(update={"findings": [claim.findings[0].model_copy(update={
        "one": {"method": "mvoe"}})]}), Evidence(LAPTOP))
    assert "has no runs for it: method 'mvoe'; there are adc, " in item.what and item.runs == 0


def test_the_robots_numbers_are_the_papers_thirty_trials_and_one_exact_test():
    item, = findings(claims()[32], Evidence(LAPTOP))
    assert item.value == pytest.approx(6 / 30) and "Barnard's exact p 0.027" in item.what
    assert "the paper's own counts" in item.what, "nobody here has a robot"


def test_each_undecided_claim_of_the_shipped_ledger_says_what_would_decide_it():
    shipped = json.loads((paths.ROOT / "paper_figures/claims.json").read_text())["claims"]
    for each in shipped:
        open_ones = [number for number in each["numbers"] if number["answer"] == "open" and not number["trend"]]
        assert len(each["needed"]) == len(open_ones) * (each["verdict"] == "undecided"), each["number"]


def test_the_ledger_for_other_programs_is_the_table_with_its_schema_and_the_claims_fingerprint(tmp_path):
    shipped = json.loads((LAPTOP.figures / "claims.json").read_text())
    assert shipped["claims_sha256"] == hashlib.sha256(data.FILE.read_bytes()).hexdigest(), "make claims"
    decided = ledger.Ledger.model_validate(shipped).claims
    table = pd.read_csv(LAPTOP.figures / "claims.csv")
    assert [one.verdict for one in decided] == table.verdict.tolist() and set(table.verdict) <= set(VERDICTS)
    ledger.save_json(decided, tmp_path)
    assert (tmp_path / "claims.schema.json").read_text() == (LAPTOP.figures / "claims.schema.json").read_text()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["claims.json", "claims.schema.json"]
    with pytest.raises(ValidationError):
        ledger.Ledger.model_validate(shipped | {"more": 1})


# a claim comes before its runs ---------------------------------------------------------------------------------------


SAID_ELSEWHERE = {7: "2945cc6", 12: "5745233", 23: "5745233", 25: "2945cc6"}
"""What was changed when a run had been made and none looked at: the hand of figures 1, 3 and 5 in `selections`, and
that a claim asked again waits for its last run. Claim -> the commit of that change; `KNOWN_DEVIATIONS.md` says so."""


def late(
    versions: list[tuple[str, dict[int, tuple[str, str]]]], runs_of: dict[int, list[str]], is_before
) -> dict[int, str]:
    """The claims that were written after one of their runs and did not say so then, and the commit that wrote them.

    Args:
        versions: commit and claims (number -> what decides it, what it says was changed), the oldest first; what the
            first one has is exempt.
        runs_of: number -> the commits of its runs.
        is_before: whether a commit is another one or before it.
    """
    found = {}
    for number, (content, _) in versions[-1][1].items():
        place = next(place for place, (_, there) in enumerate(versions) if there.get(number, ("",))[0] == content)
        before, now = (versions[each][1].get(number, ("", ""))[1] for each in (place - 1, place))
        if place and now == before and not all(is_before(versions[place][0], run) for run in runs_of[number]):
            found[number] = versions[place][0]
    return found


@pytest.mark.parametrize("changed, late_ones", [("", {2: "c"}), ("a margin of 2", {}), ("told before", {2: "c"})])
def test_a_claim_that_is_late_is_found_unless_it_says_so_with_that_change(changed, late_ones):
    told = "told before" * (changed == "told before")
    versions = [("a", {1: ("x", "")}), ("b", {1: ("x", ""), 2: ("y", told)}), ("c", {1: ("x", ""), 2: ("z", changed)})]
    runs, order = {1: ["a"], 2: ["b", "c"]}, "abc"
    assert late(versions, runs, lambda one, other: order.index(one) <= order.index(other)) == late_ones
    assert late(versions[:2], runs, lambda one, other: order.index(one) <= order.index(other)) == {}


def test_a_claim_that_was_added_since_was_committed_before_its_runs():
    """From git: what decides a claim is older than its runs' commits, or the claim says what was changed."""
    where = data.FILE.relative_to(paths.ROOT).as_posix()
    commits = git("log", "--format=%H", "--reverse", "--", where).split()
    if not commits:
        pytest.fail(f"{where} is not in git")

    def decisive(text: str) -> dict[int, tuple[str, str]]:
        return {each.number: (each.model_dump_json(exclude={"quote", "short", "place", "changed"}), each.changed)
                for each in read(text)}

    versions = [(commit, decisive(git("show", f"{commit}:{where}"))) for commit in commits]
    versions.append(("not committed", decisive(data.FILE.read_text())))
    shipped = json.loads((LAPTOP.figures / "claims.json").read_text())["claims"]
    runs = {one["number"]: [json.loads(path.read_text())["provenance"]["commit"] for run in one["runs"]
                            if (path := LAPTOP.results / f"{run}.json").exists()] for one in shipped}

    @cache
    def is_before(one: str, other: str) -> bool:
        known = subprocess.run(["git", "merge-base", "--is-ancestor", one, other.rstrip("+")], cwd=paths.ROOT,
                               capture_output=True)
        return known.returncode == 0

    found = {number: commit[:7] for number, commit in late(versions, runs, is_before).items()}
    assert found == SAID_ELSEWHERE
