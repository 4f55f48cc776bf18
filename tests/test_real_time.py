"""A picture belongs to its time: each timestep is shown the frame nearest to its time stamp, or none."""

import shutil

import numpy as np
import pytest
import real_writers as w

from move.errors import BadInput
from move.realworld import check_dataset, open_dataset, tracking
from move.realworld.frames import from_video, nearest

CAMERA = "observation.images.wrist"
V2_VIDEO = f"videos/chunk-000/{CAMERA}/episode_000000.mp4"
V2_TABLE = "data/chunk-000/episode_000000.parquet"
V3_VIDEO = f"videos/{CAMERA}/chunk-000/file-000.mp4"
V3_EPISODES = "meta/episodes/chunk-000/file-000.parquet"
FRAMES = "every timestep has its frames"


def found(data, name: str = FRAMES):
    return {check.name: check for check in check_dataset(data)}[name]


def shown(episode, steps=None) -> list[int]:
    """The numbers of the pictures that timesteps are shown."""
    frames = next(iter(episode.cameras.values()))
    return w.numbers_of(frames.read(range(episode.timesteps) if steps is None else steps)).tolist()


def film(path, count: int, **options):
    """A video of `count` pictures: 0, 4, 8, ..."""
    return w.write_video(path, range(0, 4 * count, 4), draw=w.grey, **options)


