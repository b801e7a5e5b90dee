"""State-space models of linearised mechanisms and of structures in their modes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.frequency.descriptor import descriptor_kernel
from dalembert.analysis.frequency.linear_analysis import input_names, output_measures
from dalembert.analysis.frequency.linear_mechanism import LinearMechanism
from dalembert.analysis.frequency.linear_structure import LinearStructure
from dalembert.analysis.frequency.moving_points import refuse_moving_points
from dalembert.analysis.frequency.operating_point import OperatingPoint, moving_state
from dalembert.analysis.frequency.structure_inputs import structural_inputs
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.errors import UnsupportedError
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.modes import Modes
from dalembert.results.state_space import StateSpace

UNDAMPED = Rayleigh()
VERB = "state_space"


def state_space(
    modes: Modes, inputs: Any, outputs: Any, damping: Rayleigh | None, damping_ratio: float
) -> StateSpace:
    """State-space model of the linear system behind modes.

    Parameters
    ----------
    modes : of a mechanism, whose state counts; of a structure, the modal coordinates
    inputs, outputs : names; by default those of the model
    damping, damping_ratio : of a structure

    Raises
    ------
    UnsupportedError
        An input enters constraint equations or moves supports, so that outputs depend on its
        derivatives.
    """
    if isinstance(modes.model, StructuralModel):
        return _of_structure(modes, inputs, outputs, damping or UNDAMPED, damping_ratio)
    if damping is not None or damping_ratio:
        raise UnsupportedError(
            f"{VERB}: damping is an option for structures; give dampers to mechanisms"
        )
    return _of_mechanism(modes, inputs, outputs)


def _of_mechanism(modes: Modes, inputs: Any, outputs: Any) -> StateSpace:
    model = modes.model
    names = input_names(model, inputs, VERB)
    refuse_moving_points(model, names)
    measures = output_measures(model, outputs, VERB)
    columns = [list(model.parameters).index(name) for name in names]
    system = LinearMechanism(_point(modes), model.tangents(modes.parameters, columns))
    refuse_derivatives([names[k] for k in system.constraining()])
    form = system.first_order
    rows = [form.output(measure) for measure in measures.values()]
    c, d = (np.array(part) for part in zip(*rows, strict=True))
    units = dict(zip(form.names, form.units, strict=True))
    units |= {name: model.parameters[name].unit for name in names}
    units |= {name: measure.unit for name, measure in measures.items()}
    signals = form.names, names, list(measures)
    return StateSpace(*form.matrices, c, d, *signals, units, form.sizes, model.name)


def _point(modes: Modes) -> OperatingPoint:
    """The state of modes in coordinates of the bodies, with small rotations in the same axes.

    Raises
    ------
    UnsupportedError
        The state moves in joint coordinates, in which alone it may be steady.
    """
    record = modes.record
    view, model, e = record.kernel.view, modes.model, record.kernel.e
    whole = model.all_equations
    kernel = descriptor_kernel(model, record.axes)
    lifted = [view.lift(part) for part in (whole.y, whole.v)]
    bodies = ca.Function("bodies", [e.t, e.y, e.v, e.p], lifted)
    state = record.x[: e.coordinate_count], record.x[e.coordinate_count :]
    y, v = (part.full().ravel() for part in bodies(record.time, *state, record.p))
    moving = np.abs(v) > 1e-9 * model.scales.speeds
    if moving.any() and view.speed_names != list(model.guesses.speed_names):
        raise UnsupportedError(
            f"{VERB}: the mechanism moves, and these coordinates are not those of the bodies; use "
            "coordinates=AbsoluteCoordinates()"
        )
    rates = kernel.accelerations.function(record.time, moving_state(kernel, y, v), record.p)
    a, forces = (part.full().ravel() for part in rates)
    return OperatingPoint(kernel, record.time, y, v, a, forces, record.p)


def _of_structure(
    modes: Modes, inputs: Any, outputs: Any, damping: Rayleigh, damping_ratio: float
) -> StateSpace:
    """Modal coordinates ``q`` with ``q̈ + (α + β ω² + 2 ζ ω) q̇ + ω² q = φᵀ f``."""
    model, spectrum = modes.model, modes.record
    names = structural_inputs(model, inputs, VERB)
    measures = output_measures(model, outputs, VERB)
    options = SimpleNamespace(damping=damping, loss_factor=0.0, damping_ratio=damping_ratio)
    system = LinearStructure(options, spectrum.pencil, names, np.eye(len(names)))
    moved = np.abs(system.supports).any(axis=0) if system.supports.size else np.zeros(len(names))
    refuse_derivatives([name for name, moving in zip(names, moved, strict=True) if moving])
    squares, shapes = modes.eigenvalues, spectrum.shapes[:, modes.positions]
    alpha, beta = system.coefficients
    viscous = alpha + beta * squares + 2 * damping_ratio * np.sqrt(np.maximum(squares, 0.0))
    count, zero = squares.size, np.zeros((squares.size, squares.size))
    a = np.block([[zero, np.eye(count)], [-np.diag(squares), -np.diag(viscous)]])
    force = system.forces.real
    b = np.vstack([np.zeros((count, len(names))), shapes.T @ force])
    rows = [system.row(measure).weights for measure in measures.values()]
    if any(row.forces.any() for row in rows):
        raise UnsupportedError(f"{VERB}: reactions are no outputs of modes; use frequency_response")
    c = np.array([np.concatenate([row.u @ shapes, np.zeros(count)]) for row in rows])
    d = np.array([row.p @ system.directions.real for row in rows])
    states = [f"mode {n}" for n in modes.numbers] + [f"mode {n} rate" for n in modes.numbers]
    units = {name: model.parameters[name].unit for name in names if name in model.parameters}
    units |= {name: measure.unit for name, measure in measures.items()}
    sizes = np.concatenate([np.ones(count), np.sqrt(np.maximum(np.abs(squares), 1e-300))])
    signals = states, names, list(measures)
    return StateSpace(a, b, c, d, *signals, units, sizes, model.name)


def refuse_derivatives(names: list[str]) -> None:
    """Raise for inputs whose derivatives act on the motion.

    Raises
    ------
    UnsupportedError
        Names the inputs.
    """
    if names:
        raise UnsupportedError(
            f"{VERB}: {', '.join(names)} moves constraints or supports, so that outputs depend on "
            "its derivatives, which ẋ = A x + B u does not have; use frequency_response, or drive "
            "it through a filter such as da.blocks.LowPass"
        )
