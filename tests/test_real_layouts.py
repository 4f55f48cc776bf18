"""Every layout is read back to the numbers that were written."""

import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import real_writers as w
import zarr

from move import paths
from move.errors import BadInput
from move.learn import dataset
from move.realworld import check_dataset, open_dataset
from move.realworld.detect import detect
from move.sim.demonstrations import Demonstrations


def expect_reds(frames: np.ndarray, numbers, tolerance: float = 6) -> None:
    """The pictures with these numbers, red first."""
    assert frames.dtype == np.uint8 and frames.shape[-1] == 3
    assert frames[..., 0].mean(axis=(1, 2)) == pytest.approx([40 + 30 * n for n in numbers], abs=tolerance)
    assert frames[..., 2].mean() < 40, "blue and red are exchanged"


STATE, POSE, HALF = w.state(), w.pose(), slice(None, None, 2)
MASTER = STATE + 0.01
READ = {  # layout: writer, joints, pose, gripper, action, camera with a frame's number, what a note says
    "LeRobot v2.1": (lambda f: w.lerobot_v2(f, codec="libx264"), STATE[:, :6], None, STATE[:, 6], STATE, ("wrist", 3),
                     ""),
    "LeRobot v2.1, AV1": (lambda f: w.lerobot_v2(f, codec="libsvtav1"), STATE[:, :6], None, STATE[:, 6], STATE,
                          ("wrist", 4), ""),
    "LeRobot v2.1, images in the table": (lambda f: w.lerobot_v2(f, image_column=True), STATE[:, :6], None, STATE[:, 6],
                                          STATE, ("front", 5), ""),
    "LeRobot v2.1, plain lists": (lambda f: w.lerobot_v2(f, dtype=np.float64, fixed=False), STATE[:, :6], None,
                                  STATE[:, 6], STATE, None, ""),
    "LeRobot v3.0": (lambda f: w.lerobot_v3(f, codec="libsvtav1"), STATE[:, :6], None, STATE[:, 6], STATE, ("wrist", 2),
                     ""),
    "Pika tree": (w.pika_tree, STATE[:, :6], POSE, STATE[:, 6], MASTER, ("pikaGripperDepthCamera", 4), ""),
    "Pika tree without sync.txt": (lambda f: w.pika_tree(f, synced=False), STATE[HALF, :6], POSE[HALF], STATE[HALF, 6],
                                   MASTER[HALF], ("pikaGripperDepthCamera", 0), "sync.txt"),
    "Pika HDF5, images next to it": (w.pika_hdf5, STATE[:, :6], POSE, STATE[:, 6], MASTER, ("cam", 2), ""),
    "Pika HDF5, images in it": (lambda f: w.pika_hdf5(f, by_path=False), STATE[:, :6], POSE, STATE[:, 6], MASTER,
                                ("cam", 5), "depth is 8-bit"),
    **{f"ACT, {images}": (lambda f, images=images: w.act_hdf5(f, images=images), STATE[:, :6], None, STATE[:, 6], STATE,
                          ("top", 3), "30 Hz assumed") for images in ("HWC", "CHW", "padded", "vlen")},
    "ACT, two arms": (lambda f: w.act_hdf5(f, arms=2), STATE[:, :6], None, STATE[:, 6], None, ("top", 3),
                      "the right one moves most"),
    "RoboMIND": (w.robomind_hdf5, STATE[:-1, :6], POSE[:-1], STATE[:-1, 6], MASTER[:-1], ("camera_top", 4), "gripper"),
    "RoboMIND, two arms": (lambda f: w.robomind_hdf5(f, two_arms=True), STATE[:-1, :6], POSE[:-1], STATE[:-1, 6],
                           MASTER[:-1], ("camera_top", 4), "the right one moves most"),
    **{f"zarr {number}, {'zip' if zipped else 'folder'}": (
        lambda f, number=number, zipped=zipped: w.zarr_buffer(f, zarr_format=number, zipped=zipped),
        w.joints(0, 10)[:6], w.pose(10)[:6], None, w.state(0, 10)[:6], None, "as roll, pitch, yaw") for number in (2, 3)
       for zipped in (False, True)},
    "authors' zarr": (lambda f: w.zarr_buffer(f, simulation=True), None, None, None, w.state(0, 10)[:6], ("img", 5),
                      "simulation data"),
}


