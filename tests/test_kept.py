"""A figure that simulates is shown as it was made only if all that was written of it is there, to the last bit."""

import json
import shutil
from dataclasses import replace

import pytest

from move import paths
from move.figures.page import kept, parameters
from move.figures.page.data import Data, load_or_run
from move.study.profiles import load_profile

LAPTOP = load_profile("laptop")


@pytest.fixture(params=["demonstrations", "rollouts"])
def shipped(request, tmp_path, monkeypatch):
    """A copy of a shipped figure: its name, its record, and the answers that are taken from it."""
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")
    for path in (paths.ROOT / "paper_figures").glob(f"{request.param}*"):
        shutil.copy(path, tmp_path)
    chosen = parameters.parameters(request.param, LAPTOP)
    runs = parameters.runs(request.param, LAPTOP)
    data = load_or_run(runs, LAPTOP, tmp_path) if runs else Data(LAPTOP, tmp_path)
    return request.param, tmp_path / f"{request.param}.made.json", lambda: kept.answers(request.param, data, chosen)


def edited(record, change):
    content = json.loads(record.read_text())
    change(content)
    record.write_text(json.dumps(content))


@pytest.mark.parametrize("change", [
    lambda content: content["answers"].update({name: f"{text} " for name, text in content["answers"].items()}),
    lambda content: content.update(files={}), lambda content: content["files"].popitem(),
    lambda content: content.pop("digest"), lambda content: content.update(digest=None),
    lambda content: content.update(made_of="0" * 64), lambda content: content.pop("files")])
def test_a_record_that_was_changed_is_none(shipped, change):
    name, record, answers = shipped
    assert set(answers()) == {name}, "what is shipped is taken as it is"
    edited(record, change)
    assert answers() is None


@pytest.mark.parametrize("file", ["figures/{}.py", "figures/plots/film.py", "figures/plots/style.py"])
def test_a_figure_is_made_anew_when_its_file_changed_or_one_that_it_draws_with(shipped, file, tmp_path, monkeypatch):
    name, _, answers = shipped
    shutil.copytree(paths.PACKAGE, tmp_path / "move", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(kept, "PACKAGE", tmp_path / "move")
    assert answers() is not None
    with (tmp_path / "move" / file.format(name)).open("a") as changed:
        changed.write("# something else")
    assert answers() is None


def test_the_radius_is_made_of_what_counts_fits_and_draws_it():
    assert {"figures/radius.py", "figures/plots/distance.py", "statistics/distance.py", "figures/tables/__init__.py",
            "study/seen.py", "sim/coverage.py"} <= set(kept.code("radius"))


def test_a_figure_whose_intervals_rest_on_other_figures_runs_is_made_anew_when_these_tell_another_noise(
        shipped, monkeypatch):
    name, record, answers = shipped
    told, content = Data(LAPTOP, record.parent), json.loads(record.read_text())
    told.noise("rgb", grid=True)
    kept.keep(name, told, {}, {})
    noises = json.loads(record.read_text())["noises"]
    assert list(noises) == ["rgb True"]
    content.update(noises=noises, files=kept._files(name, record.parent))
    content.update(digest=kept._of_json({key: value for key, value in content.items() if key != "digest"}))
    record.write_text(json.dumps(content))
    assert answers() is not None
    monkeypatch.setattr(Data, "noise", lambda data, seen, grid: replace(told.noises[seen, grid], repeats=1))
    assert answers() is None


@pytest.mark.parametrize("text", ["", "[]", "null", "{", "7", "\0"])
def test_a_damaged_record_is_none(shipped, text):
    shipped[1].write_text(text)
    assert shipped[2]() is None


def test_a_film_that_was_exchanged_cut_or_left_out_of_the_record_is_made_anew(shipped):
    _, record, answers = shipped
    film = next(iter(sorted(record.parent.glob("*.mp4"))))
    whole, listed = film.read_bytes(), record.read_text()
    for content in (whole[:-1], whole[:100] + bytes([whole[100] ^ 1]) + whole[101:]):
        film.write_bytes(content)
        assert answers() is None
        edited(record, lambda content: content["files"].pop(film.name))
        assert answers() is None
        record.write_text(listed)
    film.unlink()
    assert answers() is None
    film.write_bytes(whole)
    assert answers() is not None
