"""Tables for people: each kind of number in its own unit, whatever stands beside it, and LaTeX that keeps all of it."""

import numpy as np
import pandas as pd
import pytest

from move.figures.page import printed
from move.figures.page.printed import latex, readable

ONE = {"low": 0.1, "high": 0.3}


@pytest.mark.parametrize(("columns", "heading", "cell"), [
    ({"value": 0.25}, "Success (%)", "25.0"),
    ({"value": 0.2, **ONE}, "Success (%)", "20.0 [10.0, 30.0]"),
    ({"difference": -0.125}, "Difference (points)", "−12.5"),
    ({"difference": 0.2, **ONE}, "Difference (points)", "+20.0 [+10.0, +30.0]"),
    ({"own": 0.9, "lost": 0.5}, "Lost elsewhere (points)", "+50.0"),
    ({"difference": 0.2, "paper": 0.3}, "Paper (points)", "+30.0"),
    ({"value": 0.2, "paper": 0.3}, "Paper (%)", "30.0"),
    ({"timesteps": 20_000, "paper": 20_000}, "Paper, timesteps", "20,000"),
    ({"hyperparameter": "target", "paper": "sample"}, "Paper", "sample"),
    ({"share": 0.75}, "MOVE's share (%)", "75.0"),
    ({"share": 0.75, "baseline": 0.0}, "Against (%)", "0.0"),
    ({"baseline": "adc"}, "Against", "ADC"),
    ({"moves": "object + target"}, "What moves", "object, target"),
    ({"moves": "object", "baseline": "nothing"}, "Against", "nothing"),
    ({"baseline": 0.03}, "Against", "0.03"),
    ({"seeds": [0.5, 0.25]}, "Each seed (%)", "50.0, 25.0"),
    ({"seeds": 3}, "Seeds", "3"),
    ({"p": 0.0004}, "p", "<0.001"),
    ({"holm": 0.0495}, "p, Holm", "0.050"),
    ({"ratio": 1.84, "low": 0.9, "high": np.inf}, "Factor", "1.8 [0.9, more]"),
    ({"generation_rate": 0.997, "low": 0.9, "high": 1.0}, "Generation rate (%)", "99.7 [90.0, 100.0]"),
    ({"gain": 0.0, "gain_low": -0.05, "gain_high": 0.05}, "Gain (points)", "+0.0 [−5.0, +5.0]"),
    ({"improvement": 0.84, "improvement_low": 0.7, "improvement_high": 0.95}, "MOVE better (%)", "84.0 [70.0, 95.0]"),
    ({"half_width": 0.117}, "Half width (points)", "11.7"),
    ({"task": "disassemble"}, "Task", "Disassembly"),
    ({"task": "mean of 10"}, "Task", "mean of 10"),
    ({"observation": "rgb"}, "From", "pixels"),
    ({"expert": "metaworld"}, "Expert", "Meta-World's"),
    ({"group": "moving"}, "Tried", "elsewhere, in motion"),
    ({"part": "nothing"}, "Whose speed", "static"),
    ({"made_up": np.nan}, "Made up", "—"),
    ({"value": np.nan, "low": np.nan, "high": np.nan}, "Success (%)", "—"),
])
def test_a_number_is_written_in_the_unit_of_its_column(columns, heading, cell):
    assert readable(pd.DataFrame([columns]))[heading].tolist() == [cell]


def test_an_interval_stands_beside_its_value_and_in_no_column_of_its_own():
    table = readable(pd.DataFrame([{"task": "push", "value": 0.2, **ONE, "p": 0.5}]))
    assert list(table) == ["Task", "Success (%)", "p"]


def test_the_interquartile_difference_is_the_first_minus_the_second():
    over = pd.DataFrame([{"baseline": "static", "iqm_first": 0.5, "iqm_second": 0.4, "iqm_low": 0.0, "iqm_high": 0.2}])
    assert readable(over)["IQM (points)"].tolist() == ["+10.0 [+0.0, +20.0]"]
    assert readable(over)["IQM, MOVE (%)"].tolist() == ["50.0"]


def test_latex_keeps_every_cell_in_its_row_and_column_and_escapes_what_it_must():
    table = pd.DataFrame({"Who": ["a_b", "50 % & more"], "Points": ["−1.0", "<0.001"], "Paper": ["—", "+2.0"]})
    text = latex(table, "x", "Of x. with 5 %")
    assert r"a\_b & $-$1.0 & --- \\" in text and r"50 \% \& more & $<$0.001 & +2.0 \\" in text
    assert r"\caption{Of x. with 5 \%}" in text and r"\label{tab:x}" in text
    assert r"\begin{tabular}{lrr}" in text and text.index("Who") < text.index(r"a\_b")


@pytest.mark.parametrize(("rows", "letters", "kind"), [
    (3, 10, "table"), (3, 70, "table*"), (60, 10, "longtable")])
def test_a_table_has_the_float_that_it_fits_into(rows, letters, kind):
    wide = {"table": 1, "table*": 4, "longtable": 1}[kind]
    table = pd.DataFrame({f"column {place}": ["x" * (letters // wide)] * rows for place in range(wide)})
    text = latex(table, "x", "Of x.")
    assert text.count(rf"\begin{{{kind}}}") == text.count(rf"\end{{{kind}}}") == 1
    assert text.count("x" * (letters // wide)) >= rows


def test_the_tidy_table_is_written_beside_the_printed_one_and_nothing_is_rounded_away(tmp_path):
    table = pd.DataFrame([{"method": "move", "value": 0.12345678, "seeds": [0.1, 0.2]}])
    printed.save(table, "t", tmp_path / "new", "A caption.")
    (line,) = pd.read_csv(tmp_path / "new" / "t.csv").to_dict("records")
    assert line == {"method": "move", "value": 0.1235, "seeds": "0.1 0.2"}
    assert "MOVE & 12.3 & 10.0, 20.0" in (tmp_path / "new" / "t.tex").read_text()
    printed.save(table, "t", tmp_path, "A caption.", pd.DataFrame({"In its place": ["7"]}))
    assert "In its place" in (tmp_path / "t.tex").read_text() and "MOVE" not in (tmp_path / "t.tex").read_text()


def test_what_rounds_to_nothing_is_written_without_a_sign(tmp_path):
    numbers = [-2e-18, -4e-5, -6e-5, 0.5, np.nan, np.inf]
    printed.save(pd.DataFrame({"difference": numbers}), "table", tmp_path, "A table.")
    assert (tmp_path / "table.csv").read_text().split("\n")[1:-1] == [
        "0.0000", "0.0000", "-0.0001", "0.5000", '""', "inf"]
