"""Writes the site, one page of all results and a page a figure, into build/site: `make site`.

From the shipped results and pictures, and from executed notebooks: the copies that `move figure` leaves where they are
the notebooks of today with the profile's own parameters, else executed here, computing nothing that is missing. Nothing
outside build/ is written.
"""

from __future__ import annotations

import html
import os
import pkgutil
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nbformat
import pandas as pd
import papermill
from nbformat import NotebookNode
from nbformat.v4 import new_markdown_cell
from results_table import table as results_table
from sphinx.cmd.build import build_main

import move
from move import paths
from move.figures import names, owner
from move.figures.page import captions, changes, kernels, parameters
from move.files import written_aside
from move.study.profiles import load_profile
from move.study.results import Result, split

PROFILE = load_profile("laptop")
SITE, SOURCE, DOCS = paths.BUILD / "site", paths.BUILD / "site-source", paths.ROOT / "docs"
SHIPPED, TUTORIAL = PROFILE.figures, paths.NOTEBOOKS / "tutorial"
REPOSITORY_PAGES = {"deviations": "KNOWN_DEVIATIONS.md", "security": "SECURITY.md"}
ORDER = ("claims", "fig", "table", "generalization", "keypoint")  # beginnings of names; the others follow
CELL_SECONDS = 600  # no cell takes so long; without it one whose reply was lost is waited for forever
GALLERY = ("fig1_sparse", "fig2_overview", "fig5_circle", "table2_main", "claims", "fig4_scaling")
TO_THE_DOCUMENTS = {f"]({name})": f"]({page}.md)" for page, name in REPOSITORY_PAGES.items()}


def main() -> None:
    """Write the sources, let Sphinx make the pages, say how large it is and how long it took."""
    began = time.monotonic()
    os.environ["MOVE_STORED_ONLY"] = "1"  # the kernels' too
    shutil.rmtree(SOURCE, ignore_errors=True)
    for folder in ("figures", "tutorial", "api", "_static"):
        (SOURCE / folder).mkdir(parents=True)
    shutil.copy(DOCS / "site.css", SOURCE / "_static")
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:  # each notebook has a process of its own
        executed = dict(zip(listed(), pool.map(executed_copy, listed()), strict=True))
    for path, copy in executed.items():
        page = tutorial_page(copy) if path.parent == TUTORIAL else figure_page(path.stem, copy)
        nbformat.write(page, SOURCE / ("tutorial" if path.parent == TUTORIAL else "figures") / path.name)
    documents = [page for page, name in REPOSITORY_PAGES.items() if (paths.ROOT / name).exists()]
    for page in documents:
        (SOURCE / f"{page}.md").write_text(repository_page(REPOSITORY_PAGES[page]))
    rooms = list(api_pages())
    (SOURCE / "index.md").write_text(start_page(list(executed), documents, rooms))
    with tempfile.TemporaryDirectory() as doctrees, written_aside(SITE) as site:
        if build_main(["-q", "-b", "html", "-c", str(DOCS), "-d", doctrees,
                       "-D", f"html_static_path={SOURCE / '_static'}", str(SOURCE), str(site)]):
            sys.exit("make_site: Sphinx found an error; see above")
    size = sum(path.stat().st_size for path in SITE.rglob("*") if path.is_file()) / 1e6
    sys.stdout.write(f"{SITE / 'index.html'}: {size:.1f} MB, {time.monotonic() - began:.0f} s\n")


def listed() -> list[Path]:
    """The notebooks of the site: the tutorial in its order, then the figures, claims first."""
    def place(name: str) -> int:
        return next((number for number, begin in enumerate(ORDER) if name.startswith(begin)), len(ORDER))

    figures = sorted(kernels.of_profile(PROFILE), key=lambda name: (place(name), name))
    return [*sorted(TUTORIAL.glob("*.ipynb")), *(paths.NOTEBOOKS / f"{name}.ipynb" for name in figures)]


