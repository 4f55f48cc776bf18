"""Which layouts a list of file names holds. Works on a listing, so before anything is fetched."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from move.errors import BadInput
from move.realworld.episode import Part
from move.realworld.untrusted_names import is_hidden, safe_name
from move.untrusted import within

_EXPECTED = ("meta/info.json (LeRobot v2.1 or v3.0), episode*/camera|arm|gripper|localization/ (Pika raw tree), "
            "*.hdf5 or *.h5 (Pika, ACT, RoboMIND), or meta/episode_ends in a zarr folder or *.zarr.zip")
_ARCHIVES = (".zip", ".tar", ".tar.gz", ".tgz", ".7z", ".rar", ".zst")

_LEROBOT = re.compile(r"(?P<root>(?:.*/)?)meta/info\.json")
_ZARR = re.compile(r"(?P<root>(?:.*/)?)meta/episode_ends/(?:\.zarray|zarr\.json)")
_PIKA = re.compile(r"(?P<root>(?:.*/)?)episode_?\d+/(?:camera/color|arm/jointState|arm/endPose|localization/pose|"
                   r"gripper/encoder)/.+/.+")
_HDF5 = re.compile(r"(?P<root>(?:.*?/)??)(?:episode_?\d+/|[^/]+/data/(?=trajectory\.))?[^/]+\.(?:hdf5|h5)")


def detect(files: Sequence[str], root: Path) -> list[Part]:
    """Find every sub data set in a listing.

    A file belongs to the first layout that claims it, in the order LeRobot, zarr, HDF5, Pika raw tree; a raw tree
    next to an HDF5 file is that file's image store.

    Args:
        files: relative file names.
        root: where they lie or will lie.

    Raises:
        BadInput: no layout is recognised (the message says what was found), or a name leaves the folder.
    """
    left = {file for file in files if not is_hidden(safe_name(file, str(root)))}
    parts: list[Part] = []
    for pattern, layout in ((_LEROBOT, "lerobot"), (_ZARR, "zarr"), (_HDF5, "hdf5"), (_PIKA, "pika_tree")):
        found = {match["root"] for match in map(pattern.fullmatch, left) if match}
        if layout == "zarr":
            found |= {file for file in left if file.endswith(".zarr.zip")}
        within("parts", len(parts) + len(found), root)
        for prefix in sorted(found, key=len, reverse=True):
            part = _claim(prefix, layout, left, root)
            left -= {prefix} if prefix.endswith(".zip") else {prefix + file for file in part.files}
            parts.append(part)
    parts = [part for part in parts if part.files]
    if not parts:
        raise BadInput(f"{root}: no known layout; found {_describe(files)}; expected {_EXPECTED}")
    return sorted(parts, key=lambda part: part.name)


def _claim(prefix: str, layout: str, left: set[str], root: Path) -> Part:
    """The part under one folder (or the one zip file)."""
    if prefix.endswith(".zarr.zip"):
        folder, name = Path(prefix).parent.as_posix(), Path(prefix).name
        return Part(prefix, layout, root / folder, (name,))
    files = tuple(sorted(file.removeprefix(prefix) for file in left if file.startswith(prefix)))
    if layout == "lerobot":
        layout = "lerobot_v3" if any(file.startswith("meta/episodes/") for file in files) else "lerobot_v2"
        files = tuple(file for file in files if file.startswith(("meta/", "data/", "videos/", "images/")))
    elif layout == "hdf5" and not any(file.endswith((".hdf5", ".h5")) for file in files):
        files = ()
    return Part(prefix.rstrip("/") or ".", layout, root / prefix, files)


def _describe(files: Sequence[str]) -> str:
    """What a listing holds, in one line: how many files of which ending, the first names, and archives."""
    endings = Counter(Path(file).suffix or "(no ending)" for file in sorted(files)).most_common(6)
    counts = ", ".join(f"{count} {ending}" for ending, count in endings)
    text = f"{len(files)} files ({counts}), such as {', '.join(sorted(files)[:4])}" if files else "no files"
    packed = [file for file in sorted(files) if file.endswith(_ARCHIVES)]
    return text + (f"; unpack {packed[0]} first and give the folder" if packed else "")
