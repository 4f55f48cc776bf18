"""The exercises' checks: each says "right", or what to look at; none of them shows the answer.

An answer is what its cell has left behind: a number, a text, a function, a class or a collection. Dots stand for an
answer that is not there yet.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from diffusers.schedulers.scheduling_ddim import DDIMScheduler

from move.learn.dataset import window_indices
from move.realworld.trials import power
from move.sim.collect import attempts
from move.sim.collection import Collection
from move.sim.configuration import reflect
from move.sim.motion.wrappers import Motion
from move.sim.scene import camera
from move.sim.scene.scene import Scene
from move.statistics.intervals import wilson_interval

Check = Callable[[Any], str]
MOST_TRIALS = 2000  # of which a power is computed, in a second
EXERCISES: dict[str, Check] = {}
"""By number, such as "1.2": takes an answer and returns "" where it is right, else what to look at."""


@dataclass(frozen=True)
class Verdict:
    """Whether an answer is right, and what to look at where it is not."""

    right: bool
    text: str

    def __str__(self) -> str:
        return self.text

    def _repr_markdown_(self) -> str:
        return f"{'✓' if self.right else '✗'} **{self.text}**"


def check(number: str, answer: Any) -> Verdict:
    """Judge the answer to exercise `number`; an answer that breaks is not right, and says how it broke."""
    if answer is ...:
        return Verdict(False, f"Exercise {number} has no answer yet: put it where the dots are.")
    try:
        problem = _of_another_kind(EXERCISES[number], answer) or EXERCISES[number](answer)
    except Exception as error:
        problem = f"your answer stopped with {type(error).__name__}: {error}"
    return Verdict(not problem, f"Exercise {number}: {problem or 'right.'}")


KINDS: dict[str, tuple[str, Callable[[Any], bool]]] = {
    "float": ("a number", lambda answer: isinstance(answer, (int, float, np.number)) and not isinstance(answer, bool)),
    "str": ("a text in quotes", lambda answer: isinstance(answer, str)),
    "Callable": ("a function", callable),
    "type": ("a class", lambda answer: isinstance(answer, type)),
    "Collection": ("a Collection(...)", lambda answer: isinstance(answer, Collection)),
}
"""By the annotation of a check's answer: what is wanted in words, and whether an answer is that."""
LARGEST = 10**6  # of an answer that is a number; all right ones are far below


def _of_another_kind(judge: Check, answer: Any) -> str:
    """What is wrong with an answer that is no number, function or what else is wanted; "" where it is."""
    annotation = inspect.signature(judge).parameters["answer"].annotation
    wanted, is_that = KINDS[re.match(r"\w+", annotation.replace("int", "float"))[0]]  # type: ignore[index]
    if answer is None:
        return f"the answer is None, which is nothing yet; wanted is {wanted}. Does a `return` or a name miss?"
    if not is_that(answer):
        return f"the answer is of type {type(answer).__name__}; wanted is {wanted}"
    if wanted == "a number" and not abs(answer) <= LARGEST:
        return f"{answer:.3g} cannot be meant: all numbers asked for here are far below a million"
    return ""


def exercise(number: str) -> Callable[[Check], Check]:
    """Register a check under its number."""
    def register(judge: Check) -> Check:
        EXERCISES[number] = judge
        return judge
    return register


def _near(answer: float, right: float, tolerance: float, hint: str) -> str:
    return "" if abs(float(answer) - right) <= tolerance else f"{answer:g} is not it; {hint}"


# 1, a scene that moves -----------------------------------------------------------------------------------------------


@exercise("1.1")
def mean_distance(answer: float) -> str:
    """Centimetres that an object goes on average in 30 steps at v_max 0.03 m a step: Beta(2, 5) has mean 2/7."""
    return _near(answer, 100 * 30 * 0.03 * 2 / 7, 0.5, "what is the mean of Beta(2, 5)? It is in the figure above. "
                 "Steps times v_max times that mean is in metres")


@exercise("1.2")
def bounce(answer: Callable[..., float]) -> str:
    """A function (start, velocity, time, low, high) -> position that bounces at both limits, in one dimension."""
    for start, velocity, time in ((0.2, 0.1, 3), (0.2, 0.1, 12), (0.2, -0.1, 5), (0.9, 0.07, 100), (0.5, -0.3, 41)):
        found, right = answer(start, velocity, time, 0.0, 1.0), reflect(start + velocity * time, 0.0, 1.0)
        if found is None:
            return "the function returns nothing yet"
        if abs(found - right) > 1e-9:
            return (f"from {start} at {velocity} a step, after {time} steps between 0 and 1: it gives {found:.3f}; "
                    f"without limits it would be at {start + velocity * time:.2f}. After two bounces a motion goes on "
                    "as at first: what is left of the way after dividing by twice the width?")
    return "" if abs(answer(2.5, 0.5, 3, 2.0, 3.0) - 2.0) < 1e-9 else "right from 0 to 1; now let `low` be other than 0"


