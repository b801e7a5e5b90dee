"""The page of an optimum: that of its best run, the first design as a ghost, and how it came."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

STILL = ("name", "node", "shapes")


def optimum_page(best: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of an ``Optimum`` shows, as plain data."""
    page = best.motion.page(**first_view)
    page["title"] = f"{page['title']}: optimum"
    page["optimum"] = {
        "label": best.label,
        "unit": best.unit,
        "start": best.history[0].objective,
        "value": best.fun,
        "success": best.success,
        "message": best.message,
        "variables": [asdict(one) for one in best.variables],
        "limits": [asdict(one) for one in best.limits],
        "prices": best.prices,
        "history": [{"objective": i.objective, "violation": i.violation} for i in best.history],
    }
    if "scene" in page and page.get("time"):
        page["scene"]["ghosts"] = _ghosts(best.initial.page(), np.array(page["time"]))
    return page


def _ghosts(first: dict[str, Any], time: np.ndarray) -> list[dict[str, Any]]:
    """Bodies of the first design at these instants; none after its run ended."""
    at = np.array(first["time"])
    made = []
    for body in first["scene"]["bodies"]:
        if not body["shapes"] or not at.size:
            continue
        columns = {k: np.array(v, dtype=float) for k, v in body.items() if k not in STILL}
        ghost = {
            k: np.interp(time, at, column, right=np.nan).tolist() if at.size > 1 else column[0]
            for k, column in columns.items()
            if column.shape == at.shape
        }
        made.append({"shapes": body["shapes"], **ghost})
    return made
