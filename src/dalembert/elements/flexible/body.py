"""Flexible bodies: structures reduced to shapes in a floating frame."""

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
    """A structure as a body: a floating frame, and shapes of its deformation.

    Points and frames are those of its interfaces.

    Parameters
    ----------
    structure : Structure or StructuralModel, without supports
    interface : name → nodes that move as one rigid section, or a list of single nodes
    modes : maximum number of modes between the interfaces
    up_to : upper limit of their frequencies [rad/s]
    reference : the interface in which the frame is fixed, or ``"mean"`` axes (default)
    stiffening : second-order displacements, for centrifugal stiffening; needs a frame fixed in an
        interface
    damping_ratio : ``ζ`` of every shape with the frame at rest
    rayleigh : (2,) coefficients of mass [1/s] and stiffness [s] in the damping
    parameters : values of the structure's parameters

    Raises
    ------
    ModelError
        A structure with supports or of another dimension, no interface, an unknown frame.
    """

    structure: FlexibleStructure = option("a structure without supports")
    interface: Interfaces = option("name → nodes for joints and forces")
    modes: int = option("maximum number of modes between the interfaces", default=6)
    up_to: float | None = option("upper limit of their frequencies [rad/s]", default=None)
    reference: str = option("interface in which the frame is fixed, or 'mean' axes", default="")
    stiffening: bool = option("second-order displacements", default=False)
    damping_ratio: Scalar = quantity("", "damping ratio of every shape", default=0.0, minimum=0.0)
    rayleigh: Vector = quantity(
        "1/s | s", "coefficients of mass and stiffness", default=(0.0, 0.0), size=2
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
        """Create the symbols of the frame and of ``q``."""
        raise NotImplementedError

    def _frame_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """Measures of the frame's motion."""
        raise NotImplementedError

    def guesses(self) -> tuple[list, list]:
        pose, twist = super().guesses()
        zeros = [ca.SX(0)] * self.shapes.count
        return [*pose, *zeros], [*twist, *zeros]

    def _reduce(self) -> None:
        """Compute the shapes of the structure."""
        if hasattr(self.structure, "build"):
            self.structure = self.structure.build()
        if not hasattr(self.structure, "floating"):
            raise ModelError(
                "structure must be a model of nodes and finite elements alone; got "
                f"{self.structure!r}",
                self.name,
            )
        if not self.interface:
            raise ModelError("needs an interface: nodes for joints and forces", self.name)
        self._check_options()
        self.reference = self.reference or MEAN
        values, formulas = self._parameters()
        try:
            following = self.structure.following(
                self.interface,
                self.modes,
                up_to=self.up_to,
                frame=self.reference,
                second_order=self.stiffening,
                parameters=values,
            )
        except (ModelError, AnalysisError) as error:
            raise ModelError(str(error), self.name) from None
        self.shapes, self.numbers = following.chosen, None
        self.graph = constant_shapes(self.shapes)
        if formulas:
            self.numbers = ShapeNumbers(self.name, following, values, formulas)
            self.graph = self.numbers.graph
        if self.shapes.dimension != self.dimension:
            raise ModelError(
                f"its structure has nodes of {self.shapes.dimension} coordinates; the body needs "
                f"{self.dimension}",
                self.name,
            )
        self.has_material_frame = self.reference != MEAN
        self.mass = Expression(self.graph.inertia[0, 0], f"{self.name}.mass", "kg")

    def _parameters(self) -> tuple[dict[str, float], dict[str, ca.SX]]:
        """Parameters of the structure: numbers, and formulas of parameters of the system."""
        values: dict[str, float] = {}
        formulas: dict[str, ca.SX] = {}
        for key, value in (self.parameters or {}).items():
            formula = as_expression(value, f"{self.name}.parameters[{key!r}]")
            if formula.sx.is_constant():
                values[key] = float(formula.sx)
            elif key in self.structure.parameters:
                formulas[key] = formula.sx
            else:
                names = list(self.structure.parameters)
                raise ModelError(unknown("parameter of the structure", key, names), self.name)
        return values, formulas

    def _check_options(self) -> None:
        if isinstance(self.modes, bool) or not isinstance(self.modes, int) or self.modes < 0:
            raise ModelError(f"modes must be a number of modes; got {self.modes!r}", self.name)
        if self.up_to is not None and not self.up_to > 0:
            raise ModelError(f"up_to must be a frequency [rad/s]; got {self.up_to!r}", self.name)
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
        """The coordinates ``q1``, ``q2``, …: maximum displacements of their shapes."""
        return {name: (self.q[k], "m") for k, name in enumerate(self.modal_names)}

    def _make_sections(self) -> None:
        """Create a section, and its point or frame, for every interface."""
        self.sections = {}
        for label, shapes in self.shapes.sections.items():
            section = self.section_kind(self, label, shapes)
            self._claim("point", label)
            origin = (0.0,) * self.dimension
            if self.dimension == 3 and section.rotates:
                self.frames[label] = SectionFrame(section, origin, name=label)
                self.points[label] = self.frames[label]
            else:
                self.points[label] = SectionPoint(section, origin, label)
            self.sections[label] = section

    def section(self, name: str) -> Any:
        """An interface as a body."""
        if name not in self.sections:
            names = ", ".join(self.sections)
            raise ModelError(f"no section {name!r} (known: {names})", self.name)
        return self.sections[name]

    def point(self, x, y=None, z=None) -> Point:
        """The point of an interface, ``point("tip")``."""
        if y is not None:
            raise ModelError(
                "its material moves in the frame, so that coordinates do not define a point; use "
                f"one of its interfaces: {', '.join(self.sections)}",
                self.name,
            )
        return super().point(x)

    def frame(self, place="", **axes):
        """The frame of an interface, with its axes or specified ones."""
        if isinstance(place, str) and not axes:
            return super().frame(place)
        if not isinstance(place, str):
            return self.point(*place)
        return self.section(place).frame((0.0, 0.0, 0.0), **axes)
