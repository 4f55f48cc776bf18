"""What moves (figure 6), how fast (figure 7) and by which law, MOVE from pixels at table 2's budget."""

from __future__ import annotations

import math
from functools import partial
from typing import Annotated, Any

from pydantic import Field

from move.choices import SpeedLaw
from move.experiments.budgets import budgets
from move.experiments.registry import Count, Seeds, experiment
from move.sim.collection import FASTEST, FASTEST_TURN
from move.sim.motion.wrappers import movable
from move.sim.tasks import get_task
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

ORDER = ("object", "target", "camera", "rotation")  # in which figure 6 adds them
Speed = Annotated[float, Field(gt=0, le=FASTEST, allow_inf_nan=False)]
Degrees = Annotated[float, Field(gt=0, le=math.degrees(FASTEST_TURN), allow_inf_nan=False)]


@experiment
def fig6_dimensions(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "assembly"),
    alone_tasks: tuple[str, ...] = ("pick-place",), seeds: Seeds = 3, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """Nothing moves, then the object, the target, the camera and the rotation as well; on some tasks each one alone.

    The label `moves` names what moves; where nothing does, the demonstrations are static (figure 6).
    """
    base = partial(policy_run, profile, episodes=episodes)
    return [run for task in dict.fromkeys((*tasks, *alone_tasks))
            for run in grid(base, seed=range(seeds), task=budgets([task], most_timesteps),
                            moves=_moves(task, task in tasks, task in alone_tasks))]


def _moves(task: str, together: bool, alone: bool) -> dict[str, dict[str, Any]]:
    parts = sorted(movable(get_task(task), "all"), key=ORDER.index)
    chosen = {"nothing": (), "object": ("object",)}
    if together:
        chosen |= {" + ".join(parts[:count]): tuple(parts[:count]) for count in range(2, len(parts) + 1)}
    if alone:
        chosen |= {f"{part} alone": (part,) for part in parts[1:]}
    return {name: {"method": "move", "moving": moving} if moving else {"method": "static"}
            for name, moving in chosen.items()}


@experiment
def fig7_speed(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "assembly"),
    camera_tasks: tuple[str, ...] = ("pick-place",), speeds: tuple[Speed, ...] = (0.01, 0.02, 0.03, 0.05, 0.08),
    camera_degrees: tuple[Degrees, ...] = (0.33, 0.67, 1.0, 1.67, 2.67), seeds: Seeds = 2, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[LabelledRun]:
    """The largest speed of the object, of the target, or of the camera, the others as always; and static (figure 7).

    Labels: `part`, whose speed it is ("nothing": static), and `speed`, metres a step or degrees a step of the camera.

    Args:
        speeds: of object and target, metres per step.
        camera_degrees: of the camera, degrees per step.
    """
    base = partial(policy_run, profile, episodes=episodes)
    runs: list[LabelledRun] = []
    for task in tasks:
        place: dict[str, Any] = {"seed": range(seeds), "task": budgets([task], most_timesteps)}
        runs += grid(partial(base, method="static"), **place, part={"nothing": {}}, speed={0.0: {}})
        for part in [name for name in ("object", "target") if name in movable(get_task(task), "all")]:
            runs += grid(partial(base, method="move"), **place, part={part: {}},
                         speed={speed: {f"{part}_speed": speed} for speed in speeds})
        if task in camera_tasks:
            runs += grid(partial(base, method="move"), **place, part={"camera": {}},
                         speed={angle: {"camera_speed": math.radians(angle)} for angle in camera_degrees})
    return runs


@experiment
def fig_speed_law(
    profile: Profile, task: str = "pick-place", laws: tuple[SpeedLaw, ...] = ("beta", "uniform", "constant"),
    seeds: Seeds = 2, timesteps: Count = 20_000, episodes: Count = 100,
) -> list[LabelledRun]:
    """MOVE with every speed drawn by another law of the same mean, and static; the label `law` (section III-B).

    The paper's law is "beta"; where nothing moves, the label is "static".
    """
    base = partial(policy_run, profile, task=task, timesteps=timesteps, episodes=episodes)
    chosen: dict[str, dict[str, str]] = {"static": {"method": "static"}}
    chosen |= {law: {"method": "move", "speed_law": law} for law in laws}
    return grid(base, seed=range(seeds), law=chosen)