@pytest.mark.filterwarnings("ignore::UserWarning")  # zarr's, while the zip is written
@pytest.mark.parametrize("layout", READ)
def test_each_layout_is_read_back_to_what_was_written(tmp_path, layout):
    write, joints, pose, gripper, action, camera, note = READ[layout]
    e = open_dataset(write(tmp_path / "set")).episodes[0]
    for found, wanted in ((e.joints, joints), (e.end_effector, pose), (e.gripper, gripper)):
        assert (found is None) == (wanted is None)
        if wanted is not None:
            np.testing.assert_allclose(found, wanted, atol=1e-6)
    if action is not None:
        np.testing.assert_allclose(e.action, action, atol=1e-6)
    assert bool(e.notes) == bool(note) and note in " ".join(e.notes)
    if camera is not None:
        expect_reds(e.cameras[camera[0]].read([camera[1]]), [camera[1] * (2 if "sync" in layout else 1)])


@pytest.mark.parametrize(("write", "index", "joints", "red"), [
    (lambda f: w.lerobot_v2(f, codec="libx264"), 1, w.joints(1), 4), (w.lerobot_v3, 2, w.joints(2), 5),
    (w.zarr_buffer, 1, w.joints(0, 10)[6:], None)])
def test_a_later_episode_has_its_own_rows_frames_and_times(tmp_path, write, index, joints, red):
    (e,) = open_dataset(write(tmp_path / "set"), episodes=[index]).episodes
    np.testing.assert_allclose(e.joints, joints, atol=1e-6)
    np.testing.assert_allclose(e.timestamps_s, np.arange(len(joints)) / 10, atol=1e-6)
    for frames in e.cameras.values():
        expect_reds(frames.read([3]), [red])


@pytest.mark.parametrize("name", ["timestamp", "timestamps", "observations/timestamp", "observations/timestamps"])
def test_times_of_act_are_read_under_each_of_their_names(tmp_path, name):
    with h5py.File(w.act_hdf5(tmp_path / "d") / "episode_0.hdf5", "a") as file:
        file[name] = np.arange(w.STEPS) / 4
    (e,) = open_dataset(tmp_path / "d").episodes
    np.testing.assert_allclose(e.timestamps_s, np.arange(w.STEPS) / 4)
    assert not any("no timestamps" in note for note in e.notes)


@pytest.mark.parametrize(("names", "key"), [([w.NAMES], "names"), ({"motors": w.NAMES}, "names"), (w.NAMES, "name"),
                                            (None, "names")])
def test_names_in_every_form(tmp_path, names, key):
    e = open_dataset(w.lerobot_v2(tmp_path / "d", names=names, key=key)).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints(), atol=1e-6)
    assert bool(e.notes) == (names is None), "an assumed order must be noted"


@pytest.mark.parametrize(("parts", "names", "note"), [
    ((w.state, lambda n: w.pose()), None, "order assumed"),
    ((lambda n: w.pose(), lambda n: w.state()[:, 6:]), ["x", "y", "z", "roll", "pitch", "yaw", "gripper"], "")])
def test_a_pose_next_to_joints_or_alone(tmp_path, parts, names, note):
    folder = w.lerobot_v2(tmp_path / "d", values=lambda n: np.hstack([part(n) for part in parts]), names=names)
    e = open_dataset(folder).episodes[0]
    np.testing.assert_allclose(e.end_effector, w.pose(), atol=1e-6)
    assert (e.joints is None) == (not note) and note in " ".join(e.notes)


def test_streams_of_unequal_length_are_cut_to_the_shortest(tmp_path):
    data = open_dataset(w.robomind_hdf5(tmp_path / "d"))
    assert data.episodes[0].lengths == {"joints": 6, "gripper": 6, "end_effector": 6, "action": 5}
    assert np.diff(data.episodes[0].timestamps_s) == pytest.approx(0.1)
    assert data.contents["part"].tolist() == ["put_orange/success_episodes"]


def test_several_parts_and_numbers_of_episodes(tmp_path):
    w.lerobot_v2(tmp_path / "static_35k", episodes=3)
    w.lerobot_v2(tmp_path / "move_35k", episodes=3)
    data = open_dataset(tmp_path, episodes=2)
    assert data.contents["method"].tolist() == ["move", "static"]
    assert data.contents["episodes_read"].tolist() == [2, 2] and data.contents["timesteps"].tolist() == [18, 18]
    assert [e.method for e in data.episodes] == ["move", "move", "static", "static"]
    for episodes, says in (([7], "has no episode 7"), (0, "episodes=0")):
        with pytest.raises(BadInput, match=says):
            open_dataset(tmp_path, episodes=episodes)


