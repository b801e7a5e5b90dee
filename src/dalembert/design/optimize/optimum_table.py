"""Table of an optimum for notebooks."""

from __future__ import annotations

import html
from typing import Any

from dalembert.design.bounded import Bounded


def optimum_table(optimum: Any) -> str:
    """HTML of an ``Optimum``: objective, parameters, limits and prices; names are escaped."""
    unit = html.escape(optimum.unit)
    start = optimum.history[0].objective
    rows = [_row("th", "", "unit", "lower", "start", "best", "upper", "price")]
    rows.append(_row("td", optimum.label, optimum.unit, "", start, optimum.fun, "", ""))
    for bounded in (*optimum.limits, *optimum.variables):
        rows.append(_bounded_row(bounded.shown_in((), (1.0, optimum.unit))))
    mark = "✓" if optimum.success else "✗"
    return (
        f"<div><b>{mark} {html.escape(optimum.message)}</b><table>{''.join(rows)}</table>"
        f"<small>price: what the objective{f' [{unit}]' if unit else ''} gains per unit by which "
        f"an active limit is relaxed; {optimum.runs} runs, {optimum.gradients} "
        f"gradients</small></div>"
    )


def _bounded_row(bounded: Bounded) -> str:
    def side(name: str) -> str:
        value = getattr(bounded, name)
        text = "" if value is None else f"{value:.6g}"
        return f"<b>{text}</b>" if bounded.active == name else text

    cells = [html.escape(bounded.name), html.escape(bounded.unit), side("lower")]
    cells += [f"{bounded.start:.6g}", f"{bounded.value:.6g}", side("upper")]
    cells.append(f"{bounded.price:.4g}" if bounded.active and bounded.price else "")
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _row(tag: str, *cells: str | float) -> str:
    texts = [html.escape(c) if isinstance(c, str) else f"{c:.6g}" for c in cells]
    return "<tr>" + "".join(f"<{tag}>{text}</{tag}>" for text in texts) + "</tr>"
