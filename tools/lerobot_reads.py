"""LeRobot's own reader against the arrays that were exported; run by LeRobot's Python, from tools/test_lerobot.py.

    python -I lerobot_reads.py EXPORTED ARRAYS       (ARRAYS: observations.npy, actions.npy, ends.npy)

Prints what was compared as JSON; ends with an AssertionError where anything differs.
"""

import json
import sys
from pathlib import Path

import numpy as np
import torch
from lerobot.datasets.compute_stats import aggregate_stats, get_feature_stats
from lerobot.datasets.lerobot_dataset import LeRobotDataset

STATE, ENVIRONMENT, CAMERA = "observation.state", "observation.environment_state", "observation.images.camera"
FPS = 80
DECODER = "pyav"  # which brings its own FFmpeg; LeRobot's default, torchcodec, needs the system's
BEFORE, AFTER = 1, 6  # timesteps of the windows of actions
MEAN_ERROR, WORST_FRAME = 1.5, 2.0  # of 255 levels, lost in the video


def numbers_of(observations: np.ndarray, actions: np.ndarray, ends: np.ndarray) -> dict[str, np.ndarray]:
    """What every column of numbers must hold, (timesteps, ...)."""
    lengths = np.diff(ends, prepend=0)
    within = np.concatenate([np.arange(length) for length in lengths])
    images = observations.ndim == 4
    seen = {STATE: np.zeros((len(actions), 2), np.float32)} if images else {STATE: observations,
                                                                            ENVIRONMENT: observations}
    return {**seen, "action": actions, "episode_index": np.repeat(np.arange(len(ends)), lengths),
            "frame_index": within, "index": np.arange(len(actions)), "timestamp": (within / FPS).astype(np.float32),
            "task_index": np.zeros(len(actions), int)}


def compare_frames(data: LeRobotDataset, numbers: dict[str, np.ndarray], observations: np.ndarray) -> dict:
    """Every number of every frame exactly, time to 10 microseconds; images within the codec's error."""
    errors = []
    for index in range(len(data)):
        frame = data[index]
        for name, values in numbers.items():
            found = frame[name].numpy()
            assert np.allclose(found, values[index], rtol=0, atol=1e-5 if name == "timestamp" else 0), (name, index)
        if CAMERA in frame:
            picture = frame[CAMERA].numpy().transpose(1, 2, 0) * 255
            errors.append(float(np.abs(picture - observations[index]).mean()))
    if not errors:
        return {}
    assert np.mean(errors) < MEAN_ERROR and max(errors) < WORST_FRAME, (np.mean(errors), max(errors))
    return {"image_error": round(float(np.mean(errors)), 3), "worst_image": round(max(errors), 3)}


def compare_windows(root: Path, actions: np.ndarray, ends: np.ndarray) -> None:
    """Windows of actions around every timestep, what lies beyond an episode marked as padding."""
    steps = range(-BEFORE, AFTER + 1)
    data = LeRobotDataset("local/x", root=root, video_backend=DECODER,
                          delta_timestamps={"action": [step / FPS for step in steps]})
    first = 0
    for end in ends:
        for now in range(first, end):
            wanted = [now + step for step in steps]
            window = data[now]
            assert np.array_equal(window["action"].numpy(), actions[np.clip(wanted, first, end - 1)]), now
            assert window["action_is_pad"].tolist() == [not first <= at < end for at in wanted], now
        first = end


def compare_stats(data: LeRobotDataset, numbers: dict[str, np.ndarray], observations: np.ndarray, ends: np.ndarray
                  ) -> None:
    """meta/stats.json against what LeRobot itself would write: quantiles to a bin of its histogram."""
    episodes = []
    for first, end in zip([0, *ends[:-1]], ends, strict=True):
        found = {name: get_feature_stats(values[first:end], axis=0, keepdims=values.ndim == 1)
                 for name, values in numbers.items()}
        if observations.ndim == 4:
            pictures = observations[first:end].transpose(0, 3, 1, 2).astype(float)
            found[CAMERA] = {name: value if name == "count" else np.squeeze(value / 255, axis=0) for name, value in
                             get_feature_stats(pictures, axis=(0, 2, 3), keepdims=True).items()}
        episodes.append(found)
    theirs = aggregate_stats(episodes)
    assert set(theirs) == set(data.meta.stats)
    for feature, wanted in theirs.items():
        ours = data.meta.stats[feature]
        assert set(ours) == set(wanted), (feature, set(ours) ^ set(wanted))
        bin_width = (wanted["max"] - wanted["min"]) / 5000 + 1e-5
        for name, value in wanted.items():
            assert np.shape(ours[name]) == np.shape(value), (feature, name)
            assert np.all(np.abs(np.asarray(ours[name], float) - value) <= bin_width), (feature, name)


def main() -> None:
    """Compare one export with its arrays."""
    root, arrays = Path(sys.argv[1]), Path(sys.argv[2])
    observations, actions, ends = (np.load(arrays / f"{name}.npy") for name in ("observations", "actions", "ends"))
    numbers = numbers_of(observations, actions, ends)
    data = LeRobotDataset("local/x", root=root, video_backend=DECODER)
    assert (len(data), data.num_episodes, data.fps) == (len(actions), len(ends), FPS)
    errors = compare_frames(data, numbers, observations)
    compare_windows(root, actions, ends)
    compare_stats(data, numbers, observations, ends)
    batch = next(iter(torch.utils.data.DataLoader(data, batch_size=16, shuffle=True)))
    assert len(batch["action"]) == 16
    print(json.dumps({"episodes": len(ends), "frames": len(actions), "numbers": sorted(numbers), **errors}))


if __name__ == "__main__":
    main()
