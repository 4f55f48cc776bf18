"""What pydantic refuses, and why a file could not be read, as one line."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from move.errors import BadInput

Model = TypeVar("Model", bound=BaseModel)
LONGEST_GIVEN = 60  # characters repeated of what was given, which may be a whole file
LONGEST_REASON = 200  # characters


def build(model: type[Model], **values: Any) -> Model:
    """Build `model` from values that a user chose.

    Raises:
        BadInput: what pydantic refuses, in one line.
    """
    return validated(model, values)


def validated(model: type[Model], content: Any, where: str = "", hint: str = "") -> Model:
    """`content` as a `model`.

    Raises:
        BadInput: what pydantic refuses, in one line that begins with `where` it stood and ends with `hint`.
    """
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise BadInput(f"{where}{': ' if where else ''}{first_problem(error)}{hint}") from error


def first_problem(error: ValidationError, whole: str = "settings") -> str:
    """The first thing that pydantic found wrong, in one line: where, what was given, what is allowed.

    Args:
        whole: the name of all that was given, said where no part of it is at fault.
    """
    first = error.errors()[0]
    where = " ".join(".".join(str(part) for part in first["loc"]).split()) or whole
    given = first.get("input")
    shown = "" if isinstance(given, dict | list | BaseModel) else f"{_cut(repr(given))} given; "
    told = first["msg"].removeprefix("Value error, ").lower().replace("a valid tuple", "a list, in brackets")
    return f"{where}: {shown}{told}"


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_GIVEN else f"{text[:LONGEST_GIVEN]}..."


def reason_of(error: Exception, whole: str = "settings") -> str:
    """Why a file could not be read, in one short line; `whole` as for `first_problem`."""
    if isinstance(error, ValidationError):
        return first_problem(error, whole)[:LONGEST_REASON]
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, KeyError):
        return f"it has no {error}"
    return " ".join(str(error).split())[:LONGEST_REASON]
