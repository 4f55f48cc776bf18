"""A notebook that is opened and run untouched is the shipped figure, computes nothing long, says what is missing."""

import os
import re
import shutil

import cells
import matplotlib.pyplot as plt
import pytest

from move import paths
from move.errors import BadInput
from move.figures import load
from move.figures.page import browser, captions, changes, data, kept, make
from move.figures.page.kernels import of_profile
from move.figures.page.parameters import call, specs
from move.figures.plots import style
from move.study.plan import plan_rows
from move.study.profiles import load_profile
from move.study.results import NOT_COMPUTED

LAPTOP = load_profile("laptop")
SAVE = style.save
MOST_WORDS = 60  # of an answer: the paper, here, how sure; what is more is a table


@pytest.fixture
def status(tmp_path, monkeypatch):
    """The lines that a reader sees under the cells, in a browser on a machine with two cores, where nothing computes.
    """
    lines = []
    monkeypatch.delenv(changes.BY_COMMAND, raising=False)
    monkeypatch.delenv("MOVE_STORED_ONLY", raising=False)
    monkeypatch.setattr(changes, "get_ipython", object)
    monkeypatch.setattr(browser, "show_status", lines.append)
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    monkeypatch.setattr(paths, "own_figures", lambda name: tmp_path / "build/figures" / name)
    monkeypatch.setattr(type(LAPTOP), "own_results", property(lambda _: tmp_path / "none"))
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(style, "save", cells.picture_left_empty)
    monkeypatch.setattr("move.figures.page.make.Made.answer", property(lambda made: made.answers[made.name]))
    yield lines
    plt.close("all")


@pytest.fixture
def nothing_computes(monkeypatch):
    def compute(*_):
        raise AssertionError("an untouched notebook computes runs")

    def nothing_simulated(name, part, *given):
        assert part != "seen" or not hasattr(load(name), "SIMULATES"), (
            "made of other code or runs than is shipped: make the figure and look at it")
        return call(name, part, *given)

    monkeypatch.setattr(data, "execute", compute)
    monkeypatch.setattr(make, "call", nothing_simulated)


@pytest.fixture
def unlike(status, monkeypatch):
    """The pictures that somebody would see to differ from the shipped ones, once they are drawn."""
    found = []

    def drawn(figure, name, folder, caption=None):
        folder.mkdir(parents=True, exist_ok=True)
        for kind in ("pdf", "png"):
            shutil.copy(LAPTOP.figures / f"{name}.{kind}", folder)
        SAVE(figure, name, folder, caption)  # which leaves what nobody could see to differ
        if (folder / f"{name}.png").read_bytes() != (LAPTOP.figures / f"{name}.png").read_bytes():
            found.append(name)

    monkeypatch.setattr(style, "save", drawn)
    return found


@pytest.mark.parametrize("name", of_profile(LAPTOP, stored_only=True))
def test_an_untouched_notebook_is_the_shipped_figure_from_stored_results(name, status, unlike, nothing_computes):
    made = cells.execute(name)["made"]
    assert not unlike, "drawn otherwise than shipped: look at both"
    assert not made.change and "Not the shipped figure" not in made.answer
    lengths = {one: len(captions.plain(answer).split()) for one, answer in made.answers.items()}
    assert max(lengths.values()) <= MOST_WORDS, lengths
    (planned,) = plan_rows(LAPTOP, {name: specs(name, LAPTOP)})
    assert len(made.data.missing) == planned["missing"] and {why for _, why in made.data.missing} <= {NOT_COMPUTED}
    assert bool(made.data.postponed) == bool(planned["missing"])
    if planned["missing"]:
        assert "compute = True" in status[-1] and re.search(r"\d (minutes|hours)", status[-1])
    shipped = [path for path in kept.files_of(name, LAPTOP.figures) if path.suffix in (".csv", ".tex", ".md")
               or path.suffix == ".json" and not path.name.endswith(".made.json")]
    assert shipped or not made.tables
    for path in shipped:
        assert (made.data.folder / path.name).read_bytes() == path.read_bytes(), path.name
    assert made.data.folder.is_relative_to(paths.BUILD) or made.data.folder == LAPTOP.figures


def test_what_takes_long_is_computed_once_it_is_asked_for(status, tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(data, "execute", lambda specs, folder: (asked.extend(specs), ([], [
        (spec, NOT_COMPUTED) for spec in specs]))[1])
    made = cells.execute("few_demonstrations", seeds=4)["made"]
    assert not asked and len(made.data.missing) == 6 and "6 of 24 runs" in status[-1]
    cells.execute("few_demonstrations", seeds=4, compute=True)
    assert len(asked) == 6


def test_where_nothing_is_stored_one_line_says_how_long_it_takes_and_how_to_start_it(status, nothing_computes):
    with pytest.raises(BadInput, match=r"none of the .* is stored; computing .* about .* set compute = True"):
        cells.execute("few_demonstrations", timesteps=[1000])


def test_what_takes_little_is_computed_at_once(status, monkeypatch):
    asked = []
    monkeypatch.setattr(data, "execute", lambda specs, folder: (asked.extend(specs), ([], [
        (spec, NOT_COMPUTED) for spec in specs]))[1])
    cells.execute("keypoint_control", seeds=6)
    assert {spec.seed for spec in asked} == {5} and len(asked) == 9


def test_the_first_line_comes_before_results_are_read_and_stays_below_its_cell(status, nothing_computes, monkeypatch):
    seen = []
    monkeypatch.setattr("move.figures.page.make.load_or_run", lambda *_: seen.extend(status) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        cells.execute("fig1_sparse")
    assert seen == ["fig1_sparse: reading the stored results ..."]


def test_an_interrupt_shows_one_line():
    from IPython.core.interactiveshell import InteractiveShell

    shell, shown = InteractiveShell(), []
    shell._showtraceback = lambda kind, error, lines: shown.append(lines)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(changes, "get_ipython", lambda: shell)
        browser.show_interrupts_as_one_line()
    done = shell.run_cell("def f():\n    raise KeyboardInterrupt\nf()")
    assert isinstance(done.error_in_exec, KeyboardInterrupt)
    assert len(shown) == 1 and len(shown[0]) == 1 and "KeyboardInterrupt" in shown[0][0] and "goes on" in shown[0][0]
