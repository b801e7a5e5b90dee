"""Functions of a frequency response of a mechanism for other parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import statics_kernel
from dalembert.analysis.frequency.descriptor import DescriptorKernel
from dalembert.analysis.frequency.linear_mechanism import LinearMechanism
from dalembert.analysis.frequency.operating_point import AtRest, OperatingPoint, moving_state
from dalembert.analysis.live.equilibrium_module import (
    NO_EQUILIBRIUM,
    UNSTABLE,
    following,
    indifferent_obstacle,
)
from dalembert.analysis.live.frequency_rows import Transfers, frequency_data
from dalembert.analysis.live.frequency_structure import structure_functions, structure_obstacle
from dalembert.analysis.live.modes_module import pictures
from dalembert.analysis.live.obstacles import common_obstacle, march_obstacle
from dalembert.analysis.live.small_motions import linear_functions
from dalembert.analysis.live.start import closing, violation
from dalembert.analysis.modes.linearization_kernel import linearization_kernel
from dalembert.errors import SingularityError
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.results.live import LiveFunctions
from dalembert.results.sources import Row
from dalembert.symbolic.formulas.expression import Expression, stack


def obstacle(response: Any) -> str:
    """Reason why a response cannot be computed outside of Python; empty if it can."""
    if not response.status.success:
        return f"the response was not computed ({response.status.outcome.value})"
    if response.analysis.random:
        return "spectral densities do not run in a page"
    if response.model.kind == "structure":
        return structure_obstacle(response.analysis, response.record)
    return _mechanism_obstacle(response)


def frequency_functions(response: Any, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of a frequency response.

    Parameters
    ----------
    response : without an obstacle
    rows : outputs, formulas of amplitudes, the frequency and parameters; those of pictures last
    times : (K,) frequencies [Hz] that the page always evaluates, besides the default ones
    """
    if response.model.kind == "structure":
        return structure_functions(response, rows, times)
    return _mechanism_functions(response, rows, times)


def _mechanism_obstacle(response: Any) -> str:
    system: LinearMechanism = response.record
    point, model, analysis = system.point, system.model, response.analysis
    if analysis.method == "modal" and analysis.count is not None:
        return "the modal superposition is truncated"
    if point.origin is None:
        return "the operating point is the end of a motion"
    if model.equations.contacts:
        return "the mechanism has rigid contacts"
    if model.equations.slips:
        return "the equilibrium of rolling bodies depends on the path"
    try:
        linearization_kernel(model, AbsoluteCoordinates())
    except SingularityError:
        return "a motion of the mechanism has no mass"
    if not isinstance(point.origin, AtRest):
        return march_obstacle(analysis, model)
    if any("not stable" in note for note in point.notes):
        return UNSTABLE
    return indifferent_obstacle(model) or common_obstacle(analysis, model)


