"""MOVE, reproduced: demonstrations from moving scenes, diffusion policies, and every figure and table of the paper.

Importing the package makes its scenes known to Gymnasium as MOVE/<task>-v0: they move as MOVE's do, unless
`method="static"` or "adc" is given; see `move.sim.moving_scene`.
"""

import gymnasium

from move.machine import choose_gl, fill_closed_streams
from move.sim.tasks import TASKS

fill_closed_streams()
choose_gl()

for _name in TASKS:
    gymnasium.register(f"MOVE/{_name}-v0", "move.sim.moving_scene:MovingScene", max_episode_steps=200,
                       kwargs={"task": _name})

__version__ = "0.1.0"
