"""`move compare`: two evaluations at the same configurations, or a line on why they are not."""

import json
import re
from importlib.metadata import version

import numpy as np
import pytest
from shared import move

from move.errors import BadInput
from move.figures.page import parameters
from move.statistics.paired import exact_difference
from move.study import compare, results
from move.study.profiles import load_profile
from move.study.provenance import DECIDING

HERE = {name: version(name) for name in DECIDING}


def printed(successes, task="push", **changes):
    """What `move evaluate --json` prints."""
    rows = [{"trial": number, "group": "random", "object_x": number / 7, "object_y": 0.5, "success": bool(success),
             "steps": 9} for number, success in enumerate(successes)]
    return {"agent": "policy", "task": task, "rows": rows, "provenance": {"versions": HERE}} | changes


@pytest.fixture
def files(tmp_path):
    def write(*contents):
        for name, content in zip("AB", contents, strict=True):
            (tmp_path / name).write_text(content if isinstance(content, str) else json.dumps(content))
        return [str(tmp_path / name) for name in "AB"]
    return write


@pytest.mark.parametrize("seed, apart", [(0, 0.0), (1, 0.3), (2, -0.4)])
def test_the_difference_is_that_of_the_paired_episodes(capsys, files, seed, apart):
    rng = np.random.default_rng(seed)
    one, other = rng.random(80) < 0.5 + apart / 2, rng.random(80) < 0.5 - apart / 2
    expected = exact_difference(one, other)
    code, out, _ = move(capsys, "compare", *files(printed(one), printed(other)), "--json")
    found = json.loads(out)
    assert code == 0 and found["task"] == "push"
    for name in ("value", "low", "high", "p_value"):
        assert found["difference"][name] == pytest.approx(getattr(expected, name))
    assert (found["first_rate"]["value"], found["second_rate"]["value"]) == (one.mean(), other.mean())
    assert found["difference"]["value"] == pytest.approx(one.mean() - other.mean())


@pytest.mark.parametrize("won, lost, count, p", [
    (2, 0, 2, 0.5), (6, 0, 6, 0.03125), (20, 0, 20, 2 / 2**20), (5, 0, 20, 0.0625), (8, 1, 20, 0.0390625),
    (3, 0, 3, 0.25), (1, 1, 2, 1.0), (0, 0, 10, 1.0), (40, 20, 100, 0.013489293712)])
def test_few_configurations_that_tell_two_apart_make_nobody_sure(won, lost, count, p):
    one, other = np.zeros((2, count), bool)
    one[:won], other[won:won + lost] = True, True
    found, turned = exact_difference(one, other), exact_difference(other, one)
    assert found.p_value == pytest.approx(p) and found.value == pytest.approx((won - lost) / count)
    assert p < 0.05 or found.low <= 0, "the interval is no surer than p"
    assert -1 <= found.low <= found.value <= found.high <= 1 and found.high - found.low > 0.01
    assert (turned.low, turned.high) == pytest.approx((-found.high, -found.low))


def test_intervals_hold_the_difference_as_often_as_they_say():
    rng, inside = np.random.default_rng(3), []
    for count, rates in ((10, (0.9, 0.6)), (25, (0.5, 0.5)), (60, (0.3, 0.2))) * 120:
        one, other = (rng.random(count) < rate for rate in rates)
        found = exact_difference(one, other)
        inside.append(found.low <= rates[0] - rates[1] <= found.high)
    assert np.mean(inside) >= 0.94


def test_a_line_says_it_all_and_pairing_narrows_it(capsys, files):
    one = np.tile([1, 1, 1, 0], 15)
    other = np.where(np.arange(60) < 12, 0, one)
    code, out, _ = move(capsys, "compare", *files(printed(one), printed(other)))
    assert code == 0 and out.count("\n") == 1
    assert "A 0.750 minus" in out and "B 0.600: +15.0 points [+" in out and "p = 0.00" in out
    low, high = map(float, re.search(r"\[([+-][\d.]+), ([+-][\d.]+)\]", out).groups())
    expected = exact_difference(one, other)
    assert (low, high) == pytest.approx((100 * expected.low, 100 * expected.high), abs=0.051)
    assert "paired at 60 configurations of push" in out and "trainings differ is not counted" in out
    assert "0.0 points [" in str(compare.compare(*[compare.read_evaluation(name, []) for name in files(
        printed(one), printed(one))]))


def test_episodes_at_a_policys_own_training_points_do_not_count(capsys, files):
    one, other = printed([1, 1, 1, 0, 0, 0]), printed([0, 0, 1, 0, 1, 1])
    for content in (one, other):
        for row in content["rows"][-2:]:
            row["group"] = "point"
    code, out, _ = move(capsys, "compare", *files(one, other))
    assert code == 0 and "paired at 4 configurations" in out and "A 0.750 minus" in out and "B 0.250: +50.0" in out


def test_two_stored_runs_by_their_hashes_and_a_run_with_itself(capsys):
    profile = load_profile("laptop")
    runs = {run.spec.method: run.spec for run in parameters.runs("table2_main", profile)
            if run.spec.task == "pick-place" and run.spec.seed == 0 and run.spec.observation == "rgb"}
    code, out, _ = move(capsys, "compare", runs["move"].hash, runs["static"].hash, "--json")
    found = json.loads(out)
    rates = [results.load(runs[method], profile.results).rate for method in ("move", "static")]
    assert code == 0 and found["difference"]["value"] == pytest.approx(rates[0] - rates[1])
    assert found["difference"]["low"] > 0 and found["first_rate"]["p_value"] is None and "NaN" not in out
    code, out, _ = move(capsys, "compare", runs["move"].hash, runs["move"].hash)
    assert code == 0 and "0.0 points" in out