def executed_copy(path: Path) -> NotebookNode:
    """A notebook with its outputs: as `move figure` left it, or executed now, from stored results alone."""
    left = paths.BUILD / "notebooks" / PROFILE.name / path.name
    if left.exists() and (found := read_copy(left)) and is_of_today(found, nbformat.read(path, 4)):
        return found
    sys.stdout.write(f"make_site: executing {path.stem} ...\n")
    made = paths.BUILD / "site-notebooks" / path.name
    made.parent.mkdir(parents=True, exist_ok=True)
    given = {} if path.parent == TUTORIAL else parameters.parameters(path.stem, PROFILE)
    return papermill.execute_notebook(path, made, given, kernel_name="python3", progress_bar=False, cwd=path.parent,
                                      execution_timeout=CELL_SECONDS)


def read_copy(path: Path) -> NotebookNode | None:
    """A notebook that was left; None where it is damaged."""
    try:
        return nbformat.read(path, 4)
    except (ValueError, AttributeError, nbformat.ValidationError):
        return None


def is_of_today(executed: NotebookNode, notebook: NotebookNode) -> bool:
    """Whether an executed copy has the cells of the notebook, all run, under the profile's own parameters."""
    cells = [cell for cell in executed.cells if "injected-parameters" not in cell.metadata.get("tags", [])]
    run_by = executed.metadata.get("papermill", {})
    same = [cell.source for cell in cells] == [cell.source for cell in notebook.cells]
    run = all(cell.execution_count for cell in cells if cell.cell_type == "code" and cell.source)
    name = Path(run_by.get("input_path") or "none").stem
    return same and run and not changes.change(name, PROFILE, run_by.get("parameters", {}))


def figure_page(name: str, executed: NotebookNode) -> NotebookNode:
    """The page of a figure: picture and caption, the executed notebook, how to make and change it, its runs."""
    title, *cells = shown_cells(executed, hide_code=True)
    pictures = [path.stem for path in sorted(SHIPPED.glob("*.png"))
                if owner(path.stem) == name]
    heading, _, question = title.source.partition("\n")
    after = [commands(name), tables(name), provenance(name)]
    if pictures:
        cells = [without_pictures(cell) for cell in cells]
    before = "\n\n".join([heading, *map(picture, pictures), films(name), question.strip()])
    executed.cells = [new_markdown_cell(before), *cells, *(new_markdown_cell(text) for text in after if text)]
    return executed


def tutorial_page(executed: NotebookNode) -> NotebookNode:
    """A chapter of the tutorial, code and all; its pictures are named after the heading above them."""
    heading = "the chapter"
    executed.cells = shown_cells(executed, hide_code=False)
    for cell in executed.cells:
        if cell.cell_type == "markdown":
            heading = next((line.strip("# ") for line in cell.source.splitlines() if line.startswith("#")), heading)
        else:
            cell.metadata["mystnb"] = {"image": {"alt": f"Picture: {heading}"}}
    return executed


def shown_cells(executed: NotebookNode, hide_code: bool) -> list[NotebookNode]:
    """The cells that a reader of the site needs: no injected parameters, no progress of a live page."""
    cells = [cell for cell in executed.cells if "injected-parameters" not in cell.metadata.get("tags", [])]
    for cell in cells:
        cell.metadata = NotebookNode()
        if cell.cell_type == "code":
            cell.metadata["tags"] = ["hide-input"] if hide_code else []
            cell.outputs = [output for output in cell.outputs
                            if "application/vnd.jupyter.widget-view+json" not in output.get("data", {})]
    return cells


def without_pictures(cell: NotebookNode) -> NotebookNode:
    """The cell without the pictures that stand above, with their captions."""
    if cell.cell_type == "code":
        cell.outputs = [output for output in cell.outputs if "image/png" not in output.get("data", {})]
    return cell