@exercise("1.3")
def still_under_adc(answer: str) -> str:
    """What stands still throughout a demonstration of ADC: the camera."""
    if answer.strip().lower() == "camera":
        return ""
    return f"{answer!r} is not it; allowed are 'object', 'target' and 'camera': which one does not jump in the film?"


# 2, collect and look -------------------------------------------------------------------------------------------------


@exercise("2.1")
def back_to_the_world(answer: Callable[..., np.ndarray]) -> str:
    """A function (seen, angle) -> world points (n, 3), the inverse of `camera.to_camera_frame`."""
    rng = np.random.default_rng(0)
    points = rng.uniform(-1, 1, (5, 3))
    for angle in (0.0, 0.7, -2.0):
        found = answer(camera.to_camera_frame(points, angle), angle)
        if found is None:
            return "the function returns nothing yet"
        if not np.allclose(found, points):
            return (f"at camera angle {angle} the points do not come back. The rows of `axes` are orthogonal unit "
                    "vectors: multiply by the matrix itself, not its transpose, then add what was subtracted")
    return ""


@exercise("2.2")
def windows_of_a_budget(answer: int) -> str:
    """Training windows of 2,500 timesteps: as many."""
    return _near(answer, 2500, 0, "look at the table again: how many rows has each timestep?")


@exercise("2.3")
def window_of(answer: Callable[..., tuple[list[int], list[int]]]) -> str:
    """A function (t, first, last) -> (observed, predicted) of an episode whose timesteps are first to last."""
    ends = np.array([4, 6, 20])
    observed, predicted = window_indices(ends, 2, 4)
    for first, last in ((0, 3), (4, 5), (6, 19)):
        for t in range(first, last + 1):
            found = answer(t, first, last)
            if found is None:
                return "the function returns nothing yet"
            right = (observed[t].tolist(), predicted[t].tolist())
            if tuple(map(list, found)) != right:
                return (f"timestep {t} of an episode from {first} to {last}: it gives {tuple(map(list, found))}. What "
                        "reaches over an edge repeats the timestep at that edge; both begin one timestep early")
    return ""


# 3, a diffusion policy -----------------------------------------------------------------------------------------------


@exercise("3.1")
def noisy(answer: Callable[..., torch.Tensor]) -> str:
    """A function (actions, noise, alpha_bar) -> noisy actions."""
    generator = torch.Generator().manual_seed(0)
    actions, noise = (torch.randn((3, 4, 2), generator=generator) for _ in range(2))
    for level in (1.0, 0.0, 0.36):
        found = answer(actions, noise, level)
        if found is None:
            return "the function returns nothing yet"
        if not torch.allclose(found, math.sqrt(level) * actions + math.sqrt(1 - level) * noise, atol=1e-5):
            return f"at alpha_bar = {level} it is another; both weights are square roots, and their squares add up to 1"
    return ""


@exercise("3.2")
def ddim_step(answer: Callable[..., torch.Tensor]) -> str:
    """A function (x, eps, alpha_bar, alpha_bar_next) -> the sample one step later, equation 5."""
    schedule = DDIMScheduler(num_train_timesteps=100, beta_schedule="squaredcos_cap_v2", clip_sample=False)
    schedule.set_timesteps(10)
    generator = torch.Generator().manual_seed(0)
    x, eps = (torch.randn((3, 4, 2), generator=generator) for _ in range(2))
    for t in (90, 50, 10):
        right = schedule.step(eps, t, x).prev_sample
        found = answer(x, eps, float(schedule.alphas_cumprod[t]), float(schedule.alphas_cumprod[t - 10]))
        if found is None:
            return "the function returns nothing yet"
        if not torch.allclose(found, right, atol=1e-4):
            return (f"from t = {t} to {t - 10} diffusers' DDIMScheduler goes elsewhere. First take the noise out (with "
                    "alpha_bar of now) to get the clean actions, then put it back in (with that of the next level)")
    return ""


@exercise("3.3")
def passes(answer: int) -> str:
    """Times that the denoiser runs in an episode of 200 steps: 67 decisions of 10 DDIM steps."""
    return _near(answer, math.ceil(200 / 3) * 10, 0, "a decision lasts for T_a = 3 steps and the last one may be cut; "
                 "each decision takes ten DDIM steps")


