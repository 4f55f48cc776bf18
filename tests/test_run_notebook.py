"""How a notebook is run, without a kernel: its parameters, what the kernel finds, and what happens when it dies."""

import contextlib
import os
import time

import nbformat
import pytest
from nbclient.exceptions import DeadKernelError

from move import paths
from move.errors import BadInput
from move.figures.page import kernels, parameters
from move.figures.page.changes import BY_COMMAND
from move.study.profiles import Profile, load_profile

SMOKE = load_profile("smoke")


class Starts:
    """Stands in for papermill: each start ends in the next of `ends`, an error or how many cells were executed."""

    def __init__(self, *ends: Exception | int) -> None:
        self.ends, self.started = list(ends), []

    def __call__(self, source, executed, parameters, **options):
        self.started.append({"source": source, "executed": executed, "parameters": parameters, **options,
                             "environment": {name: os.environ.get(name) for name in (BY_COMMAND, "MOVE_STORED_ONLY")}})
        end = self.ends.pop(0)
        if isinstance(end, Exception):
            raise end
        cells = [nbformat.v4.new_code_cell("1", execution_count=place + 1 if place < end else None)
                 for place in range(3)]
        return nbformat.v4.new_notebook(cells=[*cells, nbformat.v4.new_code_cell("")])


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Run notebook `table4` with the given kernels; returns them and what came of it."""
    monkeypatch.setattr(paths, "BUILD", tmp_path)

    def run(starts: Starts, name: str = "table4_hyperparameters", **given):
        monkeypatch.setattr("papermill.execute_notebook", starts)
        return kernels.run_notebook(name, SMOKE, **given)

    return run


def test_the_executed_copy_lies_under_build_and_the_profile_is_a_parameter(start, tmp_path):
    starts = Starts(3)
    assert start(starts) == tmp_path / "notebooks/smoke/table4_hyperparameters.ipynb"
    (one,) = starts.started
    assert one["source"] == paths.NOTEBOOKS / "table4_hyperparameters.ipynb" and one["cwd"] == paths.NOTEBOOKS
    assert one["parameters"]["profile"] == "smoke" and one["kernel_name"] == "python3"


def test_a_readers_changes_come_after_the_profiles_own_parameters(start):
    """As lists, for papermill writes a tuple as a text."""
    starts = Starts(3)
    start(starts, "few_demonstrations", changes={"seeds": 4}, stored_only=True)
    (one,) = starts.started
    own = parameters.parameters("few_demonstrations", SMOKE)
    given = {**own, "seeds": 4, "timesteps": list(own["timesteps"]), "profile": "smoke"}
    assert one["parameters"] == given and own["seeds"] != 4


@pytest.mark.parametrize("stored_only", [True, False])
def test_a_kernel_knows_who_started_it_and_nobody_after_it_does(start, monkeypatch, stored_only):
    monkeypatch.delenv(BY_COMMAND, raising=False)
    monkeypatch.setenv("MOVE_STORED_ONLY", "0")
    starts = Starts(3)
    start(starts, stored_only=stored_only)
    assert starts.started[0]["environment"] == {BY_COMMAND: "1", "MOVE_STORED_ONLY": "1" if stored_only else "0"}
    assert BY_COMMAND not in os.environ and os.environ["MOVE_STORED_ONLY"] == "0"


@pytest.mark.parametrize("death", [DeadKernelError("Kernel died"), RuntimeError("no port"), 2])
def test_a_kernel_that_dies_is_started_once_more_and_then_told_with_the_executed_copy(start, death):
    assert start(Starts(death, 3)).name == "table4_hyperparameters.ipynb"
    starts = Starts(death, death)
    with pytest.raises(kernels.NotebookFailed) as told:
        start(starts)
    executed = starts.started[0]["executed"]
    assert len(starts.started) == 2 and f"(see {executed.parent.parent / executed.name})" in str(told.value)
    assert ("before the last cell" if death == 2 else str(death)) in str(told.value)


@pytest.mark.parametrize("end, left", [(3, "new"), (DeadKernelError("Kernel died"), "new"),
                                       (OSError(28, "No space left on device"), "old")])
def test_an_executed_copy_is_replaced_in_one_step_once_it_is_written(start, tmp_path, end, left):
    executed = tmp_path / "notebooks/smoke/table4_hyperparameters.ipynb"
    executed.parent.mkdir(parents=True)
    executed.write_text("old")

    class Writes(Starts):
        def __call__(self, source, under_way, parameters, **options):
            assert under_way != executed and under_way.suffix == ".ipynb" and not under_way.exists()
            under_way.write_text("new")
            assert executed.read_text() in ("old", "new" if self.started else "old")
            return super().__call__(source, under_way, parameters, **options)

    with contextlib.nullcontext() if end == 3 else pytest.raises((kernels.NotebookFailed, OSError)):
        start(Writes(end, end))
    assert executed.read_text() == left and not any((executed.parent / "under_way").iterdir())


def test_what_is_wrong_in_a_cell_is_not_tried_again(start, monkeypatch):
    from papermill.exceptions import PapermillExecutionError

    starts = Starts(PapermillExecutionError(1, 1, "source", "KeyError", "'a'", []), 3)
    with pytest.raises(kernels.NotebookFailed, match="KeyError: 'a'"):
        start(starts)
    assert len(starts.started) == 1 and BY_COMMAND not in os.environ


def test_a_parameter_that_the_notebook_does_not_have_starts_no_kernel(start):
    starts = Starts(3)
    with pytest.raises(BadInput, match="has no parameter budget"):
        start(starts, changes={"budget": 5})
    with pytest.raises(BadInput, match="nothing_like_it"):
        start(starts, "nothing_like_it")
    assert not starts.started


def test_the_runs_that_are_watched_are_those_without_a_result_each_once(tmp_path, monkeypatch):
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    name, change = "table1_spatial_factors", {"seeds": 2}
    wanted = list(dict.fromkeys(spec.hash for spec in parameters.specs(name, SMOKE, {"seeds": 2})))
    assert kernels.missing_runs(name, SMOKE, change) == wanted
    assert len(wanted) > len(kernels.missing_runs(name, SMOKE, {}))
    (tmp_path / f"{wanted[0]}.json").write_text("{}")
    assert kernels.missing_runs(name, SMOKE, change) == wanted[1:]
    assert kernels.missing_runs("table4_hyperparameters", SMOKE, {}) == [], "which needs no runs"


def test_notebooks_are_forks_of_this_process_and_each_ends_as_it_does(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "RUNS", tmp_path)
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path / "none"))  # none
    monkeypatch.setattr(kernels, "LOOKS", 0.05)
    missing = kernels.missing_runs("rollouts", SMOKE, {})
    (tmp_path / missing[0]).mkdir()
    (tmp_path / missing[0] / "progress").write_text("train 50 100")

    def run(name, profile, changes, stored_only):
        if name == "rollouts":
            time.sleep(1)
            return tmp_path / name
        if name == "fig7_speed":
            os._exit(9)
        raise {"gap": BadInput, "fig1_sparse": kernels.NotebookFailed}[name](f"{name}: no")

    monkeypatch.setattr(kernels, "run_notebook", run)
    seen = []
    asked = ["gap", "rollouts", "fig1_sparse", "fig7_speed"]
    ended = kernels.run_notebooks(asked, SMOKE, {}, on_progress=lambda *so_far: seen.append(so_far))
    done = {one.name: one for one in ended}
    assert done["rollouts"].executed == tmp_path / "rollouts" and done["rollouts"].problem is None
    assert isinstance(done["gap"].problem, BadInput) and str(done["gap"].problem) == "gap: no"
    assert isinstance(done["fig1_sparse"].problem, kernels.NotebookFailed)
    assert "killed" in str(done["fig7_speed"].problem) and list(done) == asked
    assert (["rollouts"], pytest.approx(1 + 0.475 / len(missing)), 0, len(missing)) in seen
