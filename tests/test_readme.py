"""README says what is so: its results are the figures' own; rooms, names and targets that pages name are there."""

import importlib.util
import re

import numpy as np
import pandas as pd
import pytest

from move import paths
from move.figures import names

DOCS = paths.ROOT / "docs"
SCRIPT = importlib.util.spec_from_file_location("results_table", paths.ROOT / "tools" / "results_table.py")
results_table = importlib.util.module_from_spec(SCRIPT)
SCRIPT.loader.exec_module(results_table)
README = results_table.README.read_text()


def test_readme_shows_what_the_script_writes():
    assert README == results_table.with_results(README)


def test_a_fall_that_the_paper_has_too_is_judged_as_a_rise_is():
    fall, rise = (pd.Series({"difference": sign * 0.43, "low": sign * 0.43 - 0.08, "high": sign * 0.43 + 0.08})
                  for sign in (-1, 1))
    row = results_table._line("Table 1", (1.0, 0.57), fall, 3, (0.675, 0.317), 0.17)
    assert row == ("| Table 1 | 1.00 | 0.57 | -43 | -51 to -35 | 3 | 0.675 | 0.317 | -36 | reproduced; levels higher |")
    assert results_table._line("", (1.0, 0.57), rise, 3, (0.675, 0.317)).endswith("| refuted here; levels higher |")


def test_a_cell_of_the_results_holds_one_number():
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in results_table.table().splitlines()
            if line.startswith("| ")]
    heads = [row for row in rows if row[0] == "what"]
    assert len(heads) == 3 and {len(row) for row in rows} == {10}
    for row in rows:
        if row not in heads:
            *rates, interval, seeds = row[1:6]
            assert all(re.fullmatch(r"([+-]?[\d.]+)?", cell) for cell in [*rates, *row[6:9]]), row
            assert re.fullmatch(r"([+-]\d+ to [+-]\d+)?", interval) and re.fullmatch(r"(\d( to \d)?)?", seeds), row


def test_the_page_is_short_and_begins_with_three_commands_the_claims_and_the_film():
    lines = README.splitlines()
    assert len(lines) <= 120
    first = [README.index(mark) for mark in ("git clone", "claims.png", "demonstrations.webp", "| what |")]
    assert first == sorted(first) and first[2] < 1400  # characters that one screen of 1280 x 800 pixels holds
    commands = [line for line in README[:first[1]].splitlines() if line.startswith("    ")]
    assert len(commands) == 3 and max(map(len, commands)) <= 92  # of 8 pixels, in a box of 760
    shown = re.findall(r'(?:src="|\]\()((?!http)[^)"#]+)', README)
    assert [name for name in shown if not (paths.ROOT / name).exists()] == []


ROOMS = re.findall(r"^\| `(move/\S*)` \| (.*) \|$", (DOCS / "rooms.md").read_text(), re.M)


@pytest.mark.parametrize(("room", "text"), ROOMS, ids=[room for room, _ in ROOMS])
def test_every_file_of_a_room_is_named_there_and_every_name_is_a_file(room, text):
    named = set(re.findall(r"`(\w+)/?`", re.sub(r"\([^()]*\)", "", text)))
    there = {path.stem for path in (paths.ROOT / room).iterdir()
             if path.suffix == ".py" or (path.is_dir() and list(path.glob("*.py")))} - {"__init__", "__pycache__"}
    rooms = {name.removeprefix("move/") for name, _ in ROOMS}
    assert named <= there, "no name of what is gone"
    if room != "move/realworld":  # which names its doors alone
        known = {"move/": rooms, "move/figures": set(names())}.get(room, set())
        assert there - named - known == set()


def test_every_room_is_in_the_table():
    there = {f"move/{path.parent.name}" for path in (paths.ROOT / "move").glob("*/__init__.py")}
    assert there <= {room for room, _ in ROOMS} | {"move/cli"}


@pytest.mark.parametrize("page", [*sorted(paths.NOTEBOOKS.rglob("*.ipynb")), *paths.ROOT.glob("*.md"),
                                  *sorted(DOCS.rglob("*.md"))],
                         ids=lambda page: page.name)
