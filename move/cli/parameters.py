"""-p name=value."""

from __future__ import annotations

from typing import Any

from move import yaml_text
from move.errors import BadInput


def parameters(given: list[str] | None) -> dict[str, Any]:
    """The parameters given as `name=value`, each value read as YAML reads it.

    Raises:
        BadInput: no such assignment, or a name given twice; the profile, which has an option of its own.

    >>> parameters(["seeds=2", "timesteps=[100, 200]"])
    {'seeds': 2, 'timesteps': [100, 200]}
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
        read[name] = yaml_text.read(value, f"-p {name}")
    return read
