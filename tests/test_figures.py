"""Every picture, drawn from planted results: readable when printed, panels lettered, nothing cut off, all captioned."""

import math
import re

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.collections import PathCollection, QuadMesh  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402
from matplotlib.container import ErrorbarContainer  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from PIL import Image  # noqa: E402
from planted import World, visited  # noqa: E402

from move import paths  # noqa: E402
from move.errors import BadInput  # noqa: E402
from move.figures import fig2_overview, load, names, rollouts  # noqa: E402
from move.figures.page import captions  # noqa: E402
from move.figures.page.data import Data  # noqa: E402
from move.figures.page.kernels import of_profile  # noqa: E402
from move.figures.page.parameters import parts  # noqa: E402
from move.figures.plots import real_figures, style  # noqa: E402
from move.paper import PAPER_METHODS  # noqa: E402
from move.realworld import tracking, workspace  # noqa: E402
from move.realworld.trials import comparisons, real_table  # noqa: E402
from move.sim.collection import Collection  # noqa: E402
from move.statistics.places import next_places  # noqa: E402
from move.study.profiles import load_profile  # noqa: E402

RNG = np.random.default_rng(0)
ROBOT = ("fig8_real_setup", "fig8_object_places", "fig8_grasp_places")
PICTURES = {picture: name for name in names() if "draw" in parts(name)
            for picture in (name, *load(name).WORDS.others)}
"""Every picture, and whose file it is."""


def words(picture: str) -> captions.Words:
    own = load(PICTURES[picture]).WORDS
    return own.others.get(picture, own)


def strips(count: int) -> dict:
    frames = RNG.integers(0, 256, (8, 32, 32, 3), dtype=np.uint8)
    return {f"strip {number}, episode 10: success": (frames, list(range(0, 160, 20))) for number in range(count)}


def overview(data: Data) -> plt.Figure:
    """Figure 2 of places at random; nothing is simulated."""
    places = {name: pd.DataFrame(RNG.uniform([-0.2, 0.5, -0.1, 0.8], [0.1, 0.8, 0.1, 0.9], (50, 4)),
                                 columns=["object_x", "object_y", "target_x", "target_y"]).assign(method=name)
              for name in PAPER_METHODS}
    shares = pd.DataFrame({"method": PAPER_METHODS, "object": 0.25, "target": 0.4})
    seen = Data(data.profile, data.folder, seen=fig2_overview.Seen(places, strips(5)))
    return fig2_overview.draw({"": shares}, seen, task="pick-place")


def films(data: Data) -> plt.Figure:
    seen = rollouts.Seen(pd.DataFrame(), strips(6), [], [])
    return rollouts.draw({}, Data(data.profile, data.folder, seen=seen))


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


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """Planted results, of which four figures lack a cell: question marks stand in its place."""
    world = World(tmp_path_factory.mktemp("world"), laid_out=True)
    fast = round(math.radians(2.67), 6)
    for name, cell in (("fig4_scaling", {"task": "pick-place", "method": "move", "timesteps": 40_000}),
                       ("fig7_speed", {"task": "pick-place", "method": "move", "camera_speed": fast}),
                       ("few_demonstrations", {"method": "static", "timesteps": 1550}),
                       ("fig_training_length", {"task": "push", "method": "move", "length": 3.0})):
        for result in world.found(name, **cell):
            (world.folder / f"results/laptop/{result.spec.hash}.json").unlink()
    yield world
    plt.close("all")


def picture(name: str, world: World) -> plt.Figure:
    by_hand = {"fig2_overview": overview, "rollouts": films}
    if name in by_hand:
        return by_hand[name](Data(load_profile("laptop"), world.folder))
    if name in ROBOT:
        return {"fig8_real_setup": setup, "fig8_object_places": orange, "fig8_grasp_places": grasps}[name]()
    if name == "table3_real":
        return real_figures.cells_figure(real_table(), comparisons())
    world.show(PICTURES[name])
    return world.figures[name]


def seen_texts(figure: plt.Figure) -> list[Text]:
    """Every text of a drawn figure that a reader sees: not those of ticks beyond an axis, or of an axis that is off."""
    unseen = set()
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            slack = 1e-6 * (high - low)
            for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
                if not (ax.axison and low - slack <= tick.get_loc() <= high + slack):
                    unseen |= {tick.label1, tick.label2}
            unseen |= set() if ax.axison else {axis.label, axis.get_offset_text()}
    return [text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()
            and text not in unseen]


@pytest.fixture(params=PICTURES, scope="module")
def drawn(request, world):
    style.use_style()
    figure = picture(request.param, world)
    figure.set_label(request.param)
    style.remark(figure, "114 of 154 runs are missing")
    figure.set_dpi(plt.rcParams["savefig.dpi"])  # as it is written
    style.settle(figure)
    figure.draw_without_rendering()
    yield figure
    plt.close(figure)


