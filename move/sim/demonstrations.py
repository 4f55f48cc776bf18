"""What collection produces and training consumes: observations and actions of whole episodes, end to end."""

import hashlib
from dataclasses import dataclass

import numpy as np

from move.errors import BadInput


@dataclass(frozen=True)
class Demonstrations:
    """Episodes of observations and actions, one behind the other.

    observations: (timesteps, coordinates) float32 keypoints in metres, or (timesteps, H, W, 3) uint8 images.
    actions: (timesteps, action_size) float32; in [-1, 1] where they are collected here.
    episode_ends: (episodes,) int64, the timestep after each episode's last one.
    Raises BadInput where these do not hold.

    >>> demonstrations = Demonstrations(np.zeros((5, 3), np.float32), np.zeros((5, 4), np.float32), np.array([2, 5]))
    >>> demonstrations.timesteps, demonstrations.episodes, demonstrations.lengths
    (5, 2, array([2, 3]))
    """

    observations: np.ndarray
    actions: np.ndarray
    episode_ends: np.ndarray

    def __post_init__(self) -> None:
        _check_observations(self.observations)
        _check_actions(self.actions)
        if len(self.observations) != len(self.actions):
            raise BadInput(f"{len(self.observations)} observations with {len(self.actions)} actions; allowed: as many")
        _check_episode_ends(self.episode_ends, len(self.actions))

    @property
    def fingerprint(self) -> str:
        """Sixteen hexadecimal digits that no two data sets share; see `fingerprint`."""
        return fingerprint(self.observations, self.actions, self.episode_ends)

    @property
    def timesteps(self) -> int:
        """Timesteps of all episodes together, which is also the number of windows."""
        return len(self.actions)

    @property
    def episodes(self) -> int:
        """Number of episodes."""
        return len(self.episode_ends)

    @property
    def lengths(self) -> np.ndarray:
        """Timesteps of each episode, (episodes,) int64."""
        return np.diff(self.episode_ends, prepend=0)

    @property
    def has_images(self) -> bool:
        """Whether an observation is an image; keypoints otherwise."""
        return self.observations.ndim == 4


def fingerprint(*arrays: np.ndarray) -> str:
    """The first sixteen hexadecimal digits of the sha256 of arrays: of each its dtype, its shape and its numbers.

    >>> fingerprint(np.zeros((2, 3))) == fingerprint(np.zeros((3, 2))), fingerprint(np.zeros(2)) == fingerprint([0, 0])
    (False, False)
    """
    digest = hashlib.sha256()
    for array in map(np.asarray, arrays):
        digest.update(f"{array.dtype.name} {array.shape} ".encode())
        digest.update(np.ascontiguousarray(array, array.dtype.newbyteorder("<")).data)
    return digest.hexdigest()[:16]


def _check_observations(observations: np.ndarray) -> None:
    keypoints = observations.ndim == 2 and observations.dtype == np.float32
    images = observations.ndim == 4 and observations.shape[-1] == 3 and observations.dtype == np.uint8
    if not (keypoints or images):
        raise BadInput(f"observations {observations.shape} {observations.dtype}; "
                       "allowed: (timesteps, coordinates) float32 or (timesteps, height, width, 3) uint8")
    if keypoints and not np.isfinite(observations).all():
        raise BadInput("observations hold NaN or infinity; every keypoint needs a finite place")


def _check_actions(actions: np.ndarray) -> None:
    if actions.ndim != 2 or actions.dtype != np.float32:
        raise BadInput(f"actions {actions.shape} {actions.dtype}; allowed: (timesteps, action_size) float32")
    if not np.isfinite(actions).all():
        raise BadInput("actions hold NaN or infinity; allowed: finite numbers")


def _check_episode_ends(ends: np.ndarray, timesteps: int) -> None:
    if ends.ndim != 1 or ends.dtype != np.int64:
        raise BadInput(f"episode_ends {ends.shape} {ends.dtype}; allowed: (episodes,) int64")
    if len(ends) == 0 or ends[-1] != timesteps:
        last = ends[-1] if len(ends) else "nothing"
        raise BadInput(f"episode_ends ends with {last}; the last entry is the number of timesteps, {timesteps}")
    if np.diff(ends, prepend=0).min() < 1:
        raise BadInput(f"episode_ends {ends.tolist()}; allowed: strictly increasing from above 0")
