"""Demonstrations, their store on disk, and the windows cut from them."""

import json
import shutil

import numpy as np
import pytest
import zarr
from hypothesis import given, settings
from hypothesis import strategies as st

from move.errors import BadInput
from move.learn.dataset import load, save, window_indices
from move.sim.demonstrations import Demonstrations


def six_frames(images: bool = False) -> Demonstrations:
    """Two episodes, of four and of two timesteps."""
    rng = np.random.default_rng(0)
    observations = rng.normal(size=(6, 5)).astype(np.float32)
    if images:
        observations = rng.integers(0, 256, (6, 8, 8, 3), dtype=np.uint8)
    return Demonstrations(observations, rng.uniform(-1, 1, (6, 4)).astype(np.float32), np.array([4, 6]))


def test_windows_of_six_frames_written_by_hand():
    observed, predicted = window_indices(np.array([4, 6]), observation_horizon=2, prediction_horizon=4)
    assert observed.tolist() == [[0, 0], [0, 1], [1, 2], [2, 3], [4, 4], [4, 5]]
    assert predicted.tolist() == [
        [0, 0, 1, 2], [0, 1, 2, 3], [1, 2, 3, 3], [2, 3, 3, 3],
        [4, 4, 5, 5], [4, 5, 5, 5],
    ]


def slow_windows(ends: list[int], observation_horizon: int, prediction_horizon: int):
    observed, predicted, start = [], [], 0
    for end in ends:
        for t in range(start, end):
            begin = t - observation_horizon + 1
            observed.append([min(max(begin + k, start), end - 1) for k in range(observation_horizon)])
            predicted.append([min(max(begin + k, start), end - 1) for k in range(prediction_horizon)])
        start = end
    return observed, predicted


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(1, 12), min_size=1, max_size=6), st.integers(1, 4), st.integers(1, 8))
def test_windows_agree_with_a_loop(lengths, observation_horizon, prediction_horizon):
    ends = np.cumsum(lengths)
    observed, predicted = window_indices(ends, observation_horizon, prediction_horizon)
    slow_observed, slow_predicted = slow_windows(ends.tolist(), observation_horizon, prediction_horizon)
    assert observed.tolist() == slow_observed
    assert predicted.tolist() == slow_predicted


@pytest.mark.parametrize("images", [False, True])
def test_saved_demonstrations_come_back(tmp_path, images):
    given_demonstrations, attributes = six_frames(images), {"task": "pick-place", "seed": 3, "range": [0.1, 0.2]}
    save(given_demonstrations, tmp_path / "deep" / "six.zarr", attributes)
    loaded, loaded_attributes = load(tmp_path / "deep" / "six.zarr")
    assert loaded_attributes == attributes
    for name in ("observations", "actions", "episode_ends"):
        before, after = getattr(given_demonstrations, name), getattr(loaded, name)
        assert after.dtype == before.dtype and np.array_equal(after, before)


def test_the_layout_is_that_of_a_diffusion_policy_replay_buffer(tmp_path):
    save(six_frames(images=True), tmp_path / "six.zarr", {})
    group = zarr.open_group(tmp_path / "six.zarr", mode="r")
    assert group.metadata.zarr_format == 2
    assert sorted(group["data"].array_keys()) == ["action", "img"]
    assert sorted(group["meta"].array_keys()) == ["episode_ends"]


def version(number: int) -> dict:
    """Attributes of a collection, told apart by a number."""
    return {"collection": {"task": "push"}, "version": number}


def test_saving_again_replaces_when_told_to_and_leaves_nothing_beside(tmp_path):
    save(six_frames(), tmp_path / "six.zarr", version(1))
    with pytest.raises(BadInput, match="six.zarr exists; allowed is a new folder, or --overwrite"):
        save(six_frames(images=True), tmp_path / "six.zarr", version(2))
    save(six_frames(images=True), tmp_path / "six.zarr", version(3), overwrite=True)
    assert load(tmp_path / "six.zarr")[1] == version(3)
    assert [path.name for path in tmp_path.iterdir()] == ["six.zarr"]


@pytest.mark.parametrize("strange", ["thesis.txt", "data/notes.md", "data/action/0.0.bak", ".hidden", "meta/deep/er/0"])
def test_nothing_is_replaced_that_was_not_written_here(tmp_path, strange):
    path = tmp_path / "six.zarr"
    save(six_frames(), path, version(1))
    (path / strange).parent.mkdir(parents=True, exist_ok=True)
    (path / strange).write_text("mine")
    with pytest.raises(BadInput, match="exists and is not, or not only, a data set"):
        save(six_frames(), path, version(2), overwrite=True)
    assert (path / strange).read_text() == "mine" and json.loads((path / ".zattrs").read_text())["version"] == 1


def test_another_programs_data_set_a_file_and_a_link_are_left_alone(tmp_path):
    save(six_frames(), tmp_path / "theirs.zarr", {"no": "mark"})
    save(six_frames(), tmp_path / "ours.zarr", version(1))
    (tmp_path / "file").write_text("mine")
    (tmp_path / "link").symlink_to("ours.zarr")
    (tmp_path / "dangling").symlink_to("nowhere")
    (tmp_path / "empty").mkdir()
    before = sorted(tmp_path.rglob("*"))
    for name in ("theirs.zarr", "file", "link", "dangling", "empty"):
        with pytest.raises(BadInput, match="exists and is not"):
            save(six_frames(), tmp_path / name, version(2), overwrite=True)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_failed_save_leaves_the_old_store(tmp_path, monkeypatch):
    save(six_frames(), tmp_path / "six.zarr", version(1))
    monkeypatch.setattr(zarr, "create_group", lambda *a, **k: (_ for _ in ()).throw(OSError(28, "No space left")))
    with pytest.raises(BadInput, match="cannot write .*six.zarr: No space left"):
        save(six_frames(), tmp_path / "six.zarr", version(2), overwrite=True)
    monkeypatch.undo()
    assert load(tmp_path / "six.zarr")[1] == version(1)
    assert [path.name for path in tmp_path.iterdir()] == ["six.zarr"]


