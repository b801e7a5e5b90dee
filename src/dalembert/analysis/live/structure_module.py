"""Functions of statics and vibration of a small structure for other parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.live.structure_graph import MEASURES, StructureGraph
from dalembert.model.assembled.measures import Measure
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.live import LiveFunctions
from dalembert.results.sources import Row
from dalembert.results.structural.eigenmodes import Eigenvalue
from dalembert.results.structural.modes import Participation, VibrationModes
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.formulas.expression import stack, t

LARGEST = 150
"""Upper limit of the number of free displacements, whose matrices are dense."""


def structural_obstacle(model: StructuralModel) -> str:
    """Reason why matrices of a structure are not computed outside of Python; empty if they are."""
    assembly = model.linearized.assembly
    if assembly.free.size > LARGEST:
        return f"the structure has {assembly.free.size} free displacements, more than {LARGEST}"
    if any(load.configuration for load in model.linearized.loads.values()):
        return "loads depend on displacements or temperatures"
    if any(b.kind.graphs.u.numel() != b.kind.graphs.v.numel() for b in assembly.blocks):
        return "rotations of its nodes have more entries than their speeds"
    return ""


def statics_obstacle(result: StructuralResult) -> str:
    """Reason why statics cannot be repeated outside of Python; empty if it can."""
    if not result.status.success:
        return f"statics was not completed ({result.status.outcome.value})"
    return structural_obstacle(result.model)


def vibration_obstacle(modes: VibrationModes) -> str:
    """Reason why vibration cannot be repeated outside of Python; empty if it can."""
    analysis: Any = modes.analysis
    if not modes.status.success:
        return f"the modes were not computed ({modes.status.outcome.value})"
    if analysis.about is not None:
        return "the modes are about a loaded state"
    if analysis.lumped or analysis.shift:
        return "the masses are lumped, or the modes are nearest to a shift"
    return structural_obstacle(modes.model)


def statics_functions(
    result: StructuralResult, rows: Sequence[Row], times: np.ndarray
) -> LiveFunctions:
    """Functions and constants of linear statics.

    Parameters
    ----------
    result : without an obstacle
    rows : outputs, formulas of measures
    times : (K,) numbers of the load cases
    """
    model = result.model.linearized
    case, p = ca.MX.sym("case"), ca.MX.sym("p", model.p.numel())
    graph = StructureGraph(model, p)
    free, weights = ca.MX.sym("u", graph.count), ca.MX.sym("w", graph.count)
    u, start = graph.displaced(free), graph.displaced(ca.MX.zeros(graph.count))
    loads = [graph.applied(model.loads[name]) for name in result.cases]
    applied = sum((load * (case == k) for k, load in enumerate(loads)), ca.MX.zeros(graph.size))
    at = graph.free.tolist()
    strain = graph.internal_forces(start)[at]
    sides = ca.vertcat(*((load[at] - strain) for load in loads))
    unbalanced = applied - graph.internal_forces(u)
    held = np.zeros(graph.size)
    held[model.assembly.prescribed] = 1.0
    forces = ca.if_else(ca.DM(held), -unbalanced, applied)
    work = ca.dot(weights, unbalanced[at])
    arguments = [case, free, p]
    functions = {
        "system": ca.Function("system", [p], [graph.stiffness(), sides]),
        "residual_adjoint": _gradient("residual_adjoint", arguments, weights, work, [p]),
        **_outputs(
            arguments, rows, lambda part: measure_rows(result, graph, part, (u, forces), case)
        ),
    }
    data = {**_data("statics", result, times, graph), "message": result.status.message}
    return LiveFunctions(functions, data)


def vibration_functions(
    modes: VibrationModes, rows: Sequence[Row], times: np.ndarray
) -> LiveFunctions:
    """Functions and constants of the vibration of an unloaded structure.

    Parameters
    ----------
    modes : without an obstacle
    rows : outputs, formulas of measures
    times : (K,) numbers of the modes
    """
    model = modes.model.linearized
    number, p = ca.MX.sym("number"), ca.MX.sym("p", model.p.numel())
    graph = StructureGraph(model, p)
    state = ca.MX.sym("x", 1 + graph.count)
    u, none = graph.displaced(state[1:], False), ca.MX.zeros(graph.size)
    stiffness, mass = graph.stiffness(), graph.mass()
    a, b = ca.MX.sym("a", graph.count), ca.MX.sym("b", graph.count)
    factors, n = ca.MX.sym("f", 2), graph.count
    k, m = (ca.reshape(matrix, n, n) for matrix in (stiffness, mass))
    value = ca.bilin(k - factors[0] * m, a, b) + factors[1] * ca.bilin(m, b, b)
    functions = {
        "system": ca.Function("system", [p], [stiffness, mass]),
        "pencil_adjoint": ca.Function("pencil_adjoint", [a, b, factors, p], [_slope(value, p)]),
        **_outputs(
            [number, state, p],
            rows,
            lambda part: measure_rows(modes, graph, part, (u, none), number, state[0]),
        ),
    }
    text: Any = modes.analysis
    return LiveFunctions(
        functions, {**_data("vibration", modes, times, graph), "name": text.display_name}
    )


def measure_rows(
    result: Any,
    graph: StructureGraph,
    rows: Sequence[Row],
    state: tuple[ca.MX, ca.MX],
    number: ca.MX,
    eigenvalue: ca.MX | None = None,
) -> ca.MX:
    """Formulas of measures of a state."""
    model = graph.model
    column = stack(row.sx for row in rows)
    symbols = model.measure_symbols(column)
    values = [_value(graph, result.measure(s.name()), state, eigenvalue) for s in symbols]
    formula = ca.Function("rows", [t.sx, stack(symbols), model.p], [ca.densify(column)])
    return formula(number, ca.vertcat(*values), graph.p)


def _value(
    graph: StructureGraph,
    measure: Measure,
    state: tuple[ca.MX, ca.MX],
    eigenvalue: ca.MX | None,
) -> ca.MX:
    if isinstance(measure, Eigenvalue):
        assert eigenvalue is not None
        return eigenvalue
    if isinstance(measure, Participation):
        motion = ca.MX(ca.DM(measure.motion))
        return ca.dot(state[0], graph.inertia(motion))
    if not isinstance(measure, MEASURES):
        return ca.MX.nan()
    return graph.measure(measure, *state)


def _outputs(
    arguments: list[ca.MX], rows: Sequence[Row], graph_of: Callable[[Sequence[Row]], ca.MX]
) -> dict[str, ca.Function]:
    """Outputs, and the weights of state and parameters from those of the outputs.

    Drawn rows without derivatives are the last ones.
    """
    count = max(1, sum(not row.drawn for row in rows))
    weights = ca.MX.sym("w", count)
    outputs, sources = graph_of(rows), arguments[1:]
    value = ca.dot(weights, graph_of(rows[:count]))
    return {
        "outputs": ca.Function("outputs", arguments, [ca.densify(outputs)]),
        "outputs_adjoint": _gradient("outputs_adjoint", arguments, weights, value, sources),
    }


def _gradient(
    name: str, arguments: list[ca.MX], weights: ca.MX, value: ca.MX, sources: list[ca.MX]
) -> ca.Function:
    return ca.Function(name, [*arguments, weights], [_slope(value, s) for s in sources])


def _slope(value: ca.MX, source: ca.MX) -> ca.MX:
    return ca.densify(ca.gradient(value, source))


def _data(kind: str, result: Any, times: np.ndarray, graph: StructureGraph) -> dict[str, Any]:
    return {
        "kind": kind,
        "start": 0.0,
        "times": times,
        "anchor": {"p": result.parameters, "y": np.zeros(0)},
        "relative": [],
        "roots": [],
        "free": graph.count,
    }
