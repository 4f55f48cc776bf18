"""Names that come from a data set are not trusted: they stay inside its folder, and are shown as what they are."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from move.errors import BadInput

_TEMPLATE = re.compile(r"(?:[^{}]|\{[a-z_]+(?::0?\d{1,2}d)?\})*")
_LONGEST = 1_000  # characters of a name
_MARKUP = "<>&\"'`"
# printable, says Unicode, and yet not seen
_UNSEEN = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]")


def plain_text(text: str, where: object) -> str:
    """Return a text that a data set gives and a reader will see, or refuse it.

    Args:
        where: the data set or file that holds the text, for the message.

    Raises:
        BadInput: very long, or it holds markup, a control character, or one that is not seen or turns the text round.
    """
    if len(text) > _LONGEST:
        raise BadInput(f"name {text[:40]!r}... in {where} has {len(text)} characters; allowed are {_LONGEST}")
    odd = next((letter for letter in text if letter in _MARKUP or not letter.isprintable() or _UNSEEN.match(letter)),
               None)
    if odd is not None:
        raise BadInput(f"name {ascii(text)[:80]} in {where} holds {ascii(odd)}; allowed: no markup ({_MARKUP}) and no "
                       "control characters")
    return text


def safe_name(name: str, where: str) -> str:
    """Return a relative file name unchanged, or refuse it.

    Args:
        name: a file name read from a listing or from inside a data set, with forward slashes.
        where: the data set or file that holds the name, for the message.

    Raises:
        BadInput: the name is empty, absolute, holds a backslash, a drive letter or a `..` step, or is no `plain_text`.
    """
    steps = PurePosixPath(plain_text(name, where)).parts
    bad = not name or "\\" in name or name.startswith("/") or ".." in steps
    if bad or re.match(r"^[A-Za-z]:", name):
        raise BadInput(f"file name {name!r} in {where} leaves the data set's folder; only names inside it are read")
    return name


def is_hidden(name: str) -> bool:
    """Whether a file lies in a folder whose name begins with a dot: such folders are no part of a data set.

    >>> is_hidden(".git/config"), is_hidden("data/action/.zarray")
    (True, False)
    """
    return any(step.startswith(".") for step in PurePosixPath(name).parts[:-1])


def inside(root: Path, name: str) -> Path:
    """Return `root / name` for a name that stays inside `root`.

    Raises:
        BadInput: the name would leave `root`, or leads through a hidden folder.
    """
    path = root / safe_name(name, str(root))
    if is_hidden(name):
        raise BadInput(f"file name {name[:80]!r} in {root} leads through a hidden folder, no part of a data set")
    return path


def fill_template(template: str, values: Mapping[str, int | str], where: str) -> str:
    """Fill a LeRobot path template such as `data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet`.

    A field is a name of `values`, with an optional width of zero-padded digits, so a template can neither reach an
    attribute nor ask for a huge field.

    Raises:
        BadInput: another field, or a result that leaves the folder.
    """
    if not _TEMPLATE.fullmatch(template):
        raise BadInput(f"path template {template[:80]!r} in {where} has a field of an unknown form; allowed: {{name}} "
                       "or {name:03d}")
    try:
        filled = template.format(**values)
    except (KeyError, ValueError) as error:
        raise BadInput(f"path template {template[:80]!r} in {where} uses {error}; allowed: numbers of "
                       f"{sorted(values)}") from error
    return safe_name(filled, where)
