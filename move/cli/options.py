"""The program, and the options that several commands have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Optional

import typer

from move import figures
from move.sim.methods import METHODS
from move.sim.tasks import TASKS

if TYPE_CHECKING:
    TaskName = str
    MethodName = str
else:
    TaskName = Literal[tuple(TASKS)]
    MethodName = Literal[tuple(METHODS)]

app = typer.Typer(no_args_is_help=True, rich_markup_mode="rich", pretty_exceptions_enable=False,
                  help="MOVE, reproduced: collect demonstrations, train policies, evaluate them, rebuild the paper.")

LARGEST_SEED = 2**32 - 1


def _profiles() -> list[str]:
    from move.study.profiles import names

    return names()


Json = Annotated[bool, typer.Option("--json", help="print JSON for machines instead of a table for people")]
Seed = Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="decides every random number")]
ClipActions = Annotated[bool, typer.Option("--clip-actions", help="clip actions to -1..1 as Meta-World does")]
ProfileName = Annotated[str, typer.Option(help="a settings file under profiles/", autocompletion=_profiles)]
Figures = Annotated[Optional[list[str]], typer.Argument(
    metavar="[FIGURE]...", help="figures or tables, as fig1 or fig1_sparse (default: all of the profile)",
    autocompletion=lambda: [*figures.short_names(), *figures.names()])]
Parameters = Annotated[Optional[list[str]], typer.Option(
    "-p", metavar="NAME=VALUE", help="a parameter of the figure instead of the profile's; may be repeated")]


def examples(*lines: str) -> str:
    """The end of a command's help."""
    return "\n\n".join(["Examples:", *lines])
