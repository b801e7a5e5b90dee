"""What ``[synthesis]`` of a file asks: a target, and linkages to meet it."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.identification.table import read_table
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.slider_crank import SliderCrank
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.io.model_file import ModelFile
from dalembert.text.wording import unknown

LINKAGES: dict[str, type[Linkage]] = {"FourBar": FourBar, "SliderCrank": SliderCrank}
NEEDS = {
    "path": ("points",),
    "motion": ("points", "coupler_angles"),
    "function": ("crank_angles", "outputs"),
}
"""Type of a target → the columns that it must have."""
COLUMNS = ("coupler_angles", "outputs", "crank_angles")


def make_synthesis(file: ModelFile) -> dict[str, Any]:
    """The arguments of ``synthesize`` that the file gives.

    Raises
    ------
    ModelError
        No ``[synthesis]``, or a target that cannot be, with its place.
    """
    asked: Any = getattr(file.document, "synthesis", None)
    if asked is None:
        cure = 'is missing; add [synthesis] with type = "path" and points'
        raise file.located.error(cure, "synthesis")
    given = _columns(file, asked)
    for key in NEEDS[asked.type]:
        if key not in given:
            text = f"is missing; a {asked.type} needs {' and '.join(NEEDS[asked.type])}"
            raise file.located.error(text, "synthesis", key)
    linkage = LINKAGES[asked.linkage]
    for name in asked.bounds:
        if name not in linkage.names():
            text = unknown("dimension", name, linkage.names())
            raise file.located.error(text, "synthesis", "bounds", name)
    wanted = {k: v for k, v in given.items() if k in (*NEEDS[asked.type], "crank_angles")}
    try:
        target = Target(closed=asked.closed, **wanted)
    except AnalysisError as error:
        raise file.located.error(str(error), "synthesis") from None
    keys = ("crank_turns", "transmission", "order", "starts", "rng")
    bounds = {name: (float(low), float(high)) for name, (low, high) in asked.bounds.items()}
    return {
        **{"target": target, "linkage": linkage, "bounds": bounds},
        **{key: getattr(asked, key) for key in keys},
    }


def _columns(file: ModelFile, asked: Any) -> dict[str, Any]:
    """The target's columns, of the table itself or of the file it names."""
    given = {key: getattr(asked, key) for key in ("points", *COLUMNS) if getattr(asked, key)}
    if asked.file is None:
        return given
    with file.located("synthesis", "file"):
        table = read_table(str(file.path.parent / asked.file))
    if {"x", "y"} <= set(table):
        given.setdefault("points", np.column_stack([table["x"], table["y"]]))
    return {key: table[key] for key in COLUMNS if key in table} | given
