"""What is exported is read back by the package's own reader: numbers exactly, images within the codec's tolerance."""

import json
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from huggingface_hub import DatasetCard
from shared import full_disk

from move.errors import BadInput
from move.exchange import card
from move.exchange import export as exporting
from move.exchange.feature_stats import QUANTILES, feature_stats
from move.learn import dataset
from move.realworld import open_dataset
from move.sim.collect import Collection, collect, record_attributes
from move.sim.demonstrations import Demonstrations

ATTRIBUTES = {"collection": {"task": "pick-place", "method": "move"}, "seed": 3}
ENDS = np.array([7, 12, 20])


def smooth_images(timesteps: int, side: int) -> np.ndarray:
    """A grey picture with a red square of four pixels that wanders: what is small and coloured must survive."""
    images = np.full((timesteps, side, side, 3), 120, np.uint8)
    for t, image in enumerate(images):
        image[t:t + 4, 10:14] = (150, 20, 20)
    return images


def write(folder, images: bool = False) -> Demonstrations:
    """Three episodes of 7, 5 and 8 timesteps, stored; pictures have an odd side."""
    rng = np.random.default_rng(0)
    seen = smooth_images(20, 47) if images else rng.normal(size=(20, 27)).astype(np.float32)
    demonstrations = Demonstrations(seen, rng.uniform(-1, 1, (20, 4)).astype(np.float32), ENDS)
    dataset.save(demonstrations, folder, ATTRIBUTES)
    return demonstrations


def pieces(array: np.ndarray) -> list[np.ndarray]:
    return np.split(array, ENDS[:-1])


class Exported(NamedTuple):
    """Demonstrations, the folder in which LeRobot finds them, and what the export said."""

    written: Demonstrations
    out: Path
    about: dict


@pytest.fixture(scope="module")
def exported(tmp_path_factory) -> dict[bool, Exported]:
    """By whether images are observed."""
    found = {}
    for images in (False, True):
        folder = tmp_path_factory.mktemp("exported")
        written = write(folder / "a.zarr", images)
        about = exporting.export(folder / "a.zarr", folder / "out", "lerobot")
        found[images] = Exported(written, folder / "out", about)
    return found


def test_keypoints_come_back_exactly_from_lerobot(exported):
    written, out, about = exported[False]
    assert (about["episodes"], about["timesteps"], about["observation"]) == (3, 20, "numbers")
    read = open_dataset(out, episodes=None)
    assert [e.timesteps for e in read.episodes] == [7, 5, 8] and not read.unread
    for e, seen, action in zip(read.episodes, pieces(written.observations), pieces(written.actions), strict=True):
        np.testing.assert_array_equal(e.state, seen)
        np.testing.assert_array_equal(e.action, action)
        np.testing.assert_allclose(e.timestamps_s, np.arange(len(seen)) / 80, atol=1e-6)
        assert e.action_names == ("x", "y", "z", "gripper") and not e.cameras


def test_images_come_back_from_lerobot_within_the_codecs_tolerance(exported):
    written, out, _ = exported[True]
    for e, seen, action in zip(open_dataset(out, episodes=None).episodes, pieces(written.observations),
                               pieces(written.actions), strict=True):
        np.testing.assert_array_equal(e.action, action)
        frames = e.cameras["camera"].read(range(e.timesteps))
        error = np.abs(frames.astype(int) - seen)
        assert frames.shape == seen.shape and error.mean() < 1.5 and error.max() < 40
        squares = (frames[..., 0].astype(int) - frames[..., 1]) > 60
        assert [np.argwhere(square).mean(axis=0).round().tolist() for square in squares] == [
            np.argwhere(image[..., 1] == 20).mean(axis=0).round().tolist() for image in seen]


def test_the_files_are_those_of_lerobot_v3(exported):
    written, out, _ = exported[True]
    assert {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()} == {
        "README.md", "meta/info.json", "meta/stats.json", "meta/tasks.parquet", "meta/move.json", exporting.EPISODES,
        "data/chunk-000/file-000.parquet", "videos/observation.images.camera/chunk-000/file-000.mp4"}
    info = json.loads((out / "meta/info.json").read_text())
    assert (info["codebase_version"], info["total_frames"], info["fps"]) == ("v3.0", 20, 80)
    assert json.loads((out / "meta/move.json").read_text()) == ATTRIBUTES
    assert pd.read_parquet(out / "meta/tasks.parquet").index.tolist() == ["pick-place"]
    table = pq.read_table(out / "data/chunk-000/file-000.parquet")
    columns = {name for name, feature in info["features"].items() if feature["dtype"] != "video"}
    assert set(table.column_names) == columns and table.num_rows == 20
    assert table["frame_index"].to_pylist() == [*range(7), *range(5), *range(8)]
    assert table["timestamp"].to_pylist() == pytest.approx(
        [frame / 80 for frame in table["frame_index"].to_pylist()], abs=1e-6), "each episode begins at 0 s"
    assert table["action"].type.list_size == 4 and np.ptp(np.vstack(table["observation.state"].to_numpy())) == 0
    rows = pq.read_table(out / exporting.EPISODES).to_pylist()
    assert [row["dataset_from_index"] for row in rows] == [0, 7, 12]
    seconds = [row["videos/observation.images.camera/from_timestamp"] for row in rows]
    assert seconds == pytest.approx([0, 7 / 80, 12 / 80])
    np.testing.assert_allclose(rows[1]["stats/action/mean"], written.actions[7:12].mean(axis=0), rtol=1e-5)