def test_a_figure_can_be_printed(drawn):
    """One or two columns wide, no text under 7 points, none cut off at the edge, none over another."""
    assert round(drawn.get_figwidth(), 2) in (style.COLUMN_WIDTH, style.PAGE_WIDTH)
    texts = seen_texts(drawn)
    assert texts and [text for text in texts if text.get_fontsize() < style.LEAST_POINTS] == []
    width, height = drawn.bbox.width, drawn.bbox.height
    boxes = {text: text.get_window_extent() for text in texts}
    cut = [text.get_text() for text, box in boxes.items()
           if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1]
    assert cut == []
    inner = [(text.get_text(), box.x0 + 1, box.x1 - 1, box.y0 + 1, box.y1 - 1) for text, box in boxes.items()]
    over = [(one[0], other[0]) for place, one in enumerate(inner) for other in inner[:place]
            if min(one[2], other[2]) > max(one[1], other[1]) and min(one[4], other[4]) > max(one[3], other[3])]
    assert over == []


def test_panels_have_letters_in_order(drawn):
    named = [ax.get_title(loc="left") for ax in drawn.axes if ax.get_title(loc="left")]
    letters = re.findall(r"\\bf\{([a-z])\}", " ".join(named))
    assert letters == (list("abcdefghijkl"[:len(named)]) if len(named) > 1 else [])
    panels = [ax for ax in drawn.axes if ax.get_label() != "<colorbar>"]
    assert len(named) == len(panels) or len(panels) == 1


def lines(figure: plt.Figure, **wanted) -> list[Line2D]:
    """The lines and points of a figure, legends left out, whose properties are these."""
    return [line for ax in figure.axes for line in ax.get_lines() if len(line.get_xdata())
            and all(getattr(line, f"get_{name}")() == value for name, value in wanted.items())]


MARKS = {  # what a caption calls it -> whether it is drawn
    r"[Ww]hite dots": lambda figure: any(
        isinstance(dots, PathCollection) and dots.get_sizes().tolist() == [8] and len(dots.get_offsets())
        for ax in figure.axes for dots in ax.collections),
    r"dotted": lambda figure: lines(figure, linestyle=":", color="black"),
    r"[Dd]iamond": lambda figure: lines(figure, marker="D") and figure.get_label() != "statistics",  # "one shape a ..."
    r"[Qq]uestion marks": lambda figure: lines(figure, marker="$?$"),
    r"seen from above": lambda figure: any(isinstance(mesh, QuadMesh) for ax in figure.axes for mesh in ax.collections)
    or figure.get_label() in ("fig2_overview", "fig8_real_setup"),
    r"interval": lambda figure: any(isinstance(bars, ErrorbarContainer) for ax in figure.axes for bars in ax.containers)
    or figure.get_label() == "statistics",
    r"Rings": lambda figure: any(isinstance(dots, PathCollection) and dots.get_sizes().tolist() == [22]
                                 for ax in figure.axes for dots in ax.collections)
    and figure.get_label() != "fig3_dense",  # whose grasp points lie everywhere
    r"Open points": lambda figure: lines(figure, label="_pooled"),
    r"hollow": lambda figure: [line for line in lines(figure, marker="o") if to_hex(line.get_mfc()) == "#ffffff"
                               and line.get_label() != "_pooled"],
}


def test_the_caption_names_the_marks_that_are_drawn_and_no_other(drawn):
    text = captions.caption(words(drawn.get_label())).text
    told = {mark: bool(re.search(mark, text)) for mark in MARKS}
    assert told == {mark: bool(there(drawn)) for mark, there in MARKS.items()}


def test_every_letter_that_the_caption_names_is_a_panel(drawn):
    panels = set(re.findall(r"\\bf\{([a-z])\}", " ".join(ax.get_title(loc="left") for ax in drawn.axes)))
    told = re.findall(r"\(([a-z])(?:, ([a-z])| to ([a-z])| and ([a-z]))?\)", words(drawn.get_label()).shown)
    assert {letter for letters in told for letter in letters if letter} <= panels


def test_what_comes_from_keypoints_says_so(world):
    for name in ("keypoint_control", "table_keypoint_control", "table2_main", "table_adc", "fig_perception"):
        assert any("keypoints" in text.get_text() for text in seen_texts(picture(name, world))), name


def test_figure_2_counts_demonstrations_and_the_cells_that_they_visit(tmp_path):
    places = {name: visited(Collection(task="pick-place", method=name, timesteps=400), False).assign(
        method=name, episode=np.arange(400) // (100 + 10 * number)) for number, name in enumerate(PAPER_METHODS)}
    data = Data(load_profile("laptop"), tmp_path, seen=fig2_overview.Seen(places, {}))
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


def test_every_shipped_file_of_a_figure_has_words():
    """What stands in paper_figures is a picture or a table that a figure's words name, and all of these are there."""
    folder = paths.ROOT / "paper_figures"
    stored = of_profile(load_profile("laptop"), stored_only=True)
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
