"""MOVE: object, target and camera move while the expert demonstrates (equations 1 to 3)."""

from move.sim.grasp_points import motion_region
from move.sim.methods.method import Method
from move.sim.motion.wrappers import PARTS, with_motions

MOVE = Method(
    "move", "MOVE", "#D55E00", "^", moves=PARTS,
    wrap=lambda scene, collection: with_motions(
        scene, collection.motions_used, collection.factors, motion_region(collection.protocol, scene.task),
        arrive=collection.protocol != "random"),
)
