"""Films side by side, captioned, embedded in a notebook and looping; one line instead where nothing can be drawn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from IPython.display import Markdown, Video
from PIL import Image, ImageDraw, ImageFont

from move import paths
from move.learn.diffusion import DiffusionPolicy
from move.machine import gl_problem
from move.paper import PAPER_METHODS
from move.report import film
from move.report.style import COLOURS, NAMES
from move.study.spec import PolicyRun
from move.video import write_video

BAND = 36  # pixels above each film, for its caption
LOOPING = "controls autoplay loop muted playsinline"
SLOW = 15  # frames a second: about five times slower than the robot's own 80


def methods_film(task: str, size: int, seed: int) -> Video | Markdown:
    """One demonstration each of static, ADC and MOVE, which start alike, side by side."""
    if problem := gl_problem():
        return Markdown(f"No film: {problem}.")
    films = {NAMES[name]: film.demonstration_frames(film.demonstration(task, name, size), seed)
             for name in PAPER_METHODS}
    return embedded(side_by_side(films, [COLOURS[name] for name in PAPER_METHODS]), f"{task}_methods")


def outcomes_film(policy: DiffusionPolicy, spec: PolicyRun, size: int, seed: int) -> Video | Markdown:
    """An evaluation episode in which the policy succeeds beside one in which it fails; the only one if all are alike.

    Episodes are drawn at random by `seed`, at most twenty.
    """
    if problem := gl_problem():
        return Markdown(f"No film: {problem}.")
    played = film.one_of_each(policy, spec, np.random.default_rng(seed), size)
    films = {f"configuration {row['trial']}: {'success' if row['success'] else 'failure'}": frames
             for row, frames in played}
    return embedded(side_by_side(films, [COLOURS[spec.method]] * len(films)), f"{spec.method}_outcomes")


def side_by_side(films: Mapping[str, np.ndarray], colours: list[str]) -> np.ndarray:
    """One film of several, each below its name and step; the shorter ones wait at their last frame.

    Args:
        films: name -> (timesteps, size, size, 3) uint8, all of one size.
        colours: of the names, one a film.

    Returns:
        (most timesteps, BAND + size, films * size, 3) uint8, sides even.
    """
    longest = max(map(len, films.values()))
    columns = [np.stack([_captioned(frames[min(step, len(frames) - 1)], name, min(step, len(frames) - 1), colour)
                         for step in range(longest)])
               for (name, frames), colour in zip(films.items(), colours, strict=True)]
    return np.concatenate(columns, axis=2)


def _captioned(frame: np.ndarray, name: str, step: int, colour: str) -> np.ndarray:
    picture = Image.new("RGB", (frame.shape[1], frame.shape[0] + BAND), "white")
    picture.paste(Image.fromarray(frame), (0, BAND))
    ink, font = ImageDraw.Draw(picture), ImageFont.load_default(size=14)
    ink.text((5, 1), name, fill=colour, font=font)
    ink.text((5, 17), f"step {step}", fill="black", font=font)
    return np.asarray(picture)


def embedded(frames: np.ndarray, name: str) -> Video:
    """Frames (timesteps, height, width, 3) uint8 as a film inside the notebook that plays by itself and loops.

    A copy stays in build/tutorial/.
    """
    path = paths.BUILD / "tutorial" / f"{name}.mp4"
    write_video(path, frames, frames.shape[1:3], SLOW, "yuv420p", {})
    return Video(str(path), embed=True, width=frames.shape[2], html_attributes=LOOPING)
