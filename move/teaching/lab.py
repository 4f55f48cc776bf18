"""What JupyterLab saves of a notebook of this package: its cells, and neither outputs nor traces of a session.

`docs/lab/config.py` makes `without_outputs` the hook before saving, so that reading the notebooks leaves `git status`
clean.
"""

from __future__ import annotations

from typing import Any

import nbformat
from nbstripout import strip_output

FOLDER = "notebooks/"
METADATA = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"}}
OWN = ("tags", "slideshow")  # of a cell's metadata


def without_outputs(model: dict[str, Any], path: str, contents_manager: Any = None, **_: Any) -> None:
    """Strip what Jupyter is about to save at `path`, if that is one of this package's notebooks.

    Args:
        model: as a contents manager has it, with the notebook in `content`; it is changed.
        path: below the folder that JupyterLab shows.
    """
    content = model.get("content") or {}
    if model.get("type") != "notebook" or not path.lstrip("/").startswith(FOLDER) or content.get("nbformat") != 4:
        return
    kept = strip_output(nbformat.from_dict(content), keep_output=False, keep_count=False, keep_id=True)
    for cell in kept.cells:
        cell.metadata = {name: value for name, value in cell.metadata.items() if name in OWN}
    model["content"] = kept | {"metadata": METADATA}
