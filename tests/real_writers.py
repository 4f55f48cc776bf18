"""Tiny data sets in every layout, made by the official writers (pyarrow, h5py, zarr, PyAV)."""

import io
import json
from fractions import Fraction
from pathlib import Path

import av
import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import zarr
from PIL import Image

STEPS = 6
NAMES = [*(f"joint_{n}" for n in range(1, 7)), "gripper"]
SCALARS = {
    "timestamp": "float32", "frame_index": "int64", "episode_index": "int64", "index": "int64", "task_index": "int64",
}


def joints(episode: int = 0, steps: int = STEPS) -> np.ndarray:
    """(steps, 6) rad within PIPER's limits, another value in every cell."""
    base = np.array([0.1, 1.5, -1.5, 0.2, 0.5, -0.3])
    return base + 0.01 * np.arange(steps)[:, None] + 0.001 * np.arange(6) + 0.05 * episode


def state(episode: int = 0, steps: int = STEPS) -> np.ndarray:
    """(steps, 7): joints and a gripper in metres."""
    return np.column_stack([joints(episode, steps), np.linspace(0.09, 0.05, steps)])


def pose(steps: int = STEPS) -> np.ndarray:
    """(steps, 6) m and rad."""
    return np.column_stack(
        [np.linspace(0.2, 0.4, steps),
         np.full(steps, 0.1),
         np.full(steps, 0.2),
         np.full((steps, 3), 0.3)])


def picture(number: int, height: int = 16, width: int = 24) -> np.ndarray:
    """Red grows with the number, blue is low: tells frames and channel orders apart."""
    image = np.zeros((height, width, 3), np.uint8)
    image[..., 0], image[..., 1], image[..., 2] = min(40 + 30 * number, 255), 60, 10
    return image


def jpeg(number: int) -> bytes:
    """One encoded picture."""
    buffer = io.BytesIO()
    Image.fromarray(picture(number)).save(buffer, "JPEG", quality=95)
    return buffer.getvalue()


def write_video(path: Path, numbers, codec: str = "libx264", size: tuple[int, int] = (64, 64), fps: int = 10,
                draw=picture, times_s=None) -> Path:
    """Encode `draw(n, *size)` for each n, at a steady rate or at the given times (s)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unit = Fraction(1, 30_000)
    with av.open(str(path), "w") as container:
        stream = container.add_stream(
            codec, rate=fps, options={"g": "2", "crf": "20"} | ({"preset": "12"} if codec == "libsvtav1" else {}))
        stream.height, stream.width, stream.pix_fmt = *size, "yuv420p"
        if times_s is not None:
            stream.codec_context.time_base = unit
        for place, number in enumerate(numbers):
            frame = av.VideoFrame.from_ndarray(draw(number, *size), format="rgb24")
            if times_s is not None:
                frame.pts, frame.time_base = round(times_s[place] / unit), unit
            for packet in stream.encode(frame):
                container.mux(packet)
        for packet in stream.encode():
            container.mux(packet)
    return path


def grey(number: int, height: int = 64, width: int = 64) -> np.ndarray:
    """A picture as bright as its number, 0 to 255; `numbers_of` tells it back."""
    return np.full((height, width, 3), number, np.uint8)


def numbers_of(frames: np.ndarray) -> np.ndarray:
    """The numbers of `grey` pictures whose numbers are multiples of 4."""
    return (4 * np.round(frames.mean(axis=(1, 2, 3)) / 4)).astype(int)


def change_table(path: Path, **columns) -> Path:
    """Replace columns of a parquet table, or leave them out where None is given."""
    table = pq.read_table(path)
    for name, values in columns.items():
        table = table.drop_columns([name]) if name in table.column_names else table
        table = table if values is None else table.append_column(name, pa.array(values))
    pq.write_table(table, path)
    return path


def change_json(path: Path, **values) -> Path:
    """Replace values of a JSON object."""
    path.write_text(json.dumps(json.loads(path.read_text()) | values))
    return path


def vectors(values: np.ndarray, *, fixed: bool = True) -> pa.Array:
    """A column of vectors as LeRobot's recorder (fixed) or its converter (plain lists) writes it."""
    if fixed:
        return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
    return pa.array(values.tolist(), pa.list_(pa.from_numpy_dtype(values.dtype)))


def rows(episode: int, first: int, values: np.ndarray, *, fixed: bool = True, dtype=np.float32) -> dict:
    """The columns of one episode."""
    steps = np.arange(len(values))
    return {
        "observation.state": vectors(values.astype(dtype),
                                     fixed=fixed), "action": vectors(values[:, :7].astype(dtype), fixed=fixed),
        "timestamp": (steps / 10).astype(np.float32), "frame_index": steps,
        "episode_index": np.full(len(steps), episode), "index": steps + first, "task_index": np.zeros(len(steps), int),
    }


