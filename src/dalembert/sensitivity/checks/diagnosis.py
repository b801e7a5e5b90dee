"""Notes on gradients: missing influence, bounds, and properties of the run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.model.graph.model import Model
from dalembert.responses.base import Response
from dalembert.responses.integrals import Total
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.checks.event_notes import (
    contact_notes,
    step_accuracy_notes,
    switch_notes,
)
from dalembert.sensitivity.checks.kinks import ties
from dalembert.sensitivity.checks.stencils import parameter_scales
from dalembert.sensitivity.marching.stable_steps import describe, growth_of
from dalembert.symbolic.once import once

NEGLIGIBLE = 1e-10
"""Threshold of influences of round-off size, relative to the largest on the same response [-]."""
NEAR = 0.02
"""Threshold of the smallest singular value of ``C``, relative to its maximum over the run [-]."""
MAX_EQUATIONS, MAX_ENTRIES, MAX_OUTPUTS = 60, 1_000_000, 500
"""Upper limits of equations, entries of ``C`` and outputs for examining the constraints."""


@dataclass(frozen=True)
class Findings:
    """A gradient with its run, responses and parameters.

    Attributes
    ----------
    values : (responses, columns)
    columns : numbers of the parameters
    """

    motion: Result
    responses: Sequence[Response]
    columns: Sequence[int]
    values: np.ndarray

    @cached_property
    def names(self) -> list[str]:
        names = list(self.motion.model.parameters)
        return [names[i] for i in self.columns]

    @cached_property
    def influence(self) -> np.ndarray:
        """Changes of the responses for a change of 100 % of each parameter."""
        return np.abs(self.values) * parameter_scales(self.motion, self.columns)


def without_influence(f: Findings) -> list[str]:
    """Parameters that responses do not depend on, exactly or to round-off."""
    names = np.array(f.names)
    affected: dict[tuple[str, str], list[str]] = {}
    for response, row in zip(f.responses, f.influence, strict=True):
        none = row == 0.0
        small = ~none & (row <= NEGLIGIBLE * row.max())
        for mask, kind in ((none, "no influence"), (small, "negligible influence")):
            if mask.any():
                affected.setdefault((kind, _join(names[mask])), []).append(response.label)
    remark = {"no influence": "exactly zero", "negligible influence": "of the size of round-off"}
    return [
        f"{parameters}: {kind} on {', '.join(labels)} ({remark[kind]})"
        for (kind, parameters), labels in affected.items()
    ]


def _join(names: np.ndarray, limit: int = 12) -> str:
    more = f" and {names.size - limit} more" if names.size > limit else ""
    return ", ".join(map(str, names[:limit])) + more


def at_bounds(f: Findings) -> list[str]:
    """Parameters at or beyond a bound."""
    notes, parameters = [], list(f.motion.model.parameters.values())
    for i in f.columns:
        p, value = parameters[i], float(f.motion.parameters[i])
        for bound, side, beyond in (
            (p.bounds[0], "lower", value < p.bounds[0]),
            (p.bounds[1], "upper", value > p.bounds[1]),
        ):
            position = "beyond" if beyond else "at"
            if beyond or (np.isfinite(bound) and abs(value - bound) <= 1e-12 * abs(bound)):
                notes.append(f"{p.name} = {value:.9g} is {position} its {side} bound {bound:g}")
    return notes


def changes_of_variant(f: Findings) -> list[str]:
    """Changes of independent speeds, which the gradient treats as fixed."""
    kernel = getattr(getattr(f.motion, "record", None), "kernel", None)
    if not isinstance(kernel, DynamicsKernel):
        return []
    steps = f.motion.record.steps  # type: ignore[attr-defined]
    lasting = steps.lasting
    changes = lasting[np.flatnonzero(np.diff(steps.mode[lasting]))]
    changes = changes[~np.isin(changes + 1, np.flatnonzero(steps.h == 0))]  # excludes contacts
    variants = kernel.variants
    after = lasting[np.searchsorted(lasting, changes) + 1]
    pairs = zip(steps.mode[changes], steps.mode[after], strict=True)
    same = [variants[a].integrator == variants[b].integrator for a, b in pairs]
    changes = changes[np.array(same, dtype=bool)]  # excludes changes of the method
    if not changes.size:
        return []
    return [
        f"the run changed its independent speeds {changes.size} time(s), first at "
        f"t = {steps.t[changes[0] + 1]:.6g} s; the gradient holds these choices and their times"
    ]


@once
def _constraint_jacobian(model: Model) -> ca.Function:
    e = model.equations
    return ca.Function("jacobian", [e.t, e.y, e.p], [ca.densify(e.jacobian)])


def near_singular(f: Findings) -> list[str]:
    """Instant at which the constraints are closest to losing rank."""
    motion = f.motion
    if not isinstance(motion, Recording):
        return []
    e, s = motion.model.equations, motion.trajectory
    if not 0 < e.constraint_count <= MAX_EQUATIONS or s.t.size < 2:
        return []
    function = _constraint_jacobian(motion.model)
    count = max(min(MAX_OUTPUTS, MAX_ENTRIES // (e.constraint_count * e.speed_count)), 10)
    outputs = np.unique(np.linspace(0, s.t.size - 1, count).astype(int))
    p = np.tile(motion.parameters[:, None], outputs.size)
    columns = function.map(outputs.size)(s.t[outputs], s.y[:, outputs], p).full()
    matrices = columns.reshape(e.constraint_count, outputs.size, -1).swapaxes(0, 1)
    smallest = np.linalg.svd(matrices, compute_uv=False)[:, -1]
    worst = int(np.argmin(smallest))
    if smallest[worst] >= NEAR * smallest.max():
        return []
    return [
        f"near t = {s.t[outputs[worst]]:.6g} s the run passes close to a singular position "
        f"(smallest singular value of C {smallest[worst]:.2g}, elsewhere up to "
        f"{smallest.max():.2g}): derivatives grow there"
    ]


def warnings_of_the_run(f: Findings) -> list[str]:
    """Warnings of the result itself."""
    notes = [f"the run: {text}" for text in f.motion.warnings]
    if f.motion.statistics.get("stable") is False:
        notes.append("the equilibrium is not stable: neighbouring ones may not be reached")
    return notes


def one_sided(f: Findings) -> list[str]:
    """Extremes attained by several samples."""
    notes = (ties(f.motion, r, f.columns) for r in f.responses)
    return [note for note in notes if note]


def switches_of_forces(f: Findings) -> list[str]:
    """Switches inside fixed steps, and grazed switches."""
    return switch_notes(f.motion)


def divided_steps(f: Findings) -> list[str]:
    """Growth of step tangents at the stability limit, avoided by subdivided steps."""
    growth = growth_of(f.motion) if isinstance(f.motion, Recording) else None
    if growth is None or growth.harmless:
        return []
    return [
        f"{describe(growth)}: the gradient is that of the same run with these steps in up to "
        f"{growth.parts.max()} parts; Radau() or BDF() take fewer steps"
    ]


def sums_over_steps(f: Findings) -> list[str]:
    """Sums over the ends of adaptive steps, which have no derivative."""
    kernel = getattr(getattr(f.motion, "record", None), "kernel", None)
    adaptive = isinstance(kernel, DynamicsKernel) and kernel.adaptive is not None
    if not adaptive or getattr(f.motion.analysis, "outputs", None) is not None:
        return []
    return [
        f"{response.label} sums over the ends of adaptive steps, whose number and times change "
        "with the parameters; give outputs="
        for response in f.responses
        if isinstance(response, Total)
    ]


def roughness(f: Findings) -> list[str]:
    """Gradients over switches that depend on the step lengths."""
    return step_accuracy_notes(f.motion, f.responses, f.columns, f.values)


def rigid_contacts(f: Findings) -> list[str]:
    """Impacts whose order or number changes with the parameters."""
    return contact_notes(f.motion)


NOTES: tuple[Callable[[Findings], list[str]], ...] = (
    one_sided,
    divided_steps,
    sums_over_steps,
    roughness,
    without_influence,
    at_bounds,
    changes_of_variant,
    switches_of_forces,
    rigid_contacts,
    near_singular,
    warnings_of_the_run,
)
"""All checks, in the order of their notes."""


def diagnose(findings: Findings) -> list[str]:
    """Notes on the gradient, most important first; empty if there are none."""
    return [note for check in NOTES for note in check(findings)]
