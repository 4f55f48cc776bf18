"""Writing under a temporary name: whole or not at all, whatever stops it, and what a killed process left is deleted."""

import os
import subprocess
import sys

import pytest

from move import files, paths
from move.errors import BadInput

DEAD = 2**22 + 1  # above every process number of Linux


def names(folder) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_file_and_a_folder_take_their_place_in_one_step(tmp_path):
    for text in ("first", "second"):
        with files.written_aside(tmp_path / "deep/file") as beside:
            beside.write_text(text)
        with files.written_aside(tmp_path / "folder") as beside:
            beside.mkdir()
            (beside / text).touch()
    assert (tmp_path / "deep/file").read_text() == "second" and names(tmp_path / "folder") == ["second"]
    assert names(tmp_path) == ["deep", "folder"] and names(tmp_path / "deep") == ["file"]


@pytest.mark.parametrize("error, raised", [
    (OSError(28, "No space left on device"), BadInput),
    (KeyError("x"), KeyError),
])
def test_what_fails_leaves_what_was_there(tmp_path, error, raised):
    (tmp_path / "file").write_text("old")
    with pytest.raises(raised) as caught, files.written_aside(tmp_path / "file") as beside:
        beside.write_text("half")
        raise error
    assert names(tmp_path) == ["file"] and (tmp_path / "file").read_text() == "old"
    assert raised is KeyError or "file: No space left on device; allowed is" in str(caught.value)


def test_an_old_folder_comes_back_when_the_new_one_cannot_take_its_place(tmp_path, monkeypatch):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/old").touch()
    real = os.replace

    def replace(source, target):
        if str(source).endswith(".part"):
            raise OSError(5, "Input/output error")
        real(source, target)

    monkeypatch.setattr(files.os, "replace", replace)
    with pytest.raises(BadInput), files.written_aside(tmp_path / "folder") as beside:
        beside.mkdir()
    assert names(tmp_path) == ["folder"] and names(tmp_path / "folder") == ["old"]


def left_behind(folder, name: str, process: int, ending: str):
    path = folder / f".{name}.{files.HOST}.{process}.{ending}"
    path.mkdir(parents=True)
    (path / "content").touch()
    return path


def test_what_a_killed_process_left_is_put_away_and_what_others_own_is_not(tmp_path):
    left_behind(tmp_path, "data", DEAD, "part")
    left_behind(tmp_path, "data", DEAD, "old")  # and there is no "data": it was killed between the two renames
    kept = [left_behind(tmp_path, "data", os.getpid(), "part"), left_behind(tmp_path, "other", DEAD, "part")]
    kept.append(tmp_path / ".data.elsewhere.7.part")
    kept[-1].touch()
    files.put_away_remains(tmp_path / "data")
    assert names(tmp_path) == sorted(["data", *(path.name for path in kept)])
    assert names(tmp_path / "data") == ["content"]
    left_behind(tmp_path, "data", DEAD, "old")  # now the new one is there
    files.put_away_all_remains(tmp_path)  # whatever they wrote
    assert names(tmp_path) == sorted(["data", *(path.name for path in kept if "other" not in path.name)])


@pytest.mark.parametrize("moment", ["written", "moved"])
def test_killed_at_a_bad_moment(tmp_path, moment):
    program = f"""
import os, signal
from pathlib import Path
from move import files
path = Path({str(tmp_path / "data")!r})
path.mkdir()
(path / "old").touch()
real = os.replace
def replace(source, target):
    if source.name.endswith(".part"):
        os.kill(os.getpid(), signal.SIGKILL)
    real(source, target)
files.os.replace = replace
with files.written_aside(path) as beside:
    beside.mkdir()
    if {moment!r} == "written":
        os.kill(os.getpid(), signal.SIGKILL)
"""
    killed = subprocess.run([sys.executable, "-c", program], cwd=paths.ROOT)
    assert killed.returncode == -9 and len(names(tmp_path)) == 2
    with files.written_aside(tmp_path / "data") as beside:
        assert names(tmp_path / "data") == ["old"]
        beside.mkdir()
    assert names(tmp_path) == ["data"] and names(tmp_path / "data") == []


@pytest.mark.parametrize("place", ["", ".", "/", "..", "/dev/null/x", "/proc/x", "n" * 300, "m" * 300 + "/x", "a\0b"])
def test_places_where_nothing_can_be_written(place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput) as caught:
        files.refuse_unwritable(paths.Path(place))
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 300 and not names(tmp_path)


def test_a_place_below_a_file_is_refused_and_one_below_missing_folders_is_not(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(BadInput, match="Not a directory"):
        files.refuse_unwritable(tmp_path / "file/x")
    files.refuse_unwritable(tmp_path / "a/b/c")
    assert names(tmp_path) == ["file"]
    with pytest.raises(BadInput, match="file exists; allowed is a new folder"):
        files.refuse_existing(tmp_path / "file")


def test_a_file_takes_no_folders_place(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("all of it")
    with pytest.raises(BadInput, match="mine is a folder; allowed is the path of a file"):
        files.refuse_folder(tmp_path / "mine")
    with pytest.raises(BadInput, match="cannot write .*mine"), files.written_aside(tmp_path / "mine") as new:
        new.write_text("a table")
    assert [path.name for path in tmp_path.rglob("*")] == ["mine", "thesis.tex"]
    assert (tmp_path / "mine" / "thesis.tex").read_text() == "all of it"
