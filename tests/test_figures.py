"""Every whole figure, from toy tables: readable when printed, panels lettered, nothing cut off, all of it captioned."""

import inspect
import re
from types import ModuleType

import matplotlib

matplotlib.use("Agg")

import claimed  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import nbformat  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.collections import PathCollection, QuadMesh  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402
from matplotlib.container import ErrorbarContainer  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from matplotlib.text import Text  # noqa: E402

from move import paths  # noqa: E402
from move.errors import BadInput  # noqa: E402
from move.experiments.gap import SETTINGS  # noqa: E402
from move.experiments.preliminary import HANDS  # noqa: E402
from move.paper import PAPER_METHODS, PAPER_TASKS, published  # noqa: E402
from move.realworld import tracking, workspace  # noqa: E402
from move.realworld.trials import real_table  # noqa: E402
from move.report import captions, figures, real_figures, style, tables, words  # noqa: E402
from move.report.gap import waterfall  # noqa: E402
from move.sim.tasks import get_task  # noqa: E402

RNG = np.random.default_rng(0)


def rates(methods=("static", "move"), **columns) -> pd.DataFrame:
    """A row a method and value of each column, the last column running fastest; one value is missing."""
    index = pd.MultiIndex.from_product([*columns.values(), methods], names=[*columns, "method"])
    values = RNG.uniform(0.2, 0.9, len(index))
    table = pd.DataFrame({"value": values, "low": values - 0.1, "high": values + 0.1, "paper": values / 2,
                          "seeds": [[value - 0.05, value + 0.05] for value in values]}, index).reset_index()
    return table


def one_missing(table: pd.DataFrame) -> pd.DataFrame:
    table.loc[1, ["value", "low", "high"]] = np.nan
    return table.assign(seeds=[[] if place == 1 else seeds for place, seeds in enumerate(table.seeds)])


def grid() -> pd.DataFrame:
    return pd.DataFrame([
        {"group": "grid", "object_x": -0.19 + 0.05 * x, "object_y": 0.51 + 0.05 * y, "seed": seed, "method": method,
         "success": (x + y + seed) % 3 > 0}
        for method in ("static", "move") for x in range(6) for y in range(6) for seed in range(3)]
        + [{"group": "point", "object_x": 0.1, "object_y": 0.8, "seed": 0, "method": method, "success": True}
           for method in ("static", "move")])


def compared(by: str, values, others=("static", "adc")) -> pd.DataFrame:
    return pd.DataFrame([{by: value, "baseline": other, "difference": 0.1, "low": -0.3, "high": 0.4, "paper": 0.2}
                         for value in values for other in others])


def seen(method: str) -> pd.DataFrame:
    places = RNG.uniform(0, 1, (50, 4))
    return pd.DataFrame({"method": method, "object_x": -0.2 + 0.3 * places[:, 0], "object_y": 0.5 + 0.3 * places[:, 1],
                         "target_x": 0.2 * places[:, 2] - 0.1, "target_y": 0.8 + 0.1 * places[:, 3]})


def strips(count: int = 2) -> dict:
    frames = RNG.integers(0, 256, (8, 32, 32, 3), dtype=np.uint8)
    return {f"strip {number}, episode 10: success": (frames, list(range(0, 160, 20))) for number in range(count)}


def ranges() -> dict:
    task = get_task("pick-place")
    return {"object": task.object_range, "target": task.target_range}


def recipe(budget: int) -> pd.DataFrame:
    names = ["chosen", "one noise level a window", "encoder learns from all frames", "3 times as long"]
    return pd.DataFrame([{"timesteps": budget, "change": name, "value": 0.9, "low": 0.8, "high": 1.0, "gain": -0.05,
                          "gain_low": -0.2, "gain_high": 0.1, "train_minutes": 19.5} for name in names])


def costs() -> pd.DataFrame:
    return pd.DataFrame([{"task": task, "method": method, "expert": expert, "mean_steps": 100 + place,
                          "generation_rate": 1 - place / 20}
                         for place, task in enumerate(PAPER_TASKS) for method in PAPER_METHODS
                         for expert in ("phase", "metaworld")])


def controls() -> pd.DataFrame:
    return pd.DataFrame({"expert": 1.0, "goal-blind": 0.3}, index=list(PAPER_TASKS))


