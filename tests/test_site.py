"""The site: its parts from shipped files, and, where it has been built, every page, link and picture of it."""

import io
import multiprocessing
import os
import re
import sys
import time
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlparse
from zipfile import ZipFile

import nbformat
import pandas as pd
import pytest
from nbclient.exceptions import CellTimeoutError, DeadKernelError
from nbformat.v4 import new_code_cell, new_notebook, new_output
from PIL import Image

from move import paths
from move.learn.evaluation import starts
from move.study import policies

sys.path.insert(0, str(paths.ROOT / "tools"))
make_site = pytest.importorskip("make_site", reason="Sphinx is not installed")

import browser  # noqa: E402
import executed_notebooks  # noqa: E402
import record_atlas  # noqa: E402

WIDTHS = (1280, 390)
BROKEN_WORDS = r"""[...document.querySelectorAll('td, th')].flatMap(cell => {
    const walk = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT), broken = [], range = document.createRange();
    for (let text; (text = walk.nextNode());) for (const word of text.data.matchAll(/[\p{L}\p{N}_.]+/gu)) {
        range.setStart(text, word.index);
        range.setEnd(text, word.index + word[0].length);
        if (new Set([...range.getClientRects()].map(one => Math.round(one.top))).size > 1) broken.push(word[0]);
    }
    return broken;
}).slice(0, 5)"""
"""Words in table cells that are on more than one line."""
PAGES = sorted(make_site.SITE.rglob("*.html"))
built = pytest.mark.skipif(not PAGES, reason="no site here; `make site` builds it")


class Found(HTMLParser):
    """What a page refers to, the places in it, and its pictures without an alternative text."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links, self.places, self.silent = [], set(), []
        self.feed(path.read_text())

    def handle_starttag(self, tag: str, attributes: list) -> None:
        given = dict(attributes)
        self.places |= {given.get("id"), given.get("name")}
        self.links += [given[key] for key in ("href", "src") if given.get(key)]
        if tag == "img" and not (given.get("alt") or "").strip():
            self.silent.append(given.get("src"))


def test_the_start_page_has_every_claim_with_its_verdict_and_its_figures_page():
    ledger = pd.read_csv(make_site.SHIPPED / "claims.csv")
    lines = list(make_site.claims(ledger))[2:]
    assert len(lines) == len(ledger) == 36
    for line, row in zip(lines, ledger.itertuples(), strict=True):
        assert line.startswith(f"| {row.number} |") and f"**{row.verdict}**" in line
        assert f"(figures/{row.figure}.ipynb)" in line and line.count(" | ") == 4


def test_the_site_computes_nothing_that_is_missing(tmp_path, monkeypatch):
    class Enough(Exception):
        pass

    def executed_copies(notebooks: list[Path]) -> None:
        raise Enough(os.environ["MOVE_STORED_ONLY"])

    monkeypatch.setenv("MOVE_STORED_ONLY", "0")
    monkeypatch.setattr(make_site, "SOURCE", tmp_path / "source")
    monkeypatch.setattr(make_site, "executed_copies", executed_copies)
    with pytest.raises(Enough, match="1"):
        make_site.main()


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A site of no notebook, in place of which `write` puts whatever it wants."""
    for name in ("SITE", "SOURCE"):
        monkeypatch.setattr(make_site, name, tmp_path / "build" / name.lower())
    for name, found in (("listed", []), ("api_pages", []), ("start_page", ""), ("atlas.page", "")):
        monkeypatch.setattr(f"make_site.{name}", lambda *arguments, found=found: found)
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")

    def make(write) -> dict[str, str]:
        monkeypatch.setattr(make_site, "build_main", lambda arguments: write(Path(arguments[-1])))
        make_site.main()
        return content()

    def content() -> dict[str, str]:
        return {path.relative_to(tmp_path).as_posix(): path.read_text() for path in tmp_path.rglob("*.html")}

    def of(text: str):
        def write(folder: Path) -> None:
            folder.mkdir(parents=True)
            (folder / "index.html").write_text(text)
        return write

    return make, of, content


