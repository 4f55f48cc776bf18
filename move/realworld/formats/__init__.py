"""One reader a layout. A layout is three functions, in the order they are needed.

metadata(files)        the small files that must be there before episodes can be chosen
episodes(part)         one EpisodeRef an episode: which files hold it
read(part, ref)        one Recording, in the units of the file
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from move.realworld.episode import EpisodeRef, Part, Recording
from move.realworld.formats import hdf5, lerobot_v2, lerobot_v3, pika_tree, zarr_buffer


@dataclass(frozen=True)
class Layout:
    """How one layout is read."""

    title: str
    metadata: Callable[[Sequence[str]], list[str]]
    episodes: Callable[[Part], list[EpisodeRef]]
    read: Callable[[Part, EpisodeRef], Recording]


LAYOUTS = {
    "lerobot_v2": Layout("LeRobot v2.1 (or v2.0)", lerobot_v2.metadata, lerobot_v2.episodes, lerobot_v2.read),
    "lerobot_v3": Layout("LeRobot v3.0", lerobot_v3.metadata, lerobot_v3.episodes,
                         lerobot_v3.read), "pika_tree": Layout("Pika raw tree", pika_tree.metadata, pika_tree.episodes,
                                                               pika_tree.read),
    "hdf5": Layout("HDF5, one file an episode (Pika, ACT or RoboMIND)", hdf5.metadata, hdf5.episodes,
                   hdf5.read), "zarr": Layout("zarr replay buffer", zarr_buffer.metadata, zarr_buffer.episodes,
                                              zarr_buffer.read),
}
