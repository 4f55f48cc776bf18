"""What training saw: the collection of a run made again without images, in seconds, and kept under build/seen.

The same collection, seed and versions give the same configurations, whatever is kept of each timestep. What counts is
where everything was before the grasp, or before the first touch: afterwards the hand has the object.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import pandas as pd

from move import paths
from move.files import written_aside
from move.learn.evaluation import starts
from move.sim.collection import Collection
from move.sim.tasks import get_task
from move.study.provenance import deciding
from move.study.spec import PolicyRun

FACTORS: dict[str, tuple[str, ...]] = {
    "object": ("object_x", "object_y"), "yaw": ("object_yaw",), "target": ("target_x", "target_y", "target_z"),
    "camera": ("camera_angle",), "hand": ("hand_x", "hand_y", "hand_z"),
}
"""What is random, and its coordinates in metres and radians; the object's are those in the table's plane."""
SCALES = {"object": (0.01, 0.4), "yaw": (0.05, 4.0), "target": (0.01, 0.4), "camera": (0.05, 4.0), "hand": (0.02, 0.8)}
"""Length scales, from and to, under which a nearest timestep is looked for, in metres and radians."""
SEARCHES = 32  # sets of length scales: under any other set one of the timesteps found is nearest, or nearly so


@cache
def nearest_place(spec: PolicyRun) -> np.ndarray:
    """Metres in the plane from each place of the object that a run tries to the nearest that it saw, (trials,)."""
    from scipy.spatial import cKDTree  # slow to import

    places = _tried(spec)[list(FACTORS["object"])].to_numpy()
    return cKDTree(before_grasp(spec)["object"]).query(places)[0]


@cache
def nearest_timesteps(spec: PolicyRun) -> np.ndarray:
    """How far each configuration that a run tries is from timesteps that it saw, (trials, `SEARCHES`, factors).

    Which timestep is nearest depends on the factors' length scales; these are the nearest ones under many sets of them.
    Distances are metres for object, target and hand, radians for yaw and camera, in the order of `FACTORS`.
    """
    seen, tried = before_grasp(spec), _tried(spec)
    apart = np.stack([np.sqrt(sum((tried[column].to_numpy(np.float32)[:, None] - seen[name][:, axis]) ** 2
                                  for axis, column in enumerate(columns)))
                      for name, columns in FACTORS.items()], axis=-1)
    low, high = np.log(np.array([SCALES[name] for name in FACTORS])).T
    scales = np.exp(np.random.default_rng(0).uniform(low, high, (SEARCHES, len(FACTORS))))
    places = [np.argmin(apart**2 @ (1 / scale**2).astype(np.float32), axis=1) for scale in scales]
    return np.take_along_axis(apart, np.stack(places, axis=1)[:, :, None], axis=1)


def _tried(spec: PolicyRun) -> pd.DataFrame:
    """The configurations that a run tries, one row a trial; metres and radians."""
    task = get_task(spec.task).variant(spec.evaluation.fixed)
    return pd.DataFrame([start.configuration.columns() for start in starts(task, spec.evaluation)])


def before_grasp(spec: PolicyRun) -> dict[str, np.ndarray]:
    """Where everything was before the grasps in a run's demonstrations, by factor: (configurations, coordinates).

    Metres and radians, each configuration once; collected once a machine and version. Failed attempts are left out, as
    in the data set itself.
    """
    collection = _blind(spec.collection)
    key = json.dumps([collection.model_dump(mode="json"), spec.seed, deciding()], sort_keys=True)
    path = paths.BUILD / "seen" / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}.npz"
    if (found := _read(path)) is not None:
        return found
    from move.sim.coverage import configurations  # imports the simulator

    rows = configurations(collection, spec.seed)
    columns = [column for names in FACTORS.values() for column in names]
    once = rows[rows.phase == "pick"][columns].drop_duplicates()
    found = {name: once[list(names)].to_numpy(np.float32) for name, names in FACTORS.items()}
    with written_aside(path) as new, new.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **found)
    return found


def _blind(collection: Collection) -> Collection:
    """The collection as it is without images."""
    return collection.model_copy(update={"observation": "keypoints",
                                         "image_size": Collection.model_fields["image_size"].default})


def _read(path: Path) -> dict[str, np.ndarray] | None:
    try:
        with np.load(path, allow_pickle=False) as stored:
            return {name: stored[name] for name in FACTORS}
    except (OSError, ValueError, KeyError, BadZipFile):  # not there, or not as it was written
        return None
