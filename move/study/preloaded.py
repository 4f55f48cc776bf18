"""What every run imports, where processes of runs are forked from; without GL, which lives on in no fork."""

from move.machine import without_gl

with without_gl():
    import diffusers.schedulers.scheduling_ddim  # noqa: F401
    import metaworld  # noqa: F401

    import move.study.run  # noqa: F401
