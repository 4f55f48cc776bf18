"""Episodes on disk and windows of (observation, action).

All episodes lie behind one another in one array; `episode_ends[i]` is the timestep after the last one of
episode i. Each timestep t gives one window, so that equal timesteps mean equal training data for every method.
With an observation horizon of 2, a prediction horizon of 4 and an action horizon of 3:

    timestep       t-1    t    t+1   t+2
    observed        x     x
    predicted       x     x     x     x
    executed              x     x     x

What would reach over the edge of an episode repeats its first or its last timestep.
"""

import hashlib
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from move.errors import BadInput
from move.files import put_away_remains, refuse_unwritable, written_aside
from move.sim.demonstrations import Demonstrations, fingerprint
from move.untrusted import bounded_memory, plain_files, within
from move.untrusted_zarr import missing_chunks, opened_group, plain_array

CHUNK_TIMESTEPS = 256
FAR, NOISE = 100.0, 1e-10  # a size from which on differences may be lost in float32; the share of it that is noise
OBSERVED = ("data/img", "data/keypoints", "data/state")  # the first one that is there
MARK, DIGEST = "collection", "collection_digest"  # attributes of every data set that is made here
WRITTEN = re.compile(r"\.z(group|attrs)|(data|meta)/(\.z(group|attrs)|\w+/(\.z(array|attrs)|\d+(\.\d+)*))")  # by `save`


def window_indices(
    episode_ends: np.ndarray, observation_horizon: int, prediction_horizon: int
) -> tuple[np.ndarray, np.ndarray]:
    """Timesteps that each window observes and predicts, one window a timestep.

    Returns observation_index (timesteps, observation_horizon) and action_index (timesteps, prediction_horizon),
    both int64; both begin observation_horizon - 1 timesteps before the window's own.

    >>> observed, predicted = window_indices(np.array([4, 6]), 2, 4)
    >>> observed.tolist()
    [[0, 0], [0, 1], [1, 2], [2, 3], [4, 4], [4, 5]]
    >>> predicted[3].tolist(), predicted[4].tolist()
    ([2, 3, 3, 3], [4, 4, 5, 5])
    """
    lengths = np.diff(episode_ends, prepend=0)
    first = np.repeat(episode_ends - lengths, lengths)[:, None]
    last = np.repeat(episode_ends - 1, lengths)[:, None]
    start = np.arange(len(first))[:, None] - (observation_horizon - 1)
    observed = np.clip(start + np.arange(observation_horizon), first, last)
    predicted = np.clip(start + np.arange(prediction_horizon), first, last)
    return observed, predicted


def save(demonstrations: Demonstrations, path: Path, attributes: dict[str, Any], overwrite: bool = False) -> None:
    """Write a zarr group in diffusion_policy's replay-buffer layout, or nothing at all.

        data/img or data/keypoints    data/action    meta/episode_ends    attributes (JSON), with a digest of it all

    The group is zarr format 2, which diffusion_policy itself can read. An older one at `path` stays until the new one
    is whole. Raises BadInput if the attributes are not JSON, and whatever `check_place` refuses.
    """
    try:
        json.dumps(attributes)
    except TypeError as error:
        raise BadInput(f"attributes that JSON cannot hold: {error}") from None
    path = Path(path)
    check_place(path, overwrite)
    with written_aside(path) as beside:
        _write(demonstrations, beside, attributes)


def check_place(path: Path, overwrite: bool = False) -> None:
    """Refuse a place where `save` could not or must not write, before any work is done.

    Raises:
        BadInput: nothing can be written there, or something is there: what is not a data set of ours in any case, and
            one of ours unless `overwrite` is given.
    """
    refuse_unwritable(path)
    put_away_remains(path)
    if not path.exists() and not path.is_symlink():
        return
    if not _is_ours(path):
        raise BadInput(f"{path} exists and is not, or not only, a data set of `move collect`; allowed is a new folder")
    if not overwrite:
        raise BadInput(f"{path} exists; allowed is a new folder, or --overwrite to replace this data set")


def _is_ours(path: Path) -> bool:
    """Whether `path` is a folder in which `save` wrote everything, with the mark of a collection."""
    if path.is_symlink() or not path.is_dir():
        return False
    try:
        attributes = json.loads((path / ".zattrs").read_text())
    except (OSError, ValueError, RecursionError):
        return False
    written = [found.relative_to(path).as_posix() for found in path.rglob("*")
               if found.is_symlink() or not found.is_dir()]
    return isinstance(attributes, dict) and MARK in attributes and all(map(WRITTEN.fullmatch, written))


def _write(demonstrations: Demonstrations, path: Path, attributes: dict[str, Any]) -> None:
    arrays = {
        f"data/{'img' if demonstrations.has_images else 'keypoints'}": demonstrations.observations,
        "data/action": demonstrations.actions,
        "meta/episode_ends": demonstrations.episode_ends,
    }
    sealed = {**attributes, DIGEST: _digest(list(arrays.values()), attributes)}
    group = zarr.create_group(path, zarr_format=2, attributes=sealed)
    for name, array in arrays.items():
        chunks = (min(CHUNK_TIMESTEPS, len(array)), *array.shape[1:])
        group.create_array(name, data=array, chunks=chunks, config={"write_empty_chunks": True})


