"""What whole figures share: an empty panel that says why, legends, what a white dot is."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from move.figures.plots.style import COLOURS, NAMES, in_order

SEEN = {"rgb": "from pixels", "keypoints": "from keypoints: perception given"}


def empty_panel(text: str, ax: Axes) -> None:
    """A panel without axes that says why it is empty."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, text, ha="center", va="center", transform=ax.transAxes)


def seed_dot() -> Line2D:
    """A legend's entry for the white dots on a bar."""
    return Line2D([], [], ls="none", marker="o", ms=3.5, color="black", mfc="white", mew=0.6, label="a seed")


def legend_below(ax: Axes, more: Sequence[Line2D] = (), columns: int = 2, lines: int = 1) -> None:
    """The legend of one panel under its axis, outside of the marks and of tick labels of so many lines."""
    handles, _ = ax.get_legend_handles_labels()
    ax.legend(handles=[*handles, *more], ncol=columns, loc="upper center", bbox_to_anchor=(0.5, -0.02 - 0.12 * lines))


def key_under(ax: Axes, entry: Line2D) -> None:
    """What one kind of mark on a map is, under its axis; the layout takes no notice of it."""
    ax.legend(handles=[entry], loc="upper left", bbox_to_anchor=(-0.1, -0.31)).set_in_layout(False)


def methods_and_seeds(figure: Figure, rates: pd.DataFrame) -> None:
    """A legend over the figure: the methods' colours and what a white dot is."""
    bars = [Patch(color=COLOURS[name], alpha=0.85, label=NAMES[name]) for name in in_order(rates.method)]
    figure.legend(handles=[*bars, seed_dot()], ncol=4, loc="outside upper center")
