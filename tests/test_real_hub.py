"""Fetching with the Hub's own client from a server on 127.0.0.1 that does what a good, a broken and a bad Hub does."""

import functools
import json
import shutil
from pathlib import Path

import pytest
import real_writers as w
from hub_server import COMMIT, about, row, serving
from huggingface_hub import HfApi
from huggingface_hub.utils import _http
from shared import full_disk

from move.errors import BadInput
from move.realworld import dataset, hub, open_dataset

PAGE = b"<html>log in to the network first</html>"
ABOUT, FILE = "/api/datasets/BAAI/MOVE", "/resolve/"


@pytest.fixture
def served(tmp_path, monkeypatch):
    """A Hub that serves two LeRobot parts of three episodes each, asked by the real client, which waits for nothing."""
    w.lerobot_v2(tmp_path / "remote/static_35k", episodes=3)
    w.lerobot_v2(tmp_path / "remote/move_35k", episodes=3)
    with serving(tmp_path / "remote") as server:
        monkeypatch.setattr(hub, "HfApi", functools.partial(HfApi, endpoint=server.endpoint, token=False))
        monkeypatch.setattr(_http.time, "sleep", lambda seconds: None)
        yield server


def opened(tmp_path, revision: str | None = COMMIT, **how):
    return open_dataset("BAAI/MOVE", revision=revision, folder=tmp_path / "kept", **how)


def refusal(tmp_path, revision: str | None = COMMIT) -> str:
    """The one line in which opening is refused; nothing is written outside the commit's own folder."""
    with pytest.raises(BadInput) as caught:
        opened(tmp_path, revision)
    line = str(caught.value)
    assert "\n" not in line and len(line) < 700
    written = [path for path in tmp_path.rglob("*") if path.is_file() and tmp_path / "remote" not in path.parents]
    assert all(tmp_path / f"kept/BAAI--MOVE/{COMMIT}" in path.parents for path in written)
    return line


def listing(tmp_path) -> Path:
    return tmp_path / f"kept/BAAI--MOVE/{COMMIT}/SOURCE.json"


def test_metadata_come_first_then_only_the_chosen_episodes_as_plain_files(served, tmp_path):
    said = []
    data = opened(tmp_path, None, episodes=1, log=said.append)
    assert data.revision == COMMIT and [e.index for e in data.episodes] == [0, 0] and not data.unread
    assert all("/meta/" in name for name in served.fetched()[:4]), "metadata must come first"
    assert {name for name in served.fetched() if "/data/" in name} == {
        f"{part}/data/chunk-000/episode_000000.parquet" for part in ("static_35k", "move_35k")}
    assert any(COMMIT in line for line in said) and any("fetched 1/" in line for line in said)
    assert data.contents["episodes"].tolist() == [3, 3] and data.contents["timesteps"].tolist() == [18, 18]
    assert not any(path.is_symlink() for path in tmp_path.rglob("*"))
    assert json.loads(listing(tmp_path).read_text())["revision"] == COMMIT


def test_a_pinned_commit_that_is_here_needs_no_network(served, tmp_path):
    opened(tmp_path)
    count = len(served.asked)
    assert len(opened(tmp_path).episodes) == 6 and len(served.asked) == count


def test_an_interrupted_fetch_goes_on_and_a_half_written_file_is_fetched_again(served, tmp_path):
    served.answers["move_35k/data/chunk-000/episode_000002.parquet"] = (500, PAGE, {})
    assert "files already fetched are kept" in refusal(tmp_path)
    served.answers.clear()
    opened(tmp_path)
    assert all(served.fetched().count(name) == 1 for name in served.fetched() if "episode_000002" not in name)
    path = next((tmp_path / "kept").rglob("episode_000000.parquet"))
    path.write_bytes(b"half")
    opened(tmp_path)
    assert path.stat().st_size > 4


def test_the_cap_is_applied_to_the_listing_before_a_file_is_fetched(served, tmp_path):
    served.listing.append(row("checkpoints/policy.ckpt", 100 * 10**9))  # is not needed
    assert len(opened(tmp_path).episodes) == 6
    served.listing.append(row("big/episode_0.hdf5", 100 * 10**9))
    shutil.rmtree(tmp_path / "kept")
    served.asked.clear()
    assert "100.00 GB, allowed are 2 GB (largest: big/episode_0.hdf5" in refusal(tmp_path)
    served.listing.append(row("static_35k/meta/huge.jsonl", 3 * 10**9))
    shutil.rmtree(tmp_path / "kept")
    served.asked.clear()
    assert "allowed are 2 GB" in refusal(tmp_path) and not served.fetched()


def test_other_layouts_from_the_hub(served, tmp_path):
    shutil.rmtree(served.folder)
    w.pika_hdf5(served.folder / "static")
    w.zarr_buffer(served.folder / "move", zipped=True)
    w.lerobot_v3(served.folder / "adc")
    served.__init__(served.folder)
    data = opened(tmp_path, episodes=1)
    assert sorted(e.method for e in data.episodes) == ["adc", "move", "static"]
    assert all(len(e.cameras["cam"]) == 6 for e in data.episodes if e.method == "static")


