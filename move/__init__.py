"""MOVE, reproduced: demonstrations from moving scenes, diffusion policies, and every figure and table of the paper.

Importing the package makes its scenes known to Gymnasium as MOVE/<task>-v0.
"""

import gymnasium

from move.machine import choose_gl
from move.sim.tasks import TASKS

choose_gl()

for _name in TASKS:
    gymnasium.register(f"MOVE/{_name}-v0", "move.sim.scene.scene:Scene", max_episode_steps=200, kwargs={"task": _name})

__version__ = "0.1.0"
