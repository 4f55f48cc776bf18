"""A reader in JupyterLab: the start page opens, a notebook runs, is changed, interrupted, and goes on."""

import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import browser
import pytest

from move import paths

NOTEBOOK = "statistics"
START = "/lab/tree/notebooks/start.md"
IDLE = "document.querySelector('.jp-Notebook-ExecutionIndicator')?.dataset.status === 'idle'"
LONG = 300_000  # milliseconds


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
               "--IdentityProvider.token=", f"--ServerApp.root_dir={tmp_path}",
               f"--LabApp.app_settings_dir={paths.ROOT / 'docs/lab'}", f"--config={paths.ROOT / 'docs/lab/config.py'}"]
    server = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: socket.socket().connect_ex(("127.0.0.1", port)) == 0, 120)
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


def run_all(page) -> None:
    page.wait_for_function(IDLE, timeout=LONG)  # cells sent to a kernel that is not there yet are lost
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()


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
        page.goto(f"{lab}/lab/tree/notebooks/{NOTEBOOK}.ipynb")
        page.wait_for_selector(".jp-CodeCell", timeout=LONG)
        parameters = page.locator(".jp-CodeCell .cm-content").first

        def change(draws: int) -> None:
            text = (paths.NOTEBOOKS / f"{NOTEBOOK}.ipynb").read_text()
            assert '"draws = 2000' in text
            parameters.click()
            page.keyboard.press("Control+A")
            page.keyboard.insert_text('profile = "laptop"\nseeds = [1, 3]\ndeviations = [0.08]\nrate = 0.4\n'
                                      f"draws = {draws}")

        change(20)
        run_all(page)
        wait_for(lambda: list(made.glob(f"{NOTEBOOK}-*/{NOTEBOOK}.png")), LONG / 1000)
        first = set(made.iterdir())
        page.get_by_text("what is shipped stays as it is").first.wait_for(timeout=LONG)
        change(2_000_000)
        run_all(page)
        page.wait_for_function("document.querySelector('.jp-InputArea-prompt')?.innerText.includes('*') || "
                               "[...document.querySelectorAll('.jp-InputArea-prompt')].some(one => "
                               "one.innerText.includes('*'))", timeout=LONG)
        page.get_by_role("menuitem", name="Kernel", exact=True).click()
        page.get_by_role("menuitem", name="Interrupt Kernel").click()  # its name goes on with the keys
        page.get_by_text("KeyboardInterrupt").first.wait_for(timeout=LONG)
        change(30)
        run_all(page)
        wait_for(lambda: set(made.iterdir()) - first, LONG / 1000)
    assert not (tmp_path / "paper_figures").exists()
