"""A notebook's parameters are its figure's, so that `make figures` computes one grid and draws the same one."""

import ast

import nbformat
import papermill
import pytest

from move import paths
from move.figures import names
from move.figures.page import parameters
from move.figures.page.make import make
from move.figures.plots import style
from move.study.profiles import Profile, load_profile


@pytest.mark.parametrize("name", names())
def test_a_notebook_has_its_figures_parameters_with_the_laptop_profiles_values_and_passes_every_one(name):
    path = paths.NOTEBOOKS / f"{name}.ipynb"
    found = {key: eval(one["default"])  # noqa: S307, our own notebook
             for key, one in papermill.inspect_notebook(str(path)).items()}
    assert found.pop("profile") == "laptop"
    computes = found.pop("compute", None)
    assert computes is (False if name in parameters.with_runs() else None)
    assert {key: tuple(value) if isinstance(value, list) else value for key, value in found.items()} == (
        parameters.parameters(name, load_profile("laptop")))
    notebook = nbformat.read(path, 4)
    assert sum(cell.cell_type == "markdown" for cell in notebook.cells) >= 2
    sources = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    assert not any("def " in source for source in sources), "an algorithm belongs in the package"
    (made,) = [node for source in sources for node in ast.walk(ast.parse(source))
               if isinstance(node, ast.Call) and ast.unparse(node.func) == "make"]
    assert [ast.unparse(argument) for argument in made.args] == [repr(name), "profile"]
    assert {one.arg: ast.unparse(one.value) for one in made.keywords} == {
        key: key for key in [*found, *["compute"] * (computes is False)]}


@pytest.mark.parametrize(("profile", "stamped"), [("smoke", True), ("laptop", False)])
def test_a_smoke_figure_says_so_across_itself_and_no_other_does(profile, stamped, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(style, "save", lambda figure, *_: drawn.append([text.get_text() for text in figure.texts]))
    monkeypatch.setattr(Profile, "figures", property(lambda _: tmp_path))
    make("table3_real", profile)
    assert len(drawn) == 1 and ("SMOKE" in drawn[0]) is stamped
