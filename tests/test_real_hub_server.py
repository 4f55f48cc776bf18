"""Fetching with the Hub's own client from a server on 127.0.0.1 that does what a good, a broken and a bad Hub does."""

import functools
import json
import shutil
from pathlib import Path

import hostile
import pytest
import real_writers as w
from hub_server import COMMIT, row, serving
from huggingface_hub import HfApi
from huggingface_hub.utils import _http

from move.errors import BadInput
from move.realworld import hub, open_dataset

PAGE = b"<html>log in to the network first</html>"


@pytest.fixture
def served(tmp_path, monkeypatch):
    """A Hub that serves two episodes, asked by the real client, which waits for nothing."""
    w.lerobot_v2(tmp_path / "remote/static_35k")
    with serving(tmp_path / "remote") as server:
        monkeypatch.setattr(hub, "HfApi", functools.partial(HfApi, endpoint=server.endpoint, token=False))
        monkeypatch.setattr(_http.time, "sleep", lambda seconds: None)
        yield server


def refusal(tmp_path, revision: str | None = COMMIT) -> str:
    """The one line in which opening is refused; nothing is written outside the commit's own folder."""
    with pytest.raises(BadInput) as caught:
        open_dataset("BAAI/MOVE", revision=revision, folder=tmp_path / "kept")
    line = str(caught.value)
    assert "\n" not in line and len(line) < 700
    own = tmp_path / f"kept/BAAI--MOVE/{COMMIT}"
    assert all(own in path.parents for path in tmp_path.rglob("*")
               if path.is_file() and tmp_path / "remote" not in path.parents)
    return line


def listing(tmp_path) -> Path:
    return tmp_path / f"kept/BAAI--MOVE/{COMMIT}/SOURCE.json"


def test_the_real_client_fetches_plain_files(served, tmp_path):
    data = open_dataset("BAAI/MOVE", folder=tmp_path / "kept")
    assert data.revision == COMMIT and len(data.episodes) == 2 and not data.unread
    assert not any(path.is_symlink() for path in tmp_path.rglob("*"))
    count = len(served.asked)
    open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept")
    assert len(served.asked) == count, "a pinned commit that is here needs no network"


@pytest.mark.parametrize("status", [401, 403, 404, 500])
@pytest.mark.parametrize("part", ["/api/datasets/BAAI/MOVE", "/tree/", "/resolve/"])
def test_a_status_is_one_line_that_names_the_endpoint(served, tmp_path, status, part):
    served.answers[part] = (status, PAGE, {})
    line = refusal(tmp_path, None)
    assert served.endpoint in line and "huggingface.co" not in line
    assert listing(tmp_path).is_file() == (part == "/resolve/")


def test_missing_and_gated_data_sets_are_told_apart(served, tmp_path):
    served.answers["/api/"] = (404, b"{}", {"X-Error-Code": "RepoNotFound"})
    assert "no such data set" in refusal(tmp_path)
    served.answers["/api/"] = (403, b"{}", {"X-Error-Code": "GatedRepo"})
    assert f"accept its terms on {served.endpoint}/datasets/BAAI/MOVE" in refusal(tmp_path)


def test_a_redirect_loop_is_one_line(served, tmp_path):
    served.answers["/tree/"] = (302, b"", {"Location": f"/api/datasets/BAAI/MOVE/tree/{COMMIT}"})
    assert served.endpoint in refusal(tmp_path)


def test_a_redirect_to_another_path_is_followed(served, tmp_path):
    served.answers["/elsewhere"] = (200, json.dumps(served.tree).encode(), {})
    served.answers["/tree/"] = (307, b"", {"Location": "/elsewhere"})
    assert len(open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept").episodes) == 2


NO_LISTING = {
    "a page": PAGE, "nothing": b"", "a number": b"5", "null": b"null", "a text": b'"no"', "numbers": b"[1, 2]",
    "a mapping": b'{"error": "no"}', "no path": json.dumps([{"type": "file", "size": 3, "oid": ""}]).encode(),
    "no size": json.dumps([{"type": "file", "path": "a", "oid": ""}]).encode(), "empty": b"[]",
    "path a number": json.dumps([row(5, 3)]).encode(), "size a text": json.dumps([row("a", "big")]).encode(),
    "size below 0": json.dumps([row("a", -1)]).encode(), "deep": b"[" * 20_000,
    "name outside": json.dumps([row("../../evil", 3)]).encode(), "absolute": json.dumps([row("/etc/x", 3)]).encode(),
    "a long name": json.dumps([row("a" * 5000, 3)]).encode(),
}


@pytest.mark.parametrize("answer", NO_LISTING)
def test_what_is_no_listing_is_one_line_and_never_kept(served, tmp_path, answer):
    served.answers["/tree/"] = (200, NO_LISTING[answer], {"Content-Type": "application/json"})
    assert served.endpoint in refusal(tmp_path)
    assert not listing(tmp_path).exists()
    del served.answers["/tree/"]
    assert len(open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept").episodes) == 2, "mended"


@pytest.mark.parametrize("sha", [b"{}", b'{"sha": "../../../evil"}', b"[]", b'{"sha": 5}', PAGE])
def test_a_commit_that_is_none_is_refused(served, tmp_path, sha):
    served.answers["/api/datasets/BAAI/MOVE"] = (200, sha, {})
    refusal(tmp_path, None)


@pytest.mark.parametrize("kept", ["", "5", "{}", '{"files": []}', '{"files": [5]}', '{"files": {"../x": 1}}',
                                  '{"files": {"a": "x"}}', '{"files": {"a": -1}}',
                                  '{"files": [{"path": "a", "size_bytes": 1}]}'])
def test_a_kept_listing_that_is_bad_is_asked_for_again(served, tmp_path, kept):
    listing(tmp_path).parent.mkdir(parents=True)
    listing(tmp_path).write_text(kept)
    assert len(open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept").episodes) == 2
    assert len(json.loads(listing(tmp_path).read_text())["files"]) == 4


def test_a_listing_that_lies_about_a_size_is_found_out_before_the_file_is_fetched(served, tmp_path):
    for entry in served.tree:
        entry["size"] = 7
    assert "its listing says 7" in refusal(tmp_path)
    assert not list(tmp_path.glob("kept/**/*.parquet"))


def test_a_link_planted_in_the_kept_folder_is_refused(served, tmp_path):
    place = tmp_path / f"kept/BAAI--MOVE/{COMMIT}/static_35k/meta"
    place.mkdir(parents=True)
    (place / "notes.txt").symlink_to("/etc/passwd")
    assert "symbolic link" in refusal(tmp_path)


def test_the_chunks_of_a_fetched_buffer_are_judged_too(served, tmp_path):
    _, write = hostile.STORED["chunk that is more than it says"]
    shutil.rmtree(served.folder)
    write(served.folder)
    served.list_again()
    assert "decodes to 1,000,000 bytes; its description says 96" in refusal(tmp_path)
