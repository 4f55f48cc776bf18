"""Data that came from elsewhere: only plain files are read, and reading them takes bounded memory.

`plain_files` looks at a whole folder before anything in it is opened, so the readers need not know about links and
pipes. `reading` gives the libraries that parse files a limited address space, so that what a file announces, or
decompresses to, ends in a refusal, however it is hidden. `within` holds counts against `Limits`, which bounds time.
"""

from __future__ import annotations

import json
import os
import resource
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from move.errors import BadInput
from move.validation import validated

VARIABLE = "MOVE_LIMITS"
_KINDS = {stat.S_IFLNK: "a symbolic link", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket",
          stat.S_IFCHR: "a device", stat.S_IFBLK: "a device"}

Limit = Annotated[float, Field(ge=1, allow_inf_nan=False)]


class Limits(BaseModel):
    """How much of a data set is read; the environment variable raises it: `MOVE_LIMITS=rows=5e6,files=1e6`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    files: Limit = 200_000  # files and folders of a data set, names in a listing, chunks of an array
    parts: Limit = 200  # sub data sets
    episodes: Limit = 100_000  # of one part
    rows: Limit = 2_000_000  # timesteps of one table, array or video
    columns: Limit = 4_096  # numbers a timestep
    text_bytes: Limit = 16_000_000  # one file of JSON or text
    memory_bytes: Limit = 2_000_000_000  # address space that reading a data set may add to the process


def limits() -> Limits:
    """The limits in force.

    Raises:
        BadInput: the environment variable names no limit, or no number above 0.
    """
    pairs = [pair.partition("=") for pair in os.environ.get(VARIABLE, "").split(",") if pair]
    given = {name.strip(): number for name, _, number in pairs}
    return validated(Limits, given, VARIABLE, f"; allowed: {', '.join(Limits.model_fields)}, such as rows=5e6")


def within(limit: str, amount: int, where: object) -> None:
    """Refuse an amount above a limit.

    Args:
        limit: a field of `Limits`.
        where: the file or part of it that declares the amount, for the message.

    Raises:
        BadInput: the amount is above the limit.
    """
    allowed = getattr(limits(), limit)
    if amount > allowed:
        given = f"{amount:,}" if amount < 10**18 else "1e18 or more"
        raise BadInput(f"{where}: {given} {limit.replace('_', ' ')}; allowed are {allowed:,.0f}; "
                       f"{VARIABLE}={limit}=... allows more")


@contextmanager
def bounded_memory(where: object) -> Iterator[None]:
    """Let the process take at most `memory_bytes` more address space than it has now; on Linux, which counts it.

    Raises:
        BadInput: what was done needs more.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    allowed = _address_space_bytes() + int(limits().memory_bytes)
    unbounded = sys.platform == "linux" and (soft == resource.RLIM_INFINITY or soft > allowed)
    try:
        if unbounded:  # else it is bounded already, by the caller or by the process that started this one
            resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))
        yield
    except MemoryError as error:
        raise BadInput(f"{where}: more than {limits().memory_bytes:,.0f} bytes of memory needed; "
                       f"{VARIABLE}=memory_bytes=... allows more") from error
    finally:
        if unbounded:
            resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _address_space_bytes() -> int:
    """How much the process has now; 0 where the system does not say it."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


@contextmanager
def reading(path: Path | str, expected: str) -> Iterator[None]:
    """Read a file within `bounded_memory`; whatever a library raises becomes one line that names the file.

    Args:
        path: the file that is read inside the `with` block.
        expected: what the file should be, e.g. "a parquet table of a LeRobot v2.1 episode".

    Raises:
        BadInput: anything went wrong inside the block.
    """
    try:
        with bounded_memory(path):
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


def plain_files(folder: Path) -> list[str]:
    """Names (relative, with forward slashes, sorted) of all files under a folder.

    Folders whose name begins with a dot are left out, and nothing in them is read. The folder itself may be given by a
    symbolic link. Only names are looked at: nothing is opened.

    Raises:
        BadInput: something under it is neither a file nor a folder, or there is too much of it.
    """
    found: list[str] = []
    seen, most, waiting = 0, limits().files, [""]
    while waiting:
        inner = waiting.pop()
        with reading(folder / inner, "a folder"), os.scandir(folder / inner) as entries:
            for entry in entries:
                seen += 1
                if seen > most:
                    within("files", seen, folder)
                kind, name = entry.stat(follow_symlinks=False).st_mode, inner + entry.name
                if stat.S_ISREG(kind):
                    found.append(name)
                elif not stat.S_ISDIR(kind):
                    raise BadInput(f"{folder}/{name} is {_KINDS.get(stat.S_IFMT(kind), 'no plain file')}; inside a "
                                   "data set only plain files and folders are read (`cp -rL` makes them of links)")
                elif not entry.name.startswith("."):
                    waiting.append(f"{name}/")
    return sorted(found)


def read_text(path: Path) -> str:
    """A text file that is not too long."""
    within("text_bytes", path.stat().st_size, path)
    return path.read_text(encoding="utf-8")


def parse_json(text: str, where: object) -> dict[str, Any]:
    """Parse a JSON object, each of its keys once.

    Raises:
        BadInput: something else.
    """
    with reading(str(where), "JSON"):
        content = json.loads(text, object_pairs_hook=_each_key_once)
        if not isinstance(content, dict):
            raise BadInput(f"cannot read {where}: expected a JSON object; found a JSON {type(content).__name__}")
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
        BadInput: missing, not JSON, not an object, or too long.
    """
    with reading(path, expected):
        return parse_json(read_text(path), path)
