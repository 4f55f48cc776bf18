"""Frames and short films of the scene, drawn from real rollouts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib import get_data_path
from PIL import Image, ImageDraw, ImageFont

from move.learn.agents import Agent
from move.learn.evaluate import evaluate
from move.sim.collect import attempts
from move.sim.collection import Collection
from move.sim.motion.wrappers import Motions
from move.sim.tasks import get_task
from move.study.spec import PolicyRun
from move.video import write_video

FRAMES_PER_SECOND = 25  # of the scene's 80 timesteps a second, so that a film is about three times slower than real
LETTERS, BAND = 14, 40  # pixels: height of a film's letters, and of the band that they stand in
SEEN = {
    "pick-place": "red: object, blue: target", "push": "red: object, green: target",
    "assembly": "green handle: object, red peg: target", "box-close": "lid: object, box: target",
    "hammer": "red handle: object, grey nail: target", "pick-place-wall": "red: object, blue: target",
    "window-open": "white handle: object", "faucet-open": "red handle: object",
    "disassemble": "green handle: object, on a red peg", "basketball": "ball: object, ring: target",
}
"""What is what in the images of a task."""


def demonstration_frames(collection: Collection, seed: int) -> np.ndarray:
    """The images of the first successful demonstration, shape (timesteps, size, size, 3), uint8.

    Raises:
        BadInput: images cannot be drawn on this machine.
    """
    return np.stack(next(episode.observations for episode in attempts(collection, seed) if episode.succeeded))


def episode_frames(agent: Agent, spec: PolicyRun, number: int, image_size: int) -> tuple[dict, np.ndarray]:
    """Play one evaluation episode of a run: its row, and every timestep as (steps, size, size, 3) uint8.

    Raises:
        BadInput: images cannot be drawn on this machine.
    """
    frames: list[np.ndarray] = []
    (row,) = evaluate(
        agent, get_task(spec.task), spec.evaluation, spec.collection.observed,
        indices={number}, callback=lambda _, scene: frames.append(scene.render_image(image_size)),
    )
    return row, np.stack(frames)


def one_of_each(
    acting: Callable[[int], Agent], spec: PolicyRun, rng: np.random.Generator, image_size: int, tries: int = 20
) -> list[tuple[dict, np.ndarray]]:
    """Play evaluation episodes in random order until one has succeeded and one has failed; these two, or the only one.

    An episode is played alone here and in a batch with others in the evaluation; rounding differs a little, and an
    episode that hangs on a millimetre may end otherwise.

    Args:
        acting: who acts in the episode of a number.
    """
    shown: dict[bool, tuple[dict, np.ndarray]] = {}
    for number in rng.permutation(spec.evaluation.episodes)[:tries]:
        row, frames = episode_frames(acting(int(number)), spec, int(number), image_size)
        shown.setdefault(row["success"], (row, frames))
        if len(shown) == 2:
            break
    return [shown[outcome] for outcome in (True, False) if outcome in shown]


def demonstration(task: str, method: str, image_size: int = 192, motions: Motions | None = None) -> Collection:
    """The collection that a film of one demonstration shows."""
    return Collection(task=task, method=method, timesteps=1, observation="rgb", image_size=image_size,
                      motions=motions or Motions())


def only(part: str) -> Motions:
    """Motions of which only one is left, fast enough to be seen: "translation", "rotation" or "camera"."""
    still = {"object_speed": 0.0, "target_speed": 0.0, "yaw_speed": 0.0, "camera_speed": 0.0}
    moving = {"translation": {"object_speed": 0.03}, "rotation": {"yaw_speed": 0.1}, "camera": {"camera_speed": 0.07}}
    return Motions.model_validate({**still, **moving[part]})


def pace(part: str) -> str:
    """How fast `only(part)` moves, in words: against the data sets."""
    field = {"translation": "object_speed", "rotation": "yaw_speed", "camera": "camera_speed"}[part]
    times = getattr(only(part), field) / getattr(Motions(), field)
    return f"{times:.2g} times as fast as in the data" if times != 1 else "as fast as in the data"


def strip(frames: np.ndarray, count: int) -> tuple[np.ndarray, list[int]]:
    """`count` evenly spaced frames, shape (count, size, size, 3), and the timesteps that they show."""
    steps = np.linspace(0, len(frames) - 1, count).round().astype(int)
    return frames[steps], steps.tolist()


def titled(frames: np.ndarray, title: str, task: str, outcome: str = "") -> np.ndarray:
    """Frames over a band that says whose they are, the timestep, the outcome, and what is what in the image.

    Args:
        frames: (timesteps, size, size, 3) uint8.

    Returns:
        (timesteps, size + band, size, 3) uint8.
    """
    font = ImageFont.truetype(str(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), LETTERS)
    steps, height, width, _ = frames.shape
    whole = np.full((steps, height + BAND, width, 3), 255, np.uint8)
    whole[:, BAND:] = frames
    for step in range(steps):
        band = Image.new("RGB", (width, BAND), "white")
        draw = ImageDraw.Draw(band)
        draw.text((4, 2), f"{title}, step {step}" + (f": {outcome}" if outcome else ""), "black", font)
        draw.text((4, 2 + BAND // 2), SEEN.get(task, ""), "#444444", font)
        whole[step, :BAND] = band
    return whole


def side_by_side(films: Sequence[np.ndarray]) -> np.ndarray:
    """Films of one height side by side; one that is over keeps its last frame until the longest is."""
    longest = max(len(frames) for frames in films)
    gap = np.full((longest, films[0].shape[1], 8, 3), 255, np.uint8)
    held = [np.concatenate([frames, np.repeat(frames[-1:], longest - len(frames), axis=0)]) for frames in films]
    return np.concatenate([part for frames in held for part in (gap, frames)][1:], axis=2)


def write_film(frames: np.ndarray, path: Path) -> Path:
    """Write frames (timesteps, height, width, 3) uint8 as a small MP4 (H.264)."""
    write_video(path, frames, frames.shape[1:3], FRAMES_PER_SECOND, "yuv420p", {"crf": "26"})
    return path
