"""Base of the modes of structures (vibration, buckling) and their measures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, cast

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.assembled.measures import (
    Compliance,
    ExternalForce,
    Measure,
    State,
    Weights,
)
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.files.contents import Contents
from dalembert.results.modes import Numbered
from dalembert.results.structural.measured_states import MeasuredStates
from dalembert.results.structural.outputs import StructuralOutputs
from dalembert.symbolic.formulas.expression import Expression, free_symbols
from dalembert.symbolic.formulas.parser import Names
from dalembert.text.wording import counted, listed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EIGENVALUE = ca.SX.sym("eigenvalue")


@dataclass(kw_only=True)
class ModeState(State):
    """State of a mode: its shape and eigenvalue."""

    eigenvalue: float


@dataclass(kw_only=True)
class ModeWeights(Weights):
    """Weights of a mode, with that of its eigenvalue."""

    eigenvalue: float = 0.0


@dataclass
class Eigenvalue(Measure):
    """The eigenvalue of a mode."""

    def value(self, s: State) -> float:
        return cast(ModeState, s).eigenvalue

    def pull(self, s: State, weight: float, into: Weights) -> None:
        cast(ModeWeights, into).eigenvalue += weight


class EigenModes(Numbered, MeasuredStates, StructuralOutputs):
    """Eigenvalues and shapes of ``A φ = λ B φ``, scaled to ``φᵀ B φ = 1`` in SI units.

    Measures are those in ``named``, displacements of a shape such as ``"n2.uy"``, quantities of
    strained elements (from rest and to first order), and formulas of them.

    Attributes
    ----------
    shapes : (n, k) displacements; the largest entry is positive
    status : Status, with the residual of the eigenpairs
    """

    model: StructuralModel
    derived: ClassVar[dict[str, Expression]] = {}
    """Further measures of the eigenvalue, which are not reported."""

    # measures -----------------------------------------------------------------------------
    @classmethod
    def formula(cls, model: StructuralModel, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures and parameters.

        Raises
        ------
        ExpressionError
            A text with an unknown name; ``AnalysisError`` for measures that a mode does not have.
        """
        own, measures = cls.named | cls.derived, model.linearized.measures
        names = Names(
            lambda name: cls._find(model, name),
            lambda: [*own, *model.parameters, *measures.names()],
        )
        expression = names.expression(measure)
        for name in free_symbols(expression.sx) - set(model.parameters):
            cls._measure_of(model, name)
        return expression

    @classmethod
    def _find(cls, model: StructuralModel, name: str) -> Expression | None:
        own = cls.named | cls.derived
        if name in own:
            return own[name]
        if name in model.parameters:
            return model.parameters[name]
        return model.linearized.measures.find(name)

    def measure(self, name: str) -> Measure:
        return self._measure_of(self.model, name)

    @classmethod
    def _measure_of(cls, model: StructuralModel, name: str, lumped: bool = False) -> Measure:
        """The measure behind a symbol of a formula.

        Raises
        ------
        AnalysisError
            A mode does not have the measure.
        """
        if name == EIGENVALUE.name():
            return Eigenvalue()
        try:
            measure = model.linearized.measure(name)
        except KeyError:
            measure = None
        if measure is None or isinstance(measure, (ExternalForce, Compliance)):
            raise AnalysisError(
                f"a mode has no {name}; it has {', '.join(cls.named)}, displacements of nodes and "
                "quantities of elements"
            )
        return measure

    def state(self, k: int) -> ModeState:
        """A shape as displacements without loads."""
        u = self.shapes[:, k]
        first = next(iter(self.model.loads.values()))
        return ModeState(
            u,
            np.zeros_like(u),
            self.parameters,
            load_factor=0.0,
            temperatures=first.temperatures,
            eigenvalue=float(self.eigenvalues[k]),
        )

    def no_weights(self) -> ModeWeights:
        n = len(self.model.degrees)
        return ModeWeights(u=np.zeros(n), forces=np.zeros(n), p=np.zeros(self.parameters.size))

    # output -------------------------------------------------------------------------------
    kind_of_state = "mode"
    totals = ()
    of_any_size = True

    @property
    def cases(self) -> list[str]:  # type: ignore[override]
        """Number and main measure of each mode."""
        return self.state_names

    @property
    def displacements(self) -> np.ndarray:  # type: ignore[override]
        """(n, k) shapes."""
        return self.shapes

    @property
    def forces(self) -> np.ndarray:  # type: ignore[override]
        """(n, k) zeros."""
        return np.zeros_like(self.shapes)

    def case(self, name: str | int) -> int:
        """Index of a mode, from its number."""
        return self.places(np.array([name]))[0] if isinstance(name, int) else super().case(name)

    def draw(self, field: str | None = None, case: str | int = 1, **options: Any) -> Axes:
        """Draw the shape of the mode number ``case``; see ``StructuralResult.draw``."""
        return super().draw(field, case, **options)

    @cached_property
    def contents(self) -> Contents:
        shapes = {"shape": (("degree", "mode"), self.shapes, {"units": "m or rad"})}
        return super().contents.plus(shapes, {"degree": self.model.degrees.names})

    def __repr__(self) -> str:
        values = self.values(self.main)
        unit = f" {self.named[self.main].unit}".rstrip()
        count, rows = counted(len(values), "mode"), listed(f"{v:.6g}{unit}" for v in values)
        return f"<{type(self).__name__} of {self.model.name!r}: {count}, {rows}>"