@pytest.mark.parametrize("images", [False, True])
def test_the_card_is_one_that_the_hub_reads_and_says_what_the_data_are(exported, images):
    out = exported[images].out
    read = DatasetCard.load(out / "README.md")
    front = read.data.to_dict()
    assert front["task_categories"] == ["robotics"] and "LeRobot" in front["tags"]
    assert front["size_categories"] == ["n<1K"] and "license" not in front, "which is not ours to choose"
    (config,) = front["configs"]
    found = list(out.glob(config["data_files"]))
    assert [path.name for path in found] == ["file-000.parquet"]
    assert "Pick-Place, collected by MOVE" in front["pretty_name"] in read.text
    assert "3 demonstrations, 20 timesteps at 80 a second" in read.text and "No real robot" in read.text
    shown = set(re.findall(r"^\| `(\S+)` \|", read.text, re.M))
    assert shown == set(json.loads((out / "meta/info.json").read_text())["features"])


def test_a_card_names_nothing_that_it_does_not_know(tmp_path):
    odd = {"collection": {"task": "[a](javascript:b)", "method": "<img src=x>"}}
    info = {"total_frames": 20_000, "total_episodes": 9, "fps": 80, "features": {}}
    text = card.dataset_card(info, odd)
    assert "javascript" not in text and "<img" not in text and "Sawyer" not in text and "No real robot" not in text
    assert DatasetCard(text).data.to_dict()["tags"] == ["LeRobot"] and "say here who or what demonstrated" in text
    assert DatasetCard(text).data.to_dict()["size_categories"] == ["10K<n<100K"]


@pytest.mark.parametrize("images", [False, True])
def test_pooled_statistics_are_those_of_all_frames(exported, images):
    written, out, _ = exported[images]
    stats = json.loads((out / "meta/stats.json").read_text())
    key = exporting.CAMERA if images else exporting.STATE
    expected = feature_stats(written.observations)
    assert set(stats[key]) == set(expected) and stats[key]["count"] == [20]
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(stats[key][name], expected[name], rtol=1e-5, atol=1e-7)
    assert {np.shape(stats[key][name]) for name in QUANTILES} == {(3, 1, 1) if images else (27,)}
    for name, share in QUANTILES.items():  # LeRobot's rule: the mean of the episodes' own, weighted by their frames
        each = [np.quantile(piece.reshape(-1, piece.shape[-1]), share, axis=0, method="inverted_cdf")
                for piece in pieces(written.observations)]
        wanted = np.average(each, axis=0, weights=[7, 5, 8]) / (255 if images else 1)
        np.testing.assert_allclose(np.ravel(stats[key][name]), wanted, rtol=1e-5, atol=1e-7)


def test_episodes_keep_their_own_statistics(exported):
    written, out, _ = exported[False]
    row = pq.read_table(out / exporting.EPISODES).to_pylist()[1]
    for name, values in feature_stats(written.actions[7:12]).items():
        assert row[f"stats/action/{name}"] == values


def collected(timesteps: int, **choices) -> tuple[Demonstrations, dict]:
    chosen = Collection(task="pick-place", timesteps=timesteps, **choices)
    demonstrations, record = collect(chosen, 0)
    return demonstrations, json.loads(json.dumps(record_attributes(chosen, 0, record)))


def test_whole_episodes_leave_out_the_one_that_the_budget_cut(tmp_path):
    demonstrations, attributes = collected(250, method="static")
    dataset.save(demonstrations, tmp_path / "a.zarr", attributes)
    for form in exporting.FORMATS:
        about = exporting.export(tmp_path / "a.zarr", tmp_path / form, form, whole_episodes=True)
        assert about["episodes"] == demonstrations.episodes - 1
        assert about["timesteps"] == demonstrations.episode_ends[-2] < 250
    kept, stored = dataset.load(tmp_path / "zarr")
    assert np.array_equal(kept.observations, demonstrations.observations[: kept.timesteps])
    assert stored == attributes | {"whole_episodes": True}