def _mechanism_functions(response: Any, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    system: LinearMechanism = response.record
    point, model = system.point, system.model
    kernel, linear = point.kernel, linearization_kernel(model, AbsoluteCoordinates())
    rest = isinstance(point.origin, AtRest)
    transfers = Transfers(response, [row for row in rows if not row.drawn])
    origin = linear.resting if rest else linear.assembled
    motions, sizes = linear_functions(linear, origin, linear.small_motions(None))
    drawn = [row for row in rows if row.drawn]
    functions = {
        **(following(statics_kernel(model)) if rest else _assembling(model)),
        **motions,
        **_point(point),
        **_system(system, kernel, transfers.measures),
        **transfers.functions(model.equations.p),
        "basis": kernel.basis,
    }
    if drawn:
        functions |= {"pictures": pictures(linear, drawn), "curvature": linear.curvature}
    near = point.origin.near  # type: ignore[union-attr]
    anchor = (system.p, near) if rest else model.closure.anchor[:2]
    data = {
        **frequency_data(response, times, transfers),
        **sizes,
        "start": system.time,
        "anchor": {"p": anchor[0][: model.equations.p.numel()], "y": anchor[1]},
        "coordinates": kernel.e.coordinate_count,
        "unknowns": kernel.sizes,
        "equations": kernel.rows,
        "rates": kernel.rates.stop - kernel.rates.start,
        "moved": kernel.parts["state"].stop,
        "columns_of": _directions(system),
        "steady": not point.moves,
        "names": system.unknown_names,
    }
    return LiveFunctions(functions, data | ({"unsolved": NO_EQUILIBRIUM} if rest else {}))


def _assembling(model: Any) -> dict[str, ca.Function]:
    return {"closing": closing(model.closure), "violation": violation(model.closure)}


def _directions(system: LinearMechanism) -> np.ndarray:
    """(inputs, np, 2) complex change of the parameters by each input."""
    columns = system.directions.T[:, : system.model.equations.p.numel()]
    return np.stack([columns.real, columns.imag], axis=-1)


def _point(point: OperatingPoint) -> dict[str, ca.Function]:
    """``point(t, near, p) → [y; v; v̇; λ]``, and the weights of the parameters."""
    kernel, model = point.kernel, point.model
    e, origin = kernel.e, point.origin
    t, p = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel())
    near = ca.MX.sym("near", origin.near.size)  # type: ignore[union-attr]
    parts = [part.numel() for part in (e.y, e.v, e.a, e.multiplier)]
    weights = ca.MX.sym("w", sum(parts))
    y_bar, v_bar, a_bar, forces_bar = ca.vertsplit(weights, np.cumsum([0, *parts]).tolist())
    if isinstance(origin, AtRest):
        rest = origin.configuration
        state = rest.function(t, near, p)
        still = ca.MX.zeros(parts[1] + parts[2])
        column = ca.vertcat(state[: parts[0]], still, state[parts[0] :])
        back = rest.adjoint(t, near, p, ca.vertcat(y_bar, forces_bar))[2]
    else:
        start, rates = model.initial_state, kernel.accelerations
        y, v = start.function(t, near, p)
        memory = ca.MX.zeros(moving_state(kernel, *(np.zeros(n) for n in parts[:2])).size)
        state = ca.vertcat(y, v, memory[parts[0] + parts[1] :])
        column = ca.vertcat(y, v, *rates.function(t, state, p))
        _, moved, own = rates.adjoint(t, state, p, a_bar, forces_bar)
        ends = parts[0], parts[0] + parts[1]
        seeds = y_bar + moved[: ends[0]], v_bar + moved[ends[0] : ends[1]]
        back = own + start.adjoint(t, near, p, *seeds)[2]
    return {
        "point": ca.Function("point", [t, near, p], [ca.densify(column)]),
        "point_adjoint": ca.Function("point_adjoint", [t, near, p, weights], [ca.densify(back)]),
    }


def _system(
    system: LinearMechanism, kernel: DescriptorKernel, measures: Sequence[Expression]
) -> dict[str, ca.Function]:
    """``system(t, z, p)`` → ``K₀``, ``K₁``, ``∂r/∂p``, ``c₀``, ``c₁``, ``∂h/∂p`` in natural sizes.

    ``pull`` returns the weights of ``z`` and ``p`` from those of measures and equations, for a
    change of the motion.
    """
    e, measured = kernel.e, Expression(stack(measure.sx for measure in measures))
    t, p = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel())
    parts = np.cumsum([0, *(part.numel() for part in (e.y, e.v, e.a, e.multiplier))]).tolist()
    z = ca.MX.sym("z", parts[-1])
    at = [t, *ca.vertsplit(z, parts), p]
    sizes, rows = ca.DM(kernel.sizes), ca.DM(kernel.rows)
    moving = kernel.rates.stop - kernel.rates.start
    equations, outputs = kernel.jacobian(*at), kernel.measure_row(measured)(*at)

    def split(matrix: ca.MX) -> list[ca.MX]:
        static, rates = matrix[:, kernel.unknowns], matrix[:, kernel.rates]
        still = ca.MX.zeros(matrix.shape[0], sizes.numel() - moving)
        columns = (
            ca.mtimes(static, ca.diag(sizes)),
            ca.mtimes(ca.horzcat(rates, still), ca.diag(sizes)),
        )
        return [*columns, matrix[:, kernel.parts["parameter"]]]

    by_size = ca.diag(1 / rows)
    matrices = [*(ca.mtimes(by_size, part) for part in split(equations)), *split(outputs)]
    change = ca.MX.sym("change", kernel.change.numel())
    weights = ca.MX.sym("weights", len(measures) + rows.numel())
    *state, back = kernel.pull(measured)(*at, change, weights)
    return {
        "system": ca.Function("system", [t, z, p], [ca.densify(m.T) for m in matrices]),
        "pull": ca.Function("pull", [t, z, p, change, weights], [ca.vertcat(*state), back]),
    }
