"""A result that is not what it says is found."""

import dataclasses
import json

import numpy as np
import pytest
import typer.testing
from recipes import tiny_run

from move import cli
from move.study import results, run, verify
from move.study.profiles import Profile, load_profile


@pytest.fixture(scope="module")
def honest(tmp_path_factory):
    folder = tmp_path_factory.mktemp("honest")
    return run.run(tiny_run(), folder / "results", scratch=folder / "runs")


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_an_honest_result_is_the_same(honest, tmp_path):
    results.store(honest, tmp_path)
    (row,) = verify.verify([honest.spec], tmp_path, 1, rng())
    assert row["same"] and row["judged"] == "row by row" and row["difference"] == "none"


def test_a_row_changed_under_a_fitting_digest_is_found_and_named(honest, tmp_path):
    rows = [dict(row) for row in honest.rows]
    rows[1]["steps"] -= 1
    results.store(dataclasses.replace(honest, rows=rows), tmp_path)
    assert verify.check_files(tmp_path)[0]["same"]  # no file check can see it
    (row,) = verify.verify([honest.spec], tmp_path, 1, rng())
    assert not row["same"] and row["difference"] == "row 1: steps 199, recomputed 200"


def test_columns_that_only_new_results_have_are_no_difference(honest, tmp_path):
    old = [{name: value for name, value in row.items() if not name.startswith("hand")} for row in honest.rows]
    results.store(dataclasses.replace(honest, rows=old), tmp_path)
    assert verify.verify([honest.spec], tmp_path, 1, rng())[0]["same"]


@pytest.mark.parametrize("outcome, same", [(False, True), (True, False)])
def test_on_another_processor_the_rate_is_judged_and_not_the_bits(honest, tmp_path, outcome, same):
    """Three failures fit a rate of 0 whatever their steps; three successes do not."""
    rows = [{**row, "success": outcome, "success_steps": 10 * outcome, "steps": 7} for row in honest.rows]
    provenance = {**honest.provenance, "processor": "another"}
    results.store(dataclasses.replace(honest, rows=rows, provenance=provenance), tmp_path)
    (row,) = verify.verify([honest.spec], tmp_path, 1, rng())
    assert row["same"] is same and "other processor" in row["judged"]
    assert (row["stored_rate"], row["recomputed_rate"]) == (float(outcome), 0.0)


def test_a_sample_holds_a_run_from_pixels_and_none_twice(honest):
    stored = [dataclasses.replace(honest, spec=tiny_run(seed)) for seed in range(30)]
    pixels = dataclasses.replace(honest, spec=tiny_run(99, observation="rgb"))
    for seed in range(10):
        drawn = verify.draw_sample([*stored, pixels, *stored], 5, rng(seed))
        assert pixels in drawn and len({result.spec.hash for result in drawn}) == 5
    samples = {tuple(result.spec.seed for result in verify.draw_sample(stored, 5, rng(seed))) for seed in range(10)}
    assert len(samples) > 5


@pytest.fixture
def tampered(honest, tmp_path, monkeypatch):
    rows = [{**row, "steps": 1} for row in honest.rows]
    results.store(dataclasses.replace(honest, rows=rows), tmp_path)
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    monkeypatch.setattr(cli.study, "chosen_specs", lambda profile, figures: {"figure": [honest.spec]})
    return next(tmp_path.glob("*.json"))


def test_a_difference_ends_the_command_with_exit_code_1(tampered):
    outcome = typer.testing.CliRunner().invoke(cli.app, ["verify"])
    assert outcome.exit_code == 1 and "recomputed 200" in " ".join(outcome.output.split())
    assert "--seed" in outcome.output


def test_a_run_named_by_its_hash_is_recomputed_and_nothing_else(tampered, honest, tmp_path):
    runner = typer.testing.CliRunner()
    outcome = runner.invoke(cli.app, ["verify", honest.spec.hash, "--json"])
    (row,) = json.loads(outcome.stdout)
    assert outcome.exit_code == 1 and row["hash"] == honest.spec.hash and row["difference"] == (
        "row 0: steps 1, recomputed 200")
    results.store(honest, tmp_path)
    assert runner.invoke(cli.app, ["verify", honest.spec.hash]).exit_code == 0


def test_checking_every_file_ends_with_exit_code_1_at_a_damaged_one(tampered):
    runner = typer.testing.CliRunner()
    assert runner.invoke(cli.app, ["verify", "--all"]).exit_code == 0
    tampered.write_text(tampered.read_text().replace('"seed":0', '"seed":1'))
    assert runner.invoke(cli.app, ["verify", "--all"]).exit_code == 1


def test_all_shipped_results_fit_their_digests_and_their_names():
    rows = verify.check_files(load_profile("laptop").results)
    assert len(rows) > 60 and [row for row in rows if not row["same"]] == []
