"""The command line: `move`, whose commands are in the files below.

Bad input ends with one line on standard error and exit code 2; a run that failed ends with exit code 1. What is slow to
import is imported by the command that needs it, once names are checked.

by_hand.py      collect, placements, export, train, evaluate, compare
study.py        run, plan, verify, figure, doctor
coverage.py     coverage
teaching.py     mark
options.py      the program, and options that several commands have
output.py       tables, JSON, bars, paths
"""

from __future__ import annotations

import gc
import io
import os
import sys
import warnings

import typer
from pydantic import ValidationError

from move import paths
from move.cli import by_hand, coverage, study, teaching
from move.cli.options import app
from move.errors import BadInput
from move.validation import first_problem

__all__ = ["app", "by_hand", "coverage", "main", "study", "teaching"]

INTERRUPTED = 130  # exit code after Ctrl-C
COLLECTED_AT = (100_000, 20, 50)  # objects: stored results are a million small ones, none in a cycle


def main() -> None:
    """Run the command line; turn every kind of bad input into one line and exit code 2."""
    gc.set_threshold(*COLLECTED_AT)
    _open_standard_streams()
    if not sys.warnoptions:
        warnings.filterwarnings("ignore", category=UserWarning, module="gymnasium|metaworld")
    if paths.VARIABLE in os.environ:
        typer.echo(f"move: {paths.VARIABLE}: profiles, results and figures are those in {paths.ROOT}", err=True)
    code = _outcome()
    if code == INTERRUPTED:  # which is also what typer makes of Ctrl-C
        typer.echo("move: interrupted; the same command goes on from here", err=True)
    sys.exit(code)


def _open_standard_streams() -> None:
    """Let what is written to a stream that was closed go nowhere, and what its encoding lacks be written as escapes."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _outcome() -> int:
    """The exit code of the command that was asked for."""
    try:
        code = app(args=sys.argv[1:] or ["--help"], prog_name="move", standalone_mode=False)
        sys.stdout.flush()
    except BadInput as problem:
        return _refuse(str(problem), 2)
    except typer.TyperException as problem:
        return _refuse(_in_words(problem), 2)
    except (typer.Abort, KeyboardInterrupt):
        return INTERRUPTED
    except BrokenPipeError:  # the reader of the output has gone, as `head` does
        _drop_output()
        return 1
    except OSError as error:
        _drop_output()
        return _refuse(f"{error.filename or 'output'}: {error.strerror or error}", 2)
    except (FloatingPointError, MemoryError) as error:
        return _refuse(f"failed: {str(error) or 'not enough memory'}", 1)
    return code if isinstance(code, int) else 0


def _in_words(problem: typer.TyperException) -> str:
    """What is wrong with an argument or an option, with what was given, which typer does not say of numbers."""
    if isinstance(problem, typer.BadParameter) and problem.param and isinstance(problem.__cause__, ValidationError):
        return first_problem(problem.__cause__, "/".join(problem.param.opts))
    return problem.format_message().replace("Value error, ", "")


def _refuse(line: str, code: int) -> int:
    typer.echo(f"move: {' '.join(line.split())}", err=True)
    return code


def _drop_output() -> None:
    """Let what is still to be written go nowhere, so that Python does not try again at its end."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError):  # an output that is no file, as in tests
        sys.stdout = open(os.devnull, "w")
