"""A figure from its file: load or compute its runs, make tables, picture and answer, write them, show them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib import rcParams
from matplotlib.figure import Figure
from PIL import Image as ImageFile

from move import paths
from move.figures import load
from move.figures.page import browser, captions, changes, kept, printed
from move.figures.page.data import Data, load_or_run
from move.figures.page.parameters import call, labelled_runs, other_task, parameters, parts
from move.figures.plots import style
from move.sim.tasks import TASKS
from move.study.execute import progress_bars
from move.study.profiles import load_profile

if TYPE_CHECKING:
    from IPython.display import Image, Markdown
    from pandas.io.formats.style import Styler

Item = TypeVar("Item")
WIDEST = 900  # pixels of a picture in a notebook
AT_ONCE = 2  # minutes that computing may take in a browser without being asked for


@dataclass(frozen=True)
class Made:
    """A figure as it was made and written: what a notebook shows of it."""

    name: str
    data: Data
    tables: dict[str, pd.DataFrame]
    layouts: dict[str, pd.DataFrame]
    figures: dict[str, Figure]
    answers: dict[str, str]
    change: changes.Change
    other_task: tuple[str, str] | None = None  # the figure's own task, and the one that it is of here

    @property
    def answer(self) -> Markdown:
        """The answer, and where the files are if they are not the shipped ones."""
        from IPython.display import Markdown

        text = self.answers[self.name]
        if self.change or not changes.by_command():
            remark = f"{printed.as_markdown(str(self.change))}. " if self.change else ""
            remark += f"The paper's values are of {TASKS[self.other_task[0]].title}. " if self.other_task else ""
            shipped = self.data.profile.shipped and self.data.folder == self.data.profile.figures
            text += f"\n\n{remark}" + ("This is the shipped figure." if shipped else (
                f"Written to `{self.data.folder.relative_to(paths.ROOT)}/`; what is shipped stays as it is."))
        return Markdown(text)

    def picture(self, name: str = "") -> Image:
        """A picture as it was written.

        Args:
            name: of one that is not called as the figure is.
        """
        from IPython.display import Image

        path, drawn = self.data.folder / f"{name or self.name}.png", self.figures.get(name or self.name)
        width = drawn.get_figwidth() if drawn else ImageFile.open(path).width / rcParams["savefig.dpi"]  # inches
        return Image(filename=str(path), width=min(WIDEST, round(130 * width)))

    @property
    def films(self) -> list[Path]:
        """The films of the figure."""
        return sorted(self.data.folder.glob(f"{self.name}*.mp4"))

    def table(self, suffix: str = "") -> Styler | pd.DataFrame:
        """A table as people read it.

        Args:
            suffix: of the file's name, "" for the table that is called as the figure is.
        """
        return self.layouts[suffix] if suffix in self.layouts else printed.shown(self.tables[suffix])


def make(name: str, profile: str, compute: bool = False, **given: Any) -> Made:
    """Make figure `name`: run what is missing and reuse what is stored, then write its picture and tables.

    Args:
        profile: name of a file under profiles/.
        compute: in a browser, whether runs are computed that take longer than `AT_ONCE`; without, the figure is drawn
            from what is stored. `move figure` computes them anyway.
        given: the figure's parameters; those left out are the profile's.

    Raises:
        BadInput: an unknown parameter, a value that is not allowed, or nothing to draw.
    """
    settings = load_profile(profile)
    change = changes.change(name, settings, given)
    chosen, functions = parameters(name, settings, given), parts(name)
    browser.show_interrupts_as_one_line()
    browser.show_status(f"{name}: reading the stored results ...")
    style.use_style()
    at_once = math.inf if compute or changes.by_command() else AT_ONCE
    data = (load_or_run(labelled_runs(name, settings, chosen), settings, change.folder, at_once) if "runs" in functions
            else Data(settings, change.folder))
    browser.show_status(f"{name}: " + (data.postponed and f"drawn from what is stored; {data.postponed}"
                                       or "making the figure ..."))
    for folder in dict.fromkeys([data.folder, data.folder if change else settings.figures]):
        if (answers := kept.answers(name, replace(data, folder=folder), chosen)) is not None:
            if not data.postponed:
                browser.show_status(f"{name}: done.")
            return Made(name, replace(data, folder=folder), kept.tables(name, folder), {}, {}, answers, change)
    if "seen" in functions:
        data = replace(data, seen=call(name, "seen", chosen, data))
    tables = call(name, "tables", chosen, data)
    other = other_task(name, settings, chosen)
    if other:
        tables = {suffix: _without_papers(table) for suffix, table in tables.items()}
    both = (tables, data)
    drawn = call(name, "draw", chosen, *both) if "draw" in functions else {}
    figures = drawn if isinstance(drawn, dict) else {name: drawn}
    answers = _by_name(call(name, "answer", chosen, *both), [name, *figures])
    sources = (_by_name(call(name, "source", chosen, data), [name, *figures, *tables]) if "source" in functions
               else {})
    layouts = call(name, "printed", chosen, *both) if "printed" in functions else {}
    made = Made(name, data, tables, layouts, figures, answers, change, other)
    _write(made, sources)
    kept.keep(name, data, chosen, answers)
    if not data.postponed:
        browser.show_status(f"{name}: done.")
    return made


def _by_name(found: str | Mapping[str, str], names: Iterable[str]) -> dict[str, str]:
    return dict(found) if isinstance(found, Mapping) else dict.fromkeys(names, found)


def _write(made: Made, sources: Mapping[str, str]) -> None:
    """Write the pictures (PDF, PNG, caption) and the tables (CSV, LaTeX) of a figure."""
    words, folder, profile = load(made.name).WORDS, made.data.folder, made.data.profile
    for name, figure in made.figures.items():
        if made.data.remark:
            style.remark(figure, made.data.remark)
        if made.change:
            style.heading(figure, str(made.change), "#B00000")
        if profile.stamp:
            style.stamp(figure, profile.stamp)
        of = words if name == made.name else words.others[name]
        caption = captions.caption(of, sources.get(name, made.data.source), made.answers[name])
        caption = replace(caption, title=_named(caption.title, made), text=_named(caption.text, made))
        style.save(figure, name, folder, caption)
        plt.close(figure)
    for suffix, content in made.tables.items():
        name = f"{made.name}_{suffix}" if suffix else made.name
        source = sources.get(suffix or made.name, made.data.source)
        caption_text = _named(captions.table_caption(words, suffix, source), made)
        printed.save(content, name, folder, caption_text, made.layouts.get(suffix))


def _named(text: str, made: Made) -> str:
    """Words of a figure, with the task that it is of here in place of its own."""
    own, here = (TASKS[task].title for task in made.other_task or ("push", "push"))
    return text.replace(own, here)


def _without_papers(table: pd.DataFrame) -> pd.DataFrame:
    """A table of another task than the paper's: without the paper's values."""
    papers = [] if "task" in table else [column for column in table if str(column).startswith("paper")]
    return table.assign(**dict.fromkeys(papers, float("nan")))


def steps(items: Iterable[Item], what: str) -> Iterator[Item]:
    """Go through `items` with a bar that a reader in the browser sees; it ends at 100 %."""
    listed = list(items)
    with progress_bars(quiet=changes.by_command()) as bars:
        bar = bars.add_task(what, total=len(listed))
        for item in listed:
            yield item
            bars.update(bar, advance=1, refresh=True)
