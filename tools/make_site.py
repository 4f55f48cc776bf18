"""Writes the site into build/site: all results, a page a figure, the documents, an atlas of episodes: `make site`.

From the shipped results and pictures, and from executed notebooks: the copies that `move figure` or an earlier call
left, or new ones (`executed_notebooks`), which compute nothing that is missing. A page that cannot be made says why,
and the others are made all the same. Nothing outside build/ is written.
"""

from __future__ import annotations

import html
import io
import os
import pkgutil
import re
import shutil
import sys
import tempfile
import time
from base64 import b64decode
from collections.abc import Callable, Iterator
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import atlas
import nbformat
import pandas as pd
from executed_notebooks import executed_copies
from nbformat import NotebookNode
from nbformat.v4 import new_markdown_cell
from PIL import Image
from results_table import table as results_table
from sphinx.cmd.build import build_main

import move
from move import paths
from move.figures import load, names, owner
from move.figures.page import captions, kernels, parameters
from move.figures.page.data import load_or_run
from move.files import written_aside
from move.study.labels import distinct
from move.study.profiles import load_profile
from move.study.results import Result, split

PROFILE = load_profile("laptop")
SITE, SOURCE, DOCS = paths.BUILD / "site", paths.BUILD / "site-source", paths.ROOT / "docs"
SHIPPED, TUTORIAL = PROFILE.figures, paths.NOTEBOOKS / "tutorial"
ORDER = ("claims", "fig", "table", "generalization", "keypoint")  # beginnings of names; the others follow
GALLERY = ("fig1_sparse", "fig2_overview", "fig5_circle", "table2_main", "claims", "fig4_scaling")
DOCUMENTS = ("KNOWN_DEVIATIONS.md", "SECURITY.md", *sorted(
    str(path.relative_to(paths.ROOT)) for folder in (DOCS, DOCS / "how-to") for path in folder.glob("*.md")),
    "paper_figures/bench.md")
"""Pages of the repository; they lie in the site as in the repository, so that their links to one another hold."""
NARROW = "_narrow"  # ends the name of a picture's form for one column, and for a telephone
PHOTOGRAPH = 2500  # colours from which a picture has images of a camera in it; plots have fewer
ANSWERS = ("made.answer",)  # the cells whose output the table of the answer replaces
WRITTEN = re.compile(r"\s*Written to `[^`]*`; what is shipped stays as it is\.")  # of a live notebook alone


def main() -> None:
    """Write the sources, let Sphinx make the pages, say how large it is, how long it took and what is not there."""
    began = time.monotonic()
    os.environ["MOVE_STORED_ONLY"] = "1"  # the kernels' too
    shutil.rmtree(SOURCE, ignore_errors=True)
    (SOURCE / "_static/results").mkdir(parents=True)
    shutil.copy(DOCS / "site.css", SOURCE / "_static")
    problems = write_pages(executed_copies(listed()))
    with tempfile.TemporaryDirectory() as doctrees, written_aside(SITE) as site:
        if build_main(["-q", "-b", "html", "-c", str(DOCS), "-d", doctrees,
                       "-D", f"html_static_path={SOURCE / '_static'}", str(SOURCE), str(site)]):
            sys.exit("make_site: Sphinx found an error; see above")
    size = sum(path.stat().st_size for path in SITE.rglob("*") if path.is_file()) / 1e6
    sys.stdout.write(f"{SITE / 'index.html'}: {size:.1f} MB, {time.monotonic() - began:.0f} s, of it "
                     f"{sum(os.times()[:4]):.0f} s of a core\n")
    if problems:
        lines = "".join(f"\n  {name}: {why}" for name, why in problems.items())
        sys.exit(f"make_site: {len(problems)} pages are not whole, and say so:{lines}")


