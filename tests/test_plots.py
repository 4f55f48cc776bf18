"""Every plot draws each method in its own colour, under its own name, at the numbers it was given."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402

from move.report import plots  # noqa: E402

COLOUR = {"static": "#0072b2", "adc": "#e69f00", "move": "#d55e00"}  # Okabe and Ito: blue, orange, vermillion
NAME = {"static": "static", "adc": "ADC", "move": "MOVE"}
VALUE = {"static": 0.2, "adc": 0.5, "move": 0.8}
METHODS = list(VALUE)


def rows(**columns) -> pd.DataFrame:
    """One row a method, with its own value."""
    return pd.DataFrame([{"method": method, "value": value, "low": value - 0.1, "high": value + 0.1, "paper": value / 2,
                          "seeds": [value], **columns} for method, value in VALUE.items()])


def draw(plot, *arguments) -> plt.Axes:
    _, ax = plt.subplots()
    plot(*arguments, ax)
    return ax


def labelled(ax: plt.Axes) -> dict[str, tuple[str, float]]:
    """Label -> colour and height of what the legend shows under it."""
    found = {}
    for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
        mark = handle[0]
        height = mark.get_height() if hasattr(mark, "get_height") else mark.get_ydata()[0]
        colour = mark.get_facecolor() if hasattr(mark, "get_facecolor") else mark.get_color()
        found[label] = (to_hex(colour), float(height))
    return found


def test_rates_are_bars_in_the_methods_colours_over_their_names():
    ax = draw(plots.rates, rows())
    assert [(to_hex(bar.get_facecolor()), bar.get_height()) for bar in ax.patches] == [
        (COLOUR[name], VALUE[name]) for name in METHODS]
    assert [label.get_text() for label in ax.get_xticklabels()] == [NAME[name] for name in METHODS]
    dotted = [line.get_ydata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"]
    assert dotted == [value / 2 for value in VALUE.values()]


def test_grouped_rates_name_each_bar_by_its_method():
    ax = draw(plots.grouped_rates, rows(where="here"), "where", ["here"])
    assert labelled(ax) == {NAME[name]: (COLOUR[name], VALUE[name]) for name in METHODS}


def test_gaps_are_drawn_in_the_colour_and_under_the_name_of_the_other_method():
    table = pd.DataFrame([{"task": "push", "than": other, "gap": gap, "low": gap - 0.1, "high": gap + 0.1, "paper": 0.4}
                          for other, gap in (("static", 0.6), ("adc", 0.3))])
    ax = draw(plots.gaps, table, "task", ["Push"])
    drawn = {container.get_label(): (to_hex(container[0].get_color()), container[0].get_xdata()[0])
             for container in ax.containers}
    assert drawn == {"MOVE - static": (COLOUR["static"], 0.6), "MOVE - ADC": (COLOUR["adc"], 0.3)}


def test_scaling_draws_each_methods_line_through_its_points():
    table = pd.concat([rows(timesteps=timesteps) for timesteps in (100, 200)])
    ax = draw(plots.scaling, table)
    for line in ax.get_lines():
        (method,) = (name for name in METHODS if NAME[name] == line.get_label())
        assert to_hex(line.get_color()) == COLOUR[method] and set(line.get_ydata()) == {VALUE[method]}
    assert len(ax.get_lines()) == len(ax.collections) == 3


@pytest.mark.parametrize("log", [False, True])
def test_a_curve_draws_each_method_at_its_rates(log):
    table = pd.concat([rows(length=length) for length in (0.333, 1.0, 3.0)])
    ax = draw(lambda rows, ax: plots.curve(rows, "length", "gradient steps", ax, log), table[table.method != "adc"])
    drawn = {container.get_label(): (to_hex(container[0].get_color()), set(container[0].get_ydata()))
             for container in ax.containers}
    assert drawn == {NAME[name]: (COLOUR[name], {VALUE[name]}) for name in ("static", "move")}
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.33", "1", "3"]


def test_the_papers_points_are_crosses_in_the_methods_colours():
    ax = draw(plots.printed_points, rows(timesteps=20_000))
    assert [(to_hex(line.get_color()), line.get_ydata()[0], line.get_label()) for line in ax.get_lines()] == [
        (COLOUR[name], VALUE[name], f"{NAME[name]}, paper") for name in METHODS]


def test_an_efficiency_that_static_does_not_reach_is_hollow_and_points_on():
    table = pd.DataFrame([{"task": "push", "ratio": 1.5, "low": 1.2, "high": 1.8, "most": 2.0},
                          {"task": "hammer", "ratio": np.inf, "low": 1.0, "high": np.inf, "most": 2.0}])
    ax = draw(plots.efficiencies, table)
    known, unknown = (container[0] for container in ax.containers)
    assert (known.get_xdata()[0], known.get_markerfacecolor()) == (1.5, "black")
    assert (unknown.get_xdata()[0], unknown.get_markerfacecolor()) == (2.0, "white")
    assert [line.get_ydata()[0] for line in ax.get_lines() if line.get_marker() == ">"] == [1]


def test_a_ladder_has_a_bar_in_the_methods_colour_for_everything_that_moves():
    table = rows().iloc[[0, 2]].assign(moves=["nothing", "object + target"])
    ax = draw(lambda rows, ax: plots.ladder(rows, "moves", ax), table)
    assert [(to_hex(bar.get_facecolor()), bar.get_height()) for bar in ax.patches] == [
        (COLOUR["static"], VALUE["static"]), (COLOUR["move"], VALUE["move"])]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["nothing", "object\n+ target"]


def test_the_readings_of_one_method_have_colours_that_no_method_has():
    table = pd.concat([rows(task="push", jumping=name).query("method == 'adc'") for name in plots.READINGS])
    ax = draw(plots.readings, table, "jumping")
    drawn = {container.get_label(): to_hex(container[0].get_color()) for container in ax.containers}
    assert drawn == {name: colour.lower() for name, colour in plots.READINGS.items()}
    assert not set(drawn.values()) & set(COLOUR.values())
    assert all(container[0].get_ydata()[0] == VALUE["adc"] for container in ax.containers)


def test_task_rates_stand_under_their_tasks_between_floor_and_ceiling():
    controls = pd.DataFrame({"expert": [1.0], "goal-blind": [0.3]}, index=["push"])
    ax = draw(plots.task_rates, rows(task="push"), controls)
    place = [label.get_text() for label in ax.get_xticklabels()].index("Push")
    drawn = {container.get_label(): (to_hex(container[0].get_color()), container[0].get_ydata()[place])
             for container in ax.containers}
    assert drawn == {NAME[name]: (COLOUR[name], VALUE[name]) for name in METHODS}
    levels = {lines.get_label(): lines.get_segments()[place][0][1] for lines in ax.collections
              if not lines.get_label().startswith("_")}
    assert levels == {"expert": 1.0, "goal-blind expert": 0.3}


def test_a_rate_at_its_own_grasps_is_hollow_one_elsewhere_filled_and_one_in_motion_a_triangle():
    table = pd.concat([rows(task="push", group=group).assign(value=lambda seen, part=part: seen.value * part)
                       for group, part in (("grasp", 1), ("random", 0.5), ("moving", 0.25))]).assign(low=0.0)
    ax = draw(plots.own_and_elsewhere, table)
    looks = {"at its own grasps": (1, "o", "#ffffff"), "elsewhere": (0.5, "o", None),
             "elsewhere, in motion": (0.25, "^", None)}
    for container in ax.containers:
        mark = container[0]
        name, where = container.get_label().split(", ", 1)
        (method,) = (key for key in METHODS if NAME[key] == name)
        part, shape, filling = looks[where]
        assert to_hex(mark.get_color()) == COLOUR[method] and mark.get_marker() == shape
        assert mark.get_ydata()[0] == pytest.approx(VALUE[method] * part)
        assert to_hex(mark.get_markerfacecolor()) == (filling or COLOUR[method])
    assert len(ax.containers) == 9


def test_changes_stand_at_their_rates_beside_their_names():
    table = pd.DataFrame([{"change": name, "value": value, "low": value - 0.1, "high": value + 0.1,
                           "train_minutes": 2.0} for name, value in (("chosen", 0.9), ("32 channels", 0.7))])
    ax = draw(plots.changes, table)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["chosen, 2.0 min", "32 channels, 2.0 min"]
    assert [(container[0].get_xdata()[0], container[0].get_ydata()[0]) for container in ax.containers] == [
        (0.9, 0), (0.7, 1)]


def test_costs_are_means_over_tasks_in_the_methods_colours_with_students_interval():
    table = pd.DataFrame([{"task": task, "method": method, "expert": expert, "mean_steps": 100 * VALUE[method] + task}
                          for method in METHODS for expert in ("phase", "metaworld") for task in (-1, 0, 1)])
    ax = draw(plots.costs, table, "mean_steps", {"static": 33.0})
    drawn = [(to_hex(bar.get_facecolor()), bar.get_height()) for bar in ax.patches]
    assert drawn == [(COLOUR[name], pytest.approx(100 * VALUE[name])) for name in METHODS for _ in range(2)]
    low, high = ax.containers[1][2][0].get_segments()[0][:, 1]
    assert (high - low) / 2 == pytest.approx(4.303 / np.sqrt(3), abs=1e-3)  # t of 2 degrees of freedom, deviation 1
    assert [label.get_text() for label in ax.get_xticklabels()] == [NAME[name] for name in METHODS]


@pytest.mark.parametrize("method", METHODS)
def test_coverage_is_drawn_where_the_object_was(method):
    seen = pd.DataFrame({"method": method, "object_x": [0.1, 0.2], "object_y": [0.6, 0.7]})
    ax = draw(plots.coverage, seen, "object", (0.0, 0.5, 0.0), (0.3, 0.8, 0.0))
    (dots,) = ax.get_lines()
    assert to_hex(dots.get_color()) == COLOUR[method] and dots.get_xdata() == pytest.approx([10, 20])


def test_every_plot_of_methods_stands_in_this_file():
    """What is left out draws no method: heat maps, dots, outlines, levels and frames."""
    public = {name for name, plot in vars(plots).items()
              if getattr(plot, "__module__", "") == plots.__name__ and not name.startswith("_")}
    assert public == {"rates", "grouped_rates", "gaps", "scaling", "task_rates", "own_and_elsewhere", "changes",
                      "costs", "coverage", "curve", "readings", "printed_points", "ladder"} | {
                          "heatmap", "grasps", "circle", "level", "picture", "coverages",
                          "efficiencies", "verdicts"}
