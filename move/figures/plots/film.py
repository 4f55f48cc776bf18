"""Frames and short films of the scene, drawn from real rollouts.

A `Take` is what a camera saw and where object and target were; `marked` draws rings and trails into its images, so that
the object is told from arm and table at a glance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
from matplotlib import get_data_path
from PIL import Image, ImageDraw, ImageFont

from move.files import written_aside
from move.learn.agents import Agent
from move.learn.evaluate import evaluate
from move.sim.collect import attempts, collecting_env
from move.sim.collection import Collection
from move.sim.methods import get_method
from move.sim.motion.wrappers import Motions
from move.sim.scene import camera
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.study.spec import PolicyRun
from move.video import write_video

FRAMES_PER_SECOND = 25  # of the scene's 80 timesteps a second, so that a film is about three times slower than real
LETTERS, BAND = 14, 40  # pixels: height of a film's letters, and of the band that they stand in
LAST = 25  # frames for which a film shows how it ended
WEBP_WIDTH = 732  # pixels
RINGS = {"object": (255, 232, 0), "target": (255, 255, 255)}  # yellow and white: nothing in the scene is
ALONE = {"translation": ("object_speed", 0.03), "rotation": ("yaw_speed", 0.1), "camera": ("camera_speed", 0.07)}
"""One motion alone: whose speed, and how much, fast enough to be seen."""
RING_M, TRAIL, WORD = 0.045, 25, 20  # radius in metres; timesteps that a trail goes back; that a jump is written for
TRIES = 20  # episodes played to see one succeed and one fail
FINE = 3  # times as fine are rings drawn, and then made smaller


Where = tuple[dict[str, np.ndarray], float]  # positions by part, and the camera's angle


@dataclass(frozen=True)
class Take:
    """A rollout as it is filmed.

    `frames` is (steps, size, size, 3) uint8; `places` has the positions of "object" and, where the task has one,
    "target", each (steps, 3) in metres; `angles` are the camera's, (steps,) radians; `jumps` says which of the two a
    step shows in a new place, under ADC.
    """

    frames: np.ndarray
    places: Mapping[str, np.ndarray]
    angles: np.ndarray
    jumps: Mapping[int, str] = field(default_factory=dict)


class Watching(gymnasium.Wrapper):
    """Keeps where object and target (metres) and the camera (radians) are whenever a scene is observed."""

    def __init__(self, env: gymnasium.Env) -> None:
        super().__init__(env)
        self.scene = cast(Scene, env.unwrapped)
        self.seen: list[Where] = []
        self.jumps: dict[int, str] = {}  # number of an observation -> what it shows in a new place

    def reset(self, **keywords: Any) -> tuple[Any, dict]:
        """Start an episode with nothing seen."""
        found = self.env.reset(**keywords)
        self.seen, self.jumps, self.counted = [where(self.scene)], {}, 0
        return found

    def step(self, action: np.ndarray) -> tuple[Any, Any, bool, bool, dict]:
        """Step, and look."""
        part = "object" if self.scene.phase == "pick" else "target"
        found = self.env.step(action)
        if found[-1].get("jumps", 0) > self.counted:
            self.counted, self.jumps[len(self.seen)] = found[-1]["jumps"], part
        self.seen.append(where(self.scene))
        return found


def where(scene: Scene) -> Where:
    """Where object and target (metres) and the camera (radians) are."""
    points = {"object": scene.task.object_point}
    if scene.task.has_target:
        points["target"] = scene.task.target_point
    return {part: np.array(scene.point(name)) for part, name in points.items()}, scene.configuration.camera_angle


def taken(frames: Sequence[np.ndarray], seen: Sequence[Where], jumps: Mapping[int, str]) -> Take:
    """Images with where everything was at each of them, and at nothing after the last."""
    kept = seen[:len(frames)]
    return Take(np.stack(frames), {part: np.stack([places[part] for places, _ in kept]) for part in kept[0][0]},
                np.array([angle for _, angle in kept]), jumps)


def demonstration_take(collection: Collection, seed: int) -> Take:
    """The first successful demonstration.

    Raises:
        BadInput: images cannot be drawn on this machine.
    """
    watching = Watching(collecting_env(collection))
    episode = next(episode for episode in attempts(collection, seed, watching) if episode.succeeded)
    return taken(episode.observations, watching.seen, watching.jumps)


def episode_take(agent: Agent, spec: PolicyRun, number: int, image_size: int) -> tuple[dict, Take]:
    """Play one evaluation episode of a run: its row, and all its timesteps.

    Raises:
        BadInput: images cannot be drawn on this machine.
    """
    frames: list[np.ndarray] = []
    seen: list[Where] = []

    def look(_: int, scene: Scene) -> None:
        frames.append(scene.render_image(image_size))
        seen.append(where(scene))

    (row,) = evaluate(agent, get_task(spec.task), spec.evaluation, spec.collection.observed, indices={number},
                      callback=look)
    return row, taken(frames, seen, {})


def one_of_each(
    acting: Callable[[int], Agent], spec: PolicyRun, rng: np.random.Generator, image_size: int
) -> list[tuple[dict, Take]]:
    """Play evaluation episodes in random order until one has succeeded and one has failed; these two, or the only one.

    An episode is played alone here and in a batch with others in the evaluation; rounding differs a little, and an
    episode that hangs on a millimetre may end otherwise.

    Args:
        acting: who acts in the episode of a number.
    """
    shown: dict[bool, tuple[dict, Take]] = {}
    for number in rng.permutation(spec.evaluation.episodes)[:TRIES]:
        row, take = episode_take(acting(int(number)), spec, int(number), image_size)
        shown.setdefault(row["success"], (row, take))
        if len(shown) == 2:
            break
    return [shown[outcome] for outcome in (True, False) if outcome in shown]


def demonstration(task: str, method: str, image_size: int = 192, motions: Motions | None = None) -> Collection:
    """The collection that a film of one demonstration shows, by the method as the study compares it."""
    return Collection(task=task, method=method, timesteps=1, observation="rgb", image_size=image_size,
                      motions=motions or Motions(), **get_method(method).usual)


def only(part: str) -> Motions:
    """Motions of which only one of `ALONE` is left."""
    field, speed = ALONE[part]
    still = {"object_speed": 0.0, "target_speed": 0.0, "yaw_speed": 0.0, "camera_speed": 0.0}
    return Motions.model_validate({**still, field: speed})


def pace(part: str) -> str:
    """How fast `only(part)` moves, in words: against the data sets."""
    field, speed = ALONE[part]
    times = speed / getattr(Motions(), field)
    return f"{times:.2g} times as fast as in the data" if times != 1 else "as fast as in the data"


def strip(frames: np.ndarray, count: int) -> tuple[np.ndarray, list[int]]:
    """`count` evenly spaced frames, shape (count, size, size, 3), and the timesteps that they show."""
    steps = np.linspace(0, len(frames) - 1, count).round().astype(int)
    return frames[steps], steps.tolist()


def rings(task: str) -> str:
    """What the rings in the images of a task are round, in words.

    >>> rings("push"), rings("faucet-open")
    ('yellow ring: object, white ring: target', 'yellow ring: object')
    """
    return "yellow ring: object" + ", white ring: target" * get_task(task).has_target


def marked(take: Take) -> np.ndarray:
    """The images of a take with a ring round object and target, the way each of them came, and a word at a jump.

    Returns:
        (steps, size, size, 3) uint8.
    """
    return np.stack([_mark(take, step) for step in range(len(take.frames))])


def _mark(take: Take, step: int) -> np.ndarray:
    """One image of a take with its marks, drawn finer than it is."""
    size = take.frames.shape[1]
    line, angle = max(1, round(FINE * size / 140)), float(take.angles[step])
    over = Image.new("RGBA", (FINE * size, FINE * size))
    draw = ImageDraw.Draw(over)
    for part, places in reversed(list(take.places.items())):
        jumped = max((each for each, what in take.jumps.items() if what == part and each <= step), default=0)
        way, scale = pixels(places[max(jumped, step - TRAIL):step + 1], angle, FINE * size)
        (x, y), radius, colour = way[-1], RING_M * scale[-1], RINGS[part]
        if len(way) > 1:
            draw.line([tuple(each) for each in way], (*colour, 170), line)
        for wider, shade in ((line, (0, 0, 0, 200)), (0, (*colour, 255))):
            draw.ellipse((x - radius - wider, y - radius - wider, x + radius + wider, y + radius + wider),
                         outline=shade, width=line + 2 * wider)
        if 0 < jumped and step - jumped < WORD:
            (old,), _ = pixels(places[jumped - 1:jumped], angle, FINE * size)
            draw.line([tuple(old), (x, y)], (*colour, 170), line)
            draw.text((min(max(x, 0.2 * FINE * size), 0.8 * FINE * size), max(y - radius, 0.1 * FINE * size)),
                      f"{part} jumps", colour, _font(FINE * size // 18), anchor="mb", stroke_width=line,
                      stroke_fill="black")
    picture = Image.fromarray(take.frames[step]).convert("RGBA")
    picture.alpha_composite(over.resize((size, size), Image.Resampling.BOX))
    return np.asarray(picture.convert("RGB"))


def pixels(points: np.ndarray, angle: float, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Where world points (n, 3) in metres are in an image of `size` pixels along each side, and pixels a metre there.

    Args:
        angle: the camera's, radians.

    Returns:
        Column and row from the upper left corner, (n, 2), and pixels a metre at each point's distance, (n,).

    >>> place, scale = pixels(np.array([camera.LOOK_AT]), 1.0, 100)
    >>> place.round(6).tolist(), scale.round().tolist()
    ([[50.0, 50.0]], [134.0])
    """
    right, up, forward = camera.to_camera_frame(points, angle).T
    scale = size / 2 / math.tan(camera.FIELD_OF_VIEW / 2) / np.maximum(forward, 1e-6)
    return size / 2 + np.column_stack([right, -up]) * scale[:, None], scale


