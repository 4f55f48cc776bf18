"""The one exception that means: the input was wrong, nothing was written, exit code 2."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any


class BadInput(ValueError):
    """Raised with one line that says what was given, what is allowed and where."""

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows of it, in IPython's own words: this line, and no traceback."""
        return [f"\x1b[31mBadInput\x1b[0m: {self}"]


def one_of(what: str, given: Any, allowed: Collection[Any]) -> None:
    """Refuse anything but the allowed.

    Raises:
        BadInput: something else.
    """
    if given not in tuple(allowed):
        raise BadInput(f"{what}: {given!r} given; allowed are {', '.join(map(str, allowed))}")
