"""What is written for a reader is written whole or not at all, and what is damaged is written again."""

import os
import shutil

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from shared import full_disk, refused

from move import paths
from move.errors import BadInput
from move.figures import table4_hyperparameters
from move.figures.page import printed
from move.figures.page.captions import Caption
from move.figures.page.make import make
from move.figures.plots import style
from move.study.execute import how_far
from move.study.profiles import Profile, load_profile
from move.video import write_video

CAPTION = Caption("A line", "What is shown.", "Something.", "A line that rises.")


def figure():
    style.use_style()
    drawn, axes = plt.subplots(figsize=(2, 1.5), layout="constrained")
    axes.plot([0, 1], [0, 1])
    axes.set_title("rises")
    return drawn


def save(folder):
    """All kinds of output."""
    drawn = figure()
    style.save(drawn, "line", folder, CAPTION)
    plt.close(drawn)
    printed.save(pd.DataFrame({"task": ["push"], "rate": [0.5]}), "table2_main", folder, "Rates.")
    write_video(folder / "film.mp4", np.zeros((3, 16, 16, 3), np.uint8), (16, 16), 10, "yuv420p", {})


def content(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("saved")
    save(folder)
    assert sorted(content(folder)) == ["film.mp4", "line.caption.md", "line.pdf", "line.png", "table2_main.csv",
                                       "table2_main.tex"]
    return folder


@pytest.fixture
def outputs(saved, tmp_path):
    return shutil.copytree(saved, tmp_path / "outputs")


def cut(text: bytes) -> bytes:
    return text[:min(100, len(text) // 2)]


def flipped(text: bytes) -> bytes:
    place = text.rindex(b">>\nstream\n") + 24  # in what is compressed
    return text[:place] + bytes([text[place] ^ 255]) + text[place + 1:]


@pytest.mark.parametrize("name, damage", [
    ("line.pdf", cut), ("line.pdf", lambda text: text[:-200]), ("line.pdf", lambda text: b""), ("line.pdf", flipped),
    ("line.pdf", lambda text: text.replace(b"%PDF", b"%PDX", 1)), ("line.pdf", lambda text: text[:500] + text[600:]),
    ("line.png", cut), ("line.png", lambda text: b""), ("line.png", lambda text: text[:300] + b"\xff" + text[301:]),
    ("line.pdf", None), ("line.png", None), ("line.png", lambda text: b"none"),
    ("line.caption.md", cut), ("table2_main.csv", cut), ("table2_main.tex", lambda text: b"\0" + text),
    ("film.mp4", cut)])
def test_what_is_damaged_is_written_again_beside_what_is_whole(outputs, name, damage):
    whole = content(outputs)
    (outputs / name).unlink()
    if damage:
        (outputs / name).write_bytes(damage(whole[name]))
    assert content(outputs) != whole
    save(outputs)
    assert content(outputs) == whole


def test_a_figure_is_saved_alike_whether_or_not_it_has_been_shown(tmp_path):
    style.use_style()
    written = []
    for shown in ((), (72, 200, 150)):
        figure, panels = plt.subplots(1, 3, figsize=(style.PAGE_WIDTH, 2.3))
        for ax in panels:
            ax.set(aspect="equal", xlabel="object x (m)", title="a panel")
        figure.colorbar(panels[0].imshow(np.eye(3)), ax=panels[2], label="success rate")
        for dpi in shown:
            figure.set_dpi(dpi)
            figure.canvas.draw()
        folder = tmp_path / str(len(shown))
        style.save(figure, "f", folder, CAPTION)
        written.append([(folder / f"f.{kind}").read_bytes() for kind in ("pdf", "png")])
    assert written[0] == written[1]


def a_scene(levels: int, folder, size: float = 1.0, title: str = "Scene") -> list[bytes]:
    """What is in `folder` once a grey scene is saved there, one pixel of which is so many levels brighter."""
    image = np.full((40, 40, 3), 100, np.uint8)
    image[20, 20] += levels
    figure = plt.figure(figsize=(size, size))
    figure.figimage(image, resize=False)
    style.save(figure, "f", folder, Caption(title, "Drawn.", "Grey.", "A scene."))
    return [(folder / f"f.{kind}").read_bytes() for kind in ("pdf", "png")]


def test_a_picture_that_differs_by_less_than_can_be_seen_is_left_as_it_is(tmp_path):
    first = a_scene(0, tmp_path)
    assert a_scene(2, tmp_path) == first, "another machine draws a pixel a level or two apart"
    for changed in (a_scene(3, tmp_path), a_scene(0, tmp_path, size=1.1), a_scene(0, tmp_path, title="Another")):
        assert changed[0] != first[0] and changed[1] != first[1]


@pytest.mark.parametrize("name", ["line.pdf", "line.png", "line.caption.md", "table2_main.csv", "table2_main.tex",
                                  "film.mp4"])
def test_a_disk_that_is_full_at_the_end_is_one_line_and_leaves_what_was_there(outputs, name, monkeypatch):
    (outputs / "line.pdf").write_bytes(b"an older one")  # so that the pictures are due
    before, replace = content(outputs), os.replace

    def full(source, target):
        return full_disk() if str(target).endswith(name) else replace(source, target)

    monkeypatch.setattr(os, "replace", full)
    with refused(f"cannot write .*{name}: No space left on device"):
        save(outputs)
    after = content(outputs)
    assert after.keys() == before.keys() and after[name] == before[name]


def test_a_disk_that_is_full_in_the_middle_of_a_picture_leaves_no_half_of_it(outputs, monkeypatch):
    (outputs / "line.pdf").write_bytes(b"an older one")

    def half(self, path, **keywords):
        if keywords["format"] == "pdf":
            path.write_bytes(b"%PDF-1.4 half")
            full_disk()
        path.write(b"png")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", half)
    with pytest.raises(BadInput, match="cannot write .*line.pdf: No space left on device"):
        save(outputs)
    assert content(outputs)["line.pdf"] == b"an older one" and len(content(outputs)) == 6


@pytest.mark.parametrize("text", ["train 10 0", "train 0 0", "train x 5", "dance 1 2", "train 1", "", "\xff"])
def test_a_progress_file_that_says_nothing_is_no_progress(tmp_path, text):
    (tmp_path / "progress").write_text(text, encoding="latin-1")
    assert how_far(tmp_path) is None
    (tmp_path / "progress").write_text("train 5 10")
    assert how_far(tmp_path) == ("train", pytest.approx(0.475))


def test_the_shipped_table_4_is_that_of_the_profiles_and_agrees_with_the_paper_where_it_should(tmp_path, monkeypatch):
    monkeypatch.setattr(Profile, "figures", property(lambda profile: tmp_path))
    made = make("table4_hyperparameters", "laptop")
    (drawn,) = made.tables.values()
    table = drawn.set_index("hyperparameter")
    shipped = pd.read_csv(paths.ROOT / "paper_figures/table4_hyperparameters.csv", dtype=str, keep_default_na=False)
    assert shipped.to_dict("list") == drawn.to_dict("list")
    for name in ("prediction horizon", "action horizon", "observation horizon", "denoising steps in training",
                 "denoising steps in inference", "batch size"):
        assert table.loc[name, "paper"] == table.loc[name, "paper, simulation"]
    for profile in ("laptop", "paper"):
        recipe = load_profile(profile).recipe("rgb", 20_000)
        told = [str(getattr(recipe, field)) for field in table4_hyperparameters.FIELDS.values()]
        assert table.loc[list(table4_hyperparameters.FIELDS), profile].tolist() == told
        printed = drawn[drawn["paper, simulation"] != ""]
        same = (printed[profile] == printed["paper, simulation"]).sum()
        assert f"the profile {profile} has {same} of them word for word" in made.answers["table4_hyperparameters"]
