"""What is refused before anything is assembled."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

import casadi as ca
import numpy as np

from dalembert.budget import LARGEST
from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.coordinates import rate_of
from dalembert.errors import ExpressionError, ModelError
from dalembert.model.description import Description
from dalembert.model.rigid_gaps import rigid_gaps
from dalembert.symbolic.formulas.expression import free_symbols, refuse_unusable, stack, t

Formulas = list[tuple[str, ca.SX]]
"""Formulas with the entities they belong to."""


def check_membership(d: Description) -> None:
    """Every part an element is tied to must belong to the mechanism.

    A parameter of a structure that has the name of one of the mechanism is it by a formula only.
    """
    if not d.bodies:
        raise ModelError("has no bodies; add at least one", d.name)
    known = {id(c) for c in (*d.coordinates, d.ground)}
    for element in d.elements.values():
        for part in element.parts():
            if id(part.owner) not in known:
                raise ModelError(
                    f"is tied to {part.name!r}, which was not added to the system; "
                    f"add it with system.add(...)",
                    element.name,
                )
        for name in element.foreign_parameters():
            if name in d.parameters:
                raise ModelError(
                    f"the parameter {name!r} of its structure may be that of the system or not; "
                    f"say which by a formula or a number in its parameters={{{name!r}: ...}}",
                    element.name,
                )
        joint = getattr(element, "joint", None)
        if isinstance(joint, Constraint) and d.elements.get(joint.name) is not joint:
            raise ModelError(f"its joint {joint.name!r} was not added to the system", element.name)


def check_symbols(d: Description) -> None:
    """What formulas may depend on: lengths on parameters, joints on poses, forces on speeds."""
    parameters = set(d.parameters)
    computed = [(name, c) for name, element in d.elements.items() for c in element.computed()]
    _allow([(name, c.arguments) for name, c in computed], parameters, "")
    parameters |= _names(c.symbols for _, c in computed)
    poses = parameters | {"t"} | _names(c.pose for c in (*d.coordinates, d.ground))
    states = poses | _names(c.twist for c in (*d.coordinates, d.ground))
    lengths: Formulas = [(name, f.sx) for name, f in d.derived_parameters.items()]
    lengths += [(c.name, g) for c in d.coordinates for g in c.guesses()[0] if g is not None]
    positions: Formulas = [(c.name, c.equations) for c in d.constraints]
    efforts: Formulas = [(c.name, c.slip) for c in d.constraints]
    for element in d.elements.values():
        if isinstance(element, ForceElement):
            owners = element.parts() or d.coordinates
            taken: list[ca.SX] = []

            def rate(s: ca.SX, owners=owners, taken=taken) -> ca.SX:
                taken.append(s)
                return rate_of(s, owners, t.sx)

            efforts += [(element.name, column) for pair in element.powers(rate) for column in pair]
            positions += [(element.name, s) for s in taken]
        elif not isinstance(element, Constraint):
            lengths += [(entity, f.sx) for entity, f, _ in element.checked_quantities()]
    for gap in rigid_gaps([*d.elements.values()], d.coordinates):
        positions.append((gap.name, gap.distance))
        efforts.append((gap.name, gap.slip))
        law = gap.impact
        positions.append((gap.name, law.friction))
        lengths += [(gap.name, share) for share in (law.restitution, law.tangential)]
    _allow(positions, poses, ", positions and t")
    _refuse_bent_speeds(d)
    _allow(efforts, states, ", positions, speeds and t")
    _allow(lengths, parameters, "")


def _refuse_bent_speeds(d: Description) -> None:
    """Nonholonomic equations are linear in speeds: their forces do not depend on how fast it is."""
    twists = stack(c.twist for c in (*d.coordinates, d.ground))
    speeds: Formulas = [(constraint.name, constraint.slip) for constraint in d.constraints]
    for gap in rigid_gaps([*d.elements.values()], d.coordinates):
        speeds.append((gap.name, gap.slip))
    for entity, slip in speeds:
        if slip.numel() and ca.depends_on(ca.jacobian(slip, twists), twists):
            raise ModelError(
                "an equation of speeds must be linear in them; divide by a speed or write its root",
                entity,
            )


def _allow(formulas: Formulas, allowed: set[str], also: str) -> None:
    if free_symbols(stack(formula for _, formula in formulas)) <= allowed:
        return
    for entity, formula in formulas:
        foreign = free_symbols(formula) - allowed
        if foreign:
            raise ExpressionError(
                f"depends on {', '.join(sorted(foreign))}; only parameters of this system{also} "
                "are allowed here",
                entity,
            )


class ValueChecks:
    """Numbers of a mechanism must be finite and within their limits.

    Parameters
    ----------
    d : Description
    """

    def __init__(self, d: Description):
        known = set(d.parameters)
        self._checks: list[Callable[[np.ndarray], None]] = []
        self._allowed: list[tuple[float, float]] = []
        formulas: list[ca.SX] = []
        for element in d.elements.values():
            for entity, formula, meta in element.checked_quantities():
                if free_symbols(formula.sx) <= known:
                    self._checks.append(partial(_check_numbers, entity=entity, meta=meta))
                    formulas.append(formula.sx)
                    bounds = float(meta["minimum"]), float(meta["above"])
                    self._allowed += [bounds] * formula.sx.numel()
            for condition, wrong, *told in element.conditions():
                if free_symbols(condition) <= known:
                    n = condition.numel()
                    check = partial(_check_condition, name=element.name, wrong=wrong, count=n)
                    self._checks.append(check)
                    formulas.append(stack([condition, *told]))
                    anything = (-np.inf, -np.inf)
                    self._allowed += [(0.0, -np.inf)] * n
                    self._allowed += [anything] * (formulas[-1].numel() - n)
        self._ends = np.cumsum([f.numel() for f in formulas], dtype=int)
        symbols = stack(p.sx for p in d.parameters.values())
        self._values = ca.Function("quantities", [symbols], [stack(formulas)])

    def __call__(self, values: Sequence[float] | np.ndarray) -> None:
        """Check them at parameter values.

        Raises
        ------
        ModelError
            Names the first quantity that is wrong, with its value.
        """
        numbers = np.split(self._values(values).full().ravel(), self._ends[:-1])
        for check, found in zip(self._checks, numbers, strict=False):
            check(found)

    def doubtful(self, table: np.ndarray) -> np.ndarray:
        """(designs,) whether rows of parameter values need a look each, as most do not."""
        with np.errstate(all="ignore"):
            found = np.asarray(self._values.map(len(table))(table.T).full())
            low, above = (np.array(column)[:, None] for column in zip(*self._allowed, strict=True))
            size = np.abs(found)
            usable = (size == 0) | ((size >= 1 / LARGEST) & (size <= LARGEST))
            sound = usable & (found >= low) & (found > above)
        return ~np.all(sound, axis=0) | ~np.all(np.isfinite(table), axis=1)


def doubts_of(d: Description, values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """What elements had better be otherwise at parameter values."""
    symbols, found = d.space.symbols, []
    for element in d.elements.values():
        for condition, doubt, *told in element.warnings():
            values_of = ca.Function("doubt", [symbols], [condition, stack(told)])
            holds, numbers = (x.full().ravel() for x in values_of(values))
            if not np.all(holds >= 0):
                found.append(f"{element.name}: {doubt.format(*numbers)}")
    return tuple(found)


def _names(columns: Iterable[ca.SX]) -> set[str]:
    return {name for column in columns for name in free_symbols(column)}


def _check_condition(found: np.ndarray, name: str, wrong: str, count: int) -> None:
    if not np.all(found[:count] >= 0):
        told = found[count:]
        raise ModelError(wrong.format(*told) if told.size else wrong, name)


def _check_numbers(found: np.ndarray, entity: str, meta: Mapping) -> None:
    for number in found:
        _check_number(float(number), entity, meta)


def _check_number(number: float, entity: str, meta: Mapping) -> None:
    unit = f" {meta['unit']}" if meta["unit"] else ""
    if not math.isfinite(number):
        raise ModelError(f"its value is {number}; give a finite number", entity)
    refuse_unusable(number, entity)
    if number < meta["minimum"]:
        raise ModelError(
            f"is {number:g}{unit}, but it must not be "
            f"{'negative' if meta['minimum'] == 0 else 'below ' + str(meta['minimum'])}",
            entity,
        )
    if number <= meta["above"]:
        raise ModelError(f"is {number:g}{unit}, but it must be above {meta['above']:g}", entity)
