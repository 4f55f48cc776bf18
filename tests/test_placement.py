"""Places of demonstrations: how rules spread them, that demonstrations grasp there, and the sheet for a real table."""

import csv
import json
import math

import numpy as np
import pytest
from shared import move

from move.sim.collect import Collection, collect
from move.sim.configuration import Box
from move.sim.motion import equations
from move.sim.placement import Placement, places, sheet
from move.sim.tasks import get_task

BOX = Box((-0.1, 0.5, 0.02), (0.3, 0.8, 0.3))
RULES = ("random", "jittered", "halton")


def unit(rule: str, count: int, seed: int = 0) -> np.ndarray:
    listed = np.array(places(Placement(rule=rule, places=count), BOX, seed))
    assert (listed[:, 2] == 0.02).all()
    return (listed[:, :2] - (-0.1, 0.5)) / (0.4, 0.3)


def farthest_from_all(points: np.ndarray) -> float:
    """The largest distance of a place of the square to the nearest of `points`."""
    ticks = (np.arange(60) + 0.5) / 60
    square = np.stack(np.meshgrid(ticks, ticks), -1).reshape(-1, 1, 2)
    return float(np.hypot(*(square - points).transpose(2, 0, 1)).min(axis=1).max())


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("count", [1, 2, 5, 50])
def test_places_are_inside_distinct_and_decided_by_the_seed(rule, count):
    first = unit(rule, count)
    assert ((first >= 0) & (first <= 1)).all() and len(np.unique(first, axis=0)) == count
    assert np.array_equal(first, unit(rule, count)) and not np.array_equal(first, unit(rule, count, seed=1))


@pytest.mark.parametrize("count", [4, 5, 10, 50, 97])
def test_a_jittered_grid_has_one_place_in_each_of_its_cells_of_one_area(count):
    points = unit("jittered", count)
    columns = np.array([len(part) for part in np.array_split(np.arange(count), round(math.sqrt(count)))])
    edges = np.concatenate([[0], np.cumsum(columns)]) / count
    column = np.searchsorted(edges, points[:, 0], side="right") - 1
    cells = {(one, int(y * columns[one])) for one, y in zip(column, points[:, 1], strict=True)}
    assert cells == {(one, cell) for one, many in enumerate(columns) for cell in range(many)}
    assert np.allclose(np.diff(edges) / columns, 1 / count)


def test_spread_places_leave_smaller_holes_than_random_ones():
    holes = {rule: np.mean([farthest_from_all(unit(rule, 50, seed)) for seed in range(20)]) for rule in RULES}
    assert holes["jittered"] < 0.85 * holes["random"] and holes["halton"] < 0.85 * holes["random"]


@pytest.mark.parametrize("method", ["static", "move"])
def test_demonstrations_grasp_at_their_places_in_order_and_begin_again(method):
    placement, task = Placement(places=3), get_task("pick-place")
    made, record = collect(Collection(
        task="pick-place", method=method, timesteps=2000, factors="object", protocol="placed", placement=placement,
        demonstrations=5, hand_spread=0.03), seed=4)
    listed = places(placement, task.object_range, 4)
    wanted = [listed[number % 3][:2] for number in range(5)]
    assert np.allclose(record.grasp_points, wanted, atol=0.002)
    assert record.demonstrations == 5 == made.episodes and record.timesteps == made.timesteps == made.episode_ends[-1]
    assert made.timesteps == round(5 * record.mean_steps) < 2000
    starts = np.array([start.object_position[:2] for start in record.starts])
    assert np.allclose(starts, wanted) == (method == "static"), "under MOVE the object comes from elsewhere"


def test_the_budget_ends_a_collection_before_its_demonstrations_do():
    made, record = collect(Collection(task="pick-place", method="static", timesteps=100, demonstrations=50), seed=0)
    assert made.timesteps == 100 == record.timesteps and record.demonstrations < 50


def test_a_sheet_says_where_from_and_how_the_object_comes_to_its_place():
    box = Box((0, 0, 0), (40, 30, 0))
    listed = places(Placement(places=7), box, 2)
    rows = sheet(Placement(places=7), box, 2, demonstrations=20, speed=8.0, seconds=4.0)
    assert [row["demonstration"] for row in rows] == list(range(1, 21))
    for number, row in enumerate(rows):
        angle, place = math.radians(row["direction"]), listed[number % 7]
        there = equations.translate((row["start_x"], row["start_y"], 0.0), (
            row["speed"] * math.cos(angle), row["speed"] * math.sin(angle), 0.0), 4.0, box)
        assert math.dist(there[:2], place[:2]) < 0.06 and row["seconds"] == 4.0, "a tenth of a degree"
        assert math.dist((row["x"], row["y"]), place[:2]) < 0.01 and 0 < row["speed"] <= 8
    assert set(sheet(Placement(places=7), box, 2, 1)[0]) == {"demonstration", "x", "y"}


def test_the_sheet_is_written_as_csv_and_bad_corners_are_refused(tmp_path, capsys):
    out, asked = tmp_path / "sheet.csv", ("placements", "--places", "5", "--demonstrations", "9")
    assert move(capsys, *asked, "--out", str(out))[0] == 0
    for corners in ("3,3,1,4", "a"):
        code, _, err = move(capsys, *asked, "--within", corners)
        assert code == 2 and "allowed are the low and the high corner in cm" in err
    rows = list(csv.DictReader(out.open()))
    assert len(rows) == 9 and rows[0]["x (cm)"] == rows[5]["x (cm)"] and list(rows[0])[1:] == ["x (cm)", "y (cm)"]


def test_a_sheet_has_each_place_once_and_replaces_nothing(tmp_path, capsys):
    code, out, _ = move(capsys, "placements", "--places", "80", "--speed", "3", "--json")
    assert code == 0 and len(json.loads(out)) == 80 and {row["seconds"] for row in json.loads(out)} == {3.0}
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "thesis.tex").write_text("mine")
    (tmp_path / "sheet.csv").write_text("with notes by hand")
    for name in ("folder", "sheet.csv"):
        code, _, err = move(capsys, "placements", "--out", str(tmp_path / name))
        assert code == 2 and f"{name} exists" in err
    assert (tmp_path / "folder" / "thesis.tex").read_text() == "mine"
    assert (tmp_path / "sheet.csv").read_text() == "with notes by hand"
    code, _, err = move(capsys, "placements", "--seconds", "5")
    assert code == 2 and "seconds: 5 given, and nothing moves; allowed with --speed" in err
