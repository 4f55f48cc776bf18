"""The ten tasks of the paper by name. A task's action space is the same for every method."""

from __future__ import annotations

from move.errors import one_of
from move.sim.tasks.opening import DISASSEMBLE, FAUCET_OPEN, WINDOW_OPEN
from move.sim.tasks.placing import ASSEMBLY, BASKETBALL, BOX_CLOSE, HAMMER, PICK_PLACE, PICK_PLACE_WALL, PUSH
from move.sim.tasks.task import FACTORS, Task

__all__ = ["DEFAULT_TASK", "FACTORS", "TASKS", "Task", "get_task"]

TASKS = {
    task.name: task
    for task in (PICK_PLACE, PUSH, ASSEMBLY, BOX_CLOSE, HAMMER, PICK_PLACE_WALL, WINDOW_OPEN, FAUCET_OPEN,
                 DISASSEMBLE, BASKETBALL)
}
"""In the order of Table 2."""

DEFAULT_TASK = PICK_PLACE.name


def get_task(name: str) -> Task:
    """The task called `name`.

    Raises:
        BadInput: an unknown name.

    >>> get_task("pick-place").title
    'Pick-Place'
    """
    one_of("task", name, TASKS)
    return TASKS[name]
