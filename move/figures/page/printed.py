"""Tables as people read them: human names, per cent and points, no NaN, no lists; in a notebook and in LaTeX.

readable    a tidy table as text: rates in per cent, differences in points, one decimal, intervals next to their values
shown       the same for a notebook
save        the tidy table as CSV, the readable one as LaTeX with caption and label
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from move.figures.plots.style import NAMES
from move.files import written_aside
from move.sim.tasks import TASKS

if TYPE_CHECKING:
    from pandas.io.formats.style import Styler

ABSENT, MINUS = "\N{EM DASH}", "\N{MINUS SIGN}"
NUMBER = rf"^[+{MINUS}<{ABSENT}\d]"  # how a cell that is one begins
LONG_ROWS, LONG_TEXT, WIDE = 45, 44, 62  # rows on a page; letters of a cell that breaks lines; letters in one column

Cell = Callable[[Any], str]


def _number(value: Any, digits: int = 1, sign: str = "") -> str:
    return f"{round(value, digits) + 0.0:{sign}.{digits}f}".replace("-", MINUS)  # never "-0.0"


def _percent(value: Any) -> str:
    return _number(100 * value)


_centimetres = _percent  # of metres


def _points(value: Any) -> str:
    return _number(100 * value, sign="+")


def _probability(value: Any) -> str:
    return _number(value, 3) if value >= 0.001 else "<0.001"


def _count(value: Any) -> str:
    return f"{value:,.0f}"


def _factor(value: Any) -> str:
    return f"{value:.2g}" if np.isfinite(value) else "more"


def _plain(value: Any) -> str:
    if value == math.inf:
        return "no end"
    return f"{value:.3g}".replace("-", MINUS) if isinstance(value, float) else str(value)


def _task(value: Any) -> str:
    return TASKS[value].title if value in TASKS else str(value)


def _method(value: Any) -> str:
    return NAMES.get(value, _plain(value))


def _moves(value: Any) -> str:
    """What moves, as a list: short enough for two of them in a row."""
    return str(value).replace(" + ", ", ")


def _named(**names: str) -> Cell:
    return lambda value: names.get(str(value), str(value))


COLUMNS: dict[str, tuple[str, Cell]] = {
    "task": ("Task", _task), "method": ("Method", _method), "baseline": ("Against", _method),
    "timesteps": ("Timesteps", _count), "move_timesteps": ("Timesteps, MOVE", _count),
    "static_timesteps": ("Timesteps, static", _count), "value": ("Success (%)", _percent),
    "level": ("From goal-blind to expert (%)", _percent),
    "seeds": ("Each seed (%)", lambda values: ", ".join(map(_percent, values))), "episodes": ("Episodes", _count),
    "trainings": ("Training noise", str), "difference": ("Difference (points)", _points),
    "p": ("p", _probability), "holm": ("p, Holm", _probability), "items": ("Items", _count), "tasks": ("Tasks", _count),
    "where": ("Where", _task),
    "factors": ("Random", _named(all="object, target, hand, camera", **{"object+target": "object, target, hand"})),
    "moves": ("What moves", _moves), "part": ("Whose speed", _named(nothing="static")),
    "share": ("MOVE's share (%)", _percent), "length": ("Gradient steps / the recipe's", _plain),
    "demonstrations": ("Demonstrations", _count),
    "observation": ("From", _named(rgb="pixels")), "jumping": ("Reading of ADC", str),
    "group": ("Tried", _named(random="elsewhere", grasp="at its own grasps", moving="elsewhere, in motion")),
    "own": ("At its own grasps (%)", _percent), "elsewhere": ("Elsewhere (%)", _percent),
    "lost": ("Lost elsewhere (points)", _points), "in_motion": ("Elsewhere, in motion (%)", _percent),
    "object": ("Object (%)", _percent), "target": ("Target (%)", _percent), "camera": ("Camera (%)", _percent),
    "train_minutes": ("Minutes", _number), "loss": ("Loss", lambda value: f"{value:.4f}"),
    "gain": ("Gain (points)", _points), "collect": ("Collect", _number), "train": ("Train", _number),
    "evaluate": ("Evaluate", _number), "whole": ("Whole", _number), "runs": ("Runs", _count),
    "all_runs": ("All runs", _count), "expert": ("Expert", _named(phase="ours", metaworld="Meta-World's")),
    "attempts": ("Attempts", _count), "generation_rate": ("Generation rate (%)", _percent),
    "mean_steps": ("Timesteps", _number), "jumps": ("Jumps", _number),
    "generation_rate_error": ("Its error (points)", _percent), "mean_steps_error": ("Their error", _number),
    "paper_mean_steps": ("Timesteps, paper", _number), "acceptance_rate": ("Kept (%)", _percent),
    "paper_generation_rate": ("Generation rate, paper (%)", _percent), "mean": ("Mean success (%)", _percent),
    "count": ("Tasks", _count), "covered": ("Hold the truth (%)", _percent),
    "half_width": ("Half width (points)", _percent), "deviation": ("Trainings differ by (points)", _percent),
    "ratio": ("Factor", _factor), "least": ("Least", _factor), "most": ("Most", _factor),
    "mean_difference": ("Mean (points)", _points), "iqm_first": ("IQM, MOVE (%)", _percent),
    "iqm_second": ("IQM, other (%)", _percent), "iqm_difference": ("IQM (points)", _points),
    "improvement": ("MOVE better (%)", _percent), "p_value": ("p", _probability), "rate": ("Success (%)", _percent),
    "case": ("Case", _task), "start": ("From (%)", _percent),
    "effect": ("Switched alone (points)", _points), "hand": ("Hand's start", str),
    "above": ("Above on", _count), "below": ("Below on", _count), "neither": ("Not distinguishable on", _count),
    "number": ("No.", str), "fisher": ("p, Fisher", _probability),
    "barnard": ("p, Barnard", _probability), "base": ("Base (%)", _percent), "trials": ("Trials", _count),
    "predicted": ("Predicted (%)", _percent), "without": ("Without distances (%)", _percent),
    "beyond": ("Beyond the radius (%)", _percent), "spread": ("Spread of places (cm)", _centimetres),
    "detectable_rise": ("Found rise (points)", _points), "rate_needed": ("Rate needed (%)", _percent),
}
"""A column's heading and how its cells are written; another column is shown as it is."""

