"""Fetching from the Hub, with its client replaced: nothing here touches a network."""

import json
import shutil
from types import SimpleNamespace

import pytest
import real_writers as w
from huggingface_hub.errors import (
    GatedRepoError,
    HfHubHTTPError,
    LocalEntryNotFoundError,
    OfflineModeIsEnabled,
    RepositoryNotFoundError,
    RevisionNotFoundError,
)
from huggingface_hub.utils import httpx

from move.errors import BadInput
from move.realworld import dataset, hub, open_dataset

COMMIT = "0123456789abcdef0123456789abcdef01234567"


def http_error(kind, status=401):
    """An error of the client, as it is raised on a response."""
    response = httpx.Response(status, request=httpx.Request("GET", "https://huggingface.co/x"))
    return kind("no\nentry", response=response)


class FakeHub:
    """Stands in for HfApi: serves a local folder, counts what is fetched, fails when told to."""

    endpoint = "https://hub.example"
    folder, extra, error, fail_after = None, (), None, None
    fetched: list[str] = []
    listed = 0

    def dataset_info(self, repo_id, timeout):
        self._maybe_fail()
        return SimpleNamespace(sha=COMMIT)

    def list_repo_tree(self, repo_id, *, recursive, revision, repo_type):
        assert recursive and repo_type == "dataset" and revision == COMMIT
        self._maybe_fail()
        FakeHub.listed += 1
        files = [p for p in sorted(self.folder.rglob("*")) if p.is_file()]
        yield SimpleNamespace(path="a-folder")  # a RepoFolder has no size
        yield from (SimpleNamespace(path=p.relative_to(self.folder).as_posix(), size=p.stat().st_size) for p in files)
        yield from (SimpleNamespace(path=path, size=size) for path, size in self.extra)

    def hf_hub_download(self, repo_id, filename, *, repo_type, revision, local_dir, dry_run=False):
        self._maybe_fail()
        if dry_run:
            return SimpleNamespace(file_size=(self.folder / filename).stat().st_size)
        if self.fail_after is not None and len(self.fetched) >= self.fail_after:
            raise httpx.ConnectError("cable pulled")
        FakeHub.fetched.append(filename)
        (local_dir / filename).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.folder / filename, local_dir / filename)

    def _maybe_fail(self):
        if self.error:
            raise self.error


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """A Hub whose repository holds two LeRobot parts of three episodes each."""
    w.lerobot_v2(tmp_path / "remote/static_35k", episodes=3, codec="libx264")
    w.lerobot_v2(tmp_path / "remote/move_35k", episodes=3, codec="libx264")
    for name, value in {
            "folder": tmp_path / "remote", "extra": (), "error": None, "fail_after": None, "fetched": [], "listed": 0,
    }.items():
        monkeypatch.setattr(FakeHub, name, value)
    monkeypatch.setattr(hub, "HfApi", FakeHub)
    return FakeHub


def test_metadata_first_then_only_the_chosen_episodes(fake, tmp_path):
    said = []
    data = open_dataset("BAAI/MOVE", episodes=1, folder=tmp_path / "kept", log=said.append)
    assert data.revision == COMMIT and len(data.episodes) == 2
    assert all(name.split("/")[1] == "meta" for name in fake.fetched[:4]), "metadata must come first"
    assert {name for name in fake.fetched if "data/chunk" in name
            } == {f"{part}/data/chunk-000/episode_000000.parquet" for part in ("static_35k", "move_35k")}
    assert data.episodes[0].cameras["wrist"].read([0]).shape == (1, 64, 64, 3)
    assert any(COMMIT in line for line in said) and any("fetched 1/" in line for line in said)
    assert data.contents["episodes"].tolist() == [3, 3] and data.contents["timesteps"].tolist() == [18, 18]


def test_a_pinned_commit_needs_no_network_the_second_time(fake, tmp_path):
    open_dataset("BAAI/MOVE", revision=COMMIT, episodes=1, folder=tmp_path / "kept")
    count = len(fake.fetched)
    fake.error = httpx.ConnectError("no network")
    data = open_dataset("BAAI/MOVE", revision=COMMIT, episodes=1, folder=tmp_path / "kept")
    assert len(data.episodes) == 2 and len(fake.fetched) == count and fake.listed == 1


def test_an_interrupted_fetch_goes_on(fake, tmp_path):
    fake.fail_after = 5
    with pytest.raises(BadInput, match="files already fetched are kept"):
        open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept")
    fake.fail_after = None
    open_dataset("BAAI/MOVE", revision=COMMIT, folder=tmp_path / "kept")
    assert len(fake.fetched) == len(set(fake.fetched)), "a file was fetched twice"


def test_a_half_written_file_is_fetched_again(fake, tmp_path):
    open_dataset("BAAI/MOVE", revision=COMMIT, episodes=1, folder=tmp_path / "kept")
    path = next((tmp_path / "kept").rglob("episode_000000.parquet"))
    path.write_bytes(b"half")
    open_dataset("BAAI/MOVE", revision=COMMIT, episodes=1, folder=tmp_path / "kept")
    assert path.stat().st_size > 4


