"""A small simulated data set in the real layout, so that every function can be tried without the real one.

Not a measurement and not physics: a point-like gripper follows straight lines over a table, an orange lies still
(static) or wanders until it is grasped (MOVE), and both end on a tray. Joint angles come from PIPER's kinematics.
Two LeRobot v2.1 parts are written, `static_sample/` and `move_sample/`, next to a `SIMULATED.json` that says so.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from move.errors import BadInput
from move.files import written_aside
from move.paper import REAL_RADIUS_M
from move.realworld.dataset import SIMULATED
from move.realworld.lerobot_files import DATA, V2, VIDEO, scalar_columns, scalar_features, vectors
from move.realworld.piper import forward_kinematics, reach
from move.untrusted import read_json
from move.video import write_video

FPS = 5
CAMERA = "observation.images.cam_global"
SIZE = (72, 128)  # image height, width
METRES_PER_PIXEL = 0.010  # the camera looks straight down on 0.72 m x 1.28 m
ORANGE_RGB, TRAY_RGB, GRIPPER_RGB = (245, 130, 20), (70, 90, 200), (40, 40, 40)
TABLE_RGB, FLOOR_RGB = (222, 222, 216), (180, 180, 178)  # inside the semicircular workspace, and outside it
HEIGHT_M = {"travel": 0.26, "grasp": 0.15}
OPEN_M, HOLD_M = 0.095, 0.062
SPEED_M_PER_S = 0.06  # of what wanders
NAMES = [*(f"joint_{n}" for n in range(1, 7)), "gripper", "x", "y", "z", "roll", "pitch", "yaw"]
METHODS = ("static", "move")
LOSSLESS = {"qp": "0", "g": "100", "preset": "medium"}  # what is drawn from the frames is the same on every machine


@dataclass(frozen=True)
class Toy:
    """One toy demonstration of T timesteps."""

    flange_m: np.ndarray  # (T, 3) where the flange should be
    orange_m: np.ndarray  # (T, 2)
    tray_m: np.ndarray  # (T, 2)
    gripper_m: np.ndarray  # (T,)


def write_sample(folder: Path, *, seed: int = 0, episodes: int = 20) -> Path:
    """Write the sample, or keep the one that is already there with the same seed and at least as many demonstrations.

    Args:
        folder: where to write; its name is free.
        seed: the same seed gives the same numbers.
        episodes: demonstrations of each method.

    Returns:
        `folder`, to be given to `open_dataset`.

    Raises:
        BadInput: the folder holds something else, or cannot be written.
    """
    folder = Path(folder)
    about = {
        "simulated": True, "what": "kinematic toy in the real layout", "seed": seed, "episodes": episodes,
        "metres_per_pixel": METRES_PER_PIXEL, "version": 2,
    }
    if folder.is_dir() and (there := sorted(path.name for path in folder.iterdir())):
        if SIMULATED not in there:
            raise BadInput(f"{folder} holds {there[0][:60]}, and no sample; allowed is a new folder, or a sample's own")
        if _serves(folder / SIMULATED, about):
            return folder
    with written_aside(folder) as new:
        for method, stream in zip(METHODS, np.random.SeedSequence(seed).spawn(2), strict=True):
            rng = np.random.default_rng(stream)
            _write_part(new / f"{method}_sample",
                        [toy_demonstration(rng, moving=method == "move") for _ in range(episodes)])
        (new / SIMULATED).write_text(json.dumps(about, indent=1), encoding="utf-8")
    return folder


def _serves(mark: Path, about: dict[str, Any]) -> bool:
    """Whether a sample says of itself what `about` does, with at least as many demonstrations."""
    try:
        there = read_json(mark, "what a sample says of itself")
        return there.get("episodes", 0) >= about["episodes"] and {**there, "episodes": about["episodes"]} == about
    except (BadInput, TypeError):
        return False


def toy_demonstration(rng: np.random.Generator, *, moving: bool) -> Toy:
    """Make one demonstration: over the orange, down, close, up, over the tray, down, open.

    Args:
        moving: whether the orange wanders until the grasp, and the tray after it.
    """
    steps = round(FPS * rng.normal(18.3 if moving else 15.3, 1.0))
    grasp = int(steps * rng.uniform(0.45, 0.55))
    orange = _wander(rng, grasp, moving)
    tray = _wander(rng, steps - grasp, moving)
    while np.linalg.norm(tray[-1] - orange[-1]) < 0.2:
        tray = _wander(rng, steps - grasp, moving)
    tray = np.vstack([np.repeat(tray[:1], grasp, axis=0), tray])
    hand = _towards(rng, np.array([0.25, 0.0]) + rng.normal(0, 0.01, 2), orange)
    carry = _towards(rng, hand[-1], tray[grasp:])
    down = np.concatenate([_dip(grasp), np.minimum(_dip(steps - grasp)[::-1] + _dip(steps - grasp), 1)])
    flange = np.column_stack(
        [np.vstack([hand, carry]), HEIGHT_M["travel"] + (HEIGHT_M["grasp"] - HEIGHT_M["travel"]) * down])
    release = steps - 3
    gripper = np.full(steps, OPEN_M)
    gripper[grasp:release] = HOLD_M
    carried = carry[np.minimum(np.arange(steps - grasp), release - grasp - 1)]
    orange = np.vstack([orange, carried])
    return Toy(flange, orange, tray, gripper + rng.normal(0, 3e-4, steps))


def _wander(rng: np.random.Generator, steps: int, moving: bool) -> np.ndarray:
    """A place on the table, (steps, 2); a moving one turns slowly and stays within the reachable ring."""
    while True:
        radius, angle = np.sqrt(rng.uniform(0.25**2, 0.52**2)), rng.uniform(-1.3, 1.3)
        start = radius * np.array([np.cos(angle), np.sin(angle)])
        if not moving:
            return np.repeat(start[None], steps, axis=0)
        heading = rng.uniform(-np.pi, np.pi) + np.cumsum(rng.normal(0, 0.12, steps))
        path = start + np.cumsum(SPEED_M_PER_S / FPS * np.column_stack([np.cos(heading), np.sin(heading)]), axis=0)
        distance = np.linalg.norm(path, axis=1)
        if distance.min() > 0.22 and distance.max() < 0.54 and path[:, 0].min() > 0.05:
            return path


def _towards(rng: np.random.Generator, start: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Follow a goal that may move: the gap closes smoothly, with a little sideways error of a human hand."""
    linear = np.clip(np.linspace(0, 1.25, len(goal)), 0, 1)
    share = linear**2 * (3 - 2 * linear)
    wobble = rng.normal(0, 0.02, 2) * np.sin(np.pi * share)[:, None]
    return start + share[:, None] * (goal - start) + wobble