# 4, what a success rate can say --------------------------------------------------------------------------------------


@exercise("4.1")
def trials_for_five_points(answer: int) -> str:
    """Trials after which a rate of one half is known to five points on either side: about 381."""
    if answer < 1:
        return f"{answer:g} trials tell nothing: how many does it take?"
    half = np.ptp(wilson_interval(0.5, answer)) / 2
    if half > 0.0505:
        return f"after {answer} trials the interval still reaches {100 * half:.1f} points to either side"
    return f"{answer} trials are more than needed: {100 * half:.1f} points" if half < 0.0485 else ""


@exercise("4.2")
def paired(answer: Callable[..., tuple[float, float]]) -> str:
    """A function (first, second) of (seeds, configurations) -> mean and standard error of the paired differences."""
    rng = np.random.default_rng(0)
    for seeds in (1, 3):
        first, second = (rng.integers(0, 2, (seeds, 12)).astype(float) for _ in range(2))
        apart = first.mean(axis=0) - second.mean(axis=0)
        found = answer(first, second)
        if found is None:
            return "the function returns nothing yet"
        if abs(found[0] - apart.mean()) > 1e-9:
            return "the first number is not the mean of the differences"
        if abs(found[1] - apart.std(ddof=1) / math.sqrt(12)) > 1e-9:
            return ("the mean is right, its standard error is not: take one difference a configuration (the mean of "
                    "its seeds), their standard deviation with ddof=1, and divide by the root of how many they are")
    return ""


@exercise("4.3")
def trials_for_a_robot(answer: int) -> str:
    """Trials of each method that find 23.3 % against 36.7 % four times in five, by Fisher's exact test."""
    if not 2 <= answer <= MOST_TRIALS:
        amount = "too few to compare" if answer < 2 else "far more than needed"
        return (f"{answer:g} trials of each method are {amount}: "
                "what does the table above say at 60 and at 120?")
    there, fewer = (power(7 / 30, 11 / 30, trials=trials) for trials in (int(answer), int(0.93 * answer)))
    if there < 0.8:
        return f"{answer} trials of each method find the difference in {there:.0%} of such studies only"
    return f"{answer} are enough and more: seven per cent fewer would do as well" if fewer >= 0.8 else ""


# 5, change the method ------------------------------------------------------------------------------------------------


@exercise("5.1")
def what_is_taught(answer: str) -> str:
    """What is left to MOVE when perception is given: nothing, so it teaches to see."""
    if (chosen := answer.strip().lower()) in ("seeing", "acting"):
        return "" if chosen == "seeing" else (
            "a policy that is given the object's place needs no MOVE here: compare the two rows")
    return f"{answer!r} given; allowed are 'seeing' and 'acting'"


@exercise("5.2")
def circling(answer: type[Motion]) -> str:
    """A PickMotion whose object goes round a circle at no more than its largest speed, and stays in its range."""
    speed, collection = 0.03, Collection(task="pick-place", method="static", timesteps=1)
    motion = answer(Scene("pick-place"), speed)
    motion.reset(seed=0)
    if motion.placed(0) is None:
        return "`placed` returns nothing yet"
    for _, episode in zip(range(4), attempts(collection, 0, motion), strict=False):
        if motion.placed(0).object_position != episode.start.object_position:
            return "at time 0 the object has to be where it started: `placed(0)` gives another place"
        path = np.array([motion.placed(step).object_position[:2] for step in range(31)])
        steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
        if steps.max() < 1e-6:
            return "the object does not move"
        if steps.max() > speed + 1e-9:
            return f"it moves {100 * steps.max():.1f} cm in a step; its largest speed is {100 * speed:.0f} cm"
        if not all(motion.scene.task.object_range.contains((*place, 0.02), 1e-3) for place in path):
            return "it leaves its range: let `self.scene.task.object_range.reflect` fold it back"
        (x, y), (next_x, next_y) = np.diff(path, axis=0)[:-1].T, np.diff(path, axis=0)[1:].T
        if np.mean(np.abs(x * next_y - y * next_x) > 1e-9) < 0.5:
            return "its path is straight: let the direction of the velocity turn with time"
    return ""


@exercise("5.3")
def half_and_half(answer: Collection) -> str:
    """A mixture of static and MOVE, half the timesteps each."""
    parts = {part.method: part.timesteps for part in answer.parts}
    if set(parts) != {"static", "move"}:
        return f"its parts are {', '.join(parts)}; wanted are static and move"
    return "" if abs(parts["static"] - parts["move"]) <= 1 else f"its parts have {parts}; wanted is half each"
