"""The real-robot notebooks run from nothing, without a network, and on whatever data set they are given."""

import json
from pathlib import Path

import cells
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import real_writers as w

from move import paths
from move.figures import load
from move.figures.page import captions, printed
from move.figures.page.make import Made
from move.figures.plots import style
from move.study.profiles import Profile

TRIALS, SETUP = "table3_real", "fig8_real_setup"


@pytest.fixture
def drawn(tmp_path, monkeypatch) -> dict[str, plt.Figure]:
    """The pictures that a page draws, by their names, none of which is saved; what else it makes is in `tmp_path`."""
    figures = {}

    def kept(figure, name, *others):
        figures[name] = figure
        cells.picture_left_empty(figure, name, *others)

    monkeypatch.setattr(style, "save", kept)
    monkeypatch.setattr(Made, "picture", lambda self, name="": name)  # which would be shown
    monkeypatch.setattr(Profile, "figures", property(lambda profile: tmp_path / profile.name))
    for name, place in (("REALWORLD", tmp_path / "realworld"), ("own_figures", lambda name: tmp_path / name),
                        ("ROOT", tmp_path)):
        monkeypatch.setattr(paths, name, place)
    yield figures
    plt.close("all")


def test_they_make_their_figures_and_tables_from_nothing(tmp_path, drawn, monkeypatch):
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    cells.execute(TRIALS, profile="smoke")
    cells.execute(SETUP, profile="smoke", episodes=5)
    assert set(drawn) == {"table3_real", "fig8_real_setup", "fig8_object_places", "fig8_grasp_places"}
    assert {path.name for path in (tmp_path / "smoke").iterdir()} == {
        f"{name}.{kind}" for name in drawn for kind in ("png", "caption.md")} | {
        f"{name}.{kind}" for name in ("table3_real", "fig8_real_setup_checks") for kind in ("csv", "tex")}
    assert {path.name for path in tmp_path.iterdir()} == {"smoke", "realworld"}


def test_they_run_on_data_without_poses_or_cameras_and_with_a_sheet(tmp_path, drawn):
    w.lerobot_v2(tmp_path / "bare")
    lines = "".join(f"{n},{method},0.3,0.0,{n % 4}\n" for n in range(1, 6) for method in ("static", "MOVE"))
    (tmp_path / "sheet.csv").write_text("trial,method,position_x_m,position_y_m,score\n" + lines)
    cells.execute(SETUP, dataset=str(tmp_path / "bare"))
    assert "fig8_real_setup" in drawn
    made = cells.execute(TRIALS, sheet=str(tmp_path / "sheet.csv"))["made"]
    assert made.data.seen.trials.tolist() == [5, 5]


def students_arm(folder: Path) -> Path:
    """A LeRobot v2.1 set as a student records it: an SO-100, six named joints in degrees, one camera, 3 episodes."""
    names = [f"main_{name}" for name in ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll",
                                         "gripper")]
    steps = np.linspace(0, 1, w.STEPS)[:, None]

    def values(episode: int) -> np.ndarray:
        return np.hstack([steps * [[90, 150, -120, 60, 30]] + 3 * episode, 2 + 37 * steps])

    w.lerobot_v2(folder, episodes=3, values=values, names=names, width=6, robot_type="so100", codec="libx264")
    info = json.loads((folder / "meta/info.json").read_text())
    info["features"]["action"]["names"] = names
    (folder / "meta/info.json").write_text(json.dumps(info))
    for path in sorted(folder.rglob("*.mp4")):
        w.write_video(path, range(w.STEPS), size=(48, 64))
    return folder


