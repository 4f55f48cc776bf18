"""Opening a real-robot data set, wherever it lies and whatever its layout."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from move import paths
from move.errors import BadInput
from move.realworld import hub
from move.realworld.detect import detect
from move.realworld.episode import EpisodeRef, Part, RobotEpisode, method_of
from move.realworld.formats import LAYOUTS
from move.realworld.units import UnitRow, convert, detect_units, read_units_file, units_table
from move.realworld.untrusted_names import plain_text
from move.untrusted import bounded_memory, plain_files, read_json, reading, within

# A file of this name at the root of a data set says that no robot was involved.
SIMULATED = "SIMULATED.json"


@dataclass(frozen=True)
class RobotDataSet:
    """What was opened, what was read of it, and what could not be read."""

    source: str  # a folder, or owner/name
    revision: str | None  # the commit, for a data set of the Hub
    folder: Path  # where its files lie
    episodes: tuple[RobotEpisode, ...]
    contents: pd.DataFrame  # part, method, layout, episodes and timesteps in all (NaN: not stated), episodes read
    units: pd.DataFrame  # see `units.units_table`
    unread: tuple[str, ...]  # one line for each chosen episode that could not be read
    simulated: bool  # the data set, or one of its episodes, says that it is simulated
    about: dict  # what its `SIMULATED.json` holds
    lacking: tuple[str, ...] | None  # a line on each thing stated and not there, or of no episode; None: none stated

    @property
    def origin(self) -> str:
        """One line on where the numbers come from; the same on every machine."""
        where = f"{self.source} at {self.revision}" if self.revision else f"folder {self.folder.resolve().name}"
        read = f"{len(self.episodes)} demonstrations read"
        return f"simulated data, no robot: {read}" if self.simulated else f"{where}: {read}"


def open_dataset(data: str | Path = hub.REPOSITORY, *, revision: str | None = hub.REVISION,
                 episodes: int | Sequence[int] | None = 20, size_cap_gb: float = 2.0, folder: Path = paths.REALWORLD,
                 units_file: Path | None = None, log: hub.Log = hub.silent) -> RobotDataSet:
    """Open a real-robot data set of a local folder or of the Hugging Face Hub.

    The layout is detected (LeRobot v2.1 or v3.0, Pika raw tree or HDF5, ACT HDF5, RoboMIND HDF5, zarr replay
    buffer), and so are the units; both are reported. `BAAI/MOVE` itself could not be reached where this was
    written, so neither its layout nor a commit is assumed.

    Args:
        data: a folder, or owner/name of a data set of the Hub.
        revision: a full commit; None asks the Hub once for the newest and records it in the result. For a folder
            it must be None.
        episodes: how many of the first episodes to read of each part, or their numbers; None for all.
        size_cap_gb: refuse to fetch more than this, in 10^9 bytes, before anything is fetched.
        folder: where data of the Hub are kept.
        units_file: overrides of the detected units, see `units`.
        log: takes one line of progress.

    Raises:
        BadInput: one line that names what was given, what was found and what is allowed.
    """
    remote = None
    if Path(data).is_dir():
        if revision is not None:
            raise BadInput(f"revision {revision!r} was given with the folder {data}; a folder has no revision")
        root = Path(data)
        plain_text(root.resolve().name, "the folder's own name")
        parts = detect(plain_files(root), root)
    elif Path(data).exists():
        raise BadInput(f"data {str(data)!r} is a file; allowed is a folder on this machine, or owner/name of the Hub")
    elif str(data).count("/") == 1 and not Path(data).is_absolute() and not str(data).startswith("."):
        remote = hub.list_remote(str(data), revision, folder, log=log)
        root = remote.folder
        parts = detect(list(remote.files), root)
    else:
        raise BadInput(f"data {str(data)!r} is no folder on this machine, and no owner/name of the Hub")
    given = read_units_file(units_file, [part.name for part in parts])
    if remote:
        _fetch(remote, parts, episodes, size_cap_gb, log)
    with bounded_memory(root):
        pieces = [_read(part, episodes, given[part.name], log) for part in parts]
    read = tuple(episode for piece in pieces for episode in piece.episodes)
    unread = tuple(line for piece in pieces for line in piece.unread)
    if not read:
        raise BadInput(unread[0] if unread else f"{root}: no episodes in {[part.name for part in parts]}")
    about, lacking = _about(root / SIMULATED), [piece.lacking for piece in pieces if piece.lacking is not None]
    return RobotDataSet(str(data), remote.revision if remote else None, root, read,
                        pd.DataFrame([piece.summary for piece in pieces]),
                        units_table([row for piece in pieces for row in piece.units]), unread,
                        bool(about) or any(episode.simulated for episode in read), about,
                        tuple(line for lines in lacking for line in lines) if lacking else None)


def _fetch(remote: hub.Remote, parts: Sequence[Part], episodes: int | Sequence[int] | None, size_cap_gb: float,
           log: hub.Log) -> None:
    """Fetch what lists the episodes, then the chosen ones."""
    names = [file for file in remote.files if file == SIMULATED]
    for part in parts:
        inner = part.root.relative_to(remote.folder)
        names += [(inner / file).as_posix() for file in LAYOUTS[part.layout].metadata(part.files)]
    hub.fetch(remote, names, size_cap_gb=size_cap_gb, log=log)
    names = []
    for part in parts:
        inner = part.root.relative_to(remote.folder)
        for ref in _choose(part, _listed(part), episodes):
            names += [(inner / file).as_posix() for file in ref.files]
    hub.fetch(remote, names, size_cap_gb=size_cap_gb, log=log)


def _listed(part: Part) -> list[EpisodeRef]:
    """All episodes of a part."""
    with reading(part.root, f"a data set of the layout {LAYOUTS[part.layout].title}"):
        refs = LAYOUTS[part.layout].episodes(part)
    within("episodes", len(refs), part.root)
    twice = [index for index, count in Counter(ref.index for ref in refs).items() if count > 1]
    if twice:
        raise BadInput(f"{part.root}: episode {twice[0]} is listed twice ({len(twice)} such episodes); allowed: once")
    return refs


def _choose(part: Part, refs: Sequence[EpisodeRef], episodes: int | Sequence[int] | None) -> Sequence[EpisodeRef]:
    """The chosen ones of a part's episodes."""
    if episodes is None:
        return refs
    if isinstance(episodes, int):
        if episodes < 1:
            raise BadInput(f"episodes={episodes}: allowed are a number from 1 on, a list of episode numbers, or None")
        return refs[:episodes]
    known = {ref.index: ref for ref in refs}
    if missing := sorted(set(episodes) - set(known)):
        raise BadInput(f"{part.root} has no episode {missing[0]}; it has {len(refs)}, "
                       f"{min(known, default=0)}..{max(known, default=0)}")
    return [known[index] for index in episodes]


