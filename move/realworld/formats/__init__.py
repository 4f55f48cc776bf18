"""One reader a layout. A layout is four functions, in the order they are needed.

metadata(files)        the small files that must be there before episodes can be chosen
episodes(part)         one EpisodeRef an episode: which files hold it
read(part, ref)        one Recording, in the units of the file
lacking(part, refs)    a line on each thing that is stated and not there, or there and of no episode; None: none stated
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from move.realworld.episode import EpisodeRef, Part, Recording
from move.realworld.formats import hdf5, lerobot, pika_tree, zarr_buffer


@dataclass(frozen=True)
class Layout:
    """How one layout is read."""

    title: str
    metadata: Callable[[Sequence[str]], list[str]]
    episodes: Callable[[Part], list[EpisodeRef]]
    read: Callable[[Part, EpisodeRef], Recording]
    lacking: Callable[[Part, Sequence[EpisodeRef]], list[str] | None]


LAYOUTS = {name: Layout(title, reader.metadata, reader.episodes, reader.read, reader.lacking)
           for name, title, reader in (
    ("lerobot_v2", "LeRobot v2.1 (or v2.0)", lerobot), ("lerobot_v3", "LeRobot v3.0", lerobot),
    ("pika_tree", "Pika raw tree", pika_tree),
    ("hdf5", "HDF5, one file an episode (Pika, ACT or RoboMIND)", hdf5), ("zarr", "zarr replay buffer", zarr_buffer))}
