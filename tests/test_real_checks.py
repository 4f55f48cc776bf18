"""The checks find what is wrong and pass what is right; the sample is honest about itself; the arm's kinematics."""

import dataclasses

import numpy as np
import pytest
import real_writers as w

from move.paper import TABLE3_REAL
from move.realworld import check_dataset, checks_table, open_dataset, write_sample
from move.realworld.checks import OUTCOMES
from move.realworld.piper import LIMITS_RAD, flange_transform, forward_kinematics, reach
from move.realworld.sample import SIZE
from move.realworld.tracking import object_places, object_speeds, seen_share
from move.realworld.workspace import equal_budget


@pytest.fixture(scope="session")
def sample(tmp_path_factory):
    """The bundled sample, opened."""
    return open_dataset(write_sample(tmp_path_factory.mktemp("real") / "sample"), episodes=None)


def outcomes(data) -> dict[str, str]:
    return {check.name: check.outcome for check in check_dataset(data)}


def spoil(data, **change):
    """The data set with its first episode changed."""
    first = dataclasses.replace(data.episodes[0], **change)
    return dataclasses.replace(data, episodes=(first, *data.episodes[1:]))


def test_the_sample_says_that_it_is_simulated(sample):
    assert sample.simulated and "toy" in sample.about["what"]
    assert [(m, n) for m, n in sample.contents[["method", "episodes"]].itertuples(index=False)] == [("move", 20),
                                                                                                    ("static", 20), ]
    size = sum(path.stat().st_size for path in sample.folder.rglob("*") if path.is_file())
    assert size < 1_000_000


def test_the_sample_passes_all_but_the_papers_sizes(sample):
    table = checks_table(check_dataset(sample))
    assert list(table.columns) == ["name", "outcome", "detail"] and set(table["outcome"]) <= set(OUTCOMES)
    assert set(table.loc[table["outcome"] != "pass", "name"]) == {
        "move_sample: size is one of the paper's", "static_sample: size is one of the paper's",
        "move: mean length is the paper's", "static: mean length is the paper's",
    }


