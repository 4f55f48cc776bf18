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
from dataclasses import dataclass
from pathlib import Path

from huggingface_hub import HfApi, constants
from huggingface_hub.errors import (
    EntryNotFoundError,
    GatedRepoError,
    HfHubHTTPError,
    HFValidationError,
    RepositoryNotFoundError,
    RevisionNotFoundError,
)
from huggingface_hub.utils import httpx

from move.errors import BadInput
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


def check_revision(revision: str) -> str:
    """Accept a full commit and nothing else: a branch or a tag can move.

    >>> check_revision("main")
    Traceback (most recent call last):
    move.errors.BadInput: revision 'main': allowed is a full commit of 40 hexadecimal digits
    """
    if not re.fullmatch(r"[0-9a-f]{40}", revision):
        raise BadInput(f"revision {revision!r}: allowed is a full commit of 40 hexadecimal digits")
    return revision


@contextmanager
def plainly(repo_id: str, revision: str | None, endpoint: str = constants.ENDPOINT) -> Iterator[None]:
    """Turn what the Hub's client raises into one line that says what to do.

    Args:
        endpoint: the address that is asked, for the message.

    Raises:
        BadInput: gated, missing, wrong revision, no network, an answer of another kind, or no room on the disk.
    """
    where = f"{repo_id}@{revision or 'newest'} ({endpoint})"
    try:
        yield
    except BadInput:
        raise
    except Exception as error:  # the last of them is what the client raises while it reads an answer of something else
        name = f"{type(error).__name__}: {_short(error)}"
        kept = isinstance(error, OSError) and error.errno in DISK_ERRORS
        raise BadInput(f"{where}" + next(meaning for kind, meaning in (
            (GatedRepoError, f" is gated: accept its terms on {endpoint}/datasets/{repo_id}, run `hf auth login`, then "
             "try again"),
            (RevisionNotFoundError, ": no such commit in this repository; leave the revision empty to take the newest"),
            (RepositoryNotFoundError, ": no such data set, or it is private; check the name, or run `hf auth login`"),
            (EntryNotFoundError, f": a file that was listed is not there, or there is no network: {_short(error)}"),
            (HFValidationError, f": {repo_id!r} is no repository name; allowed is owner/name: {_short(error)}"),
            (HfHubHTTPError, f": the Hub refused: {_short(error)}"),
            (OSError if kept else (), f": cannot be kept on this disk: {_short(error)}"),
            ((OSError, httpx.HTTPError), f": no network, or the Hub did not answer ({name}); give a local folder "
             "instead, or try again: files already fetched are kept"),
            (Exception, f": what answered is no Hub, or a proxy's page came instead ({name})"),
        ) if isinstance(error, kind))) from error


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:120]


def list_remote(repo_id: str, revision: str | None, folder: Path, *, log: Log = silent) -> Remote:
    """List a repository at one commit; fetch nothing.

    The listing is kept as `SOURCE.json` under `folder/<owner>--<name>/<commit>/`, so a pinned commit that was
    listed once needs no network again. Only a listing that was judged is kept, and one that is not as it was kept is
    asked for again.

    Args:
        repo_id: owner/name of a data set.
        revision: 40 hexadecimal digits, or None to ask for the newest commit.
        folder: where data sets are kept.
        log: takes one line of progress.

    Raises:
        BadInput: see `check_revision`, `plainly` and `_judged`.
    """
    api = HfApi()
    if revision is None:
        with plainly(repo_id, None, api.endpoint):
            revision = str(api.dataset_info(repo_id, timeout=TIMEOUT_S).sha)
        log(f"{repo_id}: newest commit is {revision}; pin it to read the same data again")
    target = folder / safe_name(repo_id, "the repository name").replace("/", "--") / check_revision(revision)
    files = _kept(target / LISTING)
    if files is None:
        where = f"{repo_id}@{revision} ({api.endpoint})"
        with plainly(repo_id, revision, api.endpoint):
            tree = api.list_repo_tree(repo_id, recursive=True, revision=revision, repo_type="dataset")
            files = _judged(((entry.path, entry.size) for entry in tree if hasattr(entry, "size")), where)
    remote = Remote(repo_id, revision, target, files)
    _keep(remote)
    total = sum(files.values()) / 1e9
    log(f"{repo_id}@{revision[:8]}: {len(files)} files, {total:.2f} GB in all")
    return remote


