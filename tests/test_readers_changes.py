"""What a reader changes has folders of its own, says so, and neither overwrites what is shipped nor fails the tests."""

import io
import json
import re
import subprocess

import pytest
from conftest import notebooks_in_git
from rich.console import Console

from move import paths
from move.errors import BadInput
from move.figures import fig1_sparse, names
from move.figures.page import changes, data, kept, kernels, parameters
from move.figures.page.make import make, steps
from move.figures.plots import style
from move.study import execute
from move.study.profiles import load_profile
from move.study.results import Result, store

LAPTOP = load_profile("laptop")


@pytest.fixture
def browser(monkeypatch):
    """A kernel that no command started."""
    monkeypatch.delenv(changes.BY_COMMAND, raising=False)
    monkeypatch.setattr(changes, "get_ipython", object)


@pytest.mark.parametrize("name", names())
def test_only_a_command_with_the_profiles_own_parameters_writes_what_is_shipped(name, browser, monkeypatch):
    own = parameters.parameters(name, LAPTOP)
    places = {changes.change(name, LAPTOP, own | {key: "another"}).folder for key in own}
    assert len(places) == len(own)
    assert all(place.parent == paths.BUILD / "figures" and place.name.startswith(f"{name}-") for place in places)
    for given in (own, {}):
        assert changes.change(name, LAPTOP, given).folder == paths.BUILD / "figures" / "laptop"
    monkeypatch.setenv(changes.BY_COMMAND, "1")
    assert changes.change(name, LAPTOP, own).folder == LAPTOP.figures
    monkeypatch.delenv(changes.BY_COMMAND)
    monkeypatch.setattr(changes, "get_ipython", lambda: None)  # no notebook at all
    assert changes.change(name, LAPTOP, own).folder == LAPTOP.figures


def test_a_changed_picture_says_how_in_large_letters_and_the_page_says_where(browser, tmp_path, monkeypatch):
    pictures = []
    save = style.save
    monkeypatch.setattr(style, "save", lambda figure, *where: (pictures.append(figure), save(figure, *where)))
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    made = make("statistics", "laptop", seeds=[1, 2], draws=20, rate=0.4)
    (over,) = [text for text in pictures[0].texts if "draws" in text.get_text()]
    assert "Not the shipped figure" in over.get_text() and over.get_fontsize() >= 8
    assert all(told in over.get_text() for told in ("draws 20 (2,000)", "seeds 1, 2 (1, 2, 3, 5)"))
    assert "rate" not in over.get_text()
    (folder,) = (tmp_path / "build/figures").iterdir()
    assert {path.name for path in folder.iterdir()} == {
        f"statistics.{kind}" for kind in ("png", "pdf", "csv", "tex", "caption.md")}
    assert folder.name in made.answer.data and "draws 20" in made.answer.data
    assert not (tmp_path / "paper_figures").exists()


def test_what_is_shipped_is_read_and_what_is_new_is_stored_elsewhere(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    asked = fig1_sparse.runs(LAPTOP, "keypoints", timesteps=1500, seeds=2, identical_starts=0)
    rows = [{"trial": 0, "group": "grid", "success": True, "steps": 3}]
    results = [Result(run.spec, rows, None, None, {"train": 1.0}, {}) for run in asked]
    store(results[0], LAPTOP.results)
    toys = {result.spec.hash: result for result in results}
    monkeypatch.setattr("move.study.results.read", lambda path: toys[path.stem])  # whose files would be refused
    computed = []

    def compute(specs, folder):
        computed.append((specs, folder))
        return results[1:], []

    monkeypatch.setattr(data, "execute", compute)
    loaded = data.load_or_run(asked, LAPTOP, tmp_path)
    assert [result.spec for result in loaded.results] == [run.spec for run in asked]
    assert computed == [([run.spec for run in asked[1:]], tmp_path / "build/results/laptop")]
    assert len(list((tmp_path / "results/laptop").iterdir())) == 1


def test_a_changed_notebook_runs_to_its_end_beside_what_is_shipped(tmp_path, monkeypatch):
    (tmp_path / "results").symlink_to(paths.ROOT / "results")
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    kernels.run_notebook("statistics", LAPTOP, {"draws": 20}, stored_only=True)
    told = changes.change("statistics", LAPTOP, {"draws": 20})
    assert (told.folder / "statistics.png").exists() and not (tmp_path / "paper_figures").exists()


def test_a_bar_ends_at_a_hundred_per_cent_and_a_narrow_page_cuts_the_description_alone(browser, monkeypatch):
    drawn = io.StringIO()
    monkeypatch.setattr(execute, "Console", lambda stderr: Console(file=drawn, width=60, force_terminal=True))
    assert list(steps(["a", "b"], "a task with a long name " * 5)) == ["a", "b"]
    last = drawn.getvalue()[drawn.getvalue().rindex("%") - 3:]
    assert last.startswith("100%") and "0:00:0" in last and len(re.sub(r"\x1b\S*?[A-Za-z]", "", last)) <= 60


def test_a_figures_files_are_listed_with_its_pictures_first():
    listed = [path.name for path in kept.files_of("fig1_sparse", LAPTOP.figures)]
    assert listed[:3] == ["fig1_sparse.png", "fig1_sparse.pdf", "fig1_sparse.caption.md"]
    assert {"fig1_sparse.csv", "fig1_sparse_hand.tex"} <= set(listed) and len(listed) == len(set(listed))


def test_no_file_is_of_two_figures_though_one_has_a_name_that_begins_as_the_others():
    owners = [path for name in names() for path in kept.files_of(name, LAPTOP.figures)]
    assert len(owners) == len(set(owners)) > 100 and "decided.csv" in {path.name for path in owners}


def test_bad_input_in_a_notebook_is_one_line():
    assert BadInput("seeds: -1 given")._render_traceback_()[0].endswith("BadInput\x1b[0m: seeds: -1 given")


def test_tests_read_a_notebook_as_git_has_it(tmp_path, monkeypatch):
    (tmp_path / "notebooks").mkdir()
    here = tmp_path / "notebooks/a.ipynb"
    here.write_text(json.dumps({"cells": ["committed"]}))
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "NOTEBOOKS", tmp_path / "notebooks")
    assert notebooks_in_git(str(tmp_path / "none")) == tmp_path / "notebooks"  # no git, no copy
    for command in (["init", "-q"], ["add", "notebooks"]):
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    here.write_text(json.dumps({"cells": ["played with"]}))
    assert json.loads((notebooks_in_git(str(tmp_path / "copy")) / "a.ipynb").read_text()) == {"cells": ["committed"]}
