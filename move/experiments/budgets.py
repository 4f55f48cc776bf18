"""Tasks with the paper's budgets."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from move.sim.tasks import get_task


def budgets(tasks: Iterable[str], most_timesteps: int) -> dict[str, dict[str, Any]]:
    """The axis `task`, each task with the paper's budget for it, but at most `most_timesteps`."""
    return {name: {"task": name, "timesteps": get_task(name).budget(most_timesteps)} for name in tasks}
