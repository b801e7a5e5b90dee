"""What is worth knowing about a gradient: no influence, bounds, doubtful places of the run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.model.model import Model
from dalembert.responses.base import Response
from dalembert.responses.integrals import Total
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.checks.contacts import through_contacts
from dalembert.sensitivity.checks.kinks import ties
from dalembert.sensitivity.checks.roughness import over_rough_steps
from dalembert.sensitivity.checks.scales import parameter_scales
from dalembert.sensitivity.checks.switches import over_switches
from dalembert.sensitivity.marching.stable_steps import described, growth_of
from dalembert.symbolic.once import once

NEGLIGIBLE = 1e-10
"""Influence, relative to the largest on the same response, that is round-off."""
NEAR = 0.02
"""Smallest singular value of ``C``, relative to its largest of the run, that is near zero."""
LARGEST, ENTRIES, MOST = 60, 1_000_000, 500
"""Equations, entries of ``C`` in all, and outputs, up to which the constraints are examined."""


@dataclass(frozen=True)
class Findings:
    """A gradient, and what it was computed from.

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
        listed = list(self.motion.model.parameters)
        return [listed[i] for i in self.columns]

    @cached_property
    def influence(self) -> np.ndarray:
        """Changes of the responses for a change of 100 % of each parameter."""
        return np.abs(self.values) * parameter_scales(self.motion, self.columns)


def without_influence(f: Findings) -> list[str]:
    """Parameters on which responses do not depend, exactly or to round-off."""
    names = np.array(f.names)
    found: dict[tuple[str, str], list[str]] = {}
    for response, row in zip(f.responses, f.influence, strict=True):
        none = row == 0.0
        small = ~none & (row <= NEGLIGIBLE * row.max())
        for here, what in ((none, "no influence"), (small, "negligible influence")):
            if here.any():
                found.setdefault((what, _listed(names[here])), []).append(response.label)
    told = {"no influence": "exactly zero", "negligible influence": "of the size of round-off"}
    return [
        f"{which}: {what} on {', '.join(labels)} ({told[what]})"
        for (what, which), labels in found.items()
    ]


def _listed(names: np.ndarray, most: int = 12) -> str:
    more = f" and {names.size - most} more" if names.size > most else ""
    return ", ".join(map(str, names[:most])) + more


def at_bounds(f: Findings) -> list[str]:
    """Parameters that may change to one side only."""
    notes, listed = [], list(f.motion.model.parameters.values())
    for i in f.columns:
        p, value = listed[i], float(f.motion.parameters[i])
        for bound, side, beyond in (
            (p.bounds[0], "lower", value < p.bounds[0]),
            (p.bounds[1], "upper", value > p.bounds[1]),
        ):
            place = "beyond" if beyond else "at"
            if beyond or (np.isfinite(bound) and abs(value - bound) <= 1e-12 * abs(bound)):
                notes.append(f"{p.name} = {value:.9g} is {place} its {side} bound {bound:g}")
    return notes


def changes_of_variant(f: Findings) -> list[str]:
    """Switches between sets of independent speeds, which the gradient takes as given."""
    kernel = getattr(getattr(f.motion, "record", None), "kernel", None)
    if not isinstance(kernel, DynamicsKernel):
        return []
    steps = f.motion.record.steps  # type: ignore[attr-defined]
    lasting = steps.lasting
    changes = lasting[np.flatnonzero(np.diff(steps.mode[lasting]))]
    changes = changes[~np.isin(changes + 1, np.flatnonzero(steps.h == 0))]  # those are contacts
    variants = kernel.variants
    after = lasting[np.searchsorted(lasting, changes) + 1]
    pairs = zip(steps.mode[changes], steps.mode[after], strict=True)
    same = [variants[a].integrator == variants[b].integrator for a, b in pairs]
    changes = changes[np.array(same, dtype=bool)]  # others are changes of the method
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
    """The place where the constraints come closest to losing rank."""
    motion = f.motion
    if not isinstance(motion, Recording):
        return []
    e, s = motion.model.equations, motion.trajectory
    if not 0 < e.constraint_count <= LARGEST or s.t.size < 2:
        return []
    function = _constraint_jacobian(motion.model)
    few = max(min(MOST, ENTRIES // (e.constraint_count * e.speed_count)), 10)
    looks = np.unique(np.linspace(0, s.t.size - 1, few).astype(int))
    p = np.tile(motion.parameters[:, None], looks.size)
    found = function.map(looks.size)(s.t[looks], s.y[:, looks], p).full()
    matrices = found.reshape(e.constraint_count, looks.size, -1).swapaxes(0, 1)
    smallest = np.linalg.svd(matrices, compute_uv=False)[:, -1]
    worst = int(np.argmin(smallest))
    if smallest[worst] >= NEAR * smallest.max():
        return []
    return [
        f"near t = {s.t[looks[worst]]:.6g} s the run passes close to a singular position (smallest "
        f"singular value of C {smallest[worst]:.2g}, elsewhere up to {smallest.max():.2g}): "
        "derivatives grow there"
    ]


def doubts_of_the_run(f: Findings) -> list[str]:
    """What the result itself warns about."""
    notes = [f"the run: {text}" for text in f.motion.warnings]
    if f.motion.statistics.get("stable") is False:
        notes.append("the equilibrium is not stable: neighbouring ones may not be reached")
    return notes


def one_sided(f: Findings) -> list[str]:
    """Extremes that several samples share."""
    found = (ties(f.motion, r, f.columns) for r in f.responses)
    return [note for note in found if note]


def switches_of_forces(f: Findings) -> list[str]:
    """Switches that fixed steps went over, or that were only grazed."""
    return over_switches(f.motion)


def divided_steps(f: Findings) -> list[str]:
    """Growth of step tangents at the limit of stability, which shorter steps avoid."""
    growth = growth_of(f.motion) if isinstance(f.motion, Recording) else None
    if growth is None or growth.harmless:
        return []
    return [
        f"{described(growth)}: the gradient is that of the same run with these steps in up to "
        f"{growth.parts.max()} parts; Radau() or Bdf() take fewer steps"
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
    """Gradients over switches that depend on the lengths of the steps."""
    return over_rough_steps(f.motion, f.responses, f.columns, f.values)


def rigid_contacts(f: Findings) -> list[str]:
    """Impacts beside which the motion is another one."""
    return through_contacts(f.motion)


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
    doubts_of_the_run,
)
"""What is looked for, in the order in which it is told."""


def diagnose(findings: Findings) -> list[str]:
    """Sentences about the gradient, the gravest first; none where all is well."""
    return [note for look in NOTES for note in look(findings)]
