"""Axes of a grid that several figures have: tasks with the paper's budgets, and each task's floors and ceiling."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Any

from move.sim.tasks import get_task
from move.study.kinds import control_run
from move.study.labels import LabelledRun, grid


def budgets(tasks: Iterable[str], most_timesteps: int) -> dict[str, dict[str, Any]]:
    """The axis `task`, each task with the paper's budget for it, but at most `most_timesteps`."""
    return {name: {"task": name, "timesteps": get_task(name).budget(most_timesteps)} for name in tasks}


def floors_and_ceilings(tasks: Iterable[str], episodes: int) -> list[LabelledRun]:
    """Of each task: doing nothing, random actions, the expert, and with a goal the expert told a wrong one."""
    base = partial(control_run, episodes=episodes)
    agents = {task: ["nothing", "random", "expert"] + ["goal-blind"] * get_task(task).has_target for task in tasks}
    return [run for task, those in agents.items() for run in grid(base, task=[task], agent=those)]
