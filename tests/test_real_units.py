"""Units are told from names or sizes, shown, and overridden; never guessed in silence."""

import numpy as np
import pytest
import real_writers as w

from move.errors import BadInput
from move.realworld import check_dataset, open_dataset

# The rows of the table of known sources: joints scale, gripper values, unit of each, gripper in SI or 0..1.
SOURCES = {
    "piper_sdk on the bus": (180e3 / np.pi, [60_000, 98_000, 0], "mdeg", "um", [0.060, 0.098, 0], "m"),
    "ROS, data_tools": (1.0, [0.0, 0.098, 0.05], "rad", "m", [0.0, 0.098, 0.05], "m"),
    "stock PIPER gripper": (1.0, [0.0, 0.07, 0.05], "rad", "m", [0.0, 0.07, 0.05], "m"),
    "RoboCOIN open_scale": (1.0, [0.0, 1.0, 0.5], "rad", "normalised", [0.0, 1.0, 0.5], "normalised"),
    "Pika encoder angle": (1.0, [0.0, 1.6, 0.8], "rad", "pika_rad", [0.0, 1.0, 0.5], "normalised"),
    "degrees on the Hub": (180 / np.pi, [0.0, 1.0, 1.0], "deg", "normalised", [0.0, 1.0, 1.0],
                           "normalised"), "millimetres": (180 / np.pi, [0.0, 70.0,
                                                                        35.0], "deg", "mm", [0.0, 0.07, 0.035], "m"),
}


def source(folder, scale, gripper, **kwargs):
    """A LeRobot set whose joints are scaled and whose gripper takes the given values."""
    values = np.resize(np.array(gripper, float), w.STEPS)
    return w.lerobot_v2(folder, values=lambda n: np.column_stack([w.joints(n) * scale, values]), dtype=np.float64,
                        **kwargs)


@pytest.mark.parametrize("name", SOURCES)
def test_each_known_source(tmp_path, name):
    scale, gripper, joint_unit, gripper_unit, expected, result = SOURCES[name]
    data = open_dataset(source(tmp_path / "d", scale, gripper))
    told = data.units.set_index("quantity")
    assert told.loc["joints", "unit"] == joint_unit and told.loc["gripper", "unit"] == gripper_unit
    assert set(told["decided_by"].drop("time")) == {"size of the numbers"}
    np.testing.assert_allclose(data.episodes[1].joints, w.joints(1), rtol=1e-9)
    np.testing.assert_allclose(data.episodes[0].gripper[:3], expected, atol=1e-12)
    assert data.episodes[0].gripper_unit == result


@pytest.mark.parametrize(("scale", "position", "rotation"), [((1, 1), "m", "rad"), ((1e3, 180 / np.pi), "mm", "deg"),
                                                             ((1e6, 180e3 / np.pi), "um", "mdeg")])
def test_poses(tmp_path, scale, position, rotation):
    def values(n):
        return np.hstack([w.state(n), w.pose()[:, :3] * scale[0], w.pose()[:, 3:] * scale[1]])

    data = open_dataset(w.lerobot_v2(tmp_path / "d", values=values, names=None, dtype=np.float64))
    told = data.units.set_index("quantity")["unit"]
    assert (told["position"], told["rotation"]) == (position, rotation)
    np.testing.assert_allclose(data.episodes[0].end_effector, w.pose(), rtol=1e-9)


@pytest.mark.parametrize("said", [None, "cm"])
def test_a_pose_in_centimetres_is_not_taken_for_one_in_millimetres(tmp_path, said):
    def values(n):
        return np.hstack([w.state(n), w.pose()[:, :3] * 100, w.pose()[:, 3:]])

    (tmp_path / "units.yaml").write_text(f"'*': {{position: {said}}}" if said else "")
    data = open_dataset(w.lerobot_v2(tmp_path / "d", values=values, names=None, dtype=np.float64),
                        units_file=tmp_path / "units.yaml")
    assert data.units.set_index("quantity").unit["position"] == (said or "unknown")
    if said:
        np.testing.assert_allclose(data.episodes[0].end_effector, w.pose(), rtol=1e-9)
    else:
        assert data.episodes[0].end_effector is None


def test_column_names_decide(tmp_path):
    names = [f"arm_joint_{n}_rad" for n in range(1, 7)] + ["gripper_open_scale"]
    data = open_dataset(source(tmp_path / "a", 1.0, [0, 1, 0], names=names))
    assert set(data.units["decided_by"]) == {"names", "the stated rate"}


