"""Every plot draws each method in its own colour, under its own name, at the numbers it was given."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
import pytest  # noqa: E402
from matplotlib.collections import PathCollection  # noqa: E402
from matplotlib.colors import to_hex  # noqa: E402

from move.figures import plots  # noqa: E402
from move.figures.plots import maps, style  # noqa: E402

COLOUR = {"static": "#0072b2", "adc": "#e69f00", "move": "#d55e00"}  # Okabe and Ito: blue, orange, vermillion
NAME = {"static": "static", "adc": "ADC", "move": "MOVE"}
VALUE = {"static": 0.2, "adc": 0.5, "move": 0.8}
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


COSTS = pd.DataFrame([{"task": task, "method": method, "expert": expert, "mean_steps": VALUE[method] + task / 100}
                      for method in METHODS for expert in ("phase", "metaworld") for task in (-1, 0, 1)])
DRAWN = {  # plot -> how it is drawn with every method
    "rates": lambda: draw(plots.rates, rows()),
    "grouped_rates": lambda: draw(plots.grouped_rates, rows(where="here"), "where", ["here"]),
    "covered": lambda: draw(plots.covered, rows().assign(task="push", moves="all", joint=[0.2, 0.4, 0.9]), "joint"),
    "ladder": lambda: draw(plots.ladder, rows().assign(moves=METHODS), "moves"),
    "curve": lambda: draw(lambda table, ax: plots.curve(table, "timesteps", "timesteps", ax, log=True),
                          many("timesteps", (100, 200))),
    "printed_points": lambda: draw(plots.printed_points, rows(timesteps=20_000)),
    "task_rates": lambda: draw(plots.task_rates, rows(task="push"), pd.DataFrame()),
    "own_and_elsewhere": lambda: draw(plots.own_and_elsewhere, rows(task="push", group="random")),
    "costs": lambda: draw(plots.costs, COSTS, "mean_steps", {}),
}


def marks(ax: plt.Axes) -> dict[str, set[float]]:
    """Colour -> heights of the bars and of the points of that colour, hollow ones left out."""
    found: dict[str, set[float]] = {}
    for bar in ax.patches:
        found.setdefault(to_hex(bar.get_facecolor()), set()).add(round(float(bar.get_height()), 6))
    for line in ax.get_lines():
        heights = {round(float(value), 6) for value in line.get_ydata() if np.isfinite(value)}
        if line.get_marker() in ("o", "^", "D") and heights:
            found.setdefault(to_hex(line.get_color()), set()).update(heights)
    return found


@pytest.mark.parametrize("name", DRAWN)
def test_each_method_has_its_colour_at_its_number_in_every_plot(name):
    drawn = marks(DRAWN[name]())
    for method, colour in COLOUR.items():
        assert VALUE[method] in drawn[colour], method
    assert set(drawn) <= {*COLOUR.values(), "#444444"}, "and no other colour but the dots of single tasks"


def test_every_plot_of_methods_stands_in_this_file():
    """What is left out draws no method, or is a part of what draws one; a reference has a test of its own."""
    public = {name for name, plot in vars(plots).items()
              if getattr(plot, "__module__", "").startswith(plots.__name__) and not name.startswith("_")}
    assert public == {*DRAWN} | {"differences", "changes", "gains", "readings", "level", "coverages", "half_widths",
                                 "efficiencies", "forest", "forest_entries", "entries", "cost_entries",
                                 "own_and_elsewhere_entries", "share_interval", "log_ticks", "points_axis", "short",
                                 "reference",
                                 "reference_entry"}


@pytest.mark.parametrize("method", METHODS)
def test_a_reference_is_a_dashed_line_in_its_methods_colour_in_a_band_that_is_its_interval(method):
    rate = next(row for row in rows().itertuples() if row.method == method)
    ax = draw(plots.reference, rate)
    (line,), (band,), entry = ax.get_lines(), ax.patches, plots.reference_entry(method)
    assert list(line.get_ydata()) == [VALUE[method]] * 2 and line.get_linestyle() == entry.get_linestyle() == "--"
    assert (band.get_y(), band.get_height()) == pytest.approx((VALUE[method] - 0.1, 0.2))
    assert {to_hex(line.get_color()), to_hex(band.get_facecolor()), to_hex(entry.get_color())} == {COLOUR[method]}
    assert entry.get_label() == NAME[method]


def test_rates_stand_over_their_names_with_the_papers_value_dotted_and_named_once():
    ax = draw(plots.rates, rows())
    assert [label.get_text() for label in ax.get_xticklabels()] == [NAME[name] for name in METHODS]
    dotted = [line.get_ydata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"]
    assert dotted == [value / 2 for value in VALUE.values()]
    assert ax.get_legend_handles_labels()[1] == ["paper"]


def test_every_bar_has_a_dot_a_seed():
    table = rows(where="here").assign(seeds=[[0.1, 0.3], [0.5], [0.7, 0.8, 0.9]])
    for ax in (draw(plots.grouped_rates, table, "where", ["here"]), draw(plots.rates, table),
               draw(plots.ladder, table.assign(moves=METHODS), "moves")):
        dots = [dots for dots in ax.collections if isinstance(dots, PathCollection)]
        assert [[place[1] for place in one.get_offsets()] for one in dots] == table.seeds.tolist()


def test_grouped_rates_name_each_bar_by_its_method_also_where_the_first_group_lacks_it():
    table = pd.concat([rows(where="inside").iloc[:1], rows(where="outside")])
    handles, labels = draw(plots.grouped_rates, table, "where", ["inside", "outside"]).get_legend_handles_labels()
    named = {label: to_hex(handle[0].get_facecolor()) for handle, label in zip(handles, labels, strict=True)
             if label != "paper"}
    assert named == {NAME[name]: COLOUR[name] for name in METHODS}


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


@pytest.mark.parametrize("log", [False, True])
def test_a_curve_draws_each_method_at_its_rates(log):
    table = many("length", (0.333, 1.0, 3.0))
    ax = draw(lambda rows, ax: plots.curve(rows, "length", "gradient steps", ax, log), table[table.method != "adc"])
    drawn = {container.get_label(): (to_hex(container[0].get_color()), set(container[0].get_ydata()))
             for container in ax.containers}
    assert drawn == {NAME[name]: (COLOUR[name], {VALUE[name]}) for name in ("static", "move")}
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.33", "1", "3"]


def test_ticks_that_would_touch_have_no_name():
    ax = draw(lambda ticks, ax: plots.log_ticks(ticks, ax), [5000, 10_000, 40_000, 50_000])
    assert [label.get_text() for label in ax.get_xticklabels()] == ["5k", "10k", "40k", ""]


def test_the_papers_points_are_hollow_diamonds():
    ax = draw(plots.printed_points, rows(timesteps=20_000))
    assert [(line.get_marker(), to_hex(line.get_mfc())) for line in ax.get_lines()] == [("D", "#ffffff")] * 3
    assert [handle.get_label() for handle in plots.entries(["move", "static"], "paper", missing=True)] == [
        "static", "MOVE", "paper", "missing"]


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


def test_the_readings_of_one_method_have_colours_that_no_method_has():
    table = pd.concat([rows(task="push", jumping=name).query("method == 'adc'") for name in plots.READINGS])
    ax = draw(plots.readings, table, "jumping")
    drawn = {container.get_label(): to_hex(container[0].get_color()) for container in ax.containers}
    assert drawn == {name: colour.lower() for name, colour in plots.READINGS.items()}
    assert not set(drawn.values()) & set(COLOUR.values())
    assert all(container[0].get_ydata()[0] == VALUE["adc"] for container in ax.containers)


def test_task_rates_stand_under_their_tasks_between_floor_and_ceiling_with_the_papers_in_each_methods_colour():
    controls = pd.DataFrame({"expert": [1.0], "goal-blind": [0.3]}, index=["push"])
    ax = draw(plots.task_rates, rows(task="push"), controls)
    place = [label.get_text() for label in ax.get_xticklabels()].index("Push")
    drawn = {container.get_label(): (to_hex(container[0].get_color()), container[0].get_ydata()[place])
             for container in ax.containers}
    assert drawn == {NAME[name]: (COLOUR[name], VALUE[name]) for name in METHODS}
    levels = {lines.get_label(): lines.get_segments()[place][0][1] for lines in ax.collections
              if not lines.get_label().startswith("_")}
    assert levels == {"expert": 1.0, "goal-blind expert": 0.3}
    theirs = {to_hex(line.get_color()): (line.get_ydata()[place], line.get_xdata()[place]) for line in ax.get_lines()
              if line.get_marker() == "D" and len(line.get_xdata())}
    assert {colour: height for colour, (height, _) in theirs.items()} == {
        COLOUR[name]: VALUE[name] / 2 for name in METHODS}
    ours = {to_hex(container[0].get_color()): container[0].get_xdata()[place] for container in ax.containers}
    assert all(theirs[colour][1] > ours[colour] for colour in ours), "beside the point, not under it"


def test_a_rate_at_its_own_grasps_is_hollow_one_elsewhere_filled_and_one_in_motion_a_triangle():
    table = pd.concat([rows(task="push", group=group).assign(value=lambda seen, part=part: seen.value * part)
                       for group, part in (("grasp", 1), ("random", 0.5), ("moving", 0.25))]).assign(low=0.0)
    drawn = [container[0] for container in draw(plots.own_and_elsewhere, table).containers]
    expected = {(COLOUR[name], marker, filling or COLOUR[name], round(VALUE[name] * part, 6))
                for name in METHODS for (marker, filling), part in zip(
                    (("o", "#ffffff"), ("o", None), ("^", None)), (1, 0.5, 0.25), strict=True)}
    assert {(to_hex(mark.get_color()), mark.get_marker(), to_hex(mark.get_mfc()), round(mark.get_ydata()[0], 6))
            for mark in drawn} == expected and len(drawn) == 9
    entries = plots.own_and_elsewhere_entries(table)
    assert [entry.get_label() for entry in entries[:3]] == [NAME[name] for name in METHODS]
    told = {entry.get_label(): (entry.get_marker(), to_hex(entry.get_mfc()).replace("#444444", "") or None)
            for entry in entries[3:]}
    assert told == {"at its own grasps": ("o", "#ffffff"), "elsewhere": ("o", None),
                    "elsewhere, in motion": ("^", None)}


def test_changes_and_gains_stand_at_their_numbers_beside_their_names_and_minutes():
    table = pd.DataFrame([{"change": name, "value": value, "low": value - 0.1, "high": value + 0.1, "gain": value - 0.9,
                           "gain_low": value - 1, "gain_high": value - 0.8, "train_minutes": 2.0}
                          for name, value in (("chosen", 0.9), ("32 channels", 0.7))])
    success, gain = draw(plots.changes, table), draw(plots.gains, table)
    assert [label.get_text() for label in success.get_yticklabels()] == ["chosen", "32 channels"]
    assert [(container[0].get_xdata()[0], container[0].get_ydata()[0]) for container in success.containers] == [
        (0.9, 0), (0.7, 1)]
    assert [container[0].get_xdata()[0] for container in gain.containers] == [0.0, pytest.approx(-0.2)]
    assert [text.get_text() for text in gain.texts] == ["2.0 min", "2.0 min"]


def test_costs_are_means_over_tasks_with_students_interval():
    table = COSTS.assign(mean_steps=100 * COSTS.mean_steps)
    ax = draw(plots.costs, table, "mean_steps", {"static": 33.0})
    drawn = [(to_hex(bar.get_facecolor()), bar.get_height()) for bar in ax.patches]
    assert drawn == [(COLOUR[name], pytest.approx(100 * VALUE[name])) for name in METHODS for _ in range(2)]
    low, high = ax.containers[1][2][0].get_segments()[0][:, 1]
    assert (high - low) / 2 == pytest.approx(4.303 / np.sqrt(3), abs=1e-3)  # t of 2 degrees of freedom, deviation 1
    assert [label.get_text() for label in ax.get_xticklabels()] == [NAME[name] for name in METHODS]


def test_no_interval_of_a_share_leaves_0_and_1():
    shares = pd.Series([0.27, 0.7, 1.0, 1.0, 1.0])
    low, high = plots.share_interval(shares)
    assert 0 < low < shares.mean() < high <= 1
    table = pd.DataFrame([{"task": task, "method": "move", "expert": "phase", "rate": share}
                          for task, share in enumerate(shares)])
    ends = draw(lambda rows, ax: plots.costs(rows, "rate", {}, ax, share=True), table).containers[1][2][0]
    assert ends.get_segments()[0][:, 1].tolist() == pytest.approx([low, high])


@pytest.mark.parametrize("method", METHODS)
def test_coverage_is_drawn_where_the_object_was(method):
    seen = pd.DataFrame({"method": method, "object_x": [0.1, 0.2], "object_y": [0.6, 0.7]})
    ax = draw(maps.coverage, seen, "object", (0.0, 0.5, 0.0), (0.3, 0.8, 0.0))
    (dots,) = ax.get_lines()
    assert to_hex(dots.get_color()) == COLOUR[method] and dots.get_xdata() == pytest.approx([10, 20])


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


def test_frames_stand_apart_with_their_labels():
    frames = np.zeros((3, 60, 60, 3), np.uint8)
    ax = draw(maps.strip, frames, ["0", "10", "20"])
    row = ax.get_images()[0].get_array()
    white = (np.asarray(row)[0, :, 0] == 255)
    assert row.shape == (60, 3 * 60 + 2 * 2, 3) and white.sum() == 4 and not white[:60].any()
    assert [text.get_text() for text in ax.texts] == ["0", "10", "20"]
