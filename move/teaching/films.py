"""Films side by side, captioned, embedded in a notebook and looping; one line instead where nothing can be drawn."""

from __future__ import annotations

import numpy as np
from IPython.display import Markdown, Video

from move import paths
from move.figures.plots import film
from move.figures.plots.style import NAMES
from move.learn.agents import PolicyAgent
from move.learn.diffusion import DiffusionPolicy
from move.machine import gl_problem
from move.paper import PAPER_METHODS
from move.study.spec import PolicyRun
from move.video import write_video

LOOPING = "controls autoplay loop muted playsinline"
SLOW = 15  # frames a second: about five times slower than the robot's own 80


def methods_film(task: str, size: int, seed: int) -> Video | Markdown:
    """One demonstration each of static, ADC and MOVE, which start alike, side by side."""
    if problem := gl_problem():
        return Markdown(f"No film: {problem}.")
    films = [film.titled(film.demonstration_take(film.demonstration(task, name, size), seed), NAMES[name], task)
             for name in PAPER_METHODS]
    return embedded(film.side_by_side(films), f"{task}_methods")


def outcomes_film(policy: DiffusionPolicy, spec: PolicyRun, size: int, seed: int) -> Video | Markdown:
    """An evaluation episode in which the policy succeeds and one in which it fails; the only one if all are alike.

    Episodes are drawn at random by `seed`, at most twenty.
    """
    if problem := gl_problem():
        return Markdown(f"No film: {problem}.")
    played = film.one_of_each(lambda _: PolicyAgent(policy, spec.seed), spec, np.random.default_rng(seed), size)
    films = [film.titled(take, f"configuration {row['trial']}", spec.task, "success" if row["success"] else "failure")
             for row, take in played]
    return embedded(film.side_by_side(films), f"{spec.method}_outcomes")


def embedded(frames: np.ndarray, name: str) -> Video:
    """Frames (timesteps, height, width, 3) uint8 as a film inside the notebook that plays by itself and loops.

    A copy stays in build/tutorial/.
    """
    path = paths.BUILD / "tutorial" / f"{name}.mp4"
    write_video(path, frames, frames.shape[1:3], SLOW, "yuv420p", {})
    return Video(str(path), embed=True, width=frames.shape[2], html_attributes=LOOPING)
