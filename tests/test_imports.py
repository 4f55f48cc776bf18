"""What drawing from stored results imports: neither torch nor a simulator, each of which takes seconds."""

import subprocess
import sys

SLOW = ("torch", "diffusers", "mujoco", "metaworld", "scipy.stats", "statsmodels", "zarr", "h5py",
        "huggingface_hub", "distributed")
QUICK = ("move", "move.learn.settings", "move.study.spec", "move.study.labels", "move.study.kinds",
         "move.study.profiles", "move.study.results", "move.study.plan", "move.study.verify", "move.study.compare",
         "move.study.execute", "move.statistics.over_tasks", "move.statistics.cells",
         "move.statistics.data_efficiency", "move.figures.fig1_sparse", "move.figures.table2_main",
         "move.figures.fig8_real_setup", "move.figures.table3_real")


def test_what_reads_and_counts_stored_results_imports_nothing_slow():
    code = f"""
import importlib, sys
for module in {QUICK}:
    importlib.import_module(module)
    print(*[f"{{module}}: {{name}}" for name in {SLOW} if name in sys.modules])
"""
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert shown == "\n" * len(QUICK)
