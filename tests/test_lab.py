"""A reader in JupyterLab: notebooks run untouched, are changed, interrupted and go on; a page leads to them all."""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import browser
import nbformat
import pytest
from playwright.sync_api import TimeoutError

from move import paths
from move.figures.page.browser import INTERRUPTED

NOTEBOOK = "statistics"
WRITTEN = "what is shipped stays as it is"  # in the last line of a notebook that has run
UNTOUCHED = ("fig1_sparse", "table2_main", "generalization", "claims")
START = "/lab/tree/notebooks/start.md"
LONG = 300_000  # milliseconds
OPEN = "window.jupyterapp?.shell.currentWidget?.context"
CODE = f"({OPEN}?.model?.toJSON().cells || []).filter(cell => cell.cell_type === 'code' && cell.source.length)"
"""The code cells of the open notebook with all their outputs; the page itself holds only those in sight."""
IDLE = f"{CODE}.length && {OPEN}.sessionContext.session?.kernel?.status === 'idle'"
"""The notebook is there and its kernel too; cells sent before are lost."""


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[str]:
    """The address of a JupyterLab whose root is a copy of what a reader opens."""
    if browser.CHROMIUM is None:
        pytest.skip("no chromium on this machine; `make test-browser` installs it")
    for name in ("notebooks", "profiles"):
        shutil.copytree(paths.ROOT / name, tmp_path / name)
    (tmp_path / "results").symlink_to(paths.ROOT / "results")
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    environment = os.environ | {"MOVE_ROOT": str(tmp_path), "PYTHONPATH": str(paths.ROOT), "OMP_NUM_THREADS": "1",
                                "JUPYTER_CONFIG_DIR": str(tmp_path / "jupyter")}
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={port}", "--ip=127.0.0.1",
               "--IdentityProvider.token=", "--LabApp.expose_app_in_browser=True", f"--ServerApp.root_dir={tmp_path}",
               f"--LabApp.app_settings_dir={paths.ROOT / 'docs/lab'}", f"--config={paths.ROOT / 'docs/lab/config.py'}"]
    server = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: socket.socket().connect_ex(("127.0.0.1", port)) == 0, LONG / 1000)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.terminate()
        try:
            server.wait(30)
        except subprocess.TimeoutExpired:  # a kernel that does not end
            server.kill()
            server.wait(30)


def wait_for(there, seconds: float) -> None:
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.3)


def opened(page, lab: str, name: str) -> None:
    """Open a notebook in a workspace of its own, where no other one comes back beside it."""
    page.goto(f"{lab}/lab/workspaces/{name}/tree/notebooks/{name}.ipynb")
    page.wait_for_function(f"{OPEN}?.path === 'notebooks/{name}.ipynb'", timeout=LONG)


def run_all(page) -> None:
    """Choose Run All Cells, again where the first choice came before the page was ready for it."""
    for _ in range(5):
        page.wait_for_function(IDLE, timeout=LONG)
        page.evaluate(f"{OPEN}.sessionContext.ready.then(() => true)")
        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        try:
            page.wait_for_function(f"{OPEN}.sessionContext.session.kernel.status === 'busy'", timeout=LONG / 10)
            return
        except TimeoutError:
            continue
    raise AssertionError("no cell began to run")


def change(page, name: str, **parameters: object) -> None:
    """Type other values into the cell of the parameters, as they stand in git but for these."""
    (text,) = (cell.source for cell in nbformat.read(paths.NOTEBOOKS / f"{name}.ipynb", 4).cells
               if "parameters" in cell.metadata.get("tags", []))
    for key, value in parameters.items():
        text, found = re.subn(rf"^{key} = .*$", f"{key} = {value!r}", text, flags=re.MULTILINE)
        assert found == 1, key
    page.locator(".jp-CodeCell .cm-content").first.click(timeout=LONG)
    page.keyboard.press("Control+A")
    page.keyboard.insert_text(text)


def outputs(page, last: str) -> list[dict]:
    """All outputs of the open notebook, once one of them says `last`."""
    said = f"JSON.stringify({CODE}.map(cell => cell.outputs))"
    page.wait_for_function(f"{said}.includes({json.dumps(last)})", timeout=LONG)
    return [output for cell in page.evaluate(CODE) for output in cell["outputs"]]


def no_error(outputs: list[dict]) -> bool:
    return all(output["output_type"] != "error" for output in outputs)


@pytest.mark.browser
def test_notebooks_opened_untouched_are_the_shipped_figures_and_a_changed_one_is_not(lab, tmp_path):
    with browser.page() as page:
        for name in reversed(UNTOUCHED):
            opened(page, lab, name)
            run_all(page)
            made = outputs(page, WRITTEN)
            assert no_error(made) and "Not the shipped figure" not in str(made), name
            assert any("image/png" in output.get("data", {}) for output in made), name
            picture = page.locator(".jp-OutputArea img").first
            picture.scroll_into_view_if_needed(timeout=LONG)
            assert picture.evaluate("one => one.naturalWidth") > 400, name
            if pictures := os.environ.get("MOVE_SCREENSHOTS"):
                page.screenshot(path=f"{pictures}/lab_{name}.png")
        assert {path.name for path in (tmp_path / "build/figures").iterdir()} == {"laptop"}
        change(page, "fig1_sparse", seeds=1)
        run_all(page)
        assert no_error(outputs(page, "Not the shipped figure: seeds 1 (3)"))
    assert list((tmp_path / "build/figures").glob("fig1_sparse-*/fig1_sparse.png"))


@pytest.mark.browser
def test_the_start_page_leads_to_a_notebook(lab):
    with browser.page() as page:
        page.goto(lab + START)
        page.get_by_role("link", name=NOTEBOOK).click(timeout=LONG)
        page.wait_for_selector(".jp-NotebookPanel .jp-CodeCell", timeout=LONG)


@pytest.mark.browser
def test_a_reader_changes_interrupts_and_goes_on(lab, tmp_path):
    made = tmp_path / "build/figures"
    with browser.page() as page:
        opened(page, lab, NOTEBOOK)
        page.wait_for_function(IDLE, timeout=LONG)
        change(page, NOTEBOOK, seeds=[1, 3], deviations=[0.08], draws=20)
        run_all(page)
        wait_for(lambda: list(made.glob(f"{NOTEBOOK}-*/{NOTEBOOK}.png")), LONG / 1000)
        first = set(made.iterdir())
        outputs(page, WRITTEN)
        change(page, NOTEBOOK, seeds=[1, 3], deviations=[0.08], draws=1_000_000)
        run_all(page)
        page.wait_for_function("document.querySelector('.jp-InputArea-prompt')?.innerText.includes('*') || "
                               "[...document.querySelectorAll('.jp-InputArea-prompt')].some(one => "
                               "one.innerText.includes('*'))", timeout=LONG)
        page.get_by_role("menuitem", name="Kernel", exact=True).click()
        page.get_by_role("menuitem", name="Interrupt Kernel").click()  # its name goes on with the keys
        (stopped,) = (output for output in outputs(page, INTERRUPTED) if output["output_type"] == "error")
        assert stopped["ename"] == "KeyboardInterrupt" and len(stopped["traceback"]) == 1
        change(page, NOTEBOOK, seeds=[1, 3], deviations=[0.08], draws=30)
        run_all(page)
        wait_for(lambda: set(made.iterdir()) - first, LONG / 1000)
    assert not (tmp_path / "paper_figures").exists()
