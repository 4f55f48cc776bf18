"""Solutions of 5_change_the_method, each under the name that its exercise uses."""

import math
from dataclasses import replace

from move.sim.collect import Collection
from move.sim.configuration import vector
from move.sim.motion.equations import sample_speed
from move.sim.motion.wrappers import PickMotion

# 5.1: given where the object is, static does as well as MOVE
taught = "seeing"


# 5.2: a circle through the starting place; radius times angle a step is the speed
class Circling(PickMotion):
    """The object goes round a circle through its starting place."""

    radius = 0.05  # metres

    def sample(self, rng):
        self.angle = rng.uniform(0, 2 * math.pi)
        self.turn = sample_speed(rng, self.maximum_speed) / self.radius

    def placed(self, time):
        x, y, z = self.start.object_position
        now = self.angle + self.turn * time
        dx, dy = (self.radius * (f(now) - f(self.angle)) for f in (math.cos, math.sin))
        there = self.scene.task.object_range.reflect((x + dx, y + dy, z))
        return replace(self.scene.configuration, object_position=vector(there))


# 5.3: parts of a mixture lie one behind the other
mixture = Collection(task="pick-place", method="mixture", timesteps=2500,
                     shares={"static": 0.5, "move": 0.5})