def means() -> pd.DataFrame:
    return compared("task", ["x"]).drop(columns="task").assign(items=10)


def simulated() -> pd.DataFrame:
    return pd.DataFrame([{"seeds": seeds, "deviation": deviation, "interval": name, "covered": 0.95,
                          "half_width": 0.1 + deviation}
                         for name in ("ours", "episodes alone") for seeds in (1, 3, 5) for deviation in (0.03, 0.2)])


def moves() -> pd.DataFrame:
    names = ["nothing", "object", "object + target + camera + rotation", "camera alone"]
    return one_missing(rates(("move",), task=["pick-place", "assembly"], moves=names))


def speeds() -> pd.DataFrame:
    still = rates(("static",), task=["pick-place", "assembly"], part=["nothing"], speed=[0.0])
    moved = rates(("move",), task=["pick-place"], part=["object", "camera"], speed=[0.01, 0.08])
    return pd.concat([one_missing(moved), still, rates(("move",), task=["assembly"], part=["object"], speed=[0.03])])


def real_steps() -> pd.DataFrame:
    way = [{"part": "p", "method": method, "index": index, "step": step, "x_m": 0.1 + 0.04 * step,
            "y_m": 0.05 * index * step, "z_m": 0.1, "grasped": step > 6}
           for method in ("static", "move") for index in range(3) for step in range(9)]
    return pd.DataFrame(way)


def setup() -> plt.Figure:
    steps = real_steps()
    frames = {method: (RNG.integers(0, 256, (6, 18, 32, 3), dtype=np.uint8), [f"{n} s" for n in range(6)])
              for method in ("static", "move")}
    return real_figures.setup_figure(workspace.coverage_by_method(steps), steps, frames, simulated=True)


def gap() -> plt.Figure:
    settings = [name for name in SETTINGS if "10 times" not in name]
    table = rates(case=["figure 1", "pick-place", "push"], setting=settings)
    table = table.assign(paper=0.3, effect=-0.05, effect_low=-0.1, effect_high=0.02)
    leads = compared("setting", settings, ("static",))
    cases = list(table.case.unique())
    return figures.gap(waterfall(table), table, pd.concat([leads.assign(case=case) for case in cases]), cases)


def orange() -> plt.Figure:
    places = pd.DataFrame([{"method": method, "part": "p", "index": index, "step": step, "time_s": 0.2 * step,
                            "row": 20.0 + step, "column": 40.0 + step * index, "height": 72, "width": 128}
                           for method in ("static", "move") for index in range(4) for step in range(0, 20, 5)])
    return real_figures.object_figure(places, tracking.object_speeds(places), simulated=True)


