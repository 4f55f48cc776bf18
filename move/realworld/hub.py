"""Fetching chosen files of a Hugging Face data set: list first, cap the size, then fetch, one revision for all.

The repository of the paper's real-robot data, `BAAI/MOVE`, could not be reached where this was written, so no
commit is built in: `REVISION` is None, which means "ask the Hub once for its newest commit, and record it". A
reader who has seen the data should pin the commit that was recorded.
"""

from __future__ import annotations

import errno
import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from huggingface_hub import HfApi
from huggingface_hub.errors import GatedRepoError, RepositoryNotFoundError, RevisionNotFoundError

from move.errors import BadInput
from move.files import written_aside
from move.realworld.untrusted_names import inside, safe_name
from move.untrusted import plain_files, read_json, within

REPOSITORY = "BAAI/MOVE"
REVISION: str | None = None
LISTING = "SOURCE.json"
TIMEOUT_S = 10.0
WORKERS = 8  # files fetched at a time; a raw tree has thousands of small ones
DISK_ERRORS = (errno.ENOSPC, errno.EACCES, errno.EPERM, errno.EROFS, errno.EDQUOT)

Log = Callable[[str], None]


def silent(line: str) -> None:
    """Log nothing: the default of every `log` argument."""


@dataclass(frozen=True)
class Remote:
    """A repository at one commit, listed but not fetched."""

    repo_id: str
    revision: str  # 40 hexadecimal digits
    folder: Path  # where its files lie once fetched
    files: Mapping[str, int]  # name -> bytes


def _check_revision(revision: str) -> str:
    """Accept a full commit and nothing else: a branch or a tag can move."""
    if not re.fullmatch(r"[0-9a-f]{40}", revision):
        raise BadInput(f"revision {revision!r}: allowed is a full commit of 40 hexadecimal digits")
    return revision


@contextmanager
def _plainly(repo_id: str, revision: str | None, endpoint: str) -> Iterator[None]:
    """Turn what the Hub's client raises into one line that says what to do."""
    try:
        yield
    except BadInput:
        raise
    except Exception as error:  # the client raises dozens of types, also while it reads an answer of something else
        said = f"{type(error).__name__}: {' '.join(str(error).split())[:120]}"
        if isinstance(error, GatedRepoError):
            what = f"it is gated: accept its terms on {endpoint}/datasets/{repo_id}, run `hf auth login`, try again"
        elif isinstance(error, RevisionNotFoundError):
            what = "no such commit in this repository; leave the revision empty to take the newest"
        elif isinstance(error, RepositoryNotFoundError):
            what = "no such data set, or it is private; check the name, or run `hf auth login`"
        elif isinstance(error, OSError) and error.errno in DISK_ERRORS:
            what = f"it cannot be kept on this disk ({said})"
        else:
            what = (f"no network, or what answered is no Hub ({said}); give a local folder instead, or try again: "
                    "files already fetched are kept")
        raise BadInput(f"{repo_id}@{revision or 'newest'} ({endpoint}): {what}") from error


def list_remote(repo_id: str, revision: str | None, folder: Path, *, log: Log = silent) -> Remote:
    """List a repository at one commit; fetch nothing.

    The listing is kept as `SOURCE.json` under `folder/<owner>--<name>/<commit>/`, so a pinned commit that was
    listed once needs no network again.

    Args:
        repo_id: owner/name of a data set.
        revision: 40 hexadecimal digits, or None to ask for the newest commit.
        folder: where data sets are kept.
        log: takes one line of progress.

    Raises:
        BadInput: no full commit, no network, a data set that is missing or gated, or an answer that is no listing.
    """
    home = folder / safe_name(repo_id, "the repository name").replace("/", "--")
    files = _kept(home / _check_revision(revision) / LISTING) if revision else None
    if revision is None or files is None:
        api = HfApi()
        with _plainly(repo_id, revision, api.endpoint):
            about = api.dataset_info(repo_id, revision=revision, files_metadata=True, timeout=TIMEOUT_S)
            files = _judged(((file.rfilename, file.size) for file in about.siblings or ()),
                            f"{repo_id}@{revision or 'newest'} ({api.endpoint})")
        if revision is None:
            revision = _check_revision(str(about.sha))
            log(f"{repo_id}: newest commit is {revision}; pin it to read the same data again")
    remote = Remote(repo_id, revision, home / revision, files)
    with written_aside(remote.folder / LISTING) as beside:
        beside.write_text(json.dumps({**asdict(remote), "folder": None}), encoding="utf-8")
    log(f"{repo_id}@{revision[:8]}: {len(files)} files, {sum(files.values()) / 1e9:.2f} GB in all")
    return remote


