"""Views of a page as plain data, drawn by ``cards.js``.

Each view is a card. Views of designs refer to the table of designs of the page and share the
selected design.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

EXPONENT = re.compile(r"(?<=\d)e-(?=\d)")
"""Exponent of a number, whose hyphen would allow a line break."""


def facts(title: str, rows: Iterable[tuple[Any, Any]], note: str = "") -> dict[str, Any]:
    """Labelled values."""
    texts = ((k, f"{v:.6g}" if isinstance(v, float) else str(v)) for k, v in rows)
    items = [{"label": str(k), "value": EXPONENT.sub("e−", text)} for k, text in texts]
    return {"kind": "facts", "title": title, "items": items, "note": note}


def notes(title: str, texts: Iterable[str]) -> dict[str, Any]:
    """A list of sentences, such as explanations and questions."""
    return {"kind": "notes", "title": title, "texts": [str(text) for text in texts]}


def bars(
    title: str, rows: Mapping[str, float], unit: str = "", note: str = "", share: bool = False
) -> dict[str, Any]:
    """A bar for each name, in descending order of magnitude; negative bars point left.

    Parameters
    ----------
    share : whether values are shares of a whole
    """
    ordered = sorted(rows.items(), key=lambda row: -abs(row[1]) if np.isfinite(row[1]) else 0.0)
    items = [{"name": name, "value": float(value)} for name, value in ordered]
    return {
        **{"kind": "bars", "title": title, "rows": items, "unit": unit},
        **{"note": note, "share": share},
    }


def histogram(
    title: str,
    label: str,
    values: np.ndarray,
    marks: Mapping[str, float],
    normal: tuple[float, float] | None = None,
    note: str = "",
) -> dict[str, Any]:
    """Histogram of values.

    Parameters
    ----------
    marks : name → value that is marked
    normal : mean and standard deviation of a normal density drawn over it, also without values
    """
    finite = np.asarray(values, dtype=float)
    finite = finite[np.isfinite(finite)]
    counts, edges = np.histogram(finite, bins="auto") if finite.size else (np.zeros(0), np.zeros(0))
    return {
        **{"kind": "histogram", "title": title, "label": label, "note": note},
        **{"counts": counts.astype(float), "edges": edges, "size": int(finite.size)},
        "marks": [{"name": name, "value": float(v)} for name, v in marks.items()],
        "normal": None if normal is None else [float(n) for n in normal],
    }


def line(name: str, x: Any, y: Any, style: str = "line", **more: Any) -> dict[str, Any]:
    """One of the ``curves``: ``"line"``, ``"dashed"``, ``"dots"``, or ``"band"`` with ``y`` and
    ``low``."""
    columns = {"x": np.asarray(x, dtype=float), "y": np.asarray(y, dtype=float)}
    return {"name": name, "style": style, **columns, **more}


def curves(
    title: str,
    x: str,
    y: str,
    lines: Sequence[Mapping[str, Any]],
    *,
    note: str = "",
    equal: bool = False,
    logarithmic: str = "",
    levels: Sequence[float] = (),
    follows: str = "",
) -> dict[str, Any]:
    """Curves and dots over one axis.

    Parameters
    ----------
    x, y : labels of the axes
    equal : equal scales of both axes
    logarithmic : ``"x"``, ``"y"`` or ``"xy"``
    levels : horizontal lines
    follows : name of a curve that is drawn for the selected design, ``lines[...]["design"]``
    """
    return {
        **{"kind": "curves", "title": title, "x": x, "y": y, "lines": list(lines), "note": note},
        **{"equal": equal, "logarithmic": logarithmic, "levels": list(levels), "follows": follows},
    }


def ellipses(
    title: str, names: Sequence[str], units: Sequence[str], centre: Any, covariance: Any, note: str
) -> dict[str, Any]:
    """Confidence ellipses of all pairs of unknowns, from their covariance."""
    return {
        **{"kind": "ellipses", "title": title, "names": list(names), "units": list(units)},
        "centre": np.asarray(centre, dtype=float),
        "covariance": [np.asarray(row, dtype=float) for row in covariance],
        "note": note,
    }


def designs(
    columns: Iterable[tuple[str, str, str, Any]],
    *,
    labels: Sequence[str] = (),
    chosen: int = 0,
    reasons: Sequence[str] = (),
    alternatives: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """The table of designs of a page.

    Parameters
    ----------
    columns : name, unit, role (``"aim"`` or ``"parameter"``) and values
    labels : of the designs; their numbers by default
    reasons : reason of failure of each design; empty for successful ones
    alternatives : parts of the page that differ per design: ``time``, ``scene``, ``series``
    """
    table = [
        {"name": name, "unit": unit, "role": role, "values": np.asarray(values, dtype=float)}
        for name, unit, role, values in columns
    ]
    return {
        **{"columns": table, "labels": list(labels), "chosen": chosen},
        **{"reasons": list(reasons), "alternatives": list(alternatives)},
    }


def of_designs(kind: str, title: str, **more: Any) -> dict[str, Any]:
    """A view of the table of designs: ``front``, ``parallel``, ``matrix`` or ``table``."""
    return {"kind": kind, "title": title, **more}