def info(version: str, *, names=NAMES, width: int = 7, cameras: dict | None = None, key: str = "names",
         **extra) -> dict:
    """An info.json; `cameras` maps a feature name to its dtype."""
    features = {
        "observation.state": {"dtype": "float32", "shape": [width], key: names},
        "action": {"dtype": "float32", "shape": [7], "names": NAMES},
    }
    features |= {name: {"dtype": dtype, "shape": [3, 16, 24], "names": None} for name, dtype in (cameras or {}).items()}
    features |= {name: {"dtype": dtype, "shape": [1], "names": None} for name, dtype in SCALARS.items()}
    return {"codebase_version": version, "robot_type": "piper", "fps": 10, "chunks_size": 1000, "features": features,
            } | extra


def lerobot_v2(folder: Path, *, episodes: int = 2, codec: str | None = None, values=state, dtype=np.float32,
               fixed: bool = True, image_column: bool = False, **about) -> Path:
    """Write a LeRobot v2.1 data set; `codec` adds a camera `wrist`, `image_column` one inside the parquet file."""
    cameras = ({"observation.images.wrist": "video"} if codec else {}) | ({"observation.images.front": "image"}
                                                                          if image_column else {})
    (folder / "meta").mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(info("v2.1", cameras=cameras, **about)))
    lines = [json.dumps({"episode_index": n, "tasks": ["t"], "length": STEPS}) for n in range(episodes)]
    (folder / "meta/episodes.jsonl").write_text("\n".join(lines))
    (folder / "data/chunk-000").mkdir(parents=True)
    for n in range(episodes):
        columns = rows(n, n * STEPS, values(n), fixed=fixed, dtype=dtype)
        if image_column:
            columns["observation.images.front"] = pa.array([{"bytes": jpeg(k), "path": None} for k in range(STEPS)],
                                                           pa.struct([("bytes", pa.binary()), ("path", pa.string())]))
        pq.write_table(pa.table(columns), folder / f"data/chunk-000/episode_{n:06d}.parquet")
        if codec:
            write_video(folder / f"videos/chunk-000/observation.images.wrist/episode_{n:06d}.mp4",
                        range(n, n + STEPS), codec)
    return folder


def lerobot_v3(folder: Path, *, episodes: int = 3, codec: str = "libx264") -> Path:
    """Write a LeRobot v3.0 data set: all episodes in one parquet file and one video."""
    camera = "observation.images.wrist"
    for name in ("meta/episodes/chunk-000", "data/chunk-000"):
        (folder / name).mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(info("v3.0", cameras={camera: "video"})))
    tables = [pa.table(rows(n, n * STEPS, state(n))) for n in range(episodes)]
    pq.write_table(pa.concat_tables(tables), folder / "data/chunk-000/file-000.parquet")
    write_video(folder / f"videos/{camera}/chunk-000/file-000.mp4",
                [n for e in range(episodes) for n in range(e, e + STEPS)], codec)
    listing = [{
        "episode_index": n, "tasks": ["t"], "length": STEPS, "data/chunk_index": 0, "data/file_index": 0,
        f"videos/{camera}/chunk_index": 0, f"videos/{camera}/file_index": 0,
        f"videos/{camera}/from_timestamp": n * STEPS / 10, f"videos/{camera}/to_timestamp": (n + 1) * STEPS / 10,
        "stats/action/min": [0.0],
    } for n in range(episodes)]
    pq.write_table(pa.Table.from_pylist(listing), folder / "meta/episodes/chunk-000/file-000.parquet")
    return folder


def pika_tree(folder: Path, *, synced: bool = True, episodes: int = 1) -> Path:
    """Write a Pika raw tree; without sync.txt the camera runs at half the rate of the arm."""
    for n in range(episodes):
        times = 1_700_000_000 + np.arange(STEPS) / 30
        values, six = state(n), pose()
        sensors = {
            "arm/jointState/puppet": [{"position": v.tolist(), "velocity": [], "effort": []} for v in values],
            "arm/jointState/master": [{"position": (v + 0.01).tolist(), "velocity": [], "effort": []} for v in values],
            "arm/endPose/puppet": [
                dict(zip(("x", "y", "z", "roll", "pitch", "yaw"), p.tolist(), strict=True)) for p in six
            ], "gripper/encoder/pikaGripper": [{"angle": 1.0, "distance": float(v[6])} for v in values],
        }
        for name, readings in sensors.items():
            place = folder / f"episode{n}" / name
            place.mkdir(parents=True)
            for t, reading in zip(times, readings, strict=True):
                (place / f"{t:.6f}.json").write_text(json.dumps(reading))
            if synced:
                (place / "sync.txt").write_text("\n".join(f"{t:.6f}.json" for t in times))
        place = folder / f"episode{n}/camera/color/pikaGripperDepthCamera"
        place.mkdir(parents=True)
        kept = range(STEPS) if synced else range(0, STEPS, 2)
        for k in kept:
            (place / f"{times[k]:.6f}.jpg").write_bytes(jpeg(k))
        if synced:
            (place / "sync.txt").write_text("\n".join(f"{times[k]:.6f}.jpg" for k in kept))
    return folder