def test_a_units_file_overrides(tmp_path):
    file = tmp_path / "units.yaml"
    file.write_text('"*": {joints: rad, gripper: half_m}\n.: {joints: deg}\n')
    data = open_dataset(source(tmp_path / "d", 1.0, [0.0, 0.035, 0.02]), units_file=file)
    assert set(data.units["decided_by"]) == {"units file", "the stated rate"}
    np.testing.assert_allclose(data.episodes[0].joints, np.deg2rad(w.joints()), rtol=1e-9)
    np.testing.assert_allclose(data.episodes[0].gripper[:3], [0.0, 0.07, 0.04])


def test_a_part_of_its_own_wins_and_closed_can_be_high(tmp_path):
    source(tmp_path / "set/a", 1.0, [0.0, 1.0, 0.25])
    source(tmp_path / "set/b", 1.0, [0.0, 1.0, 0.25])
    file = tmp_path / "units.yaml"
    file.write_text("b: {gripper_closed_is: high}\n")
    data = open_dataset(tmp_path / "set", units_file=file, episodes=1)
    np.testing.assert_allclose(data.episodes[0].gripper[:3], [0.0, 1.0, 0.25])
    np.testing.assert_allclose(data.episodes[1].gripper[:3], [1.0, 0.0, 0.75])


@pytest.mark.parametrize(("names", "joints", "gripper", "quantity", "note"), [
    (None, 1.0, 0.14, "gripper", "between the known ranges"), (None, None, 0.07, "joints", "scaled to -1..1"),
    ("gripper_mm", 1.0, 0.09, "gripper", "names: mm; the numbers look like m"),
    ("gripper_cm", 1.0, 0.1, "gripper", "names: cm"), ("gripper_m", 1.0, 5.0, "gripper", "names: m"),
    ("joint_rad", 300.0, 0.07, "joints", "names: rad; the numbers are up to 480.3"), ("joint_rad", 5.0, 0.07, "joints",
                                                                                   "names: rad"),
    ("joint_mrad", 1.0, 0.07, "joints", "names: mrad, no unit of it"),
    ("gripper_centimeters", 1.0, 0.09, "gripper", "names: cm"), (None, 1.0, 100.0, "gripper", "mm or per cent"),
    ("gripper_percent", 1.0, 1.0, "gripper", "names: percent"), ("gripper_mdeg", 1.0, 0.07, "gripper", "mdeg, no unit"),
    (None, 5.0 / 1.66, 5.0, "joints", "units file"), (None, 5.0 / 1.66, 5.0, "gripper", "between the known ranges"),
    ("joint_rad", 180 / np.pi, 1.0, "joints", "names: rad; the numbers look like deg"),
    ("gripper_deg", 1.0, 1.5, "gripper", "names: deg"),
    ("joint_deg", 1.0, 0.07, "joints", "names: deg; the numbers look like rad"),
    ("joint_mdeg", 180 / np.pi, 0.07, "joints", "names: mdeg; the numbers look like deg"),
    ("joint_turns", 1.0, 0.07, "joints", "names: turns, no unit of it"),
    (["rad"] * 5 + ["deg"], 1.0, 0.07, "joints", "names: deg and rad, no unit of it"),
    (["rad", "ticks", *["rad"] * 4], 1.0, 0.07, "joints", "names: rad and ticks, no unit of it")])
def test_numbers_that_do_not_fit_a_unit_have_none(tmp_path, names, joints, gripper, quantity, note):
    scale = 1 / np.abs([w.joints(n) for n in range(2)]).max() if joints is None else joints
    kind, _, unit = names.partition("_") if isinstance(names, str) else ("joint", "_", names)
    ends = np.resize(unit if kind == "joint" else "rad", 6)
    named = names and [*(f"joint_{n}_{end}" for n, end in enumerate(ends, 1)),
                       f"gripper_{unit}" if kind == "gripper" else "gripper"]
    data = open_dataset(source(tmp_path / "d", scale, [0.0, gripper, 0.0], **({"names": named} if named else {})))
    told = data.units.set_index("quantity").loc[quantity]
    assert told["unit"] == "unknown" and note in told["note"]
    assert all(getattr(episode, quantity) is None for episode in data.episodes)


