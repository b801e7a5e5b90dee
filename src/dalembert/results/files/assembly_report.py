"""Report of a mechanism that cannot be assembled: initial guess, best position and gap."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.failure import OpenPosition
from dalembert.model.graph.model import Model
from dalembert.report.page import write_page
from dalembert.results.files.contents import Contents
from dalembert.results.files.tables import diagnosis, parameter_rows
from dalembert.results.pictures.scene import is_spatial, motion_scene, standing
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.text.arguments import check_arguments

GUESS, BEST = np.array([0]), np.array([1])


@check_arguments
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
    return write_page(assembly_payload(error), path)


def assembly_payload(error: AssemblyError) -> dict[str, Any]:
    """Payload of the page as plain data."""
    position: OpenPosition = error.position
    recording: Any = _PositionRecording(position)
    scene = motion_scene(recording, BEST, loads=False)
    guess = motion_scene(recording, GUESS, loads=False)["bodies"]
    scene["ghosts"] = [standing(body, 0) for body in guess]
    if position.ends is not None:
        start, end = position.ends.tolist()
        scene["gaps"] = [{"from": start, "to": end, "text": position.gap}]
    parameters = position.parts.parameters
    loop = "–".join(position.loop) or "none"
    items = [("open joint", position.joint), ("gap", position.gap), ("loop", loop)]
    return {
        "format": 1,
        "kind": "spatial" if is_spatial(position.parts) else "mechanism",
        "title": position.parts.name,
        "subtitle": "cannot be assembled: best position, with the initial guess in faint lines",
        "time": [position.time],
        "scene": scene,
        "series": [],
        "events": [],
        "diagnosis": diagnosis("cannot be assembled", items, [("error", str(error))]),
        "statistics": [],
        "parameters": parameter_rows(parameters, position.parameters),
    }


def position_payload(model: Model) -> dict[str, Any]:
    """Payload of a page with a mechanism at its initial position, for one whose analysis fails.

    Parameters
    ----------
    model : assembled mechanism
    """
    p = model.values(None)
    y = model.assemble(p, 0.0).y
    position = OpenPosition(model.parts, p, 0.0, y, y, "", None, "", "", ())
    recording: Any = _PositionRecording(position)
    return {
        "format": 1,
        "kind": "spatial" if is_spatial(model.parts) else "mechanism",
        "title": model.name,
        "subtitle": "initial position",
        "time": [0.0],
        "scene": motion_scene(recording, BEST, loads=False),
        "series": [],
        "events": [],
        "statistics": [],
        "parameters": parameter_rows(model.parts.parameters, p),
    }


class _PositionRecording:
    """Recording of two instants, the initial guess and the best position, for drawings."""

    def __init__(self, position: OpenPosition):
        self.position, parts = position, position.parts
        self.parameters = position.parameters
        self._p = parts.space.symbols
        self._y = stack(group.pose for group in parts.coordinates)
        self.model = SimpleNamespace(
            parts=parts,
            bodies=parts.bodies,
            constraints=parts.constraints,
            forces=parts.forces,
            equations=SimpleNamespace(p=self._p),
        )
        width = 3 if is_spatial(parts) else 2
        sizes = {
            "position": (width, "axis"),
            "euler_parameters": (4, "component"),
            "angle": (1, ""),
        }
        variables: dict[str, Any] = {}
        for name, (size, dimension) in sizes.items():
            rows = [self.column(getattr(body, name, None), size) for body in parts.bodies]
            dims = ("time", "body", dimension) if dimension else ("time", "body")
            variables[name] = (dims, np.stack(rows, axis=1))
        self.contents = Contents.from_arrays(
            variables, {"body": [body.name for body in parts.bodies]}, {}
        )

    def column(self, measure: Expression | None, size: int) -> np.ndarray:
        """(2,) or (2, size) values; missing components are zero, missing measures NaN."""
        table = np.full((2, size), np.nan)
        if measure is not None:
            values = self.values(measure).reshape(2, -1)
            table[:] = np.pad(values, ((0, 0), (0, size - values.shape[1])))
        return table if size > 1 else table[:, 0]

    def source(self, variable: str, **labels: str) -> None:
        """No variable has a formula: the picture is that of one design."""

    def drawn_contacts(self, row: int) -> None:
        """Positions have no contact forces."""

    def columns(self, measures: list[Expression]) -> list[np.ndarray]:
        """``values`` of several measures."""
        return [self.values(measure) for measure in measures]

    def values(self, measure: Expression) -> np.ndarray:
        """(2,) or (2, size) values of a measure of positions."""
        sx = ca.densify(at_ground(self.position.parts.ground, measure.sx))
        function = ca.Function("measure", [t.sx, self._y, self._p], [sx])
        poses = (self.position.guess, self.position.y)
        rows = [function(self.position.time, y, self.parameters).full().ravel() for y in poses]
        table = np.array(rows)
        return table[:, 0] if table.shape[1] == 1 else table
