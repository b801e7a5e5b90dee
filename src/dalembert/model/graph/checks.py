"""Validation of a description before assembly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.blocks.block import Block
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.coordinates import rate_of
from dalembert.elements.stateful import SIGNAL, Stateful
from dalembert.elements.states import foreign_states
from dalembert.errors import ExpressionError, ModelError
from dalembert.model.graph.description import Description
from dalembert.model.graph.rigid_gaps import rigid_gaps
from dalembert.model.value_limits import ValueChecks, ValueLimit
from dalembert.symbolic.formulas.expression import free_symbols, stack, t

Formulas = list[tuple[str, ca.SX]]
"""Formulas with the entities they belong to."""


def check_membership(d: Description) -> None:
    """Check that every part an element refers to belongs to the mechanism.

    A parameter of a structure is that of the mechanism of the same name only by a formula.
    """
    if not d.coordinates:
        raise ModelError("has no bodies; add at least one", d.name)
    members = {id(c) for c in (*d.coordinates, d.ground)}
    for element in d.elements.values():
        for part in element.parts():
            if id(part.owner) not in members:
                raise ModelError(
                    f"is tied to {part.name!r}, which was not added to the system; "
                    "add it with system.add(...)",
                    element.name,
                )
        for name in element.foreign_parameters():
            if name in d.parameters:
                raise ModelError(
                    f"the parameter {name!r} of its structure has the name of a parameter of the "
                    f"system; give a formula or a number in its parameters={{{name!r}: ...}}",
                    element.name,
                )
        joint = getattr(element, "joint", None)
        if isinstance(joint, Constraint) and d.elements.get(joint.name) is not joint:
            raise ModelError(f"its joint {joint.name!r} was not added to the system", element.name)


def check_symbols(d: Description) -> None:
    """Check what formulas depend on: lengths on parameters, joints on poses, forces on speeds."""
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
        if isinstance(element, Stateful):
            efforts.append((element.name, element.rates()))
        if isinstance(element, ForceElement):
            owners = element.parts() or d.coordinates
            rated_expressions: list[ca.SX] = []

            def rate(s: ca.SX, owners=owners, rated_expressions=rated_expressions) -> ca.SX:
                rated_expressions.append(s)
                return rate_of(s, owners, t.sx)

            efforts += [(element.name, column) for pair in element.powers(rate) for column in pair]
            positions += [(element.name, s) for s in rated_expressions]
        elif isinstance(element, Block):
            efforts += [
                (f"{element.name}.{name}", sx) for name, (sx, _) in element.outputs().items()
            ]
            lengths += [
                (e, f.sx) for e, f, meta in element.checked_quantities() if SIGNAL not in meta
            ]
        elif not isinstance(element, Constraint):
            lengths += [(entity, f.sx) for entity, f, _ in element.checked_quantities()]
    for gap in rigid_gaps([*d.elements.values()], d.coordinates):
        positions.append((gap.name, gap.distance))
        efforts.append((gap.name, gap.slip))
        law = gap.impact
        positions.append((gap.name, law.friction))
        lengths += [(gap.name, share) for share in (law.restitution, law.tangential)]
    _allow(positions, poses, ", positions and t")
    _check_linear_in_speeds(d)
    _check_laws_of_states(d)
    _allow(efforts, states, ", positions, speeds and t")
    _allow(lengths, parameters, "")


def _check_linear_in_speeds(d: Description) -> None:
    """Check that nonholonomic equations are linear in speeds, as their forces require."""
    twists = stack(c.twist for c in (*d.coordinates, d.ground))
    speeds: Formulas = [(constraint.name, constraint.slip) for constraint in d.constraints]
    for gap in rigid_gaps([*d.elements.values()], d.coordinates):
        speeds.append((gap.name, gap.slip))
    for entity, slip in speeds:
        if slip.numel() and ca.depends_on(ca.jacobian(slip, twists), twists):
            raise ModelError(
                "an equation of speeds must be linear in the speeds; divide by a speed, or write "
                "its root",
                entity,
            )


def _check_laws_of_states(d: Description) -> None:
    """Check that positions follow states whose rates do not depend on speeds or forces.

    Otherwise ``Φ̈ = 0`` would contain ``Φ_z ∂ż/∂v v̇``: drivers would act on speeds, not positions.
    """
    known = _names([stack(c.pose for c in (*d.coordinates, d.ground))]) | set(d.parameters) | {"t"}
    blocks = (element for element in d.elements.values() if isinstance(element, Sampled))
    sampled = _names(block.states.pose for block in blocks)
    positions: Formulas = [(c.name, c.equations) for c in d.constraints]
    coordinates = d.coordinates
    positions += [
        (gap.name, gap.distance) for gap in rigid_gaps([*d.elements.values()], coordinates)
    ]
    for entity, formula in positions:
        for group in foreign_states(formula, (), coordinates):
            rate = ca.jtimes(ca.densify(formula), group.pose, group.pose_rate)
            if held := sorted((_names([formula]) | _names([rate])) & sampled):
                raise ModelError(
                    f"its position or speed follows {', '.join(held[:3])}, which jumps at samples; "
                    "let it follow a filter of second order, such as two da.blocks.LowPass",
                    entity,
                )
            if foreign := sorted(_names([rate]) - known):
                raise ModelError(
                    f"its position follows the state {group.name}, whose rate depends on "
                    f"{', '.join(foreign[:3])}; let it follow a filter of the state, such as "
                    "da.blocks.LowPass, or of the quantities in the rate",
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


def value_checks(d: Description) -> ValueChecks:
    """Check of the quantities of a mechanism that are formulas of parameters alone."""
    parameters = set(d.parameters)
    limits: list[ValueLimit] = []
    for element in d.elements.values():
        for entity, formula, meta in element.checked_quantities():
            if free_symbols(formula.sx) <= parameters:
                bounds = float(meta["minimum"]), float(meta["above"])
                limits.append(ValueLimit(entity, ca.vec(formula.sx), meta["unit"], *bounds))
        for condition, message, *values in element.conditions():
            if free_symbols(condition) <= parameters:
                graph, n = stack([condition, *values]), condition.numel()
                limits.append(ValueLimit(element.name, graph, message=message, count=n))
    return ValueChecks(limits, stack(p.sx for p in d.parameters.values()))


def element_warnings(d: Description, values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """Warnings of elements at parameter values."""
    symbols, warnings = d.space.symbols, []
    for element in d.elements.values():
        for condition, message, *parts in element.warnings():
            function = ca.Function("margins", [symbols], [condition, stack(parts)])
            margins, numbers = (x.full().ravel() for x in function(values))
            if not np.all(margins >= 0):
                warnings.append(f"{element.name}: {message.format(*numbers)}")
    return tuple(warnings)


def _names(columns: Iterable[ca.SX]) -> set[str]:
    return {name for column in columns for name in free_symbols(column)}