def pika_hdf5(folder: Path, *, by_path: bool = True, image_name: str = "camera/color/cam/{}.jpg") -> Path:
    """Write one Pika HDF5 episode, its images beside it or inside it (blue first)."""
    place = folder / "episode0"
    place.mkdir(parents=True)
    with h5py.File(place / "data.hdf5", "w") as file:
        file["arm/jointStatePosition/puppet"], file["arm/jointStatePosition/master"] = state(), state() + 0.01
        file["arm/endPose/puppet"] = np.column_stack([pose(), np.full(STEPS, 0.05)])
        file["gripper/encoderDistance/pikaGripper"] = state()[:, 6]
        file["timestamp"] = 1_700_000_000 + np.arange(STEPS) / 30
        file["size"] = STEPS
        if by_path:
            names = [image_name.format(n) for n in range(STEPS)]
            file.create_dataset("camera/color/cam", data=np.array([n.encode() for n in names]))
            (place / "camera/color/cam").mkdir(parents=True)
            for n in range(STEPS):
                (place / f"camera/color/cam/{n}.jpg").write_bytes(jpeg(n))
        else:
            file["camera/color/cam"] = np.stack([picture(n)[..., ::-1] for n in range(STEPS)])
            file["camera/depth/cam"] = np.zeros((STEPS, 4, 4, 3), np.uint8)
    return folder


def act_hdf5(folder: Path, *, arms: int = 1, images: str = "HWC") -> Path:
    """Write one ACT episode; `images`: HWC, CHW, padded (JPEG in rows of equal length) or vlen."""
    folder.mkdir(parents=True)
    values = state() if arms == 1 else np.hstack([np.repeat(state()[:1], STEPS, axis=0), state()])
    with h5py.File(folder / "episode_0.hdf5", "w") as file:
        file.attrs["sim"] = False
        file["observations/qpos"] = values.astype(np.float32)
        file["action"] = values.astype(np.float32)
        if images in ("HWC", "CHW"):
            stack = np.stack([picture(n) for n in range(STEPS)])
            file["observations/images/top"] = stack if images == "HWC" else np.moveaxis(stack, 3, 1)
        elif images == "padded":
            encoded = [jpeg(n) for n in range(STEPS)]
            width = max(map(len, encoded)) + 20
            file["observations/images/top"] = np.stack(
                [np.frombuffer(e.ljust(width, b"\0"), np.uint8) for e in encoded])
        else:
            data = file.create_dataset("observations/images/top", (STEPS,), dtype=h5py.vlen_dtype(np.uint8))
            for n in range(STEPS):
                data[n] = np.frombuffer(jpeg(n), np.uint8)
    return folder


def robomind_hdf5(folder: Path, *, two_arms: bool = False) -> Path:
    """Write one RoboMIND episode whose camera is one frame shorter than its arm."""
    place = folder / "put_orange/success_episodes/1017_163121/data"
    place.mkdir(parents=True)
    with h5py.File(place / "trajectory.hdf5", "w") as file:
        for side in ("_left", "_right") if two_arms else ("",):
            still = two_arms and side == "_left"
            file[f"puppet/joint_position{side}"] = np.repeat(state()[:1], STEPS, axis=0) if still else state()
            file[f"master/joint_position{side}"] = state()[:-1] + 0.01
            file[f"puppet/end_effector{side}"] = pose()
        data = file.create_dataset("observations/rgb_images/camera_top", (STEPS - 1,), dtype=h5py.vlen_dtype(np.uint8))
        for n in range(STEPS - 1):
            data[n] = np.frombuffer(jpeg(n), np.uint8)
    return folder


def zarr_buffer(folder: Path, *, zarr_format: int = 2, simulation: bool = False, zipped: bool = False) -> Path:
    """Write a replay buffer of two episodes of 6 and 4 steps."""
    folder.mkdir(parents=True)
    store = (zarr.storage.ZipStore(folder
                                   / "replay_buffer.zarr.zip", mode="w") if zipped else str(folder
                                                                                            / "replay_buffer.zarr"))
    group = zarr.open_group(store, mode="w", zarr_format=zarr_format)
    total = STEPS + 4
    arrays = {"action": state(0, total).astype(np.float32)}
    if simulation:
        arrays |= {
            "img": np.stack([picture(n % 7) for n in range(total)]), "state": np.zeros((total, 9), np.float32),
            "full_state": np.zeros((total, 39), np.float32),
        }
    else:
        arrays |= {
            "robot_joint": joints(0, total), "robot_eef_pose": pose(total), "timestamp": 5 + np.arange(total) / 10,
        }
    for name, values in arrays.items():
        group.create_array(f"data/{name}", data=values, chunks=(4, *values.shape[1:]))
    group.create_array("meta/episode_ends", data=np.array([STEPS, total], np.int64))
    if zipped:
        store.close()
    return folder


LAYOUTS = {
    "LeRobot v2.1": lerobot_v2, "LeRobot v3.0": lerobot_v3, "Pika tree": pika_tree, "Pika HDF5": pika_hdf5,
    "ACT": act_hdf5, "RoboMIND": robomind_hdf5, "zarr": zarr_buffer,
    "zarr in a zip": lambda folder: zarr_buffer(folder, zipped=True),
    "authors' zarr": lambda folder: zarr_buffer(folder, simulation=True),
}
