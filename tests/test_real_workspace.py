"""Coverage, grasps and tracking, on arrays whose answers are written by hand."""

import dataclasses

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.colors import rgb_to_hsv

from move.figures.plots import real_figures, style
from move.realworld import tracking, workspace
from move.realworld.episode import RobotEpisode
from move.realworld.frames import Frames
from move.realworld.piper import forward_kinematics


def episode(xy, gripper=None, method="move", index=0, frames=None):
    """An episode that follows (T, 2) points."""
    steps = len(xy)
    pose = np.column_stack([np.asarray(xy, float), np.zeros((steps, 4))])
    cameras = ({} if frames is None else
               {"cam": Frames("memory", lambda: steps, lambda numbers: (frames[n] for n in numbers))})
    return RobotEpisode(part="p", method=method, index=index, source=".", timestamps_s=np.arange(steps) / 10,
                        robot="piper", end_effector=pose, gripper=None if gripper is None else
                        np.asarray(gripper, float), gripper_unit="m", action=pose[:, :2], action_names=("x", "y"),
                        cameras=cameras)


def test_cells_fill_the_half_disc(monkeypatch):
    monkeypatch.setattr(workspace, "CELL_M", 0.01)
    assert len(workspace.coverage(np.empty((0, 2)))) == pytest.approx(5655, rel=0.005), "0.5 pi 60 60 cm2"


def test_coverage_counts_each_point_in_its_cell():
    points = [[0.01, 0.01], [0.04, 0.04], [0.06, -0.01], [0.7, 0.0], [-0.1, 0.1], [np.nan, 0.0]]
    cells = workspace.coverage(points)
    visited = cells[cells["visits"] > 0].set_index(["column", "row"])["visits"].to_dict()
    assert visited == {(0, 0): 2, (1, -1): 1}
    assert workspace.coverage(np.empty((0, 2)))["visits"].sum() == 0


@given(st.lists(st.tuples(st.floats(0, 0.38), st.floats(-0.38, 0.38)), min_size=1, max_size=30))
def test_coverage_loses_no_point_inside(points):
    assert workspace.coverage(np.array(points)).visits.sum() == len(points)


@pytest.mark.parametrize(
    ("signal", "grasp"), [([9, 9, 9, 6, 6, 6, 6, 9, 9], 3), ([9, 9, 6, 6, 6, 6], 2), ([9, 9, 6, 9, 9, 6, 6, 6, 9], 5),
                          ([0, 0, 0, 0, 0, 9, 9, 0, 0, 0, 9], 7), ([9, 9, 9.1, 9, 9], None), ([9, 9, 6, 6, 9], None),
                          ([9, np.nan, 0, 0, 0, 0], None), ([9], None), ],
    ids=["once", "never opened", "a slip first", "closed at the start", "noise", "too short", "not finite", "one step"])
def test_grasp(signal, grasp):
    assert workspace.grasp_step(np.array(signal, float)) == grasp


def test_path_and_length_tables():
    e = episode([[0.1, 0], [0.2, 0], [0.2, 0.1], [0.2, 0.2], [0.2, 0.3]], gripper=[9, 9, 1, 1, 1])
    assert workspace.path_table([e])["grasped"].tolist() == [False, False, True, True, True]
    lengths = workspace.length_table([e, episode(np.zeros((7, 2)), index=1)])
    assert lengths["mean_timesteps"].tolist() == [6] and lengths["episodes"].tolist() == [2]
    assert workspace.path_table([dataclasses.replace(e, end_effector=None)]).empty


def test_positions_come_from_six_joints_first():
    joints = np.tile([0.2, 1.5, -1.5, 0.0, 0.5, 0.0], (4, 1))
    both = dataclasses.replace(episode(np.full((4, 2), 9.0)), joints=joints)
    np.testing.assert_allclose(workspace.positions(both), forward_kinematics(joints)[:, :3])
    seven = dataclasses.replace(both, joints=np.zeros((4, 7)))
    assert workspace.positions(seven)[0, 0] == 9, "seven are no PIPER's: the recorded pose is taken"
    both.joints[2, 4] = np.nan
    assert np.isnan(workspace.positions(both)).any(axis=1).tolist() == [False, False, True, False]