def test_where_the_budget_cut_nothing_all_episodes_are_whole():
    first, _ = collected(1000, method="static")
    demonstrations, attributes = collected(int(first.episode_ends[2]), method="static")
    assert exporting.whole(demonstrations, attributes).episodes == demonstrations.episodes == 3


def test_of_a_mixture_each_methods_last_episode_is_left_out():
    demonstrations, attributes = collected(600, method="mixture", shares={"static": 0.5, "move": 0.5})
    whole = exporting.whole(demonstrations, attributes)
    cut = demonstrations.episode_ends.tolist().index(300)
    assert whole.lengths.tolist() == np.delete(demonstrations.lengths, [cut, -1]).tolist()
    part, _ = collected(300, method="static")
    assert np.array_equal(whole.actions[: part.episode_ends[-2]], part.actions[: part.episode_ends[-2]])


@pytest.mark.parametrize("timesteps, attributes, message", [
    (250, {}, "nothing says how these demonstrations were collected"),
    (250, {"collection": {"task": "moon"}, "record": {}}, "nothing says how"),
    (50, None, "none among 1"),
])
def test_whole_episodes_that_cannot_be_known_are_refused(timesteps, attributes, message):
    demonstrations, own = collected(timesteps, method="static")
    with pytest.raises(BadInput, match=message):
        exporting.whole(demonstrations, own if attributes is None else attributes)


def test_the_states_numbers_are_named_after_keypoints(exported):
    feature = json.loads((exported[False].out / "meta/info.json").read_text())["features"]["observation.state"]
    assert feature["names"][:2] == ["site:rightEndEffector right", "site:rightEndEffector up"]


@pytest.mark.parametrize("images", [False, True])
def test_the_zarr_export_is_the_same_store(tmp_path, images):
    written = write(tmp_path / "a.zarr", images)
    exporting.export(tmp_path / "a.zarr", tmp_path / "b.zarr", "zarr")
    read, attributes = dataset.load(tmp_path / "b.zarr")
    for name, values in vars(written).items():
        np.testing.assert_array_equal(getattr(read, name), values)
    assert attributes == ATTRIBUTES and (tmp_path / "b.zarr/.zgroup").exists(), "zarr format 2"
    frames = open_dataset(tmp_path / "b.zarr", episodes=None).episodes[1]
    np.testing.assert_array_equal(frames.action, written.actions[7:12])


def test_nothing_half_written_and_nothing_overwritten(tmp_path, monkeypatch):
    write(tmp_path / "a.zarr", images=True)
    (tmp_path / "there").mkdir()
    with pytest.raises(BadInput, match="exists; allowed is a new folder"):
        exporting.export(tmp_path / "a.zarr", tmp_path / "there", "lerobot")

    monkeypatch.setattr(exporting, "write_video", full_disk)
    with pytest.raises(BadInput, match="cannot write .*out: No space left on device"):
        exporting.export(tmp_path / "a.zarr", tmp_path / "out", "lerobot")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.zarr", "there"]


def test_demonstrations_of_ones_own_say_what_was_recorded(tmp_path):
    mine = Demonstrations(np.zeros((4, 3), np.float32), np.zeros((4, 7), np.float32), np.array([2, 4]))
    dataset.save(mine, tmp_path / "a.zarr", {"task": "push the puck", "robot_type": "pusher", "fps": 20})
    exporting.export(tmp_path / "a.zarr", tmp_path / "out", "lerobot")
    info = json.loads((tmp_path / "out/meta/info.json").read_text())
    assert (info["robot_type"], info["fps"], info["features"]["action"]["shape"]) == ("pusher", 20, [7])
    table = pq.read_table(tmp_path / "out/data/chunk-000/file-000.parquet")
    assert table["timestamp"].to_pylist() == pytest.approx([0, 1 / 20, 0, 1 / 20])
    assert pd.read_parquet(tmp_path / "out/meta/tasks.parquet").index.tolist() == ["push the puck"]


@pytest.mark.parametrize("attributes, message", [({"fps": 0}, "attributes: fps: 0 given"),
                                                 ({"robot_type": 3}, "attributes: robot_type: 3 given")])
def test_a_robot_or_a_rate_that_is_none_is_refused_and_nothing_written(tmp_path, attributes, message):
    mine = Demonstrations(np.zeros((4, 3), np.float32), np.zeros((4, 7), np.float32), np.array([2, 4]))
    dataset.save(mine, tmp_path / "a.zarr", attributes)
    with pytest.raises(BadInput, match=message):
        exporting.export(tmp_path / "a.zarr", tmp_path / "out", "lerobot")
    assert not (tmp_path / "out").exists()