def test_a_site_replaces_the_one_before_once_it_is_whole(small):
    make, of, content = small
    assert make(of("first")) == {"build/site/index.html": "first"}

    def fails(folder: Path) -> int:
        of("half")(folder)
        return 1

    with pytest.raises(SystemExit, match="Sphinx found an error"):
        make(fails)
    assert content() == {"build/site/index.html": "first"}
    assert make(of("second")) == {"build/site/index.html": "second"}


def test_a_site_whose_making_is_killed_leaves_the_one_before_and_the_next_clears_up(small, tmp_path):
    make, of, content = small
    make(of("first"))

    def endless(folder: Path) -> None:
        of("half")(folder)
        time.sleep(600)

    process = multiprocessing.get_context("fork").Process(target=make, args=(endless,))
    process.start()
    deadline = time.monotonic() + 120
    while "half" not in content().values() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.kill()
    process.join()
    found = content()
    assert found.pop("build/site/index.html") == "first" and list(found.values()) == ["half"]
    assert make(of("second")) == {"build/site/index.html": "second"}
    assert {path.name for path in (tmp_path / "build").iterdir()} == {"site", "source"}


@pytest.mark.parametrize("text", ["", "{", '{"cells": [', "[]", "{}", "\0" * 50, '{"nbformat": 4, "cells": [{}]}'])
def test_a_damaged_copy_of_a_notebook_is_none(tmp_path, text):
    (tmp_path / "a.ipynb").write_text(text)
    assert executed_notebooks.read_copy(tmp_path / "a.ipynb") is None


def test_every_table_belongs_to_a_notebook():
    for path in make_site.SHIPPED.glob("*.csv"):
        assert (paths.NOTEBOOKS / f"{make_site.table_of(path.stem)}.ipynb").exists(), path


def test_an_executed_copy_counts_only_with_todays_cells_all_run_and_the_profiles_own_parameters():
    notebook = nbformat.read(paths.NOTEBOOKS / "fig1_sparse.ipynb", 4)
    left = nbformat.read(paths.NOTEBOOKS / "fig1_sparse.ipynb", 4)
    for cell in left.cells:
        if cell.cell_type == "code":
            cell.execution_count = 1
    left.metadata["papermill"] = {"input_path": "notebooks/fig1_sparse.ipynb", "parameters": {"profile": "laptop"}}
    assert executed_notebooks.is_of_today(left, notebook)
    left.metadata["papermill"]["parameters"] = {"seeds": 1}
    assert not executed_notebooks.is_of_today(left, notebook)
    left.metadata["papermill"]["parameters"] = {}
    left.cells[2].execution_count = None
    assert not executed_notebooks.is_of_today(left, notebook)
    left.cells[2].execution_count = 1
    left.cells[3].source += "\n"
    assert not executed_notebooks.is_of_today(left, notebook)


def test_a_reader_of_the_site_sees_no_progress_of_a_live_page():
    live = new_output("display_data", {"application/vnd.jupyter.widget-view+json": {}, "text/plain": "Output()"})
    told = new_output("stream", text="told")
    injected = new_code_cell("profile = 'x'", metadata={"tags": ["injected-parameters"]})
    answer = new_code_cell("made.answer", outputs=[new_output("display_data", {"text/markdown": "It is."})])
    notebook = new_notebook(cells=[injected, new_code_cell("run()", outputs=[live, told]), answer])
    (cell,) = make_site.shown_cells(notebook, hide_code=True)
    assert cell.outputs == [told] and cell.metadata["tags"] == ["remove-input"]
    assert make_site.answer_of(notebook) == "It is."


@pytest.fixture
def source(tmp_path, monkeypatch):
    (tmp_path / "_static/results").mkdir(parents=True)
    monkeypatch.setattr(make_site, "SOURCE", tmp_path)
    return tmp_path