def _judged(rows: Iterable[tuple[object, object]], where: str) -> dict[str, int]:
    """The names and sizes of a listing, if they are such."""
    files: dict[str, int] = {}
    for name, size in rows:
        if not isinstance(name, str) or type(size) is not int or size < 0:
            raise BadInput(f"{where}: its listing holds {str(name)[:80]!r} of {str(size)[:40]!r} bytes; allowed: a "
                           "name and a number from 0 on")
        files[safe_name(name, where)] = size
    within("files", len(files), f"{where}: its listing")
    if not files:
        raise BadInput(f"{where}: its listing holds no file")
    return files


def _kept(path: Path) -> dict[str, int] | None:
    """A listing that was kept; None where there is none that is as it was kept."""
    try:
        return _judged(read_json(path, "a listing that was kept").get("files", {}).items(), str(path))
    except (BadInput, AttributeError):
        return None


def fetch(remote: Remote, names: Sequence[str], *, size_cap_gb: float, log: Log = silent) -> None:
    """Fetch the named files that are not there yet; an interrupted fetch goes on where it stopped.

    Args:
        names: file names relative to the repository.
        size_cap_gb: refuse, before anything is fetched, when the files together (those already here included)
            are larger than this, in 10^9 bytes.

    Raises:
        BadInput: a name or size that is not as listed, above the cap, no network, or no room on the disk.
    """
    sizes, api = remote.files, HfApi()
    where = f"{remote.repo_id}@{remote.revision[:8]} ({api.endpoint})"
    unknown = [name for name in names if name not in sizes]
    if unknown:
        raise BadInput(f"{where} has no file {unknown[0]!r} ({len(unknown)} of {len(names)} wanted files are missing "
                       "from its listing)")
    total = sum(sizes[name] for name in set(names)) / 1e9
    if total > size_cap_gb:
        largest = max(names, key=sizes.__getitem__)
        raise BadInput(
            f"{where}: {len(set(names))} files need {total:.2f} GB, allowed are {size_cap_gb:g} GB (largest: "
            f"{largest}, {sizes[largest] / 1e9:.2f} GB); raise size_cap_gb or choose fewer episodes")

    def one(name: str) -> str:
        path = inside(remote.folder, name)
        with _plainly(remote.repo_id, remote.revision, api.endpoint):
            api.hf_hub_download(remote.repo_id, name, repo_type="dataset", revision=remote.revision,
                                local_dir=remote.folder, force_download=path.exists())
        if not is_here(name):
            raise BadInput(f"{where}: {name} has {path.stat().st_size:,} bytes, its listing says {sizes[name]:,}")
        return name

    def is_here(name: str) -> bool:
        path = inside(remote.folder, name)
        return path.is_file() and path.stat().st_size == sizes[name]

    missing = [name for name in sorted(set(names)) if not is_here(name)]
    pool = ThreadPoolExecutor(WORKERS)
    try:
        for number, name in enumerate(pool.map(one, missing), 1):
            log(f"fetched {number}/{len(missing)} ({sizes[name] / 1e6:.1f} MB): {name}")
    finally:
        pool.shutdown(cancel_futures=True)
    plain_files(remote.folder)
