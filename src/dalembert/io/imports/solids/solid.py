"""Rigid bodies of solids: volume, mass centre, moments, place; their model file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import ModelError
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.names import Names
from dalembert.io.imports.robots.pose import tidy
from dalembert.io.omission import Omission
from dalembert.text.wording import visible
from dalembert.units.measured import check_measured, measured

DENSITY = 7850.0
"""Default density: steel [kg/m³]."""
DIGITS = 12
"""Significant digits of volumes and moments."""
NEGLIGIBLE = 1e-12
"""Threshold of products of inertia relative to the largest moment below which they are zero."""
HEADING = """\
Rigid bodies of the solids in {name}. No joints connect them yet:
add [joints] between frames of the bodies, or between a body and the ground."""
ASSUMED = "assumed: steel; the file states no density"


@dataclass(frozen=True, eq=False)
class Solid:
    """A homogeneous solid in a frame of its own.

    Attributes
    ----------
    name : in the file
    place : file and entity, for messages
    volume : [m³]
    center : (3,) centroid in its frame [m]
    moments : (3, 3) moments of inertia per density about the centroid [m⁵]
    position : (3,) origin of its frame [m]
    axes : (3, 3) axes of its frame as columns
    surface : mesh for pictures, with the length of its unit [m]
    """

    name: str
    place: str
    volume: float
    center: np.ndarray
    moments: np.ndarray
    position: np.ndarray = field(default_factory=lambda: np.zeros(3))
    axes: np.ndarray = field(default_factory=lambda: np.eye(3))
    surface: tuple[Path, float] | None = None

    def __post_init__(self) -> None:
        numbers = np.concatenate([self.center, self.moments.ravel(), self.position])
        if not (math.isfinite(self.volume) and self.volume > 0 and np.isfinite(numbers).all()):
            raise ModelError(
                f"has the volume {self.volume:g} m^3; export a closed solid", self.place
            )

    def table(self) -> dict[str, Any]:
        """The body of a model file, with masses by the parameter ``density``."""
        diagonal = list(np.diag(self.moments))
        products = [self.moments[0, 1], self.moments[1, 2], self.moments[0, 2]]
        if max(map(abs, products)) > NEGLIGIBLE * max(diagonal):
            diagonal += products
        table: dict[str, Any] = {"type": "Body"}
        if self.surface is not None:
            table |= {"type": "Mesh", "file": self.surface[0], "scale": self.surface[1]}
        table["mass"] = f"density*{self.volume:.{DIGITS}g} m^3"
        table["inertia"] = [f"density*{value:.{DIGITS}g} m^5" for value in diagonal]
        table["center_of_mass"] = _rounded(self.center)
        if self.position.any():
            table["position"] = _rounded(self.position)
        if not np.allclose(self.axes, np.eye(3), rtol=0, atol=1e-14):
            table["rotation"] = {"type": "from_matrix", "rows": [tidy(row) for row in self.axes]}
        return table


def _rounded(values: np.ndarray) -> list[float]:
    """Coordinates without digits that come from rounding."""
    smallest = 1e-14 * max(np.abs(values).max(initial=0.0), 1e-3)
    return [float(f"{v:.{DIGITS}g}") if abs(v) > smallest else 0.0 for v in values.tolist()]


def imported_solids(
    path: Path,
    solids: Sequence[Solid],
    density: float | str | None,
    mass: float | str | None,
    omissions: list[Omission],
) -> Imported:
    """The model of solids.

    Parameters
    ----------
    density : [kg/m³]
    mass : of all solids together, in place of the density [kg]

    Raises
    ------
    ModelError
        No solids; density and mass; a number that is not above 0.
    """
    if not solids:
        raise ModelError("has no solid; export closed solids, not surfaces or lines", str(path))
    bodies: dict[str, Any] = {}
    names = Names.of_parts()
    names.used.add("density")
    for solid in solids:
        bodies[names.add(solid.name)] = solid.table()
    value = density_of(density, mass, sum(solid.volume for solid in solids))
    return _imported(path, bodies, value, density is None and mass is None, omissions)


def imported_file(
    path: Path, scale: float, density: float | str | None, mass: float | str | None, volume: float
) -> Imported:
    """The model of one body whose shape is a file of a mesh.

    Parameters
    ----------
    scale : length of the unit of the file [m]
    volume : [m³]
    """
    name = Names.of_parts().add(path.stem)
    name = "part" if name == "density" else name
    table: dict[str, Any] = {"type": "Mesh", "file": path.absolute(), "scale": scale}
    value = density_of(density, mass, volume)
    bodies = {name: table | {"density": "density"}}
    return _imported(path, bodies, value, density is None and mass is None, [])


def density_of(density: float | str | None, mass: float | str | None, volume: float) -> float:
    """The density that options state [kg/m³]."""
    if density is not None and mass is not None:
        raise ModelError("give density or mass, not both", "density")
    if mass is not None:
        return _positive(mass, "kg", "mass") / volume
    return _positive(DENSITY if density is None else density, "kg/m^3", "density")


def _positive(value: float | str, unit: str, name: str) -> float:
    number = measured(value)
    check_measured([number], unit, name)
    if not (math.isfinite(float(number)) and float(number) > 0):
        raise ModelError(f"is {value}; give a number above 0", name)
    return float(number)


def length_of(unit: str, option: str = "unit") -> float:
    """Length of a unit [m]."""
    number = measured(f"1 {unit}")
    check_measured([number], "m", option)
    return float(number)


def _imported(
    path: Path, bodies: dict[str, Any], density: float, assumed: bool, omissions: list[Omission]
) -> Imported:
    about = {"value": density, "unit": "kg/m^3", "description": "density of all bodies"}
    document = {
        "format": 1,
        "name": visible(path.stem),
        "gravity": [0.0, 0.0, -9.81],
        "parameters": {"density": about},
        "bodies": bodies,
        "analysis": {"type": "Dynamics", "duration": 1.0, "outputs": 101},
    }
    comments = {"": HEADING.format(name=path.name)}
    if assumed:
        comments["parameters.density"] = ASSUMED
    return Imported(path, document, omissions, comments)