def test_what_cannot_be_read_is_named_and_the_rest_is_read(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", codec="libx264")
    path, video = (next(folder.rglob(f"episode_00000{name}")) for name in ("0.parquet", "1.mp4"))
    path.write_bytes(path.read_bytes()[:200])
    video.write_bytes(video.read_bytes()[:60])
    data = open_dataset(folder)
    assert [e.index for e in data.episodes] == [1]
    assert len(data.unread) == 1 and "episode_000000.parquet" in data.unread[0] and "\n" not in data.unread[0]
    with pytest.raises(BadInput, match=r"episode_000001\.mp4: expected the frames of a camera"):
        data.episodes[0].cameras["wrist"].read([0])
    shutil.copy(path, folder / "data/chunk-000/episode_000001.parquet")
    with pytest.raises(BadInput, match=r"episode_000000\.parquet: expected a parquet table"):
        open_dataset(folder)


def test_a_git_lfs_pointer_is_called_one(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", episodes=1)
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"
    (folder / "data/chunk-000/episode_000000.parquet").write_text(pointer)
    with pytest.raises(BadInput, match="run `git lfs pull`"):
        open_dataset(folder)


@pytest.mark.parametrize("numbers", [[6], [-1], [2, 1], []])
def test_frames_outside_the_episode_are_refused(tmp_path, numbers):
    frames = open_dataset(w.act_hdf5(tmp_path / "d")).episodes[0].cameras["top"]
    with pytest.raises(BadInput, match=r"allowed are increasing numbers in 0\.\.5"):
        frames.read(numbers)


def test_unknown_content_names_what_was_found(tmp_path):
    (tmp_path / "data.tar.gz").write_bytes(b"x")
    (tmp_path / "README.md").write_text("x")
    with pytest.raises(BadInput, match=r"found 2 files .*README.md.*unpack data.tar.gz first.*expected meta/info.json"):
        open_dataset(tmp_path)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["strange/thing"] = 1
    with pytest.raises(BadInput, match=r"found groups \['strange'\]; expected arm/"):
        open_dataset(tmp_path)


def test_neither_folder_nor_repository_and_a_folder_with_a_revision(tmp_path):
    with pytest.raises(BadInput, match="no folder on this machine, and no owner/name"):
        open_dataset("./nowhere/at/all")
    with pytest.raises(BadInput, match="a folder has no revision"):
        open_dataset(tmp_path, revision="a" * 40)


@pytest.mark.parametrize(("files", "parts"), [
    (["static/data/episode_0.hdf5", "move/data/episode_0.hdf5", "t/success_episodes/1017/data/trajectory.hdf5"],
     [("move/data", "hdf5", 1), ("static/data", "hdf5", 1), ("t/success_episodes", "hdf5", 1)]),
    (["episode0/data.hdf5", "episode1/data.hdf5"], [(".", "hdf5", 2)]),
    (["1/data/trajectory.hdf5", "2/data/trajectory.hdf5"], [(".", "hdf5", 2)]),
    (["episode0/data.hdf5", "episode0/camera/color/cam/1.jpg", "episode0/arm/jointState/puppet/1.json"],
     [(".", "hdf5", 3)]),  # a raw tree next to an HDF5 file is its image store
])
def test_parts_are_told_apart_by_their_names_alone(tmp_path, files, parts):
    assert [(part.name, part.layout, len(part.files)) for part in detect(files, tmp_path)] == parts


def test_the_method_comes_from_the_folder_or_from_the_reader(tmp_path):
    assert open_dataset(w.act_hdf5(tmp_path / "static_35k")).contents["method"].tolist() == ["static"]
    whole = w.act_hdf5(tmp_path / "MOVE")
    assert open_dataset(whole).contents["method"].tolist() == ["unknown"], "the repository's own name tells nothing"
    (tmp_path / "units.yaml").write_text('"*": {method: static}')
    data = open_dataset(whole, units_file=tmp_path / "units.yaml")
    assert data.episodes[0].method == "static" and data.contents["method"].tolist() == ["static"]


@pytest.mark.parametrize("layout", w.LAYOUTS)
def test_the_how_to_pages_ten_lines_make_a_buffer_of_every_layout(tmp_path, layout):
    page = (paths.ROOT / "docs/how-to/use_your_own_demonstrations.md").read_text(encoding="utf-8")
    lines = next(block for block in re.findall(r"```python\n(.*?)```", page, flags=re.S) if "open_dataset(" in block)
    assert len(lines.splitlines()) <= 10
    w.LAYOUTS[layout](tmp_path / "mine_lerobot")
    for name in ("mine_lerobot", "from_lerobot.zarr"):
        assert f'"build/{name}"' in lines
        lines = lines.replace(f'"build/{name}"', f'"{tmp_path}/{name}"')
    exec(lines, {"np": np, "Path": Path, "open_dataset": open_dataset, "dataset": dataset,
                 "Demonstrations": Demonstrations})
    data = open_dataset(tmp_path / "mine_lerobot", episodes=None)
    made, _ = dataset.load(tmp_path / "from_lerobot.zarr")
    assert made.episode_ends.tolist() == np.cumsum([e.timesteps for e in data.episodes]).tolist()
    np.testing.assert_allclose(made.observations, np.concatenate([e.state for e in data.episodes]), rtol=1e-6)
    np.testing.assert_allclose(made.actions, np.concatenate([e.action for e in data.episodes]), rtol=1e-6)


@pytest.mark.parametrize(("write", "state"), [
    (w.pika_tree, np.hstack([w.state(), w.pose()])), (w.zarr_buffer, np.hstack([w.joints(0, 10)[:6], w.pose(10)[:6]]))])
def test_the_state_of_layouts_without_one_is_all_that_the_arm_told(tmp_path, write, state):
    np.testing.assert_allclose(open_dataset(write(tmp_path / "d")).episodes[0].state, state, atol=1e-12)


@pytest.mark.parametrize(("second", "read"), [(lambda g: g, True), (lambda g: g + 1e-10, True),
                                              (lambda g: -g, False), (lambda g: 0 * g, False)])
def test_a_zarr_gripper_of_two_fingers_is_one_where_they_are_alike(tmp_path, second, read):
    folder, gripper = w.zarr_buffer(tmp_path / "d"), np.linspace(0.01, 0.04, 10)
    zarr.open_group(str(folder / "replay_buffer.zarr"), mode="a").create_array(
        "data/gripper", data=np.column_stack([gripper, second(gripper)]))
    episode = open_dataset(folder).episodes[0]
    assert (episode.gripper is not None) == read
    assert any("2 columns that differ" in note for note in episode.notes) != read


def in_arms(folder, names):
    """Rename the arms of a Pika HDF5 episode; all but the first move."""
    with h5py.File(folder / "episode0/data.hdf5", "a") as file:
        for name in ("puppet", "master"):
            del file[f"arm/jointStatePosition/{name}"]
        for number, name in enumerate(names):
            file[f"arm/jointStatePosition/{name}"] = w.state() + number / 10


@pytest.mark.parametrize(("names", "read", "action", "note"), [
    (["puppetLeft", "puppetRight", "masterLeft"], 0, 2, "of puppetLeft, puppetRight puppetLeft is read"),
    (["master_right", "puppet_right"], 1, 0, ""), (["master"], 0, 0, "master, the leader, is read"),
    (["puppet", "master"], 0, 1, "")])
def test_of_pikas_arms_the_one_that_follows_is_read_and_others_are_named(tmp_path, names, read, action, note):
    in_arms(folder := w.pika_hdf5(tmp_path / "d"), names)
    episode = open_dataset(folder).episodes[0]
    np.testing.assert_allclose(episode.joints, (w.state() + read / 10)[:, :6])
    np.testing.assert_allclose(episode.action, w.state() + action / 10)
    assert any(note in each for each in episode.notes) if note else not episode.notes


def test_a_pose_with_a_quaternion_is_not_read_as_angles(tmp_path):
    folder, turned = w.pika_hdf5(tmp_path / "d"), np.tile([0.2, 0.1, 0.3, 0.5, 0.5, 0.5, 0.5], (w.STEPS, 1))
    with h5py.File(folder / "episode0/data.hdf5", "a") as file:
        del file["arm/endPose/puppet"]
        file["arm/endPose/puppet"] = turned
    episode = open_dataset(folder).episodes[0]
    assert episode.end_effector is None and "the pose has a quaternion: not read" in episode.notes


def test_hdf5_episodes_have_the_numbers_of_their_files(tmp_path):
    folder = w.act_hdf5(tmp_path / "d")
    for number in (2, 10):
        with h5py.File(folder / "episode_0.hdf5") as one, h5py.File(folder / f"episode_{number}.hdf5", "w") as other:
            for name in one:
                one.copy(name, other)
            other["observations/qpos"][:] += number / 100
    episodes = open_dataset(folder, episodes=[2, 10]).episodes
    assert [episode.index for episode in episodes] == [2, 10]
    np.testing.assert_allclose(episodes[0].joints, w.joints() + 0.02, atol=1e-6)


def test_a_gripper_without_columns_is_refused_in_a_line(tmp_path):
    folder = w.zarr_buffer(tmp_path / "d")
    zarr.open_group(str(folder / "replay_buffer.zarr"), mode="a").create_array("data/gripper", data=np.empty((10, 0)))
    with pytest.raises(BadInput, match="gripper is float64"):
        open_dataset(folder)


def test_fewer_names_of_images_than_timesteps_are_told(tmp_path):
    folder = w.pika_hdf5(tmp_path / "d")
    with h5py.File(folder / "episode0/data.hdf5", "a") as file:
        del file["camera/color/cam"]
        names = [f"camera/color/cam/{1_700_000_000 + n / 30}.jpg" for n in range(4)]
        file["camera/color/cam"] = np.array([name.encode() for name in names])
    assert {check.name: check.outcome for check in check_dataset(open_dataset(folder))}[
        "every timestep has its frames"] == "differs"
