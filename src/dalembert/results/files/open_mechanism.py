"""The page of a mechanism that cannot be assembled: where it was given, where it gets, the gap."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.absolute import at_ground
from dalembert.model.assembly.failure import OpenPosition
from dalembert.report.page import write_page
from dalembert.results.files.contents import Contents
from dalembert.results.files.page_parts import diagnosis, parameter_rows
from dalembert.results.pictures.scene import is_spatial, motion_scene, standing
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.text.spelling import spelled

GUESS, BEST = np.array([0]), np.array([1])


@spelled
def assembly_report(error: AssemblyError, path: str | Path) -> Path:
    """Write a page that draws why a mechanism cannot be assembled; returns its path.

    Parameters
    ----------
    error : as raised by ``build()``
    path : of the HTML file

    Raises
    ------
    FileError
        It cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("too short")
    >>> bar = system.add(planar.Bar("bar", length=1.0))
    >>> a = system.add(planar.Revolute("A", system.ground.center, bar.start))
    >>> b = system.add(planar.Revolute("B", system.ground.point(2, 0), bar.end))
    >>> try:
    ...     model = system.build()
    ... except da.AssemblyError as error:
    ...     with tempfile.TemporaryDirectory() as folder:
    ...         page = da.assembly_report(error, f"{folder}/why.html").name
    >>> page
    'why.html'
    """
    return write_page(open_payload(error), path)


def open_payload(error: AssemblyError) -> dict[str, Any]:
    """What the page shows, as plain data."""
    found: OpenPosition = error.position
    drawn: Any = _Drawn(found)
    scene = motion_scene(drawn, BEST, loads=False)
    guess = motion_scene(drawn, GUESS, loads=False)["bodies"]
    scene["ghosts"] = [standing(body, 0) for body in guess]
    if found.ends is not None:
        start, end = found.ends.tolist()
        scene["gaps"] = [{"from": start, "to": end, "text": found.gap}]
    parameters = found.parts.parameters
    loop = "–".join(found.loop) or "none"
    items = [("stays open", found.joint), ("gap", found.gap), ("loop", loop)]
    return {
        "format": 1,
        "kind": "spatial" if is_spatial(found.parts) else "mechanism",
        "title": found.parts.name,
        "subtitle": "cannot be assembled: the best position, and faint where it was given",
        "time": [found.time],
        "scene": scene,
        "series": [],
        "events": [],
        "diagnosis": diagnosis("cannot be assembled", items, [("error", str(error))]),
        "statistics": [],
        "parameters": parameter_rows(parameters, found.parameters),
    }


class _Drawn:
    """Two instants, the guess and the best position, as the drawing of a motion sees them."""

    def __init__(self, found: OpenPosition):
        self.found, d = found, found.parts
        self.parameters = found.parameters
        self._p = d.space.symbols
        self._y = stack(group.pose for group in d.coordinates)
        self.model = SimpleNamespace(
            parts=d,
            bodies=d.bodies,
            constraints=d.constraints,
            forces=d.forces,
            equations=SimpleNamespace(p=self._p),
        )
        width = 3 if is_spatial(d) else 2
        sizes = {
            "position": (width, "axis"),
            "euler_parameters": (4, "component"),
            "angle": (1, ""),
        }
        known: dict[str, Any] = {}
        for name, (size, along) in sizes.items():
            rows = [self.column(getattr(body, name, None), size) for body in d.bodies]
            dims = ("time", "body", along) if along else ("time", "body")
            known[name] = (dims, np.stack(rows, axis=1))
        self.contents = Contents.given(known, {"body": [body.name for body in d.bodies]}, {})

    def column(self, measure: Expression | None, size: int) -> np.ndarray:
        """(2,) or (2, size), zero where a body of the plane has less, else not a number."""
        table = np.full((2, size), np.nan)
        if measure is not None:
            found = self.values(measure).reshape(2, -1)
            table[:] = np.pad(found, ((0, 0), (0, size - found.shape[1])))
        return table if size > 1 else table[:, 0]

    def columns(self, measures: list[Expression]) -> list[np.ndarray]:
        """``values`` of several measures."""
        return [self.values(measure) for measure in measures]

    def values(self, measure: Expression) -> np.ndarray:
        """(2,) or (2, size) values of a measure of positions."""
        sx = ca.densify(at_ground(self.found.parts.ground, measure.sx))
        number = ca.Function("measure", [t.sx, self._y, self._p], [sx])
        poses = (self.found.guess, self.found.y)
        rows = [number(self.found.time, y, self.parameters).full().ravel() for y in poses]
        table = np.array(rows)
        return table[:, 0] if table.shape[1] == 1 else table
