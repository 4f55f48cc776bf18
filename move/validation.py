"""What pydantic refuses, as one line."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from move.errors import BadInput

Model = TypeVar("Model", bound=BaseModel)


def build(model: type[Model], **values: Any) -> Model:
    """Build `model` from values that somebody chose.

    Raises:
        BadInput: what pydantic refuses, in one line.
    """
    try:
        return model(**values)
    except ValidationError as error:
        raise BadInput(first_problem(error)) from error


def first_problem(error: ValidationError) -> str:
    """The first thing that pydantic found wrong, in one line: where, what was given, what is allowed."""
    first = error.errors()[0]
    where = " ".join(".".join(str(part) for part in first["loc"]).split()) or "settings"
    given = first.get("input")
    shown = "" if isinstance(given, dict | list | BaseModel) else f"{given!r} given; "
    return f"{where}: {shown}{first['msg'].removeprefix('Value error, ').lower()}"
