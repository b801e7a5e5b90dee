"""Common parts of the pages of design tasks: views, verdict, frame, alternative designs."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from dalembert.report.views import notes

MAX_FRAMES = 2400
"""Upper limit of the instants of all designs of a page together."""
MIN_FRAMES = 61
"""Lower limit of the instants of one design."""
CHANGING = {
    "mechanism": ("time", "states", "scene", "series", "events"),
    "spatial": ("time", "states", "scene", "series", "events"),
    "structure": ("states", "scene", "displacements", "reactions"),
}
"""Kind of page → keys that depend on the design."""


def plain_page(decision: Any) -> dict[str, Any]:
    """Page of a decision without a mechanism or structure."""
    return {
        **{"format": 1, "kind": "decision", "title": decision.name, "subtitle": decision.sentence},
        "verdict": verdict(decision),
        "designs": decision.table_of_designs(),
        "views": all_views(decision),
    }


def verdict(decision: Any) -> dict[str, Any]:
    """Success and summary for the head of a page."""
    return {"success": decision.ok and not decision.warnings, "text": decision.sentence}


def all_views(decision: Any) -> list[dict[str, Any]]:
    """Warnings and views of a decision."""
    if not decision.warnings:
        return list(decision.views())
    warnings = notes("Warnings", decision.warnings)
    return [{**warnings, "place": "board"}, *decision.views()]


def with_views(page: dict[str, Any], decision: Any, title: str) -> dict[str, Any]:
    """Page of a result, extended by the views of its decision."""
    page["title"] = f"{page['title']}: {title}"
    page["verdict"] = verdict(decision)
    page["designs"] = decision.table_of_designs()
    page["views"] = [*page.get("views", ()), *all_views(decision)]
    return page


def page_frame(decision: Any, height: int = 620) -> str:
    """HTML frame with the page of a decision, for notebooks."""
    from dalembert.report.page import render_page

    page = html.escape(render_page(plain_page(decision)), quote=True)
    look = f"width:100%;height:{height}px;border:1px solid #8884;border-radius:10px"
    return f'<iframe srcdoc="{page}" style="{look}" title="Page of the decision"></iframe>'


def thinned(page: dict[str, Any], count: int) -> dict[str, Any]:
    """Page of a motion with fewer instants, so that ``count`` of them stay within the limit."""
    time = page.get("time") or []
    limit = max(MIN_FRAMES, MAX_FRAMES // max(count, 1))
    if len(time) <= limit:
        return page
    indices = np.unique(np.linspace(0, len(time) - 1, limit).round().astype(int))
    thinned_page: dict[str, Any] = _select(page, len(time), indices)
    return thinned_page


def _select(payload: Any, size: int, indices: np.ndarray) -> Any:
    """Payload whose columns of ``size`` instants are reduced to ``indices``."""
    if isinstance(payload, dict):
        return {key: _select(value, size, indices) for key, value in payload.items()}
    if isinstance(payload, np.ndarray):
        return payload[indices] if payload.shape[:1] == (size,) else payload
    if isinstance(payload, list):
        if len(payload) == size and all(x is None or isinstance(x, (int, float)) for x in payload):
            return [payload[k] for k in indices]
        return [_select(value, size, indices) for value in payload]
    return payload


def alternative(result: Any, page: dict[str, Any], **first_view: Any) -> dict[str, Any]:
    """Keys of the page of another result that replace those of ``page``; empty without a result."""
    if result is None:
        return {}
    other = result.page(**first_view)
    if "time" in page and other.get("time"):
        limit = len(page["time"]) or 1
        if len(other["time"]) > limit:
            indices = np.linspace(0, len(other["time"]) - 1, limit).round().astype(int)
            other = _select(other, len(other["time"]), np.unique(indices))
    plotted = {name for group in page.get("default_plots", ()) for name in group}
    payload = {key: other[key] for key in CHANGING[page["kind"]] if key in other}
    if "series" in payload and "states" not in payload:
        payload["series"] = [s for s in payload["series"] if s["name"] in plotted]
    payload["parameters"] = other.get("parameters", [])
    return payload