def _digest(arrays: Sequence[np.ndarray], attributes: dict[str, Any]) -> str:
    """Of observations, actions and episode ends as they are stored, and of the attributes but for the digest."""
    rest = json.loads(json.dumps({name: value for name, value in attributes.items() if name != DIGEST}))
    return hashlib.sha256(f"{fingerprint(*arrays)} {json.dumps(rest, sort_keys=True)}".encode()).hexdigest()


def _refuse_changed(arrays: Sequence[np.ndarray], attributes: dict[str, Any]) -> None:
    """Refuse a data set of `move collect` that is not as it was written."""
    if DIGEST not in attributes:
        raise BadInput("it has no digest, which `move collect` writes; collect it again")
    if attributes[DIGEST] != _digest(arrays, attributes):
        raise BadInput("its content does not fit its digest: damaged, or changed after `move collect`")


def load(path: Path, clip_actions: bool = False) -> tuple[Demonstrations, dict[str, Any]]:
    """Read a replay buffer: the demonstrations and the attributes.

    What `save` wrote is read as it is. So is the authors' published data (data/img, state, full_state and action of
    zarr format 2), whose images are the observations and whose states are left alone, as in the paper; where a buffer
    has neither images nor keypoints, its state is what is observed.

    Args:
        path: folder of the zarr group.
        clip_actions: clip actions to -1..1, which is what Meta-World's scene does with larger ones; without it they
            are what they are, and a policy learns them within their own limits.

    Raises:
        BadInput: there is no such group, a part of it is missing or damaged, one of `move collect` does not fit its
            digest, something in it is no plain array (see `move.untrusted_zarr`) or beyond the limits of
            `move.untrusted`, or actions that are not finite.
    """
    path = Path(path)
    if not path.exists():
        raise BadInput(f"no demonstrations at {path}")
    try:
        if path.is_dir():
            plain_files(path)
        with bounded_memory("its arrays"), opened_group(path) as group:
            observed = next((name for name in OBSERVED if name in group), OBSERVED[-1])
            arrays = [_read(group, name) for name in (observed, "data/action", "meta/episode_ends")]
            attributes = dict(group.attrs)
        if MARK in attributes or DIGEST in attributes:
            _refuse_changed(arrays, attributes)
        observations, actions, ends = _observations(arrays[0]), _actions(arrays[1], clip_actions), arrays[2]
        within("episodes", len(ends), f"{path}: meta/episode_ends")
        if ends.dtype.kind in "iu":
            ends = ends.astype(np.int64, copy=False)
        return Demonstrations(observations, actions, ends), {
            name: value for name, value in attributes.items() if name != DIGEST}
    except BadInput as problem:
        raise BadInput(f"cannot read demonstrations from {path}: {problem}") from problem
    except Exception as error:  # zarr raises dozens of types; all mean "this store is not what it should be"
        reason = " ".join(str(error).split())
        raise BadInput(f"cannot read demonstrations from {path}: {type(error).__name__}: {reason}") from error


def _observations(observations: np.ndarray) -> np.ndarray:
    """Images as they are, or numbers as float32."""
    if 0 in observations.shape[1:]:
        raise BadInput(f"observations {observations.shape}; allowed: at least one number a timestep")
    if observations.ndim != 2:
        return observations
    _refuse_collapsed("observations", observations)
    return observations.astype(np.float32, copy=False)


def _refuse_collapsed(name: str, values: np.ndarray) -> None:
    """Refuse numbers that differ, far from 0, by so little that most of them are equal in float32."""
    if values.dtype.kind not in "iuf" or values.dtype.itemsize <= 4 or not values.size:
        return
    for number, column in enumerate(values.reshape(len(values), -1).T):
        size = np.nanmax(np.abs(column.astype(np.float64)))
        if not FAR < size < np.inf or np.ptp(column) < NOISE * size:
            continue
        before, after = len(np.unique(column)), len(np.unique(column.astype(np.float32)))
        if 2 * after < before:
            raise BadInput(f"{name}: {before} numbers of column {number}, up to {size:.3g}, are {after} in float32; "
                           "allowed: numbers from which such an offset is taken")


def task_of(attributes: dict[str, Any]) -> str:
    """The task that a data set's attributes name; "" where they name none, as in the authors' data."""
    collection = attributes.get("collection")
    task = collection.get("task") if isinstance(collection, dict) else None
    return task if isinstance(task, str) else ""


def _actions(actions: np.ndarray, clip: bool) -> np.ndarray:
    """Actions as float32, within -1..1 if clipped."""
    if actions.dtype.kind == "b":
        raise BadInput("data/action holds true and false; allowed: numbers")
    if 0 in actions.shape[1:]:
        raise BadInput(f"actions {actions.shape}; allowed: at least one number a timestep")
    _refuse_collapsed("actions", actions)
    with np.errstate(over="ignore"):  # what float32 cannot hold is infinite, and refused
        actions = actions.astype(np.float32, copy=False)
    if not np.isfinite(actions).all():
        raise BadInput("actions hold NaN or infinity; allowed: any finite number")
    return np.clip(actions, -1, 1) if clip else actions


def _read(group: zarr.Group, name: str) -> np.ndarray:
    """All numbers of an array."""
    array = plain_array(group, name)
    if array.dtype.kind == "c":
        raise BadInput(f"{name} holds complex numbers, whose imaginary part would be lost; allowed: real numbers")
    if array.ndim == 2:
        within("columns", array.shape[1], name)
    if array.size and (gap := missing_chunks(name, array)):
        raise BadInput(gap)
    return np.asarray(array[:])