def test_setup_figure_without_anything_to_show():
    nothing = workspace.path_table([])
    figure = real_figures.setup_figure(workspace.coverage_by_method(nothing), nothing, {}, simulated=False,
                                       lacking="the arm is $\\frac{so100, not PIPER")
    style.settle(figure)
    assert [text.get_text() for text in figure.axes[0].texts] == [
        "the arm is $\\frac{so100, not PIPER; no camera whose frames can be read"]
    plt.close(figure)


def test_equal_budget_keeps_the_first_of_each():
    episodes = [episode(np.zeros((4, 2)), method="static"), episode(np.zeros((9, 2)), method="move")]
    cut = workspace.equal_budget(workspace.path_table(episodes))
    assert cut.groupby("method")["step"].apply(list).to_dict() == {"static": [0, 1, 2, 3], "move": [0, 1, 2, 3]}


def test_action_table():
    table = workspace.action_table([episode([[0, 0], [1, 0], [3, 0]])]).set_index("component")
    spoilt = episode([[0, 0], [np.nan, 0], [3, 0], [4, 0]])
    alone = workspace.action_table([spoilt]).set_index("component").loc["x"]
    assert (alone["mean"], alone["mean_step"]) == (pytest.approx(7 / 3), 1.0), "what is not finite is left out"
    assert table.loc["x", "mean_step"] == 1.5 and table.loc["y", "sd"] == 0 and table.loc["x", "highest"] == 3


def square(row: int, column: int, colour=(245, 130, 20)) -> np.ndarray:
    """A grey image with a coloured 4 x 4 square whose upper left corner is given."""
    image = np.full((20, 30, 3), 200, np.uint8)
    image[row:row + 4, column:column + 4] = colour
    return image


def test_tracking_finds_the_centre_and_hides_what_is_not_orange():
    frames = np.stack([square(2, 3), square(2, 13), square(2, 13, (20, 60, 245)), square(2, 13, (240, 20, 20))])
    centres = tracking.track_orange(frames)
    np.testing.assert_allclose(centres[:2], [[3.5, 4.5], [3.5, 14.5]])
    assert np.isnan(centres[2:]).all(), "blue and red are not orange"
    assert tracking.speeds(centres, np.arange(4) / 2)[0] == pytest.approx(20)


def test_orange_is_what_hue_saturation_and_value_say():
    """Whatever the colour, on a grid through all of them."""
    levels = np.arange(0, 256, 5, dtype=np.uint8)
    colours = np.stack(np.meshgrid(levels, levels, levels), -1).reshape(1, -1, 3)
    hue, saturation, value = np.moveaxis(rgb_to_hsv(colours / np.float32(255)), -1, 0)
    defined = (saturation >= 0.55) & (value >= 0.35) & (12 <= 360 * hue) & (360 * hue <= 45)
    assert np.array_equal(tracking.orange_mask(colours), defined) and 0.01 < defined.mean() < 0.2


def test_object_speed_looks_before_the_grasp_only():
    frames = [square(2, 2 + min(n, 10)) for n in range(20)]
    e = episode(np.zeros((20, 2)), gripper=[9] * 11 + [1] * 9, frames=frames)
    row = tracking.object_speeds(tracking.object_places([e], "cam")).iloc[0]
    assert row["mean_speed"] == pytest.approx(10) and row["travelled"] == pytest.approx(10) and row["unit"] == "px"


def test_seen_share_counts_square_cells(monkeypatch):
    monkeypatch.setattr(tracking, "CELLS_ACROSS", 4)
    places = pd.DataFrame({"row": [0.0, 4.9, 5.1, np.nan], "column": [0.0, 4.0, 9.9, 1.0], "height": 10, "width": 20})
    assert tracking.seen_share(places) == 2 / 8
    assert tracking.seen_share(places.iloc[3:]) == 0
