"""The real-robot notebook runs through `move figure` from nothing, without a network, and is kept clean."""

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import real_writers as w

from move import paths

NAME = "table3_real_robot"
PARAMETERS = ("profile", "data", "revision", "episodes", "size_cap_gb", "units_file", "sheet")


def figure(root: Path, profile: str) -> Path:
    """Run `move figure` in a root of its own; returns the folder of its figures."""
    for name in ("profiles", "notebooks"):
        (root / name).symlink_to(getattr(paths, name.upper()))
    command = [sys.executable, "-m", "move.cli", "figure", NAME, "--profile", profile]
    environment = os.environ | {"MOVE_ROOT": str(root), "PYTHONPATH": str(paths.ROOT), "HF_HUB_OFFLINE": "1",
                                "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]
    return root / f"build/figures/{profile}"


def test_it_is_clean_and_its_cells_are_short():
    notebook = nbformat.read(paths.NOTEBOOKS / f"{NAME}.ipynb", as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    tagged = [cell for cell in code if "parameters" in cell.metadata.get("tags", [])]
    assert len(tagged) == 1 and [line.split(" = ")[0] for line in tagged[0].source.splitlines()] == list(PARAMETERS)
    assert all(len(cell.source.splitlines()) <= 12 and "def " not in cell.source for cell in code)


def test_it_makes_its_figures_and_tables_from_nothing(tmp_path):
    made = {path.name for path in figure(tmp_path, "smoke").iterdir()}
    pictures = ("table3_real", "fig8_real_setup", "fig8_object_places")
    assert made == {f"{name}.{kind}" for name in pictures for kind in ("pdf", "png", "caption.md")} | {
        f"{name}.{kind}" for name in ("table3_real", "table3_real_checks") for kind in ("csv", "tex")}
    assert not (tmp_path / "paper_figures").exists()


def test_it_runs_on_data_without_poses_or_cameras_and_with_a_sheet(tmp_path, monkeypatch):
    """In this process, cell by cell: starting another kernel would tell nothing new."""
    monkeypatch.setattr(paths, "figures", lambda profile: tmp_path / profile.name)
    w.lerobot_v2(tmp_path / "bare")
    lines = "".join(f"{n},{method},0.3,0.0,{n % 4}\n" for n in range(1, 6) for method in ("static", "MOVE"))
    (tmp_path / "sheet.csv").write_text("trial,method,position_x_m,position_y_m,score\n" + lines)
    changes = f"data, sheet = {str(tmp_path / 'bare')!r}, {str(tmp_path / 'sheet.csv')!r}"
    cells = [cell for cell in nbformat.read(paths.NOTEBOOKS / f"{NAME}.ipynb", 4).cells if cell.cell_type == "code"]
    space: dict = {}
    for source in (cells[0].source, changes, *(cell.source for cell in cells[1:])):
        exec(source, space)
    assert (tmp_path / "laptop/fig8_real_setup.png").stat().st_size > 5000
    assert space["scores"].trials.tolist() == [5, 5]
