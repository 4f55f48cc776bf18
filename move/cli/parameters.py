"""-p name=value."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from move import yaml_text
from move.errors import BadInput


def parameters(given: list[str] | None, texts: Collection[str] = ()) -> dict[str, Any]:
    """The parameters given as `name=value`, each value read as YAML reads it.

    Args:
        texts: the names of those that are texts, whose values are taken as they stand.

    Raises:
        BadInput: no such assignment, or a name given twice; the profile, which has an option of its own; a text with
            characters that cannot be printed.

    >>> parameters(["seeds=2", "timesteps=[100, 200]", "data=2024-10-01 #2"], ["data"])
    {'seeds': 2, 'timesteps': [100, 200], 'data': '2024-10-01 #2'}
    """
    read: dict[str, Any] = {}
    for text in given or []:
        name, equals, value = text.partition("=")
        if not equals or not name.isidentifier():
            raise BadInput(f"-p {text[:60]!r}: allowed is name=value")
        if name == "profile":
            raise BadInput(f"-p profile: allowed is --profile {value[:60]}")
        if name in read:
            raise BadInput(f"-p {name}: given twice; allowed is once")
        if name in texts and not value.isprintable():
            raise BadInput(f"-p {name}: {value[:60]!r} given; allowed are characters that can be printed")
        read[name] = value if name in texts else yaml_text.read(value, f"-p {name}")
    return read
