"""The paper's claims, each with its verdict: made by one rule from stored runs alone."""

from __future__ import annotations

from typing import NamedTuple

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import readable
from move.statistics.verdicts import VERDICTS


class Decided(NamedTuple):
    """The claims as a table, those that are numbers, and the sha256 of the file that says how they are decided."""

    table: pd.DataFrame
    numbers: pd.DataFrame
    fingerprint: str


def seen(data: Data) -> Decided:
    """Every claim decided; writes claims.json for other programs."""
    from move.claims import ledger  # claims are made of figures' tables, so this room imports theirs and not they ours
    from move.claims.claims import fingerprint
    from move.claims.evidence import Evidence

    decided = ledger.entries(Evidence(data.profile))
    ledger.save_json(decided, data.folder)
    return Decided(ledger.as_table(decided), ledger.numbers(decided), fingerprint())


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """One row a claim."""
    return {"": data.seen.table}


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """Number, claim, verdict and figure."""
    return {"": readable(tables[""][["number", "claim", "verdict", "figure"]])}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """The claims that are numbers, grouped by figure: shares and differences, and below them factors."""
    numbers = data.seen.numbers
    grouped = numbers.assign(first=numbers.groupby("figure").number.transform("min")).sort_values(
        ["first", "number"], kind="stable")
    parts = [grouped[~grouped.factor], grouped[grouped.factor]]
    lines = [max(part.number.nunique(), 1) for part in parts]
    figure, axes = plt.subplots(2, 1, figsize=(PAGE_WIDTH, 1.9 + 0.17 * sum(lines)), height_ratios=lines)
    for ax, part in zip(axes, parts, strict=True):
        plots.forest(part, ax)
    axes[0].set_xlabel("difference, rate or share, as the claim has it")
    axes[1].set(xlabel="static's timesteps / MOVE's, same success", xlim=(0, None))
    axes[1].axvline(1, color="black", lw=0.8, ls="--")
    figure.legend(handles=plots.forest_entries(list(numbers.verdict)), ncol=4, loc="outside upper center")
    titles(axes, ["claims that are a share or a difference", "claims of data efficiency"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many claims have which verdict, and which are still to be computed."""
    counts = tables[""].verdict.value_counts()
    unfinished = tables[""][tables[""].verdict == "not computed yet"].number.astype(str)
    return "Of {} claims: {}. Still to be computed: {}. The rules are those of claims.yaml with sha256 {}.".format(
        len(tables[""]), "; ".join(f"{counts[name]} {name}" for name in VERDICTS if name in counts),
        "number " + ", ".join(unfinished) if len(unfinished) else "none", data.seen.fingerprint)


WORDS = Words(
    title="What became of the paper's claims",
    shown=(
        "The claims that are numbers, those of a figure together: ours with its 95 % interval, coloured by the verdict "
        "that one rule makes from stored runs, the paper's value a diamond. Of a claim of several things small strokes "
        "are the single ones and the point is their mean, or the trend over them."),
    alt="A forest plot with a line a claim: a point, its interval, and a diamond for the paper.",
    tables={
        "": "The paper's claims, each with its verdict and the evidence.",
    },
)
