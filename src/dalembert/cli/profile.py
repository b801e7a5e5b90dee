"""``--profile``: where the time of a command went, and how often things were done."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.analysis.dynamics.record import projection_time
from dalembert.cli.console import console
from dalembert.text.wording import visible
from dalembert.timing import ENDING, Timing

INSIDE = {
    "model": ("build",),
    "analysis": (
        "assembly",
        "compile",
        "integration",
        "loading",
        "factorisation",
        "solution",
        "computation",
        "outputs",
        "checks",
    ),
}
"""Part of the command → parts of it that the statistics of a result know."""


def profile(timing: Timing, result: Any) -> dict[str, Any]:
    """Seconds of the parts of a command and of what is inside them, and counts.

    Parameters
    ----------
    timing : of the parts of the command
    result : Result that tells more
    """
    statistics = result.statistics
    parts: dict[str, dict[str, Any]] = {
        name: {"seconds": seconds, "inside": _inside(name, statistics)}
        for name, seconds in timing.parts.items()
    }
    seconds = projection_time(result)
    if seconds is not None:
        parts["analysis"]["inside"]["projection, of the integration"] = seconds
    counts = {
        name: value
        for name, value in statistics.items()
        if isinstance(value, int) and not isinstance(value, bool)
    }
    return {"seconds": timing.total, "parts": parts, "counts": counts}


def _inside(part: str, statistics: Mapping[str, Any]) -> dict[str, float]:
    names = INSIDE.get(part, ())
    return {name: statistics[name + ENDING] for name in names if name + ENDING in statistics}


def show_profile(found: Mapping[str, Any]) -> None:
    """Print it as a table."""
    from rich.table import Table

    table = Table("part", "seconds", "share", title="profile", title_justify="left")
    whole = max(found["seconds"], 1e-300)
    for name, part in found["parts"].items():
        table.add_row(visible(name), *_row(part["seconds"], whole), style="bold")
        for inner, seconds in part["inside"].items():
            table.add_row(f"  {visible(inner)}", *_row(seconds, whole))
    table.add_row("all", *_row(found["seconds"], whole), style="bold")
    for column in table.columns[1:]:
        column.justify = "right"
    console().print(table)
    counts = Table("count", "number", show_edge=True)
    counts.columns[1].justify = "right"
    for name, number in found["counts"].items():
        counts.add_row(visible(name), str(number))
    if found["counts"]:
        console().print(counts)


def _row(seconds: float, whole: float) -> tuple[str, str]:
    return f"{seconds:.4f}", f"{100 * seconds / whole:.1f} %"
