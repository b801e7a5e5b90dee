"""Synthesis tasks of a file: ``[synthesis]``."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from dalembert.design.identification.data_table import read_table
from dalembert.design.synthesis.chains import INVERSIONS, geared_five_bar, six_bar
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.mechanism_task import mechanism_task
from dalembert.design.synthesis.slider_crank import SliderCrank
from dalembert.design.synthesis.synthesize import synthesize
from dalembert.design.synthesis.synthesize_mechanism import synthesize_mechanism
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.io.decisions.design_tables import SynthesisTable
from dalembert.io.model_file import ModelFile
from dalembert.model.system import System
from dalembert.text.wording import unknown

LINKAGES: dict[str, type[Linkage]] = {"FourBar": FourBar, "SliderCrank": SliderCrank}
GEARED, OWN = "geared five-bar", "own"
KINDS = (*LINKAGES, *INVERSIONS, GEARED, OWN)
"""Kinds of linkages available in files."""
NEEDS = {
    "path": ("points",),
    "motion": ("points", "coupler_angles"),
    "function": ("crank_angles", "outputs"),
}
"""Type of a target → its required columns."""
COLUMNS = ("coupler_angles", "outputs", "crank_angles")


def make_synthesis(file: ModelFile, model: Any = None) -> partial[Any]:
    """The synthesis of ``[synthesis]`` as a function of ``progress``.

    Parameters
    ----------
    model : model of the file, if it has one

    Raises
    ------
    ModelError
        No ``[synthesis]``, or an invalid target; states the location.
    """
    table: Any = getattr(file.document, "synthesis", None)
    if table is None:
        cure = 'is missing; add [synthesis] with type = "path" and points'
        raise file.located.error(cure, "synthesis")
    target = _target(file, table)
    bounds = {name: (float(low), float(high)) for name, (low, high) in table.bounds.items()}
    shared = {key: getattr(table, key) for key in ("order", "starts", "rng")} | {"bounds": bounds}
    if table.linkage not in LINKAGES:
        return _mechanism_synthesis(file, model, table, target, shared)
    linkage = LINKAGES[table.linkage]
    for name in table.bounds:
        if name not in linkage.names():
            text = unknown("dimension", name, linkage.names())
            raise file.located.error(text, "synthesis", "bounds", name)
    own_options = {key: getattr(table, key) for key in ("crank_turns", "transmission")}
    return partial(synthesize, target, linkage, **shared, **own_options)


def _target(file: ModelFile, table: SynthesisTable) -> Target:
    columns = _columns(file, table)
    for key in NEEDS[table.type]:
        if key not in columns:
            text = f"is missing; a {table.type} needs {' and '.join(NEEDS[table.type])}"
            raise file.located.error(text, "synthesis", key)
    arguments = {k: v for k, v in columns.items() if k in (*NEEDS[table.type], "crank_angles")}
    try:
        return Target(closed=table.closed, **arguments)
    except AnalysisError as error:
        raise file.located.error(str(error), "synthesis") from None


def _mechanism_synthesis(
    file: ModelFile, model: Any, table: SynthesisTable, target: Target, shared: dict[str, Any]
) -> partial[Any]:
    """Synthesis of a named linkage or of the mechanism of the file."""
    for key in ("crank_turns", "transmission"):
        if key in table.model_fields_set:
            text = f"is for FourBar and SliderCrank; {table.linkage} turns, and has no {key}"
            raise file.located.error(text, "synthesis", key)
    if table.linkage == OWN:
        if not file.document.bodies:  # type: ignore[union-attr]
            text = 'is "own", but the file has no bodies; add them, or name a linkage'
            raise file.located.error(text, "synthesis", "linkage")
        model = file.model() if model is None else model
    else:
        with file.located("synthesis"):
            model = _linkage(table).build()
    quantities = {"point": table.point, "body": table.body, "output": table.output}
    options = {"vary": table.vary or None, "speed": table.speed}
    with file.located("synthesis"):
        mechanism_task(
            target, model, **quantities, **options, bounds=shared["bounds"], order=table.order
        )
    return partial(synthesize_mechanism, target, model, **quantities, **options, **shared)


def _linkage(table: SynthesisTable) -> System:
    """System of a six-bar or a geared five-bar."""
    joints: dict[str, Any] = {
        name: tuple(coordinates) for name, coordinates in table.joints.items()
    }
    marks: dict[str, dict[str, Any]] = {
        link: {p: tuple(xy) for p, xy in points.items()} for link, points in table.marks.items()
    }
    options = {"reach": table.reach, "speed": table.speed}
    if table.linkage != GEARED:
        return six_bar(table.linkage, joints, marks, **options)
    if table.ratio is None:
        raise AnalysisError("the gears have no ratio; give ratio, negative for two gears in mesh")
    return geared_five_bar(joints, table.ratio, marks, **options)


def _columns(file: ModelFile, table: SynthesisTable) -> dict[str, Any]:
    """Columns of the target, from the table itself or from a CSV file."""
    columns = {key: getattr(table, key) for key in ("points", *COLUMNS) if getattr(table, key)}
    if table.file is None:
        return columns
    with file.located("synthesis", "file"):
        data = read_table(str(file.path.parent / table.file))
    if {"x", "y"} <= set(data):
        columns.setdefault("points", np.column_stack([data["x"], data["y"]]))
    return {key: data[key] for key in COLUMNS if key in data} | columns