def test_a_page_that_cannot_be_made_says_why_and_loses_no_other(source, monkeypatch):
    def fail(*arguments):
        raise OSError("no space left")

    monkeypatch.setattr(make_site, "results_table", fail)
    monkeypatch.setattr(make_site.atlas, "page", fail)
    monkeypatch.setattr(make_site, "api_pages", lambda: iter(()))
    chapter = next(iter(sorted(make_site.TUTORIAL.glob("*.ipynb"))))
    problems = make_site.write_pages({paths.NOTEBOOKS / "rollouts.ipynb": "rollouts: its kernel died",
                                      chapter: "chapter: its kernel died"})
    assert set(problems) == {"rollouts", chapter.stem, "atlas", "index"}
    figure = (source / "figures/rollouts.ipynb").read_text()
    assert "its kernel died" in figure and "../_static/rollouts.png" in figure
    assert "move verify f396f28daf1b259e" in figure
    assert "its kernel died" in (source / f"tutorial/{chapter.name}").read_text()
    assert all("no space left" in (source / f"{name}.md").read_text() for name in ("atlas", "index"))
    assert all((source / name).exists() for name in make_site.DOCUMENTS)


def test_a_notebook_is_executed_for_the_site_as_it_is_opened(tmp_path, monkeypatch):
    monkeypatch.setattr(executed_notebooks, "EXECUTED", tmp_path)
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")
    path = paths.NOTEBOOKS / "table4_hyperparameters.ipynb"
    done = executed_notebooks.executed_copy(path)  # whose parameter is a tuple, which papermill would hand on as text
    assert executed_notebooks.is_of_today(done, nbformat.read(path, 4)) and "**Here" in make_site.answer_of(done)


def test_a_notebook_that_fails_costs_its_own_copy_alone(monkeypatch, capsys):
    def executed_copy(path: Path):
        if path.stem == "fig1_sparse":
            raise RuntimeError("cell 3")
        return new_notebook()

    monkeypatch.setattr(executed_notebooks, "copy_of_today",
                        lambda path: new_notebook() if path.stem == "claims" else None)
    monkeypatch.setattr(executed_notebooks, "executed_copy", executed_copy)
    names = ("claims", "fig1_sparse", "rollouts")
    found = executed_notebooks.executed_copies([paths.NOTEBOOKS / f"{name}.ipynb" for name in names])
    assert [path.stem for path in found] == list(names)
    assert [isinstance(copy, str) for copy in found.values()] == [False, True, False]
    said = capsys.readouterr().out
    assert "(1 of 2)" in said and "(2 of 2)" in said and "claims" not in said


@pytest.mark.parametrize("lost", [CellTimeoutError, DeadKernelError])
def test_a_notebook_whose_kernel_dies_or_never_answers_is_executed_again(lost, tmp_path, monkeypatch):
    given = []

    def execute_notebook(*arguments, **options):
        given.append(options["execution_timeout"])
        if len(given) == 1:
            raise lost("gone")
        return new_notebook()

    monkeypatch.setattr(executed_notebooks, "EXECUTED", tmp_path)
    monkeypatch.setattr(executed_notebooks.papermill, "execute_notebook", execute_notebook)
    assert executed_notebooks.executed_copy(tmp_path / "a.ipynb") == new_notebook()
    assert given == [executed_notebooks.PATIENCE] * 2


def test_the_answer_is_a_table_with_a_row_a_part_and_nothing_of_the_live_page():
    made = make_site.answer_table("**The paper:** a < b. **Here, from pixels:** +1 [-2, +5]; more. **How sure:** so.")
    assert re.findall(r"<th scope=\"row\">(.*?)</th><td>(.*?)</td>", made) == [
        ("The paper", "A &lt; b."), ("Here, from pixels", "+1 [-2, +5]; more."), ("How sure", "So.")]
    live = new_code_cell("made.answer", outputs=[new_output("display_data", {
        "text/markdown": "It is.\n\nWritten to `build/figures/laptop/`; what is shipped stays as it is."})])
    assert make_site.answer_of(new_notebook(cells=[live])) == "It is."


