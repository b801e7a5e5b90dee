"""What ``[synthesis]`` of a file asks: a target, and mechanisms to meet it."""

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
from dalembert.io.model_file import ModelFile
from dalembert.model.system import System
from dalembert.text.wording import unknown

LINKAGES: dict[str, type[Linkage]] = {"FourBar": FourBar, "SliderCrank": SliderCrank}
GEARED, OWN = "geared five-bar", "own"
KINDS = (*LINKAGES, *INVERSIONS, GEARED, OWN)
"""What a file may look for."""
NEEDS = {
    "path": ("points",),
    "motion": ("points", "coupler_angles"),
    "function": ("crank_angles", "outputs"),
}
"""Type of a target → the columns that it must have."""
COLUMNS = ("coupler_angles", "outputs", "crank_angles")


def make_synthesis(file: ModelFile, model: Any = None) -> partial[Any]:
    """The synthesis that the file asks for: call it with ``progress``.

    Parameters
    ----------
    model : of the file, where it has one

    Raises
    ------
    ModelError
        No ``[synthesis]``, or a target that cannot be, with its place.
    """
    asked: Any = getattr(file.document, "synthesis", None)
    if asked is None:
        cure = 'is missing; add [synthesis] with type = "path" and points'
        raise file.located.error(cure, "synthesis")
    target = _target(file, asked)
    bounds = {name: (float(low), float(high)) for name, (low, high) in asked.bounds.items()}
    shared = {key: getattr(asked, key) for key in ("order", "starts", "rng")} | {"bounds": bounds}
    if asked.linkage not in LINKAGES:
        return _of_mechanism(file, model, asked, target, shared)
    linkage = LINKAGES[asked.linkage]
    for name in asked.bounds:
        if name not in linkage.names():
            text = unknown("dimension", name, linkage.names())
            raise file.located.error(text, "synthesis", "bounds", name)
    own = {key: getattr(asked, key) for key in ("crank_turns", "transmission")}
    return partial(synthesize, target, linkage, **shared, **own)


def _target(file: ModelFile, asked: Any) -> Target:
    given = _columns(file, asked)
    for key in NEEDS[asked.type]:
        if key not in given:
            text = f"is missing; a {asked.type} needs {' and '.join(NEEDS[asked.type])}"
            raise file.located.error(text, "synthesis", key)
    wanted = {k: v for k, v in given.items() if k in (*NEEDS[asked.type], "crank_angles")}
    try:
        return Target(closed=asked.closed, **wanted)
    except AnalysisError as error:
        raise file.located.error(str(error), "synthesis") from None


def _of_mechanism(
    file: ModelFile, model: Any, asked: Any, target: Target, shared: dict[str, Any]
) -> partial[Any]:
    """Of a mechanism by name, or of the file's own."""
    for key in ("crank_turns", "transmission"):
        if key in asked.model_fields_set:
            text = f"is for FourBar and SliderCrank; {asked.linkage} turns, and has no {key}"
            raise file.located.error(text, "synthesis", key)
    if asked.linkage == OWN:
        if not file.document.bodies:  # type: ignore[union-attr]
            text = 'is "own", but the file has no bodies; add them, or name a linkage'
            raise file.located.error(text, "synthesis", "linkage")
        model = file.model() if model is None else model
    else:
        with file.located("synthesis"):
            model = _named(asked).build()
    about = {"point": asked.point, "body": asked.body, "output": asked.output}
    how = {"vary": asked.vary or None, "speed": asked.speed}
    with file.located("synthesis"):
        mechanism_task(target, model, **about, **how, bounds=shared["bounds"], order=asked.order)
    return partial(synthesize_mechanism, target, model, **about, **how, **shared)


def _named(asked: Any) -> System:
    """A six-bar or a geared five-bar."""
    joints = {name: tuple(place) for name, place in asked.joints.items()}
    marks = {link: {p: tuple(xy) for p, xy in own.items()} for link, own in asked.marks.items()}
    how = {"reach": asked.reach, "speed": asked.speed}
    if asked.linkage != GEARED:
        return six_bar(asked.linkage, joints, marks, **how)
    if asked.ratio is None:
        raise AnalysisError("the gears have no ratio; give ratio, negative for two gears in mesh")
    return geared_five_bar(joints, asked.ratio, marks, **how)


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
