"""A page of views alone, and how a notebook shows it."""

from __future__ import annotations

import html
from typing import Any


def plain_page(decision: Any) -> dict[str, Any]:
    """The page of a decision without a mechanism or structure beside it."""
    return {
        **{"format": 1, "kind": "decision", "title": decision.name, "subtitle": decision.sentence},
        "verdict": verdict(decision),
        "designs": decision.table_of_designs(),
        "views": all_views(decision),
    }


def verdict(decision: Any) -> dict[str, Any]:
    """How it ended, for the head of a page."""
    return {"success": decision.ok and not decision.warnings, "text": decision.sentence}


def all_views(decision: Any) -> list[dict[str, Any]]:
    """The views of a decision, its warnings before them."""
    if not decision.warnings:
        return list(decision.views())
    told = {"kind": "notes", "title": "Warnings", "texts": list(decision.warnings)}
    return [{**told, "place": "board"}, *decision.views()]


def with_views(page: dict[str, Any], decision: Any, title: str) -> dict[str, Any]:
    """The page of a run, with the views of the decision that it belongs to."""
    page["title"] = f"{page['title']}: {title}"
    page["verdict"] = verdict(decision)
    page["designs"] = decision.table_of_designs()
    page["views"] = all_views(decision)
    return page


def framed(decision: Any, height: int = 620) -> str:
    """The page of views alone in a frame, as notebooks show it."""
    from dalembert.report.page import render_page

    page = html.escape(render_page(plain_page(decision)), quote=True)
    look = f"width:100%;height:{height}px;border:1px solid #8884;border-radius:10px"
    return f'<iframe srcdoc="{page}" style="{look}" title="Page of the decision"></iframe>'
