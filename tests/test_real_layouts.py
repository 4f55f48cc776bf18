"""Every layout is read back to the numbers that were written."""

import json
import re
import shutil
import warnings
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
import real_writers as w

from move import paths
from move.errors import BadInput
from move.learn import dataset
from move.realworld import open_dataset
from move.realworld.detect import detect
from move.realworld.state_columns import split_columns
from move.sim.demonstrations import Demonstrations


def red(frames: np.ndarray) -> np.ndarray:
    """Mean of the first channel of each frame."""
    return frames[..., 0].mean(axis=(1, 2))


def expect_reds(frames: np.ndarray, numbers, tolerance: float = 6) -> None:
    assert frames.dtype == np.uint8 and frames.shape[-1] == 3
    assert red(frames) == pytest.approx([40 + 30 * n for n in numbers], abs=tolerance)
    assert frames[..., 2].mean() < 40, "blue and red are exchanged"


@pytest.mark.parametrize("codec", ["libx264", "libsvtav1"])
def test_lerobot_v2_with_video(tmp_path, codec):
    data = open_dataset(w.lerobot_v2(tmp_path / "static_35k", codec=codec), episodes=None)
    assert [e.index for e in data.episodes] == [0, 1]
    e = data.episodes[1]
    np.testing.assert_allclose(e.joints, w.joints(1), atol=1e-6)
    np.testing.assert_allclose(e.gripper, w.state()[:, 6], atol=1e-6)
    np.testing.assert_allclose(e.timestamps_s, np.arange(6) / 10, atol=1e-6)
    assert e.gripper_unit == "m" and e.end_effector is None and e.notes == ()
    assert e.action_names == tuple(w.NAMES)
    assert len(e.cameras["wrist"]) == w.STEPS
    expect_reds(e.cameras["wrist"].read([1, 3, 4]), [1, 3, 4])


@pytest.mark.parametrize("names", [[w.NAMES], {"motors": w.NAMES}, None], ids=["nested", "motors", "missing"])
def test_names_in_every_form(tmp_path, names):
    data = open_dataset(w.lerobot_v2(tmp_path / "d", names=names))
    np.testing.assert_allclose(data.episodes[0].joints, w.joints(), atol=1e-6)
    assert bool(data.episodes[0].notes) == (names is None), "an assumed order must be noted"


def test_names_under_the_older_key(tmp_path):
    data = open_dataset(w.lerobot_v2(tmp_path / "d", key="name"))
    assert data.episodes[0].notes == () and data.episodes[0].joints.shape == (6, 6)


def test_float64_and_plain_lists(tmp_path):
    data = open_dataset(w.lerobot_v2(tmp_path / "d", dtype=np.float64, fixed=False))
    np.testing.assert_allclose(data.episodes[1].joints, w.joints(1), atol=1e-12)


def test_images_inside_the_parquet_file(tmp_path):
    data = open_dataset(w.lerobot_v2(tmp_path / "d", image_column=True))
    expect_reds(data.episodes[0].cameras["front"].read([0, 5]), [0, 5])


def test_agilex_order_of_joints_then_pose(tmp_path):
    def values(n):
        return np.hstack([w.state(n), w.pose()])

    data = open_dataset(w.lerobot_v2(tmp_path / "d", values=values, width=13, names=[["a"] * 14]))
    np.testing.assert_allclose(data.episodes[0].end_effector, w.pose(), atol=1e-6)
    assert "order assumed" in data.episodes[0].notes[0]


def test_pose_only_names(tmp_path):
    def values(n):
        return np.column_stack([w.pose(), w.state()[:, 6]])

    names = ["x", "y", "z", "roll", "pitch", "yaw", "gripper"]
    e = open_dataset(w.lerobot_v2(tmp_path / "d", values=values, names=names)).episodes[0]
    assert e.joints is None
    np.testing.assert_allclose(e.end_effector, w.pose(), atol=1e-6)


