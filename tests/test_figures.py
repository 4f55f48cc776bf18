"""Words of the figures, which every picture and table has; and pictures of what no stored result enters."""


import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from PIL import Image
from planted import visited

from move import paths
from move.errors import BadInput
from move.figures import demonstrations, fig2_overview, load, names, rollouts
from move.figures.page import captions
from move.figures.page.data import Data
from move.figures.page.kernels import of_profile
from move.figures.page.parameters import parts
from move.figures.plots import film, real_figures, style
from move.figures.tables.ranks import ranks
from move.paper import PAPER_METHODS
from move.realworld import tracking, workspace
from move.realworld.trials import comparisons, real_table
from move.sim.collection import Collection
from move.sim.tasks import get_task
from move.statistics.places import next_places
from move.study.profiles import load_profile

RNG = np.random.default_rng(0)
LAPTOP = load_profile("laptop")
PICTURES = {picture: name for name in names() if "draw" in parts(name)
            for picture in (name, *load(name).WORDS.others)}
"""Every picture, and whose file it is."""


def words_of(picture: str) -> captions.Words:
    own = load(PICTURES[picture]).WORDS
    return own.others.get(picture, own)


def strips(count: int) -> dict:
    frames = RNG.integers(0, 256, (8, 32, 32, 3), dtype=np.uint8)
    return {f"strip {number}, episode 10: success": (frames, list(range(0, 160, 20))) for number in range(count)}


def overview() -> plt.Figure:
    """Figure 2 of places at random; nothing is simulated."""
    places = {name: pd.DataFrame(RNG.uniform([-0.2, 0.5, -0.1, 0.8], [0.1, 0.8, 0.1, 0.9], (50, 4)),
                                 columns=["object_x", "object_y", "target_x", "target_y"]).assign(method=name)
              for name in PAPER_METHODS}
    shares = pd.DataFrame({"method": PAPER_METHODS, "object": 0.25, "target": 0.4})
    seen = Data(LAPTOP, paths.BUILD, seen=fig2_overview.Seen(places, strips(5)))
    return fig2_overview.draw({"": shares}, seen, task="pick-place")


def films() -> plt.Figure:
    seen = rollouts.Seen(pd.DataFrame(), strips(6), [], [])
    return rollouts.draw({}, Data(LAPTOP, paths.BUILD, seen=seen))


def setup() -> plt.Figure:
    steps = pd.DataFrame([{"part": "p", "method": method, "index": index, "step": step, "x_m": 0.1 + 0.04 * step,
                           "y_m": 0.05 * index * step, "z_m": 0.1, "grasped": step > 6}
                          for method in ("static", "move") for index in range(3) for step in range(9)])
    frames = {method: (RNG.integers(0, 256, (6, 18, 32, 3), dtype=np.uint8), [f"{n} s" for n in range(6)])
              for method in ("static", "move")}
    return real_figures.setup_figure(workspace.coverage_by_method(steps), steps, frames, simulated=True)


def grasps() -> plt.Figure:
    """Static grasps in a few places, MOVE's in many."""
    places = {"static": np.repeat(RNG.uniform(0.2, 0.5, (5, 2)), 4, axis=0), "move": RNG.uniform(0.2, 0.5, (20, 2))}
    return real_figures.grasp_figure(
        places, {method: next_places(each, ((0.2, 0.2), (0.5, 0.5)), 10)[0] for method, each in places.items()},
        simulated=True)


def orange() -> plt.Figure:
    places = pd.DataFrame([{"method": method, "part": "p", "index": index, "step": step, "time_s": 0.2 * step,
                            "row": 20.0 + step, "column": 40.0 + step * index, "height": 72, "width": 128}
                           for method in ("static", "move") for index in range(4) for step in range(0, 20, 5)])
    return real_figures.object_figure(places, tracking.object_speeds(places), simulated=True)


BY_HAND = {"fig2_overview": overview, "rollouts": films, "fig8_real_setup": setup, "fig8_object_places": orange,
           "fig8_grasp_places": grasps, "table3_real": lambda: real_figures.cells_figure(real_table(), comparisons())}
"""Pictures whose notebooks are not executed on planted results."""


