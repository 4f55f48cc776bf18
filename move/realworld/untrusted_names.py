"""Names that come from a data set are not trusted: they stay inside its folder, and reading errors get one line."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any

from move.errors import BadInput

_FIELD = re.compile(r"\{(\w+)(?::0?(\d{1,2})d)?\}")
_FIELDS = {"episode_chunk", "episode_index", "video_key", "chunk_index", "file_index"}


def safe_name(name: str, where: str) -> str:
    """Return a relative file name unchanged, or refuse it.

    Args:
        name: a file name read from a listing or from inside a data set, with forward slashes.
        where: the data set or file that holds the name, for the message.

    Raises:
        BadInput: the name is empty, absolute, holds a backslash, a drive letter, a NUL or a `..` step.
    """
    steps = PurePosixPath(name).parts
    bad = not name or "\\" in name or "\0" in name or name.startswith("/") or ".." in steps
    if bad or re.match(r"^[A-Za-z]:", name):
        raise BadInput(f"file name {name!r} in {where} leaves the data set's folder; only names inside it are read")
    return name


def inside(root: Path, name: str) -> Path:
    """Return `root / name` for a name that stays inside `root`.

    Raises:
        BadInput: the name would leave `root`.
    """
    return root / safe_name(str(name), str(root))


def fill_template(template: str, values: Mapping[str, int | str], where: str) -> str:
    """Fill a LeRobot path template such as `data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet`.

    Only the five field names of LeRobot are known, with an optional zero-padded width, so a template can
    neither reach an attribute nor ask for a huge field.

    Raises:
        BadInput: an unknown field, or a result that leaves the folder.
    """
    def fill(match: re.Match) -> str:
        field, width = match.group(1), match.group(2)
        if field not in _FIELDS or field not in values:
            raise BadInput(f"path template {template!r} in {where} uses {field!r}; allowed: {sorted(_FIELDS)}")
        return f"{values[field]:0{int(width)}d}" if width else str(values[field])

    filled = _FIELD.sub(fill, template)
    if "{" in filled or "}" in filled:
        raise BadInput(
            f"path template {template!r} in {where} has a field of an unknown form; allowed: {{name}} or {{name:03d}}")
    return safe_name(filled, where)


@contextmanager
def reading(path: Path | str, expected: str) -> Iterator[None]:
    """Turn whatever a file library raises into one line that names the file and what was expected of it.

    Args:
        path: the file that is read inside the `with` block.
        expected: what the file should be, e.g. "a parquet table of a LeRobot v2.1 episode".

    Raises:
        BadInput: anything went wrong inside the block.
    """
    try:
        yield
    except BadInput:
        raise
    except Exception as error:  # file libraries raise dozens of types; all mean "this file is not what it should be"
        cause = " ".join(str(error).split())[:160] or "no message"
        if _is_pointer(Path(path)):
            cause = "it is a Git LFS pointer, not the file itself: run `git lfs pull`"
        raise BadInput(f"cannot read {path}: expected {expected}; {type(error).__name__}: {cause}") from error


def _is_pointer(path: Path) -> bool:
    """Whether a file is what Git leaves where a large file was not pulled."""
    try:
        with path.open("rb") as file:
            return file.read(23) == b"version https://git-lfs"
    except OSError:
        return False


def read_json(path: Path, expected: str) -> dict[str, Any]:
    """Read a JSON object.

    Raises:
        BadInput: missing, not JSON, or not an object.
    """
    with reading(path, expected):
        content = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(content, dict):
            raise BadInput(f"cannot read {path}: expected {expected}; found a JSON {type(content).__name__}")
        return content
