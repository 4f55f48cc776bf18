"""A joint belongs to its name: names of many robots are sorted, and nothing is taken for PIPER's that is not."""

import h5py
import numpy as np
import pytest
import real_writers as w

from move.realworld import check_dataset, open_dataset
from move.realworld.state_columns import Columns, split_columns
from move.realworld.workspace import joint_table, path_table, positions, why_no_positions

SO101 = [f"{name}.pos" for name in ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll",
                                    "gripper")]
SO100 = [f"main_{name.removesuffix('.pos')}" for name in SO101]
VIPER = ["waist", "shoulder", "elbow", "forearm_roll", "wrist_angle", "wrist_rotate", "gripper"]
ROBOTS = {  # names -> limb: joints, pose, gripper
    "SO-101": (SO101, {"": Columns((0, 1, 2, 3, 4), (), 5)}), "SO-100": (SO100, {"": Columns((0, 1, 2, 3, 4), (), 5)}),
    "gripper first": (["gripper", "joint_2", "joint_1"], {"": Columns((2, 1), (), 0)}),
    "two ViperX": ([f"{side}_{name}" for side in ("left", "right") for name in VIPER],
                   {"left": Columns(tuple(range(6)), (), 6), "right": Columns(tuple(range(7, 13)), (), 13)}),
    "numbered arms": ([f"arm{n}_joint{k}" for n in (1, 2) for k in range(3)],
                      {"arm1": Columns((0, 1, 2)), "arm2": Columns((3, 4, 5))}),
    "Franka": ([*(f"panda_joint{n}" for n in range(1, 8)), "gripper.pos"],
               {"": Columns(tuple(range(7)), (), 7)}),
    "UR": (["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint",
            "wrist_3_joint"], {"": Columns(tuple(range(6)))}),
    "words from the hand down": ([*reversed(VIPER[:-1]), "gripper"],
                                 {"": Columns((5, 4, 3, 2, 0, 1), (), 6)}),
    "a UR from the hand down": (["wrist_3", "wrist_2", "wrist_1", "elbow", "shoulder_pan", "shoulder_lift"],
                                {"": Columns((4, 5, 3, 2, 1, 0))}),
    "a gripper that says how closed it is": (["joint_1", "joint_2", "gripper_closedness"], {"": Columns((0, 1))}),
    "camel case": (["leftArmJoint1", "leftArmJoint2", "leftGripper"], {"left": Columns((0, 1), (), 2)}),
    "speeds and efforts first": (["joint_1.vel", "joint_1.pos", "joint_2.effort", "joint_2.pos"],
                                 {"": Columns((1, 3))}),
    "a base that drives": ([*(f"arm_{name}" for name in SO101), "x.vel", "y.vel", "theta.vel"],
                           {"": Columns((0, 1, 2, 3, 4), (), 5)}),
    "leader and follower": (["leader_joint_1", "leader_joint_2", "joint_1", "joint_2"],
                            {"leader": Columns((0, 1)), "": Columns((2, 3))}),
    "the place of a cube": (["object_x", "object_y", "object_z", "joint_1"], {"": Columns((3,))}),
    "legs": (["left_hip_pitch", "left_knee", "left_shoulder_pitch", "left_elbow"], {"left": Columns((2, 3))}),
    "a pose of Euler angles": ([*(f"tcp_pos_{axis}" for axis in "xyz"), *(f"tcp_rot_{axis}" for axis in "xyz")],
                               {"": Columns((), tuple(range(6)))}),
    "RoboCOIN": ([*(f"right_arm_joint_{n}_rad" for n in range(1, 7)), "right_gripper_open_scale",
                  *(f"right_eef_{kind}_{axis}" for kind in ("pos", "rot") for axis in "xyz")],
                 {"right": Columns(tuple(range(6)), tuple(range(7, 13)), 6)}),
    "a column twice": (["joint_1", "joint_1", "gripper"], {}), "nothing said": (["a", "b", "c", "d", "e", "f"], {}),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_names_of_robots(name):
    names, arms = ROBOTS[name]
    assert split_columns(names, len(names))[0] == arms


def test_what_names_leave_is_said_and_width_is_asked_only_without_names():
    assert split_columns(SO101, 6, piper_order=False)[1] is None
    assert "from the waist to the wrist" in split_columns(SO101, 6)[1]
    assert "3 of 4 columns are of no arm" in split_columns(["object_x", "u", "v", "joint_1"], 4)[1]
    assert "6 of 6 columns" in split_columns(["a"] * 6, 6)[1]
    arms, note = split_columns([], 6)
    assert arms == {"": Columns(tuple(range(6)))} and "order assumed from the width" in note
    arms, note = split_columns([], 6, piper_order=False)
    assert not arms and "kept as stored" in note


@pytest.mark.parametrize("names, kept", [(["x", "y", "z", "roll", "pitch", "yaw"], True), (["state"], False)])
def test_names_that_do_not_fit_the_columns_do_not_make_joints_of_a_pose(tmp_path, names, kept):
    recorded = open_dataset(w.lerobot_v2(tmp_path / "d", names=names)).episodes[0]
    assert (recorded.joints is None) is kept
    assert any(("7 of 7 columns" if kept else "order assumed") in note for note in recorded.notes)


def arm(folder, values, names, robot, **about):
    """A LeRobot set of two episodes whose state is `values`, (T, columns), a little other in each."""
    return w.lerobot_v2(folder, values=lambda n: values + 0.01 * n, names=names, width=len(names or values[0]),
                        dtype=np.float64, robot_type=robot, **about)


def swing(largest: float, columns: int = 5) -> np.ndarray:
    """(STEPS, columns) from -largest to largest."""
    return np.linspace(-largest, largest, w.STEPS)[:, None] * np.linspace(1, 0.5, columns)


def with_gripper(largest: float, grip) -> np.ndarray:
    return np.column_stack([swing(largest), np.resize(np.asarray(grip, float), w.STEPS)])


@pytest.mark.parametrize("robot", ["so100", "so101_follower", "koch", "lekiwi"])
@pytest.mark.parametrize(("largest", "unit"), [(80.0, "unknown"), (3.0, "unknown"), (170.0, "deg")])
def test_arms_of_hobby_motors_have_a_gripper_in_per_cent_and_joints_that_no_size_tells(tmp_path, robot, largest, unit):
    data = open_dataset(arm(tmp_path / "d", with_gripper(largest, [2, 39, 20]), SO101, robot))
    told = data.units.set_index("quantity")
    e = data.episodes[0]
    assert told.loc["joints", "unit"] == unit and told.loc["gripper", "unit"] == "percent"
    assert told.loc["gripper", "decided_by"] == "the arm" and e.gripper_unit == "normalised"
    np.testing.assert_allclose(e.gripper[:3], [0.02, 0.39, 0.20])
    assert (e.joints is None) == (unit == "unknown") and e.robot == robot and e.state.shape == (w.STEPS, 6)
    outcome = {check.name: check.outcome for check in check_dataset(data)}
    assert outcome["all units are known"] == ("differs" if unit == "unknown" else "pass")
    assert outcome["joints stay within PIPER's limits"] == "unknown"


@pytest.mark.parametrize(("said", "joints"), [("deg", np.deg2rad), ("percent", None)])
def test_a_units_file_says_whether_joints_are_degrees_or_per_cent(tmp_path, said, joints):
    folder = arm(tmp_path / "d", with_gripper(80.0, [2, 39, 20]), SO101, "so101_follower")
    (tmp_path / "units.yaml").write_text(f"'*': {{joints: {said}}}")
    data = open_dataset(folder, units_file=tmp_path / "units.yaml")
    assert data.units.set_index("quantity").loc["joints", "unit"] == said
    assert {c.name: c.outcome for c in check_dataset(data)}["all units are known"] == "pass"
    e = data.episodes[0]
    if joints is None:
        assert e.joints is None
    else:
        np.testing.assert_allclose(e.joints, joints(swing(80.0)))


COUNTS = "mdeg or counts of a motor: name it in a units file"


@pytest.mark.parametrize(("robot", "largest", "unit", "note"), [
    ("piper", 85.0, "deg", ""), ("franka", 2.8, "rad", ""), ("ur5e", 85.0, "unknown", "degrees or -100..100 per cent"),
    (None, 85.0, "unknown", "degrees or -100..100 per cent"), ("ur5e", 140.0, "deg", ""),
    ("so101_follower", 2900.0, "unknown", COUNTS), ("koch", 4000.0, "unknown", COUNTS),
    ("ur5e", 90_000.0, "unknown", COUNTS), (None, 3500.0, "unknown", COUNTS), (None, 90_000.0, "mdeg", ""),
    ("piper", 3500.0, "mdeg", "")])
def test_what_large_numbers_of_joints_and_gripper_are_depends_on_the_arm(tmp_path, robot, largest, unit, note):
    names = [f"joint_{n}" for n in range(1, 6)] + ["gripper"]
    values = np.column_stack([swing(largest), np.linspace(2000, min(largest, 70_000.0), w.STEPS)])
    data = open_dataset(arm(tmp_path / "d", values, names, robot))
    told, e = data.units.set_index("quantity"), data.episodes[0]
    assert told.loc["joints", "unit"] == unit and note in told.loc["joints", "note"]
    assert (e.joints is None) == (unit == "unknown")
    if largest > 1000:
        assert told.loc["gripper", "unit"] == ("um" if unit == "mdeg" else "unknown")
        assert (e.gripper is None) == (unit == "unknown")


@pytest.mark.parametrize(("name", "values", "unit", "expected", "turned_into"), [
    ("gripper_percent", [0, 50, 100], "percent", [0, 0.5, 1], "normalised"),
    ("gripper_rad", [0, 0.4, 0.9], "rad", [0, 0.4, 0.9], "rad"), ("gripper_deg", [0, 45, 90], "deg",
                                                                [0, np.pi / 4, np.pi / 2], "rad"),
    ("gripper_mm", [0, 35, 70], "mm", [0, 0.035, 0.07], "m"), ("gripper_m", [0, 0.035, 0.07], "m",
                                                              [0, 0.035, 0.07], "m"),
    ("gripper", [0, 35, 70], "unknown", None, None), ("gripper_percent", [0, 900, 1800], "unknown", None, None),
    ("gripper_m", [0, 35, 70], "unknown", None, None)])
def test_the_gripper_has_the_unit_of_its_name(tmp_path, name, values, unit, expected, turned_into):
    data = open_dataset(arm(tmp_path / "d", with_gripper(1.0, values), [f"joint_{n}" for n in range(5)] + [name],
                            "ur5e"))
    e = data.episodes[0]
    assert data.units.set_index("quantity").loc["gripper", "unit"] == unit and e.gripper_unit == turned_into
    if expected is None:
        assert e.gripper is None
    else:
        np.testing.assert_allclose(e.gripper[:3], expected, atol=1e-12)


def test_a_state_of_another_arm_without_names_is_kept_as_stored(tmp_path):
    e = open_dataset(arm(tmp_path / "d", with_gripper(80.0, [2, 39, 20]), None, "so100")).episodes[0]
    assert e.joints is None and e.gripper is None and "kept as stored" in e.notes[0]
    np.testing.assert_allclose(e.state, with_gripper(80.0, [2, 39, 20]))


@pytest.mark.parametrize("robot", ["so100", "ur5e", None, "piper_x"])
def test_only_a_pipers_hand_is_placed(tmp_path, robot):
    whole = open_dataset(arm(tmp_path / "d", w.state(), w.NAMES, robot))
    assert all(positions(e) is None for e in whole.episodes) and path_table(whole.episodes).empty
    assert f"the arm is {robot or 'not named'}, not PIPER" in why_no_positions(whole.episodes)
    (tmp_path / "units.yaml").write_text("'*': {arm: piper}")
    mine = open_dataset(tmp_path / "d", units_file=tmp_path / "units.yaml")
    assert positions(mine.episodes[0]).shape == (w.STEPS, 3) and why_no_positions(mine.episodes) == ""


def test_a_piper_beyond_its_limits_is_not_placed(tmp_path):
    data = open_dataset(w.lerobot_v2(tmp_path / "d", values=lambda n: w.state(n) + [0, 0, 2.0, 0, 0, 0, 0]))
    assert positions(data.episodes[0]) is None
    assert "2 of 2 episodes: joints beyond PIPER's limits" in why_no_positions(data.episodes)


def test_joints_of_a_layout_that_names_no_arm_may_be_per_cent_too(tmp_path):
    folder = w.act_hdf5(tmp_path / "d")
    with h5py.File(folder / "episode_0.hdf5", "a") as file:
        file["observations/qpos"][:, :6] = np.rad2deg(w.joints())
    told = open_dataset(folder).units.set_index("quantity")
    assert told.loc["joints", "unit"] == "unknown" and "degrees or -100..100" in told.loc["joints", "note"]


def test_joints_keep_their_names_and_the_leader_is_not_read(tmp_path):
    names = ["elbow_flex", "gripper", "shoulder_lift", "shoulder_pan", "wrist_flex", "wrist_roll"]
    values = np.radians([20, 57, 10, 30, 40, 50]) + np.linspace(0, 0.1, w.STEPS)[:, None]
    table = joint_table(open_dataset(arm(tmp_path / "a", values, names, "koch", ), units_file=said(
        tmp_path, "joints: rad")).episodes)
    first = table[(table["index"] == 0) & (table.time_s == 0)].set_index("joint").degrees.round(3).to_dict()
    assert first == {"elbow_flex": 20, "shoulder_lift": 10, "shoulder_pan": 30, "wrist_flex": 40, "wrist_roll": 50}
    names = [*(f"leader_joint_{n}" for n in range(1, 4)), *(f"joint_{n}" for n in range(1, 4))]
    both = np.hstack([swing(2.0, 3), swing(0.5, 3)])
    followed = open_dataset(arm(tmp_path / "b", both, names, "ur5")).episodes[0]
    np.testing.assert_allclose(followed.joints, both[:, 3:])


def said(folder, line):
    """A units file."""
    (folder / "units.yaml").write_text(f"'*': {{{line}}}")
    return folder / "units.yaml"