def test_every_run_of_a_figure_leads_to_its_file_its_command_and_its_rows(source):
    runs = {spec.hash for spec in make_site.parameters.specs("rollouts", make_site.PROFILE)}
    shown, rows = make_site.provenance("rollouts"), make_site.rows_of("rollouts")
    assert {path.stem for path in (source / "_static/results").iterdir()} == runs
    assert all(f"../_static/results/{run}.json" in shown and f"move verify {run}<" in shown for run in runs)
    episodes = pd.read_csv(source / "_static/rollouts_rows.csv.zip")
    assert "rollouts_rows.csv.zip" in rows and set(episodes.run) == runs
    with ZipFile(source / "_static/rollouts_rows.csv.zip") as archive:
        assert {entry.date_time[0] for entry in archive.infolist()} == {1980}, "the same rows are the same bytes"
    assert len(episodes) == sum(len(result.rows) for result in make_site.split(
        make_site.parameters.specs("rollouts", make_site.PROFILE), make_site.PROFILE.results)[0])


def test_a_picture_opens_large_and_only_plots_are_exchanged_on_dark_pages(source):
    for name, kind in (("fig1_sparse", "plot"), ("rollouts", "photograph"), ("fig2_overview", "photograph")):
        shown = make_site.picture(name)
        assert f'<a href="../_static/{name}.png"><picture><img class="{kind}"' in shown
        assert ("exchanged" in shown) is (kind == "plot") and "<source" not in shown
    shown = make_site.picture("claims")
    assert '<source media="(max-width: 600px)" srcset="../_static/claims_narrow.png">' in shown
    assert (source / "_static/claims_narrow.png").exists() and (source / "_static/claims.pdf").exists()


def test_the_atlas_starts_where_figure_1s_evaluation_does():
    """All but camera and target, as its page says."""
    (evaluation,) = {run.spec.evaluation for run in make_site.parameters.runs("fig1_sparse", make_site.PROFILE)
                     if run.labels["hand"] == "anywhere" and run.spec.evaluation.starts == "grid"}
    ours = starts(make_site.atlas.TASK, record_atlas.EVALUATION)
    theirs = starts(make_site.atlas.TASK.variant(evaluation.fixed), evaluation)
    for number in record_atlas.PLACES:
        for part in ("object_position", "hand_position"):
            assert getattr(ours[number].configuration, part) == getattr(theirs[number].configuration, part)


def test_a_film_of_the_atlas_plays_what_was_recorded(tmp_path, monkeypatch):
    if problem := make_site.atlas.gl_problem():
        pytest.skip(problem)
    monkeypatch.setattr(make_site.atlas, "MADE", tmp_path)
    spec = record_atlas.filmed_runs(make_site.PROFILE)["move"]
    number = record_atlas.PLACES[0]
    actions = policies.recorded_episodes(spec, make_site.PROFILE, policies.ATLAS)[number]
    start = starts(make_site.atlas.TASK, record_atlas.EVALUATION)[number]
    film = make_site.atlas.film("move", number, actions, start)
    assert film["frames"] == film["steps"] // make_site.atlas.STRIDE + 1 and film["steps"] <= len(actions) + 2
    with Image.open(tmp_path / film["file"]) as sheet:
        assert sheet.size[0] == make_site.atlas.COLUMNS * make_site.atlas.SIZE


def test_the_start_page_of_the_lab_leads_to_every_notebook_of_a_shipped_figure():
    text = (paths.ROOT / "notebooks/start.md").read_text()
    linked = re.findall(r"\]\(([^)]+)\)", text)
    asked = [link for link in linked if link != "../build/figures" and (
        make_site.TUTORIAL.exists() or not link.startswith("tutorial/"))]
    assert all((paths.ROOT / "notebooks" / link).exists() for link in asked), asked
    here = {str(path.relative_to(paths.NOTEBOOKS)) for pattern in ("*.ipynb", "tutorial/*.ipynb")
            for path in paths.NOTEBOOKS.glob(pattern)
            if pattern.startswith("tutorial") or any(make_site.SHIPPED.glob(f"{path.stem}*"))}
    assert here <= set(linked), here - set(linked)


