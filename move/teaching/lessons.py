"""Small figures and tables of the data, of the policy and of success rates."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import ipywidgets
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import torch
from IPython.display import Markdown, display
from matplotlib.axes import Axes
from torch import Tensor

from move.figures.page.parameters import runs as runs_of
from move.figures.plots.style import COLOURS, NAMES
from move.learn.dataset import window_indices
from move.learn.diffusion import DiffusionPolicy, noise_schedule
from move.learn.settings import Training
from move.learn.train import TrainingReport, train
from move.machine import gl_problem
from move.sim.collect import Collection, collect
from move.sim.demonstrations import Demonstrations
from move.sim.observe import keypoint_slices
from move.sim.tasks import get_task
from move.statistics import cells
from move.statistics.estimates import success_rate
from move.statistics.intervals import exact_interval, wilson_interval
from move.study import results
from move.study.profiles import load_profile
from move.validation import build

REDRAWN = 0.2  # seconds between two looks at the progress of a training


# the data ------------------------------------------------------------------------------------------------------------


def named_keypoints(observation: np.ndarray, task: str) -> pd.DataFrame:
    """One keypoint a row: its name and its place in the camera's frame, centimetres."""
    slices = keypoint_slices(get_task(task).keypoints)
    return pd.DataFrame({name: 100 * observation[part].astype(float) for name, part in slices.items()},
                        index=["right (cm)", "up (cm)", "forward (cm)"]).T.round(1)


def windows_table(demonstrations: Demonstrations, training: Training, first: int, count: int) -> pd.DataFrame:
    """What each of some windows observes and predicts, and which of it is executed: timesteps of the data set."""
    observed, predicted = window_indices(
        demonstrations.episode_ends, training.observation_horizon, training.prediction_horizon)
    rows = range(first, min(first + count, demonstrations.timesteps))
    return pd.DataFrame({"observed": [observed[t].tolist() for t in rows],
                         "predicted": [predicted[t].tolist() for t in rows],
                         "executed": [predicted[t][training.executed].tolist() for t in rows]},
                        index=pd.Index(rows, name="timestep"))


def draw_pictures(task: str, methods: tuple[str, ...], size: int, seed: int, timesteps: tuple[int, ...]) -> Markdown:
    """Images of the first demonstration by each method at some timesteps, as a policy from pixels sees them."""
    if problem := gl_problem():
        return Markdown(f"No images: {problem}.")
    figure, axes = plt.subplots(len(methods), len(timesteps), figsize=(1.3 * len(timesteps), 1.35 * len(methods)))
    for row, method in zip(axes, methods, strict=True):
        wanted = Collection(task=task, method=method, timesteps=max(timesteps) + 1, observation="rgb", image_size=size)
        seen = collect(wanted, seed)[0].observations
        for ax, step in zip(row, timesteps, strict=True):
            ax.imshow(seen[step])
            ax.set(xticks=[], yticks=[], title=f"step {step}" if ax in axes[0] else "")
        row[0].set_ylabel(NAMES[method], color=COLOURS[method])
    plt.show()
    return Markdown(f"An observation is {size} x {size} x 3 numbers from 0 to 255; a policy gets two of them.")


# the policy ----------------------------------------------------------------------------------------------------------


