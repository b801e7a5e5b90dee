"""Labelled dataset of a motion, evaluated by one mapped call for all expressions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.model.graph.model import Model
from dalembert.results.files.contents import COMPONENTS, Contents
from dalembert.results.recording import Recording
from dalembert.results.variables import Variable, variables


def motion_contents(motion: Recording) -> Contents:
    """Evaluate all variables along the motion."""
    data, coords = labelled_variables(motion, variables(motion.model))
    _add_states(data, coords, motion)
    _add_energies(data, motion)
    _add_events(data, coords, motion)
    if motion.impacts:
        _add_impacts(data, coords, motion)
    return Contents.from_arrays(data, coords, _attributes(motion))


def labelled_variables(motion: Recording, layout: Sequence[Variable]) -> tuple[dict, dict]:
    """Variables along the motion, and their coordinates, as arguments of ``Contents``."""
    s = motion.trajectory
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
    return data, coords


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
        **numbers,
    }