def test_robocoin_names():
    names = [f"right_arm_joint_{n}_rad" for n in range(1, 7)] + ["right_gripper_open_scale"]
    names += [f"right_eef_pos_{a}" for a in "xyz"] + [f"right_eef_rot_{a}" for a in "xyz"]
    arms, note = split_columns(names, 13)
    assert note is None and list(arms) == ["right"]
    assert arms["right"].joints == (0, 1, 2, 3, 4, 5)
    assert arms["right"].gripper == 6 and arms["right"].pose == (7, 8, 9, 10, 11, 12)


def test_lerobot_v3_slices_rows_and_video(tmp_path):
    data = open_dataset(w.lerobot_v3(tmp_path / "MOVE_75k", codec="libsvtav1"), episodes=[2])
    e = data.episodes[0]
    assert (e.index, len(data.episodes)) == (2, 1) and e.timesteps == w.STEPS
    np.testing.assert_allclose(e.joints, w.joints(2), atol=1e-6)
    expect_reds(e.cameras["wrist"].read([0, 2]), [2, 4])
    assert data.contents["timesteps"].tolist() == [18]


def test_pika_tree_synchronised(tmp_path):
    e = open_dataset(w.pika_tree(tmp_path / "static")).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints(), atol=1e-12)
    np.testing.assert_allclose(e.end_effector, w.pose(), atol=1e-12)
    np.testing.assert_allclose(e.gripper, w.state()[:, 6], atol=1e-12)
    np.testing.assert_allclose(e.action, w.state() + 0.01, atol=1e-12)
    assert e.notes == () and np.diff(e.timestamps_s) == pytest.approx(1 / 30, abs=1e-4)
    expect_reds(e.cameras["pikaGripperDepthCamera"].read([0, 4]), [0, 4])


def test_pika_tree_without_sync_is_aligned_by_time_and_says_so(tmp_path):
    e = open_dataset(w.pika_tree(tmp_path / "static", synced=False)).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints()[::2], atol=1e-12)
    assert any("sync.txt" in note for note in e.notes)


def test_pika_sync_cannot_leave_the_folder(tmp_path):
    folder = w.pika_tree(tmp_path / "static")
    sync = folder / "episode0/gripper/encoder/pikaGripper/sync.txt"
    sync.write_text(sync.read_text().replace(sync.read_text().split("\n")[0], "../../../../secret.json"))
    with pytest.raises(BadInput, match="leaves the data set's folder"):
        open_dataset(folder)


def test_pika_hdf5_with_images_beside_it(tmp_path):
    e = open_dataset(w.pika_hdf5(tmp_path / "d")).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints(), atol=1e-12)
    np.testing.assert_allclose(e.end_effector, w.pose(), atol=1e-12)
    np.testing.assert_allclose(e.action, w.state() + 0.01)
    expect_reds(e.cameras["cam"].read([1, 2]), [1, 2])


def test_pika_hdf5_pixels_are_blue_first_and_8_bit_depth_is_refused(tmp_path):
    e = open_dataset(w.pika_hdf5(tmp_path / "d", by_path=False)).episodes[0]
    expect_reds(e.cameras["cam"].read([0, 5]), [0, 5], tolerance=0)
    assert any("depth" in note for note in e.notes)


@pytest.mark.parametrize("name", ["../../secret/{}.jpg", "/etc/{}.jpg", "C:\\x\\{}.jpg"])
def test_paths_inside_an_hdf5_file_cannot_leave_it(tmp_path, name):
    with pytest.raises(BadInput, match="leaves the data set's folder"):
        open_dataset(w.pika_hdf5(tmp_path / "d", image_name=name))