@dataclass(frozen=True)
class _Piece:
    """What was read of one part."""

    episodes: list[RobotEpisode]
    units: list[UnitRow]
    unread: list[str]
    lacking: list[str] | None
    summary: dict  # a row of `RobotDataSet.contents`


def _read(part: Part, episodes: int | Sequence[int] | None, given: dict[str, str], log: hub.Log) -> _Piece:
    """Read the chosen episodes of a part; one that cannot be read is named and left out."""
    layout, refs = LAYOUTS[part.layout], _listed(part)
    recordings, unread = [], []
    for ref in _choose(part, refs, episodes):
        try:
            recordings.append(layout.read(part, ref))
        except BadInput as error:
            unread.append(str(error))
    units, method = detect_units(recordings, given) if recordings else [], given.get("method", _method(part))
    read = [convert(recording, units, given, method) for recording in recordings]
    log(f"{part.name}: {layout.title}, read {len(read)} of {len(refs)} episodes")
    found = {episode.index: episode.timesteps for episode in read}
    lengths = pd.Series([found.get(ref.index, ref.timesteps) for ref in refs], dtype=float)
    summary = {"part": part.name, "method": method, "layout": layout.title, "episodes": len(refs),
               "timesteps": lengths.sum(skipna=False), "episodes_read": len(read)}
    return _Piece(read, units, unread, layout.lacking(part, refs), summary)


def _about(mark: Path) -> dict:
    """What a data set that is simulated says of itself; nothing where it does not say that it is."""
    about = read_json(mark, "a JSON object that describes a simulation") if mark.is_file() else {}
    size = about.get("metres_per_pixel", 1.0)
    if isinstance(size, bool) or not isinstance(size, int | float) or not 0 < size < 1000:
        raise BadInput(f"{mark}: metres_per_pixel is {str(size)[:40]!r}; allowed: a number between 0 and 1000")
    return about


def _method(part: Part) -> str:
    """How a part was collected: by its folder's name; the name MOVE alone is the repository's and says nothing."""
    name = part.root.resolve().name if part.name == "." else part.name
    return "unknown" if name == "MOVE" and part.name == "." else method_of(name)
