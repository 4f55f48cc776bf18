"""The checks find what is wrong and pass what is right; the sample is honest about itself; the arm's kinematics."""

import dataclasses
import json
import shutil
import warnings

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
import real_writers as w
import zarr
from shared import full_disk

from move.errors import BadInput
from move.paper import TABLE3_REAL
from move.realworld import check_dataset, checks_table, open_dataset, write_sample
from move.realworld.episode import RobotEpisode
from move.realworld.piper import LIMITS_RAD, flange_transform, forward_kinematics, reach
from move.realworld.sample import SIZE
from move.realworld.tracking import object_places, object_speeds, seen_share
from move.realworld.workspace import action_table, coverage_by_method, equal_budget, path_table


@pytest.fixture(scope="session")
def sample(tmp_path_factory):
    """The bundled sample with six demonstrations of each method in place of twenty, opened."""
    return open_dataset(write_sample(tmp_path_factory.mktemp("real") / "sample", episodes=6), episodes=None)


def outcomes(data) -> dict[str, str]:
    return {check.name: check.outcome for check in check_dataset(data)}


def test_the_sample_says_that_it_is_simulated(sample):
    assert sample.simulated and "toy" in sample.about["what"]
    assert sample.contents.set_index("method").episodes.to_dict() == {"move": 6, "static": 6}
    assert sum(path.stat().st_size for path in sample.folder.rglob("*") if path.is_file()) < 300_000


def test_the_sample_passes_all_but_the_papers_sizes(sample):
    table = checks_table(check_dataset(sample))
    assert list(table.columns) == ["name", "outcome", "detail"]
    assert set(table.loc[table["outcome"] != "pass", "name"]) == {
        "move_sample: size is one of the paper's", "static_sample: size is one of the paper's",
        "move: mean length is the paper's", "static: mean length is the paper's", "a robot was involved",
        "no chunk of an array is missing", "streams belong to the same time",
    }


