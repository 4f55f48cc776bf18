"""Write results of the layout before, one list a column and a digest within, in today's: `convert_results.py [FOLDER]`.

By default all of results/. What a file holds stays the same: each is read again before it takes the old one's place.
"""

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

from move import paths
from move.files import written_aside
from move.study.spec import run_spec_from_json
from move.study.stored import DIGEST, from_bytes, to_text

PARTS = ("collection", "training", "seconds", "provenance")


def read_before(path: Path) -> dict[str, Any]:
    """The content of a file of the layout before, without its digest.

    Raises:
        ValueError: it does not fit its digest.
    """
    content = json.loads(path.read_text())
    digest = content.pop("digest")
    if digest != hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest():
        raise ValueError(f"{path}: its content does not fit its digest")
    return content


def convert(path: Path) -> None:
    """Convert one file, unless it is converted already.

    Raises:
        ValueError: it does not fit its digest, or would not hold the same afterwards.
    """
    if DIGEST.match(path.read_bytes()):
        return
    content = read_before(path)
    columns, spec = content["rows"], run_spec_from_json(json.dumps(content["spec"]))
    rows = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    text = to_text(spec, rows, {part: content[part] for part in PARTS})
    again, same_rows, same = from_bytes(text.encode())
    if (again, same_rows, same) != (spec, rows, {part: content[part] for part in PARTS}):
        raise ValueError(f"{path}: would not hold the same")
    if [list(row) for row in same_rows] != [list(row) for row in rows]:
        raise ValueError(f"{path}: its columns would be in another order")
    with written_aside(path) as beside:
        beside.write_text(text)


if __name__ == "__main__":
    for folder in [Path(sys.argv[1])] if len(sys.argv) > 1 else sorted((paths.ROOT / "results").iterdir()):
        for found in sorted(folder.glob("*.json")):
            convert(found)
