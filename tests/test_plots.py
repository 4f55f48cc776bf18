"""What the planted world does not see of the plots: markers, names, dots of seeds, what is missing, maps."""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex

from move.figures import plots
from move.figures.plots import maps, style

COLOUR = {"static": "#0072b2", "adc": "#e69f00", "move": "#d55e00"}  # Okabe and Ito: blue, orange, vermillion
NAME = {"static": "static", "adc": "ADC", "move": "MOVE"}
VALUE = {"static": 0.2, "adc": 0.5, "move": 0.8}
MARKER = {"static": "o", "adc": "s", "move": "^"}
METHODS = list(VALUE)


@pytest.fixture(autouse=True)
def few_figures():
    yield
    plt.close("all")


def rows(**columns) -> pd.DataFrame:
    """One row a method, with its own value."""
    return pd.DataFrame([{"method": method, "value": value, "low": value - 0.1, "high": value + 0.1, "paper": value / 2,
                          "seeds": [value], **columns} for method, value in VALUE.items()])


def draw(plot, *arguments) -> plt.Axes:
    _, ax = plt.subplots()
    plot(*arguments, ax)
    return ax


def many(column: str, values) -> pd.DataFrame:
    return pd.concat([rows(**{column: value}) for value in values])


DRAWN = {  # plots of points, with every method
    "covered": lambda: draw(plots.covered, rows().assign(task="push", moves="all", joint=[0.2, 0.4, 0.9]), "joint"),
    "curve": lambda: draw(lambda table, ax: plots.curve(table, "timesteps", "timesteps", ax, log=True),
                          many("timesteps", (100, 200))),
    "task_rates": lambda: draw(plots.task_rates, rows(task="push"), pd.DataFrame()),
    "own_and_elsewhere": lambda: draw(plots.own_and_elsewhere, rows(group="random")),
}


@pytest.mark.parametrize("name", DRAWN)
def test_each_method_has_its_marker_in_every_plot_of_points(name):
    drawn = {(to_hex(line.get_color()), line.get_marker()) for line in DRAWN[name]().get_lines()
             if line.get_marker() in ("o", "s", "^", "v") and len(line.get_xdata())}
    assert drawn == {(COLOUR[method], marker) for method, marker in MARKER.items()}
    told = {handle.get_label(): handle.get_marker() for handle in plots.entries(METHODS)}
    assert told == {NAME[method]: marker for method, marker in MARKER.items()}


def test_a_point_whose_interval_is_pooled_is_open_and_the_legend_says_so():
    table = rows().assign(trainings=["moderated", "like cells", "moderated"])
    drawn = draw(plots.task_rates, table.assign(task="push"), pd.DataFrame())
    hollow = {(to_hex(line.get_color()), y) for line in drawn.get_lines()
              if line.get_marker() in MARKER.values() and to_hex(line.get_mfc()) == "#ffffff"
              for y in line.get_ydata() if np.isfinite(y)}
    assert hollow == {(COLOUR["adc"], VALUE["adc"])}
    (entry,) = plots.pooled_entry(table)
    assert entry.get_label().startswith("open: one seed") and to_hex(entry.get_mfc()) == "#ffffff"
    assert plots.pooled_entry(rows()) == [] == plots.pooled_entry(rows().assign(trainings="moderated"))


def test_a_curve_may_show_a_dot_a_seed():
    table = many("timesteps", (100, 200)).query("method == 'move'").assign(seeds=[[0.7, 0.9], [0.8, 0.6]])
    ax = draw(lambda rows, ax: plots.curve(rows, "timesteps", "timesteps", ax, dots=True), table)
    dots = [one.get_offsets() for one in ax.collections if isinstance(one, PathCollection)]
    assert [one[:, 1].tolist() for one in dots] == [[0.7, 0.9], [0.8, 0.6]]
    assert [one[0, 0] for one in dots] == pytest.approx([100, 200], abs=3)


