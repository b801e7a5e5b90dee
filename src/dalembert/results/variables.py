"""Variables of the results of a mechanism: expressions by entity, with names and units."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement
from dalembert.elements.driver import Driver
from dalembert.elements.pair import Pair
from dalembert.model.graph.model import Model
from dalembert.model.graph.parts import element_measures
from dalembert.results.files.contents import COMPONENTS
from dalembert.results.sources import Row, Source
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@dataclass(frozen=True)
class Variable:
    """A block of expressions over an entity dimension and components."""

    name: str
    long_name: str
    unit: str
    dimension: str | None
    entities: tuple[str, ...]
    columns: tuple[Expression, ...]  # one per entity, each scalar or (2,)


@once
def variables(model: Model) -> list[Variable]:
    """All variables of a model's results."""
    return [
        *_bodies(model),
        *_points(model),
        *_joints(model),
        *_drivers(model),
        *_forces(model),
        *_scalars(model),
    ]


def _bodies(model: Model) -> list[Variable]:
    measures = {b.name: b.measures() for b in model.bodies}
    reference_point = "the origin of the body" if _spatial(model) else "the mass centre"
    motion = {
        "position": (f"position of {reference_point}", "m"),
        "angle": ("angle", "rad"),
        "euler_parameters": ("Euler parameters, the scalar first", "1"),
        "velocity": (f"velocity of {reference_point}", "m/s"),
        "angular_velocity": ("angular velocity", "rad/s"),
        "acceleration": (f"acceleration of {reference_point}", "m/s^2"),
        "angular_acceleration": ("angular acceleration", "rad/s^2"),
    }
    available = {q for quantities in measures.values() for q in quantities}
    return [_variable("body", measures, q, q, *motion[q], model) for q in motion if q in available]


def _points(model: Model) -> list[Variable]:
    measures = {p.name: p.measures() for b in model.bodies for p in b.points.values()}
    motion = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2"} if measures else {}
    return [
        _variable("point", measures, q, f"point_{q}", f"{q} of the point", unit, model)
        for q, unit in motion.items()
    ]


def _joints(model: Model) -> list[Variable]:
    joints = [c for c in model.constraints if isinstance(c, Pair)]
    names, reactions = tuple(c.name for c in joints), [c.reaction() for c in joints]
    kinds = [
        ("reaction_force", 2, "force of the joint on its second body", "N"),
        ("reaction_moment", 1, "moment of the joint on its second body, at the joint", "N m"),
    ]
    return [
        Variable(
            name,
            text,
            unit,
            "joint",
            names,
            _uniform_columns(graphs, 3 if _spatial(model) else width),
        )
        for (name, width, text, unit), graphs in zip(
            kinds, zip(*reactions, strict=True), strict=False
        )
    ]


def _drivers(model: Model) -> list[Variable]:
    drivers = [c for c in model.constraints if isinstance(c, Driver)]
    measures = {c.name: element_measures(c, model) for c in drivers}
    units = {"effort": "N or N m", "power": "W"} if drivers else {}
    return [
        _variable("driver", measures, q, q, f"{q} of the driver", unit, model)
        for q, unit in units.items()
    ]


def _variable(
    dimension: str,
    measures: dict[str, dict[str, tuple[ca.SX, str]]],
    quantity: str,
    name: str,
    text: str,
    unit: str,
    model: Model,
) -> Variable:
    """One quantity of all entities; ``measures`` is name → quantity → (graph, unit)."""
    graphs = [quantities.get(quantity, (None, ""))[0] for quantities in measures.values()]
    width = max(sx.numel() for sx in graphs if sx is not None)
    columns = _uniform_columns(graphs, 3 if width == 2 and _spatial(model) else width)
    return Variable(name, text, unit, dimension, tuple(measures), columns)


def _forces(model: Model) -> list[Variable]:
    """Scalar measures of all force elements, one variable per quantity."""
    variables: list[Variable] = []
    by_quantity: dict[tuple[str, str], list[tuple[str, ca.SX]]] = {}
    for force in model.forces:
        if isinstance(force, ForceElement) and force.name != "gravity":
            for quantity, (sx, unit) in element_measures(force, model).items():
                if sx.numel() == 1:
                    by_quantity.setdefault((quantity, unit), []).append((force.name, sx))
    for (quantity, unit), entries in by_quantity.items():
        name = f"element_{quantity}"
        if any(v.name == name for v in variables):
            name = f"element_{quantity}_{unit.replace('/', '_per_').replace(' ', '_')}"
        dimension = f"{name}_of"
        names = tuple(n for n, _ in entries)
        text = f"{quantity} of the force element"
        variables.append(
            Variable(name, text, unit, dimension, names, _columns(s for _, s in entries))
        )
    return variables


def _scalars(model: Model) -> list[Variable]:
    e = model.all_equations
    speeds = e.velocity_constraints
    zero = ca.SX(0)
    entries = [
        ("kinetic_energy", "kinetic energy", "J", e.kinetic_energy),
        ("potential_energy", "potential energy", "J", e.potential),
        (
            "position_violation",
            "largest violation of a constraint",
            "m or rad",
            ca.norm_inf(e.constraints) if e.constraints.numel() else zero,
        ),
        (
            "velocity_violation",
            "largest violation of a velocity constraint",
            "m/s or rad/s",
            ca.norm_inf(speeds) if speeds.numel() else zero,
        ),
    ]
    return [Variable(n, text, unit, None, (n,), _columns([sx])) for n, text, unit, sx in entries]


@once
def energy_sources(model: Model) -> dict[str, Source]:
    """Formulas of the energies that a dataset adds to its variables."""
    e, none = model.all_equations, ca.SX(0)
    total = e.kinetic_energy + e.potential
    return {
        "energy": total,
        "dissipated_energy": Row(none, (1.0, 0.0)),
        "input_energy": Row(none, (0.0, 1.0)),
        "balance_error": Row(total, (1.0, -1.0), relative=True),
    }


def variable_source(model: Model, name: str, **labels: str) -> Source | None:
    """Formula of a variable at labels of its dimensions; None if it is not a formula."""
    if name in (energies := energy_sources(model)):
        return energies[name]
    variable = next((v for v in variables(model) if v.name == name), None)
    if variable is None:
        return None
    entity = labels[variable.dimension] if variable.dimension else name
    sx = variable.columns[variable.entities.index(entity)].sx
    dimension, components = COMPONENTS.get(sx.numel(), ("", ()))
    return sx[components.index(labels[dimension])] if dimension in labels else sx


def _spatial(model: Model) -> bool:
    return any(body.dimension == 3 for body in model.bodies)


def _uniform_columns(graphs: Iterable[ca.SX | None], width: int) -> tuple[Expression, ...]:
    """Columns with ``width`` components each; planar ones are padded, missing ones are NaN."""

    def padded(sx: ca.SX | None) -> ca.SX:
        if sx is None:
            return ca.SX.nan(width, 1)
        if sx.numel() == width:
            return sx
        return ca.vertcat(sx, 0) if sx.numel() == 2 else ca.vertcat(0, 0, sx)

    return _columns(padded(sx) for sx in graphs)


def _columns(graphs: Iterable[ca.SX]) -> tuple[Expression, ...]:
    return tuple(Expression(graph) for graph in graphs)