INTERVALS = {"value": ("low", "high"), "difference": ("low", "high"), "ratio": ("low", "high"), "rate": ("low", "high"),
             "generation_rate": ("low", "high"), "mean_difference": ("low", "high"),
             "estimate": ("low", "high"), "radius": ("low", "high"),
             "gain": ("gain_low", "gain_high"), "effect": ("effect_low", "effect_high"),
             "improvement": ("improvement_low", "improvement_high"),
             "iqm_difference": ("iqm_low", "iqm_high")}
"""Whose interval stands in which columns."""


def readable(table: pd.DataFrame) -> pd.DataFrame:
    """A tidy table as text for people: headings, per cent and points with one decimal, a dash for what is not there.

    The paper's column is in points next to a difference, in per cent next to a success, else a number of timesteps.
    """
    table = table.reset_index() if table.index.name else table
    if {"iqm_first", "iqm_second"} <= set(table):
        table = table.assign(iqm_difference=table.iqm_first - table.iqm_second)
    if table.empty:
        return pd.DataFrame({"": ["not computed yet"]})
    known, content, bounds = {**COLUMNS, **_by_neighbours(table)}, {}, set()
    for name in table:
        ends = [end for end in INTERVALS.get(name, ()) if end in table]
        heading, cell = known.get(name, (str(name)[:1].upper() + str(name)[1:].replace("_", " "), _plain))
        content[name] = (heading, [_cell(cell, *values) for values in zip(*(table[one] for one in (name, *ends)),
                                                                         strict=True)])
        bounds.update(ends)
    return pd.DataFrame(dict(column for name, column in content.items() if name not in bounds))


def _by_neighbours(table: pd.DataFrame) -> dict[str, tuple[str, Cell]]:
    """The columns whose meaning depends on the other columns."""
    paper: tuple[str, Cell] = ("Paper (points)", _points) if "difference" in table else (
        ("Paper (%)", _percent) if "value" in table else ("Paper, timesteps", _count))
    than = {"baseline": ("Against (%)", _percent)} if "share" in table else (
        {"baseline": ("Against", _moves)} if "moves" in table else {})
    if "paper" in table and not pd.api.types.is_numeric_dtype(table["paper"]):
        paper = ("Paper", str)  # a profile's name is "paper", too
    seeds = {"seeds": ("Seeds", _count)} if "seeds" in table and table.seeds.map(type).ne(list).all() else {}
    return {"paper": paper, **than, **seeds}


