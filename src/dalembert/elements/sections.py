"""Cross-sections and materials, from which quantities of elements are computed.

Widths are along the section's z axis, heights along its y axis, viewed along the beam; every
number may be a formula of parameters. Shear areas are Cowper's classical estimates
(5/6 of a rectangle, 9/10 of a circle, the web of an I section); torsion constants by Roark,
Formulas for Stress and Strain, table 10.7.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

from dalembert.elements.base import Element
from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.functions import where
from dalembert.text.arguments import CheckedArguments, check_arguments
from dalembert.units.measured import check_measured, measured

Number = Any  # number, text of a number with its unit, or Expression


@dataclass(frozen=True)
class Section(CheckedArguments):
    """A cross-section.

    Parameters
    ----------
    area : [m²]
    second_moment_y, second_moment_z : second moments of area about its axes [m⁴]
    torsion_constant : [m⁴]
    shear_area_y, shear_area_z : for shear forces along its axes [m²]

    Examples
    --------
    >>> from dalembert import structures
    >>> box = structures.Section(area=4e-3, second_moment_y=2e-5, second_moment_z=2e-5,
    ...     torsion_constant=3e-5, shear_area_y=2e-3, shear_area_z=2e-3)
    >>> sorted(box.of(structures.Frame))
    ['area', 'second_moment']
    """

    area: Number
    second_moment_y: Number
    second_moment_z: Number
    torsion_constant: Number
    shear_area_y: Number
    shear_area_z: Number

    def __post_init__(self) -> None:
        area, bend = "m^2", "m^4"
        _read_fields(self, (area, bend, bend, bend, area, area))

    def of(self, cls: type[Element]) -> dict[str, Number]:
        """Keyword arguments for a class of elements; planar elements bend about the z axis."""
        planar = {"second_moment": self.second_moment_z, "shear_area": self.shear_area_y}
        return _arguments_for(cls, {**vars(self), **planar}, "area", "section")

    def planar_beam(self, material: Material) -> dict[str, Number]:
        """Rigidities and masses of ``planar.Beam``, which bends about the section's z axis."""
        return self._beam(material) | {
            "bending_rigidity": material.modulus * self.second_moment_z,
            "rotary_inertia": material.density * self.second_moment_z,
        }

    def spatial_beam(self, material: Material) -> dict[str, Number]:
        """Rigidities and masses of ``spatial.Beam``."""
        about_y, about_z = self.second_moment_y, self.second_moment_z
        density, modulus, shear = material.density, material.modulus, material.shear_modulus
        return self._beam(material) | {
            "shear_rigidity_z": shear * self.shear_area_z,
            "torsional_rigidity": shear * self.torsion_constant,
            "bending_rigidity_y": modulus * about_y,
            "bending_rigidity_z": modulus * about_z,
            "rotary_inertia": tuple(density * i for i in (about_y + about_z, about_y, about_z)),
        }

    def _beam(self, material: Material) -> dict[str, Number]:
        return {
            "axial_rigidity": material.modulus * self.area,
            "shear_rigidity": material.shear_modulus * self.shear_area_y,
            "mass_per_length": material.density * self.area,
        }


@dataclass(frozen=True)
class Material(CheckedArguments):
    """An isotropic elastic material.

    Parameters
    ----------
    modulus : Young's modulus [Pa]
    poisson : Poisson's ratio [-]
    density : [kg/m³]
    expansion : coefficient of thermal expansion [1/K]

    Examples
    --------
    >>> from dalembert import structures
    >>> steel = structures.Material(210e9, poisson=0.3, density=7850.0)
    >>> steel.of(structures.Truss)
    {'modulus': 210000000000.0, 'density': 7850.0, 'expansion': 0.0}
    >>> round(steel.of(structures.SpaceFrame)["shear_modulus"] / 1e9, 3)  # E/(2 (1 + ν)) [GPa]
    80.769
    """

    modulus: Number
    poisson: Number = 0.3
    density: Number = 0.0
    expansion: Number = 0.0

    def __post_init__(self) -> None:
        _read_fields(self, ("Pa", "1", "kg/m^3", "1/K"))

    @property
    def shear_modulus(self) -> Number:
        """``G = E/(2 (1 + ν))`` [Pa]."""
        return self.modulus / (2 * (1 + self.poisson))

    def of(self, cls: type[Element]) -> dict[str, Number]:
        """Keyword arguments for a class of elements."""
        values = {**vars(self), "shear_modulus": self.shear_modulus}
        return _arguments_for(cls, values, "modulus", "material")