def test_hdf5_link_to_another_file_is_refused(tmp_path):
    folder = w.act_hdf5(tmp_path / "d")
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["x"] = np.zeros(3)
    with h5py.File(folder / "episode_0.hdf5", "a") as file:
        file["observations/extra"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/x")
    with pytest.raises(BadInput, match="links to another file"):
        open_dataset(folder)


@pytest.mark.parametrize("images", ["HWC", "CHW", "padded", "vlen"])
def test_act_hdf5(tmp_path, images):
    e = open_dataset(w.act_hdf5(tmp_path / "d", images=images)).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints(), atol=1e-6)
    expect_reds(e.cameras["top"].read([0, 3]), [0, 3])
    assert any("30 Hz assumed" in note for note in e.notes)


def test_act_two_arms_reads_the_one_that_moves(tmp_path):
    e = open_dataset(w.act_hdf5(tmp_path / "d", arms=2)).episodes[0]
    np.testing.assert_allclose(e.joints, w.joints(), atol=1e-6)
    assert any("right" in note for note in e.notes)


@pytest.mark.parametrize("two_arms", [False, True])
def test_robomind_cuts_to_the_shortest_stream(tmp_path, two_arms):
    data = open_dataset(w.robomind_hdf5(tmp_path / "d", two_arms=two_arms))
    e = data.episodes[0]
    np.testing.assert_allclose(e.joints, w.joints()[:-1], atol=1e-12)
    np.testing.assert_allclose(e.end_effector, w.pose()[:-1], atol=1e-12)
    assert e.lengths == {"joints": 6, "gripper": 6, "end_effector": 6, "action": 5}
    assert np.diff(e.timestamps_s) == pytest.approx(0.1)
    expect_reds(e.cameras["camera_top"].read([4]), [4])
    assert data.contents["part"].tolist() == ["put_orange/success_episodes"]


@pytest.mark.parametrize("zarr_format", [2, 3])
@pytest.mark.parametrize("zipped", [False, True])
def test_zarr_buffer(tmp_path, zarr_format, zipped):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        folder = w.zarr_buffer(tmp_path / "d", zarr_format=zarr_format, zipped=zipped)
    data = open_dataset(folder)
    assert [e.timesteps for e in data.episodes] == [6, 4]
    np.testing.assert_allclose(data.episodes[1].joints, w.joints(0, 10)[6:], atol=1e-12)
    np.testing.assert_allclose(data.episodes[1].timestamps_s, np.arange(4) / 10, atol=1e-9)


def test_authors_simulation_zarr_has_frames_and_no_joints(tmp_path):
    data = open_dataset(w.zarr_buffer(tmp_path / "d", simulation=True))
    e = data.episodes[1]
    assert e.joints is None and e.end_effector is None and e.action.shape == (4, 7)
    expect_reds(e.cameras["img"].read([0, 2]), [6, 1], tolerance=0)
    assert any("simulation data" in note for note in e.notes)


def test_zarr_with_pickle_codec_is_refused(tmp_path):
    folder = w.zarr_buffer(tmp_path / "d")
    path = folder / "replay_buffer.zarr/data/action/.zarray"
    about = json.loads(path.read_text())
    path.write_text(json.dumps(about | {"filters": [{"id": "pickle", "protocol": 5}]}))
    with pytest.raises(BadInput, match="uses the codecs pickle; allowed"):
        open_dataset(folder)


def test_several_parts_and_numbers_of_episodes(tmp_path):
    w.lerobot_v2(tmp_path / "static_35k", episodes=3)
    w.lerobot_v2(tmp_path / "move_35k", episodes=3)
    data = open_dataset(tmp_path, episodes=2)
    assert data.contents["method"].tolist() == ["move", "static"]
    assert data.contents["episodes_read"].tolist() == [2, 2] and data.contents["timesteps"].tolist() == [18, 18]
    assert [e.method for e in data.episodes] == ["move", "move", "static", "static"]
    with pytest.raises(BadInput, match="has no episode 7"):
        open_dataset(tmp_path, episodes=[7])
    with pytest.raises(BadInput, match="episodes=0"):
        open_dataset(tmp_path, episodes=0)