@pytest.mark.parametrize("change, says", [
    ({"success_rate": 0.9}, "success_rate is 0.9, its rows say 0.5"), ({"success_rate": "high"}, "success_rate"),
    ({"success_rate": float("nan")}, "success_rate"), ({"episodes": 20}, "episodes is 20, it has 4 rows"),
    ({"rows": [{"trial": n, "group": "random", "object_x": n / 7, "success": True} for n in range(4)],
      "success_rate": 1.0}, "did not begin in the same configuration")])
def test_what_a_file_says_of_itself_and_where_it_began_has_to_fit(capsys, files, change, says):
    right = printed([1, 0, 1, 0], success_rate=0.5)
    assert move(capsys, "compare", *files(right, right))[0] == 0
    for order in (0, 1):
        code, out, err = move(capsys, "compare", *files(*[right, right | change][:: 1 - 2 * order]))
        assert code == 2 and says in err and not out


@pytest.mark.parametrize("made, said", [
    (HERE, []), (HERE | {"torch": f"{HERE['torch'].split('+')[0]}+cu130"}, []),
    (HERE | {"mujoco": "2.3.7"}, ["1 run with mujoco 2.3.7"]),
    ({name: HERE[name] for name in DECIDING if name != "numpy"}, ["1 run with numpy unknown"]),
    ({}, ["1 run with versions that were not recorded"])])
def test_evaluations_of_other_versions_are_named(capsys, files, made, said):
    other = printed([1, 0, 1, 1], provenance={"versions": made, "source": "x"})
    code, out, _ = move(capsys, "compare", *files(printed([1, 0, 1, 0]), other), "--json")
    assert code == 0 and json.loads(out)["other_versions"] == said
    code, out, _ = move(capsys, "compare", *files(printed([1, 0, 1, 0]), other))
    assert ("; other versions than here computed" in out) == bool(said) and all(one in out for one in said)


def test_a_stored_run_of_other_versions_is_named(capsys, tmp_path):
    profile = load_profile("laptop")
    specs = [run.spec for run in parameters.runs("table2_main", profile) if run.spec.task == "push"][:2]
    made = [results.load(spec, profile.results) for spec in specs]
    made[1].provenance["versions"] |= {"metaworld": "3.0.0", "numpy": "1.26.4"}
    found = compare.compare(*(compare.read_evaluation(str(results.store(one, tmp_path)), []) for one in made))
    assert found.other_versions == ["1 run with metaworld 3.0.0", "1 run with numpy 1.26.4"]
    again = compare.read_evaluation(specs[1].hash, [tmp_path / "nothing", tmp_path])
    assert again.provenance["versions"]["numpy"] == "1.26.4"


def test_what_evaluate_prints_says_what_computed_it(capsys, tmp_path):
    for name, agent in (("A", "random"), ("B", "nothing")):
        code, out, _ = move(capsys, "evaluate", "--agent", agent, "--task", "push", "--episodes", "2", "--json")
        (tmp_path / name).write_text(out)
        made = json.loads(out)["provenance"]
        assert code == 0 and made["versions"]["mujoco"] == HERE["mujoco"] and made["source"]
    code, out, _ = move(capsys, "compare", str(tmp_path / "A"), str(tmp_path / "B"))
    assert code == 0 and "paired at 2 configurations of push" in out and "other versions" not in out


def moved(content):
    content["rows"][3]["object_x"] += 1e-6
    return content


@pytest.mark.parametrize("second, message", [
    (printed([1, 0, 1, 1], task="hammer"), "is of push, .* of hammer; allowed is one task"),
    (printed([1, 0, 1]), "4 and 3 episodes; allowed is one number in both"),
    (moved(printed([1, 0, 1, 1])), "trial 3 of .* did not begin in the same configuration"),
    (printed([1, 0, 1, 1], rows=printed([1, 0, 1, 1])["rows"][::-1]), "did not begin in the same configuration"),
    (printed([1] * 4, rows=[{"trial": n, "group": "random", "success": True} for n in range(4)]), "did not begin"),
    (printed([1] * 4, rows=[{"trial": 0, "group": "random", "success": 1}]), "success: 1 given; input should be"),
    (printed([1] * 4, rows=printed([1, 0, 1, 1])["rows"] * 2), "trial 0 stands there more than once"),
    (printed([1, 0, 1, 1], task="push\x1b[2J"), "task: .*should match pattern"),
    (printed([1] * 4, rows=[]), "rows: .*at least 1"),
    (printed([1] * 4, rows=[5]), "rows.0: 5 given"),
    ({"task": "push"}, "rows: .*field required; allowed is what `move evaluate --json` prints"),
    ({"spec": 5, "rows": []}, "is not usable"),
    ("[]", "expected a JSON object"), ("{", "cannot read"), ("[" * 9000, "cannot read"),
])
def test_what_cannot_be_compared_is_one_line(capsys, files, second, message):
    code, out, told = move(capsys, "compare", *files(printed([1, 0, 1, 1]), second))
    assert (code, out) == (2, "") and told.count("\n") == 1 and re.search(message, told), told


@pytest.mark.parametrize("given", ["nowhere.json", "0" * 16, "/", "", "../results"])
def test_what_is_not_there_is_one_line(given, tmp_path):
    with pytest.raises(BadInput, match="given; allowed is (a file of `move evaluate --json`, or )?the hash of a run"):
        compare.read_evaluation(given, [tmp_path])