FIGURES = {
    "few_demonstrations": lambda: figures.few_demonstrations(
        one_missing(rates(timesteps=[1300, 3250, 7000])), rates(timesteps=[1300, 3250, 7000])),
    "fig1_sparse": lambda: figures.fig1_sparse(grid(), one_missing(rates(hand=list(HANDS)))),
    "fig2_overview": lambda: figures.fig2_overview(
        {method: seen(method) for method in PAPER_METHODS},
        pd.DataFrame({"method": PAPER_METHODS, "object": 0.25, "target": 0.4}), ranges(), strips(3)),
    "fig3_dense": lambda: figures.fig3_dense(
        grid(), grid(), rates(hand=list(HANDS)), rates(timesteps=[2000, 3500, 7000])),
    "fig4_scaling": lambda: figures.fig4_scaling(
        one_missing(rates(PAPER_METHODS, task=PAPER_TASKS, timesteps=[5000, 10_000, 20_000, 40_000, 50_000, 100_000])),
        tables.printed_success(list(PAPER_TASKS))),
    "fig4_efficiency": lambda: figures.fig4_efficiency(
        pd.DataFrame([{"task": "push", "ratio": np.inf, "low": 1.0, "high": np.inf, "most": 4.0}]), PAPER_TASKS),
    "fig5_circle": lambda: figures.fig5_circle(grid(), rates(hand=list(HANDS), where=["inside", "outside"])),
    "fig6_dimensions": lambda: figures.fig6_dimensions(moves()),
    "fig7_speed": lambda: figures.fig7_speed(speeds()),
    "fig_mixture": lambda: figures.fig_mixture(one_missing(rates(("mixture",), share=[0, 0.25, 1])), "pick-place"),
    "fig_speed_law": lambda: figures.fig_speed_law(
        one_missing(rates(("move",), law=["beta", "uniform", "constant"])), "pick-place"),
    "fig_training_length": lambda: figures.fig_training_length(
        one_missing(rates(task=["pick-place", "push", "window-open"], length=[1 / 3, 1, 3]))),
    "equal_demonstrations": lambda: figures.equal_demonstrations(
        one_missing(rates(equal=["timesteps", "demonstrations"])), "pick-place"),
    "fig_coverage": lambda: figures.fig_coverage(
        rates(PAPER_METHODS, task=["push", "hammer"], moves=["all", "object"]).assign(
            object=0.9, camera=1.0, joint=np.linspace(0.2, 0.7, 12))),
    "fig_perception": lambda: figures.fig_perception(one_missing(rates(
        observation=["rgb", "keypoints"], experiment=["figure 1", "figure 3", "figure 5", "table 1, object",
                                                      "table 1, object+target", "table 1, all"]))),
    "gap": gap,
    "generalization": lambda: figures.generalization(
        rates(PAPER_METHODS, task=PAPER_TASKS, group=["grasp", "random", "moving"])),
    "keypoint_control": lambda: figures.keypoint_control(
        rates(PAPER_METHODS, timesteps=[1250, 2500, 5000]), {"expert": 1.0, "goal-blind": 0.33},
        published("table2_main", task="pick-place").assign(timesteps=20_000)),
    "rollouts": lambda: figures.rollouts(strips(6)),
    "statistics": lambda: figures.statistics(simulated()),
    "table1_spatial_factors": lambda: figures.table1_spatial_factors(
        rates(factors=["object", "all"]), compared("factors", ["object", "all"], ("static",)).drop(columns="paper"),
        {"object": "object", "all": "+ camera"}),
    "table2_main": lambda: figures.table2_main(
        rates(PAPER_METHODS, task=PAPER_TASKS), rates(PAPER_METHODS, task=PAPER_TASKS).drop(columns="paper"),
        controls(), compared("task", PAPER_TASKS), means()),
    "table3_real": lambda: real_figures.cells_figure(real_table()),
    "table6_collection": lambda: figures.table6_collection(
        costs(), pd.DataFrame({"method": ["static"], "paper_mean_steps": [83.8], "paper_generation_rate": [0.93]})),
    "table_adc": lambda: figures.table_adc(
        rates(("adc",), observation=["rgb", "keypoints"], task=PAPER_TASKS,
              jumping=["as printed", "mended", "periodic"])),
    "table_keypoint_control": lambda: figures.table_keypoint_control(
        rates(PAPER_METHODS, task=PAPER_TASKS).drop(columns="paper"), controls()),
    "table_recipe": lambda: figures.table_recipe(pd.concat([recipe(7000), recipe(20_000)])),
    "claims": lambda: figures.claims(claimed.numbers()),
    "fig8_real_setup": setup,
    "fig8_object_places": orange,
}


def of(module: ModuleType) -> set[str]:
    return {name for name, make in vars(module).items() if inspect.isfunction(make) and not name.startswith("_")
            and make.__module__.startswith(module.__name__)}


def test_every_figure_stands_here_and_has_a_caption():
    assert set(FIGURES) == set(words.FIGURES)
    assert of(figures) <= set(FIGURES) and len(of(real_figures)) == 3


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


@pytest.fixture(params=FIGURES, scope="module")
def drawn(request):
    style.use_style()
    figure = FIGURES[request.param]()
    figure.set_label(request.param)
    style.remark(figure, "114 of 154 runs are missing")
    figure.draw_without_rendering()
    yield figure
    plt.close(figure)


