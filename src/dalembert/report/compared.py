"""Two runs on one page: the second one dashed in the plots, and pale behind the first one."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import FileError
from dalembert.report.packing import unpacked

POSES = ("x", "y", "z", "angle", "e0", "e1", "e2", "e3")


def compared(first: dict[str, Any], second: dict[str, Any], name: str) -> dict[str, Any]:
    """The page of the first run with the second one on it, at the instants of the first.

    Parameters
    ----------
    name : what the second run is called

    Raises
    ------
    FileError
        They are of different kind or dimension, or have no states of one name.
    """
    first, second = unpacked(first), unpacked(second)
    kinds = [page.get("kind", "mechanism") for page in (first, second)]
    if kinds[0] != kinds[1]:
        raise FileError(f"two runs of one kind can be compared, not {' and '.join(kinds)}")
    if kinds[0] == "structure":
        return _structures(first, second, name)
    time, other = (np.asarray(page["time"], dtype=float) for page in (first, second))
    if time.size == 0 or other.size == 0:
        raise FileError("one of the runs has no outputs to compare")

    def moved(column: Any) -> list[float]:
        """Values of the second run at the instants of the first; NaN where it has none."""
        values = np.interp(time, other, np.asarray(column, dtype=float), np.nan, np.nan)
        return values.tolist()

    known = {s["name"]: s for s in second["series"]}
    series = [
        s | {"other": moved(known[s["name"]]["values"])} if s["name"] in known else s
        for s in first["series"]
    ]
    ghosts = [
        {"shapes": body["shapes"]} | {key: moved(body[key]) for key in POSES if key in body}
        for body in second["scene"]["bodies"]
    ]
    scene = first["scene"] | {"ghosts": [*first["scene"].get("ghosts", []), *ghosts]}
    return first | {"series": series, "scene": scene, "other": name}


def _structures(first: dict[str, Any], second: dict[str, Any], name: str) -> dict[str, Any]:
    """The second structure behind the first one, in the states of the same names."""
    if first["dimension"] != second["dimension"]:
        raise FileError("the structures are of different dimension")
    known = dict(zip(second["cases"], second["moved"], strict=True))
    if not any(case in known for case in first["cases"]):
        raise FileError(f"the runs have no {first.get('kind_of_state', 'case')} of one name")
    rest = [0.0] * len(second["drawing"]["rest"])
    moved = [known.get(case, rest) for case in first["cases"]]
    return first | {"ghost": {"drawing": second["drawing"], "moved": moved}, "other": name}
