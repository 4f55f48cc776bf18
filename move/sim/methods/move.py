"""MOVE: object, target and camera move while the expert demonstrates (equations 1 to 3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import gymnasium

from move.sim.grasp_points import motion_region
from move.sim.methods.method import Method
from move.sim.motion.wrappers import PARTS, with_motions

if TYPE_CHECKING:
    from move.sim.collection import Collection
    from move.sim.scene.scene import Scene


def staged(scene: Scene, collection: Collection) -> gymnasium.Env:
    """The staged strategy; where grasp points are prescribed, the object arrives there."""
    region = motion_region(collection.protocol, scene.task)
    return with_motions(scene, collection.motions_used, collection.factors, region, collection.protocol != "random")


MOVE = Method("move", "MOVE", "#D55E00", "^", staged, moves=PARTS)
