"""Pages of views alone, and their frame in notebooks."""

from __future__ import annotations

import html
from typing import Any


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
    notes = {"kind": "notes", "title": "Warnings", "texts": list(decision.warnings)}
    return [{**notes, "place": "board"}, *decision.views()]


def with_views(page: dict[str, Any], decision: Any, title: str) -> dict[str, Any]:
    """Page of a result, extended by the views of its decision."""
    page["title"] = f"{page['title']}: {title}"
    page["verdict"] = verdict(decision)
    page["designs"] = decision.table_of_designs()
    page["views"] = all_views(decision)
    return page


def page_frame(decision: Any, height: int = 620) -> str:
    """HTML frame with the page of a decision, for notebooks."""
    from dalembert.report.page import render_page

    page = html.escape(render_page(plain_page(decision)), quote=True)
    look = f"width:100%;height:{height}px;border:1px solid #8884;border-radius:10px"
    return f'<iframe srcdoc="{page}" style="{look}" title="Page of the decision"></iframe>'
