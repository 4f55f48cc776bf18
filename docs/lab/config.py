"""JupyterLab's settings for `make lab`: using the notebooks leaves `git status` clean."""

from move.teaching.lab import without_outputs

c = get_config()  # noqa: F821, which Jupyter gives
c.FileContentsManager.pre_save_hook = without_outputs