def words(name: str) -> tuple[str, str, str]:
    """Caption, what came out and alternative text of a shipped picture, as the file next to it has them."""
    path = SHIPPED / f"{name}.caption.md"
    if not path.exists():
        cell = nbformat.read(paths.NOTEBOOKS / f"{owner(name)}.ipynb", 4).cells[0]
        title = cell.source.split("\n")[0].strip("# ")
        return title, "", title
    caption = captions.read(path)
    return caption.text, caption.found, caption.alt


def picture(name: str) -> str:
    """A shipped picture with its alternative text and caption."""
    shutil.copy(SHIPPED / f"{name}.png", SOURCE / "figures")
    shutil.copy(SHIPPED / f"{name}.pdf", SOURCE / "_static")
    caption, found, alt = words(name)
    one_line = " ".join(alt.split()).replace("[", "(").replace("]", ")")
    return (f"![{one_line}]({name}.png)\n\n{html.escape(caption, quote=False)}\n\n{html.escape(found, quote=False)}\n\n"
            f"<a href=\"../_static/{name}.pdf\">as PDF</a>")


def films(name: str) -> str:
    """The shipped films of a notebook side by side, looping."""
    parts = []
    for path in sorted(SHIPPED.glob(f"{name}*.mp4")):
        shutil.copy(path, SOURCE / "_static")
        title = path.stem.replace("_", " ")
        parts.append(f"<figure><video src=\"../_static/{path.name}\" controls loop muted playsinline "
                     f"preload=\"metadata\" aria-label=\"{title}\"></video><figcaption>{title}</figcaption></figure>")
    return f"<div class=\"films\">{''.join(parts)}</div>" if parts else ""


def commands(name: str) -> str:
    """How to make a figure, and what can be changed of it."""
    own = parameters.parameters(name, PROFILE)
    change = next((f"    move figure {name} -p {key}={value // 2}" for key, value in own.items()
                   if isinstance(value, int) and value > 1), "")
    lines = ["## Make it, change it", "From the shipped results, into `paper_figures/`; changed, into a folder of its "
             "own under `build/figures/`, which computes what is missing; or in the browser with `make lab`.", "",
             f"    make {name}", change, f"    move plan {name}", ""]
    lines += ["| parameter | here |", "|---|---|", *(f"| `{key}` | `{value}` |" for key, value in own.items())]
    return "\n".join(lines if own else lines[:5])


def tables(name: str) -> str:
    """Links to the shipped tables of a notebook."""
    found = sorted(path for path in SHIPPED.glob("*.csv") if table_of(path.stem) == name)
    for path in found:
        shutil.copy(path, SOURCE / "_static")
    links = ", ".join(f"<a href=\"../_static/{path.name}\">{path.stem}</a>" for path in found)
    return f"## All its numbers\n\nAs CSV: {links}." if found else ""


def table_of(stem: str) -> str:
    """The notebook that a table belongs to: the longest name that its own begins with."""
    return max((name for name in names() if stem == name or stem.startswith(f"{name}_")), key=len, default="")


def provenance(name: str) -> str:
    """Every stored run of a figure: what it is, its result's name, where and how long it was computed."""
    if name not in parameters.with_runs():
        return ""
    there, missing = split(parameters.specs(name, PROFILE), PROFILE.results)
    head = "".join(f"<th>{title}</th>" for title in ("run", "hash", "success", "seconds", "processor", "commit"))
    rows = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in provenance_row(result))}</tr>" for result in there)
    lacking = f" {len(missing)} more are not computed yet." if missing else ""
    listed = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    return (f"## Where the numbers come from\n\n{len(there)} runs; each is the file `results/laptop/HASH.json`, with "
            f"every episode.{lacking}\n\n"
            f"<details><summary>the runs</summary><div class=\"wide\">{listed}</div></details>")


def provenance_row(result: Result) -> Iterator[str]:
    """What a run is, its hash, rate, seconds, processor and commit."""
    made = result.provenance
    yield html.escape(result.spec.label)
    yield f"<code>{result.spec.hash}</code>"
    yield f"{result.rate:.2f}"
    yield f"{sum(result.seconds.values()):.0f}"
    yield html.escape(str(made.get("processor", "unknown")))
    yield f"<code>{str(made.get('commit', 'unknown'))[:8]}</code>"


