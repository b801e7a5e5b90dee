"""Rayleigh damping of structures."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.elements.base import Scalar
from dalembert.errors import ModelError
from dalembert.model.assembled.model import StructuralModel
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import free_symbols
from dalembert.symbolic.parametric_array import ArrayEntries, ParametricArray
from dalembert.text.arguments import CheckedArguments


@dataclass(frozen=True, eq=False)
class Rayleigh(CheckedArguments):
    """Proportional damping, ``C = α M + β K`` with the stiffness ``K`` at rest (Rayleigh 1877).

    A mode of angular frequency ``ω`` has the damping ratio ``(α/ω + β ω)/2``.

    Parameters
    ----------
    mass : ``α`` [1/s], number or formula of parameters
    stiffness : ``β`` [s], likewise

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("oscillator")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=100.0))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=1.0))
    >>> bar.support(a)
    >>> bar.initial(b, ux=1.0)
    >>> damping = da.Rayleigh(mass=0.5, stiffness=0.005)  # α/(2 ω) + β ω/2 = 0.05
    >>> motion = da.solve_transient(bar.build(), 0.2 * math.pi, step=1e-3, damping=damping)
    >>> round(-math.log(motion["b.ux"][-1]) / (2 * math.pi), 3)  # after a period
    0.05
    """

    mass: Scalar = 0.0
    stiffness: Scalar = 0.0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rayleigh) and self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @property
    def _identity(self) -> tuple[object, ...]:
        """Numbers by their values, formulas by the object."""
        terms = self.mass, self.stiffness
        return tuple(term if isinstance(term, (float, int)) else id(term) for term in terms)

    def coefficients(self, model: StructuralModel) -> ParametricArray:
        """``(α, β)`` as functions of the model's parameters.

        Raises
        ------
        ModelError
            A formula of other names.
        """
        entries = ArrayEntries(2)
        for k, name in enumerate(("mass", "stiffness")):
            coefficient = as_expression(getattr(self, name), f"Rayleigh.{name}")
            foreign = free_symbols(coefficient.sx) - set(model.parameters)
            if foreign:
                raise ModelError(
                    f"depends on {', '.join(sorted(foreign))}, no parameters of {model.name}",
                    f"Rayleigh.{name}",
                )
            entries.add(k, coefficient)
        return entries.array(model.p)
