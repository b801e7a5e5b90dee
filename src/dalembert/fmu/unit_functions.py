"""Functions and constants of a unit, from the model and its analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.contact.located_pairs import collisions_of
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.live.start import violation
from dalembert.elements.blocks.sampled import Sampled
from dalembert.errors import UnsupportedError
from dalembert.fmu.assembly_functions import start_closing, start_of, start_rows, steady_closing
from dalembert.fmu.motion_functions import MotionFunctions
from dalembert.fmu.stepping_functions import SteppingFunctions
from dalembert.model.graph.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.graph.model import Model
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates
from dalembert.model.value_limits import ValueLimit
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.columns import dense
from dalembert.symbolic.formulas.expression import Expression

EXCHANGE, STEPS = "exchange", "step"
"""Prefixes of the functions of model exchange and of co-simulation."""


@dataclass(frozen=True, eq=False)
class Problem:
    """Functions of one interface type.

    Attributes
    ----------
    prefix : of their names
    functions : name without prefix → function
    states, memory, held : numbers of states with derivatives, of others, and of held numbers
    rows : names of the equations of its positions
    """

    prefix: str
    functions: Mapping[str, ca.Function]
    states: int
    memory: int
    held: int
    rows: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class UnitFunctions:
    """All functions of a unit.

    Parameters
    ----------
    model : Model
    analysis : Dynamics with a step
    outputs : name → expression
    kinds : interface types, EXCHANGE and STEPS
    states : names of the independent coordinates of model exchange; None for an automatic choice

    Raises
    ------
    UnsupportedError
        The model or its analysis cannot run outside of Python, with the reason.
    """

    model: Model
    analysis: Dynamics
    outputs: Mapping[str, Expression]
    kinds: Sequence[str]
    states: Sequence[str] | None = None
    _columns: list[ca.SX] = field(init=False)

    def __post_init__(self) -> None:
        model = self.model
        model.closure.refuse_singular_start()
        if reason := _obstacle(model, self.kinds):
            raise UnsupportedError(f"{model.name!r} cannot be exported: {reason}")
        columns = [model.at_ground(output.sx) for output in self.outputs.values()]
        object.__setattr__(self, "_columns", columns)

    @cached_property
    def motion(self) -> MotionFunctions | None:
        """Functions of model exchange."""
        if EXCHANGE not in self.kinds:
            return None
        coordinates = closed_in(self.model)
        return MotionFunctions(self.model, coordinates, self._columns, self.states)

    @cached_property
    def stepping(self) -> SteppingFunctions | None:
        """Functions of co-simulation."""
        if STEPS not in self.kinds:
            return None
        return SteppingFunctions(self.model, self.analysis, self._columns)

    @cached_property
    def assembly(self) -> dict[str, ca.Function]:
        """Functions of the assembly, common to both interface types."""
        closure = self.model.closure
        functions = {"start_closing": start_closing(closure), "start_violation": violation(closure)}
        steady = steady_closing(closure)
        return functions if steady is None else {**functions, "steady_closing": steady}

    @cached_property
    def assembly_rows(self) -> list[str]:
        return start_rows(self.model.closure)

    @cached_property
    def limits(self) -> tuple[ca.Function | None, list[ValueLimit]]:
        """``p`` → quantities that depend on parameters, and their limits."""
        p, limits = self.model.value_limits()
        if not limits:
            return None, []
        column = ca.densify(ca.vertcat(*(limit.graph for limit in limits)))
        return ca.Function("limits", [p], [column]), limits

    @cached_property
    def exchange_problem(self) -> Problem | None:
        m = self.motion
        if m is None:
            return None
        functions = _differentiated(self.model, m.everything, m.start)
        functions |= {"rates": m.rates.function, "outputs": m.measured.function}
        if m.closed:
            functions["closing"] = m.closing
        if m.conditioning is not None:
            functions["conditioning"] = m.conditioning
        if m.indicators is not None:
            functions["indicators"] = m.indicators
        return Problem(EXCHANGE, functions, m.states.count, 0, m.held.numel(), m.rows)

    @cached_property
    def step_problem(self) -> Problem | None:
        s = self.stepping
        if s is None:
            return None
        functions = _differentiated(self.model, s.measured, s.start)
        functions |= {"outputs": s.measured.function, "terms": s.values, "": s.step}
        functions["violation"] = s.violation
        if s.conditioning is not None:
            functions["conditioning"] = s.conditioning
        if s.begin is not None:
            functions["begin"] = s.begin
        functions |= {f"sample_{due}": function for due, function in s.samples.items()}
        if self.motion is not None:
            functions["states"] = self._states_of_step(s, self.motion)
        states = s.measured.input_sizes[2]
        memory = s.variant.step.size - states
        return Problem(STEPS, functions, states, memory, 0, s.rows)

    def _states_of_step(self, s: SteppingFunctions, m: MotionFunctions) -> ca.Function:
        """``(t, –, x, p) → x, held`` of model exchange from a state of co-simulation."""
        inputs = [ca.MX.sym(n, c) for n, c in zip("thxp", s.measured.input_sizes, strict=True)]
        both, count = s.bodies(*inputs), self.model.all_equations.coordinate_count
        outputs = m.start.function.call([inputs[0], both[:count], both[count:], inputs[3]])
        return ca.Function("states", inputs, outputs)

    @property
    def problems(self) -> list[Problem]:
        return [p for p in (self.exchange_problem, self.step_problem) if p is not None]

    @cached_property
    def functions(self) -> dict[str, ca.Function]:
        """Name in C → function with dense results."""
        named = dict(self.assembly)
        if self.limits[0] is not None:
            named["limits"] = self.limits[0]
        for problem in self.problems:
            for name, function in problem.functions.items():
                named[f"{problem.prefix}_{name}".rstrip("_")] = function
        return {name: dense(function) for name, function in named.items()}

    @cached_property
    def dependencies(self) -> tuple[np.ndarray, ...]:
        """Structural dependence of rates and outputs on the time, the states and the parameters.

        By the tangent, as positions depend on states through closed loops.
        """
        function = self.motion.everything if self.motion else self._stepping.measured
        tangent = function.tangent
        patterns = (tangent.jac_sparsity(0, k) for k in (4, 6, 7))
        return tuple(np.array(ca.DM(p, 1).full() != 0) for p in patterns)

    @property
    def _stepping(self) -> SteppingFunctions:
        assert self.stepping is not None
        return self.stepping

    @property
    def state_sizes(self) -> np.ndarray:
        """Natural sizes of the states of model exchange."""
        m = self.motion
        if m is None:
            return np.zeros(0)
        s, scales = m.states, m.e.scales
        parts = [scales.coordinates[list(s.positions)], scales.speeds[list(s.speeds)]]
        sizes = np.concatenate([*parts, scales.coordinates[list(s.first_order)]])
        return np.where(sizes > 0, sizes, 1.0)


def _obstacle(model: Model, kinds: Sequence[str]) -> str:
    """Reason why a model cannot be a unit; empty if it can."""
    if model.equations.contacts:
        return "rigid contacts change during the run; use compliant contacts"
    if shapes := collisions_of(model):
        names = ", ".join(element.name for element in shapes)
        return (
            f"{names}: contacts among many shapes are not available; give a Contact with a force "
            "law for each pair"
        )
    sampled = [e for e in model.parts.elements.values() if isinstance(e, Sampled)]
    if functions := [block.name for block in sampled if block.python_law is not None]:
        return f"{', '.join(functions)}: Python functions are not; use blocks"
    if sampled and EXCHANGE in kinds:
        names = ", ".join(block.name for block in sampled)
        return (
            f"{names}: sampled blocks are not available in model exchange; give "
            "kind='cosimulation', or use continuous blocks"
        )
    if len(model.nominal) > len(model.parameters):
        return (
            "shapes of flexible bodies are computed by finite elements from parameters; give "
            "numbers in their place"
        )
    return ""


def closed_in(model: Model) -> Coordinates:
    """Coordinates of model exchange: those of joints, in which trees need no closure.

    Mass between bodies has no tree of joints; such models use absolute coordinates.
    """
    massive = any(element.own_mass for element in model.parts.elements.values())
    return AbsoluteCoordinates() if massive else JointCoordinates()


def _differentiated(
    model: Model, function: ImplicitFunction, states: ImplicitFunction
) -> dict[str, ca.Function]:
    """Derivatives of a function, and the start with its derivatives."""
    start = start_of(model, states)
    return {
        "tangent": function.tangent,
        "adjoint": function.adjoint,
        "start": start.function,
        "start_tangent": start.tangent,
        "start_adjoint": start.adjoint,
    }
