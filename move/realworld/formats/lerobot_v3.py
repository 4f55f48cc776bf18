"""LeRobot v3.0: many episodes share a parquet file and a video.

meta/info.json  meta/stats.json  meta/tasks.parquet
meta/episodes/chunk-000/file-000.parquet     which file and which rows hold an episode
data/chunk-000/file-000.parquet
videos/observation.images.<camera>/chunk-000/file-000.mp4
"""

from __future__ import annotations

from collections.abc import Sequence

from move.realworld.episode import EpisodeRef, Part, Recording
from move.realworld.formats import lerobot
from move.realworld.frames import from_video
from move.realworld.parquet import numeric_names, read_columns
from move.realworld.untrusted_names import fill_template, inside
from move.untrusted import reading, within

DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEO = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"


def metadata(files: Sequence[str]) -> list[str]:
    """Everything under `meta/` but the statistics."""
    return [file for file in files if file.startswith("meta/") and "stats" not in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """List the episodes of `meta/episodes/`."""
    info = lerobot.read_info(part, "v3")
    refs: list[EpisodeRef] = []
    for name in sorted(file for file in part.files if file.startswith("meta/episodes/") and file.endswith(".parquet")):
        path = inside(part.root, name)
        with reading(path, "the episode table of a LeRobot v3.0 data set"):
            wanted = [name for name in numeric_names(path) if not name.startswith("stats/")]
            rows = read_columns(path, wanted).to_pylist()
            within("episodes", len(refs) + len(rows), path)
            refs += [_ref(info, row, str(path)) for row in rows]
    return sorted(refs, key=lambda ref: ref.index)


def _ref(info: lerobot.Info, row: dict, where: str) -> EpisodeRef:
    """Turn one row of the episode table into a reference."""
    place: dict[str, str | tuple[str, float]] = {
        "data": fill_template(
            info.data_path or DATA,
            {"chunk_index": int(row["data/chunk_index"]), "file_index": int(row["data/file_index"])}, where)
    }
    for key in info.cameras("video"):
        file: dict[str, int | str] = {
            "video_key": key, "chunk_index": int(row[f"videos/{key}/chunk_index"]),
            "file_index": int(row[f"videos/{key}/file_index"]),
        }
        name = fill_template(info.video_path or VIDEO, file, where)
        place[key] = (name, float(row[f"videos/{key}/from_timestamp"]))
    files = tuple(value if isinstance(value, str) else value[0] for value in place.values())
    return EpisodeRef(int(row["episode_index"]), files, int(row["length"]), place)


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode: its rows by `episode_index`, its frames from `from_timestamp` on."""
    info = lerobot.read_info(part, "v3")
    path = inside(part.root, ref.place["data"])
    with reading(path, "a parquet table of LeRobot v3.0 episodes"):
        table = lerobot.read_table(path, info, episode=ref.index)
        table = table.sort_by("frame_index") if "frame_index" in table.column_names else table
        cameras = {
            key: from_video(inside(part.root, value[0]), start_s=value[1], count=table.num_rows)
            for key, value in ref.place.items()
            if key != "data"
        }
        return lerobot.recording(part, ref, info, table, path, cameras)
