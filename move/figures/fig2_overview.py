"""Figure 2: the idea. Where object and target are in static, ADC's and MOVE's demonstrations, and frames of motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Frames, Pixels, RandomSeed, TaskName
from move.figures.plots import maps
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import NAMES, PAGE_WIDTH, titles
from move.machine import gl_problem
from move.paper import PAPER_METHODS
from move.sim.collection import Collection
from move.sim.tasks import TASKS, get_task

SIMULATES = True

Strips = Mapping[str, tuple[np.ndarray, Sequence[int]]]  # title -> frames (count, size, size, 3), their timesteps
LONGEST = 40  # timesteps of a strip


class Seen(NamedTuple):
    """The configurations of each method's demonstrations, and strips of frames."""

    configurations: Mapping[str, pd.DataFrame]
    strips: Strips


def seen(
    data: Data, *, task: TaskName = "pick-place", rotating_task: TaskName = "assembly", timesteps: Count = 2500,
    frames: Frames = 8, image_size: Pixels = 160, seed: RandomSeed = 0,
) -> Seen:
    """One collection a method without images, and a demonstration of each motion alone with them.

    Args:
        task: whose configurations are drawn.
        rotating_task: whose object is turned in the second strip.
        frames: of each strip.
        image_size: pixels along a side of a frame.
    """
    from move.figures.plots import film
    from move.sim import coverage  # imports the simulator

    collected: dict[str, pd.DataFrame] = {
        name: coverage.configurations(Collection(task=task, method=name, timesteps=timesteps), seed)
        for name in PAPER_METHODS}
    shown = {} if gl_problem() else {"translation": task, "rotation": rotating_task, "camera": task}
    return Seen(collected, {
        f"{part} alone, {TASKS[name].title} ({film.SEEN[name]}), {film.pace(part)}": film.strip(
            film.demonstration_frames(film.demonstration(name, "move", image_size, film.only(part)), seed)[:LONGEST],
            frames) for part, name in shown.items()})


def source(data: Data, *, task: str, timesteps: int, seed: int) -> str:
    """What was collected."""
    return f"{TASKS[task].title}, {timesteps:,} timesteps a method, seed {seed}."


def tables(data: Data, *, task: str) -> dict[str, pd.DataFrame]:
    """Of each method its demonstrations and the share of the cells of each range that they visit."""
    from move.sim import coverage

    return {"": pd.DataFrame([
        {"method": name, "demonstrations": rows.episode.nunique(), **{
            part: coverage.visited_share(rows, get_task(task), part) for part in coverage.PARTS}}
        for name, rows in data.seen.configurations.items()])}


def draw(tables: dict[str, pd.DataFrame], data: Data, *, task: str) -> Figure:
    """For each way of collecting where object and target were, and below strips of frames."""
    seen, strips = data.seen
    ranges = {"object": get_task(task).object_range, "target": get_task(task).target_range}
    methods, share = list(seen), tables[""].set_index("method")
    figure = plt.figure(figsize=(PAGE_WIDTH, 2.9 + 0.98 * max(len(strips), 1)))
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[2.7, 0.1 + 1.05 * max(len(strips), 1)])[:, 0]
    for part in (top, bottom):
        part.set_facecolor("none")
    panels = top.subplots(len(ranges), len(methods), squeeze=False, sharex=True,
                          height_ratios=[box.high[1] - box.low[1] for box in ranges.values()])
    texts = []
    for row, (name, box) in zip(panels, ranges.items(), strict=True):
        for ax, method in zip(row, methods, strict=True):
            maps.coverage(seen[method], name, box.low, box.high, ax)
            texts.append(f"{NAMES[method]}, {name}: {100 * share.loc[method, name]:.0f} % of cells")
            ax.set_xlabel("x (cm)" if ax in panels[-1] else "")
            ax.set_ylabel(f"{name} y (cm)" if method == methods[0] else "")
    strip_axes = bottom.subplots(max(1, len(strips)), 1, squeeze=False)[:, 0]
    for ax, (frames, steps) in zip(strip_axes, strips.values(), strict=False):
        maps.strip(frames, [str(step) for step in steps], ax)
    if not strips:
        empty_panel(gl_problem() or "no images", strip_axes[0])
    titles([*panels.flat, *strip_axes], [*texts, *(strips or [""])])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data, *, timesteps: int) -> str:
    """How many demonstrations each method makes, and what share of the cells they show."""
    row = tables[""].set_index("method")
    shares = "; ".join(f"the {part}'s **{row[part].move:.0%}**, {row[part].static:.0%} and {row[part].adc:.0%}"
                       for part in ("object", "target", "camera"))
    return (
        "**The paper:** a picture, without numbers. "
        f"**Here:** at {timesteps:,} timesteps MOVE's {row.demonstrations.move}, static's {row.demonstrations.static} "
        f"and ADC's {row.demonstrations.adc} demonstrations show, of the cells of its range or arc, {shares}. "
        "**How sure:** counted in one collection a method; another seed gives much the same shares.")


WORDS = Words(
    title="Figure 2. The idea: points against segments",
    shown=(
        "(a to f) Where the object, until it is grasped, and the target were at every timestep that each way of "
        "collecting recorded, seen from above; the rectangle is the range that evaluation draws from; the percentage "
        "is the share of a 10 x 10 grid's cells visited. ADC (adversarial data collection) makes object and target "
        "jump. (g to i) Frames of demonstrations in which one thing alone moves; the number is the timestep. The "
        "titles say how much faster than in the data sets."),
    alt="Six scatter plots of places and three strips of camera images of a robot arm.",
    tables={
        "": "Figure 2: share of the cells of each range that the demonstrations visit, in per cent.",
    },
)
