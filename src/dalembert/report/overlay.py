"""Two runs on one page: the second one dashed in the plots and pale behind the first one."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import FileError
from dalembert.report.packing import unpack

POSES = ("x", "y", "z", "angle", "e0", "e1", "e2", "e3")


def overlay(first: dict[str, Any], second: dict[str, Any], name: str) -> dict[str, Any]:
    """Page of the first run overlaid with the second one, at the instants of the first.

    Parameters
    ----------
    name : name of the second run

    Raises
    ------
    FileError
        The runs are of different kind or dimension, or have no common states.
    """
    first, second = unpack(first), unpack(second)
    kinds = [page.get("kind", "mechanism") for page in (first, second)]
    if kinds[0] != kinds[1]:
        raise FileError(f"only runs of the same kind can be compared, not {' and '.join(kinds)}")
    if kinds[0] == "structure":
        return _structures(first, second, name)
    if "states" in first or "states" in second:
        return _modes(first, second, name)
    time, other_time = (np.asarray(page["time"], dtype=float) for page in (first, second))
    if time.size == 0 or other_time.size == 0:
        raise FileError("one of the runs has no outputs to compare")

    def resampled(column: Any) -> list[float]:
        """Values of the second run at the instants of the first; NaN outside its time span."""
        values = np.interp(time, other_time, np.asarray(column, dtype=float), np.nan, np.nan)
        return values.tolist()

    series_by_name = {s["name"]: s for s in second["series"]}
    series = [
        s | {"other": resampled(series_by_name[s["name"]]["values"])}
        if s["name"] in series_by_name
        else s
        for s in first["series"]
    ]
    ghosts = [
        {"shapes": body["shapes"]} | {key: resampled(body[key]) for key in POSES if key in body}
        for body in second["scene"]["bodies"]
    ]
    scene = first["scene"] | {"ghosts": [*first["scene"].get("ghosts", []), *ghosts]}
    return first | {"series": series, "scene": scene, "other": name}


def _modes(first: dict[str, Any], second: dict[str, Any], name: str) -> dict[str, Any]:
    """Overlay a mechanism in its modes, which are compared by their numbers."""
    if not ("states" in first and "states" in second):
        raise FileError("modes are compared with modes, not with a motion")
    ghosts = [*first["scene"].get("ghosts", []), *second["scene"]["bodies"]]
    return first | {"scene": first["scene"] | {"ghosts": ghosts}, "other": name}


def _structures(first: dict[str, Any], second: dict[str, Any], name: str) -> dict[str, Any]:
    """Overlay the second structure behind the first one, in states of the same names."""
    if first["scene"]["dimension"] != second["scene"]["dimension"]:
        raise FileError("the structures have different dimensions")
    states, mesh = first["states"], second["scene"]["mesh"]
    displacements = dict(zip(second["states"]["names"], mesh["vertex_displacements"], strict=True))
    if not any(state in displacements for state in states["names"]):
        raise FileError(f"the runs have no common {states['kind']}")
    rest = [0.0] * len(mesh["rest"])
    moved = [displacements.get(state, rest) for state in states["names"]]
    scene = first["scene"] | {"ghosts": [{"mesh": mesh | {"vertex_displacements": moved}}]}
    return first | {"scene": scene, "other": name}
