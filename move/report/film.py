"""Frames and short films of the scene, drawn from real rollouts."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from move.learn.agents import PolicyAgent
from move.learn.diffusion import DiffusionPolicy
from move.learn.evaluate import evaluate
from move.sim.collect import attempts
from move.sim.collection import Collection, Method
from move.sim.motion.wrappers import Motions
from move.sim.tasks import get_task
from move.study.spec import PolicyRun
from move.video import write_video

FRAMES_PER_SECOND = 25  # two timesteps of three are shown at real speed


def demonstration_frames(collection: Collection, seed: int) -> np.ndarray:
    """The pictures of the first successful demonstration, shape (timesteps, size, size, 3), uint8.

    Raises:
        BadInput: pictures cannot be drawn on this machine.
    """
    return np.stack(next(episode.observations for episode in attempts(collection, seed) if episode.succeeded))


def episode_frames(policy: DiffusionPolicy, spec: PolicyRun, number: int, image_size: int) -> tuple[dict, np.ndarray]:
    """Play one evaluation episode of a run again: its row, and every timestep as (steps, size, size, 3) uint8.

    Raises:
        BadInput: pictures cannot be drawn on this machine.
    """
    frames: list[np.ndarray] = []
    (row,) = evaluate(
        PolicyAgent(policy, spec.seed), get_task(spec.task), spec.evaluation, spec.collection.observed,
        indices={number}, callback=lambda _, scene: frames.append(scene.render_image(image_size)),
    )
    return row, np.stack(frames)


def one_of_each(
    policy: DiffusionPolicy, spec: PolicyRun, rng: np.random.Generator, image_size: int, tries: int = 20
) -> list[tuple[dict, np.ndarray]]:
    """Play evaluation episodes in random order until one has succeeded and one has failed; these two, or the only one.

    An episode is played alone here and was played beside others in the evaluation; rounding differs a little, and an
    episode that hangs on a millimetre may end otherwise.
    """
    shown: dict[bool, tuple[dict, np.ndarray]] = {}
    for number in rng.permutation(spec.evaluation.episodes)[:tries]:
        row, frames = episode_frames(policy, spec, int(number), image_size)
        shown.setdefault(row["success"], (row, frames))
        if len(shown) == 2:
            break
    return [shown[outcome] for outcome in (True, False) if outcome in shown]


def demonstration(task: str, method: Method, image_size: int = 192, motions: Motions | None = None) -> Collection:
    """The collection that a film of one demonstration shows."""
    return Collection(task=task, method=method, timesteps=1, observation="rgb", image_size=image_size,
                      motions=motions or Motions())


def only(part: str) -> Motions:
    """Motions of which only one is left, fast enough to be seen: "translation", "rotation" or "camera"."""
    still = {"object_speed": 0.0, "target_speed": 0.0, "yaw_speed": 0.0, "camera_speed": 0.0}
    moving = {"translation": {"object_speed": 0.03}, "rotation": {"yaw_speed": 0.1}, "camera": {"camera_speed": 0.07}}
    return Motions(**{**still, **moving[part]})


def strip(frames: np.ndarray, count: int) -> np.ndarray:
    """`count` evenly spaced frames side by side, shape (size, count * size, 3), uint8."""
    chosen = np.linspace(0, len(frames) - 1, count).round().astype(int)
    return np.concatenate(frames[chosen], axis=1)


def write_film(frames: np.ndarray, path: Path) -> Path:
    """Write frames (timesteps, height, width, 3) uint8 as a small MP4 (H.264)."""
    write_video(path, frames, frames.shape[1:3], FRAMES_PER_SECOND, "yuv420p", {})
    return path
