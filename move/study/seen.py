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
from move.learn.evaluation import Evaluation, starts
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


def nearest_place(spec: PolicyRun) -> np.ndarray:
    """Metres in the plane from each place of the object that a run tries to the nearest that it saw, (trials,)."""
    return _nearest_place(_blind(spec.collection), spec.seed, spec.evaluation)


def nearest_timesteps(spec: PolicyRun) -> np.ndarray:
    """How far each configuration that a run tries is from timesteps that it saw, (trials, `SEARCHES`, factors).

    Which timestep is nearest depends on the factors' length scales; these are the nearest ones under many sets of them.
    Distances are metres for object, target and hand, radians for yaw and camera, in the order of `FACTORS`.
    """
    return _nearest_timesteps(_blind(spec.collection), spec.seed, spec.evaluation)


def before_grasp(spec: PolicyRun) -> dict[str, np.ndarray]:
    """Where everything was before the grasps in a run's demonstrations, by factor: (configurations, coordinates).

    Metres and radians, each configuration once; collected once a machine and version. Failed attempts are left out
    where the data set has none.
    """
    return _before_grasp(_blind(spec.collection), spec.seed)


def _blind(collection: Collection) -> Collection:
    """The collection as it is without images."""
    return collection.model_copy(update={"observation": "keypoints",
                                         "image_size": Collection.model_fields["image_size"].default})


@cache
def _nearest_place(collection: Collection, seed: int, evaluation: Evaluation) -> np.ndarray:
    from scipy.spatial import cKDTree  # slow to import

    places = _tried(collection, evaluation)[list(FACTORS["object"])].to_numpy()
    return cKDTree(_before_grasp(collection, seed)["object"]).query(places)[0]


@cache
def _nearest_timesteps(collection: Collection, seed: int, evaluation: Evaluation) -> np.ndarray:
    seen, tried = _before_grasp(collection, seed), _tried(collection, evaluation)
    apart = np.stack([np.sqrt(sum((tried[column].to_numpy(np.float32)[:, None] - seen[name][:, axis]) ** 2
                                  for axis, column in enumerate(columns)))
                      for name, columns in FACTORS.items()], axis=-1)
    low, high = np.log(np.array([SCALES[name] for name in FACTORS])).T
    scales = np.exp(np.random.default_rng(0).uniform(low, high, (SEARCHES, len(FACTORS))))
    places = [np.argmin(apart**2 @ (1 / scale**2).astype(np.float32), axis=1) for scale in scales]
    return np.take_along_axis(apart, np.stack(places, axis=1)[:, :, None], axis=1)


def _tried(collection: Collection, evaluation: Evaluation) -> pd.DataFrame:
    """The configurations of an evaluation, one row a trial; metres and radians."""
    task = get_task(collection.task).variant(evaluation.fixed)
    return pd.DataFrame([start.configuration.columns() for start in starts(task, evaluation)])


def _before_grasp(collection: Collection, seed: int) -> dict[str, np.ndarray]:
    key = json.dumps([collection.model_dump(mode="json"), seed, deciding()], sort_keys=True)
    path = paths.BUILD / "seen" / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}.npz"
    if (found := _read(path)) is not None:
        return found
    from move.sim.coverage import configurations  # imports the simulator

    rows = configurations(collection, seed)
    columns = [column for names in FACTORS.values() for column in names]
    once = rows[rows.phase == "pick"][columns].drop_duplicates()
    found = {name: once[list(names)].to_numpy(np.float32) for name, names in FACTORS.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    with written_aside(path) as new, new.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **found)
    return found


def _read(path: Path) -> dict[str, np.ndarray] | None:
    try:
        with np.load(path, allow_pickle=False) as stored:
            return {name: stored[name] for name in FACTORS}
    except (OSError, ValueError, KeyError, BadZipFile):  # not there, or not as it was written
        return None
