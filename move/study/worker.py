"""A process that computes the runs it is sent, one after another: `python -m move.study.worker PARENT NUMBER`.

A line of standard input is a run, its results folder and what decides results where it is asked for; a line of
standard output says what went wrong, or null. It ends with the process PARENT, which it looks after before anything
slow is imported. NUMBER chooses the GPU.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from move.errors import BadInput
from move.machine import end_with


def main(parent: int, number: int) -> None:
    """Compute what standard input asks for, until it ends."""
    end_with(parent)
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what libraries print is no answer
    import torch

    if gpus := torch.cuda.device_count():
        torch.cuda.set_device(number % gpus)
    for line in sys.stdin:
        answers.write(json.dumps(_compute(**json.loads(line))) + "\n")
        answers.flush()


def _compute(spec: str, folder: str, there: dict[str, str]) -> str | None:
    """Compute one run, given as JSON; one line on what went wrong."""
    from move.study.provenance import difference
    from move.study.run import run_and_report
    from move.study.spec import run_spec_from_json

    if differing := difference(there):
        return f"its process has {differing}: the source was changed meanwhile"
    try:
        run_and_report(run_spec_from_json(spec), Path(folder))
    except Exception as error:  # whatever it is, the others go on
        name = "" if isinstance(error, BadInput) else f"{type(error).__name__}: "
        return f"{name}{' '.join(str(error).split())[:200]}"
    return None


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
