"""The real-robot notebook runs from nothing, without a network, and is kept clean."""

from pathlib import Path

import cells
import nbformat
import real_writers as w

from move import paths

NAME = "table3_real_robot"
PARAMETERS = ("profile", "data", "revision", "episodes", "size_cap_gb", "units_file", "sheet")


def run(tmp_path: Path, monkeypatch, **changes: object) -> dict:
    """Its cells with other parameters, one after the other in this process; what they made is below `tmp_path`."""
    monkeypatch.setattr(paths, "figures", lambda profile: tmp_path / profile.name)
    monkeypatch.setattr(paths, "REALWORLD", tmp_path / "realworld")
    space = cells.execute(NAME, **changes)
    assert set(PARAMETERS) <= set(space)
    return space


def test_it_is_clean_and_its_cells_are_short():
    notebook = nbformat.read(paths.NOTEBOOKS / f"{NAME}.ipynb", as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    tagged = [cell for cell in code if "parameters" in cell.metadata.get("tags", [])]
    assert len(tagged) == 1 and [line.split(" = ")[0] for line in tagged[0].source.splitlines()] == list(PARAMETERS)
    assert all(len(cell.source.splitlines()) <= 12 and "def " not in cell.source for cell in code)


def test_it_makes_its_figures_and_tables_from_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    run(tmp_path, monkeypatch, profile="smoke", episodes=5)
    pictures = ("table3_real", "fig8_real_setup", "fig8_object_places")
    assert {path.name for path in (tmp_path / "smoke").iterdir()} == {
        f"{name}.{kind}" for name in pictures for kind in ("pdf", "png", "caption.md")} | {
        f"{name}.{kind}" for name in ("table3_real", "table3_real_checks") for kind in ("csv", "tex")}
    assert {path.name for path in tmp_path.iterdir()} == {"smoke", "realworld"}


def test_it_runs_on_data_without_poses_or_cameras_and_with_a_sheet(tmp_path, monkeypatch):
    w.lerobot_v2(tmp_path / "bare")
    lines = "".join(f"{n},{method},0.3,0.0,{n % 4}\n" for n in range(1, 6) for method in ("static", "MOVE"))
    (tmp_path / "sheet.csv").write_text("trial,method,position_x_m,position_y_m,score\n" + lines)
    space = run(tmp_path, monkeypatch, data=str(tmp_path / "bare"), sheet=str(tmp_path / "sheet.csv"))
    assert (tmp_path / "laptop/fig8_real_setup.png").stat().st_size > 5000
    assert space["scores"].trials.tolist() == [5, 5]
