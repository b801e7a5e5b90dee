"""Functions of a run of dynamics for other parameters: start, steps, outputs, adjoints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.residual_check import DRIFT, held_levels
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.events import as_events
from dalembert.analysis.live.checks import check_data, residuals
from dalembert.analysis.live.obstacles import march_obstacle
from dalembert.analysis.live.rows import smooth_rows
from dalembert.analysis.live.start import closing, violation
from dalembert.analysis.residual_check import EXACT
from dalembert.analysis.singular_positions import LOST
from dalembert.formulations.base import WORK, Level
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.model import Model
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row
from dalembert.symbolic.evaluation.columns import compiled_form


def obstacle(motion: Motion) -> str:
    """Reason why a run cannot be repeated outside of Python; empty if it can."""
    record, model = motion.record, motion.model
    kernel: DynamicsKernel = record.kernel
    if kernel.contacts is not None:
        return "rigid contacts change during the run"
    if kernel.equations.switches.count:
        return "forces switch during the run"
    if any(event.terminal for event in as_events(motion.analysis.events).values()):
        return "an event may end the run"
    if model.closure.lost:
        return "the run starts in a singular position"
    if not motion.status.success or not record.steps.count:
        return f"the run was not completed ({motion.status.outcome.value})"
    modes = np.unique(record.steps.mode)
    mode = int(modes[0])
    if modes.size != 1 or kernel.variants[mode].conditioning is not None:
        return "the run may change between partitions of its coordinates"
    if kernel.fixed.at_once(mode):
        return f"{kernel.integrator.name} is not compiled"
    if kernel.adaptive is not None and kernel.implicit(mode):
        return "the run takes implicit steps with error control"
    return march_obstacle(motion.analysis, model)


def dynamics_functions(motion: Motion, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of a run.

    Parameters
    ----------
    motion : the run that is repeated, without an ``obstacle``
    rows : outputs
    times : (K,) their times [s], ends of steps in runs with fixed steps
    """
    kernel: DynamicsKernel = motion.record.kernel
    steps = motion.record.steps
    mode = int(steps.mode[0])
    variant, marched = kernel.variants[mode], kernel.fixed.marched(mode)
    start, start_adjoint = _start(kernel, variant, motion.model)
    outputs, outputs_adjoint = _outputs(variant, rows)
    functions = {
        "closing": closing(motion.model.closure),
        "violation": violation(motion.model.closure),
        "start": start,
        "values": marched.forms.values,
        "step": compiled_form(marched.forms.function, marched.forms.called),
        "outputs": outputs,
        "residuals": residuals(motion.model, _bodies(variant)),
        "start_adjoint": start_adjoint,
        "adjoint_values": marched.prelude.values,
        "step_adjoint": marched.adjoint(True),
        "values_adjoint": marched.prelude.adjoint,
        "outputs_adjoint": outputs_adjoint,
    }
    if (unsolved := variant.step.residual) is not None:
        functions["step_residual"] = unsolved
    data: dict[str, Any] = {
        "kind": "dynamics",
        "start": float(steps.t[0]),
        "times": times,
        "instant": steps.instant,
        "anchor": {"p": motion.model.closure.anchor[0], "y": motion.model.closure.anchor[1]},
        "relative": [k for k, row in enumerate(rows) if row.relative],
        "roots": smooth_rows(rows)[1],
        "check": _check(kernel, variant, motion),
    }
    if kernel.adaptive is None:
        data["steps"] = _prescribed(steps)
        ends = np.append(steps.t, steps.end)
        data["times"] = None if np.array_equal(times, ends) else times
    else:
        run: Any = motion.analysis
        first = run.step if run.step else 1e-4 * (steps.end - float(steps.t[0]))
        longest = kernel.integrator.longest_in(steps.end - float(steps.t[0]))
        functions["attempt"] = kernel.adaptive.columns(mode).function
        memory = variant.attempt.memory if variant.attempt else np.zeros(0)
        data["adaptive"] = {
            "end": steps.end,
            "first": min(first, longest),
            "longest": longest,
            "memory": memory,
        }
    return LiveFunctions(functions, data)


