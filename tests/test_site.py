"""The site: its parts from shipped files, and, where it has been built, every page, link and picture of it."""

import multiprocessing
import os
import re
import sys
import time
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlparse

import nbformat
import pandas as pd
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from move import paths

sys.path.insert(0, str(paths.ROOT / "tools"))
make_site = pytest.importorskip("make_site", reason="Sphinx is not installed")

import browser  # noqa: E402

WIDTHS = (1280, 390)
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

    def executed_copy(path: Path) -> None:
        raise Enough(os.environ["MOVE_STORED_ONLY"])

    monkeypatch.setenv("MOVE_STORED_ONLY", "0")
    monkeypatch.setattr(make_site, "SOURCE", tmp_path / "source")
    monkeypatch.setattr(make_site, "executed_copy", executed_copy)
    with pytest.raises(Enough, match="1"):
        make_site.main()


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A site of no notebook, in place of which `write` puts whatever it wants."""
    for name in ("SITE", "SOURCE"):
        monkeypatch.setattr(make_site, name, tmp_path / "build" / name.lower())
    for name, found in (("listed", []), ("api_pages", []), ("start_page", "")):
        monkeypatch.setattr(make_site, name, lambda *arguments, found=found: found)
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
    assert make_site.read_copy(tmp_path / "a.ipynb") is None


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
    assert make_site.is_of_today(left, notebook)
    left.metadata["papermill"]["parameters"] = {"seeds": 1}
    assert not make_site.is_of_today(left, notebook)
    left.metadata["papermill"]["parameters"] = {}
    left.cells[2].execution_count = None
    assert not make_site.is_of_today(left, notebook)
    left.cells[2].execution_count = 1
    left.cells[3].source += "\n"
    assert not make_site.is_of_today(left, notebook)


def test_a_reader_of_the_site_sees_no_progress_of_a_live_page():
    live = new_output("display_data", {"application/vnd.jupyter.widget-view+json": {}, "text/plain": "Output()"})
    told = new_output("stream", text="told")
    injected = new_code_cell("profile = 'x'", metadata={"tags": ["injected-parameters"]})
    notebook = new_notebook(cells=[injected, new_code_cell("run()", outputs=[live, told])])
    (cell,) = make_site.shown_cells(notebook, hide_code=True)
    assert cell.outputs == [told] and cell.metadata["tags"] == ["hide-input"]


def test_the_start_page_of_the_lab_leads_to_every_notebook():
    text = (paths.ROOT / "notebooks/start.md").read_text()
    linked = re.findall(r"\]\(([^)]+)\)", text)
    asked = [link for link in linked if link != "../build/figures" and (
        make_site.TUTORIAL.exists() or not link.startswith("tutorial/"))]
    assert all((paths.ROOT / "notebooks" / link).exists() for link in asked), asked
    here = {str(path.relative_to(paths.NOTEBOOKS)) for pattern in ("*.ipynb", "tutorial/*.ipynb")
            for path in paths.NOTEBOOKS.glob(pattern)}
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
    assert sum(path.stat().st_size for path in make_site.SITE.rglob("*") if path.is_file()) < 40e6


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
        assert not page.errors, page.errors


@built
@pytest.mark.browser
def test_the_search_finds_a_figure_and_a_function():
    with browser.page() as page:
        for wanted, where in (("circle", "fig5_circle"), ("sample_speed", "api/")):
            page.goto(f"{(make_site.SITE / 'search.html').as_uri()}?q={wanted}")
            page.wait_for_selector("#search-results li a", timeout=20_000)
            links = page.eval_on_selector_all("#search-results li a", "all => all.map(one => one.href)")
            assert any(where in link for link in links), links