def write_pages(executed: dict[Path, NotebookNode | str]) -> dict[str, str]:
    """Write the sources of all pages; return those that are not whole, with why.

    Args:
        executed: of every notebook the executed copy, or why there is none.
    """
    problems: dict[str, str] = {}

    def write(name: str, title: str, page: Callable[[], NotebookNode | str]) -> None:
        (SOURCE / name).parent.mkdir(parents=True, exist_ok=True)
        try:
            content = page()
        except Exception as problem:  # whatever it is, the other pages are made
            problems[name] = why = f"{type(problem).__name__}: {problem}"
            content = f"# {title}\n\n{not_made('This page', why)}\n"
        if isinstance(content, str):
            (SOURCE / name).with_suffix(".md").write_text(content)
        else:
            nbformat.write(content, (SOURCE / name).with_suffix(".ipynb"))

    for path, copy in executed.items():
        if isinstance(copy, str):
            problems[path.stem] = copy
        if path.parent == TUTORIAL:
            write(f"tutorial/{path.stem}", path.stem, lambda path=path, copy=copy: tutorial_page(path, copy))
        else:
            write(f"figures/{path.stem}", path.stem, lambda path=path, copy=copy: figure_page(path.stem, copy))
    write("atlas", "Atlas", lambda: atlas.page(PROFILE, SOURCE / "_static"))
    documents = [name for name in DOCUMENTS if (paths.ROOT / name).exists()]
    for name in documents:
        write(name, name, lambda name=name: document(name))
    for picture in DOCS.glob("*.svg"):
        shutil.copy(picture, SOURCE / DOCS.name)
    rooms = list(api_pages())
    write("index", "MOVE, reproduced", lambda: start_page(list(executed), documents, rooms))
    return problems


def not_made(what: str, why: str) -> str:
    """A note to a reader that something of a page is lacking."""
    reason = html.escape(" ".join(why.split())[:500], quote=False)
    return f"```{{warning}}\n{what} could not be made: {reason}\n```"


def listed() -> list[Path]:
    """The notebooks of the site: the tutorial in its order, then the figures, claims first."""
    def place(name: str) -> int:
        return next((number for number, begin in enumerate(ORDER) if name.startswith(begin)), len(ORDER))

    figures = sorted(kernels.of_profile(PROFILE, stored_only=True), key=lambda name: (place(name), name))
    return [*sorted(TUTORIAL.glob("*.ipynb")), *(paths.NOTEBOOKS / f"{name}.ipynb" for name in figures)]


def figure_page(name: str, executed: NotebookNode | str) -> NotebookNode:
    """The page of a figure: picture, answer and caption, the executed notebook, how to make and change it, its runs.

    Args:
        executed: the copy, or why there is none: then the page has what is shipped.
    """
    notebook = nbformat.read(paths.NOTEBOOKS / f"{name}.ipynb", 4) if isinstance(executed, str) else executed
    answer = answer_of(notebook) or words(name)[1]
    title, *cells = shown_cells(notebook, hide_code=True)
    pictures = [path.stem for path in sorted(SHIPPED.glob("*.png"))
                if owner(path.stem) == name and not path.stem.endswith(NARROW)]
    heading, _, question = title.source.partition("\n")
    lacking = not_made("The executed notebook of this page", executed) if isinstance(executed, str) else ""
    if pictures:
        cells = [without_pictures(cell) for cell in cells]
    before = [heading, lacking, answer_table(answer), *map(picture, pictures), films(name), question.strip()]
    after = [commands(name), tables(name), provenance(name), source(name)]
    notebook.cells = [new_markdown_cell("\n\n".join(part for part in before if part)), *cells,
                      *(new_markdown_cell(text) for text in after if text)]
    return notebook