def _bodies(variant: Variant) -> ca.Function:
    """``(t, x, p) → y, v, v̇, λ, work`` of a state without the memory of multistep methods."""
    e, inputs = variant.equations, variant.bodies
    t, p, x = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel()), ca.MX.sym("x", variant.step.state_size)
    at = e.coordinate_count + e.speed_count
    parts = inputs(t, x[: inputs.numel_in(1)], p)
    return ca.Function("bodies", [t, x, p], [*parts, x[at : at + WORK.numel()]])


def _check(kernel: DynamicsKernel, variant: Variant, motion: Motion) -> dict[str, Any]:
    """Limits of the residual check of a run."""
    held, model = held_levels(kernel), motion.model
    levels = {n: (EXACT[n], False) if n in held else (DRIFT, True) for n in Level}
    lost = {"lost": LOST * model.scales.length} if variant.step.corrects else {}
    analysis: Any = motion.analysis
    more = {"balance": analysis.balance, "energy": model.scales.energy, "drift": DRIFT}
    return check_data(model, levels, **more, **lost)


def _prescribed(steps: Steps) -> dict[str, Any]:
    """Times of steps: of equal ones, start, length, end and number; their corrections."""
    t, end = steps.t, steps.end
    equal = np.append(t[0] + steps.h[0] * np.arange(steps.count), end)
    corrected = np.flatnonzero(~steps.corrected)
    if not np.array_equal(equal, np.append(t, end)):
        return {"ends": np.append(t, end), "uncorrected": corrected}
    return {"length": steps.h[0], "end": end, "count": steps.count, "uncorrected": corrected}


def _start(
    kernel: DynamicsKernel, variant: Variant, model: Model
) -> tuple[ca.Function, ca.Function]:
    """``(t, y, p) → x`` at an assembled position, and ``(t, y, p, x̄) → p̄``."""
    state, begin, size = model.initial_state, variant.step.begin, variant.step.state_size
    kind: Any = ca.MX
    t, y, p = (
        kind.sym("t"),
        kind.sym("y", state.input_sizes[1]),
        kind.sym("p", state.input_sizes[2]),
    )
    y0, v0 = state.function(t, y, p)
    x = kernel.start.function(t, y0, v0, p)
    memory = x if begin is None else ca.vertcat(x[:size], begin.function(t, x[:size], p))
    weight = ca.MX.sym("w", memory.numel())
    x_bar, p_bar = weight[:size], ca.MX.zeros(p.numel())
    if begin is not None:
        _, back, p_bar = begin.adjoint(t, x[:size], p, weight[size:])
        x_bar += back
    _, y_bar, v_bar, through_start = kernel.start.adjoint(t, y0, v0, p, x_bar)
    _, _, through_assembly = state.adjoint(t, y, p, y_bar, v_bar)
    total = ca.densify(p_bar + through_start + through_assembly)
    return (
        ca.Function("start", [t, y, p], [ca.densify(memory)]),
        ca.Function("start_adjoint", [t, y, p, weight], [total]),
    )


def _outputs(variant: Variant, rows: Sequence[Row]) -> tuple[ca.Function, ca.Function]:
    """``(t, x, p) → values`` of the rows, and ``(t, x, p, weights) → x̄, p̄``."""
    measured = variant.measured(smooth_rows(rows)[0])
    e, count = variant.equations, variant.step.state_size
    at = e.coordinate_count + e.speed_count
    work = ca.DM([row.work for row in rows])
    t, x, p = ca.MX.sym("t"), ca.MX.sym("x", count), ca.MX.sym("p", e.p.numel())
    own = [x[at : at + WORK.numel()]]
    values = measured.function(t, x[: measured.input_sizes[1]], p) + ca.mtimes(work, own[0])
    weights = ca.MX.sym("w", len(rows))
    _, x_bar, p_bar = measured.adjoint(t, x[: measured.input_sizes[1]], p, weights)
    more = ca.mtimes(work.T, weights)
    x_bar = ca.vertcat(x_bar, ca.MX.zeros(count - x_bar.numel()))
    placed = ca.vertcat(ca.MX.zeros(at), more, ca.MX.zeros(count - at - more.numel()))
    return (
        ca.Function("outputs", [t, x, p], [ca.densify(values)]),
        ca.Function("outputs_adjoint", [t, x, p, weights], [ca.densify(x_bar + placed), p_bar]),
    )
