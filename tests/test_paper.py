"""The paper's values as data against a second transcription, written down line by line from the paper's own source."""

import math

import pandas as pd
import pytest

from move import paper
from move.errors import BadInput
from move.figures import table2_main
from move.figures.tables import with_paper

# Copied by eye, in the order and the units in which the paper prints them; never from `move.paper`.
PER_CENT = {  # section IV-A and the captions of its figures: static, MOVE
    ("fig1_sparse", ""): "29.5 80.8",
    ("fig3_dense", ""): "66 74",
    ("fig5_circle", "inside"): "21.3 43.7",  # "across the in-circle space"
    ("fig5_circle", "outside"): "44.6 67.4",  # "across the out-of-circle space"
}
DEMONSTRATIONS = {"fig1_sparse": "90 85", "fig3_dense": "90 85", "fig5_circle": "90 59"}  # static, MOVE
TABLE_I = {"object": "0.675", "object+target": "0.447", "all": "0.317"}
TABLE_II = """
           Pick-Place Push  Assembly Box-Close Hammer Wall  Window Faucet Disassembly Basketball Average
    static 0.317      0.163 0.072    0.351     0.156  0.066 0.512  0.289  0.279       0.011      0.222
    adc    0.472      0.335 0.053    0.383     0.252  0.237 0.455  0.345  0.207       0.025      0.276
    move   0.673      0.410 0.131    0.417     0.309  0.298 0.705  0.418  0.447       0.099      0.391
"""
TABLE_III = """
    35000 static  3.3 0.055
    35000 move   23.3 0.311
    75000 static 23.3 0.389
    75000 move   36.7 0.522
"""
TABLE_IV = """
    prediction horizon           4      8
    action horizon               3      8
    observation horizon          2      2
    batch size                   128    128
    denoising steps in training  100    50
    denoising steps in inference 10     10
"""
TABLE_V = """
    Pick-Place 20 Push   20 Box-Close 100 Assembly    20 Hammer     20
    Wall       20 Window  5 Faucet      5 Disassembly 20 Basketball 20
"""
TABLE_VI = {"static": "459.2 2 83.8 93.3", "move": "549.3 2 107.4 89.7"}  # real steps, people; steps, per cent
TASK = {"Pick-Place": "pick-place", "Push": "push", "Assembly": "assembly", "Box-Close": "box-close",
        "Hammer": "hammer", "Wall": "pick-place-wall", "Window": "window-open", "Faucet": "faucet-open",
        "Disassembly": "disassemble", "Basketball": "basketball"}


def second_transcription() -> dict[tuple[str, ...], float]:
    """Every value above in the keys of `PAPER`: (experiment, task, method, condition, metric) -> value."""
    values = {}
    for (figure, where), printed in PER_CENT.items():
        for method, number in zip(("static", "move"), printed.split(), strict=True):
            values[figure, "pick-place", method, where, "success"] = float(number) / 100
    for figure, printed in DEMONSTRATIONS.items():
        for method, number in zip(("static", "move"), printed.split(), strict=True):
            values[figure, "pick-place", method, "", "demonstrations"] = float(number)
    for factors, number in TABLE_I.items():
        values["table1_spatial_factors", "pick-place", "static", factors, "success"] = float(number)
    values["table1_spatial_factors", "pick-place", "static", "", "timesteps"] = 20e3
    names, *lines = (line.split() for line in TABLE_II.strip().splitlines())
    for method, *numbers in lines:
        for name, number in zip(names, numbers, strict=True):
            task, metric = (TASK[name], "success") if name != "Average" else ("", "mean_success")
            values["table2_main", task, method, "", metric] = float(number)
    values["table2_main", "", "move", "over static", "relative_gain"] = 0.761
    values["fig2_overview", "real-robot", "move", "over static", "largest_score_ratio"] = 4
    for size, method, success, score in (line.split() for line in TABLE_III.strip().splitlines()):
        values["table3_real", "real-robot", method, size, "success"] = float(success) / 100
        values["table3_real", "real-robot", method, size, "score"] = float(score)
    for task, move, static in (("pick-place", 20e3, 50e3), ("assembly", 50e3, 100e3), ("pick-place-wall", 20e3, 100e3)):
        values["fig4_scaling", task, "move", "equally good", "timesteps"] = move
        values["fig4_scaling", task, "static", "equally good", "timesteps"] = static
    values["fig4_scaling", "", "move", "least", "data_efficiency"] = 2
    values["fig4_scaling", "", "move", "most", "data_efficiency"] = 5
    words = TABLE_V.split()
    for name, thousands in zip(words[::2], words[1::2], strict=True):
        values["table5_data_sizes", TASK[name], "", "", "timesteps"] = 1000 * float(thousands)
    for method, printed in TABLE_VI.items():
        real, people, steps, rate = map(float, printed.split())
        values["table6_collection", "real-robot", method, "real robot", "mean_steps"] = real
        values["table6_collection", "real-robot", method, "real robot", "people"] = people
        values["table6_collection", "", method, "simulation", "mean_steps"] = steps
        values["table6_collection", "", method, "simulation", "generation_rate"] = rate / 100
    return values


