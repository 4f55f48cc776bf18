"""What a collection method is: a name, its looks, what it moves, and how it wraps a scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import gymnasium

from move.sim.motion.wrappers import SPEEDS, Part

if TYPE_CHECKING:
    from move.sim.collection import Collection
    from move.sim.scene.scene import Scene

MOTION_SETTINGS = ("motions", "object_steps", "moving", *SPEEDS.values(), "speed_law")


@dataclass(frozen=True)
class Method:
    """How demonstrations are collected: what happens to a scene while the expert acts in it.

    `wrap` puts around a scene what moves in it, as the collection says. A method without it is a mixture of others.
    """

    name: str
    title: str  # in figures and tables
    colour: str  # of its marks; hexadecimal
    marker: str  # matplotlib's, of MOVE minus this method
    wrap: Callable[[Scene, Collection], gymnasium.Env] | None
    moves: tuple[Part, ...] = ()  # at speeds that a collection may choose (`Collection.motions_used`)
    reads: tuple[str, ...] = ()  # what other fields of Collection it reads that not all methods do
    usual: Mapping[str, Any] = field(default_factory=dict)  # fields of Collection wherever the study compares methods

    @property
    def settings(self) -> tuple[str, ...]:
        """The fields of Collection that have an effect under this method, but not under all."""
        return (*self.reads, *(MOTION_SETTINGS if self.moves else ()))