def test_all_zero_observations_survive(tmp_path):
    zeros = Demonstrations(np.zeros((6, 3), np.float32), np.zeros((6, 4), np.float32), np.array([6]))
    save(zeros, tmp_path / "zeros.zarr", {})
    assert np.array_equal(load(tmp_path / "zeros.zarr")[0].actions, zeros.actions)


def test_a_missing_store_is_named(tmp_path):
    with pytest.raises(BadInput, match="no demonstrations at .*nowhere"):
        load(tmp_path / "nowhere")


@pytest.mark.parametrize("part", ["data/action", "meta", "data/action/0.0", "data/keypoints/0.0", ".zgroup"])
def test_a_store_with_a_part_missing_is_refused(tmp_path, part):
    path = tmp_path / "six.zarr"
    save(six_frames(), path, {})
    broken = path / part
    shutil.rmtree(broken) if broken.is_dir() else broken.unlink()
    with pytest.raises(BadInput, match="^cannot read demonstrations from [^\n]*six.zarr[^\n]*$"):
        load(path)


def test_attributes_that_json_cannot_hold_are_refused(tmp_path):
    with pytest.raises(BadInput, match="JSON"):
        save(six_frames(), tmp_path / "six.zarr", {"array": np.zeros(3)})
    assert list(tmp_path.iterdir()) == []


WRONG = {
    "observations.*float64.*allowed": {"observations": np.zeros((6, 5))},
    r"observations \(6, 8, 8, 4\)": {"observations": np.zeros((6, 8, 8, 4), np.uint8)},
    "NaN": {"observations": np.full((6, 5), np.nan, np.float32)},
    "5 observations with 6 actions": {"observations": np.zeros((5, 5), np.float32)},
    r"actions \(6,\)": {"actions": np.zeros(6, np.float32)},
    "actions hold NaN or infinity; allowed": {"actions": np.full((6, 4), np.nan, np.float32)},
    "episode_ends .*int32": {"episode_ends": np.array([4, 6], np.int32)},
    "ends with 5; .* 6": {"episode_ends": np.array([4, 5])},
    "ends with nothing": {"episode_ends": np.array([], np.int64)},
    "strictly increasing": {"episode_ends": np.array([4, 4, 6])},
    "from above 0": {"episode_ends": np.array([0, 6])},
}


@pytest.mark.parametrize("message", WRONG)
def test_impossible_demonstrations_are_refused(message):
    right = vars(six_frames())
    with pytest.raises(BadInput, match=message):
        Demonstrations(**{**right, **WRONG[message]})


def published(path, actions: np.ndarray, pictures: bool = True) -> None:
    """A small store with the keys of the authors' published data, in zarr format 2 on disk."""
    rng = np.random.default_rng(1)
    group = zarr.create_group(path, zarr_format=2)
    arrays = {"state": rng.normal(size=(len(actions), 9)).astype(np.float32),
              "full_state": rng.normal(size=(len(actions), 39)).astype(np.float32), "action": actions}
    if pictures:
        arrays["img"] = rng.integers(0, 256, (len(actions), 48, 48, 3), dtype=np.uint8)
    for name, array in arrays.items():
        group.create_array(f"data/{name}", data=array, chunks=(100, *array.shape[1:]))
    group.create_array("meta/episode_ends", data=np.array([30, len(actions)]))


def test_the_authors_published_data_are_read_as_images(tmp_path):
    actions = np.random.default_rng(0).uniform(-1, 1, (50, 4))
    published(tmp_path / "p.zarr", actions)
    assert (tmp_path / "p.zarr/data/img/.zarray").exists()
    read, attributes = load(tmp_path / "p.zarr")
    assert read.has_images and read.observations.shape == (50, 48, 48, 3) and attributes == {}
    assert read.episode_ends.tolist() == [30, 50]
    np.testing.assert_array_equal(read.actions, actions.astype(np.float32))


def test_without_images_the_state_is_observed(tmp_path):
    published(tmp_path / "p.zarr", np.ones((50, 4), np.float32), pictures=False)
    assert load(tmp_path / "p.zarr")[0].observations.shape == (50, 9)


@pytest.mark.parametrize("offset", [1e7, 1.7e9])
def test_numbers_that_float32_would_make_one_are_refused(tmp_path, offset):
    published(tmp_path / "p.zarr", np.ones((50, 4), np.float32), pictures=False)
    group = zarr.open_group(str(tmp_path / "p.zarr"), mode="a")
    state = np.random.default_rng(2).normal(size=(50, 9))
    for shift, refused in ((0.0, False), (offset, True)):
        del group["data/state"]
        group.create_array("data/state", data=state + shift * (np.arange(9) == 3))
        if refused:
            with pytest.raises(BadInput, match="50 numbers of column 3, .* in float32"):
                load(tmp_path / "p.zarr")
        else:
            load(tmp_path / "p.zarr")


def test_actions_out_of_range_are_what_they_are_or_clipped_when_asked(tmp_path):
    actions = np.linspace(-9.5, 3.25, 200, dtype=np.float32).reshape(50, 4)
    published(tmp_path / "p.zarr", actions)
    np.testing.assert_array_equal(load(tmp_path / "p.zarr")[0].actions, actions)
    np.testing.assert_array_equal(load(tmp_path / "p.zarr", clip_actions=True)[0].actions, actions.clip(-1, 1))