def test_a_figure_can_be_printed(drawn):
    """One or two columns wide, no text under 7 points, none cut off at the edge, none over another."""
    assert round(drawn.get_figwidth(), 2) in (style.COLUMN_WIDTH, style.PAGE_WIDTH)
    texts = [text for text in seen_texts(drawn) if text.get_text() != real_figures.SIMULATED_TEXT]
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
    r"[Dd]iamond": lambda figure: lines(figure, marker="D"),
    r"[Qq]uestion marks": lambda figure: lines(figure, marker="$?$"),
    r"seen from above": lambda figure: any(isinstance(mesh, QuadMesh) for ax in figure.axes for mesh in ax.collections)
    or figure.get_label() in ("fig2_overview", "fig8_real_setup"),
    r"interval": lambda figure: any(isinstance(bars, ErrorbarContainer) for ax in figure.axes for bars in ax.containers)
    or figure.get_label() == "statistics",
    r"Rings": lambda figure: any(isinstance(dots, PathCollection) and dots.get_sizes().tolist() == [22]
                                 for ax in figure.axes for dots in ax.collections)
    and figure.get_label() != "fig3_dense",  # whose grasp points lie everywhere
    r"triangles": lambda figure: lines(figure, marker="^") and figure.get_label() != "statistics",  # "one shape a ..."
    r"hollow": lambda figure: [line for line in lines(figure, marker="o") if to_hex(line.get_mfc()) == "#ffffff"],
}


def test_the_caption_names_the_marks_that_are_drawn_and_no_other(drawn):
    text = captions.caption(drawn.get_label()).text
    told = {mark: bool(re.search(mark, text)) for mark in MARKS}
    assert told == {mark: bool(there(drawn)) for mark, there in MARKS.items()}


def test_every_letter_that_the_caption_names_is_a_panel(drawn):
    panels = set(re.findall(r"\\bf\{([a-z])\}", " ".join(ax.get_title(loc="left") for ax in drawn.axes)))
    told = re.findall(r"\(([a-z])(?:, ([a-z])| to ([a-z])| and ([a-z]))?\)", captions.caption(drawn.get_label()).text)
    assert {letter for letters in told for letter in letters if letter} <= panels


def test_what_comes_from_keypoints_says_so():
    for name in ("keypoint_control", "table_keypoint_control", "table2_main", "table_adc", "fig_perception"):
        assert any("keypoints" in text.get_text() for text in seen_texts(FIGURES[name]())), name
    plt.close("all")


def test_everything_that_a_notebook_writes_has_words():
    for path in paths.NOTEBOOKS.glob("*.ipynb"):
        source = "\n".join(cell.source for cell in nbformat.read(path, 4).cells if cell.cell_type == "code")
        for name, figure, content in re.findall(
                r'page\.(?:save_outputs(?:_alone)?|write)\(\s*"(\w+)", (\w+),\s*\{((?:[^{}]|\{[^{}]*\})*)\}', source):
            assert figure == "None" or name in words.FIGURES, name
            for suffix in re.findall(r'"(\w*)":', content):
                assert f"{name}_{suffix}".rstrip("_") in words.TABLES, (name, suffix)


def test_a_caption_is_read_back_as_it_was_written(tmp_path):
    written = captions.caption("fig1_sparse", "From pixels.", "**MOVE** is:\n- ahead")
    (tmp_path / "a.caption.md").write_text(written.markdown())
    assert captions.read(tmp_path / "a.caption.md") == written
    assert written.found == "MOVE is: ahead." and written.alt.endswith(written.found) and "From pixels." in written.text
    assert len(captions.caption("fig1_sparse", "", "Ahead of it. " * 100).alt) < 600
    (tmp_path / "b.caption.md").write_text("nothing")
    with pytest.raises(BadInput, match="allowed is what the figures write"):
        captions.read(tmp_path / "b.caption.md")
    for told in (captions.caption, captions.table_caption):
        with pytest.raises(BadInput, match="words.py"):
            told("fig99")


def test_the_files_of_a_figure_hold_its_title_and_its_alternative_text(tmp_path):
    from PIL import Image

    caption = captions.caption("claims", "", "Six hold.")
    style.save(figures.claims(claimed.numbers()), "claims", tmp_path, caption)
    with Image.open(tmp_path / "claims.png") as picture:
        assert picture.info["Title"] == caption.title and picture.info["Description"] == caption.alt
    assert b"/Title" in (tmp_path / "claims.pdf").read_bytes()
    assert captions.read(tmp_path / "claims.caption.md") == caption


def test_every_shipped_picture_has_its_caption():
    folder = paths.ROOT / "paper_figures"
    assert {path.stem for path in folder.glob("*.png")} == {
        path.name.removesuffix(".caption.md") for path in folder.glob("*.caption.md")}