def test_every_file_that_a_page_names_is_there(page):
    named = re.findall(r"`((?:move|notebooks|profiles|tests|tools|docs)/[\w./-]+)`", page.read_text())
    added = re.findall(r"^\+\+\+ b/(\S+)$", "".join(path.read_text() for path in DOCS.rglob("*.patch")), re.M)
    assert [name for name in named if not (paths.ROOT / name).exists() and name not in added] == []


def test_every_target_of_make_is_explained_and_no_other():
    makefile = (paths.ROOT / "Makefile").read_text()
    documented = set(re.findall(r"^([\w-]+):.*##", makefile, re.M))
    table = README.split("| `make` target | what it does |")[1].split("\n\n")[0]
    assert set(re.findall(r"`([\w-]+)`", "\n".join(re.findall(r"^\|([^|]*)\|", table, re.M)))) == documented | {"fig1"}
    targets = documented | {path.stem for path in paths.NOTEBOOKS.glob("*.ipynb")} | {"fig1"}
    for words in re.findall(r"`make ([^`]+)`", README):
        assert {word for word in words.split() if "=" not in word and "{" not in word} <= targets, words


def test_every_name_of_the_papers_symbols_is_in_the_package():
    rows = (DOCS / "symbols.md").read_text().split("| in the paper | here |")[1].split("\n\n")[0]
    source = "\n".join(path.read_text() for path in (paths.ROOT / "move").rglob("*.py"))
    for cell in re.findall(r"^\|[^|]*\|([^|]*)\|", rows, re.M)[1:]:
        for name in re.findall(r"`([\w.]+)`", cell):
            assert re.search(rf"\b{name.split('.')[-1]}\b", source), name


def test_the_deviations_say_the_means_that_the_tables_have():
    text, folder = (paths.ROOT / "KNOWN_DEVIATIONS.md").read_text(encoding="utf-8"), paths.ROOT / "paper_figures"
    rates = pd.read_csv(folder / "table2_main.csv").groupby("method").value.mean()
    readings = pd.read_csv(folder / "table_adc_means.csv").set_index(["observation", "jumping"])["mean"]
    static, adc, move, *ways = (f"{mean:.3f}"[1:] for mean in (
        *(rates[method] for method in ("static", "adc", "move")),
        *(readings[seen, way] for seen in ("rgb", "keypoints") for way in ("mended", "as printed"))))
    assert f"with its present one they are {static}, {adc} and {move}" in text
    assert "ADC has {} so and {} as printed from pixels (one seed), {} and {} from keypoints".format(*ways) in text


def test_readme_and_the_how_to_page_say_what_their_figures_have():
    rates, gap = (pd.read_csv(paths.ROOT / f"paper_figures/{name}.csv") for name in ("fifty_demonstrations", "gap"))
    own = rates[(rates.task == "pick-place") & (rates.equal == "demonstrations")]
    success = own.set_index(["arm", "demonstrations"]).value
    third = gap[(gap.case == "figure 1") & (gap.setting == "0.33 times the steps")].set_index("method").value
    told = [third["static"], third["move"], success["5 places", 100], success["each its own, random", 50],
            success["MOVE, random", 25]]
    text = README.split("after a third of the training")[1].split("What a verdict means")[0]
    assert [float(number) for number in re.findall(r"(?<![\d.])\.\d\d", text)] == pytest.approx(told, abs=0.0051)
    means = pd.read_csv(paths.ROOT / "paper_figures/table_keypoint_control_differences_mean.csv").set_index("baseline")
    gain, low, high = (f"{100 * number:+.0f}" for number in means.loc["static", ["difference", "low", "high"]])
    assert f"(table 2: {gain} [{low}, {high}]" in " ".join(text.split())
    page = (DOCS / "how-to/where_to_put_the_object.md").read_text()
    rows = [[int(cell) for cell in row] for row in re.findall(
        r"^\| (?!demonstrations).* \| (\d+) \| (\d+) \| (\d+) \|$", page, re.M)]
    expected = [[100 * success[arm, count] for count in (25, 50, 100)] for arm in dict.fromkeys(own.arm)]
    assert np.array(rows) == pytest.approx(np.array(expected), abs=0.51) and len(rows) == 7