def tutorial_page(path: Path, executed: NotebookNode | str) -> NotebookNode:
    """A chapter of the tutorial, code and all; its pictures are named after the heading above them.

    Args:
        executed: the copy, or why there is none: then the page has the cells as they are written.
    """
    heading = "the chapter"
    notebook = nbformat.read(path, 4) if isinstance(executed, str) else executed
    notebook.cells = shown_cells(notebook, hide_code=False)
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            heading = next((line.strip("# ") for line in cell.source.splitlines() if line.startswith("#")), heading)
        else:
            cell.metadata["mystnb"] = {"image": {"alt": f"Picture: {heading}", "classes": kind_of(cell)}}
    if isinstance(executed, str):
        notebook.cells.insert(1, new_markdown_cell(not_made("The outputs of this page", executed)))
    return notebook


def kind_of(cell: NotebookNode) -> str:
    """"photograph" of a cell whose pictures have images of a camera in them, else "plot"."""
    found = [b64decode(output["data"]["image/png"]) for output in cell.outputs if "image/png" in output.get("data", {})]
    return "photograph" if any(is_photograph(Image.open(io.BytesIO(content))) for content in found) else "plot"


def is_photograph(image: Image.Image) -> bool:
    """Whether a picture has images of a camera in it: then its light and dark are not exchanged on a dark page."""
    return image.convert("RGB").getcolors(PHOTOGRAPH) is None


def answer_of(notebook: NotebookNode) -> str:
    """The answer that an executed notebook prints, in Markdown; empty where it was not executed."""
    shown = [output["data"].get("text/markdown", "") for cell in notebook.cells if cell.source in ANSWERS
             for output in cell.get("outputs", []) if "data" in output]
    return WRITTEN.sub("", "\n\n".join(shown)).strip()


def answer_table(answer: str) -> str:
    """The answer as a small table: a row a part that begins in bold, as `**Here**, from pixels:`, a line a sentence."""
    first, *parts = re.split(r"\*\*([^*]+?):?\*\*", answer)
    labelled = [("Here", first), *zip(parts[::2], parts[1::2], strict=True)]
    rows = [(label, text.strip(" ,:\n")) for label, text in labelled]
    cells = "".join(
        f"<tr><th scope=\"row\">{html.escape(label, quote=False)}</th><td>{sentences(text)}</td></tr>"
        for label, text in rows if text)
    return f"<div class=\"wide answer\"><table><tbody>{cells}</tbody></table></div>" if cells else ""


def sentences(text: str) -> str:
    """Plain text for HTML, a line a sentence and a line a part between semicolons."""
    words = " ".join(text.replace("**", "").replace("`", "").split())
    lines = re.split(r"(?<=[.;]) (?=\w)", words) if len(words) > 120 else [words]
    return "<br>".join(html.escape(line[:1].upper() + line[1:].rstrip(";"), quote=False) for line in lines)


def shown_cells(executed: NotebookNode, hide_code: bool) -> list[NotebookNode]:
    """The cells that a reader of the site needs: no injected parameters, no progress of a live page.

    Args:
        hide_code: leave the code away, and the answer, which stands above.
    """
    cells = [cell for cell in executed.cells if "injected-parameters" not in cell.metadata.get("tags", [])
             and not (hide_code and cell.source in ANSWERS)]
    for cell in cells:
        cell.metadata = NotebookNode()
        if cell.cell_type == "code":
            cell.metadata["tags"] = ["remove-input"] if hide_code else []
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
    """A shipped picture, which opens large, with its alternative text and caption; narrow screens show its narrow form.
    """
    has_narrow = (SHIPPED / f"{name}{NARROW}.png").exists()
    for file in (f"{name}.png", f"{name}.pdf", *[f"{name}{NARROW}.png"] * has_narrow):
        shutil.copy(SHIPPED / file, SOURCE / "_static")
    caption, _, alt = words(name)
    with Image.open(SHIPPED / f"{name}.png") as image:
        kind, (width, height) = "photograph" if is_photograph(image) else "plot", image.size
    remark = "Light and dark are exchanged in this picture; the large one is as published." if kind == "plot" else ""
    file, alt = f"../_static/{name}", html.escape(" ".join(alt.split()))
    narrow = (f"<source media=\"(max-width: 600px)\" srcset=\"{file}{NARROW}.png\">"
              if has_narrow else "")
    return (f"<figure class=\"picture\"><a href=\"{file}.png\"><picture>{narrow}<img class=\"{kind}\" "
            f"src=\"{file}.png\" width=\"{width}\" height=\"{height}\" alt=\"{alt}\"></picture></a>"
            f"<figcaption class=\"on-dark\">{remark}"
            f"</figcaption></figure>\n\n{html.escape(caption, quote=False)} <a href=\"{file}.png\">Large</a>, "
            f"<a href=\"{file}.pdf\">PDF</a>.")


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
    """Links to the shipped tables of a notebook, and to all its episodes."""
    found = sorted(path for path in SHIPPED.glob("*.csv") if table_of(path.stem) == name)
    for path in found:
        shutil.copy(path, SOURCE / "_static")
    links = ", ".join(f"<a href=\"../_static/{path.name}\">{path.stem}</a>" for path in found)
    parts = [f"As CSV: {links}."] * bool(found) + [rows_of(name)]
    return "## All its numbers\n\n" + "\n\n".join(filter(None, parts)) if any(parts) else ""


