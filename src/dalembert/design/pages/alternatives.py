"""What of a page is another for each design that can be chosen."""

from __future__ import annotations

from typing import Any

import numpy as np

FRAMES = 2400
"""Instants of all designs of a page together; each keeps ``LEAST`` at least."""
LEAST = 61
CHANGING = {
    "mechanism": ("time", "scene", "series", "events"),
    "spatial": ("time", "scene", "series", "events"),
    "structure": ("drawing", "moved", "scales", "displacements", "fields", "loads", "reactions"),
}
"""Kind of page → what in it depends on the design."""


def thinned(page: dict[str, Any], count: int) -> dict[str, Any]:
    """The page of a motion with as many instants as ``count`` of them have room for."""
    time = page.get("time") or []
    most = max(LEAST, FRAMES // max(count, 1))
    if len(time) <= most:
        return page
    keep = np.unique(np.linspace(0, len(time) - 1, most).round().astype(int))
    made: dict[str, Any] = _kept(page, len(time), keep)
    return made


def _kept(thing: Any, size: int, keep: np.ndarray) -> Any:
    """Columns with a row for each instant, of the instants kept."""
    if isinstance(thing, dict):
        return {key: _kept(value, size, keep) for key, value in thing.items()}
    if isinstance(thing, np.ndarray):
        return thing[keep] if thing.shape[:1] == (size,) else thing
    if isinstance(thing, list):
        if len(thing) == size and all(x is None or isinstance(x, (int, float)) for x in thing):
            return [thing[k] for k in keep]
        return [_kept(value, size, keep) for value in thing]
    return thing


def alternative(result: Any, page: dict[str, Any], **first_view: Any) -> dict[str, Any]:
    """What the page of another result has in place of what ``page`` has; nothing without one."""
    if result is None:
        return {}
    other = result.page(**first_view)
    if "time" in page and other.get("time"):
        most = len(page["time"]) or 1
        if len(other["time"]) > most:
            keep = np.linspace(0, len(other["time"]) - 1, most).round().astype(int)
            other = _kept(other, len(other["time"]), np.unique(keep))
    shown = {name for group in page.get("default_plots", ()) for name in group}
    made = {key: other[key] for key in CHANGING[page["kind"]] if key in other}
    if "series" in made:
        made["series"] = [s for s in made["series"] if s["name"] in shown]
    made["parameters"] = other.get("parameters", [])
    return made
