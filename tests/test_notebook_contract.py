"""A notebook's parameters are its experiment's, so that `make figures` computes one grid and draws the same one."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import papermill  # noqa: E402
import pytest  # noqa: E402

from move import paths  # noqa: E402
from move.figures.page import parameters  # noqa: E402
from move.figures.page.changes import SHOWN  # noqa: E402
from move.study.profiles import load_profile  # noqa: E402


@pytest.mark.parametrize("name", parameters.with_runs())
def test_a_notebooks_defaults_are_its_experiments(name):
    found = papermill.inspect_notebook(str(paths.NOTEBOOKS / f"{name}.ipynb"))
    defaults = parameters.defaults(name)
    assert found.pop("profile")["default"] == '"laptop"'
    extra = set(found) - set(defaults)
    assert set(defaults) <= set(found) and extra == set(SHOWN.get(name, {})), extra
    for key, default in defaults.items():
        value = eval(found[key]["default"])  # noqa: S307, our own notebook
        assert (tuple(value) if isinstance(value, list) else value) == default, key


@pytest.mark.parametrize("profile, stamped", [("smoke", True), ("laptop", False)])
def test_a_smoke_figure_says_so_across_itself_and_no_other_does(profile, stamped, tmp_path, monkeypatch):
    monkeypatch.setattr(Profile, "figures", property(lambda name: tmp_path))
    figure, _ = plt.subplots()
    page.write("claims", figure, {}, load_profile(profile), "source")
    assert ("SMOKE" in [text.get_text() for text in figure.texts]) is stamped