def test_every_bar_has_a_dot_a_seed():
    table = rows(where="here").assign(seeds=[[0.1, 0.3], [0.5], [0.7, 0.8, 0.9]])
    for ax in (draw(plots.grouped_rates, table, "where", ["here"]),
               draw(plots.ladder, table.assign(moves=METHODS), "moves")):
        dots = [dots for dots in ax.collections if isinstance(dots, PathCollection)]
        assert [[place[1] for place in one.get_offsets()] for one in dots] == table.seeds.tolist()


@pytest.mark.parametrize("inside", [rows(where="inside").iloc[:1],
                                    rows(where="inside").assign(value=[0.2, np.nan, 0.8])])
def test_grouped_rates_name_each_bar_by_its_method_also_where_the_first_group_lacks_it_and_the_paper_once(inside):
    ax = draw(plots.grouped_rates, pd.concat([inside, rows(where="outside")]), "where", ["inside", "outside"])
    handles, labels = ax.get_legend_handles_labels()
    named = {label: to_hex(handle[0].get_facecolor()) for handle, label in zip(handles, labels, strict=True)
             if label != "paper"}
    assert named == {NAME[name]: COLOUR[name] for name in METHODS} and labels.count("paper") == 1


def test_what_is_missing_says_so():
    table = rows(where="here").assign(value=[0.2, np.nan, 0.8])
    for ax in (draw(plots.grouped_rates, table, "where", ["here"]),
               draw(plots.ladder, table.assign(moves=METHODS), "moves")):
        assert [text.get_text() for text in ax.texts] == ["missing"] and len(ax.patches) == 2
        assert ax.get_xlim()[0] < ax.texts[0].xy[0] < ax.get_xlim()[1]
    ax = draw(lambda rows, ax: plots.curve(rows, "timesteps", "timesteps", ax, log=True),
              pd.concat([table.assign(timesteps=100), table.assign(timesteps=200, value=0.5, low=0.1, high=1.0)]))
    asked = [(to_hex(line.get_color()), line.get_xdata().tolist()) for line in ax.get_lines()
             if line.get_marker() == "$?$" and len(line.get_xdata())]
    assert asked == [(COLOUR["adc"], [100])]


def test_differences_are_drawn_in_no_methods_colour_and_name_what_they_are():
    table = pd.DataFrame([{"task": "push", "baseline": other, "difference": value, "low": value - 0.1,
                           "high": value + 0.1, "paper": 0.4} for other, value in (("static", 0.6), ("adc", 0.3))])
    ax = draw(plots.differences, table, "task", ["Push"])
    drawn = {container.get_label(): (to_hex(container[0].get_color()), container[0].get_xdata()[0])
             for container in ax.containers}
    assert {label: value for label, (_, value) in drawn.items()} == {"MOVE − static": 0.6, "MOVE − ADC": 0.3}
    assert not {colour for colour, _ in drawn.values()} & {colour.lower() for name, colour in style.COLOURS.items()
                                                            if name in ("static", "adc", "move", "mixture")}
    assert ax.get_xlabel() == "difference of success (points)"
    assert ax.xaxis.get_major_formatter()(-0.05, 0) == "−5" and ax.xaxis.get_major_formatter()(0.05, 0) == "+5"


def test_ticks_have_short_names_and_none_where_they_would_touch():
    ax = draw(lambda ticks, ax: plots.log_ticks(ticks, ax), [5000, 10_000, 40_000, 50_000])
    assert [label.get_text() for label in ax.get_xticklabels()] == ["5k", "10k", "40k", ""]
    ax = draw(lambda rows, ax: plots.curve(rows, "length", "gradient steps", ax), many("length", (0.333, 1.0, 3.0)))
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.33", "1", "3"]