@pytest.mark.parametrize("status", [401, 403, 404, 500])
@pytest.mark.parametrize("part", [ABOUT, FILE])
def test_a_status_is_one_line_that_names_the_endpoint(served, tmp_path, status, part):
    endpoint, served.answers[part] = served.endpoint, (status, PAGE, {})
    line = refusal(tmp_path, None)
    assert endpoint in line and "huggingface.co" not in line and listing(tmp_path).is_file() == (part == FILE)


@pytest.mark.parametrize(("status", "code", "says"), [(404, "RepoNotFound", "no such data set"),
                                                      (404, "RevisionNotFound", "no such commit"),
                                                      (403, "GatedRepo", "accept its terms on http://127.0.0.1")])
def test_missing_and_gated_data_sets_are_told_apart(served, tmp_path, status, code, says):
    served.answers[ABOUT] = (status, b"{}", {"X-Error-Code": code})
    assert says in refusal(tmp_path)


def test_no_network_and_a_full_disk_are_one_line(served, tmp_path, monkeypatch):
    monkeypatch.setattr(hub, "HfApi", functools.partial(HfApi, endpoint="http://127.0.0.1:9", token=False))
    assert "no network" in refusal(tmp_path)

    monkeypatch.setattr(hub, "HfApi", functools.partial(HfApi, endpoint=served.endpoint, token=False))
    monkeypatch.setattr(HfApi, "hf_hub_download", full_disk)
    assert "cannot be kept on this disk" in refusal(tmp_path)


def test_a_redirect_loop_is_one_line_and_a_redirect_is_followed(served, tmp_path):
    served.answers["/elsewhere"] = (200, json.dumps(about(served.listing)).encode(), {})
    served.answers[ABOUT] = (302, b"", {"Location": ABOUT})
    assert served.endpoint in refusal(tmp_path)
    served.answers[ABOUT] = (307, b"", {"Location": "/elsewhere"})
    assert len(opened(tmp_path).episodes) == 6


NO_LISTING = {
    "a page": PAGE, "nothing": b"", "a number": b"5", "null": b"null", "a list": b"[1, 2]", "deep": b"[" * 20_000,
    "a mapping": b'{"error": "no"}',
} | {name: json.dumps(about(rows)).encode() for name, rows in {
    "empty": [], "no path": [{"size": 3}], "no size": [row("a", None)], "path a number": [row(5, 3)],
    "size a text": [row("a", "big")], "size below 0": [row("a", -1)], "a name outside": [row("../../evil", 3)],
    "an absolute name": [row("/etc/x", 3)], "a drive": [row("C:/x", 3)], "a long name": [row("a" * 5000, 3)],
    "a backslash": [row("a\\b", 3)], "markup": [row("<b>", 3)]}.items()}


@pytest.mark.parametrize("answer", NO_LISTING)
def test_what_is_no_listing_is_one_line_and_never_kept(served, tmp_path, answer):
    served.answers[ABOUT] = (200, NO_LISTING[answer], {"Content-Type": "application/json"})
    assert served.endpoint in refusal(tmp_path) and not listing(tmp_path).exists()
    served.answers.clear()
    assert len(opened(tmp_path).episodes) == 6, "mended"


@pytest.mark.parametrize("sha", ["../../../evil", 5, None])
def test_a_commit_that_is_none_is_refused(served, tmp_path, sha):
    served.answers[ABOUT] = (200, json.dumps(about(served.listing, sha)).encode(), {})
    refusal(tmp_path, None)


@pytest.mark.parametrize("revision", ["main", "v2.1", "0123456", COMMIT.upper(), COMMIT + "0", COMMIT[:-1] + "\n"])
def test_only_a_full_commit_is_a_revision(served, tmp_path, revision):
    assert "full commit of 40 hexadecimal digits" in refusal(tmp_path, revision) and not served.asked


@pytest.mark.parametrize("kept", ["", "5", '{"files": []}', '{"files": {"../x": 1}}', '{"files": {"a": -1}}'])
def test_a_kept_listing_that_is_bad_is_asked_for_again(served, tmp_path, kept):
    listing(tmp_path).parent.mkdir(parents=True)
    listing(tmp_path).write_text(kept)
    assert len(opened(tmp_path).episodes) == 6
    assert len(json.loads(listing(tmp_path).read_text())["files"]) == 10


def test_a_file_of_another_size_than_listed_is_refused(served, tmp_path):
    for entry in served.listing:
        entry["size"] = 7
    assert "its listing says 7" in refusal(tmp_path)


def test_a_file_that_the_layout_needs_and_the_listing_lacks_is_named(served, tmp_path):
    served.listing = [entry for entry in served.listing if "move_35k/data/chunk-000/episode_000001" not in
                      entry["rfilename"]]
    assert "has no file 'move_35k/data/chunk-000/episode_000001.parquet'" in refusal(tmp_path)


def test_a_link_planted_in_the_kept_folder_is_refused(served, tmp_path):
    place = tmp_path / f"kept/BAAI--MOVE/{COMMIT}/static_35k/meta"
    place.mkdir(parents=True)
    (place / "notes.txt").symlink_to("/etc/passwd")
    assert "symbolic link" in refusal(tmp_path)


def test_no_commit_is_invented():
    assert hub.REVISION is None and hub.REPOSITORY == "BAAI/MOVE"
    assert "could not be reached" in hub.__doc__ and "could not be reached" in dataset.open_dataset.__doc__
