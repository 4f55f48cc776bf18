"""LeRobot v2.1 (and v2.0): one parquet file and one video a camera for every episode.

meta/info.json  meta/episodes.jsonl  meta/tasks.jsonl  meta/episodes_stats.jsonl
data/chunk-000/episode_000000.parquet
videos/chunk-000/observation.images.<camera>/episode_000000.mp4
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from move.realworld.episode import EpisodeRef, Part, Recording
from move.realworld.formats import lerobot
from move.realworld.frames import Frames, from_video
from move.realworld.untrusted_names import fill_template, inside
from move.untrusted import parse_json, read_text, reading, within

DATA = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"


def metadata(files: Sequence[str]) -> list[str]:
    """Everything under `meta/`, but the statistics, which grow with the data and are not needed."""
    return [file for file in files if file.startswith("meta/") and "stats" not in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """List the episodes of `meta/episodes.jsonl`, or of the parquet files' names where that file is missing."""
    info = lerobot.read_info(part, "v2")
    lengths = _lengths(part)
    return [
        EpisodeRef(index, tuple(_files(info, index, str(part.root)).values()), length)
        for index, length in sorted(lengths.items())
    ]


def _lengths(part: Part) -> dict[int, int | None]:
    path = inside(part.root, "meta/episodes.jsonl")
    if not path.is_file():
        found = (re.fullmatch(r"data/.*episode_(\d+)\.parquet", file) for file in part.files)
        return {int(match.group(1)): None for match in found if match}
    with reading(path, "one JSON object a line with episode_index and length"):
        lines = [line for line in read_text(path).splitlines() if line.strip()]
        within("episodes", len(lines), path)
        rows = [parse_json(line, path) for line in lines]
        return {int(row["episode_index"]): within("rows", int(row["length"]), path) for row in rows}


def _files(info: lerobot.Info, index: int, where: str) -> dict[str, str]:
    """File names of one episode: "data" and one a video feature."""
    chunk = index // (info.chunks_size or 1000)
    values = {"episode_chunk": chunk, "episode_index": index}
    names = {"data": fill_template(info.data_path or DATA, values, where)}
    for key in info.cameras("video"):
        names[key] = fill_template(info.video_path or VIDEO, {**values, "video_key": key}, where)
    return names


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode; videos are opened only when frames are asked for."""
    info = lerobot.read_info(part, "v2")
    names = _files(info, ref.index, str(part.root))
    path = inside(part.root, names.pop("data"))
    with reading(path, "a parquet table of a LeRobot v2.1 episode"):
        table = lerobot.read_table(path, info)
        cameras: dict[str, Frames] = {key: from_video(inside(part.root, name)) for key, name in names.items()}
        return lerobot.recording(part, ref, info, table, path, cameras)
