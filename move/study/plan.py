"""What is missing, why, and how long it would take: measured where results exist, else the profile's estimate."""

from __future__ import annotations

from collections import Counter
from statistics import median
from typing import Any

from move.paths import results
from move.study.profiles import load_profile
from move.study.results import Result, split
from move.study.spec import RunSpec

CONTROL_MINUTES = 0.05


def plan_rows(profile: str, figures: dict[str, list[RunSpec]]) -> list[dict[str, Any]]:
    """One row a figure: how many runs, how many stored, why the others are missing, and their core-minutes."""
    estimates, rows = load_profile(profile).minutes, []
    for figure, specs in figures.items():
        there, missing = split(specs, results(profile))
        reasons = Counter(why if why == "not computed yet" else "unusable result" for _, why in missing)
        rows.append({
            "figure": figure,
            "runs": len(specs),
            "stored": len(there),
            "missing": len(missing),
            "core_minutes_left": _total([_minutes(spec, there, estimates) for spec, _ in missing]),
            "why": "; ".join(f"{count} {why}" for why, count in reasons.items()) or "complete",
        })
    return rows


def _total(minutes: list[float | None]) -> float | str:
    return "unknown" if None in minutes else round(sum(minutes), 1)


def _minutes(spec: RunSpec, there: list[Result], estimates: dict[str, float]) -> float | None:
    """Core-minutes of one run: the median of stored runs like it, or the profile's estimate, or None."""
    alike = [sum(result.seconds.values()) / 60 for result in there
             if result.spec.observation == spec.observation and result.spec.task == spec.task]
    if alike:
        return median(alike)
    return CONTROL_MINUTES if spec.collection is None else estimates.get(spec.observation)
