"""Table 3: the paper's real-robot trials, and what thirty trials leave open; a laboratory's own scoring sheet."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.plots import real_figures
from move.figures.plots.style import NAMES


def seen(data: Data, *, sheet: str = "") -> pd.DataFrame | None:
    """The scores of a laboratory's own sheet.

    Args:
        sheet: path of a CSV with the columns trial, method, position_x_m, position_y_m, score; empty: none.
    """
    if not sheet:
        return None
    from move.realworld import scoring

    return scoring.score_table(scoring.read_sheet(sheet))


def source(data: Data) -> str:
    """Nobody ran a robot here."""
    return "The paper's counts."


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """The paper's four cells with exact intervals, and the scores that their successes allow."""
    from move.realworld import trials

    return {"": trials.real_table()}


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """Counts, per cent with the exact interval, scores with the range that they could have."""
    return {"": pd.DataFrame([
        {"Timesteps": f"{row.timesteps:,}", "Method": NAMES[row.method], "Successes": f"{row.successes}/{row.trials}",
         "Success (%)": f"{100 * row.rate:.1f}", "95 % interval": f"{100 * row.low:.1f} to {100 * row.high:.1f}",
         "Score (%)": f"{100 * row.normalised:.1f}",
         "Score that the successes allow": f"{100 * row.score_low:.1f} to {100 * row.score_high:.1f}"}
        for row in tables[""].itertuples()])}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Success and score of the four cells."""
    from move.realworld import trials

    return real_figures.cells_figure(tables[""], trials.comparisons())


def pairs() -> pd.DataFrame:
    """All pairs of the paper's cells by their names, with exact tests; see `move.realworld.trials.comparisons`."""
    from move.realworld import trials

    table = trials.comparisons()
    cells = {column: [cell.split() for cell in table[column]] for column in ("first", "second")}
    return table.assign(**{column: [f"{NAMES[method]} {size}" for method, size in cell]
                           for column, cell in cells.items()})


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The paper's counts, which of them differ by an exact test, and which rise thirty trials would find."""
    from move.realworld import trials

    table, compared = tables[""], pairs()
    apart = compared.query("barnard < 0.05")
    each = "; ".join(f"{pair.first}, {pair.second} (p {pair.barnard:.3f})" for pair in apart.itertuples())
    counts = ", ".join(f"{NAMES[row.method]} {row.timesteps // 1000}k {row.successes}/{row.trials}"
                       for row in table.itertuples())
    base = sorted(set(table["rate"]))[1]
    return (
        f"**The paper:** {counts} successes. **Here**, with no robot, {len(apart)} of {len(compared)} pairs "
        f"differ: {each or 'none'}. **How sure:** Barnard's exact tests, uncorrected; by Fisher's a rise "
        f"under {100 * trials.minimum_detectable_effect(base):.0f} points from {base:.0%} mostly goes unseen.")


WORDS = Words(
    title="Table 3. The paper's real-robot trials, with what thirty trials leave open",
    shown=(
        "(a) Success of the paper's four cells, thirty trials each, with exact 95 % intervals, and p of Barnard's "
        "exact test between the methods at each budget, not corrected for making several. (b) The score "
        "(diamonds), a third for each of approach, pick-up and put-down, over the range (grey) in which it must lie "
        "once the successes are known. Counts are the paper's."),
    alt="A bar chart of four cells with intervals, and four diamonds over grey ranges.",
    tables={
        "": (
            "Table 3: the paper's real-robot trials; exact 95 % intervals, and the scores that the successes "
            "alone would allow."),
    },
)
