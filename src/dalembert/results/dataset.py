"""Labelled dataset of a motion, evaluated by one mapped call for all expressions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import ForceElement
from dalembert.elements.driver import Driver
from dalembert.elements.pair import Pair
from dalembert.model.graph.model import Model
from dalembert.model.graph.parts import element_measures
from dalembert.results.files.contents import COMPONENTS, Contents
from dalembert.results.recording import Recording
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


def motion_contents(motion: Recording) -> Contents:
    """Evaluate all variables along the motion."""
    layout, s = variables(motion.model), motion.trajectory
    table = motion.table([column for variable in layout for column in variable.columns])
    data: dict = {}
    coords: dict = {
        "time": ("time", s.t, {"units": "s", "long_name": "time"}),
    }
    row = 0
    for variable in layout:
        width = max(len(c) for c in variable.columns)
        block = table[row : row + width * len(variable.columns)]
        row += block.shape[0]
        attributes = {"units": variable.unit, "long_name": variable.long_name}
        if variable.dimension is None:
            data[variable.name] = ("time", block[0], attributes)
            continue
        shaped = block.reshape(len(variable.columns), width, -1).transpose(2, 0, 1)
        coords[variable.dimension] = list(variable.entities)
        if width > 1:
            dimension, names = COMPONENTS[width]
            coords[dimension] = list(names)
            data[variable.name] = (("time", variable.dimension, dimension), shaped, attributes)
        else:
            data[variable.name] = (("time", variable.dimension), shaped[:, :, 0], attributes)
    _add_states(data, coords, motion)
    _add_energies(data, motion)
    _add_events(data, coords, motion)
    if motion.impacts:
        _add_impacts(data, coords, motion)
    return Contents.from_arrays(data, coords, _attributes(motion))


def _add_states(data: dict, coords: dict, motion: Recording) -> None:
    model, s = motion.model, motion.trajectory
    coords["coordinate"] = list(model.guesses.names)
    units = {"units": "m or rad (per second for speeds)"}
    data["coordinates"] = (("time", "coordinate"), s.y.T, {"long_name": "coordinates y", **units})
    dimension = _speed_dimension(model)
    flat, guesses = dimension == "coordinate", model.guesses
    coords[dimension] = list(guesses.names if flat else guesses.speed_names)
    data["speeds"] = (("time", dimension), s.v.T, {"long_name": "speeds v", **units})
    coords["equation"] = model.equation_names
    data["multiplier"] = (
        ("time", "equation"),
        s.multiplier[: len(model.equation_names)].T,
        {"long_name": "multipliers", "units": "N or N m"},
    )


def _add_energies(data: dict, motion: Recording) -> None:
    kinetic, potential = data["kinetic_energy"][1], data["potential_energy"][1]
    dissipated, input_work = motion.trajectory.work
    total = kinetic + potential
    balance = total + dissipated - input_work
    balance = balance - balance[:1]  # zero at the first output
    for name, values, text in (
        ("energy", total, "kinetic plus potential energy"),
        ("dissipated_energy", dissipated, "energy dissipated since the start"),
        ("input_energy", input_work, "work of drivers and applied forces since the start"),
        ("balance_error", balance, "energy + dissipated − input, since the first output"),
    ):
        data[name] = ("time", values, {"units": "J", "long_name": text})


def _add_events(data: dict, coords: dict, motion: Recording) -> None:
    events, model = motion.events, motion.model
    coords["event"] = np.array([event.name for event in events], dtype=str)
    data["event_time"] = (
        "event",
        np.array([event.time for event in events], dtype=float),
        {"units": "s", "long_name": "time of the event"},
    )
    data["event_direction"] = (
        "event",
        np.array([event.direction for event in events], dtype=int),
        {"units": "1", "long_name": "sign of the rate of the event's measure"},
    )
    for name, states, along, text in (
        ("event_coordinates", [e.y for e in events], "coordinate", "coordinates y at the event"),
        ("event_speeds", [e.v for e in events], _speed_dimension(model), "speeds v at the event"),
    ):
        table = np.array(states, dtype=float).reshape(len(events), len(coords[along]))
        units = {"units": "m or rad (per second for speeds)"}
        data[name] = (("event", along), table, {"long_name": text, **units})


def _add_impacts(data: dict, coords: dict, motion: Recording) -> None:
    coords["impact"] = np.array([impact.name for impact in motion.impacts], dtype=str)
    for name, values, units, text in (
        ("impact_time", [i.time for i in motion.impacts], "s", "time of the impact"),
        ("impact_impulse", [i.normal for i in motion.impacts], "N s", "impulse along the gap"),
    ):
        table = np.array(values, dtype=float)
        data[name] = ("impact", table, {"units": units, "long_name": text})


def _speed_dimension(model: Model) -> str:
    """Dimension of the speeds; quasi-velocities have their own names."""
    return "coordinate" if model.equations.manifold.flat else "speed"


def _attributes(motion: Recording) -> dict:
    numbers = {
        f"parameter_{name}": float(value)
        for name, value in zip(motion.model.parameters, motion.parameters, strict=False)
    }
    return {
        "model": motion.model.name,
        "analysis": repr(motion.analysis),
        "status": str(motion.status),
        "outcome": motion.status.outcome.name,
        "warnings": "\n".join(motion.warnings),
        **numbers,
    }