@pytest.mark.parametrize("rate", [10, 20, 30, 50])
def test_rows_at_10_hz_beside_a_faster_video_in_every_layout(tmp_path, rate):
    v2 = w.lerobot_v2(tmp_path / "v2", episodes=1, codec="libx264")
    film(v2 / V2_VIDEO, 6 * rate // 10, fps=rate)
    v3 = w.lerobot_v3(tmp_path / "v3", episodes=2)
    film(v3 / V3_VIDEO, 12 * rate // 10, fps=rate)
    zarr = w.zarr_buffer(tmp_path / "zarr")
    film(zarr / "videos/0/cam.mp4", 6 * rate // 10, fps=rate)
    film(zarr / "videos/1/cam.mp4", 4 * rate // 10, fps=rate)
    each = 4 * rate // 10
    for folder, lengths in ((v2, [6]), (v3, [6, 6]), (zarr, [6, 4])):
        data = open_dataset(folder)
        assert [e.timesteps for e in data.episodes] == lengths and found(data).outcome == "pass"
        first = 0
        for episode, length in zip(data.episodes, lengths, strict=True):
            start = first if folder == v3 else 0
            assert shown(episode) == [each * (start + n) for n in range(length)], folder.name
            first += length


def test_a_slower_video_shows_its_frames_again_and_refuses_what_is_beyond_half_a_frame(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", episodes=1, codec="libx264")
    film(folder / V2_VIDEO, 2, fps=5)  # frames at 0 and .2 s for rows at 0, .1, ..., .5 s
    data = open_dataset(folder)
    assert shown(data.episodes[0], [0, 2, 3]) == [0, 4, 4]
    with pytest.raises(BadInput, match="timestep 4 has no frame within half a frame"):
        shown(data.episodes[0], [2, 4])
    assert found(data).outcome == "differs" and "2 of 6 timesteps without a frame" in found(data).detail


def test_a_video_of_variable_rate_is_read_by_its_time_stamps(tmp_path):
    times = np.cumsum([0.0, 0.1, 0.13, 0.05, 0.4, 0.09])
    folder = w.lerobot_v2(tmp_path / "d", episodes=1, codec="libx264")
    w.change_table(folder / V2_TABLE, timestamp=times.astype(np.float32))
    film(folder / V2_VIDEO, 6, times_s=times)
    data = open_dataset(folder)
    assert shown(data.episodes[0]) == [0, 4, 8, 12, 16, 20] and found(data).outcome == "pass"


def episodes_table(folder, from_s) -> None:
    w.change_table(folder / V3_EPISODES, **{f"videos/{CAMERA}/from_timestamp": np.asarray(from_s, float)})


@pytest.mark.parametrize("drift_frames", [0.3, 1.0, 2.5])
def test_drift_of_the_start_in_a_shared_video_is_refused_before_it_shows_another_frame(tmp_path, drift_frames):
    count = 8
    folder = w.lerobot_v3(tmp_path / "d", episodes=count)
    film(folder / V3_VIDEO, 6 * count)
    episodes_table(folder, [0.6 * n + 0.1 * drift_frames * n / (count - 1) for n in range(count)])
    data = open_dataset(folder, episodes=None)
    refused = 0
    for n, episode in enumerate(data.episodes):
        try:
            assert shown(episode) == [4 * (6 * n + k) for k in range(6)]
        except BadInput:
            refused += 1
    assert refused == sum(drift_frames * n / (count - 1) > 0.5 for n in range(count))
    assert found(data).outcome == ("differs" if refused else "pass")


@pytest.mark.parametrize("from_s", [[0, 0, 0], [0.6, 0.0, 1.2], [0, 1.2, 0.6], [0, 0.6, 0.6], [0.6, 1.2, 1.8]],
                         ids=["all 0", "first two", "last two", "one twice", "all one episode late"])
@pytest.mark.parametrize("rate", [10, 30])
def test_starts_of_other_episodes_are_refused(tmp_path, from_s, rate):
    folder = w.lerobot_v3(tmp_path / "d")
    film(folder / V3_VIDEO, 18 * rate // 10, fps=rate)
    episodes_table(folder, from_s)
    data = open_dataset(folder)
    for n, episode in enumerate(data.episodes):
        if abs(from_s[n] - 0.6 * n) < 0.01:
            assert shown(episode)[0] == 4 * 6 * n * rate // 10
        else:
            with pytest.raises(BadInput):
                shown(episode)
    assert found(data).outcome == "differs"


@pytest.mark.parametrize("extra", [0, 2])
def test_episodes_of_several_shared_videos_are_counted_in_their_own(tmp_path, extra):
    folder = w.lerobot_v3(tmp_path / "d", episodes=5)
    film(folder / V3_VIDEO, 12 + extra)  # what lies behind the last episode is nobody's
    film(folder / V3_VIDEO.replace("file-000", "file-001"), 18, fps=10)
    w.change_table(folder / V3_EPISODES, **{f"videos/{CAMERA}/file_index": [0, 0, 1, 1, 1]})
    episodes_table(folder, [0, 0.6, 0, 0.6, 1.2])
    data = open_dataset(folder)
    assert [shown(e)[0] for e in data.episodes] == [0, 24, 0, 24, 48] and found(data).outcome == "pass"


@pytest.mark.parametrize("layout", ["v2", "v3"])
def test_a_declared_video_that_is_missing_or_short_is_found(tmp_path, layout):
    write, video = {"v2": (w.lerobot_v2, V2_VIDEO), "v3": (w.lerobot_v3, V3_VIDEO)}[layout]
    folder = write(tmp_path / "d", codec="libx264")
    assert found(open_dataset(folder)).outcome == "pass"
    film(folder / video, 3)
    assert "without a frame" in found(open_dataset(folder)).detail
    (folder / video).unlink()
    check = found(open_dataset(folder))
    assert check.outcome == "differs" and video.rsplit("/", 1)[1] in check.detail


def test_a_declared_image_column_or_file_that_is_missing_is_found(tmp_path):
    folder = w.lerobot_v2(tmp_path / "column", image_column=True)
    assert found(open_dataset(folder)).outcome == "pass"
    w.change_table(folder / V2_TABLE, **{"observation.images.front": None})
    assert "6 of 6 timesteps without a frame" in found(open_dataset(folder)).detail
    folder = w.pika_hdf5(tmp_path / "files")
    (folder / "episode0/camera/color/cam/3.jpg").unlink()
    assert "1 of 6 are missing" in found(open_dataset(folder)).detail


def test_without_time_stamps_only_as_many_frames_as_timesteps_are_shown(tmp_path):

    folder = w.zarr_buffer(tmp_path / "d")
    shutil.rmtree(folder / "replay_buffer.zarr/data/timestamp")
    film(folder / "videos/0/cam.mp4", 6)
    film(folder / "videos/1/cam.mp4", 12, fps=30)
    data = open_dataset(folder)
    assert shown(data.episodes[0]) == [0, 4, 8, 12, 16, 20]
    with pytest.raises(BadInput, match="12 frames for 4 timesteps, whose times are not known"):
        shown(data.episodes[1])


def square(number: int, height: int = 64, width: int = 128) -> np.ndarray:
    """An orange square that goes 2 pixels to the right with each number."""
    image = np.full((height, width, 3), 200, np.uint8)
    image[24:40, 4 + 2 * number:20 + 2 * number] = (250, 130, 10)
    return image


@pytest.mark.parametrize("rate", [10, 30])
def test_speeds_of_the_object_are_those_of_its_video(tmp_path, monkeypatch, rate):
    """2 pixels a frame are 20 px/s at 10 frames a second and 60 px/s at 30, whatever the rate of the rows."""
    folder = w.zarr_buffer(tmp_path / "d")
    w.write_video(folder / "videos/0/cam.mp4", range(6 * rate // 10), fps=rate, draw=square, size=(64, 128))
    w.write_video(folder / "videos/1/cam.mp4", range(4 * rate // 10), fps=rate, draw=square, size=(64, 128))
    data = open_dataset(folder)
    assert "videos begin" in found(data, "nothing had to be assumed").detail
    monkeypatch.setattr(tracking, "GAP_STEPS", 1)
    table = tracking.object_speeds(tracking.object_places(data.episodes, "cam"))
    assert table["mean_speed"].tolist() == pytest.approx([2 * rate] * 2, rel=0.05) and set(table["seen"]) == {1.0}


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_the_unit_of_time_is_told_as_the_others_are(tmp_path, unit, factor):
    folder = w.lerobot_v2(tmp_path / "d", episodes=2, codec="libx264")
    film(folder / V2_VIDEO, 6)
    for path in sorted((folder / "data").rglob("*.parquet")):
        w.change_table(path, timestamp=np.arange(6) / 10 * factor)
    for change in ({}, {"fps": None}):
        w.change_json(folder / "meta/info.json", **change)
        data = open_dataset(folder)
        row = data.units.set_index("quantity").loc["time"]
        assert (row["unit"], row["decided_by"]) == (unit, "size of the numbers" if change else "the stated rate")
        np.testing.assert_allclose(data.episodes[0].timestamps_s, np.arange(6) / 10)
        assert shown(data.episodes[0]) == [0, 4, 8, 12, 16, 20]
        assert "10.0 timesteps a second" in found(data, "time increases").detail


def test_a_time_of_unknown_unit_stays_out_until_a_units_file_names_it(tmp_path):
    folder = w.lerobot_v2(tmp_path / "d", episodes=1, codec="libx264")
    w.change_table(folder / V2_TABLE, timestamp=np.arange(6) * 1.5)
    w.change_json(folder / "meta/info.json", fps=None)
    data = open_dataset(folder)
    assert data.units.set_index("quantity").loc["time", "unit"] == "unknown"
    assert np.isnan(data.episodes[0].timestamps_s).all() and found(data, "all units are known").outcome == "differs"
    (tmp_path / "units.yaml").write_text('"*": {time: s}')
    data = open_dataset(folder, units_file=tmp_path / "units.yaml")
    np.testing.assert_allclose(data.episodes[0].timestamps_s, np.arange(6) * 1.5)


@pytest.mark.parametrize("fps", [1000, 12, 5])
def test_a_rate_that_is_not_that_of_the_time_stamps_is_found(tmp_path, fps):
    folder = w.lerobot_v2(tmp_path / "d")
    assert found(open_dataset(folder), "the rate is the stated one").outcome == "pass"
    w.change_json(folder / "meta/info.json", fps=fps)
    check = found(open_dataset(folder), "the rate is the stated one")
    assert check.outcome == "differs" and f"states {fps} Hz, its steps take 0.1 s" in check.detail


def test_a_video_is_counted_without_decoding_and_its_times_are_its_own(tmp_path):
    times = [0.0, 0.04, 0.3, 0.31]
    frames = from_video(film(tmp_path / "a.mp4", 4, times_s=times))
    assert len(frames) == 4
    assert frames.at(np.array([0.0, 0.05, 0.29, np.nan, 0.5])).numbers().tolist() == [0, 1, 2, -1, -1]


def test_nearest():
    assert nearest(np.array([0.0, 1.0, 3.0]), np.array([-1, 0.4, 0.6, 2.1, 9])).tolist() == [0, 0, 1, 2, 2]
    assert nearest(np.array([2.0]), np.array([-1, 9])).tolist() == [0, 0]