def test_a_100_gb_file_is_never_fetched(fake, tmp_path):
    (fake.folder / "big").mkdir()
    fake.extra = (("big/episode_0.hdf5", 100 * 10**9),)
    with pytest.raises(BadInput, match=r"100\.00 GB, allowed are 2 GB \(largest: big/episode_0.hdf5"):
        open_dataset("BAAI/MOVE", folder=tmp_path / "kept")
    assert not any("data/" in name or "big" in name
                   for name in fake.fetched), ("data were fetched before the cap was applied")


def test_a_100_gb_file_that_is_not_needed_does_no_harm(fake, tmp_path):
    fake.extra = (("checkpoints/policy.ckpt", 100 * 10**9),)
    assert len(open_dataset("BAAI/MOVE", folder=tmp_path / "kept").episodes) == 6
    assert "checkpoints/policy.ckpt" not in fake.fetched


def test_the_cap_counts_metadata_too(fake, tmp_path):
    fake.extra = (("static_35k/meta/huge.jsonl", 3 * 10**9),)
    with pytest.raises(BadInput, match="allowed are 2 GB"):
        open_dataset("BAAI/MOVE", folder=tmp_path / "kept")
    assert fake.fetched == []


@pytest.mark.parametrize("name", ["../../.ssh/authorized_keys", "/etc/passwd", "a/../../b.parquet", "C:/x.parquet"])
def test_names_that_leave_the_folder_are_refused(fake, tmp_path, name):
    fake.extra = ((name, 10),)
    with pytest.raises(BadInput, match="leaves the data set's folder"):
        hub.list_remote("BAAI/MOVE", None, tmp_path / "kept")
    with pytest.raises(BadInput, match="leaves the data set's folder"):
        open_dataset("BAAI/MOVE", folder=tmp_path / "kept")
    assert fake.fetched == [] and not (tmp_path / "kept").exists()


@pytest.mark.parametrize(("error", "says"),
                         [(http_error(GatedRepoError, 403), "is gated: accept its terms"),
                          (http_error(RevisionNotFoundError, 404), "no such commit"),
                          (http_error(RepositoryNotFoundError, 404), "no such data set, or it is private"),
                          (http_error(HfHubHTTPError, 500), "the Hub refused"),
                          (httpx.ConnectError("name resolution failed"), "no network"),
                          (OfflineModeIsEnabled("offline"), "no network"),
                          (LocalEntryNotFoundError("not cached"), "no network"),
                          (OSError(28, "No space left on device"), "cannot be kept on this disk"), ],
                         ids=lambda value: type(value).__name__ if isinstance(value, Exception) else "")
@pytest.mark.parametrize("revision", [None, COMMIT])
def test_every_refusal_is_one_clear_line(fake, tmp_path, error, says, revision):
    fake.error = error
    with pytest.raises(BadInput, match=says) as caught:
        open_dataset("BAAI/MOVE", revision=revision, folder=tmp_path / "kept")
    assert "\n" not in str(caught.value) and "BAAI/MOVE" in str(caught.value)


@pytest.mark.parametrize("revision", ["main", "v2.1", "0123456", COMMIT.upper(), COMMIT + "0", "", COMMIT[:-1] + "\n"])
def test_only_a_full_commit_is_a_revision(fake, tmp_path, revision):
    with pytest.raises(BadInput, match="full commit of 40 hexadecimal digits"):
        open_dataset("BAAI/MOVE", revision=revision, folder=tmp_path / "kept")
    assert fake.listed == 0


def test_the_listing_is_recorded(fake, tmp_path):
    open_dataset("BAAI/MOVE", episodes=1, folder=tmp_path / "kept")
    record = json.loads((tmp_path / f"kept/BAAI--MOVE/{COMMIT}/SOURCE.json").read_text())
    assert record["revision"] == COMMIT and record["repo_id"] == "BAAI/MOVE" and len(record["files"]) == 16


def test_a_file_the_layout_needs_but_the_listing_lacks(fake, tmp_path):
    (fake.folder / "move_35k/data/chunk-000/episode_000001.parquet").unlink()
    with pytest.raises(BadInput, match="has no file .move_35k"):
        open_dataset("BAAI/MOVE", folder=tmp_path / "kept")


def test_other_layouts_from_the_hub(fake, tmp_path):
    shutil.rmtree(fake.folder)
    w.pika_hdf5(fake.folder / "static")
    w.zarr_buffer(fake.folder / "move", zipped=True)
    w.lerobot_v3(fake.folder / "adc")
    data = open_dataset("BAAI/MOVE", episodes=1, folder=tmp_path / "kept")
    assert sorted(e.method for e in data.episodes) == ["adc", "move", "static"]
    assert all(len(e.cameras["cam"]) == 6 for e in data.episodes if e.method == "static")


def test_no_commit_is_invented():
    assert hub.REVISION is None and hub.REPOSITORY == "BAAI/MOVE"
    assert "could not be reached" in hub.__doc__ and "could not be reached" in dataset.open_dataset.__doc__