def test_every_value_is_that_of_the_second_transcription():
    mine = second_transcription()
    theirs = paper.PAPER.set_index(["experiment", "task", "method", "condition", "metric"]).value
    assert theirs.index.is_unique and set(theirs.index) == set(mine)
    wrong = {key: (theirs[key], value) for key, value in mine.items() if theirs[key] != pytest.approx(value, abs=1e-9)}
    assert wrong == {}


def test_the_hyperparameters_are_those_of_table_4():
    rows = (line.rsplit(maxsplit=2) for line in TABLE_IV.strip().splitlines())
    whole = {name.strip(): (int(simulation), int(real)) for name, simulation, real in rows}
    steps = {"gradient steps": ("220,000 in all", "200 an epoch")}
    assert whole | steps == paper.TABLE4_HYPERPARAMETERS


def test_the_papers_means_are_those_of_its_tasks():
    means = paper.published("table2_main").groupby("method").value.mean()
    printed = paper.published("table2_main", "mean_success").set_index("method").value
    assert all(means[method] == pytest.approx(value, abs=6e-4) for method, value in printed.items())
    gain = paper.published("table2_main", "relative_gain").value.item()
    assert printed["move"] / printed["static"] - 1 == pytest.approx(gain, abs=1e-3)


def test_the_real_counts_are_whole_trials_and_points():
    cells = paper.TABLE3_REAL
    assert cells.successes.tolist() == [1, 7, 7, 11] and cells.score.tolist() == [5, 28, 35, 47]
    assert cells.timesteps.tolist() == [35_000, 35_000, 75_000, 75_000]


def test_the_join_keeps_our_rows_and_finds_the_papers_by_name():
    ours = pd.DataFrame({"where": ["outside", "inside", "outside"], "method": ["move", "static", "adc"]},
                        index=[7, 8, 9])
    table = with_paper(ours, "fig5_circle", on=["where", "method"])
    assert table.index.tolist() == [7, 8, 9] and table.paper.tolist()[:2] == [0.674, 0.213]
    assert math.isnan(table.paper[9])
    hammer = pd.DataFrame({"task": ["hammer"], "baseline": ["adc"]})
    compared = with_paper(hammer, "table2_main", ["task", "baseline"], "difference")
    assert compared.paper.tolist() == pytest.approx([0.309 - 0.252])


@pytest.mark.parametrize("on, experiment, metric", [
    (["method"], "fig5_circle", "success"), (["where", "method", "factors"], "fig5_circle", "success"),
    (["method"], "fig6_dimensions", "success"), (["method"], "fig1_sparse", "length")])
def test_a_join_that_would_be_ambiguous_or_empty_is_refused(on, experiment, metric):
    ours = pd.DataFrame({"where": ["inside"], "method": ["move"], "factors": ["all"]})
    with pytest.raises(BadInput, match="allowed"):
        with_paper(ours, experiment, on, metric)


def test_of_some_tasks_alone_the_papers_mean_is_that_of_these_tasks():
    def means(*tasks):
        rates = pd.DataFrame([{"task": task, "method": "move", "value": 0.5} for task in tasks])
        return table2_main._means({"": with_paper(rates, "table2_main", on=["task", "method"])}).paper.tolist()

    assert means("push", "hammer") == [pytest.approx((0.410 + 0.309) / 2)]
    assert means(*paper.PAPER_TASKS) == [0.391]