def keypoint_training(timesteps: int, gradient_steps: int) -> Training:
    """The recipe of profile laptop-keypoints for so many timesteps, with other gradient steps."""
    recipe = load_profile("laptop-keypoints").recipe("keypoints", timesteps)
    return build(Training, **{**recipe.model_dump(), "gradient_steps": gradient_steps,
                              "warmup_steps": min(recipe.warmup_steps, gradient_steps // 2)})


def draw_noising(actions: np.ndarray, training: Training, levels: tuple[int, ...], seed: int) -> None:
    """The x displacement of a demonstration's actions under more and more noise, and alpha_bar over the noise levels.

    Args:
        actions: (timesteps, action_size) in [-1, 1].
        levels: diffusion times t, below `diffusion_steps`.
    """
    schedule, generator = noise_schedule(training), torch.Generator().manual_seed(seed)
    clean = torch.from_numpy(actions[:, :1])
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 2.2), width_ratios=[2, 1])
    for level, shade in zip(levels, np.linspace(0.0, 0.75, len(levels)), strict=True):
        noise = torch.randn(clean.shape, generator=generator)
        noisy = schedule.add_noise(clean, noise, cast(torch.IntTensor, torch.tensor([level])))
        left.plot(noisy, color=str(shade), lw=1, label=f"t = {level}")
    left.set(xlabel="timestep", ylabel="action, x")
    left.legend(ncol=len(levels))
    right.plot(schedule.alphas_cumprod, color="black")
    right.set(xlabel="noise level t", ylabel="alpha_bar_t")
    plt.show()


@contextmanager
def cpu_time(clock: dict[str, float], part: str) -> Iterator[None]:
    """Note in `clock` how many seconds of processor time a part took."""
    started = time.process_time()
    yield
    clock[part] = round(time.process_time() - started, 1)


def train_live(demonstrations: Demonstrations, training: Training, seed: int) -> tuple[DiffusionPolicy, TrainingReport]:
    """`move.learn.train.train` with a bar that moves, and the loss curve at its end."""
    bar = ipywidgets.IntProgress(max=training.gradient_steps, description="training")
    loss_now, shown_at = ipywidgets.Label(), 0.0
    display(ipywidgets.HBox([bar, loss_now]))

    def show(done: int, total: int, loss: Tensor) -> None:
        nonlocal shown_at
        if time.monotonic() - shown_at > REDRAWN or done == total:
            shown_at = time.monotonic()
            bar.value, loss_now.value = done, f"step {done} of {total}, loss {loss:.4f}"

    return train(demonstrations, training, seed, on_step=show)


def draw_loss(report: TrainingReport) -> None:
    """The loss over the gradient steps, each point the mean since the one before."""
    steps, losses = zip(*report.curve, strict=True)
    figure, ax = plt.subplots(figsize=(4.2, 2.2))
    ax.plot(steps, losses, color="black")
    ax.set(yscale="log", xlabel="gradient steps", ylabel="loss")
    plt.show()


# success rates -------------------------------------------------------------------------------------------------------


def stored(figure: str, profile: str) -> pd.DataFrame:
    """The episodes of a figure's stored runs, one row each; nothing is computed."""
    chosen = load_profile(profile)
    runs = {run.spec.hash: run for run in runs_of(figure, chosen)}
    there, _ = results.split([run.spec for run in runs.values()], chosen.results)
    return results.table(there)


def cell(episodes: pd.DataFrame, method: str) -> np.ndarray:
    """One method's successes, (seeds, configurations)."""
    return cells.successes(episodes[episodes.method == method])


def seeds_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """One row a method: each training's success, and two intervals of their mean, per cent.

    Wilson's takes all episodes as alike; the other one knows that another training differs.
    """
    rows = []
    for method in ("static", "move"):
        successes = cell(episodes, method)
        alone, found = wilson_interval(float(successes.mean()), successes.size), success_rate(successes)
        rows.append({"method": NAMES[method], "each training": _per_cent(*successes.mean(axis=1)),
                     "mean": f"{100 * successes.mean():.0f}", "episodes alone": _per_cent(*alone),
                     "with trainings": _per_cent(found.low, found.high)})
    return pd.DataFrame(rows).set_index("method")


def _per_cent(*rates: float) -> str:
    return ", ".join(f"{100 * rate:.0f}" for rate in rates)


def draw_intervals(rates: list[float], trials: int, ax: Axes) -> None:
    """The exact 95 % interval of each rate after so many trials."""
    for place, rate in enumerate(rates):
        low, high = exact_interval(round(rate * trials), trials)
        ax.plot([low, high], [place, place], color="black", lw=1.2)
        ax.plot(rate, place, "o", color="black", ms=4)
    ax.set_yticks(range(len(rates)), [f"{round(rate * trials)} of {trials}" for rate in rates])
    ax.set(xlim=(0, 1), xlabel="success rate")
