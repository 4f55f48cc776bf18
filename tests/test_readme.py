"""README says what is so: its results are the figures' own, its rooms, names and targets are there."""

import importlib.util
import re

import pandas as pd
import pytest

from move import paths

SCRIPT = importlib.util.spec_from_file_location("results_table", paths.ROOT / "tools" / "results_table.py")
results_table = importlib.util.module_from_spec(SCRIPT)
SCRIPT.loader.exec_module(results_table)


def test_readme_shows_what_the_script_writes():
    text = results_table.README.read_text()
    assert text == results_table.with_results(text)


def test_a_fall_that_the_paper_has_too_is_judged_as_a_rise_is():
    fall, rise = (pd.Series({"difference": sign * 0.43, "low": sign * 0.43 - 0.08, "high": sign * 0.43 + 0.08})
                  for sign in (-1, 1))
    row = results_table._line("Table 1", (1.0, 0.57), fall, 3, (0.675, 0.317), "static", 0.17)
    assert row.endswith("| -43 [-51, -35] points | 3 | 0.675, 0.317 (-36) | reproduced; levels higher |")
    assert results_table._line("", (1.0, 0.57), rise, 3, (0.675, 0.317), "").endswith("| refuted here; levels higher |")


README = results_table.README.read_text()
ROOMS = re.findall(r"^\| `(move/\w*)` \| (.*) \|$", README, re.M)


@pytest.mark.parametrize(("room", "text"), ROOMS, ids=[room for room, _ in ROOMS])
def test_every_file_of_a_room_is_named_there_and_every_name_is_a_file(room, text):
    named = set(re.findall(r"`(\w+)/?`", re.sub(r"\([^()]*\)", "", text)))
    there = {path.stem for path in (paths.ROOT / room).iterdir()
             if path.suffix == ".py" or (path.is_dir() and list(path.glob("*.py")))} - {"__init__", "__pycache__"}
    rooms = {name.removeprefix("move/") for name, _ in ROOMS}
    assert named - {"LeRobot"} <= there, "no name of what is gone"
    if room != "move/realworld":  # which names its doors alone
        assert there - named - (rooms if room == "move/" else set()) == set()


@pytest.mark.parametrize("page", [*sorted(paths.NOTEBOOKS.rglob("*.ipynb")), *paths.ROOT.glob("*.md")],
                         ids=lambda page: page.name)
def test_every_file_that_a_page_names_is_there(page):
    named = re.findall(r"`((?:move|notebooks|profiles|tests|tools|docs)/[\w./-]+)`", page.read_text())
    assert [name for name in named if not (paths.ROOT / name).exists()] == []


def test_what_can_be_done_with_it_fits_on_a_screen():
    table = README.split("| you want to | do |")[1].split("\n\n")[0]
    assert table.count("\n|") == 1 + 7
    targets = set(re.findall(r"^([\w-]+):", (paths.ROOT / "Makefile").read_text(), re.M)) | {
        path.stem for path in paths.NOTEBOOKS.glob("*.ipynb")} | {"fig1"}
    for words in re.findall(r"`make ([^`]+)`", README):
        assert {word for word in words.split() if "=" not in word and "{" not in word} <= targets, words


def test_every_name_of_the_papers_symbols_is_in_the_package():
    rows = README.split("| in the paper | here |")[1].split("\n\n")[0]
    source = "\n".join(path.read_text() for path in (paths.ROOT / "move").rglob("*.py"))
    for cell in re.findall(r"^\|[^|]*\|([^|]*)\|", rows, re.M)[1:]:
        for name in re.findall(r"`([\w.*]+)`", cell):
            assert re.search(rf"\b{re.escape(name.split('.')[-1]).replace(re.escape('*'), '')}", source), name