def rows_of(name: str) -> str:
    """A link to every episode of a figure's runs as CSV, which is written; empty of a figure without runs."""
    if name not in parameters.with_runs():
        return ""
    episodes = load_or_run(distinct(parameters.runs(name, PROFILE)), PROFILE, SOURCE).episodes
    path = SOURCE / "_static" / f"{name}_rows.csv.zip"
    entry = ZipInfo(path.stem)  # of no date: the same rows are the same bytes
    entry.compress_type = ZIP_DEFLATED
    with ZipFile(path, "w") as archive:
        archive.writestr(entry, episodes.to_csv(index=False, float_format="%.4f"))
    return (f"Its rows, one an episode: <a href=\"../_static/{path.name}\">{path.name}</a> ({len(episodes):,} rows; "
            f"`pandas.read_csv` reads it as it is).")


def table_of(stem: str) -> str:
    """The notebook that a table belongs to: the longest name that its own begins with."""
    return max((name for name in names() if stem == name or stem.startswith(f"{name}_")), key=len, default="")


def provenance(name: str) -> str:
    """Every stored run of a figure: what it is, its result's file, how to recompute it, where and how long it took."""
    if name not in parameters.with_runs():
        return ""
    there, missing = split(list(dict.fromkeys(parameters.specs(name, PROFILE))), PROFILE.results)
    titles = ("run", "result", "success", "seconds", "processor", "commit", "recompute and compare")
    head = "".join(f"<th scope=\"col\">{title}</th>" for title in titles)
    rows = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in provenance_row(result))}</tr>" for result in there)
    lacking = f" {len(missing)} more are not computed yet." if missing else ""
    listed = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
    return (f"## Where the numbers come from\n\n{len(there)} runs; each is a file with its settings and every "
            f"episode.{lacking} `move verify HASH` in a checkout recomputes one and compares it row by row.\n\n"
            f"<details><summary>the runs</summary><div class=\"wide\">{listed}</div></details>")


def provenance_row(result: Result) -> Iterator[str]:
    """What a run is, its result's file, rate, seconds, processor, commit, and the command that recomputes it."""
    made, name = result.provenance, result.spec.hash
    shutil.copy(PROFILE.results / f"{name}.json", SOURCE / "_static/results")
    yield html.escape(result.spec.label)
    yield f"<a href=\"../_static/results/{name}.json\"><code>{name}</code></a>"
    yield f"{result.rate:.2f}"
    yield f"{sum(result.seconds.values()):.0f}"
    yield html.escape(str(made.get("processor", "unknown")))
    yield f"<code>{str(made.get('commit', 'unknown'))[:8]}</code>"
    yield f"<code>move verify {name}</code>"


def source(name: str) -> str:
    """The file that the figure is made by, folded."""
    text = Path(str(load(name).__file__)).read_text()
    return (f"## Its code\n\n<details><summary><code>move/figures/{name}.py</code></summary>\n\n````python\n{text}````"
            "\n\n</details>")


