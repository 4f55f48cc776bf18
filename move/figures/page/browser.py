"""What a reader in a browser sees while a notebook works: a line at once, and no traceback after an interrupt."""

from __future__ import annotations

from typing import Any

from move.figures.page import changes

INTERRUPTED = "stopped. Finished runs are kept, and running the cell again goes on where it stopped."
_status: dict[str, Any] = {}  # the line of the cell under way, and the cell's number


def show_status(text: str) -> None:
    """Show one line under the cell; the next one of the same cell takes its place. Nothing outside a browser."""
    if changes.by_command():
        return
    from IPython.display import Markdown, display

    cell = getattr(changes.get_ipython(), "execution_count", None)
    if _status.get("cell") == cell and _status.get("line"):
        _status["line"].update(Markdown(text))
    else:
        _status.update(cell=cell, line=display(Markdown(text), display_id=True))


def show_interrupts_as_one_line() -> None:
    """From now on an interrupted cell of this notebook shows one line in place of a traceback."""
    if hasattr(shell := changes.get_ipython(), "set_custom_exc"):
        shell.set_custom_exc((KeyboardInterrupt,), _interrupted)


def _interrupted(shell: Any, kind: Any, error: BaseException, trace: Any, tb_offset: int | None = None) -> list[str]:
    line = f"\x1b[31mKeyboardInterrupt\x1b[0m: {INTERRUPTED}"
    shell._showtraceback(kind, error, [line])
    return [line]
