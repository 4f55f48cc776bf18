"""How every figure looks: colours, sizes, panel letters, file formats, and what a copied figure must still say."""

from __future__ import annotations

import math
import re
import textwrap
import zlib
from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.transforms import Bbox
from PIL import Image

from move.figures.page.captions import Caption
from move.files import written_aside
from move.sim.methods import METHODS

COLOURS = {name: method.colour for name, method in METHODS.items()} | {  # safe for colour-blind readers (Okabe and Ito)
    "nothing": "#999999",
    "random": "#999999",
    "expert": "#000000",
    "goal-blind": "#999999",
    "unknown": "#777777",  # data that do not say how they were collected
}
MARKERS = dict.fromkeys(COLOURS, "o") | {name: method.marker for name, method in METHODS.items()}
"""Of a method's points wherever they are drawn: told apart in grey, too."""
DIFFERENCES = {name: ("#000000" if name == "static" else "#777777", method.marker) for name, method in METHODS.items()}
"""Colour and marker of MOVE minus another method: never a method's colour, for a difference is none of them."""
NAMES = {name: method.title for name, method in METHODS.items()} | {
    "nothing": "do nothing",
    "random": "random actions",
    "expert": "expert",
    "goal-blind": "goal-blind expert",
    "unknown": "unknown",
}
GREY = "#777777"  # of what is no method's
COLUMN_WIDTH = 3.4  # inches, one column of a two-column page
PAGE_WIDTH = 7.0  # inches
LEAST_POINTS = 7.0  # no text in a figure is smaller
UNSEEN_LEVELS = 2  # of 255: a pixel that differs by no more looks the same
MOST_PASSES = 40  # of the layout until nothing moves; about ten are enough
STILL = 1e-9  # of the figure's width or height: axes that move by less have come to rest
LETTERS = "abcdefghijklmnopqrstuvwxyz"


def in_order(methods: Iterable[str]) -> list[str]:
    """Methods, each once, in the order in which all figures have them."""
    there = set(methods)
    return [name for name in COLOURS if name in there]


def use_style() -> None:
    """Set matplotlib up for a two-column PDF; the same bytes every time a figure is written."""
    import seaborn as sns  # slow to import, and of use where something is drawn

    sns.set_theme(style="ticks", context="paper", rc={
        "font.size": 7.5, "axes.titlesize": 8, "axes.labelsize": 7.5, "legend.fontsize": 7, "xtick.labelsize": 7,
        "ytick.labelsize": 7, "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 150,
        "savefig.dpi": 200, "pdf.fonttype": 42, "svg.hashsalt": "move", "legend.frameon": False,
        "axes.titlelocation": "left", "axes.linewidth": 0.8, "xtick.major.width": 0.8, "ytick.major.width": 0.8,
        "xtick.major.size": 3, "ytick.major.size": 3, "legend.handlelength": 1.6, "legend.columnspacing": 1.2,
        "figure.constrained_layout.use": True,
    })
    mpl.rcParams["axes.formatter.use_mathtext"] = True


def titles(axes: Sequence[Axes], texts: Sequence[str]) -> None:
    """Write each panel's title over its left edge, after a bold letter where there are several panels."""
    for number, (ax, text) in enumerate(zip(axes, texts, strict=True)):
        letter = rf"$\bf{{{LETTERS[number]}}}$   " if len(axes) > 1 else ""
        ax.set_title(letter + text, loc="left")


def remark(figure: Figure, text: str) -> None:
    """Write a line under the figure that a reader must not miss, such as how many runs are not there."""
    figure.supxlabel(text, fontsize=LEAST_POINTS, color="#444444", x=0.01, ha="left")


def heading(figure: Figure, text: str, colour: str = "black") -> None:
    """Write over figure and legend, under what stands there already, what nobody may overlook who sees it alone.

    The figure grows by the height of the text, so that its panels keep theirs.
    """
    wrapped = textwrap.fill(text, int(figure.get_figwidth() * 13))
    figure.set_figheight(figure.get_figheight() + 0.16 * (wrapped.count("\n") + 1))
    if figure.legends:  # which the layout would put where it puts a figure's title
        legend = figure.legends[0]
        lines = "\n".join(filter(None, (legend.get_title().get_text(), wrapped)))
        legend.set_title(lines, FontProperties(size=8.5, weight="bold"))
        legend.get_title().set(color=colour, parse_math=False, multialignment="left")
        return
    lines = "\n".join(filter(None, (figure.get_suptitle(), wrapped)))
    figure.suptitle(lines, fontsize=8.5, color=colour, weight="bold", x=0.01, ha="left", parse_math=False)


