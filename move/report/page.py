"""What every notebook does around its figure: load or compute runs, say where numbers come from, write files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import pandas as pd
from IPython.display import Markdown, display
from matplotlib.figure import Figure

from move import paths
from move.errors import BadInput
from move.report import captions, changes, printed, style
from move.study.execute import execute, progress_bars
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import NOT_COMPUTED, Result, missing_in_words, split, table
from move.study.spec import RunSpec

Item = TypeVar("Item")


@dataclass(frozen=True)
class Loaded:
    """The runs of one figure: what is stored, as results and as episodes, and what is missing."""

    profile: Profile
    results: list[Result]
    episodes: pd.DataFrame
    missing: list[tuple[RunSpec, str]]

    @property
    def counted(self) -> list[Result]:
        """The results, each once: a run may stand in several conditions of a figure, with other labels."""
        return list({result.spec.hash: result for result in self.results}.values())

    @property
    def source(self) -> str:
        """Observation, budgets, seeds, episodes, runs, what is missing and the profile's purpose, in sentences."""
        said = captions.numbers(self.counted, len(self.missing), self.profile.purpose)
        return f"{said} Missing: {missing_in_words(self.missing)}." if self.missing else said

    @property
    def behind(self) -> str:
        """How much stands behind an answer: seeds, episodes, and what is missing."""
        return captions.behind(self.counted, len(self.missing))

    @property
    def remark(self) -> str:
        """What a reader of the figure alone must not miss: that perception was given, and how much is missing."""
        trained = [result.spec for result in self.results if result.spec.training]
        wanted = len(self.counted) + len(self.missing)
        given = bool(trained) and all(spec.observation == "keypoints" for spec in trained)
        parts = ["from keypoints: perception is given"] * given
        parts += [f"{len(self.missing)} of {wanted} runs are missing"] * bool(self.missing)
        return "; ".join(parts)


def load_or_run(runs: list[LabelledRun], profile: Profile) -> Loaded:
    """Compute what is missing of `runs`, unless MOVE_STORED_ONLY is set, and return all there is, with its labels.

    What is computed is stored under build/; the shipped results are only read.

    Raises:
        BadInput: there is nothing at all to draw; the message says why.
    """
    if not runs:
        raise BadInput(f"profile {profile.name}: has no runs of this figure; allowed is another profile")
    style.use_style()
    there, missing = _found(list(dict.fromkeys(run.spec for run in runs)), profile)
    if not there:
        raise BadInput(f"none of the {len(runs)} runs of this figure is stored; the first one: {missing[0][1]}")
    stored = {result.spec.hash: result for result in there}
    results = [replace(stored[run.spec.hash], labels=run.labels) for run in runs if run.spec.hash in stored]
    return Loaded(profile, results, table(results), missing)


def _found(specs: list[RunSpec], profile: Profile) -> tuple[list[Result], list[tuple[RunSpec, str]]]:
    """What is there of `specs`, shipped or a reader's own, computed where allowed; and what is missing, with why."""
    shipped, lacking = split(specs, profile.results)
    unusable = {spec.hash: why for spec, why in lacking if why != NOT_COMPUTED}
    stored_only = os.environ.get("MOVE_STORED_ONLY") == "1"
    own, missing = (split if stored_only else execute)([spec for spec, _ in lacking], profile.own_results)
    return shipped + own, [(spec, unusable.get(spec.hash, why) if why == NOT_COMPUTED else why)
                           for spec, why in missing]


def steps(items: Iterable[Item], what: str) -> Iterator[Item]:
    """Go through `items` with a bar that a reader in the browser sees; it ends at 100 %."""
    listed = list(items)
    with progress_bars(quiet=changes.by_command()) as bars:
        bar = bars.add_task(what, total=len(listed))
        for item in listed:
            yield item
            bars.update(bar, advance=1, refresh=True)


def save_outputs(name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], loaded: Loaded, found: str = "",
                 layouts: dict[str, pd.DataFrame] | None = None) -> None:
    """Write the figure (PDF, PNG, caption) and the tables (CSV, LaTeX) of a notebook.

    Args:
        tables: suffix of the file's name ("" for none) -> table.
        found: what came out, in words; part of the caption.
        layouts: suffix -> how that table is printed in LaTeX, where it is not as `tables.readable` says.
    """
    runs = [*(result.spec for result in loaded.results), *(spec for spec, _ in loaded.missing)]
    write(name, figure, tables, loaded.profile, loaded.source, found, loaded.remark, layouts, runs)


def save_outputs_alone(name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], profile: Profile,
                       source: str = "", found: str = "", layouts: dict[str, pd.DataFrame] | None = None) -> None:
    """`save_outputs` for a notebook that needs no runs; `source` says where the numbers come from."""
    write(name, figure, tables, profile, source, found, layouts=layouts)


def folder(name: str, profile: Profile) -> Path:
    """Where the notebook of figure `name` writes whatever else it makes, such as films."""
    return changes.change(name, profile).folder


def write(name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], profile: Profile, source: str,
          found: str = "", remark: str = "", layouts: dict[str, pd.DataFrame] | None = None,
          runs: Iterable[RunSpec] | None = None) -> None:
    """Write one figure and its tables, and say where; for notebooks with several of them.

    What is not as the profile has it goes to a folder of its own, and the figure says how it differs.

    Args:
        source: where the numbers come from; part of the captions.
        remark: one line in the figure itself.
        found, layouts: as for `save_outputs`.
        runs: what it is drawn from, where that can differ from the profile's.
    """
    changed = changes.change(name, profile, runs=runs)
    folder = changed.folder
    if figure is not None:
        if remark:
            style.remark(figure, remark)
        if changed:
            style.changed(figure, str(changed))
        if profile.stamp:
            style.stamp(figure, profile.stamp, "red", 80)
        style.save(figure, name, folder, captions.caption(name, source, found))
    for suffix, content in tables.items():
        table = name if suffix == "" else f"{name}_{suffix}"
        printed.save(content, table, folder, (layouts or {}).get(suffix), source)
    if changed or not changes.by_command():
        display(Markdown(f"{printed.as_markdown(str(changed))}{'. ' if changed else ''}Written to "
                         f"`{folder.relative_to(paths.ROOT)}/`; what is shipped stays as it is."))
