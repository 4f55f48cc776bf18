"""Figure 8: real-robot demonstrations in whatever layout they come: the arm's ways, the object's places, its speed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from pydantic import Field

from move import paths
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.printed import as_markdown
from move.figures.plots import real_figures
from move.figures.plots.style import NAMES, in_order

if TYPE_CHECKING:
    from move.realworld import RobotDataSet

PROPOSED = 10  # placements
Revision = Annotated[str, Field(pattern=r"^([0-9a-f]{40})?$")]
Episodes = Annotated[int, Field(gt=0, le=10**5, strict=True)]
Gigabytes = Annotated[float, Field(gt=0, le=10**5, allow_inf_nan=False)]


class Seen(NamedTuple):
    """The demonstrations, the cells that the end effector visited, its ways, where it grasped, and where objects were.

    `grasps` are the places of each method that has some, (N, 2) m.
    """

    demos: RobotDataSet
    cells: pd.DataFrame
    steps: pd.DataFrame
    grasps: dict[str, np.ndarray]
    places: pd.DataFrame


def seen(
    data: Data, *, dataset: str = "", revision: Revision = "", episodes: Episodes = 20, size_cap_gb: Gigabytes = 2.0,
    units_file: str = "",
) -> Seen:
    """A data set's demonstrations, opened.

    Args:
        dataset: a folder, or owner/name on the Hub such as "BAAI/MOVE"; empty: the simulated sample.
        revision: a full commit of 40 digits; empty: the Hub is asked once for the newest.
        episodes: how many demonstrations are read of each part.
        size_cap_gb: never fetch more than this.
        units_file: YAML that overrides the detected units; empty: detect.
    """
    from move.realworld import open_dataset, tracking, workspace, write_sample  # what reads data is slow to import
    from move.realworld.grasps import grasp_table

    demos = open_dataset(
        dataset or write_sample(paths.REALWORLD / "sample", episodes=episodes), revision=revision or None,
        episodes=episodes, size_cap_gb=size_cap_gb, units_file=Path(units_file) if units_file else None, log=print)
    camera = next((name for episode in demos.episodes for name in episode.cameras), "")
    steps = workspace.path_table(demos.episodes)
    grasps = grasp_table(demos.episodes)
    places = {method: grasps.loc[grasps.method == method, ["x_m", "y_m"]].to_numpy()
              for method in in_order(grasps.method)}
    return Seen(demos, workspace.coverage_by_method(workspace.equal_budget(steps)), steps, places,
                tracking.object_places(demos.episodes, camera))


def source(data: Data) -> str:
    """Which data set it is, and how much of it was read."""
    return data.seen.demos.origin


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """What was checked."""
    from move.realworld import check_dataset, checks_table

    return {"checks": checks_table(check_dataset(data.seen.demos))}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, Figure]:
    """For each method its ways, the cells visited, and frames; and where the object was seen, if it was."""
    from move.realworld import tracking, workspace
    from move.statistics.places import next_places, spanned

    demos, cells, steps, grasps, places = data.seen
    figures = {"fig8_real_setup": real_figures.setup_figure(
        cells, steps, workspace.frame_strips(demos.episodes), simulated=demos.simulated,
        joints=workspace.joint_table(demos.episodes), lacking=workspace.why_no_positions(demos.episodes))}
    table = spanned(np.vstack(list(grasps.values()))) if grasps else None
    if table:
        proposed = {method: next_places(points, table, PROPOSED)[0] for method, points in grasps.items()}
        figures["fig8_grasp_places"] = real_figures.grasp_figure(grasps, proposed, simulated=demos.simulated)
    if len(places):
        speeds = tracking.object_speeds(places, metres_per_pixel=demos.about.get("metres_per_pixel"))
        figures["fig8_object_places"] = real_figures.object_figure(places, speeds, simulated=demos.simulated)
    return figures


def answer(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, str]:
    """What share of the table's cells the arm visits, and in what share of the image's cells the object was seen."""
    from move.realworld import tracking, workspace
    from move.statistics.places import in_words, repetitions

    demos, cells, _, grasps, places = data.seen
    visited = (cells.visits > 0).groupby(cells.method, sort=False).mean()
    ways = "; ".join(f"{NAMES[method]}: the end effector passed through {share:.0%} of the table's cells"
                     for method, share in visited.items())
    objects = "; ".join(
        f"{NAMES[method]}: in {len(rows)} frames the orange was seen in {tracking.seen_share(rows):.0%} of the image's "
        "cells" for method, rows in workspace.equal_budget(places).groupby("method"))
    grasped = "; ".join(f"{NAMES[method]}: {in_words(repetitions(points))}" for method, points in grasps.items())
    return {"fig8_grasp_places": grasped or "Nothing to compare",
            "fig8_real_setup": "; ".join(filter(None, (ways, as_markdown(workspace.why_no_positions(demos.episodes))))),
            "fig8_object_places": objects or "Nothing to compare"}


WORDS = Words(
    title="Figure 8. The real-robot setup: workspace and demonstrations",
    shown=(
        "Left: the way of the end effector to each grasp (dots), seen from above on the half disc of 60 cm radius; the "
        "black square is the arm's base, y grows to the left as seen by the arm. Right: the cells of 5 cm that it "
        "passed through, up to as many timesteps for each method. Below: frames of one demonstration of each method, "
        "each at its own times; orange: the object, blue: the tray it is put on, black: the fingers. Of "
        "another arm than the paper's its joints over time are drawn in place of the hand's way."),
    alt="Half discs with trajectories and visited cells, and two strips of images from above.",
    tables={
        "checks": "What was checked in the real-robot demonstrations.",
    },
    others={
        "fig8_grasp_places": Words(
            title="Figure 8, continued. Where demonstrations grasp, and where the next ones should",
            shown=(
                "Where the hand was at each grasp, from above in the frame of the arm's base or of the data set. "
                f"Numbers: where the next {PROPOSED} demonstrations should put the object, in order, each in the "
                "middle of the largest hole that those before it leave, within the part of the table that all grasps "
                "span (`move coverage` takes another)."),
            alt="A map from above for each method with dots at the grasps and numbers in the holes.",
        ),
        "fig8_object_places": Words(
            title="Figure 8, continued. Where the object was, and how fast it moved",
            shown=(
                "(a, b) Where the orange was seen in the image up to its grasp, joined within a demonstration. (c) Its "
                "mean speed before the grasp, one dot a demonstration, spread sideways to be told apart. The orange is "
                "followed by its colour; what a still orange seems to move is the noise of that."),
            alt="Two maps of an image with dots and lines, and a strip of dots for the speeds.",
        ),
    },
)