def _dip(steps: int) -> np.ndarray:
    """0 while travelling, rising to 1 (down) over the last fifth."""
    return np.clip((np.linspace(0, 1, steps) - 0.8) / 0.15, 0, 1)


def draw(toy: Toy, step: int) -> np.ndarray:
    """The view of a camera straight above the table, (height, width, 3) uint8; the base is at the lower middle."""
    rows, columns = np.mgrid[:SIZE[0], :SIZE[1]]
    x = (SIZE[0] - 3 - rows) * METRES_PER_PIXEL
    y = (SIZE[1] / 2 - 0.5 - columns) * METRES_PER_PIXEL
    image = np.empty((*SIZE, 3), np.uint8)
    image[:] = FLOOR_RGB
    image[(np.hypot(x, y) < REAL_RADIUS_M) & (x >= 0)] = TABLE_RGB
    tray, orange, hand = toy.tray_m[step], toy.orange_m[step], toy.flange_m[step, :2]
    image[(np.abs(x - tray[0]) < 0.09) & (np.abs(y - tray[1]) < 0.09)] = TRAY_RGB
    image[np.hypot(x - orange[0], y - orange[1]) < 0.045] = ORANGE_RGB
    jaw = (np.abs(x - hand[0]) < 0.030) & (np.abs(np.abs(y - hand[1]) - toy.gripper_m[step] / 2 - 0.02) < 0.012)
    image[jaw] = GRIPPER_RGB
    return image


def _write_part(folder: Path, toys: list[Toy]) -> None:
    """Write demonstrations as one LeRobot v2.1 data set."""
    (folder / "meta").mkdir(parents=True, exist_ok=True)
    joints = np.split(reach(np.vstack([toy.flange_m for toy in toys])),
                      np.cumsum([len(toy.flange_m) for toy in toys])[:-1])
    first = 0
    lines = []
    for index, (toy, angles) in enumerate(zip(toys, joints, strict=True)):
        state = np.column_stack([angles, toy.gripper_m, forward_kinematics(angles)]).astype(np.float32)
        _write_table(folder / f"data/chunk-000/episode_{index:06d}.parquet", state, index, first)
        write_video(folder / f"videos/chunk-000/{CAMERA}/episode_{index:06d}.mp4",
                    (draw(toy, step) for step in range(len(state))), SIZE, FPS, "rgb24", LOSSLESS,
                    codec="libx264rgb")
        lines.append(json.dumps({"episode_index": index, "tasks": ["put the orange on the tray"],
                                 "length": len(state)}))
        first += len(state)
    (folder / "meta/episodes.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "meta/tasks.jsonl").write_text('{"task_index": 0, "task": "put the orange on the tray"}\n',
                                             encoding="utf-8")
    (folder / "meta/info.json").write_text(json.dumps(_info(len(toys), first), indent=1), encoding="utf-8")


def _info(episodes: int, frames: int) -> dict:
    return {
        "codebase_version": "v2.1", "robot_type": "piper", "total_episodes": episodes, "total_frames": frames,
        "total_tasks": 1, "total_videos": episodes, "total_chunks": 1, "chunks_size": 1000, "fps": FPS,
        "splits": {"train": f"0:{episodes}"}, "data_path": DATA[V2], "video_path": VIDEO[V2],
        "features": {
            "observation.state": {"dtype": "float32", "shape": [len(NAMES)], "names": NAMES},
            "action": {"dtype": "float32", "shape": [7], "names": NAMES[:7]},
            CAMERA: {"dtype": "video", "shape": [*SIZE, 3], "names": ["height", "width", "channels"]},
            **scalar_features(),
        },
    }


def _write_table(path: Path, state: np.ndarray, index: int, first: int) -> None:
    """Write one episode; the action is the next step's joints and gripper."""
    path.parent.mkdir(parents=True, exist_ok=True)
    action = np.vstack([state[1:, :7], state[-1:, :7]])
    scalars = scalar_columns(np.array([len(state)]), FPS, first_episode=index, first_index=first)
    table = pa.table({"observation.state": vectors(state), "action": vectors(action), **scalars})
    pq.write_table(table, path, compression="zstd", use_dictionary=False, write_statistics=False)