def start_page(listed: list[Path], documents: list[str], rooms: list[str]) -> str:
    """The results' table, the claims with their verdicts, and the way to all other pages."""
    figures = [f"figures/{path.stem}" for path in listed if path.parent != TUTORIAL]
    chapters = [f"tutorial/{path.stem}" for path in listed if path.parent == TUTORIAL]
    ledger = pd.read_csv(SHIPPED / "claims.csv")
    counted = "; ".join(f"{count} {verdict}" for verdict, count in ledger.verdict.value_counts().items())
    trees = [("Tutorial", chapters), ("Figures and tables", figures), ("About", documents), ("Code", rooms)]
    return "\n".join([
        "# MOVE, reproduced", "",
        "*MOVE: A Simple Motion-Based Data Collection Paradigm for Spatial Generalization in Robotic Manipulation* "
        "(arXiv 2512.04813), reimplemented from scratch on a laptop without a GPU. Every number here comes from a "
        "stored run, and each page says which.", "", "## What came out", "", results_table(), "", gallery(figures), "",
        f"## What became of the paper's {len(ledger)} claims", "",
        f"{counted}. A rule gives the verdicts; [how](figures/claims.ipynb).", "",
        *claims(ledger), "", *(tree(title, pages) for title, pages in trees if pages)])


def claims(ledger: pd.DataFrame) -> Iterator[str]:
    """The lines of the claims' table, each claim with its numbers and its figure's page."""
    yield "| | the paper says | verdict | numbers | figure |"
    yield "|---|---|---|---|---|"
    for row in ledger.itertuples():
        open_ones = f"{row.evidence}; {row.needed}" if isinstance(row.needed, str) else row.evidence
        claim, evidence = (" ".join(str(text).split()).replace("|", "\\|").replace("[", "\\[")
                          for text in (row.claim, open_ones))
        yield (f"| {row.number} | {claim} ({row.place}) | **{row.verdict}** | {evidence} | "
               f"[{row.figure}](figures/{row.figure}.ipynb) |")


def gallery(figures: list[str]) -> str:
    """A few pictures that lead to their pages."""
    shown = [name for name in GALLERY if f"figures/{name}" in figures and (SHIPPED / f"{name}.png").exists()]
    return "\n\n".join(f"[![{title}](figures/{name}.png)](figures/{name}.ipynb)"
                       for name, title in ((name, words(name)[2].replace("[", "(").replace("]", ")"))
                                           for name in shown))


def tree(title: str, pages: list[str]) -> str:
    """One part of the table of contents."""
    return f"```{{toctree}}\n:caption: {title}\n:maxdepth: 1\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"


def repository_page(name: str) -> str:
    """A document of the repository, its links to the other documents led to their pages."""
    text = (paths.ROOT / name).read_text()
    for link, page in TO_THE_DOCUMENTS.items():
        text = text.replace(link, page)
    return text


def api_pages() -> Iterator[str]:
    """One page a package, with what the docstrings of its modules say; yields their names."""
    modules = [module for module in pkgutil.walk_packages(move.__path__, "move.") if module.name != "move.cli"]
    packages = ["move", *(module.name for module in modules if module.ispkg)]
    for package in packages:
        inside = [module.name for module in modules
                  if not module.ispkg and module.name.rpartition(".")[0] == package]
        parts = [f"# {package}", f"```{{eval-rst}}\n.. automodule:: {package}\n   :no-members:\n```"]
        parts += [f"## {name.rpartition('.')[2]}\n\n```{{eval-rst}}\n.. automodule:: {name}\n```" for name in inside]
        (SOURCE / "api" / f"{package}.md").write_text("\n\n".join(parts) + "\n")
        yield f"api/{package}"


if __name__ == "__main__":
    main()
