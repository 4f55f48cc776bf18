"""README's table of results is what the figures' own tables say."""

import importlib.util

import pytest

from move import paths

SCRIPT = importlib.util.spec_from_file_location("results_table", paths.ROOT / "tools" / "results_table.py")
results_table = importlib.util.module_from_spec(SCRIPT)
SCRIPT.loader.exec_module(results_table)


def test_readme_shows_what_the_script_writes():
    text = results_table.README.read_text()
    assert text == results_table.with_table(text)


@pytest.mark.parametrize("gap, low, high, published, words", [
    (0.10, 0.06, 0.14, 0.17, "direction as in the paper, size smaller"),
    (0.58, 0.46, 0.70, 0.22, "direction as in the paper, size larger"),
    (0.22, 0.07, 0.39, 0.23, "direction and size as in the paper"),
    (-0.43, -0.49, -0.36, -0.30, "direction as in the paper, size larger"),
    (-0.10, -0.20, -0.01, 0.20, "opposite direction"),
    (-0.01, -0.05, 0.03, 0.08, "not found here"),
    (0.05, -0.05, 0.15, 0.08, "no difference shown, nor the paper's excluded"),
])
def test_the_verdict_is_a_rule(gap, low, high, published, words):
    assert results_table.verdict(gap, low, high, published) == words
