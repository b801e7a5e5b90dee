"""Variables of a unit: parameters, inputs, outputs, states and their rates."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.wording import unknown

FIXED, TUNABLE, INPUT = "f", "t", "u"
"""Kinds of parameters: constant after the start, changed at any time, input."""


TIME = 0
"""Value reference of the time."""


@dataclass(frozen=True)
class Variable:
    """A real variable of the unit.

    Attributes
    ----------
    name, unit, description : unit in SI
    reference : its value reference
    causality, variability, initial : as in FMI
    start, minimum, maximum : numbers, None without one
    display_unit : in which a user declared it
    derivative : value reference of the state whose rate it is
    """

    name: str
    unit: str
    reference: int
    causality: str
    variability: str = "continuous"
    initial: str = ""
    description: str = ""
    start: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    display_unit: str = ""
    derivative: int | None = None


@dataclass(frozen=True, eq=False)
class Variables:
    """Variables of a unit in the order of their value references.

    Attributes
    ----------
    parameters : (np,) of the vector ``p``
    outputs, states, rates, indicators : computed variables
    kinds : for each parameter, FIXED, TUNABLE or INPUT
    """

    parameters: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    states: tuple[Variable, ...]
    rates: tuple[Variable, ...]
    indicators: tuple[Variable, ...]
    kinds: str

    @property
    def all(self) -> list[Variable]:
        time = Variable("time", "s", TIME, "independent", description="simulation time")
        computed = (*self.outputs, *self.states, *self.rates, *self.indicators)
        return [time, *self.parameters, *computed]


def variables_of(
    model: Model,
    inputs: Iterable[str],
    outputs: Mapping[str, Expression],
    states: Sequence[tuple[str, str]],
    indicators: int,
) -> Variables:
    """Variables of a model.

    Parameters
    ----------
    inputs : names of the parameters that are inputs
    outputs : name → expression of the bodies
    states : name and unit of each state of model exchange
    indicators : number of event indicators

    Raises
    ------
    UnsupportedError
        Unknown inputs, or inputs in joints, whose rates a unit does not know.
    """
    kinds = _kinds(model, list(inputs))
    first = 1 + len(model.parameters)
    parameters = [
        _parameter(parameter, 1 + k, kind)
        for k, (parameter, kind) in enumerate(zip(model.parameters.values(), kinds, strict=True))
    ]
    taken = {"time", *model.parameters}
    own = [
        Variable(_free(name, taken), e.unit, first + k, "output", initial="calculated")
        for k, (name, e) in enumerate(outputs.items())
    ]
    first += len(own)
    names = [_free(name, taken) for name, _ in states]
    at_state = [
        Variable(name, unit, first + k, "local", initial="calculated")
        for k, (name, (_, unit)) in enumerate(zip(names, states, strict=True))
    ]
    first += len(at_state)
    rates = [
        Variable(
            _free(f"der({s.name})", taken),
            per_second(s.unit),
            first + k,
            "local",
            initial="calculated",
            derivative=s.reference,
        )
        for k, s in enumerate(at_state)
    ]
    first += len(rates)
    switches = [
        Variable(_free(f"switch {k + 1}", taken), "", first + k, "local", initial="calculated")
        for k in range(indicators)
    ]
    columns = (tuple(parameters), tuple(own), tuple(at_state), tuple(rates), tuple(switches))
    return Variables(*columns, kinds)


def per_second(unit: str) -> str:
    """Unit of the rate of a quantity: ``m/s^2`` for ``m/s``."""
    if unit in ("", "1"):
        return "1/s"
    return f"{unit[:-2]}/s^2" if unit.endswith("/s") else f"{unit}/s"


def _free(name: str, taken: set[str]) -> str:
    """A name that no other variable has."""
    while name in taken:
        name = f"state.{name}" if not name.startswith("state.") else f"{name}_"
    taken.add(name)
    return name


def _kinds(model: Model, inputs: list[str]) -> str:
    e = model.all_equations
    for name in inputs:
        if name not in model.parameters:
            raise UnsupportedError(unknown("input", name, model.parameters))
    joints = ca.veccat(e.constraints, ca.densify(e.nonholonomic))
    rows, columns = ca.jacobian_sparsity(joints, e.p).get_triplet()
    owners = model.closure.owners
    equation = dict(zip(columns[::-1], rows[::-1], strict=True))
    kinds = ""
    for k, name in enumerate(model.parameters):
        if k in equation and name in inputs:
            joint = owners[equation[k] % len(owners)][0].name
            raise UnsupportedError(
                f"input {name!r} is in the equations of {joint!r}, which need its rates, too; "
                "leave it out of inputs=[...], so that it is a fixed parameter"
            )
        kinds += INPUT if name in inputs else FIXED if k in equation else TUNABLE
    return kinds


def _parameter(parameter: Parameter, reference: int, kind: str) -> Variable:
    lower, upper = (b if math.isfinite(b) else None for b in parameter.bounds)
    return Variable(
        parameter.name,
        parameter.unit,
        reference,
        "input" if kind == INPUT else "parameter",
        {FIXED: "fixed", TUNABLE: "tunable", INPUT: "continuous"}[kind],
        "" if kind == INPUT else "exact",
        parameter.description,
        parameter.value,
        lower,
        upper,
        parameter.declared_unit if parameter.declared_unit != parameter.unit else "",
    )
