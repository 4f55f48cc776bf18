"""MOVE, reproduced: demonstrations from moving scenes, diffusion policies, and every figure and table of the paper.

Importing the package makes its scenes known to Gymnasium as MOVE/<task>-v0: they move as MOVE's do, unless
`method="static"` or "adc" is given; see `move.sim.moving_scene`. `move.moving` puts the same motions around any other
MuJoCo environment.
"""

from typing import TYPE_CHECKING, Any

import gymnasium

from move.machine import choose_gl, fill_closed_streams
from move.sim.tasks import TASKS

fill_closed_streams()
choose_gl()

for _name in TASKS:
    gymnasium.register(f"MOVE/{_name}-v0", "move.sim.moving_scene:MovingScene", max_episode_steps=200,
                       kwargs={"task": _name})

__version__ = "0.1.0"

if TYPE_CHECKING:
    from move.sim.moving import moving as moving


def __getattr__(name: str) -> Any:
    """`move.moving`, which imports MuJoCo, once it is asked for."""
    if name == "moving":
        from move.sim.moving import moving

        return moving
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