def test_the_papers_points_are_hollow_diamonds_at_their_own_budget():
    ax = draw(plots.printed_points, rows(timesteps=20_000))
    assert [(line.get_marker(), line.get_mfc(), line.get_xdata()) for line in ax.get_lines()] == [
        ("D", "none", [20_000])] * 3
    assert [handle.get_label() for handle in plots.entries(["move", "static"], "paper", missing=True)] == [
        "static", "MOVE", "paper", "missing"]
    ax = DRAWN["task_rates"]()
    place = [label.get_text() for label in ax.get_xticklabels()].index("Push")
    theirs = {to_hex(line.get_color()): line.get_xdata()[place] for line in ax.get_lines()
              if line.get_marker() == "D" and len(line.get_xdata())}
    ours = {to_hex(container[0].get_color()): container[0].get_xdata()[place] for container in ax.containers}
    assert set(ours) == set(theirs) and all(theirs[one] > ours[one] for one in ours), "beside the point, not under it"


def test_an_efficiency_that_static_does_not_reach_is_hollow_and_points_on():
    table = pd.DataFrame([{"task": "push", "ratio": 1.5, "low": 1.2, "high": 1.8, "most": 2.0},
                          {"task": "hammer", "ratio": np.inf, "low": 1.0, "high": np.inf, "most": 2.0},
                          {"task": "assembly", "ratio": np.nan, "low": np.nan, "high": np.nan, "most": np.nan}])
    ax = draw(plots.efficiencies, table)
    known, unknown = (container[0] for container in ax.containers)
    assert (known.get_xdata()[0], known.get_markerfacecolor()) == (1.5, "black")
    assert (unknown.get_xdata()[0], unknown.get_markerfacecolor()) == (2.0, "white")
    assert [line.get_ydata()[0] for line in ax.get_lines() if line.get_marker() == ">"] == [1]
    assert [(text.get_text(), text.xy[1]) for text in ax.texts] == [("missing", 2)]


def test_a_ladder_tells_what_moves_alone_by_a_lighter_bar():
    table = rows().iloc[[0, 2, 2]].assign(moves=["nothing", "object + target", "camera alone"])
    ax = draw(plots.ladder, table, "moves")
    assert [bar.get_alpha() for bar in ax.patches] == [0.85, 0.85, 0.45]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["nothing", "object\n+ target", "camera\nalone"]


def test_costs_are_means_of_fixed_tasks_with_the_errors_of_each():
    table = pd.DataFrame([{"task": task, "method": "static", "expert": "phase", "mean_steps": 100.0 * task,
                           "mean_steps_error": error} for task, error in enumerate((3.0, 4.0, 12.0))])
    ax = draw(plots.costs, table, "mean_steps", {"static": 33.0})
    low, high = ax.containers[1][2][0].get_segments()[0][:, 1]
    assert (low, high) == pytest.approx((100 - 1.96 * 13 / 3, 100 + 1.96 * 13 / 3))


@pytest.mark.parametrize("shares, expected", [((0.99, 1.0), [0.995 - 1.96 * 0.02 / 2**0.5, 1.0]),
                                              ((0.0, 0.01), [0.0, 0.005 + 1.96 * 0.02 / 2**0.5])])
def test_no_interval_of_a_share_leaves_0_and_1(shares, expected):
    table = pd.DataFrame([{"task": task, "method": "move", "expert": "phase", "rate": share, "rate_error": 0.02}
                          for task, share in enumerate(shares)])
    ends = draw(lambda rows, ax: plots.costs(rows, "rate", {}, ax, share=True), table).containers[1][2][0]
    assert ends.get_segments()[0][:, 1].tolist() == pytest.approx(expected)


def grid(seeds: int = 5) -> pd.DataFrame:
    """Cell k of a row of cells succeeds with k seeds; one grasp point that every seed grasps."""
    cells = [{"group": "grid", "object_x": 0.1 * cell, "object_y": y, "seed": seed, "success": seed < cell}
             for cell in range(seeds + 1) for y in (0.0, 0.1) for seed in range(seeds)]
    points = [{"group": "point", "object_x": 0.05, "object_y": 0.0, "seed": seed, "success": True}
              for seed in range(seeds)]
    return pd.DataFrame(cells + points)