def stamp(figure: Figure, text: str) -> None:
    """Write `text` in large red letters across the figure, behind its marks: it is of no worth as a result."""
    width, height = figure.get_size_inches()
    rotation = 0.6 * math.degrees(math.atan2(height, width))
    for ax in figure.axes:
        ax.patch.set_visible(False)
    figure.text(0.5, 0.5, text, fontsize=max(80 * width / PAGE_WIDTH, LEAST_POINTS), color="red", alpha=0.2,
                ha="center", va="center", rotation=rotation, weight="bold", zorder=-1)


def settle(figure: Figure) -> None:
    """Lay the figure out until nothing moves, and leave it so.

    A pass of matplotlib's layout starts where the last one ended, and axes of equal aspect still move in the next.
    After one pass a figure that a notebook has shown would be written with other bytes than one that it has not. A
    layout that never comes to rest is left as the last of `MOST_PASSES` has it.
    """
    engine, dpi = figure.get_layout_engine(), figure.get_dpi()
    if engine is None or not figure.axes:
        return
    figure.set_dpi(mpl.rcParams["savefig.dpi"])
    places = _places(figure)
    for _ in range(MOST_PASSES):
        engine.execute(figure)
        for ax in figure.axes:
            ax.apply_aspect()
        before, places = places, _places(figure)
        if np.abs(places - before).max() < STILL:
            break
    figure.set_layout_engine("none")
    for ax in figure.axes:  # whatever is left of the way there is rounded off
        ax.set_position(Bbox(ax.get_position(original=True).get_points().round(6)), which="original")
    figure.set_dpi(dpi)


def _places(figure: Figure) -> np.ndarray:
    """Left, bottom, width and height of all axes, as fractions of the figure's; `(axes, 4)`."""
    return np.array([ax.get_position().bounds for ax in figure.axes])


def save(figure: Figure, name: str, folder: Path, caption: Caption | None = None) -> None:
    """Write `name`.pdf and `name`.png into `folder`, and their caption, which both of them also hold, next to them.

    Where both are there, whole, and nobody could see a difference they stay: two machines draw the same scene a level
    of brightness apart in a pixel or two.

    Raises:
        BadInput: one of them cannot be written, as on a full disk; what was there stays.
    """
    title, alt = (caption.title, caption.alt) if caption else (name, "")
    page, picture, drawn = folder / f"{name}.pdf", folder / f"{name}.png", BytesIO()
    settle(figure)
    figure.savefig(drawn, format="png", metadata={"Software": None, "Title": title, "Description": alt})
    if not (_is_whole(page) and _look_alike(picture, drawn)):
        with written_aside(page) as new:
            figure.savefig(new, format="pdf",
                           metadata={"CreationDate": None, "ModDate": None, "Title": title, "Subject": alt})
        with written_aside(picture) as new:
            new.write_bytes(drawn.getvalue())
    if caption:
        with written_aside(folder / f"{name}.caption.md") as new:
            new.write_text(caption.markdown(), encoding="utf-8")


def _is_whole(page: Path) -> bool:
    """Whether a file is a PDF to its end, whose index is where its last lines say and whose streams decompress."""
    try:
        content = page.read_bytes()
        end = re.search(rb"startxref\s+(\d+)\s+%%EOF\s*\Z", content)
        for start in re.finditer(rb"/FlateDecode\b[^>]*>>\s*stream\r?\n", content):
            zlib.decompressobj().decompress(content[start.end():])
    except (OSError, zlib.error):
        return False
    return content.startswith(b"%PDF-") and end is not None and content[int(end[1]):].startswith(b"xref")


def _look_alike(there: Path, drawn: BytesIO) -> bool:
    """Whether two PNG files say the same of themselves and differ in no pixel by more than can be seen."""
    try:
        with Image.open(there) as old, Image.open(drawn) as new:
            if (old.size, old.info) != (new.size, new.info):
                return False
            levels = [np.asarray(image.convert("RGBA"), np.int16) for image in (old, new)]
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):  # what PIL raises on what is no picture
        return False
    return int(np.abs(levels[0] - levels[1]).max()) <= UNSEEN_LEVELS
