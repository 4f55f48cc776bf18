"""List figures and tables, what each asks and about how long it takes (run by `make help`; standard library only).

The seconds are of one processor, from stored results; `.venv/bin/python tools/figures.py measure` measures them anew by
drawing every figure of the laptop profile, and writes notebooks/seconds.json.
"""

import json
import re
import resource
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SECONDS = ROOT / "notebooks" / "seconds.json"
NUMBER = re.compile(r"(fig|table)\d+(?=_)")
WIDTH = 72


def title(notebook: Path) -> str:
    """The notebook's heading, cut to one line."""
    heading = "".join(json.loads(notebook.read_text(encoding="utf-8"))["cells"][0]["source"]).split("\n")[0]
    words = heading.removeprefix("#").strip()
    return words if len(words) <= WIDTH else words[: WIDTH - 3].rsplit(" ", 1)[0] + "..."


def about(seconds: float | None) -> str:
    """A rough time in words."""
    if seconds is None:
        return ""
    return f"{round(seconds, -1):.0f} s" if seconds < 95 else f"{seconds / 60:.0f} min"


def measure() -> None:
    """Draw every figure, and write the processor seconds that each took with all its processes."""
    taken = {}
    for path in sorted(SECONDS.parent.glob("*.ipynb")):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, "-m", "move.cli", "figure", path.stem, "--stored-only"]
        failed = subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL).returncode
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if not failed:
            taken[path.stem] = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            SECONDS.write_text(json.dumps(taken, indent=1) + "\n")


def main() -> None:
    """Print one line a figure."""
    seconds = json.loads(SECONDS.read_text()) if SECONDS.exists() else {}
    for path in sorted(SECONDS.parent.glob("*.ipynb")):
        short = match[0] if (match := NUMBER.match(path.stem)) else path.stem
        print(f"  {short:<22} {about(seconds.get(path.stem)):>6}  {title(path)}")


if __name__ == "__main__":
    measure() if sys.argv[1:] == ["measure"] else main()
