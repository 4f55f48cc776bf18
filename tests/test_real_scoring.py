"""A scoring sheet is read, or refused with the line that is wrong."""

import numpy as np
import pytest

from move.errors import BadInput
from move.realworld.scoring import paired_test, read_sheet, score_table

HEADER = "trial,method,position_x_m,position_y_m,score\n"


def sheet(tmp_path, lines: str, header: str = HEADER):
    path = tmp_path / "sheet.csv"
    path.write_text(header + lines)
    return path


def test_a_good_sheet(tmp_path):
    table = read_sheet(
        sheet(tmp_path, "1,static,0.31,-0.12,2\n1, MOVE ,0.31,-0.12,3\n2,static,0.2,0.1,0\n2,MOVE,0.2,0.1,3\n"))
    assert table["score"].tolist() == [2, 3, 0, 3] and table["method"].tolist() == ["static", "move"] * 2
    scores = score_table(table).set_index("method")
    assert scores.loc["move", "successes"] == 2 and scores.loc["move", "normalised"] == 1
    assert scores.loc["static", "normalised"] == pytest.approx(2 / 6) and scores.loc["static", "picked_up"] == 0.5
    assert scores.loc["static", "low"] == 0 < scores.loc["static", "high"] < 1


BAD = {
    "1,static,0.3,0.1,4": "line 2: score: '4' given; input should be less than or equal to 3",
    "1,static,0.3,0.1,2.5": "line 2: score: '2.5' given", "1,static,0.3,0.1,": "line 2: score: '' given",
    "1,static,0.3,0.1,\u00b2": "line 2: score", "1,static,0.3,0.1,2\n0,static,0.3,0.1,2": "line 3: trial: '0' given",
    "1,moved,0.3,0.1,2": "line 2: method: 'moved' given; input should be 'static', 'adc' or 'move'",
    "1,static,31,0.1,2": "line 2: position_x_m: '31' given", "1,static,0.3,left,2": "line 2: position_y_m: 'left'",
    "1,static,nan,0.1,2": "line 2: position_x_m: 'nan' given",
    "1,static,0.3,0.1,2\n1,static,0.3,0.1,1": "line 3: trial 1 of static is scored twice",
    "1,static,0.3,0.1,2\n1,MOVE,0.4,0.1,1": "line 3: trial 1 stands 10 cm from where it stood before",
    "1_0,static,0.3,0.1,2": "line 2: '1_0' given; allowed: numbers in digits alone",
    "1,static,0.3,0.1,2\n2,static,0.3,0.1,0_3": "line 3: '0_3' given", "1,static,0_.3,0.1,2": "line 2: '0_.3' given",
    "1,static,0.3,0.1,2,5": "line 2: 6 values; allowed: 5", "": "no trials below the header",
}


@pytest.mark.parametrize("lines", BAD)
def test_bad_lines_are_named(tmp_path, lines):
    with pytest.raises(BadInput) as caught:
        read_sheet(sheet(tmp_path, lines))
    assert BAD[lines] in str(caught.value) and "sheet.csv" in str(caught.value) and "\n" not in str(caught.value)


def test_wrong_columns_and_missing_file(tmp_path):
    with pytest.raises(BadInput, match="expected \\['trial', 'method'"):
        read_sheet(sheet(tmp_path, "1,2\n", header="trial,score\n"))
    with pytest.raises(BadInput, match="expected a CSV scoring sheet"):
        read_sheet(tmp_path / "none.csv")


def test_paired_test_uses_the_positions(tmp_path):
    lines = "".join(f"{n},static,0.3,0.0,{0 if n < 8 else 3}\n{n},MOVE,0.3,0.0,3\n" for n in range(1, 11))
    result = paired_test(read_sheet(sheet(tmp_path, lines)), "static", "move", rng=np.random.default_rng(0))
    assert (result["pairs"], result["only_first"], result["only_second"]) == (10, 0, 7)
    assert result["mcnemar"] == pytest.approx(2 * 0.5**7) and result["score_gain"] == pytest.approx(2.1)
    assert result["permutation"] == pytest.approx(2 * 0.5**7, abs=0.005)


def test_paired_test_needs_common_trials(tmp_path):
    table = read_sheet(sheet(tmp_path, "1,static,0.3,0.0,1\n2,MOVE,0.3,0.0,1\n"))
    for first, second in (("static", "move"), ("static", "adc")):
        with pytest.raises(BadInput, match="share no trial"):
            paired_test(table, first, second, rng=np.random.default_rng(0))