@pytest.mark.parametrize(("stated", "change", "quantity", "note"), [
    *((stated, lambda values, n: values * np.where(np.arange(7) < 6, 1 if n else 180 / np.pi, 1), "joints",
       "single episodes look like deg and like rad") for stated in ("rad", None)),
    (None, lambda values, n: values * np.where(np.arange(7) < 6, 1, 1 if n else 10), "gripper",
     "single episodes look like m and like normalised"),
    (None, lambda values, n: values * np.where(np.arange(7) == 3, 500, 1), "joints", "joint 4 is up to")])
def test_numbers_of_two_units_have_none(tmp_path, stated, change, quantity, note):
    names = [*(f"joint_{n}{f'_{stated}' if stated else ''}" for n in range(1, 7)), "gripper"]
    data = open_dataset(w.lerobot_v2(tmp_path / "d", names=names, dtype=np.float64,
                                     values=lambda n: change(w.state(n), n)))
    told = data.units.set_index("quantity").loc[quantity]
    assert told["unit"] == "unknown" and note in told["note"]
    assert all(getattr(episode, quantity) is None for episode in data.episodes)


def test_a_units_file_is_followed_and_held_against_the_numbers(tmp_path):
    (tmp_path / "units.yaml").write_text("'*': {joints: deg}")
    data = open_dataset(w.lerobot_v2(tmp_path / "d"), units_file=tmp_path / "units.yaml")
    told = data.units.set_index("quantity").loc["joints"]
    assert told["unit"] == "deg" and "the numbers are up to 1.6" in told["note"]
    (said,) = [check for check in check_dataset(data) if check.name == "all units are known"]
    assert said.outcome == "differs" and "the units file says deg; the numbers are up to 1.6" in said.detail
    np.testing.assert_allclose(data.episodes[0].joints, np.radians(w.joints()), rtol=1e-6)


def test_numbers_of_timesteps_are_no_time(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", fps=None)
    for path in folder.rglob("*.parquet"):
        w.change_table(path, timestamp=np.arange(w.STEPS, dtype=np.float32))
    assert "numbers of timesteps" in open_dataset(folder).units.set_index("quantity").note["time"]


def test_a_closed_gripper_is_closed_in_every_episode_alike(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", dtype=np.float64, values=lambda n: np.column_stack(
        [w.joints(n), np.linspace(0.02, 0.08 if n else 0.04, w.STEPS)]))
    (tmp_path / "units.yaml").write_text("'*': {gripper_closed_is: high}")
    episodes = open_dataset(folder, units_file=tmp_path / "units.yaml").episodes
    assert [round(float(episode.gripper[0]), 6) for episode in episodes] == [0.06, 0.06]


def test_half_a_gap_is_cautioned(tmp_path):
    data = open_dataset(source(tmp_path / "d", 1.0, [0.0, 0.035, 0.02]))
    assert "half the gap" in data.units.set_index("quantity").loc["gripper", "note"]


@pytest.mark.parametrize(("text", "says"), [
    ('"*": {joints: grad}', "'grad'; allowed: rad, deg, mdeg"), ('"*": {speed: m}', "speed; allowed: time, joints"),
    ("- a list", "expected a YAML mapping"), ("{broken", "not readable as YAML"),
    ("elsewhere: {joints: deg}", "part 'elsewhere'; allowed: *, ."), ("'*': {time: h}", "'h'; allowed: s, ms, us, ns"),
    ("'*': {joints: deg, joints: rad}", "'joints' stands twice"), ("'*': {arm: ur5}", "'ur5'; allowed: piper, other")])
def test_a_bad_units_file_is_one_line(tmp_path, text, says):
    (tmp_path / "units.yaml").write_text(text)
    with pytest.raises(BadInput) as caught:
        open_dataset(w.lerobot_v2(tmp_path / "d"), units_file=tmp_path / "units.yaml")
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_a_units_file_settles_episodes_that_look_like_different_units(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", dtype=np.float64, values=lambda n: np.column_stack(
        [w.joints(n) * (1, 180 / np.pi)[n], np.linspace(0.09, 0.05, w.STEPS)]))
    (tmp_path / "units.yaml").write_text("'*': {joints: rad}")
    episodes = open_dataset(folder, units_file=tmp_path / "units.yaml").episodes
    np.testing.assert_allclose(episodes[0].joints, w.joints(0), rtol=1e-9)


def test_what_is_relative_is_no_joint(tmp_path):
    names = [*(f"delta_joint_{n}" for n in range(1, 7)), "gripper"]
    assert all(episode.joints is None for episode in open_dataset(w.lerobot_v2(tmp_path / "d", names=names)).episodes)
