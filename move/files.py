"""Places to write to: refused before the work if nothing can be written, written to a temporary name, then renamed.

What is being written lies next to its place as .NAME.HOST.PROCESS.part, and what it replaces as .NAME.HOST.PROCESS.old
until the new one is in place. A process that is killed leaves them there; the next one that writes to the same place
deletes them, or moves an old one back where the new one never came.
"""

from __future__ import annotations

import os
import platform
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

from move.errors import BadInput

HOST = re.sub(r"\W", "-", platform.node())[:32]


def refuse_unwritable(path: Path) -> None:
    """Refuse a place where nothing can be written, before any work is done; nothing is left there.

    Folders that are missing above it will be made, so the first one that exists is tried.

    Raises:
        BadInput: no name, a name or a folder that the file system refuses, or no room for another file.
    """
    if path.name in ("", ".."):
        raise BadInput(f"{str(path)!r} given as a place to write; allowed is the path of a new file or folder")
    try:
        above = next(folder for folder in path.absolute().parents if folder.exists())
        probe = above / _aside(path, "part").name
        probe.mkdir()
        probe.rmdir()
    except (OSError, ValueError) as error:
        raise _cannot_write(path, error) from error


def refuse_folder(path: Path) -> None:
    """`refuse_unwritable`, and refuse a place for a file where a folder is.

    Raises:
        BadInput: a folder is there, or nothing can be written there.
    """
    refuse_unwritable(path)
    if path.is_dir():
        raise BadInput(f"{path} is a folder; allowed is the path of a file")


def refuse_existing(path: Path) -> None:
    """`refuse_unwritable`, and refuse a place where anything is.

    Raises:
        BadInput: it is taken, or nothing can be written there.
    """
    refuse_unwritable(path)
    put_away_remains(path)
    if os.path.lexists(path):
        raise BadInput(f"{path} exists; allowed is a new folder or file")


@contextmanager
def written_aside(path: Path) -> Iterator[Path]:
    """A place next to `path`, renamed to `path` once all is written there; of what fails nothing stays.

    A file at `path` is replaced in one step. A folder there is deleted once a new folder is in its place: the caller
    has made sure that it may be. A file takes no folder's place.

    Raises:
        BadInput: it cannot be written, as on a full disk, or it is a file and a folder is there.
    """
    new, old = _aside(path, "part"), _aside(path, "old")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        put_away_remains(path)
        yield new
        if path.is_dir() and new.is_dir():
            os.replace(path, old)
        os.replace(new, path)
    except OSError as error:
        raise _cannot_write(path, error) from error
    finally:
        _remove(new)
        if os.path.lexists(old):
            _settle(old, path)


def put_away_remains(path: Path) -> None:
    """Put away what a killed process of this machine left next to `path`."""
    put_away_all_remains(path.parent, re.escape(path.name))


def put_away_all_remains(folder: Path, names: str = ".+") -> None:
    """Put away what killed processes of this machine left in `folder`, of what they wrote to `names`, an expression."""
    left = re.compile(rf"\.({names})\.{re.escape(HOST)}\.(\d{{1,9}})\.(part|old)")
    for found in list(folder.iterdir()) if folder.is_dir() else []:
        if (match := left.fullmatch(found.name)) and not psutil.pid_exists(int(match[2])):
            _settle(found, folder / match[1])


def _settle(found: Path, path: Path) -> None:
    """Move an old one back where the new one never came; delete everything else."""
    if found.suffix == ".old" and not os.path.lexists(path):
        os.replace(found, path)
    else:
        _remove(found)


def _aside(path: Path, ending: str) -> Path:
    return path.with_name(f".{path.name}.{HOST}.{os.getpid()}.{ending}")


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _cannot_write(path: Path, error: OSError | ValueError) -> BadInput:
    shown = str(path) if len(str(path)) <= 200 else f"{str(path)[:60]}..."
    reason = getattr(error, "strerror", None) or error
    return BadInput(f"cannot write {shown}: {reason}; allowed is a writable place with room")