def _cell(cell: Cell, value: Any, low: Any = None, high: Any = None) -> str:
    """One value as text, with its interval where it has one."""
    if not isinstance(value, list) and pd.isna(value):
        return ABSENT
    return cell(value) if low is None else f"{cell(value)} [{cell(low)}, {cell(high)}]"


def shown(table: pd.DataFrame) -> Styler:
    """A tidy table as a notebook shows it: readable, without row numbers; no text in it is markup."""
    styled = readable(table).style.hide(axis="index").format(escape="html").format_index(escape="html", axis="columns")
    return styled.set_properties(**{"text-align": "left"})


def as_markdown(text: str) -> str:
    r"""Text of a file or a reader for Markdown: shown as it is, and neither markup nor HTML.

    >>> as_markdown("a_b <img src=x> [c](d)")
    'a\\_b &lt;img src=x&gt; \\[c\\](d)'
    """
    return re.sub(r"([\\`*_\[\]|~$#!])", r"\\\1", html.escape(text, quote=False))


def save(
    table: pd.DataFrame, name: str, folder: Path, caption: str, printed: pd.DataFrame | None = None
) -> None:
    """Write `name`.csv, tidy, and `name`.tex, readable, into `folder`.

    Args:
        printed: what the LaTeX table holds in place of the readable `table`.

    Raises:
        BadInput: one of them cannot be written, as on a full disk; what was there stays.
    """
    text = latex(readable(table) if printed is None else printed, name, caption)
    if "seeds" in table and table.seeds.map(type).eq(list).any():
        table = table.assign(seeds=[" ".join(map(str, values)) for values in table.seeds])
    with written_aside(folder / f"{name}.csv") as new:
        table.to_csv(new, float_format=_four_digits, index=table.index.name is not None)
    with written_aside(folder / f"{name}.tex") as new:
        new.write_text(text, encoding="utf-8")


def _four_digits(value: float) -> str:
    """A number in a CSV file; what rounds to 0 has no sign."""
    return "0.0000" if (text := f"{value:.4f}") == "-0.0000" else text


def latex(printed: pd.DataFrame, name: str, caption: str) -> str:
    """A readable table as a LaTeX float with caption and label; a long one breaks over pages.

    It needs the packages booktabs and longtable.
    """
    printed = printed.map(str)
    escaped = printed.map(_escaped)
    escaped.columns = (pd.MultiIndex.from_tuples([tuple(map(_escaped, column)) for column in printed])
                       if printed.columns.nlevels > 1 else [_escaped(str(column)) for column in printed])
    width = [max(printed.iloc[:, place].str.len().max(), 0 if printed.columns.nlevels > 1 else len(str(column)))
             for place, column in enumerate(printed)]
    long = sum(letters > LONG_TEXT for letters in width)
    left = 6.4 - 0.06 * sum(letters for letters in width if letters <= LONG_TEXT) - 0.17 * len(width)
    room = f"{max(0.8, left / max(long, 1)):.1f}in"
    sides = ["r" if printed.iloc[:, place].str.match(NUMBER).all() else "l" for place in range(len(width))]
    shape = "".join(f"p{{{room}}}" if letters > LONG_TEXT else side for letters, side in zip(width, sides, strict=True))
    lines = len(printed) * (2 if long else 1)
    kind = "longtable" if lines > LONG_ROWS else "table*" if sum(width) > WIDE else "table"
    text = escaped.style.hide(axis="index").to_latex(
        hrules=True, column_format=shape, caption=_escaped(caption), label=f"tab:{name}",
        environment=kind, multicol_align="c", **({} if kind == "longtable" else {"position": "tbp"}))
    size = "\\footnotesize\n"
    return f"{{{size}{text}}}\n" if kind == "longtable" else text.replace(
        "\\begin{tabular}", f"\\centering\n{size}\\begin{{tabular}}", 1)


_ESCAPES = str.maketrans({"&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
                          "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "\\": r"\textbackslash{}",
                          "<": "$<$", ">": "$>$", MINUS: "$-$", ABSENT: "---"})


def _escaped(text: str) -> str:
    return text.translate(_ESCAPES)
