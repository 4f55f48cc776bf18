"""The lecturer's command: mark."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from move import paths
from move.cli.options import Json, app, examples
from move.cli.output import progress, show


@app.command(epilog=examples("move mark handed_in", "move mark handed_in --minutes 3 --json"))
def mark(
    folder: Annotated[str, typer.Argument(help="tutorial notebooks that students handed in, in any subfolders")],
    minutes: Annotated[float, typer.Option(min=0.1, max=600, help="of computing that one notebook may take")] = 10,
    as_json: Json = False,
) -> None:
    """Run handed-in tutorials (their code, each in a process of its own) and show what their checks say."""
    paths.refuse_outside_checkout()
    from move.teaching import marking

    with progress("mark") as report:
        rows = marking.mark(Path(folder), minutes, report)
    if as_json:
        return show(rows, True, "")
    show([{"notebook": row["notebook"], "right": f"{row['right']} of {row['of']}",
           "exercises": ", ".join(f"{number} {_mark(text)}" for number, text in row["exercises"].items()),
           "remark": row["remark"]} for row in rows], False, "Marks: what the checks say (--json: with their hints)")


def _mark(text: str) -> str:
    """A verdict in a word or two."""
    if text in ("", "not reached"):
        return text or "right"
    return "no answer" if "no answer yet" in text or "nothing yet" in text else "wrong"
