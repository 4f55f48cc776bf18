"""Static collection, the first baseline: nothing moves within a demonstration."""

from move.sim.methods.method import Method

STATIC = Method("static", "static", "#0072B2", "o", wrap=lambda scene, collection: scene)
