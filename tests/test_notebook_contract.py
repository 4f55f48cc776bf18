"""A notebook's parameters are its experiment's, so that `make figures` computes one grid and draws the same one."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import papermill  # noqa: E402
import pytest  # noqa: E402

from move import paths  # noqa: E402
from move.experiments import EXPERIMENTS, registry  # noqa: E402
from move.report import page, tables  # noqa: E402
from move.report.changes import SHOWN  # noqa: E402
from move.sim.collect import Collection  # noqa: E402
from move.study.profiles import load_profile  # noqa: E402
from move.study.results import Result, table  # noqa: E402
from move.study.spec import ControlRun, PolicyRun  # noqa: E402


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_notebooks_defaults_are_its_experiments(name):
    found = papermill.inspect_notebook(str(paths.NOTEBOOKS / f"{name}.ipynb"))
    defaults = registry.defaults(name)
    assert found.pop("profile")["default"] == '"laptop"'
    extra = set(found) - set(defaults)
    assert set(defaults) <= set(found) and extra == set(SHOWN.get(name, {})), extra
    for key, default in defaults.items():
        value = eval(found[key]["default"])  # noqa: S307, our own notebook
        assert (tuple(value) if isinstance(value, list) else value) == default, key


@pytest.mark.parametrize("profile, stamped", [("smoke", True), ("laptop", False)])
def test_a_smoke_figure_says_so_across_itself_and_no_other_does(profile, stamped, tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "figures", lambda name: tmp_path)
    figure, _ = plt.subplots()
    page.write("claims", figure, {}, load_profile(profile), "source")
    assert ("SMOKE" in [text.get_text() for text in figure.texts]) is stamped


def result(method: str, seconds: dict[str, float]) -> Result:
    from recipes import keypoints

    spec = PolicyRun(task="push", seed=0, training=keypoints(),
                   collection=Collection(task="push", method=method, timesteps=500))
    return Result(spec, [], None, None, seconds, {})


def test_costs_of_runs_are_the_minutes_that_they_took():
    runs = [result("static", {"collect": 60.0, "train": 300.0, "evaluate": 120.0}),
            result("static", {"collect": 120.0, "train": 420.0, "evaluate": 120.0}),
            result("move", {"collect": 180.0, "train": 600.0, "evaluate": 60.0})]
    static, move = tables.run_costs(runs).itertuples()
    assert (static.collect, static.train, static.evaluate, static.whole) == (1.5, 6.0, 2.0, 9.5)
    assert (static.runs, static.all_runs, move.whole, move.runs) == (2, 19, 14.0, 1)


def test_floors_and_ceilings_are_the_controls_and_not_the_policies():
    def rows(success):
        return [{"trial": trial, "group": "random", "success": success} for trial in range(4)]

    controls = [Result(ControlRun(task="push", seed=0, agent=agent), rows(success), None, None, {}, {})
                for agent, success in (("expert", True), ("goal-blind", False))]
    policy = result("static", {})
    policies = [Result(policy.spec, rows(True), None, None, {}, {})]
    found = tables.floors_and_ceilings(table(controls + policies))
    assert found.loc["push"].to_dict() == {"expert": 1.0, "goal-blind": 0.0}
