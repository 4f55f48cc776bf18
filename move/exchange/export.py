"""Collected demonstrations in other programs' formats: a LeRobot v3.0 data set, or diffusion_policy's replay buffer.

    README.md (the dataset card)
    meta/info.json  meta/stats.json  meta/tasks.parquet  meta/move.json (how the demonstrations were collected)
    meta/episodes/chunk-000/file-000.parquet             which frames belong to which episode, and its statistics
    data/chunk-000/file-000.parquet                      every number of every frame
    videos/observation.images.camera/chunk-000/file-000.mp4

What a LeRobot policy is given:

| the demonstrations hold | observation.state | observation.environment_state | observation.images.camera |
|---|---|---|---|
| keypoints | the keypoints | the keypoints again | - |
| images | two zeros | - | the images |

LeRobot's diffusion policy wants a state, and with it an image or an environment state. A policy from images sees
images alone, as here, so its state says nothing.

Demonstrations of one's own say with the attributes "task", "robot_type" and "fps" (see `Origin`) what was recorded.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from move.errors import BadInput
from move.exchange.card import dataset_card
from move.exchange.feature_stats import Stats, feature_stats, pooled_stats
from move.files import refuse_existing, written_aside
from move.learn import dataset
from move.realworld.lerobot_files import DATA, V3, VIDEO, scalar_columns, scalar_features, vectors
from move.sim.collection import Collection
from move.sim.demonstrations import Demonstrations
from move.sim.observe import keypoint_names
from move.sim.scene.scene import Scene
from move.sim.tasks import TASKS
from move.validation import validated
from move.video import write_video

FORMATS = ("lerobot", "zarr")
STATE, ENVIRONMENT, CAMERA = "observation.state", "observation.environment_state", "observation.images.camera"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
FIRST = {"chunk_index": 0, "file_index": 0}  # one file holds all episodes
# Colour is kept at full resolution and finely, because the object is a few pixels wide: about 1.5 of 255 levels are
# lost on average. Every second frame is a key frame, so that any window can be read without decoding what lies
# before it.
PIXEL_FORMAT = "yuv444p"
VIDEO_OPTIONS = {"crf": "8", "g": "2", "bf": "0", "preset": "medium"}


class Origin(BaseModel):
    """What was recorded, as the attributes of a data set say: a scene of this package, or whatever they name."""

    model_config = ConfigDict(frozen=True, strict=True)

    task: str = Field("unknown", max_length=200)
    robot_type: str = Field("unknown", max_length=200)
    fps: int = Field(int(Scene.metadata["render_fps"]), ge=1, le=1000, description="timesteps a second")

    @classmethod
    def of(cls, attributes: dict[str, Any]) -> Origin:
        """What `attributes` say.

        Raises:
            BadInput: a task, a robot or a rate that is none.
        """
        task = dataset.task_of(attributes)
        own = {"task": task, "robot_type": "metaworld_sawyer"} if task in TASKS else {}
        return validated(cls, {**own, **attributes}, "attributes")


def export(data: Path, out: Path, form: str, clip_actions: bool = False, whole_episodes: bool = False
           ) -> dict[str, Any]:
    """Write the demonstrations of folder `data` to the new folder `out`, whole or not at all.

    Args:
        data: a zarr folder that `move.learn.dataset.load` reads.
        form: one of `FORMATS`; "zarr" rewrites the store with the keys and checks of `move.learn.dataset.save`.
        clip_actions: see `move.learn.dataset.load`.
        whole_episodes: leave out what the budget of timesteps cut short, see `whole`.

    Returns:
        path, format, episodes, timesteps, observation ("images" or "numbers") and megabytes.

    Raises:
        BadInput: an unknown format, an `out` that exists or cannot be written, or data that cannot be read.
    """
    if form not in FORMATS:
        raise BadInput(f"format: {form!r} given; allowed are {', '.join(FORMATS)}")
    out = Path(out)
    refuse_existing(out)
    demonstrations, attributes = dataset.load(data, clip_actions)
    if whole_episodes:
        demonstrations, attributes = whole(demonstrations, attributes), {**attributes, "whole_episodes": True}
    if form == "zarr":
        dataset.save(demonstrations, out, attributes)
    else:
        with written_aside(out) as new:
            write_lerobot(demonstrations, new, attributes)
    size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
    return {"path": str(out), "format": form, "episodes": demonstrations.episodes,
            "timesteps": demonstrations.timesteps,
            "observation": "images" if demonstrations.has_images else "numbers", "megabytes": size / 1e6}


def whole(demonstrations: Demonstrations, attributes: dict[str, Any]) -> Demonstrations:
    """The demonstrations without the last one, if the budget of timesteps cut it; of a mixture without each method's.

    Args:
        attributes: what `move collect` stored with them: the collection and its record.

    Raises:
        BadInput: nothing says how they were collected, or none is whole.
    """
    try:
        collection = Collection.model_validate_json(json.dumps(attributes["collection"]))
        record = attributes["record"]
        steps = record["mean_steps"] * record["demonstrations"]  # before any was cut
    except (KeyError, TypeError, ValidationError) as error:
        raise BadInput("whole episodes: nothing says how these demonstrations were collected; allowed are those of "
                       "`move collect`") from error
    if round(steps) <= demonstrations.timesteps:
        return demonstrations
    budgets = np.cumsum([part.timesteps for part in collection.parts])
    kept = ~np.isin(demonstrations.episode_ends, budgets)
    if not kept.any():
        raise BadInput(f"whole episodes: none among {demonstrations.episodes}; allowed are larger collections")
    lengths, rows = demonstrations.lengths, np.repeat(kept, demonstrations.lengths)
    return Demonstrations(demonstrations.observations[rows], demonstrations.actions[rows], np.cumsum(lengths[kept]))


def write_lerobot(demonstrations: Demonstrations, folder: Path, attributes: dict[str, Any]) -> None:
    """Write a LeRobot v3.0 data set.

    Args:
        attributes: what was stored with the demonstrations; goes to meta/move.json as it is.
    """
    origin = Origin.of(attributes)
    numbers = _numbers(demonstrations, origin.fps)
    rows, stats = _episodes(demonstrations, numbers, origin)
    for name in (EPISODES, DATA[V3].format(**FIRST)):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
    columns = {name: vectors(values) if values.ndim == 2 else pa.array(values) for name, values in numbers.items()}
    pq.write_table(pa.table(columns), folder / DATA[V3].format(**FIRST))
    pq.write_table(pa.Table.from_pylist(rows), folder / EPISODES)
    tasks = pd.DataFrame({"task_index": [0]}, index=pd.Index([origin.task], name="task"))
    tasks.to_parquet(folder / "meta/tasks.parquet")
    info = _info(demonstrations, origin)
    (folder / "README.md").write_text(dataset_card(info, attributes), encoding="utf-8")
    for name, content in (("info", info), ("stats", pooled_stats(stats)), ("move", attributes)):
        (folder / f"meta/{name}.json").write_text(json.dumps(content, indent=1) + "\n")
    if demonstrations.has_images:
        images = demonstrations.observations
        write_video(folder / VIDEO[V3].format(video_key=CAMERA, **FIRST), images, images.shape[1:3], origin.fps,
                    PIXEL_FORMAT, VIDEO_OPTIONS)


def _numbers(demonstrations: Demonstrations, fps: int) -> dict[str, np.ndarray]:
    """Every column of the data file: vectors (timesteps, n) and scalars (timesteps,)."""
    seen = demonstrations.observations
    if demonstrations.has_images:
        observed = {STATE: np.zeros((len(seen), 2), np.float32)}
    else:
        observed = {STATE: seen, ENVIRONMENT: seen}
    return {**observed, "action": demonstrations.actions, **scalar_columns(demonstrations.lengths, fps)}


def _state_names(width: int, task: str) -> list[str]:
    """Names of the state's numbers: a keypoint and an axis each, where the task is known to have them."""
    points = keypoint_names(TASKS[task].keypoints) if task in TASKS else ()
    names = [f"{point} {axis}" for point in points for axis in ("right", "up", "forward")]
    return names if len(names) == width else [f"number {n}" for n in range(width)]


