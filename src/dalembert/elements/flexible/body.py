"""What flexible bodies of the plane and of space share: a structure by shapes, and sections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Scalar, Vector, option, quantity
from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.flexible.section import Section, SectionFrame, SectionPoint
from dalembert.elements.flexible.shape_numbers import ShapeNumbers, constant_shapes
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.point import Point
from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

MEAN = "mean"
Interfaces = Mapping[str, Any] | Sequence[Any]
"""Name → nodes, or nodes."""
Numbers = Mapping[str, Any]
"""Name → value, or formula."""


@dataclass(eq=False)
class Flexible(FloatingFrame):
    """A structure as a body: a frame that floats with it, and shapes in which it deforms.

    Points and frames are those of its interfaces.

    Parameters
    ----------
    structure : StructuralModel, without supports
    interface : name → nodes that move as one rigid section, or nodes, each by itself
    modes : how many modes between the interfaces, at most
    up_to : only those up to this frequency [rad/s]
    reference : the interface in which the frame is fixed, or ``"mean"`` axes (default)
    stiffening : with displacements of second order, which make centrifugal stiffening; the frame is
        fixed in an interface
    damping_ratio : ``ζ`` of every shape with the frame at rest
    rayleigh : (2,) shares of mass [1/s] and stiffness [s] in the damping
    parameters : values of the structure's parameters

    Raises
    ------
    ModelError
        A structure with supports or of another space, no interface, an unknown frame.
    """

    structure: FlexibleStructure = option("a structure without supports")
    interface: Interfaces = option("name → nodes on which joints and forces hold")
    modes: int = option("modes between the interfaces, at most", default=6)
    up_to: float | None = option("only those up to this frequency [rad/s]", default=None)
    reference: str = option("interface that the frame is fixed in, or 'mean' axes", default="")
    stiffening: bool = option("with displacements of second order", default=False)
    damping_ratio: Scalar = quantity("", "of every shape", default=0.0, minimum=0.0)
    rayleigh: Vector = quantity(
        "1/s | s", "shares of mass and stiffness", default=(0.0, 0.0), size=2
    )
    parameters: Numbers | None = option("of the structure, values or formulas", default=None)

    section_kind = Section

    def __post_init__(self) -> None:
        super().__post_init__()
        self.initial = tuple(getattr(self, name) for name in self.initial_fields)
        self._reduce()
        self._make_pose()
        self.mass_center = self.locate(self._centre())
        self.declare(self._frame_measures() | self._modal_measures(), {})
        self._make_sections()

    def _make_pose(self) -> None:
        """Make symbols of the frame and of ``q``."""
        raise NotImplementedError

    def _frame_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Measures of the frame's motion."""
        raise NotImplementedError

    def guesses(self) -> tuple[list, list]:
        pose, twist = super().guesses()
        still = [ca.SX(0)] * self.shapes.count
        return [*pose, *still], [*twist, *still]

    def _reduce(self) -> None:
        """Take the shapes of the structure, once."""
        if not hasattr(self.structure, "floating"):
            raise ModelError(
                f"structure must be a structure that was built; got {self.structure!r}", self.name
            )
        if not self.interface:
            raise ModelError("needs an interface: nodes on which joints hold", self.name)
        self._check_options()
        self.reference = self.reference or MEAN
        given, followed = self._parameters()
        try:
            following = self.structure.following(
                self.interface,
                self.modes,
                up_to=self.up_to,
                frame=self.reference,
                second_order=self.stiffening,
                parameters=given,
            )
        except (ModelError, AnalysisError) as error:
            raise ModelError(str(error), self.name) from None
        self.shapes, self.numbers = following.chosen, None
        self.graph = constant_shapes(self.shapes)
        if followed:
            self.numbers = ShapeNumbers(self.name, following, given, followed)
            self.graph = self.numbers.graph
        if self.shapes.dimension != self.dimension:
            raise ModelError(
                f"its structure has nodes of {self.shapes.dimension} coordinates; the body needs "
                f"{self.dimension}",
                self.name,
            )
        self.tangible = self.reference != MEAN
        self.mass = Expression(self.graph.inertia[0, 0], f"{self.name}.mass", "kg")

    def _parameters(self) -> tuple[dict[str, float], dict[str, ca.SX]]:
        """Numbers, and formulas of the system's parameters, that the structure is given."""
        given: dict[str, float] = {}
        followed: dict[str, ca.SX] = {}
        for key, value in (self.parameters or {}).items():
            formula = as_expression(value, f"{self.name}.parameters[{key!r}]")
            if formula.sx.is_constant():
                given[key] = float(formula.sx)
            elif key in self.structure.parameters:
                followed[key] = formula.sx
            else:
                known = list(self.structure.parameters)
                raise ModelError(unknown("parameter of the structure", key, known), self.name)
        return given, followed

    def _check_options(self) -> None:
        if isinstance(self.modes, bool) or not isinstance(self.modes, int) or self.modes < 0:
            raise ModelError(f"modes is a count; got {self.modes!r}", self.name)
        if self.up_to is not None and not self.up_to > 0:
            raise ModelError(f"up_to is a frequency [rad/s]; got {self.up_to!r}", self.name)
        if not isinstance(self.reference, str) or not isinstance(self.stiffening, bool):
            raise ModelError(
                "reference is the name of an interface or 'mean', stiffening True or False; got "
                f"{self.reference!r} and {self.stiffening!r}",
                self.name,
            )

        if self.stiffening and self.reference in ("", MEAN):
            raise ModelError(
                "second-order displacements need a frame that is fixed in an interface; with "
                "stiffening give reference= the name of one",
                self.name,
            )

    def foreign_parameters(self) -> list[str]:
        return [name for name in self.structure.parameters if name not in (self.parameters or {})]

    def computed(self) -> list[ComputedNumbers]:
        return [self.numbers] if self.numbers else []

    @property
    def modal_names(self) -> tuple[str, ...]:
        """Names of the coordinates ``q``."""
        return tuple(f"q{k + 1}" for k in range(self.shapes.count))

    def _modal_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """The coordinates ``q1``, ``q2``, …: largest displacements of their shapes."""
        return {name: (self.q[k], "m") for k, name in enumerate(self.modal_names)}

    def _make_sections(self) -> None:
        """Name a section, and its point or frame, for every interface."""
        self.sections = {}
        for label, shapes in self.shapes.sections.items():
            section = self.section_kind(self, label, shapes)
            self._claim("point", label)
            zero = (0.0,) * self.dimension
            if self.dimension == 3 and section.rotates:
                self.frames[label] = SectionFrame(section, zero, name=label)
                self.points[label] = self.frames[label]
            else:
                self.points[label] = SectionPoint(section, zero, label)
            self.sections[label] = section

    def section(self, name: str) -> Any:
        """An interface as a body: what turns with it holds on it."""
        if name not in self.sections:
            known = ", ".join(self.sections)
            raise ModelError(f"no section {name!r} (known: {known})", self.name)
        return self.sections[name]

    def point(self, x, y=None, z=None) -> Point:
        """The point of an interface, ``point("tip")``."""
        if y is not None:
            raise ModelError(
                "its matter moves in the frame, so that coordinates are no point of it; take one "
                f"of its interfaces: {', '.join(self.sections)}",
                self.name,
            )
        return super().point(x)

    def frame(self, place="", **axes):
        """The frame of an interface, with other axes where they are given."""
        if isinstance(place, str) and not axes:
            return super().frame(place)
        if not isinstance(place, str):
            return self.point(*place)
        return self.section(place).frame((0.0, 0.0, 0.0), **axes)