def start_page(listed: list[Path], documents: list[str], rooms: list[str]) -> str:
    """The results' table, the claims with their verdicts, and the way to all other pages.

    Args:
        documents: names of the repository's pages.
        rooms: names of the pages of code.
    """
    figures = [f"figures/{path.stem}" for path in listed if path.parent != TUTORIAL]
    chapters = [f"tutorial/{path.stem}" for path in listed if path.parent == TUTORIAL]
    ledger = pd.read_csv(SHIPPED / "claims.csv")
    counted = "; ".join(f"{count} {verdict}" for verdict, count in ledger.verdict.value_counts().items())
    pages = [name.removesuffix(".md") for name in documents]
    trees = [("Tutorial", chapters), ("Figures and tables", ["atlas", *figures]), ("About", pages), ("Code", rooms)]
    return "\n".join([
        "# MOVE, reproduced", "",
        "*MOVE: A Simple Motion-Based Data Collection Paradigm for Spatial Generalization in Robotic Manipulation* "
        "(arXiv 2512.04813), reimplemented from scratch on a laptop without a GPU. Every number here comes from a "
        "stored run, and each page says which.", "",
        "[**The atlas**](atlas.md): choose a place of the object, and see what static's and MOVE's policy do from "
        "there.", "", "## What came out", "", results_table(), "", gallery(figures), "",
        f"## What became of the paper's {len(ledger)} claims", "",
        f"{counted}. A rule gives the verdicts; [how](figures/claims.ipynb).", "",
        *claims(ledger), "", *(tree(title, pages) for title, pages in trees if pages)])


def claims(ledger: pd.DataFrame) -> Iterator[str]:
    """The lines of the claims' table, each claim with its numbers and its figure's page."""
    yield "| no. | the paper says | verdict | numbers | figure |"
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
    links = []
    for name in shown:
        title, _, alt = (html.escape(" ".join(text.split())) for text in (load(name).WORDS.title, *words(name)[1:]))
        with Image.open(SHIPPED / f"{name}.png") as image:
            kind = "photograph" if is_photograph(image) else "plot"
        links.append(f"<a href=\"figures/{name}.html\"><img class=\"{kind}\" src=\"_static/{name}.png\" alt=\"{alt}\" "
                     f"loading=\"lazy\">{title}</a>")
    return f"<div class=\"gallery\">{''.join(links)}</div>"


def tree(title: str, pages: list[str]) -> str:
    """One part of the table of contents."""
    return f"```{{toctree}}\n:caption: {title}\n:maxdepth: 1\n:hidden:\n\n" + "\n".join(pages) + "\n```\n"


def document(name: str) -> str:
    """A document of the repository, with a title if it has none."""
    text = (paths.ROOT / name).read_text()
    return text if text.startswith("# ") else f"# {Path(name).stem.replace('_', ' ').capitalize()}\n\n{text}"


def api_pages() -> Iterator[str]:
    """One page a package, with what the docstrings of its modules say; yields their names."""
    modules = [module for module in pkgutil.walk_packages(move.__path__, "move.") if module.name != "move.cli"]
    packages = ["move", *(module.name for module in modules if module.ispkg)]
    for package in packages:
        inside = [module.name for module in modules
                  if not module.ispkg and module.name.rpartition(".")[0] == package]
        parts = [f"# {package}", f"```{{eval-rst}}\n.. automodule:: {package}\n   :no-members:\n```"]
        parts += [f"## {name.rpartition('.')[2]}\n\n```{{eval-rst}}\n.. automodule:: {name}\n```" for name in inside]
        (SOURCE / "api").mkdir(exist_ok=True)
        (SOURCE / "api" / f"{package}.md").write_text("\n\n".join(parts) + "\n")
        yield f"api/{package}"


if __name__ == "__main__":
    main()