def test_truncated_parquet_is_named_and_the_rest_is_read(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d")
    path = folder / "data/chunk-000/episode_000000.parquet"
    path.write_bytes(path.read_bytes()[:200])
    data = open_dataset(folder)
    assert [e.index for e in data.episodes] == [1]
    assert len(data.unread) == 1 and "episode_000000.parquet" in data.unread[0] and "\n" not in data.unread[0]
    shutil.copy(path, folder / "data/chunk-000/episode_000001.parquet")
    with pytest.raises(BadInput, match=r"episode_000000\.parquet: expected a parquet table"):
        open_dataset(folder)


def test_truncated_video_is_one_line(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", codec="libx264")
    path = folder / "videos/chunk-000/observation.images.wrist/episode_000000.mp4"
    path.write_bytes(path.read_bytes()[:60])
    frames = open_dataset(folder).episodes[0].cameras["wrist"]
    with pytest.raises(BadInput, match=r"episode_000000\.mp4: expected the frames of a camera"):
        frames.read([0])


def test_frames_outside_the_episode_are_refused(tmp_path):
    frames = open_dataset(w.act_hdf5(tmp_path / "d")).episodes[0].cameras["top"]
    for numbers in ([6], [-1], [2, 1], []):
        with pytest.raises(BadInput, match=r"allowed are increasing numbers in 0\.\.5"):
            frames.read(numbers)


def test_version_and_template_surprises(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d")
    path = folder / "meta/info.json"
    good = json.loads(path.read_text())
    for change, message in (({"codebase_version": "v9"}, "codebase_version is 'v9'"),
                            ({"data_path": "../../{episode_index:06d}.parquet"}, "leaves the data set's folder"),
                            ({"data_path": "{episode_index.__class__}"}, "path template"), ({"data_path": "{secret}"},
                                                                                            "uses 'secret'")):
        path.write_text(json.dumps(good | change))
        with pytest.raises(BadInput, match=message):
            open_dataset(folder)


def test_ragged_vectors_are_refused(tmp_path):
    import pyarrow as pa

    folder = w.lerobot_v2(tmp_path / "d", episodes=1)
    path = folder / "data/chunk-000/episode_000000.parquet"
    table = pq.read_table(path)
    ragged = pa.array([[0.0] * (7 if n else 8) for n in range(6)], pa.list_(pa.float32()))
    pq.write_table(table.set_column(0, "observation.state", ragged), path)
    with pytest.raises(BadInput, match="same number of values in every row"):
        open_dataset(folder)


def test_unknown_content_names_what_was_found(tmp_path):
    (tmp_path / "data.tar.gz").write_bytes(b"x")
    (tmp_path / "README.md").write_text("x")
    with pytest.raises(BadInput, match=r"found 2 files .*README.md.*unpack data.tar.gz first.*expected meta/info.json"):
        open_dataset(tmp_path)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["strange/thing"] = 1
    with pytest.raises(BadInput, match=r"found groups \['strange'\]; expected arm/"):
        open_dataset(tmp_path)


def test_neither_folder_nor_repository():
    with pytest.raises(BadInput, match="no folder on this machine, and no owner/name"):
        open_dataset("./nowhere/at/all")


def test_a_folder_has_no_revision(tmp_path):
    with pytest.raises(BadInput, match="a folder has no revision"):
        open_dataset(tmp_path, revision="a" * 40)


def test_detect_refuses_names_that_leave(tmp_path):
    for name in ("../meta/info.json", "/meta/info.json", "a/../../b", "a\\b"):
        with pytest.raises(BadInput, match="leaves the data set's folder"):
            detect([name], tmp_path)


def test_folders_called_data_keep_their_parts_apart(tmp_path):
    files = ["static/data/episode_0.hdf5", "move/data/episode_0.hdf5", "t/success_episodes/1017/data/trajectory.hdf5"]
    assert [p.name for p in detect(files, tmp_path)] == ["move/data", "static/data", "t/success_episodes"]


def test_episode_folders_at_the_top_are_one_part(tmp_path):
    for files in (["episode0/data.hdf5", "episode1/data.hdf5"], ["1/data/trajectory.hdf5", "2/data/trajectory.hdf5"]):
        assert [(p.name, p.files) for p in detect(files, tmp_path)] == [(".", tuple(files))]


def test_the_method_comes_from_the_folder_or_from_the_reader(tmp_path):
    assert open_dataset(w.act_hdf5(tmp_path / "static_35k")).contents["method"].tolist() == ["static"]
    whole = w.act_hdf5(tmp_path / "MOVE")
    assert open_dataset(whole).contents["method"].tolist() == ["unknown"], "the repository's own name tells nothing"
    file = tmp_path / "units.yaml"
    file.write_text('"*": {method: static}')
    data = open_dataset(whole, units_file=file)
    assert data.episodes[0].method == "static" and data.contents["method"].tolist() == ["static"]


def test_a_git_lfs_pointer_is_called_one(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", episodes=1)
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"
    (folder / "data/chunk-000/episode_000000.parquet").write_text(pointer)
    with pytest.raises(BadInput, match="run `git lfs pull`"):
        open_dataset(folder)


def test_detect_keeps_a_raw_tree_beside_hdf5_together(tmp_path):
    files = ["episode0/data.hdf5", "episode0/camera/color/cam/1.jpg", "episode0/arm/jointState/puppet/1.json"]
    parts = detect(files, tmp_path)
    assert [(p.layout, len(p.files)) for p in parts] == [("hdf5", 3)]


LAYOUTS = {
    "LeRobot v2.1": w.lerobot_v2, "LeRobot v3.0": w.lerobot_v3, "Pika tree": w.pika_tree, "Pika HDF5": w.pika_hdf5,
    "ACT": w.act_hdf5, "RoboMIND": w.robomind_hdf5, "zarr": w.zarr_buffer,
    "zarr in a zip": lambda folder: w.zarr_buffer(folder, zipped=True),
    "authors' zarr": lambda folder: w.zarr_buffer(folder, simulation=True),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_how_to_pages_ten_lines_make_a_buffer_of_every_layout(tmp_path, layout):
    page = (paths.ROOT / "docs/how-to/use_your_own_demonstrations.md").read_text(encoding="utf-8")
    lines = next(block for block in re.findall(r"```python\n(.*?)```", page, flags=re.S) if "open_dataset(" in block)
    assert len(lines.splitlines()) <= 10
    LAYOUTS[layout](tmp_path / "mine_lerobot")
    for name in ("mine_lerobot", "from_lerobot.zarr"):
        assert f'"build/{name}"' in lines
        lines = lines.replace(f'"build/{name}"', f'"{tmp_path}/{name}"')
    exec(lines, {"np": np, "Path": Path, "open_dataset": open_dataset, "dataset": dataset,
                 "Demonstrations": Demonstrations})
    data, (made, _) = open_dataset(tmp_path / "mine_lerobot", episodes=None), dataset.load(tmp_path
                                                                                           / "from_lerobot.zarr")
    assert made.episode_ends.tolist() == np.cumsum([e.timesteps for e in data.episodes]).tolist()
    np.testing.assert_allclose(made.observations, np.concatenate([e.state for e in data.episodes]), rtol=1e-6)
    np.testing.assert_allclose(made.actions, np.concatenate([e.action for e in data.episodes]), rtol=1e-6)


def test_the_state_of_layouts_without_one_is_all_that_the_arm_told(tmp_path):
    e = open_dataset(w.pika_tree(tmp_path / "pika")).episodes[0]
    np.testing.assert_allclose(e.state, np.hstack([w.state(), w.pose()]), atol=1e-12)
    e = open_dataset(w.act_hdf5(tmp_path / "act", arms=2)).episodes[0]
    assert e.state.shape == (w.STEPS, 14)
    e = open_dataset(w.zarr_buffer(tmp_path / "zarr")).episodes[1]
    np.testing.assert_allclose(e.state, np.hstack([w.joints(0, 10)[6:], w.pose(10)[6:]]))