def test_the_sample_is_a_function_of_its_seed(tmp_path):
    a, b, c = (open_dataset(write_sample(tmp_path / name, seed=seed, episodes=2))
               for name, seed in (("a", 1), ("b", 1), ("c", 2)))
    for x, y in zip(a.episodes, b.episodes, strict=True):
        np.testing.assert_array_equal(x.joints, y.joints)
        np.testing.assert_array_equal(x.cameras["cam_global"].read([0, 9]), y.cameras["cam_global"].read([0, 9]))
    assert not np.array_equal(a.episodes[0].joints[:20], c.episodes[0].joints[:20])
    before = (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns
    for episodes in (1, 2):
        write_sample(tmp_path / "a", seed=1, episodes=episodes)
        assert (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns == before, "an existing sample is kept"
    assert len(open_dataset(write_sample(tmp_path / "a", seed=1, episodes=3)).episodes) == 6


def test_real_data_are_not_called_simulated(tmp_path):
    assert not open_dataset(w.lerobot_v2(tmp_path / "d")).simulated


@pytest.mark.parametrize(
    ("change", "name", "outcome"),
    [({"joints": np.full((5, 6), np.nan), "end_effector": None}, "all values are finite", "fail"),
     ({"timestamps_s": np.array([0.0, 0.2, 0.2, 0.4])}, "time increases", "fail"),
     ({"lengths": {"joints": 9, "action": 8}}, "streams of an episode are equally long", "differs"),
     ({"joints": np.full((5, 6), 3.0), "end_effector": None}, "joints stay within PIPER's limits", "differs"),
     ({"timestamps_s": np.arange(4.0)}, "every timestep has its frames", "fail"),
     ({"notes": ("guessed",)}, "nothing had to be assumed", "differs"), ])
def test_each_check_can_fail(sample, change, name, outcome):
    assert outcomes(sample)[name] == "pass"
    assert outcomes(spoil(sample, **change))[name] == outcome


def test_unread_and_unknown_units_fail(sample):
    assert outcomes(dataclasses.replace(sample, unread=("a: broken",)))["every chosen episode can be read"] == "fail"
    units = sample.units.assign(unit="unknown")
    assert outcomes(dataclasses.replace(sample, units=units))["all units are known"] == "fail"


def test_a_tool_offset_is_seen(sample):
    shifted = [dataclasses.replace(e, end_effector=e.end_effector + [0, 0, 0.15, 0, 0, 0]) for e in sample.episodes]
    check = {c.name: c for c in check_dataset(dataclasses.replace(sample, episodes=tuple(shifted)))}
    assert check["recorded pose agrees with PIPER's kinematics"].outcome == "differs"
    assert "15.0 cm" in check["recorded pose agrees with PIPER's kinematics"].detail


@pytest.mark.parametrize(("timesteps", "outcome"), [(35_000, "pass"), (34_000, "pass"), (75_900, "pass"),
                                                    (50_000, "differs"), (float("nan"), "not checked")])
def test_sizes_of_the_paper(sample, timesteps, outcome):
    data = dataclasses.replace(sample, contents=sample.contents.assign(timesteps=float(timesteps)))
    assert outcomes(data)["static_sample: size is one of the paper's"] == outcome


def test_mean_length_of_the_paper(sample):
    long = [dataclasses.replace(e, timestamps_s=np.arange(459.0)) for e in sample.episodes if e.method == "static"]
    assert outcomes(dataclasses.replace(sample, episodes=tuple(long)))["static: mean length is the paper's"] == "pass"


def test_flange_at_zero_is_the_makers():
    """The maker's controller shows (56.1, 0, 213.3) mm and 85 degrees when all joints are zero."""
    at_zero = forward_kinematics(np.zeros((1, 6)))[0]
    np.testing.assert_allclose(at_zero, [0.0561, 0, 0.2133, 0, np.deg2rad(85), 0], atol=1e-4)


def test_transforms_are_rigid_and_turn_with_the_base():
    rng = np.random.default_rng(0)
    joints = rng.uniform(LIMITS_RAD[:, 0], LIMITS_RAD[:, 1], (20, 6))
    turn = flange_transform(joints)[:, :3, :3]
    np.testing.assert_allclose(turn @ np.swapaxes(turn, 1, 2), np.tile(np.eye(3), (20, 1, 1)), atol=1e-12)
    turned = joints + [0.3, 0, 0, 0, 0, 0]
    here, there = forward_kinematics(joints), forward_kinematics(turned)
    np.testing.assert_allclose(np.hypot(here[:, 0], here[:, 1]), np.hypot(there[:, 0], there[:, 1]), atol=1e-12)
    np.testing.assert_allclose(here[:, 2], there[:, 2], atol=1e-12)


def test_reach_gets_there_within_the_limits():
    points = np.array([[0.25, 0.0, 0.26], [0.3, 0.3, 0.15], [0.1, -0.4, 0.2], [0.5, 0.1, 0.15]])
    joints = reach(points)
    np.testing.assert_allclose(forward_kinematics(joints)[:, :3], points, atol=0.01)
    assert (joints >= LIMITS_RAD[:, 0]).all() and (joints <= LIMITS_RAD[:, 1]).all()


def test_tracking_finds_the_speed_the_sample_was_made_with(sample):
    places = object_places(sample.episodes, "cam_global")
    table = object_speeds(places, metres_per_pixel=sample.about["metres_per_pixel"])
    mean = table.groupby("method")["mean_speed"].mean()
    assert mean["move"] == pytest.approx(0.06, rel=0.05) and mean["static"] < 0.005
    assert set(object_speeds(places)["unit"]) == {"px"} and object_places(sample.episodes, "no such camera").empty
    assert sample.episodes[0].cameras["cam_global"].read([0]).shape == (1, *SIZE, 3)
    shares = {method: seen_share(rows) for method, rows in equal_budget(places).groupby("method")}
    assert shares["move"] > 1.5 * shares["static"], "a moving orange is seen in more places"


def test_paper_numbers_agree_with_themselves():
    for cell in TABLE3_REAL.itertuples():
        assert 100 * cell.successes / 30 == pytest.approx(cell.printed_success_percent, abs=0.05)
        assert cell.score / 90 == pytest.approx(cell.printed_score, abs=0.001)
