"""The collection methods by name: the paper's three, and mixtures of them."""

from __future__ import annotations

from move.errors import one_of
from move.sim.methods.adc import ADC
from move.sim.methods.method import Method
from move.sim.methods.mixture import MIXTURE
from move.sim.methods.move import MOVE
from move.sim.methods.static import STATIC

__all__ = ["METHODS", "Method", "get_method", "single_methods"]

METHODS = {method.name: method for method in (STATIC, ADC, MOVE, MIXTURE)}
"""All that exist, in the order in which figures draw them; those of the paper are `move.paper.PAPER_METHODS`."""


def get_method(name: str) -> Method:
    """The method called `name`.

    Raises:
        BadInput: an unknown name.

    >>> get_method("adc").title
    'ADC'
    """
    one_of("method", name, METHODS)
    return METHODS[name]


def single_methods() -> list[str]:
    """The names of those that wrap a scene, which a mixture can be made of."""
    return [name for name, method in METHODS.items() if method.wrap]
