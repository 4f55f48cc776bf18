"""What a data set covers: repeated places, holes, what to add and what to expect, whatever layout it has."""

import json

import numpy as np
import pandas as pd
import pytest
import real_writers as w
from shared import move, plan

from move import paths
from move.errors import BadInput
from move.exchange import export as exporting
from move.figures.radius import measured
from move.learn import dataset
from move.realworld import open_dataset, write_sample
from move.realworld.grasps import grasp_table, grasps, why_no_grasps
from move.realworld.workspace import path_table
from move.sim import collect as collecting
from move.sim.placement import Placement
from move.statistics import places as p
from move.statistics.distance import Curve

TABLE = ((0.0, -0.2), (0.4, 0.2))
CURVE = Curve(0.9, (0.04,), 4.0)


def collected(folder, **choices):
    """A data set of static demonstrations, or what is chosen otherwise; returns its record."""
    wanted = plan(**{"method": "static", **choices})
    made, record = collecting.collect(wanted, 3)
    dataset.save(made, folder, collecting.record_attributes(wanted, 3, record))
    return record


def spread(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(*TABLE, (count, 2))


def shaken(places: np.ndarray, times: int) -> np.ndarray:
    """Each place so many times, as exactly as a hand puts an object back."""
    return np.repeat(places, times, axis=0) + np.random.default_rng(1).uniform(-0.003, 0.003, (times * len(places), 2))


@pytest.mark.parametrize("times", [2, 10])
def test_five_places_ten_times_are_told_by_their_name(times):
    corners = np.array([[0, -0.2], [0, 0.2], [0.4, -0.2], [0.4, 0.2], [0.2, 0]])
    assert p.in_words(p.repetitions(shaken(corners, times))) == f"5 places x {times}"
    assert p.effective_number(shaken(corners, times), CURVE) == pytest.approx(5, abs=0.1)
    assert p.in_words(p.repetitions(corners)) == "5 places, each once"
    assert p.in_words(np.array([2, 1, 1])) == "3 places, of which 1 repeated, up to 2 times"


def test_a_chain_of_places_is_not_one_place():
    chain = np.stack([np.arange(0, 0.1, 0.008), np.zeros(13)], 1)
    assert len(p.repetitions(chain)) >= 5


def test_the_next_place_is_in_the_largest_hole_and_fills_it():
    places = spread(200)
    places = places[np.hypot(*(places - (0.3, -0.1)).T) > 0.09]  # a hole of 9 cm
    new, holes = p.next_places(places, TABLE, 5)
    assert np.hypot(*(new[0] - (0.3, -0.1))) < 0.03 and holes[0] > 0.08
    assert (np.diff(holes) <= 1e-12).all() and ((new >= TABLE[0]) & (new <= TABLE[1])).all()
    for number in range(1, 5):
        assert p.nearest(new[[number]], np.vstack([places, new[:number]])) == pytest.approx(holes[number])


def test_more_places_are_expected_to_do_better_and_repeated_ones_are_not():
    rates = [p.expected_success(spread(count), TABLE, CURVE) for count in (5, 20, 80, 2000)]
    assert rates == sorted(rates) and rates[-1] == pytest.approx(0.9, abs=0.02)
    five = spread(5)
    assert p.expected_success(shaken(five, 10), TABLE, CURVE) == pytest.approx(rates[0], abs=0.03)
    assert p.expected_success(five, TABLE, Curve(0.9, (0.08,), 4.0)) > rates[0]


def test_what_is_expected_is_the_share_of_the_table_within_reach():
    steep = Curve(1.0, (0.05,), 200.0)  # success to 5 cm, none beyond
    assert p.expected_success(np.array([[0.2, 0.0]]), TABLE, steep) == pytest.approx(np.pi * 0.05**2 / 0.16, rel=0.1)


def test_a_robots_grasps_are_where_its_hand_was_when_the_gripper_closed(tmp_path):
    folder = write_sample(tmp_path / "sample", episodes=4)  # of a PIPER, whose joints tell where it grasped
    demos = open_dataset(folder, revision=None, episodes=None)
    table = grasp_table(demos.episodes)
    assert len(table) == len(demos.episodes) == len(grasps(str(folder)).places) and why_no_grasps(demos.episodes) == ""
    paths = path_table(demos.episodes)
    first = paths[paths.grasped].groupby(["part", "index"])[["x_m", "y_m"]].first().sort_index()
    assert table.set_index(["part", "index"])[["x_m", "y_m"]].sort_index().to_numpy() == pytest.approx(first.to_numpy())


def test_an_arm_that_tells_only_its_joints_has_no_places_and_is_refused(tmp_path):
    w.lerobot_v2(tmp_path / "arm", robot_type="so100")
    with pytest.raises(BadInput, match="no place of a grasp: .* demonstrations: no pose of the hand"):
        grasps(str(tmp_path / "arm"))


POSED = ["x", "y", "z", "roll", "pitch", "yaw", "gripper"]


def posed(folder, *, apart=0.02, **about):
    """A set of an arm that tells its pose, in m; of two episodes that are so far apart."""
    return w.lerobot_v2(folder, names=POSED, dtype=np.float64, values=lambda n: np.column_stack(
        [w.pose() + apart * n, np.where(np.arange(w.STEPS) < 3, 0.9, 0.1)]), **about)


def test_what_places_rest_on_is_said(tmp_path, capsys):
    for name, arm, apart in (("a", "ur5", 0.02), ("b", "panda", 0.03)):
        posed(tmp_path / "two" / name, robot_type=arm, apart=apart)
    posed(tmp_path / "twice", robot_type="ur5", apart=0)
    doubts = {name: "; ".join(grasps(str(tmp_path / name)).doubts) for name in ("two", "twice")}
    assert "taken as places in one frame: a (ur5), b (panda)" in doubts["two"] and "b/1 equals" not in doubts["two"]
    assert "./1 equals ./0" in doubts["twice"] and "one frame" not in doubts["twice"]
    assert all("0 taken as closed" in line for line in doubts.values())
    code, out, _ = move(capsys, "coverage", str(tmp_path / "twice"), "--json", "--within", "-20,-20,80,80")
    assert code == 0 and json.loads(out)["doubts"] == doubts["twice"]
    assert json.loads(out)["part of the table (cm)"] == "-20.0, -20.0, 80.0, 80.0"
    assert all("positions up to " in line and "taken for m by their size" in line for line in doubts.values())
    assert all("an object that moved before its grasp was seen at more places" in line for line in doubts.values())
    code, _, err = move(capsys, "coverage", str(tmp_path / "two"), "--json")
    assert code == 2 and "all grasps are at one place or on one line" in err


def test_demonstrations_that_no_budget_cuts_all_have_their_grasps_and_a_cut_one_alone_has_none(tmp_path):
    collected(tmp_path / "whole", demonstrations=2)
    collected(tmp_path / "cut", timesteps=8)
    whole = grasps(str(tmp_path / "whole"))
    assert len(whole.places) == 2 and whole.without == ()
    with pytest.raises(BadInput, match="its only demonstration was cut by the budget"):
        grasps(str(tmp_path / "cut"))


def test_a_data_set_collected_here_is_covered_by_its_own_grasp_points(tmp_path, capsys):
    record = collected(tmp_path / "data.zarr")
    found = grasps(str(tmp_path / "data.zarr"))
    assert found.places == pytest.approx(np.array(record.grasp_points)[:-1]), "the budget cut the last one"
    assert len(found.without) == 1 and f"1 of {record.demonstrations} demonstrations: cut" in found.without[0]
    code, out, _ = move(capsys, "coverage", str(tmp_path / "data.zarr"), "--json", "--next", "3",
                            "--within", "-20,50,20,80", "--out", str(tmp_path / "map.png"))
    said = json.loads(out)
    assert code == 0 and said["grasps"] == record.demonstrations - 1 and len(said["next"]) == 3
    table = ((-0.2, 0.5), (0.2, 0.8))
    assert said["next"][0]["nearest before it (cm)"] == pytest.approx(
        100 * p.next_places(found.places, table, 1)[1][0], abs=0.06)
    assert (tmp_path / "map.png").stat().st_size > 5000 and (tmp_path / "map.pdf").exists()
    code, out, _ = move(capsys, "coverage", str(tmp_path / "data.zarr"), "--json", "--radius", "1000")
    assert json.loads(out)["success over this part, of that at a place seen (%)"] == "100"
    assert "around these grasps; --within" in json.loads(out)["part of the table (cm)"]


def test_where_the_object_moved_before_its_grasps_its_whole_way_was_seen(tmp_path, capsys):
    """Five places under MOVE are worth many more; the episodes that an export leaves out are not counted."""
    said = {}
    for method in ("static", "move"):
        record = collected(tmp_path / method, method=method, timesteps=1000, demonstrations=10, protocol="placed",
                           placement=Placement(places=5))
        _, out, _ = move(capsys, "coverage", str(tmp_path / method), "--json", "--within", "-20,50,10,80")
        said[method] = json.loads(out)
        ways = [where.object_position[:2] for phase, where in record.seen if phase == "pick"]
        assert len(ways) > 100 and p.nearest(np.array(ways), grasps(str(tmp_path / method)).seen).max() < 1e-6
    hole, success = ("largest hole, to the nearest place seen (cm)",
                       "success over this part, of that at a place seen (%)")
    assert said["static"]["places"] == said["move"]["places"] == "5 places x 2"
    assert said["move"][hole] < said["static"][hole] - 2
    assert int(said["move"][success].split()[0]) > int(said["static"][success].split()[0]) + 20


def test_what_an_export_left_out_is_not_counted(tmp_path):
    record = collected(tmp_path / "data")
    exporting.export(tmp_path / "data", tmp_path / "whole", "zarr", whole_episodes=True)
    found = grasps(str(tmp_path / "whole"))
    assert len(found.places) == record.demonstrations - 1 and found.without == ()
    assert found.origin == f"simulation, {record.demonstrations - 1} demonstrations"


def test_the_radius_that_is_taken_is_the_shipped_one_then_its_interval():
    shipped = pd.read_csv(paths.ROOT / "paper_figures/radius_radii.csv")
    for setting in ("hand in one place", "hand anywhere"):
        (row,) = shipped.query("setting == @setting and observation == 'rgb'").itertuples()
        curves = measured(setting)
        assert [curve.radii for curve in curves] == [(row.radius,), (row.low,), (row.high,)]
        assert {(curve.top, curve.steepness) for curve in curves} == {(row.top, row.steepness)}


def test_places_on_one_line_span_no_part_of_a_table():
    line = np.linspace((0.1, 0.0), (0.3, 0.2), 9) + np.random.default_rng(0).uniform(-0.003, 0.003, (9, 2))
    assert p.spanned(line) is None and p.spanned(shaken(np.array([[0.1, 0.2]]), 9)) is None
    assert p.spanned(np.vstack([line, [[0.3, 0.0]]])) is not None and p.inside(line, ((0.0, -0.1), (0.19, 0.3))) == 4


@pytest.mark.parametrize(("arguments", "problem"), [
    (("nowhere",), "data 'nowhere' is no folder"),
    (("nowhere", "--within", "1,2,3"), "within: '1,2,3' given"),
    (("nowhere", "--out", "map.jpg"), "out: 'map.jpg' given; allowed is a file that ends in .png"),
    (("nowhere", "--out", "{}/folder.png"), "folder.png is a folder; allowed is the path of a file"),
    (("nowhere", "--out", "{}/other.png"), "other.pdf is a folder; allowed is the path of a file"),
    (("{}/data", "--within", "0,0,1,1"), "within: 0, 0, 1, 1 given, where none of the "),
    (("{}/data", "--units-file", "u.yaml"), "units_file: 'u.yaml' given; "),
])
def test_a_bad_request_is_one_line(tmp_path, capsys, arguments, problem):
    for name in ("folder.png", "other.pdf"):
        (tmp_path / name).mkdir()
    collected(tmp_path / "data", timesteps=200)
    code, _, err = move(capsys, "coverage", *(each.format(tmp_path) for each in arguments))
    assert code == 2 and problem in err and len(err.strip().splitlines()) == 1
