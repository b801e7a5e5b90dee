"""HTML cards of notebooks: a title, a sentence and tables."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

from dalembert.text.wording import visible

COLOURS = {"info": "#5a6774", "warning": "#8a5a00", "error": "#b3261e"}


def card(title: str, sentence: str, *parts: str) -> str:
    """A title, a sentence and further HTML below."""
    head = f"<b>{escaped(title)}</b> <span style='opacity:.75'>{escaped(sentence)}</span>"
    return f"<div style='margin:.4em 0'>{head}{''.join(parts)}</div>"


def table(rows: Iterable[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """Table whose first column holds names; an empty text without rows."""
    cells = [[escaped(display_text(cell)) for cell in row] for row in rows]
    if not cells:
        return ""
    align = "style='text-align:left'"
    header = "".join(f"<th {align}>{escaped(name)}</th>" for name in head)
    body = "".join(
        f"<tr><th {align}>{row[0]}</th>{''.join(f'<td {align}>{c}</td>' for c in row[1:])}</tr>"
        for row in cells
    )
    header = f"<thead><tr>{header}</tr></thead>" if header else ""
    return f"<table>{header}<tbody>{body}</tbody></table>"


def messages(entries: Iterable[tuple[str, str]]) -> str:
    """Lines of (level, text), coloured by level."""
    return "".join(
        f"<div style='color:{COLOURS.get(level, COLOURS['info'])}'>{level}: {escaped(text)}</div>"
        for level, text in entries
    )


def folded(name: str, content: str) -> str:
    """Content that is hidden until the reader opens it."""
    return f"<details><summary>{escaped(name)}</summary>{content}</details>"


def display_text(value: Any) -> str:
    """A value as text; numbers with six digits."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def escaped(text: str) -> str:
    """Text with HTML escapes."""
    return html.escape(visible(text))
