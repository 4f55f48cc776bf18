"""What came from elsewhere is not trusted: only plain files inside its folder are read, and only so much of each.

`plain_files` looks at a whole folder before anything in it is opened, so the readers need not know about links and
pipes. `within` holds every number that a file declares against `Limits`, before what it announces is read.
"""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from move.errors import BadInput

VARIABLE = "MOVE_LIMITS"
_KINDS = {stat.S_IFLNK: "a symbolic link", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket",
          stat.S_IFCHR: "a device", stat.S_IFBLK: "a device"}


@dataclass(frozen=True)
class Limits:
    """How much of a data set is read; the environment variable raises them: `MOVE_LIMITS=rows=5e6,pixels=1e8`."""

    files: int = 200_000  # files and folders of a data set, names in a listing or an archive
    depth: int = 40  # folders inside folders, groups inside groups, JSON values inside values
    parts: int = 200  # sub data sets
    episodes: int = 100_000  # of one part
    rows: int = 2_000_000  # timesteps of one table, array or video
    columns: int = 4_096  # numbers a timestep
    chunks: int = 100_000  # of one array
    chunk_bytes: int = 64_000_000  # one chunk of an array, decoded
    json_bytes: int = 16_000_000  # one file of JSON or text, or a table's own description
    image_bytes: int = 64_000_000  # one encoded image
    pixels: int = 16_000_000  # one image or frame of a video
    memory_bytes: int = 1_000_000_000  # everything held of a data set, and every table, array or stack of frames in it


def limits() -> Limits:
    """The limits in force.

    Raises:
        BadInput: the environment variable names no limit, or no number above 0.
    """
    given = {}
    for pair in filter(None, os.environ.get(VARIABLE, "").split(",")):
        name, _, number = pair.partition("=")
        try:
            given[name.strip()] = int(float(number))
        except (ValueError, OverflowError):
            raise BadInput(f"{VARIABLE}: {pair!r} given; allowed is name=number, such as rows=5e6") from None
    names = [field.name for field in fields(Limits)]
    if wrong := [name for name, number in given.items() if name not in names or number < 1]:
        raise BadInput(f"{VARIABLE}: {wrong[0]!r} given; allowed are numbers from 1 on for {', '.join(names)}")
    return replace(Limits(), **given)


def within(limit: str, amount: int, where: object) -> int:
    """Return an amount that is not above a limit.

    Args:
        limit: a field of `Limits`.
        where: the file or part of it that declares the amount, for the message.

    Raises:
        BadInput: the amount is above the limit.
    """
    allowed = getattr(limits(), limit)
    if amount > allowed:
        shown = min(amount, 10**18)
        given = f"{shown:,} {limit.replace('_', ' ')}" + (" or more" if shown < amount else "")
        raise BadInput(f"{where}: {given}; allowed are {allowed:,} ({VARIABLE}={limit}={shown} raises it)")
    return amount


def plain_files(folder: Path) -> dict[str, int]:
    """Names (relative, with forward slashes, sorted) and sizes in bytes of all files under a folder.

    Folders whose name begins with a dot are left out, and nothing in them is read. The folder itself may be given by a
    symbolic link. Only names are looked at: nothing is opened.

    Raises:
        BadInput: something under it is neither a file nor a folder, or there is too much of it.
    """
    found: dict[str, int] = {}
    seen, waiting = 0, [("", 0)]
    while waiting:
        inner, depth = waiting.pop()
        within("depth", depth, f"{folder}/{inner}: folders inside folders")
        with os.scandir(folder / inner) as entries:
            for entry in entries:
                seen = within("files", seen + 1, folder)
                about, name = entry.stat(follow_symlinks=False), inner + entry.name
                if stat.S_ISREG(about.st_mode):
                    found[name] = about.st_size
                elif not stat.S_ISDIR(about.st_mode):
                    kind = _KINDS.get(stat.S_IFMT(about.st_mode), "no plain file")
                    raise BadInput(f"{folder}/{name} is {kind}; inside a data set only plain files and folders are "
                                   "read (`cp -rL` makes them of links)")
                elif not entry.name.startswith("."):
                    waiting.append((f"{name}/", depth + 1))
    return dict(sorted(found.items()))


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


def read_text(path: Path) -> str:
    """A text file that is not too long."""
    within("json_bytes", path.stat().st_size, path)
    return path.read_text(encoding="utf-8")


def parse_json(text: str | bytes, where: object) -> dict[str, Any]:
    """Parse a JSON object that is not nested too deep, each of its keys once.

    Raises:
        BadInput: something else.
    """
    with reading(str(where), "JSON"):
        content = json.loads(text, object_pairs_hook=_each_key_once)
        if not isinstance(content, dict):
            raise BadInput(f"cannot read {where}: expected a JSON object; found a JSON {type(content).__name__}")
        level: list[Any] = [content]
        depth = 0
        while level:
            depth = within("depth", depth + 1, f"{where}: JSON values inside values")
            level = [inner for value in level for inner in (value.values() if isinstance(value, dict) else value)
                     if isinstance(inner, dict | list)]
        return content


def _each_key_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object of its keys and values, of which Python alone would keep the last of equal keys."""
    content: dict[str, Any] = {}
    for key, value in pairs:
        if key in content:
            raise ValueError(f"the key {key[:60]!r} is given twice")
        content[key] = value
    return content


def read_json(path: Path, expected: str) -> dict[str, Any]:
    """Read a JSON object.

    Raises:
        BadInput: missing, not JSON, not an object, too long or too deep.
    """
    with reading(path, expected):
        return parse_json(read_text(path), path)
