"""What several test files use: a command in this process, a refusal in one line, a collection, a full disk."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

import pytest

from move import cli
from move.errors import BadInput
from move.machine import gl_problem
from move.sim.collection import Collection
from move.validation import build

needs_gl = pytest.mark.skipif(gl_problem() is not None, reason=f"images cannot be drawn here: {gl_problem()}")


def move(capsys: pytest.CaptureFixture, *arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of one command, in this process."""
    with pytest.raises(SystemExit) as end, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["move", *arguments])
        cli.main()
    out, err = capsys.readouterr()
    return end.value.code, out, err


@contextmanager
def refused(message: str, error: type[Exception] = BadInput) -> Iterator[None]:
    """What is inside is refused in one line, in which `message` is found."""
    with pytest.raises(error, match=message) as caught:
        yield
    assert "\n" not in str(caught.value)


def plan(**changes: Any) -> Collection:
    """400 timesteps of Pick-Place by MOVE, or what is changed of that."""
    return build(Collection, **{"task": "pick-place", "method": "move", "timesteps": 400, **changes})


def full_disk(*_: object, **__: object) -> NoReturn:
    """Stands in for what writes."""
    raise OSError(28, "No space left on device")
