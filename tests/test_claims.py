"""Verdicts follow from numbers by one rule, claims are data, and both change when the numbers do."""

import hashlib
import json
import math
import subprocess
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import git
from pydantic import ValidationError
from shared import refused

from move import paper, paths
from move.claims import claims as data
from move.claims import ledger
from move.claims.claims import claims, read
from move.claims.evidence import Evidence, chosen, placed
from move.claims.quantities import QUANTITIES, findings
from move.figures.page import parameters
from move.statistics.needed import Design, Seeds, Trials
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
    ([Finding("", 0.02, -0.3, 0.34)] * 3, "every", "undecided"),
    ([Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094)], "every", "at the ceiling"),
    ([YES, Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.094)], "every", "at the ceiling"),
    ([Finding("", 0.03, -0.04, 0.11, paper=0.228, room=0.5)], "every", "undecided"),
    ([Finding("", 0.06, 0.02, 0.08, paper=0.228, room=0.094)], "every", "reproduced, smaller"),  # a yes comes first
    ([NO], "every", "refuted here"),
    ([YES, NO], "every", "refuted here"),
    ([BARELY], "every", "refuted here"),
    ([YES, YES, YES, BARELY], "every", "direction only"),  # no longer a no after Holm's adjustment
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
    design = Design(seeds=1, configurations=100, training_variance=0.00115, minutes=30.0, evaluation_minutes=4.0)
    minutes = [float(design.needed(distance).split("about ")[1].split()[0]) for distance in (0.07, 0.1, 0.15)]
    assert minutes == sorted(minutes, reverse=True) and minutes[0] > minutes[-1]
    assert design.half_width(1, 100) == pytest.approx(1.96 * math.sqrt(0.0034 + 0.0023))  # .076, measured on table 2
    assert "would not tell" in Design(1, 100, 0.05, 30.0, 4.0).needed(0.05)
    assert Trials(7 / 30, 7 / 30).needed(0.1).startswith("138 trials")
    assert Seeds(3, 0.2, 10.0).needed(0.1) == "12 seeds, about 90 core-minutes, would tell it to +-0.1"
    assert Seeds(3, 0.1, 10.0).needed(0.2).startswith("4 seeds") and "would not tell" in Seeds(3, 0.9, 1.0).needed(0)
    undecided = Finding("a", 0.1, -0.1, 0.3, design=design)
    assert undecided.needed.startswith("a: ") and not Finding("a", 0.3, 0.2, 0.4, design=design).needed


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
    several = [SimpleNamespace(value=value, low=value - 0.1, high=value + 0.1, paper=paper_value)
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
    design = evidence.design("table2_main", [rows, rows])
    assert (design.seeds, design.configurations) == (2, 50) and design.minutes == pytest.approx(2 * 7.0)
    assert design.evaluation_minutes == pytest.approx(2 * 1.5 * 100 / 50)


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
            said = [f"(profile {profile} has no runs for it)" in item.what for item in items]
            assert said == [item.runs == 0 for item in items] and (all(said) or not none), each
            assert profile != "laptop" or not any(said), each


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


def late(versions: list[tuple[str, dict[int, str]]], runs_of: dict[int, list[str]], changed: dict[int, bool],
         is_before) -> list[int]:
    """The claims that were written after one of their runs and do not say so.

    Args:
        versions: commit and claims (number -> what decides it), the oldest first; what the first one has is exempt.
        runs_of: number -> the commits of its runs.
        is_before: whether a commit is another one or before it.
    """
    (_, first), (_, last) = versions[0], versions[-1]
    found = []
    for number, content in last.items():
        if first.get(number) == content or changed[number]:
            continue
        since = next(commit for commit, there in versions if there.get(number) == content)
        if not all(is_before(since, run) for run in runs_of[number]):
            found.append(number)
    return found


def test_a_claim_that_is_late_is_found():
    versions = [("a", {1: "x"}), ("b", {1: "x", 2: "y"}), ("c", {1: "x", 2: "z"})]
    runs, order = {1: ["a"], 2: ["b", "c"]}, "abc"
    assert late(versions, runs, {1: False, 2: False}, lambda one, other: order.index(one) <= order.index(other)) == [2]
    assert late(versions, runs, {1: False, 2: True}, lambda one, other: order.index(one) <= order.index(other)) == []
    assert late(versions[:2], runs, {1: False, 2: False}, lambda one, other: order.index(one) <= order.index(other)
                ) == []


def test_a_claim_that_was_added_since_was_committed_before_its_runs():
    """From git: what decides a claim is older than its runs' commits, or the claim says what was changed."""
    where = data.FILE.relative_to(paths.ROOT).as_posix()
    commits = git("log", "--format=%H", "--reverse", "--", where).split()
    if not commits:
        pytest.fail(f"{where} is not in git")

    def decisive(text: str) -> dict[int, str]:
        return {each.number: each.model_dump_json(exclude={"quote", "short", "place", "figure", "changed"})
                for each in read(text)}

    versions = [(commit, decisive(git("show", f"{commit}:{where}"))) for commit in commits]
    versions.append(("not committed", decisive(data.FILE.read_text())))
    shipped = json.loads((LAPTOP.figures / "claims.json").read_text())["claims"]
    runs = {one["number"]: {json.loads((LAPTOP.results / f"{run}.json").read_text())["provenance"]["commit"]
                            for run in one["runs"] if (LAPTOP.results / f"{run}.json").exists()}
            for one in shipped if versions[0][1].get(one["number"]) != versions[-1][1].get(one["number"])}

    def is_before(one: str, other: str) -> bool:
        known = subprocess.run(["git", "merge-base", "--is-ancestor", one, other.rstrip("+")], cwd=paths.ROOT,
                               capture_output=True)
        return known.returncode == 0

    changed = {each.number: bool(each.changed) for each in claims()}
    assert late(versions, {number: list(runs.get(number, [])) for number in changed}, changed, is_before) == []
