"""What can a success rate say? Simulated studies of intervals, and how much stored trainings differ."""

from __future__ import annotations

from typing import Annotated

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field

from move.figures import plots
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Share
from move.figures.plots.style import PAGE_WIDTH, titles
from move.statistics import simulation

Several = Field(min_length=1, max_length=20)
Trainings = Annotated[int, Field(gt=0, le=1000, strict=True)]


def seen(
    data: Data, *, seeds: Annotated[tuple[Trainings, ...], Several] = (1, 2, 3, 5),
    deviations: Annotated[tuple[Share, ...], Several] = (0.02, 0.04, 0.06, 0.08, 0.1), rate: Share = 0.4,
    draws: Annotated[Count, Field(le=10**6)] = 2000,
) -> pd.DataFrame:
    """So many simulated studies of each number of seeds and each deviation of the trainings."""
    return simulation.coverage(list(seeds), list(deviations), rate, draws)


def source(data: Data, *, draws: int, rate: float) -> str:
    """How many studies there are."""
    return f"{draws:,} studies of each kind, true rate {rate:.2f}."


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """How often intervals hold the truth, and how wide they are."""
    return {"": data.seen.round(4)}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """How often the intervals hold the truth, and how wide they are."""
    figure, axes = plt.subplots(1, 2, figsize=(PAGE_WIDTH, 2.8))
    plots.coverages(data.seen, axes[0])
    axes[0].legend(loc="lower left")
    plots.half_widths(data.seen[data.seen.interval == "ours"], axes[1])
    titles(axes, ["do the intervals hold the truth?", "what another seed buys"])
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data, *, draws: int) -> str:
    """Coverage of our intervals and of naive ones, and how much stored trainings differ."""
    noise = {seen: data.noise(seen) for seen in data.profile.training}
    stored = "; ".join(
        f"{'pixels' if seen == 'rgb' else 'keypoints'} {100 * one.deviation:.1f} points ({one.repeats} repeated)"
        if one.degrees else f"{seen} nothing is known" for seen, one in noise.items())
    over = data.seen.groupby(["interval", "seeds"]).covered.mean()  # cells of all deviations together
    ours, naive = over["ours"].agg(["min", "max"]), over["episodes alone"].agg(["min", "max"])
    least = data.seen[data.seen.interval == "ours"].covered.min()
    return (
        f"**The paper** gives rates without intervals. **Here:** nominal 95 % intervals held the truth in "
        f"{100 * ours['min']:.0f} to {100 * ours['max']:.0f} % of simulated studies ({100 * least:.0f} % at worst); "
        f"those of episodes alone in {100 * naive['min']:.0f} to {100 * naive['max']:.0f} %. Trainings differ by: "
        f"{stored}. **How sure:** {draws:,} studies tell a coverage to about "
        f"{100 * 1.96 * (0.05 * 0.95 / draws) ** 0.5:.0f} point.")


WORDS = Words(
    title="What can a success rate say?",
    shown=(
        "Simulated studies of 100 configurations. (a) How often nominal 95 % intervals hold the true rate: ours "
        "filled, those that count episodes alone hollow, one shape a number of seeds; the grey band is 93 to 97 %. "
        "(b) How wide ours are with one seed and with more, by how much trainings differ."),
    alt="A scatter plot of coverages around a band at 95 %, and three falling curves.",
    tables={
        "": (
            "Simulated studies: share in per cent of nominal 95 % intervals that hold the true rate, and half "
            "their width in points."),
    },
)