def test_the_sample_is_a_function_of_its_seed(tmp_path):
    a, b, c = (open_dataset(write_sample(tmp_path / name, seed=seed, episodes=1))
               for name, seed in (("a", 1), ("b", 1), ("c", 2)))
    for x, y in zip(a.episodes, b.episodes, strict=True):
        np.testing.assert_array_equal(x.joints, y.joints)
        np.testing.assert_array_equal(x.cameras["cam_global"].read([0, 9]), y.cameras["cam_global"].read([0, 9]))
    assert not np.array_equal(a.episodes[0].joints[:20], c.episodes[0].joints[:20])
    before = (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns
    write_sample(tmp_path / "a", seed=1, episodes=1)
    assert (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns == before, "an existing sample is kept"
    assert len(open_dataset(write_sample(tmp_path / "a", seed=1, episodes=2)).episodes) == 4
    larger = (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns
    write_sample(tmp_path / "a", seed=1, episodes=1)
    assert (tmp_path / "a/SIMULATED.json").stat().st_mtime_ns == larger, "and one with more"


@pytest.mark.parametrize("text", ["{", "[]", "null", '{"episodes": "many"}', '{"seed": 7}', ""])
def test_a_sample_that_does_not_say_what_it_is_is_written_anew(tmp_path, text):
    folder = write_sample(tmp_path / "a", seed=7, episodes=1)
    mark, table = folder / "SIMULATED.json", folder / "move_sample" / V2.format(0)
    said, rows = mark.read_text(), table.read_bytes()
    mark.write_text(text)
    table.write_bytes(rows[:100])
    write_sample(folder, seed=7, episodes=1)
    assert mark.read_text() == said and table.read_bytes() == rows and [*tmp_path.iterdir()] == [folder]


def test_a_sample_is_written_whole_or_not_at_all_and_never_over_something_else(tmp_path, monkeypatch):
    folder = write_sample(tmp_path / "a", seed=1, episodes=1)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    monkeypatch.setattr("move.realworld.sample.write_video", full_disk)
    for place in (folder, tmp_path / "b"):
        with pytest.raises(BadInput, match="cannot write .*: No space left on device"):
            write_sample(place, seed=1, episodes=2)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
    (tmp_path / "c").mkdir()
    (tmp_path / "c/thesis.tex").write_text("mine")
    with pytest.raises(BadInput, match="c holds thesis.tex, and no sample; allowed is a new folder"):
        write_sample(tmp_path / "c")
    assert (tmp_path / "c/thesis.tex").read_text() == "mine"


V2, V3 = "data/chunk-000/episode_{:06d}.parquet", "data/chunk-000/file-000.parquet"


VIDEO = "videos/chunk-000/observation.images.wrist/episode_{:06d}.mp4"


def v2(folder, **options):
    return w.lerobot_v2(folder, episodes=3, codec="libx264", **options)


def v2_of_60(folder):
    return v2(folder, values=lambda n: w.state(n, 60))


def v2_table(**columns):
    """Change columns of the second episode's table."""
    return lambda folder: w.change_table(folder / V2.format(1), **columns)


def in_hdf5(change):
    def make(folder):
        with h5py.File(next(folder.rglob("*.hdf5")), "a") as file:
            change(file)

    return make


def names_of_images(names):
    def make(file):
        del file["camera/color/cam"]
        file["camera/color/cam"] = np.array([name.encode() for name in names])

    return make


def in_zarr(name, values):
    def make(folder):
        group = zarr.open_group(str(folder / "replay_buffer.zarr"), mode="a")
        if name in group:
            del group[name]
        group.create_array(name, data=values)

    return make


def about(**values):
    return lambda folder: w.change_json(folder / "meta/info.json", **values)


def never_written(file):
    del file["action"]
    file.create_dataset("action", (6, 7), np.float32, chunks=(3, 7))[:3] = 1.0


def sync(sensor, change):
    def make(folder):
        path = folder / f"episode0/{sensor}/sync.txt"
        path.write_text("\n".join(change(path.read_text().split("\n"))))

    return make


def lengths(*numbers):
    return lambda folder: (folder / "meta/episodes.jsonl").write_text("".join(
        json.dumps({"episode_index": n, "tasks": ["t"], "length": length}) + "\n" for n, length in enumerate(numbers)))


def fewer_rows(name):
    def change(folder):
        place = folder / f"replay_buffer.zarr/data/{name}/.zarray"
        w.change_json(place, shape=[8, *json.loads(place.read_text())["shape"][1:]])

    return change


def swapped_rows(folder):
    table = pq.read_table(folder / V3)
    pq.write_table(table.take([*range(6), 7, 6, *range(8, 18)]), folder / V3)


STEPS, TIME = np.arange(w.STEPS), "data/timestamp"
FINITE, ORDER, EQUAL = "all values are finite", "timesteps are numbered in order", "no two episodes are equal"
INDICES, WHOLE = "indices count on from episode to episode", "everything is of an episode"
STATED, CHUNKS = "episodes are as long as stated", "no chunk of an array is missing"
SPOILT = {  # what is wrong: who writes it, what is changed, which check finds it, what it says
    "another episode's number": (v2, v2_table(episode_index=np.full(6, 2)), ORDER, "episode_index 2 at timestep 0"),
    "numbers of timesteps with a gap": (v2, v2_table(frame_index=STEPS + (STEPS > 3)), ORDER, "frame_index 5 at"),
    "an episode over another, renumbered": (
        v2, lambda folder: w.change_table(shutil.copy(folder / V2.format(0), folder / V2.format(2)),
                                          episode_index=np.full(6, 2)), EQUAL, "./2 equals ./0"),
    "a video over another": (v2, lambda folder: shutil.copy(folder / VIDEO.format(0), folder / VIDEO.format(2)), EQUAL,
                             "1: the video ./2 wrist equals ./0 wrist"),
    "longer than it is": (v2, lengths(6, 60, 6), STATED, "./1 6 timesteps of 60"),
    "shorter than it is": (v2, lengths(6, 6, 2), STATED, "./2 6 timesteps of 2"),
    "time that runs back": (v2, v2_table(timestamp=STEPS[::-1] / 10), "time increases", "./1"),
    "joints that are no number": (
        v2, v2_table(**{"observation.state": [*w.state(1).tolist()[:5], [np.nan] * 7]}), FINITE, "./1 joints 1"),
    "time that is no number": (v2, v2_table(timestamp=[0, np.nan, 0.2, 0.3, 0.4, 0.5]), FINITE, "timestamps 1"),
    "rows in another order": (w.lerobot_v3, swapped_rows, "nothing had to be assumed", "order of frame_index"),
    "another part of a shared table": (w.lerobot_v3, lambda folder: w.change_table(
        folder / V3, index=[*range(6), *range(7, 13), *range(12, 17), 99]), ORDER, "index 99 at timestep 5"),
    "ACT never written": (w.act_hdf5, in_hdf5(never_written), CHUNKS, "/action has 1 of its 2 chunks"),
    "ACT simulated": (w.act_hdf5, in_hdf5(lambda file: file.attrs.__setitem__("sim", True)), "a robot was involved",
                      "say that they are simulated"),
    "ACT simulated, in a list": (w.act_hdf5, in_hdf5(lambda file: file.attrs.__setitem__("sim", [True])),
                                 "a robot was involved", "say that they are simulated"),
    "Pika time runs back": (w.pika_tree, sync("camera/color/pikaGripperDepthCamera", lambda lines: lines[::-1]),
                            "time increases", "./0"),
    "Pika arm runs back": (w.pika_tree, sync("arm/jointState/puppet", lambda lines: lines[::-1]),
                           "streams belong to the same time", "joints"),
    "Pika gripper stands still": (w.pika_tree, sync("gripper/encoder/pikaGripper", lambda lines: lines[2:3] * 6),
                                  "streams belong to the same time", "gripper"),
    "zarr chunk": (w.zarr_buffer, lambda folder: (folder / "replay_buffer.zarr/data/robot_joint/1.0").unlink(), CHUNKS,
                   "data/robot_joint has 2 of its 3 chunks"),
    "zarr rows": (w.zarr_buffer, fewer_rows("action"), STATED, "2 timesteps of 4"),
    "zarr streams": (w.zarr_buffer, fewer_rows("action"), "streams of an episode are equally long", "action 2"),
    "timesteps that were not recorded": (v2, v2_table(timestamp=(STEPS + 4 * (STEPS > 1)) / 10),
                                         "the rate is the stated one", "./1 lacks 0.4 s after timestep 1"),
    "a clock that runs 4 % slow": (v2_of_60, v2_table(timestamp=np.arange(60) / 10 * 1.04),
                                   "the rate is the stated one", "drifts by 0.24 s from 10 Hz"),
    "a rate of no robot": (v2, about(fps=10_000), "the rate is the stated one", "states 10000 Hz, its steps take 0.1"),
    "a copy with noise": (v2, v2_table(**{name: w.vectors(np.float32(w.state(0) + 1e-7))
                                          for name in ("observation.state", "action")}),
                          "no two episodes are equal", "./1 equals ./0"),
    "Pika HDF5 images of other times": (
        w.pika_hdf5, in_hdf5(names_of_images([f"camera/color/cam/{1_700_000_009 + n}.5.jpg" for n in STEPS])),
        "streams belong to the same time", "camera cam"),
    "Pika HDF5 of another length": (w.pika_hdf5, in_hdf5(lambda file: file["size"].write_direct(np.array(9))),
                                    "episodes are as long as stated", "6 timesteps of 9"),
    "HDF5 episodes that are not there": (
        lambda folder: [w.act_hdf5(folder / "d"), folder][1],
        lambda folder: [shutil.copy(folder / "d/episode_0.hdf5", folder / f"d/episode_{n}.hdf5") for n in (2, 10)],
        WHOLE, "8: d: no episode 1; d: no episode 3"),
    "indices of another episode": (v2, v2_table(index=STEPS + 3), INDICES, "./1 begins at 3, ./0 ends at 5"),
    "indices of a shared table twice": (w.lerobot_v3, lambda folder: w.change_table(
        folder / V3, index=[*STEPS, *STEPS, *STEPS]), INDICES, "2: ./1 begins at 0, ./0 ends at 5"),
    "episodes of a shared table in another order": (w.lerobot_v3, lambda folder: w.change_table(
        folder / V3, episode_index=np.repeat([2, 1, 0], w.STEPS)), INDICES, "2: ./1 begins at 6, ./0 ends at 17"),
    "more episodes stated": (v2, about(total_episodes=4), WHOLE, ".: 4 episodes are stated, 3 are listed"),
    "fewer timesteps stated": (w.lerobot_v3, about(total_frames=17), WHOLE,
                               ".: 17 timesteps are stated, 18 are listed"),
    "an episode that is not listed": (v2, lengths(6, 6), WHOLE, "episode_000002.parquet is of no listed episode"),
    "a shared table that is not listed": (w.lerobot_v3, lambda folder: shutil.copy(
        folder / V3, folder / V3.replace("file-000", "file-001")), WHOLE, "file-001.parquet is of no listed episode"),
    "zarr rows behind the last episode": (w.zarr_buffer, in_zarr("meta/episode_ends", np.array([3, 8])), WHOLE,
                                          "data/action has 10 timesteps, the episodes end at 8"),
    "zarr rows of one array more": (w.zarr_buffer, in_zarr("data/robot_joint", w.joints(0, 13)), WHOLE,
                                    "1: replay_buffer.zarr: data/robot_joint has 13 timesteps, the episodes end at 10"),
}


@pytest.mark.parametrize("what", SPOILT)
def test_each_check_finds_what_is_wrong_in_whatever_layout(tmp_path, what):
    write, change, name, says = SPOILT[what]
    folder = write(tmp_path / "d")
    before = outcomes(open_dataset(folder))[name]
    assert before != "differs"
    change(folder)
    check = {check.name: check for check in check_dataset(open_dataset(folder))}[name]
    assert check.outcome == "differs" and says in check.detail, check


@pytest.mark.parametrize("layout", w.LAYOUTS)
def test_every_layout_has_the_same_checks_and_passes_none_for_want_of_a_quantity(tmp_path, layout):
    data = open_dataset(w.LAYOUTS[layout](tmp_path / "d"))
    table = checks_table(check_dataset(data)).set_index("name")
    assert len(table) == 20 and set(table["outcome"]) <= {"pass", "differs", "unknown"}
    wanted = {
        "episodes are as long as stated": [e for e in data.episodes if e.stated_timesteps],
        "timesteps are numbered in order": [e for e in data.episodes if e.numbering],
        "indices count on from episode to episode": [e for e in data.episodes if "index" in e.numbering][1:],
        "everything is of an episode": [1] if "LeRobot" in layout or "zarr" in layout else [],
        "no two episodes are equal": data.episodes[1:], "every timestep has its frames": data.episodes[0].cameras,
        "no chunk of an array is missing": [e for e in data.episodes if e.gaps is not None],
        "time increases": [e for e in data.episodes if e.timestamps is not None],
        "the rate is the stated one": [e for e in data.episodes if e.fps],
        "streams belong to the same time": [e for e in data.episodes if e.own_times],
        "all units are known": data.units.index, "joints stay within PIPER's limits": [
            e for e in data.episodes if e.robot == "piper"],
    }
    for name, there in wanted.items():
        assert (table.loc[name, "outcome"] == "unknown") == (len(there) == 0), name
    assert all(e.state is not None and len(e.state) == e.timesteps for e in data.episodes)


def test_a_data_set_without_a_quantity_passes_little(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", episodes=1)
    path = folder / V2.format(0)
    pq.write_table(pq.read_table(path).select(["action"]), path)
    w.change_json(folder / "meta/info.json", fps=None, robot_type=None)
    (folder / "meta/episodes.jsonl").unlink()
    table = checks_table(check_dataset(open_dataset(folder)))
    assert set(table.loc[table["outcome"] == "pass", "name"]) == {"every chosen episode can be read",
                                                                  "all values are finite"}
    assert (table["outcome"] == "unknown").sum() >= 12


def test_what_is_not_finite_is_left_out_and_named(tmp_path):
    values = w.state()
    values[2, 1], values[4, 6] = np.nan, np.inf
    data = open_dataset(w.lerobot_v2(tmp_path / "d", episodes=1, values=lambda n: values))
    steps = path_table(data.episodes)
    assert np.isnan(steps["x_m"]).tolist() == [False, False, True, False, False, False]
    assert coverage_by_method(steps)["visits"].sum() == 5 and len(action_table(data.episodes)) == 7
    assert dict(data.episodes[0].not_finite) == {"joints": 1, "gripper": 1, "action": 2, "state": 2}
    twice = open_dataset(w.lerobot_v2(tmp_path / "twice", episodes=2, values=lambda n: values))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert outcomes(twice)["no two episodes are equal"] == "differs"


def test_a_tool_offset_is_seen(sample):
    shifted = [dataclasses.replace(e, end_effector=e.end_effector + [0, 0, 0.15, 0, 0, 0]) for e in sample.episodes]
    check = {c.name: c for c in check_dataset(dataclasses.replace(sample, episodes=tuple(shifted)))}
    assert check["recorded pose agrees with PIPER's kinematics"].outcome == "differs"
    assert "15.0 cm" in check["recorded pose agrees with PIPER's kinematics"].detail


@pytest.mark.parametrize(("timesteps", "outcome"), [(35_000, "pass"), (34_000, "pass"), (75_900, "pass"),
                                                    (50_000, "differs"), (float("nan"), "unknown")])
def test_sizes_of_the_paper(sample, timesteps, outcome):
    data = dataclasses.replace(sample, contents=sample.contents.assign(timesteps=float(timesteps)))
    assert outcomes(data)["static_sample: size is one of the paper's"] == outcome


def test_mean_length_of_the_paper(sample):
    long = [RobotEpisode(part="p", index=n, source=".", method="static", timestamps_s=np.arange(459.0))
            for n in range(2)]
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


RIGHT = {  # write, change, check: nothing is wrong with it
    "a wall clock in the state": (lambda folder: v2(folder, names=[*w.NAMES, "wall_clock"], width=8, values=lambda n:
                                  np.column_stack([w.state(n), 1.7e9 + 60 * n + STEPS])), None,
                                  "no two episodes are equal"),
    "one late frame": (v2, v2_table(timestamp=STEPS / 10 + 0.06 * (STEPS == 3)), "the rate is the stated one"),
    "stamps rounded to 10 ms": (lambda folder: v2(folder, fps=30, values=lambda n: w.state(n, 60)), lambda folder: [
        w.change_table(folder / V2.format(n), timestamp=np.round(np.arange(60) / 30, 2)) for n in range(3)],
        "the rate is the stated one"),
    "images named by nine digits": (w.pika_hdf5, in_hdf5(names_of_images([
        f"camera/color/cam/{n:09d}.jpg" for n in STEPS])), "streams belong to the same time"),
}


@pytest.mark.parametrize("what", RIGHT)
def test_what_is_right_is_not_found_wrong(tmp_path, what):
    write, change, name = RIGHT[what]
    folder = write(tmp_path / "d")
    if change:
        change(folder)
    assert outcomes(open_dataset(folder))[name] != "differs"
