"""How every picture looks: colours, sizes, file formats, and the line that says where its numbers come from."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import seaborn as sns
from matplotlib.figure import Figure

COLOURS = {  # safe for colour-blind readers (Okabe and Ito); a method has the same everywhere
    "static": "#0072B2",
    "adc": "#E69F00",
    "move": "#D55E00",
    "mixture": "#009E73",
    "nothing": "#999999",
    "random": "#999999",
    "expert": "#000000",
    "goal-blind": "#999999",
    "unknown": "#777777",  # data that do not say how they were collected
}
NAMES = {"static": "static", "adc": "ADC", "move": "MOVE", "mixture": "mixture", "nothing": "do nothing",
         "random": "random actions", "expert": "expert", "goal-blind": "goal-blind expert", "unknown": "unknown"}
COLUMN_WIDTH = 3.5  # inches, one column of a two-column page
PAGE_WIDTH = 7.2  # inches


def use_style() -> None:
    """Set matplotlib up for a two-column PDF; the same bytes every time a figure is written."""
    sns.set_theme(style="ticks", context="paper", rc={
        "font.size": 8, "axes.titlesize": 8.5, "axes.labelsize": 8, "legend.fontsize": 7, "xtick.labelsize": 7,
        "ytick.labelsize": 7, "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 150,
        "savefig.dpi": 200, "pdf.fonttype": 42, "svg.hashsalt": "move", "legend.frameon": False,
        "figure.constrained_layout.use": True,
    })
    mpl.rcParams["axes.formatter.use_mathtext"] = True


def footnote(figure: Figure, text: str) -> None:
    """Write small print under the figure: observation, budget, seeds, and what the profile is for."""
    wrapped = textwrap.fill(text, int(figure.get_figwidth() * 23))
    figure.supxlabel(wrapped, fontsize=5.5, color="#555555", x=0.01, ha="left")


def changed(figure: Figure, text: str) -> None:
    """Write over the figure how it differs from the shipped one of its name, in letters of 8.5 points."""
    wrapped = textwrap.fill(text, int(figure.get_figwidth() * 15))
    figure.suptitle(wrapped, fontsize=8.5, color="#B00000", weight="bold", x=0.01, ha="left")


def stamp(figure: Figure, text: str, colour: str = "0.35", points: float = 24) -> None:
    """Write `text` across the figure: what a reader must not overlook, also on a copied picture.

    Args:
        points: size of the letters on a figure of the page's width; they shrink with it.
    """
    width, height = figure.get_size_inches()
    rotation = 0.6 * math.degrees(math.atan2(height, width))
    figure.text(0.5, 0.5, text, fontsize=points * width / PAGE_WIDTH, color=colour, alpha=0.2, ha="center",
                va="center", rotation=rotation, weight="bold", zorder=100)


def save(figure: Figure, name: str, folder: Path) -> None:
    """Write `name`.pdf and `name`.png into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / f"{name}.pdf", metadata={"CreationDate": None, "ModDate": None})
    figure.savefig(folder / f"{name}.png", metadata={"Software": None})


def save_table(table: pd.DataFrame, name: str, folder: Path, printed: pd.DataFrame | None = None) -> None:
    """Write `name`.csv and `name`.tex into `folder`; the LaTeX file holds `printed` where that is given."""
    folder.mkdir(parents=True, exist_ok=True)
    table.to_csv(folder / f"{name}.csv", float_format="%.4f", index=table.index.name is not None)
    printed = table if printed is None else printed
    styled = printed.style.format(precision=3, escape="latex", na_rep="--").format_index(escape="latex", axis="columns")
    if printed.index.name is None:
        styled = styled.hide(axis="index")
    (folder / f"{name}.tex").write_text(styled.to_latex(hrules=True))