@built
def test_every_link_of_the_site_resolves_and_every_picture_has_words():
    found = {path.resolve(): Found(path) for path in PAGES}
    for path, page in found.items():
        assert not page.silent, (path, page.silent)
        for link in page.links:
            address, place = urldefrag(link)
            if urlparse(address).scheme:
                continue
            goal = (path.parent / unquote(urlparse(address).path)).resolve() if address else path
            assert goal.exists(), (path, link)
            assert not place or goal not in found or unquote(place) in found[goal].places, (path, link)


@built
def test_the_site_loads_nothing_from_elsewhere_and_is_small():
    for path in PAGES:
        loaded = re.findall(r"<(?:script|img|video|source|iframe)[^>]*src=\"(https?:[^\"]+)", path.read_text())
        assert not loaded, (path, loaded)
    assert sum(path.stat().st_size for path in make_site.SITE.rglob("*") if path.is_file()) < 60e6


@built
@pytest.mark.browser
@pytest.mark.parametrize("width", WIDTHS)
def test_every_page_fits_its_width_without_an_error(width):
    with browser.page(width) as page:
        for path in PAGES:
            page.goto(path.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth") <= width, path
            broken = page.evaluate("[...document.images].filter(one => one.complete && !one.naturalWidth).length")
            assert not broken, path
            assert page.evaluate(BROKEN_WORDS) == [], path
        assert not page.errors, page.errors


@built
@pytest.mark.browser
@pytest.mark.parametrize("dark", [False, True])
def test_axe_finds_nothing_wrong(dark):
    """The rules that axe-core calls violations, on every page."""
    axe = pytest.importorskip("axe_playwright_python", reason="pip install axe-playwright-python brings axe-core")
    rules = (Path(axe.__file__).parent / "axe.min.js").read_text()
    with browser.page(390) as page:
        page.emulate_media(color_scheme="dark" if dark else "light")
        for path in PAGES:
            page.goto(path.as_uri())
            page.evaluate(rules)
            found = page.evaluate("axe.run(document, {resultTypes: ['violations'], selectors: false})"
                                  ".then(all => all.violations.map(one => [one.id, one.nodes[0].html]))")
            assert not found, (path, found)


@built
@pytest.mark.browser
@pytest.mark.parametrize("width", WIDTHS)
def test_the_atlas_plays_both_films_of_a_chosen_place_by_mouse_and_by_keys(width):
    with browser.page(width) as page:
        page.goto((make_site.SITE / "atlas.html").as_uri())
        place = page.locator(".places").first.locator("button").nth(6)
        place.click()
        assert place.get_attribute("aria-pressed") == "true"
        page.wait_for_function("Number(document.getElementById('atlas-step').value) > 20")
        page.locator("#atlas-play").click()  # pauses
        films = [Image.open(io.BytesIO(one.screenshot())) for one in page.locator("#atlas canvas").all()]
        assert len(films) == 2 and all(make_site.is_photograph(film) for film in films), "static's and MOVE's"
        before = page.evaluate("document.getElementById('atlas-step').value")
        page.locator("#atlas-step").fill("0")
        place.focus()
        page.keyboard.press("ArrowRight")
        beside = page.locator(".places").first.locator("button").nth(7)
        assert beside.get_attribute("aria-pressed") == "true" and place.get_attribute("aria-pressed") == "false"
        assert page.locator("#atlas-said").inner_text().startswith("The object is at x")
        page.locator("#atlas-step").fill("500")  # the end
        assert all(re.search("succeeds|fails", text) for text in page.locator("figcaption").all_inner_texts())
        assert before and not page.errors, page.errors
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        smallest = page.evaluate("Math.min(...[...document.querySelectorAll('.places button')].map(one => "
                                 "one.getBoundingClientRect().width))")
        assert smallest >= 24, smallest  # pixels of a target for a finger


@built
@pytest.mark.browser
def test_the_search_finds_a_figure_and_a_function():
    with browser.page() as page:
        for wanted, where in (("circle", "fig5_circle"), ("sample_speed", "api/")):
            page.goto(f"{(make_site.SITE / 'search.html').as_uri()}?q={wanted}")
            page.wait_for_selector("#search-results li a", timeout=20_000)
            links = page.eval_on_selector_all("#search-results li a", "all => all.map(one => one.href)")
            assert any(where in link for link in links), links
