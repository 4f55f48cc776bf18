"""A mixture: demonstrations by several methods, each with its share of the timesteps."""

from move.sim.methods.method import Method

MIXTURE = Method("mixture", "mixture", "#009E73", "v", wrap=None, reads=("shares",))
