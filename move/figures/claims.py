"""The paper's claims, each with its verdict: made by one rule from stored runs alone."""

from __future__ import annotations

from typing import NamedTuple

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures import plots
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.printed import readable
from move.figures.plots.style import COLUMN_WIDTH, PAGE_WIDTH, titles
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


def draw(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, Figure]:
    """The claims that are numbers, grouped by figure: shares and differences, and below them factors."""
    numbers = data.seen.numbers
    grouped = numbers.assign(first=numbers.groupby("figure").number.transform("min")).sort_values(
        ["first", "number"], kind="stable")
    return {"claims": _forest(grouped, PAGE_WIDTH, 0.17), "claims_narrow": _forest(grouped, COLUMN_WIDTH, 0.25)}


def _forest(numbers: pd.DataFrame, width: float, line: float) -> Figure:
    """The forest plot in a width and with a line's height in inches; one column has no room beside the lines."""
    parts, narrow = [numbers[~numbers.factor], numbers[numbers.factor]], width < PAGE_WIDTH
    lines = [max(part.number.nunique(), 1) for part in parts]
    figure, axes = plt.subplots(2, 1, figsize=(width, 1.9 + line * sum(lines)), height_ratios=lines)
    for ax, part in zip(axes, parts, strict=True):
        plots.forest(part, ax, above=narrow)
    axes[0].set_xlabel("difference, rate or share, as the claim has it")
    axes[1].set(xlabel="static's timesteps / MOVE's, same success", xlim=(0, None))
    axes[1].axvline(1, color="black", lw=0.8, ls="--")
    figure.legend(handles=plots.forest_entries(list(numbers.verdict)), ncol=2 if narrow else 4,
                  loc="outside upper center")
    titles(axes, ["claims that are a share or a difference", "claims of data efficiency"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many claims have which verdict, and which are still to be computed."""
    counts = tables[""].verdict.value_counts()
    unfinished = tables[""][tables[""].verdict == "not computed yet"].number.astype(str)
    return "Of {} claims: {}. Still to be computed: {}. The rules are those of claims.yaml with sha256 {}.".format(
        len(tables[""]), "; ".join(f"{counts[name]} {name}" for name in VERDICTS if name in counts),
        "number " + ", ".join(unfinished) if len(unfinished) else "none", data.seen.fingerprint)


SHOWN = (
    "The claims that are numbers, those of a figure together: ours with its 95 % interval, coloured by the verdict "
    "that one rule makes from stored runs, the paper's value a diamond. Black strokes are where what is claimed begins "
    "or ends. Of a claim of several things small marks are the single ones, an arrow from its lower end one that is "
    "\"more than\" what was tried, and the point is their mean, or the trend over them. Claims "
    "without a number are in the table alone.")
ALT = "A forest plot with a line a claim: a point, its interval, and a diamond for the paper."
WORDS = Words(
    title="What became of the paper's claims",
    shown=SHOWN,
    alt=ALT,
    tables={
        "": "The paper's claims, each with its verdict and the evidence.",
    },
    others={
        "claims_narrow": Words(title="What became of the paper's claims, in one column", shown=SHOWN, alt=ALT),
    },
)
