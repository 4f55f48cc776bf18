"""What success and failure look like: evaluation episodes of table 2's policies as films."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.figures.page.captions import Words, listed
from move.figures.page.data import Data
from move.figures.page.make import steps
from move.figures.page.parameters import Count, Frames, Observation, Pixels, RandomSeed, TaskName
from move.figures.plots import maps
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import NAMES, PAGE_WIDTH, remark, titles
from move.machine import gl_problem
from move.paper import PAPER_METHODS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile
from move.study.spec import PolicyRun

SIMULATES = True

OUTCOMES = {True: "success", False: "failure"}
COLUMNS = ["method", "episode", "outcome", "in the evaluation", "steps"]


def runs(
    profile: Profile, observation: Observation = "rgb", task: TaskName = "pick-place", timesteps: Count = 20_000,
    episodes: Count = 100,
) -> list[LabelledRun]:
    """The first seed's policies of table 2 on one task."""
    base = partial(policy_run, profile, task=task, seed=0, observation=observation, timesteps=timesteps,
                   episodes=episodes)
    return grid(base, method=PAPER_METHODS)


class Seen(NamedTuple):
    """The episodes shown: a row and a strip of frames each, the films, and methods whose policies are not there."""

    rows: pd.DataFrame
    strips: dict[str, tuple[np.ndarray, list[int]]]
    films: list[Path]
    absent: list[str]


def seen(data: Data, *, task: str, seed: RandomSeed = 0, frames: Frames = 8, image_size: Pixels = 320) -> Seen:
    """Episodes drawn at random, for each method until one has succeeded and one has failed.

    Args:
        seed: decides which episodes are drawn.
        frames: of each strip.
        image_size: pixels along a side of a frame.
    """
    from move.figures.plots import film
    from move.study import policies

    kept = [result for result in data.results if policies.folder_of(result.spec, data.profile)]
    absent = [NAMES[result.spec.method] for result in data.results if result not in kept]
    rows, strips, films = [], {}, []
    for result in steps([] if gl_problem() else kept, "policies"):
        assert isinstance(result.spec, PolicyRun)
        method, acting = result.spec.method, policies.acting(result.spec, data.profile)
        for row, take in film.one_of_each(acting, result.spec, np.random.default_rng(seed), image_size):
            ended, title = OUTCOMES[row["success"]], f"{NAMES[method]}, episode {row['trial']}"
            films.append(film.write_film(film.titled(take, title, task, ended),
                                         data.folder / f"rollouts_{method}_{ended}.mp4"))
            strips[f"{title}, ends in {ended} ({film.rings(task)})"] = film.strip(film.marked(take), frames)
            rows.append({"method": method, "episode": row["trial"], "outcome": ended, "steps": row["steps"],
                         "in the evaluation": OUTCOMES[result.rows[row["trial"]]["success"]]})
    return Seen(pd.DataFrame(rows, columns=COLUMNS), strips, films, absent)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """The episodes shown, how they ended here and in the evaluation."""
    return {"": data.seen.rows}


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One strip of frames an episode."""
    strips, absent = data.seen.strips, data.seen.absent
    count = max(1, len(strips))
    figure, axes = plt.subplots(count, 1, figsize=(PAGE_WIDTH, 1.14 * count), squeeze=False)
    for ax, (frames, shown) in zip(axes.flat, strips.values(), strict=False):
        maps.strip(frames, [str(step) for step in shown], ax)
    if not strips:
        empty_panel(gl_problem() or "no run is stored", axes[0, 0])
    titles(list(axes.flat), list(strips) or [""])
    if absent:
        remark(figure, f"not shown, for the policy is not shipped: {', '.join(absent)}")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data, *, episodes: int) -> str:
    """How many episodes are shown, how many end as in the evaluation, and how often the policies succeed."""
    table, absent = tables[""], data.seen.absent
    same = (table["outcome"] == table["in the evaluation"]).sum()
    rates = ", ".join(f"{NAMES[result.spec.method]} {result.rate:.0%}" for result in data.results)
    lacking = f"The policy of {listed(absent)} is not shipped and not shown. " * bool(absent)
    return (
        f"**The paper** shows no failures. **Here:** {len(table)} episodes, drawn and not picked; {same} of them ended "
        f"in the evaluation as they do here. {lacking}Over all {episodes} episodes the policies succeed in: {rates}. "
        f"**How sure:** two episodes show how, not how often. {data.sample_size} Films: {data.profile.figures.name}/.")


WORDS = Words(
    title="What success and failure look like",
    shown=(
        "Evaluation episodes drawn at random, for each method until one has succeeded and one has failed; a yellow "
        "ring is round the object, a white one round the target, and a line shows the way it came. The number on a "
        "frame is its timestep. An episode ends ten steps after its first success, or after 200; one successful step "
        "makes it a success."),
    alt="Strips of camera images of a robot arm, one a shown episode.",
    tables={
        "": "The episodes shown, how they ended here and in the evaluation.",
    },
)