@cache
def _font(pixels: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(str(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), pixels)


def titled(take: Take, title: str, task: str, outcome: str = "") -> np.ndarray:
    """Marked images under a band that says whose they are, the timestep, what the rings are, and last the outcome.

    Args:
        outcome: "success" or "failure": the last image is held for `LAST` frames and says that it ends in that.

    Returns:
        (steps, or `LAST` more, size + band, size, 3) uint8.
    """
    frames = marked(take)
    steps, height, width, _ = frames.shape
    shown = [*range(steps), *[steps - 1] * LAST * bool(outcome)]
    whole = np.full((len(shown), height + BAND, width, 3), 255, np.uint8)
    for place, step in enumerate(shown):
        band = Image.new("RGB", (width, BAND), "white")
        draw, ending = ImageDraw.Draw(band), f" ends in {outcome}" if place >= steps else f", step {step}"
        draw.text((4, 2), f"{title}{ending}", "black", _font(LETTERS))
        draw.text((4, 2 + BAND // 2), rings(task), "#444444", _font(LETTERS))
        whole[place, :BAND], whole[place, BAND:] = band, frames[step]
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


def write_webp(frames: np.ndarray, path: Path) -> Path:
    """Write frames (timesteps, height, width, 3) uint8 as a small animated WebP, which a README can show.

    Raises:
        BadInput: it cannot be written, as on a full disk; what was there stays.
    """
    height = round(frames.shape[1] * WEBP_WIDTH / frames.shape[2])
    first, *others = (Image.fromarray(frame).resize((WEBP_WIDTH, height), Image.Resampling.LANCZOS) for frame in frames)
    with written_aside(path) as new:
        first.save(new, format="WEBP", save_all=True, append_images=others, duration=1000 // FRAMES_PER_SECOND, loop=0,
                   quality=70, method=4)
    return path
