"""Model of a mechanism: symbolic equations, a consistent initial state and a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from time import perf_counter

import casadi as ca
import numpy as np

from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.model.graph.absolute import absolute_equations, at_ground, inertia_of, with_rotors
from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.guesses import AssembledState, Guesses
from dalembert.model.graph.checks import value_checks
from dalembert.model.graph.description import Description
from dalembert.model.graph.diagnosis import Diagnosis, diagnose
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.natural_units import scales_of
from dalembert.model.graph.scales import Scales
from dalembert.model.value_limits import ValueChecks, ValueLimit
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.kernel import SELDOM, condensed
from dalembert.symbolic.formulas.declared import parameter_table
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import card, messages, table

SYSTEM_MEASURES = {
    "time": "s",
    "kinetic_energy": "J",
    "potential_energy": "J",
    "energy": "J",
    "dissipated_power": "W",
    "input_power": "W",
}


class Model(ParametricModel):
    """A mechanism, checked, assembled and immutable; created by ``System.build``.

    Parameters
    ----------
    parts : Description of the mechanism
    all_equations : Equations with all constraint rows
    closure : assembly of the mechanism
    diagnosis : Diagnosis
    build_time : time to build the model [s]

    Attributes
    ----------
    equations : Equations with independent constraint rows
    parameters : name → Parameter
    nominal : (n,) their values, and numbers computed from them

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> length = system.parameter("length", 0.5, "m")
    >>> bob = system.add(planar.Bar("bob", length=length, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> model = system.build()
    >>> isinstance(model, da.Model), model.diagnosis.summary, list(model.parameters)
    (True, '1 degree of freedom', ['length'])
    >>> "bob.angle" in model.measure_names
    True
    """

    kind = "mechanism"

    def __init__(
        self,
        parts: Description,
        all_equations: Equations,
        closure: Closure,
        diagnosis: Diagnosis,
        build_time: float,
    ):
        self.parts = parts
        self.name, self.description = parts.name, parts.description
        self.parameters, self.derived_parameters = parts.parameters, parts.derived_parameters
        self.declared_outputs = parts.outputs
        self.bodies, self.ground = parts.bodies, parts.ground
        self.constraints, self.forces = parts.constraints, parts.forces
        self.coordinates = parts.coordinates
        self.all_equations, self.closure = all_equations, closure
        self.equations = all_equations.with_rows(closure.rows)
        self.nominal, self.diagnosis, self.build_time = closure.nominal, diagnosis, build_time

    @classmethod
    def assembled(cls, parts: Description, strict: bool = False) -> Model:
        """The model of a description.

        Parameters
        ----------
        parts : Description of the mechanism
        strict : refuse inconsistent initial speeds instead of projecting them

        Raises
        ------
        ModelError, AssemblyError
            The mechanism is incomplete or contradictory, or cannot be assembled.
        """
        begin = perf_counter()
        nominal = parts.space.complete(np.array([p.value for p in parts.parameters.values()]))
        guesses, equations = Guesses.collect(parts), absolute_equations(parts)
        equations = replace(
            equations,
            scales=scales_of(parts, equations, guesses, nominal),
            massless=_massless(parts, equations, guesses.values(nominal)[0], nominal),
        )
        closure = Closure(parts, equations, guesses, nominal, strict)
        mass = equations.mass_at(closure.start.y, nominal)  # those of rotors may vary
        diagnosis = diagnose(parts, closure, mass)
        return cls(parts, equations, closure, diagnosis, perf_counter() - begin)

    @property
    def guesses(self) -> Guesses:
        """Names, units and owners of the coordinates."""
        return self.closure.guesses

    @property
    def scales(self) -> Scales:
        """Natural units of the mechanism."""
        return self.all_equations.scales

    @property
    def start(self) -> AssembledState:
        """Assembled state at the nominal parameters."""
        return self.closure.start

    @property
    def initial_state(self) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)``."""
        return self.closure.initial_state

    @property
    def equation_names(self) -> list[str]:
        """Names of all constraint equations, ``joint[component]``."""
        return [f"{constraint.name}[{k}]" for constraint, k in self.closure.owners]

    def assemble(self, p: np.ndarray, time: float = 0.0) -> AssembledState:
        """Consistent initial state for parameter values ``p``, on the branch of the nominal one.

        Raises
        ------
        AssemblyError
            Names the worst joint and its residual.
        """
        return self.closure.assemble(p, time)

    def check_values(self, p: np.ndarray) -> None:
        self._value_checks(p[: len(self.parameters)])

    def value_limits(self) -> tuple[ca.SX, list[ValueLimit]]:
        limits = self._value_checks.limits
        return self.equations.p, [limit for limit in limits if ca.symvar(limit.graph)]

    def unverified(self, table: np.ndarray) -> np.ndarray:
        """(designs,) rows of parameter values that must be checked by ``check_values``."""
        return self._value_checks.unverified(table)

    def completed(self, p: np.ndarray) -> np.ndarray:
        return self.parts.space.complete(p)

    def tangents(self, p: np.ndarray, columns: Sequence[int]) -> np.ndarray:
        return self.parts.space.tangents(p, columns)

    def parameter_gradients(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
        return self.parts.space.parameter_gradients(p, gradients)

    def shapes(self, body: FloatingFrame, p: np.ndarray) -> FloatingShapes:
        """The shapes of a flexible body at parameter values."""
        if body.numbers is None:
            return body.shapes
        return body.numbers.shapes(self.parts.space.arguments(p, body.numbers))

    @cached_property
    def _value_checks(self) -> ValueChecks:
        return value_checks(self.parts)

    def mass_matrix(self, p: np.ndarray) -> np.ndarray:
        """``M`` for parameter values ``p``."""
        return self.all_equations.mass_at(self.start.y, p).toarray()

    # access ------------------------------------------------------------------------
    def expression(self, measure: str | Expression) -> Expression:
        """See ``ParametricModel``; the ground is at rest in the result."""
        valid = isinstance(measure, (str, Expression))
        return self._expression(measure) if valid else super().expression(measure)

    @once
    def _expression(self, measure: str | Expression) -> Expression:
        expression = super().expression(measure)
        return self._grounded(expression) if isinstance(measure, Expression) else expression

    @once
    def function(self, *measures: Expression) -> ca.Function:
        """``(t, y, v, a, λ of all equations, p) → measures``, stacked.

        The forces of rigid contacts follow ``λ``.
        """
        e = self.all_equations
        column = ca.vertcat(*(ca.densify(self._grounded(m).sx) for m in measures))
        inputs = [e.t, e.y, e.v, e.a, e.transmitted, e.p]
        return condensed("measures", inputs, [column], SELDOM)

    def _all_names(self) -> list[str]:
        return [*self.measure_names, *self.parameters, *self.derived_parameters]

    @once
    def _measure(self, name: str) -> Expression | None:
        measure = self._system_measure(name)
        if measure is None:
            measure = self.parts.lookup(name)
        return self._grounded(measure) if isinstance(measure, Expression) else measure

    def _grounded(self, measure: Expression) -> Expression:
        return Expression(self.at_ground(measure.sx), measure.name, measure.unit)

    def at_ground(self, expression: ca.SX) -> ca.SX:
        """The expression with the ground at rest at the origin."""
        return at_ground(self.parts.ground, expression)

    def all_multipliers(self, independent: np.ndarray) -> np.ndarray:
        """(M, K) multipliers of every equation, zero for redundant ones, from (m, K)."""
        full = np.zeros((len(self.closure.owners), independent.shape[1]))
        full[self.closure.rows] = independent
        return full

    def _system_measure(self, name: str) -> Expression | None:
        e = self.all_equations
        if name not in SYSTEM_MEASURES:
            return None
        sx = {
            "time": lambda: e.t,
            "kinetic_energy": lambda: e.kinetic_energy,
            "potential_energy": lambda: e.potential,
            "energy": lambda: e.kinetic_energy + e.potential,
            "dissipated_power": lambda: e.powers[0],
            "input_power": lambda: e.powers[1],
        }[name]()
        return Expression(sx, name, SYSTEM_MEASURES[name])

    @cached_property
    def measure_names(self) -> list[str]:
        """Names of all measures."""
        return [*SYSTEM_MEASURES, *self.parts.measure_names()]

    def __repr__(self) -> str:
        return f"<Model {self.name!r}: {self.diagnosis.summary}>"

    def _repr_html_(self) -> str:
        diagnosis = self.diagnosis
        tables = (table(diagnosis.rows), parameter_table(self.parameters))
        return card(f"Model {self.name}", diagnosis.summary, messages(diagnosis.messages), *tables)


def _massless(parts: Description, e: Equations, y: np.ndarray, p: np.ndarray) -> tuple[int, ...]:
    """Speeds without mass; a rotor gives a body inertia about one axis only."""
    driven = with_rotors(parts)
    mass = inertia_of(parts, e.v, driven)[0] if driven else e.mass
    diagonal = ca.Function("diagonal", [e.y, e.p], [ca.densify(ca.diag(mass))])(y, p).full()
    return tuple(int(k) for k in np.flatnonzero(diagonal == 0))