def _info(demonstrations: Demonstrations, origin: Origin) -> dict[str, Any]:
    """What meta/info.json holds."""
    width = demonstrations.actions.shape[1]
    action_names = ["x", "y", "z", "gripper"] if width == 4 else [f"number {n}" for n in range(width)]
    features: dict[str, Any] = {"action": {"dtype": "float32", "shape": [width], "names": action_names}}
    if demonstrations.has_images:
        height, across = demonstrations.observations.shape[1:3]
        features[STATE] = {"dtype": "float32", "shape": [2], "names": ["nothing 0", "nothing 1"]}
        features[CAMERA] = {
            "dtype": "video", "shape": [height, across, 3], "names": ["height", "width", "channels"],
            "info": {"video.height": height, "video.width": across, "video.channels": 3, "video.fps": origin.fps,
                     "video.codec": "h264", "video.pix_fmt": PIXEL_FORMAT, "video.is_depth_map": False,
                     "has_audio": False},
        }
    else:
        size = demonstrations.observations.shape[1]
        for name in (STATE, ENVIRONMENT):
            features[name] = {"dtype": "float32", "shape": [size], "names": _state_names(size, origin.task)}
    return {
        "codebase_version": "v3.0", "robot_type": origin.robot_type, "fps": origin.fps,
        "total_episodes": demonstrations.episodes, "total_frames": demonstrations.timesteps, "total_tasks": 1,
        "chunks_size": 1000, "data_files_size_in_mb": 100, "video_files_size_in_mb": 200,
        "splits": {"train": f"0:{demonstrations.episodes}"}, "data_path": DATA[V3],
        "video_path": VIDEO[V3] if demonstrations.has_images else None, "features": {**features, **scalar_features()},
    }


def _episodes(demonstrations: Demonstrations, numbers: dict[str, np.ndarray], origin: Origin
              ) -> tuple[list[dict[str, Any]], list[dict[str, Stats]]]:
    """One row an episode of the episode table, and by feature the statistics that it holds."""
    rows, stats = [], []
    for index, (end, length) in enumerate(zip(demonstrations.episode_ends, demonstrations.lengths, strict=True)):
        start = end - length
        found = {name: feature_stats(values[start:end].reshape(length, -1)) for name, values in numbers.items()}
        row = {"episode_index": index, "tasks": [origin.task], "length": int(length), "data/chunk_index": 0,
               "data/file_index": 0, "dataset_from_index": int(start), "dataset_to_index": int(end),
               "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
        if demonstrations.has_images:
            found[CAMERA] = feature_stats(demonstrations.observations[start:end])
            row |= {f"videos/{CAMERA}/chunk_index": 0, f"videos/{CAMERA}/file_index": 0,
                    f"videos/{CAMERA}/from_timestamp": start / origin.fps,
                    f"videos/{CAMERA}/to_timestamp": end / origin.fps}
        rows.append(row | {f"stats/{feature}/{name}": value for feature, values in found.items()
                           for name, value in values.items()})
        stats.append(found)
    return rows, stats
