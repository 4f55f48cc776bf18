"""Figures of the real robot: counts, scores and places stand where their method and their budget are named."""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from move.figures.plots import real as real_plots
from move.figures.plots import real_figures, style
from move.paper import REAL_RADIUS_M
from move.realworld.trials import comparisons, real_table

COLOUR = {method: style.COLOURS[method].lower() for method in ("static", "move")}


@pytest.fixture
def ax():
    _, axis = plt.subplots()
    yield axis
    plt.close("all")


def titles(figure: plt.Figure) -> list[str]:
    return [ax.get_title(loc="left").split("$   ")[-1] for ax in figure.axes if ax.get_title(loc="left")]


def steps() -> pd.DataFrame:
    """Static goes along y at x = .2 and grasps in its last episode; MOVE goes along x and always grasps."""
    rows = [{"part": "p", "method": "static", "index": index, "step": step, "x_m": 0.2, "y_m": 0.05 * step, "z_m": 0.1,
             "grasped": index == 1 and step > 2} for index in range(2) for step in range(5)]
    rows += [{"part": "p", "method": "move", "index": index, "step": step, "x_m": 0.1 * step, "y_m": -0.1, "z_m": 0.1,
              "grasped": step > 3} for index in range(3) for step in range(5)]
    return pd.DataFrame(rows)


def cells() -> pd.DataFrame:
    return pd.DataFrame([{"method": method, "x_m": 0.2, "y_m": y, "visits": visits}
                         for method, counts in (("static", [4, 0, 0, 0]), ("move", [1, 9, 0, 2]))
                         for y, visits in zip((-0.2, -0.1, 0.1, 0.2), counts, strict=True)])


def test_each_bar_has_its_own_count_over_its_own_interval(ax):
    real_plots.success_cells(real_table(), ax)
    names = [label.get_text() for label in ax.get_xticklabels()]
    assert names == ["static\n35,000", "MOVE\n35,000", "static\n75,000", "MOVE\n75,000"]
    assert [text.get_text() for text in ax.texts] == ["1/30", "7/30", "7/30", "11/30"]
    bars = [(to_hex(bar.get_facecolor()), round(30 * bar.get_height())) for bar in ax.patches]
    assert bars == [(COLOUR["static"], 1), (COLOUR["move"], 7), (COLOUR["static"], 7), (COLOUR["move"], 11)]
    for text, row in zip(ax.texts, real_table().itertuples(), strict=True):
        assert row.low < row.rate < row.high < text.get_position()[1]


def test_a_score_stands_within_what_its_successes_allow(ax):
    table = real_table()
    real_plots.score_cells(table, ax)
    for bar, line, row in zip(ax.patches, ax.get_lines(), table.itertuples(), strict=True):
        assert (bar.get_y(), bar.get_y() + bar.get_height()) == pytest.approx((row.score_low, row.score_high))
        assert line.get_ydata()[0] == row.normalised and row.score_low <= row.normalised <= row.score_high
        assert (to_hex(line.get_color()), line.get_mfc()) == (COLOUR[row.method], "white"), "the paper's"


def test_a_bracket_joins_the_two_methods_of_a_budget_over_their_intervals_and_tells_their_p(ax):
    table, compared = real_table(), comparisons()
    real_plots.brackets(table, compared, ax)
    p = compared.set_index(["first", "second"]).barnard
    assert [text.get_text() for text in ax.texts] == [
        f"p = {p['static 35k', 'move 35k']:.3f}", f"p = {p['static 75k', 'move 75k']:.3f}"]
    for line, places in zip(ax.get_lines(), ([0, 1], [2, 3]), strict=True):
        assert sorted(set(line.get_xdata())) == places
        assert min(line.get_ydata()) > table.high[places].max()


def test_the_half_disc_is_seen_from_above_with_the_arms_left_on_the_left(ax):
    outline = real_plots.half_disc(ax)
    assert (outline.r, outline.theta1, outline.theta2) == (REAL_RADIUS_M, 0, 180)
    left, right = ax.get_xlim()
    assert left > 0 > right, "y grows to the left"
    assert ax.get_ylim()[1] > REAL_RADIUS_M


