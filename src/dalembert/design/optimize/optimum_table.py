"""An optimum as a table for notebooks."""

from __future__ import annotations

import html
from typing import Any

from dalembert.design.bounded import Bounded


def optimum_table(best: Any) -> str:
    """HTML of an ``Optimum``: objective, parameters, limits and prices; all names are escaped."""
    unit = html.escape(best.unit)
    start = best.history[0].objective
    rows = [_row("th", "", "unit", "lower", "start", "best", "upper", "price")]
    rows.append(_row("td", best.label, best.unit, "", start, best.fun, "", ""))
    for one in (*best.limits, *best.variables):
        rows.append(_bounded(one.shown_in((), (1.0, best.unit))))
    mark = "✓" if best.success else "✗"
    return (
        f"<div><b>{mark} {html.escape(best.message)}</b><table>{''.join(rows)}</table>"
        f"<small>price: what the objective{f' [{unit}]' if unit else ''} gains per unit by which "
        f"an active side is let out; {best.runs} runs, {best.gradients} gradients</small></div>"
    )


def _bounded(one: Bounded) -> str:
    def side(name: str) -> str:
        value = getattr(one, name)
        text = "" if value is None else f"{value:.6g}"
        return f"<b>{text}</b>" if one.active == name else text

    cells = [html.escape(one.name), html.escape(one.unit), side("lower")]
    cells += [f"{one.start:.6g}", f"{one.value:.6g}", side("upper")]
    cells.append(f"{one.price:.4g}" if one.active and one.price else "")
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _row(tag: str, *cells: str | float) -> str:
    texts = [html.escape(c) if isinstance(c, str) else f"{c:.6g}" for c in cells]
    return "<tr>" + "".join(f"<{tag}>{text}</{tag}>" for text in texts) + "</tr>"
