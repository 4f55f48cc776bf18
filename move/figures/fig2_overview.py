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
LONGEST = 40  # timesteps of a strip of one motion alone


class Seen(NamedTuple):
    """The configurations of each method's demonstrations, and strips of frames."""

    configurations: Mapping[str, pd.DataFrame]
    strips: Strips


def seen(
    data: Data, *, task: TaskName = "pick-place", rotating_task: TaskName = "assembly", timesteps: Count = 2500,
    frames: Frames = 8, image_size: Pixels = 160, seed: RandomSeed = 0,
) -> Seen:
    """One collection a method without images; with them a demonstration of each, and of two motions alone.

    Args:
        task: whose configurations and demonstrations are drawn.
        rotating_task: whose object is turned in one of the last strips.
        frames: of each strip.
        image_size: pixels along a side of a frame.
    """
    from move.figures.plots import film
    from move.sim import coverage  # imports the simulator

    collected: dict[str, pd.DataFrame] = {
        name: coverage.configurations(Collection(task=task, method=name, timesteps=timesteps), seed)
        for name in PAPER_METHODS}
    if gl_problem():
        return Seen(collected, {})
    strips = {f"{NAMES[name]}, {TASKS[task].title} ({film.rings(task)})": film.strip(
        film.marked(film.demonstration_take(film.demonstration(task, name, image_size), seed)), frames)
        for name in PAPER_METHODS}
    for part, name in (("rotation", rotating_task), ("camera", task)):
        alone = film.demonstration_take(film.demonstration(name, "move", image_size, film.only(part)), seed)
        strips[f"{part} alone, {TASKS[name].title}, {film.pace(part)}"] = film.strip(
            film.marked(alone)[:LONGEST], frames)
    return Seen(collected, strips)


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
    """A map a way of collecting of where object and target were, and below strips of frames."""
    seen, strips = data.seen
    ranges = {"object": get_task(task).object_range}
    if get_task(task).has_target:
        ranges["target"] = get_task(task).target_range
    methods, share = list(seen), tables[""].set_index("method")
    figure = plt.figure(figsize=(PAGE_WIDTH, 2.9 + 0.98 * max(len(strips), 1)))
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=[2.7, 0.1 + 1.05 * max(len(strips), 1)])[:, 0]
    for part in (top, bottom):
        part.set_facecolor("none")
    panels = top.subplots(1, len(methods), sharex=True, sharey=True, squeeze=False)[0]
    for ax, method in zip(panels, methods, strict=True):
        for name, box in ranges.items():
            maps.coverage(seen[method], name, box.low, box.high, ax, f"{name} {100 * share.loc[method, name]:.0f} %")
        ax.set(xlabel="x (cm)", ylabel="y (cm)" if method == methods[0] else "")
    texts = [NAMES[method] for method in methods]
    strip_axes = bottom.subplots(max(1, len(strips)), 1, squeeze=False)[:, 0]
    for ax, (frames, steps) in zip(strip_axes, strips.values(), strict=False):
        maps.strip(frames, [str(step) for step in steps], ax)
    if not strips:
        empty_panel(gl_problem() or "no images", strip_axes[0])
    titles([*panels, *strip_axes], [*texts, *(strips or [""])])
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
        "(a to c) Where the object, until it is grasped, and the target were at every timestep that each way of "
        "collecting recorded, seen from above; the rectangles are the ranges that evaluation draws from; the "
        "percentage is the share of a 10 x 10 grid's cells visited. ADC (adversarial data collection) makes object and "
        "target jump. (d to f) Frames of one demonstration each, ADC's with the jumps of table 2; "
        "the number is the timestep, the rings are drawn round object and target, and a line shows the way each came. "
        "(g, h) One thing alone moves; the titles say how much "
        "faster than in the data sets."),
    alt="Three scatter plots of places and five strips of camera images of a robot arm.",
    tables={
        "": "Figure 2: share of the cells of each range that the demonstrations visit, in per cent.",
    },
)