@pytest.mark.filterwarnings("error:constrained_layout")  # axes that collapse
@pytest.mark.parametrize("units", ["", "'*': {joints: deg}"])
def test_a_students_data_set_of_another_arm_is_drawn_without_pipers_kinematics(tmp_path, drawn, units, monkeypatch):
    monkeypatch.setattr(style, "MOST_PASSES", 5)
    folder = students_arm(tmp_path / "so100")
    (tmp_path / "units.yaml").write_text(units)
    made = cells.execute(SETUP, dataset=str(folder), units_file=str(tmp_path / "units.yaml") if units else "")["made"]
    style.settle(drawn["fig8_real_setup"])
    panels = [text.get_text() for ax in drawn["fig8_real_setup"].axes for text in ax.texts]
    assert any("3 of 3 episodes: the arm is so100, not PIPER" in " ".join(text.split()) for text in panels)
    assert ["0.0 s", "0.1 s", "0.2 s"] == panels[:3], "frames are labelled by their times"
    joints = {text.get_text(): [line.get_ydata()[[0, -1]].tolist() for line in ax.get_lines()]
              for ax in drawn["fig8_real_setup"].axes for text in ax.texts if ax.get_lines()}
    assert joints == {name: [pytest.approx([3 * episode, end + 3 * episode], abs=1e-3) for episode in range(3)]
                      for name, end in (("shoulder_pan", 90), ("shoulder_lift", 150), ("elbow_flex", -120),
                                        ("wrist_flex", 60), ("wrist_roll", 30))}, "in degrees, a line an episode"
    assert "Not the shipped figure" in drawn["fig8_real_setup"].get_suptitle()
    assert made.data.seen.steps.empty
    assert not any("hand" in ax.get_title("left") for ax in drawn["fig8_real_setup"].axes)
    checks = made.tables["checks"].set_index("name").outcome
    assert checks["every timestep has its frames"] == "pass" and checks["time increases"] == "pass"
    assert checks["all units are known"] == "pass"  # beyond 100 they are no per cent
    assert checks["recorded pose agrees with PIPER's kinematics"] == "unknown"


def spoilt(folder: Path) -> Path:
    """A LeRobot set of which a video is missing, an episode unreadable, joints and times are no numbers in places."""
    values = np.vstack([[np.nan] * 7, w.state()[1:]])
    w.lerobot_v2(folder, episodes=4, codec="libx264", values=lambda n: values if n < 2 else w.state(n))
    next(folder.rglob("episode_000000.mp4")).unlink()
    w.change_table(folder / "data/chunk-000/episode_000001.parquet", timestamp=[0, np.nan, 0.2, 0.3, np.inf, 0.5])
    (folder / "data/chunk-000/episode_000003.parquet").write_bytes(b"PAR1")
    return folder


LAYOUTS = w.LAYOUTS | {"spoilt": spoilt}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_page_goes_on_with_every_layout_and_with_spoilt_data(tmp_path, drawn, layout):
    made = cells.execute(SETUP, dataset=str(LAYOUTS[layout](tmp_path / "set")))["made"]
    assert "fig8_real_setup" in drawn
    if layout == "spoilt":
        checks = made.tables["checks"].set_index("name")
        assert set(checks.index[checks.outcome == "differs"]) >= {
            "every chosen episode can be read", "all values are finite", "every timestep has its frames",
            "time increases"}
        assert made.data.seen.steps.x_m.isna().sum() == 2 and len(made.data.seen.steps) == 18


def test_a_layout_that_never_rests_is_written_as_it_is(tmp_path, monkeypatch):
    monkeypatch.setattr(style, "MOST_PASSES", 1)
    figure, _ = plt.subplots(layout="constrained")
    style.save(figure, "moving", tmp_path, captions.caption(load(TRIALS).WORDS))
    assert {path.name for path in tmp_path.iterdir()} == {"moving.pdf", "moving.png", "moving.caption.md"}
    plt.close(figure)


def test_no_text_of_a_data_set_is_markup_in_the_browser():
    odd = "<img src=x onerror=alert(1)>"
    html = printed.shown(pd.DataFrame({"part": [odd], odd: ["a & b"]})).to_html()
    assert "<img" not in html and html.count("&lt;img src=x onerror=alert(1)&gt;") == 2 and "a &amp; b" in html
    assert printed.as_markdown(f"{odd} [a](javascript:b) *c*") == (
        r"&lt;img src=x onerror=alert(1)&gt; \[a\](javascript:b) \*c\*")
    assert "](" not in captions.caption(load(SETUP).WORDS, "folder [a](javascript:b)").markdown()


def test_what_a_data_set_says_of_its_arm_is_no_markup_in_the_answer(tmp_path, drawn):
    odd = "[a](javascript:b) *c*"
    w.lerobot_v2(tmp_path / "odd", names=["a", "b"], width=2, values=lambda _: w.state()[:, :2], robot_type=odd)
    made = cells.execute(SETUP, dataset=str(tmp_path / "odd"))["made"]
    assert r"the arm is \[a\](javascript:b) \*c\*, not PIPER" in made.answer.data