def test_figure_2_counts_demonstrations_and_the_cells_that_they_visit(tmp_path):
    places = {name: visited(Collection(task="pick-place", method=name, timesteps=400), False).assign(
        method=name, episode=np.arange(400) // (100 + 10 * number)) for number, name in enumerate(PAPER_METHODS)}
    data = Data(LAPTOP, tmp_path, seen=fig2_overview.Seen(places, {}))
    tables = fig2_overview.tables(data, task="pick-place")
    counted = {name: [rows.episode.iloc[-1] + 1, len(rows[["object_x", "object_y"]].drop_duplicates()) / 100,
                      len(rows[["target_x", "target_y"]].drop_duplicates()) / 100, rows.camera_angle.nunique() / 20]
               for name, rows in places.items()}
    assert tables[""].set_index("method").T.to_dict("list") == counted
    answer = fig2_overview.answer(tables, data, timesteps=2500)
    static, adc, move = counted["static"], counted["adc"], counted["move"]
    assert f"MOVE's {move[0]}, static's {static[0]} and ADC's {adc[0]} demonstrations" in answer
    for place, part in enumerate(("object", "target", "camera"), 1):
        assert f"the {part}'s **{move[place]:.0%}**, {static[place]:.0%} and {adc[place]:.0%}" in answer
    panels = fig2_overview.draw(tables, data, task="pick-place").axes[:3]
    for ax, (name, (_, of_objects, of_targets, _)) in zip(panels, counted.items(), strict=True):
        assert ax.get_title(loc="left").endswith(f" {style.NAMES[name]}")
        assert [text.get_text() for text in ax.texts] == [
            f"object {100 * of_objects:.0f} %", f"target {100 * of_targets:.0f} %"]
        boxes = {"object": get_task("pick-place").object_range, "target": get_task("pick-place").target_range}
        for line, frame, (part, box) in zip(ax.get_lines(), ax.patches, boxes.items(), strict=True):
            assert np.array(frame.get_bbox()) == pytest.approx(100 * np.array([box.low[:2], box.high[:2]]))
            assert line.get_color() == style.COLOURS[name]
            assert np.array_equal(line.get_xydata(), 100 * places[name][[f"{part}_x", f"{part}_y"]])
    plt.close("all")


def test_a_perfect_order_has_no_interval_and_another_one_has():
    cells = pd.DataFrame({"value": [0.1, 0.2, 0.3, 0.4], "same": [1, 2, 3, 4], "other": [2, 1, 3, 4]})
    perfect, near = ranks(cells, {"same": "same", "other": "other"}, cells.index.to_numpy())
    assert perfect["correlation"] == 1.0 and np.isnan([perfect["low"], perfect["high"]]).all()
    assert near["correlation"] == pytest.approx(0.8) and -1 <= near["low"] < 0.8 < near["high"] == 1


def test_rollouts_count_the_episodes_that_end_as_in_the_evaluation(tmp_path):
    rows = pd.DataFrame({"method": "move", "episode": [1, 2, 3], "outcome": ["success", "failure", "failure"],
                         "steps": 9, "in the evaluation": ["success", "success", "failure"]})
    data = Data(LAPTOP, tmp_path, seen=rollouts.Seen(rows, {}, [], []))
    text = rollouts.answer({"": rows}, data, episodes=100)
    assert "3 episodes, drawn and not picked; 2 of them ended in the evaluation as they do here" in text


def test_each_demonstration_is_filmed_under_its_own_methods_name(tmp_path, monkeypatch):
    asked, titled = [], []
    monkeypatch.setattr(film, "demonstration", lambda task, method, size: method)
    monkeypatch.setattr(film, "demonstration_take", lambda method, seed: asked.append(method) or method)
    monkeypatch.setattr(film, "titled", lambda take, title, *rest: titled.append((take, title)) or take)
    monkeypatch.setattr(film, "side_by_side", list)
    monkeypatch.setattr(film, "write_film", lambda frames, path: path)
    monkeypatch.setattr(film, "write_webp", lambda frames, path: path)
    monkeypatch.setattr(demonstrations, "gl_problem", lambda: "")
    demonstrations.seen(Data(LAPTOP, tmp_path), tasks=("push",))
    assert titled == [("static", "static"), ("adc", "ADC"), ("move", "MOVE")]


def test_every_shipped_file_of_a_figure_has_words():
    """What stands in paper_figures is a picture or a table that a figure's words name, and all of these are there."""
    folder = paths.ROOT / "paper_figures"
    stored = of_profile(LAPTOP, stored_only=True)
    tables = {f"{name}_{suffix}".rstrip("_") for name in stored for suffix in load(name).WORDS.tables}
    pictures = {picture for picture, name in PICTURES.items() if name in stored}
    for ending, known in (("png", pictures), ("pdf", pictures), ("caption.md", pictures),
                          ("csv", tables), ("tex", tables)):
        assert {path.name.removesuffix(f".{ending}") for path in folder.glob(f"*.{ending}")} == known


WORDS = captions.Words("A title", "What is drawn.", "A chart.", {"": "Rates."})


def test_a_caption_is_read_back_as_it_was_written(tmp_path):
    written = captions.caption(WORDS, "From pixels.", "**MOVE** is:\n- ahead")
    (tmp_path / "a.caption.md").write_text(written.markdown())
    assert captions.read(tmp_path / "a.caption.md") == written
    assert written.found == "MOVE is: ahead." and written.alt.endswith(written.found) and "From pixels." in written.text
    assert len(captions.caption(WORDS, "", "Ahead of it. " * 100).alt) < 600
    (tmp_path / "b.caption.md").write_text("nothing")
    with pytest.raises(BadInput, match="allowed is what the figures write"):
        captions.read(tmp_path / "b.caption.md")
    with pytest.raises(BadInput, match="'more' given"):
        captions.table_caption(WORDS, "more")


def test_the_files_of_a_figure_hold_its_title_and_its_alternative_text(tmp_path):
    caption, (figure, ax) = captions.caption(WORDS, "", "Six hold."), plt.subplots()
    ax.plot([1, 2])
    style.save(figure, "claims", tmp_path, caption)
    plt.close(figure)
    with Image.open(tmp_path / "claims.png") as saved:
        assert saved.info["Title"] == caption.title and saved.info["Description"] == caption.alt
    assert b"/Title" in (tmp_path / "claims.pdf").read_bytes()
    assert captions.read(tmp_path / "claims.caption.md") == caption