def test_a_cell_is_as_dark_as_it_was_often_visited_and_lies_at_its_place(ax):
    shades = real_plots.coverage_map(cells().query("method == 'move'"), ax, colour=style.COLOURS["move"])
    squares = {round(square.get_x() + 0.025, 3): to_hex(square.get_facecolor()) for square in ax.patches
               if isinstance(square, Rectangle)}
    assert squares[-0.1] == COLOUR["move"] and squares[0.1] == "#ffffff"
    assert len(set(squares.values())) == 4 and shades.get_clim() == (0, 9)


def test_a_path_ends_in_a_dot_where_it_grasps_and_in_none_where_it_does_not(ax):
    real_plots.paths(steps().query("method == 'static'"), ax, colour=style.COLOURS["static"])
    ways = [line for line in ax.get_lines() if line.get_marker() == "None" and len(line.get_xdata()) > 1]
    assert [len(way.get_xdata()) for way in ways] == [5, 3], "only up to the grasp"
    dots = [(line.get_xdata()[0], line.get_ydata()[0]) for line in ax.get_lines() if line.get_marker() == "o"]
    assert dots == [(pytest.approx(0.1), pytest.approx(0.2))], "across is y, up is x"


def test_speeds_are_a_dot_an_episode_over_their_methods_name_and_number(ax):
    table = pd.DataFrame({"method": ["move", "static", "move"], "mean_speed": [3.0, 1.0, np.nan], "unit": "px"})
    real_plots.speed_dots(table, ax)
    assert [label.get_text() for label in ax.get_xticklabels()] == ["static\nn = 1", "MOVE\nn = 2"]
    drawn = {to_hex(line.get_color()): line.get_ydata().tolist() for line in ax.get_lines()}
    assert drawn == {COLOUR["static"]: [1.0], COLOUR["move"]: [3.0]} and ax.get_ylabel() == "object's speed (px/s)"


def test_the_orange_is_joined_within_an_episode_and_rows_grow_downwards(ax):
    places = pd.DataFrame([{"part": "p", "method": "move", "index": index, "row": 10.0 + step, "column": 20.0 * index,
                            "height": 72, "width": 128} for index in range(2) for step in range(3)])
    real_plots.object_map(places, ax, colour=style.COLOURS["move"])
    assert [line.get_xdata().tolist() for line in ax.get_lines()] == [[0.0] * 3, [20.0] * 3]
    assert ax.get_xlim() == (0, 128) and ax.get_ylim() == (72, 0)


def test_figure_8_counts_each_methods_demonstrations_grasps_and_cells():
    frames = np.zeros((3, 18, 32, 3), np.uint8)
    strips = {"move": (frames, ["0 s", "1 s", "2 s"])}
    toy, figure = (real_figures.setup_figure(cells(), steps(), strips, simulated=simulated)
                   for simulated in (True, False))
    assert [one.get_suptitle() for one in (toy, figure)] == [real_figures.SIMULATED_TEXT, ""]
    assert titles(figure) == [
        "static: 2 demonstrations, 1 grasps", "static: 25 % of cells visited by the hand",
        "MOVE: 3 demonstrations, 3 grasps", "MOVE: 75 % of cells visited by the hand",
        "MOVE: frames of one demonstration"]
    panels = [ax for ax in figure.axes if ax.get_title(loc="left")]
    ways = [{to_hex(line.get_color()) for line in panels[place].get_lines()} for place in (0, 2)]
    assert COLOUR["static"] in ways[0] - ways[1] and COLOUR["move"] in ways[1] - ways[0]
    plt.close("all")


def test_what_is_simulated_is_headed_so_and_nothing_lies_over_the_data():
    places = pd.DataFrame([{"part": "p", "method": method, "index": index, "row": 1.0, "column": 2.0, "height": 72,
                            "width": 128} for method, count in (("static", 2), ("move", 3)) for index in range(count)])
    speeds = pd.DataFrame({"method": ["static", "move"], "mean_speed": [1.0, 2.0], "unit": "px"})
    for simulated in (True, False):
        figure = real_figures.object_figure(places, speeds, simulated=simulated)
        assert titles(figure) == ["static: the orange (n = 2)", "MOVE: the orange (n = 3)", "its speed"]
        assert figure.get_suptitle() == real_figures.SIMULATED_TEXT * simulated
        assert len(figure.texts) == simulated, "the heading alone"
        style.heading(figure, "Not the shipped figure")
        assert figure.get_suptitle().split("\n")[-1] == "Not the shipped figure", "under it, and not in its place"
        assert (real_figures.SIMULATED_TEXT in figure.get_suptitle()) is simulated
        plt.close(figure)
