"""What notebooks show of a thing: a title, a sentence, and tables, as HTML in their own style."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

from dalembert.text.wording import visible

COLOURS = {"info": "#5a6774", "warning": "#8a5a00", "error": "#b3261e"}


def card(title: str, sentence: str, *parts: str) -> str:
    """A title, a sentence and what comes below."""
    head = f"<b>{escaped(title)}</b> <span style='opacity:.75'>{escaped(sentence)}</span>"
    return f"<div style='margin:.4em 0'>{head}{''.join(parts)}</div>"


def table(rows: Iterable[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """Rows of cells, the first of each a name; nothing if there are none."""
    cells = [[escaped(shown(cell)) for cell in row] for row in rows]
    if not cells:
        return ""
    left = "style='text-align:left'"
    top = "".join(f"<th {left}>{escaped(name)}</th>" for name in head)
    body = "".join(
        f"<tr><th {left}>{row[0]}</th>{''.join(f'<td {left}>{c}</td>' for c in row[1:])}</tr>"
        for row in cells
    )
    return f"<table>{f'<thead><tr>{top}</tr></thead>' if top else ''}<tbody>{body}</tbody></table>"


def messages(told: Iterable[tuple[str, str]]) -> str:
    """(level, text) one below the other."""
    return "".join(
        f"<div style='color:{COLOURS.get(level, COLOURS['info'])}'>{level}: {escaped(text)}</div>"
        for level, text in told
    )


def folded(name: str, content: str) -> str:
    """What is seen when it is opened."""
    return f"<details><summary>{escaped(name)}</summary>{content}</details>"


def shown(value: Any) -> str:
    """A number or text for people."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def escaped(text: str) -> str:
    """Text that stays text."""
    return html.escape(visible(text))