def test_a_map_has_one_colour_a_number_of_seeds_and_a_ring_that_shows_on_it():
    figure, ax = plt.subplots()
    mesh = maps.heatmap(grid(), ax)
    colours = [to_hex(mesh.cmap(mesh.norm(count / 5))) for count in range(6)]
    assert len(set(colours)) == 6 == mesh.cmap.N
    assert to_hex(mesh.cmap(mesh.norm(0.45))) in colours, "nothing between"
    halo, ring = (dots for dots in ax.collections if dots is not mesh)
    assert to_hex(halo.get_facecolor()[0]) == "#ffffff" and to_hex(ring.get_edgecolor()[0]) == "#000000"
    assert halo.get_sizes()[0] > ring.get_sizes()[0] and not ring.get_clip_on()
    assert to_hex(mesh.cmap(mesh.norm(ring.get_array()[0]))) == colours[5]
    maps.seeds_bar(mesh, [ax], 5)
    assert [tick.get_text() for tick in figure.axes[1].get_yticklabels()] == list("012345")


def test_a_map_of_the_difference_is_in_the_colour_of_the_method_that_is_ahead():
    both = pd.concat([grid(2).assign(method="static"), grid(2).assign(method="move")])
    both.loc[(both.method == "move") & (both.object_x == 0.0) & (both.group == "grid"), "success"] = True
    both.loc[(both.method == "move") & (both.object_x == 0.2) & (both.group == "grid"), "success"] = False
    figure, ax = plt.subplots()
    mesh = maps.difference(both, ax)
    values = np.asarray(mesh.get_array()).reshape(2, 3)
    assert values.tolist() == [[1, 0, -1]] * 2, "columns are x, MOVE minus static"
    assert [to_hex(mesh.cmap(mesh.norm(value))) for value in (1, -1)] == [COLOUR["move"], COLOUR["static"]]
    assert len({to_hex(mesh.cmap(mesh.norm(count / 2))) for count in range(-2, 3)}) == 5 == mesh.cmap.N
    maps.seeds_bar(mesh, [ax], 2, -2, "more")
    assert [tick.get_text() for tick in figure.axes[1].get_yticklabels()] == ["\u22122", "\u22121", "0", "+1", "+2"]


def test_frames_stand_apart_with_their_labels():
    frames = np.zeros((3, 60, 60, 3), np.uint8)
    ax = draw(maps.strip, frames, ["0", "10", "20"])
    row = ax.get_images()[0].get_array()
    white = (np.asarray(row)[0, :, 0] == 255)
    assert row.shape == (60, 3 * 60 + 2 * 2, 3) and white.sum() == 4 and not white[:60].any()
    assert [text.get_text() for text in ax.texts] == ["0", "10", "20"]


@pytest.mark.parametrize("width", [style.COLUMN_WIDTH, style.PAGE_WIDTH])
@pytest.mark.parametrize("legend", [True, False])
def test_a_heading_stands_over_the_figure_and_over_nothing_else(width, legend):
    style.use_style()
    figure, ax = plt.subplots(figsize=(width, 2.3))
    ax.plot([0, 1], [0, 1], label="static")
    ax.set(xticks=[0, 1], yticks=[0, 1])
    ax.set_title("a panel", loc="left")
    if legend:
        figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center")
    style.heading(figure, "Not the shipped figure: steps_allowed 60, 80, 100, 150, 500 (60, 80, 100, 150, 200)")
    style.settle(figure)
    figure.draw_without_rendering()
    names = [text for text in figure.findobj(plt.Text) if text.get_text().strip() and text.get_visible()]
    boxes = [text.get_window_extent() for text in names]
    over, = (box for text, box in zip(names, boxes, strict=True) if text.get_text().startswith("Not the"))
    assert over.x0 >= 0 and over.x1 <= figure.bbox.width and over.y1 <= figure.bbox.height
    assert sum(over.overlaps(box) for box in boxes) == 1  # itself
    plt.close(figure)