def _judged(rows: Iterable[tuple[object, object]], where: str) -> dict[str, int]:
    """The names and sizes of a listing.

    Raises:
        BadInput: no file at all, too many, a name that leaves the folder, or a value of the wrong type.
    """
    files: dict[str, int] = {}
    for path, size in rows:
        within("files", len(files) + 1, f"{where}: its listing")
        if not isinstance(path, str) or type(size) is not int or size < 0:
            raise BadInput(f"{where}: its listing holds {str(path)[:80]!r} of {str(size)[:40]!r} bytes; allowed: a "
                           "name and a number from 0 on")
        files[safe_name(path, where)] = size
    if not files:
        raise BadInput(f"{where}: its listing holds no file")
    return files


def _kept(path: Path) -> dict[str, int] | None:
    """A listing that was kept; None where there is none that is as it was kept."""
    try:
        return _judged(read_json(path, "a listing that was kept").get("files", {}).items(), str(path))
    except (BadInput, AttributeError):
        return None


def _keep(remote: Remote) -> None:
    """Write the listing, complete or not at all."""
    remote.folder.mkdir(parents=True, exist_ok=True)
    draft = remote.folder / (LISTING + ".part")
    draft.write_text(json.dumps({name: getattr(remote, name) for name in ("repo_id", "revision", "files")}),
                     encoding="utf-8")
    draft.replace(remote.folder / LISTING)


def fetch(remote: Remote, names: Sequence[str], *, size_cap_gb: float, log: Log = silent) -> int:
    """Fetch the named files that are not there yet; an interrupted fetch goes on where it stopped.

    Args:
        names: file names relative to the repository.
        size_cap_gb: refuse, before anything is fetched, when the files together (those already here included)
            are larger than this, in 10^9 bytes.

    Returns:
        Number of bytes fetched.

    Raises:
        BadInput: a name or size that is not as listed, above the cap, what `plain_files` refuses,
            or see `plainly`.
    """
    sizes = remote.files
    unknown = [name for name in names if name not in sizes]
    if unknown:
        raise BadInput(f"{remote.repo_id}@{remote.revision[:8]} has no file {unknown[0]!r} "
                       f"({len(unknown)} of {len(names)} wanted files are missing from its listing)")
    total = sum(sizes[name] for name in set(names))
    if total > size_cap_gb * 1e9:
        largest = max(names, key=sizes.__getitem__)
        raise BadInput(
            f"{remote.repo_id}: {len(set(names))} files need {total / 1e9:.2f} GB, allowed are {size_cap_gb:g} GB "
            f"(largest: {largest}, {sizes[largest] / 1e9:.2f} GB); raise size_cap_gb or choose fewer episodes")
    missing = [name for name in sorted(set(names)) if not _is_here(inside(remote.folder, name), sizes[name])]
    api, done = HfApi(), 0

    def one(name: str) -> str:
        with plainly(remote.repo_id, remote.revision, api.endpoint):
            announced = api.hf_hub_download(remote.repo_id, name, repo_type="dataset", revision=remote.revision,
                                            local_dir=remote.folder, dry_run=True).file_size
            if announced != sizes[name]:  # a listing that lies would get round the cap
                raise BadInput(f"{remote.repo_id}@{remote.revision[:8]} ({api.endpoint}): {name} has {announced:,} "
                               f"bytes, its listing says {sizes[name]:,}")
            api.hf_hub_download(remote.repo_id, name, repo_type="dataset", revision=remote.revision,
                                local_dir=remote.folder)
        return name

    pool = ThreadPoolExecutor(WORKERS)
    try:
        for number, name in enumerate(pool.map(one, missing), 1):
            done += sizes[name]
            log(f"fetched {number}/{len(missing)} ({done / 1e6:.1f} MB): {name}")
    finally:
        pool.shutdown(cancel_futures=True)
    plain_files(remote.folder)
    return done


def _is_here(path: Path, size_bytes: int) -> bool:
    return path.is_file() and path.stat().st_size == size_bytes