def _arguments_for(
    cls: type[Element], values: dict[str, Number], required: str, kind: str
) -> dict[str, Number]:
    fields = [field.name for field in cls.quantity_fields()]
    if required not in fields:
        raise ModelError(f"has no {required}, so that a {kind} does not apply", cls.__name__)
    return {name: values[name] for name in fields if name in values}


@check_arguments
def rectangle(width: Number, height: Number) -> Section:
    """A solid rectangle.

    Parameters
    ----------
    width, height : lengths along its z and y axes [m], numbers or formulas

    Examples
    --------
    >>> from dalembert import structures
    >>> profile = structures.rectangle(width=0.02, height=0.05)
    >>> round(profile.area * 1e4, 9), round(profile.second_moment_z * 1e8, 6)  # cm², b h³/12 in cm⁴
    (10.0, 20.833333)
    """
    width, height = _lengths("rectangle", width=width, height=height)
    area = width * height
    long = where(width > height, width, height) if _formula(width, height) else max(width, height)
    short = where(width > height, height, width) if _formula(width, height) else min(width, height)
    slender = short / long
    twist = long * short**3 * (1 / 3 - 0.21 * slender * (1 - slender**4 / 12))
    bend_y, bend_z = height * width**3 / 12, width * height**3 / 12
    return Section(area, bend_y, bend_z, twist, 5 / 6 * area, 5 / 6 * area)


@check_arguments
def circle(diameter: Number) -> Section:
    """A solid circle.

    Parameters
    ----------
    diameter : [m], number or formula

    Examples
    --------
    >>> import math
    >>> from dalembert import structures
    >>> bar = structures.circle(0.1)
    >>> round(float(bar.second_moment_y) * 64 / math.pi, 12)  # d⁴
    0.0001
    """
    (diameter,) = _lengths("circle", diameter=diameter)
    area, bend = pi * diameter**2 / 4, pi * diameter**4 / 64
    return Section(area, bend, bend, 2 * bend, 0.9 * area, 0.9 * area)


@check_arguments
def tube(diameter: Number, wall: Number) -> Section:
    """A circular tube; shear areas of a thin wall.

    Parameters
    ----------
    diameter, wall : outer diameter and thickness [m], numbers or formulas

    Examples
    --------
    >>> import math
    >>> from dalembert import structures
    >>> pipe = structures.tube(0.1, 0.01)
    >>> round(float(pipe.area) / math.pi * 1e4, 9)  # 5² - 4² [cm²]
    9.0
    """
    diameter, wall = _lengths("tube", diameter=diameter, wall=wall)
    inner = diameter - 2 * wall
    area, bend = pi * (diameter**2 - inner**2) / 4, pi * (diameter**4 - inner**4) / 64
    return Section(area, bend, bend, 2 * bend, area / 2, area / 2)


@check_arguments
def i_section(width: Number, height: Number, flange: Number, web: Number) -> Section:
    """An I section, with the web along the height.

    Parameters
    ----------
    width, height : overall dimensions [m]
    flange, web : thicknesses [m]

    Examples
    --------
    >>> from dalembert import structures
    >>> ipe = structures.i_section(width=0.1, height=0.2, flange=0.01, web=0.006)
    >>> round(float(ipe.area) * 1e4, 9)  # two flanges of 10 × 1 cm, a web of 18 × 0.6 cm
    30.8
    """
    lengths = {"width": width, "height": height, "flange": flange, "web": web}
    width, height, flange, web = _lengths("i_section", **lengths)
    clear = height - 2 * flange
    area = 2 * width * flange + web * clear
    bend_z = (width * height**3 - (width - web) * clear**3) / 12
    bend_y = (2 * flange * width**3 + clear * web**3) / 12
    twist = (2 * width * flange**3 + (height - flange) * web**3) / 3
    return Section(area, bend_y, bend_z, twist, web * height, 5 / 3 * width * flange)


def _read(value: Number, unit: str, entity: str) -> Number:
    """The number of a text such as ``"210 GPa"`` in SI units; other values unchanged."""
    try:
        number = measured(value)
    except ExpressionError as error:
        cause = f"{error.message}; expected a number, a text such as '2 {unit}', or a formula"
        raise ExpressionError(cause, entity) from None
    check_measured([number], unit, entity)
    return number


def _read_fields(owner: Section | Material, units: tuple[str, ...]) -> None:
    for name, unit in zip(vars(owner), units, strict=True):
        number = _read(getattr(owner, name), unit, f"{type(owner).__name__}.{name}")
        object.__setattr__(owner, name, number)


def _lengths(function: str, **lengths: Number) -> list[Number]:
    return [_read(value, "m", f"{function}: {name}") for name, value in lengths.items()]


def _formula(*numbers: Number) -> bool:
    return any(not isinstance(n, (int, float)) for n in numbers)
