"""Checks of the step length: stability of explicit steps and of feedback, jumps of the assembly.

Stability is checked before a run. An element with stiffness k and damping c along a coordinate s
moves the mass ``1 / (∇s W ∇sᵀ)``, where W is the inverse of M on the motions that C permits. Alone
it oscillates by ``s̈ + (c/m) ṡ + (k/m) s = 0``; a step of length h amplifies that by ``R(hz)``,
where z is a root. One-sided elements count as touching.

A correction of positions finds the nearest assembly. After a long step that may be another assembly
than before: then positions jump farther than the speeds on either side permit.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.elements.base import Powers
from dalembert.elements.coordinates import rate_of
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.assembly.guesses import AssembledState
from dalembert.model.graph.model import Model
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.formulas.expression import free_symbols, stack
from dalembert.symbolic.once import once

SMALL = 200
"""Upper limit of the number of equations for a dense solve."""
ALLOWED = math.log(100.0)
"""Threshold for a warning: logarithm of the growth of a disturbance during a run."""
JUMP = 2.0
"""Threshold for a jump: displacement relative to that by the larger speed at the ends."""
SMALLEST_JUMP = 1e-2
"""Minimum displacement of a jump, in natural sizes."""
BLOCK = 2000
"""Number of steps that are checked together."""


def unstable_step_warnings(
    model: Model,
    state: AssembledState,
    p: np.ndarray,
    integrator: Integrator,
    step: float,
    duration: float,
) -> list[str]:
    """Warning about the spring or stop whose instability grows fastest with these steps."""
    if integrator.stability is None or integrator.implicit or integrator.adaptive:
        return []
    names, swings = _swings(model, state, p)

    def growth(swing: np.ndarray, h: float) -> float:
        roots = np.roots([1.0, *swing]).astype(complex)
        amplification = float(np.max(np.abs(integrator.stability(h * roots))))  # type: ignore[misc]
        return duration / h * math.log(max(amplification, 1e-300))

    growths = [growth(swing, step) for swing in swings]
    if not growths or not max(growths) > ALLOWED:
        return []
    worst = int(np.argmax(growths))
    low, high = 0.0, step
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if growth(swings[worst], middle) <= ALLOWED else (low, middle)
    rate = np.sqrt(swings[worst][1])
    return [
        f"{names[worst]} alone oscillates at {rate:.3g} rad/s: {integrator.name} with steps of "
        f"{step:g} s multiplies that by {math.exp(min(growths[worst], 700.0)):.2g} during the run; "
        f"use steps below {low:.3g} s, or an implicit integrator such as Radau()"
    ]


def _swings(model: Model, state: AssembledState, p: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Names, and ``(c/m, k/m)`` of every elastic element at a state."""
    names, function = _elastic(model)
    none: list[str] = []
    if function is None:
        return none, np.zeros((0, 2))
    values = function(0.0, state.y, state.v, p)
    slopes, coefficients = values[0].full(), values[1].full()
    loads = np.zeros((values[2].shape[0], slopes.shape[0]))
    loads[: slopes.shape[1]] = slopes.T
    try:
        responses = _solved(values[2], loads)[: slopes.shape[1]]
    except np.linalg.LinAlgError:  # singular: reported by the run
        return none, np.zeros((0, 2))
    coefficients = coefficients * np.sum(slopes * responses.T, axis=1)[:, None]
    oscillating = np.isfinite(coefficients).all(axis=1) & (coefficients[:, 1] > 0)
    names = [name for name, ok in zip(names, oscillating, strict=True) if ok]
    return names, coefficients[oscillating]


def _solved(matrix: ca.DM, rhs: np.ndarray) -> np.ndarray:
    dense = rhs.shape[0] <= SMALL
    return general_factors(matrix.full() if dense else matrix.sparse()).solve(rhs)


def _components(powers: Powers) -> Powers:
    """Scalar pairs of velocity and effort."""
    return [
        pair
        for velocity, effort in powers
        for pair in zip(ca.vertsplit(velocity), ca.vertsplit(effort), strict=True)
    ]


@once
def _elastic(model: Model) -> tuple[list[str], ca.Function | None]:
    """Names of elements that store energy; ``(t, y, v, p) → ∇s, [c k], [M Cᵀ; C 0]``."""
    e = model.all_equations
    arguments, coordinates = free_symbols(ca.vertcat(e.t, e.y, e.v, e.p)), free_symbols(e.y)
    names, slopes, stiffness, damping = [], [], [], []
    for element in model.forces:
        if element.potential() is None:
            continue
        owners = element.parts() or model.coordinates

        def rate(s: ca.SX, owners=owners) -> ca.SX:
            return rate_of(s, owners, e.t)

        for u, q in _components(element.contact_powers(rate, model.scales.energy)):
            u, q = (model.at_ground(x) for x in (u, q))
            if not free_symbols(q) & coordinates:  # constant force, such as a weight
                continue
            by_place, by_speed = (ca.sparsify(ca.jacobian(q, x)) for x in (e.y, e.v))
            if not by_place.nnz() or free_symbols(ca.vertcat(u, q)) - arguments:
                continue
            slope = ca.jacobian(u, e.v)
            size = ca.sumsqr(slope)
            names.append(element.name)
            slopes.append(slope)
            stiffness.append(-ca.dot(ca.mtimes(by_place, e.lift), slope) / size)
            damping.append(-ca.dot(by_speed, slope) / size)
    if not names:
        return names, None
    c = model.equations.jacobian
    saddle = ca.blockcat([[e.mass, c.T], [c, ca.SX(c.shape[0], c.shape[0])]])
    outputs = [ca.vertcat(*slopes), ca.horzcat(stack(damping), stack(stiffness)), saddle]
    return names, ca.Function("elastic", [e.t, e.y, e.v, e.p], outputs, {"cse": True})


class BranchJumps:
    """Jumps to another assembly in the steps of a run whose states are all stored.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    """

    def __init__(self, kernel: DynamicsKernel, steps: Steps):
        self.kernel, self.steps = kernel, steps

    @property
    def warnings(self) -> list[str]:
        """Warning about the first jump, if there is one."""
        x, lasting = self.steps.x, self.steps.lasting
        if isinstance(x, Checkpoints) or not self.kernel.equations.speed_count:
            return []
        parts = (lasting[i : i + BLOCK] for i in range(0, lasting.size, BLOCK))
        return next((warnings for part in parts if (warnings := self._first(x, part))), [])

    def _first(self, x: np.ndarray, k: np.ndarray) -> list[str]:
        """Warning about the first jump in some of the steps."""
        e = self.kernel.equations
        n, sizes = e.coordinate_count, e.scales.displacements[:, None]
        with np.errstate(all="ignore"):
            before, after = x[:, k], x[:, k + 1]
            speeds = slice(n, n + e.speed_count)
            displacements = np.abs(e.manifold.lead(before[:n], after[:n])) / sizes
            fastest = np.maximum(np.abs(before[speeds]), np.abs(after[speeds]))
            permitted = fastest * self.steps.h[k] / sizes
            jumps = displacements > JUMP * permitted.max(axis=0) + SMALLEST_JUMP
        jumping = np.flatnonzero(jumps.any(axis=0))
        if not jumping.size:
            return []
        row = int(np.argmax(displacements[:, jumping[0]]))
        name = self.kernel.view.speed_names[row]
        moved = displacements[row, jumping[0]] * float(sizes[row, 0])
        return [
            f"at t = {self.steps.t[k[jumping[0]]]:.6g} s {name} jumps by {moved:.3g}, farther than "
            "the speeds permit: the run has jumped to another assembly of the mechanism; use a "
            "shorter step"
        ]


def strategy_warnings(
    formulation: Formulation,
    stabilization: Stabilization,
    integrator: Integrator,
    step: float,
    freedom: int,
    exchanged: float,
) -> list[str]:
    """Warnings about one combination of strategies.

    With feedback, constraint violations follow ``Φ̈ + c₁Φ̇ + c₀Φ = 0``; with the roots ``s`` a
    step of length h multiplies them by ``R(hs)``, which must not exceed one.

    Parameters
    ----------
    step : length of the steps [s]
    freedom : degrees of freedom without those prescribed by drivers
    exchanged : largest energy supplied or dissipated during the run [J]
    """
    warnings = stabilization.warnings(freedom, exchanged)
    for name, feedback in (
        (_name(stabilization), stabilization.feedback),
        (_name(formulation), formulation.feedback),
    ):
        growth = None if feedback is None else _growth(feedback, integrator, step)
        if growth is not None and feedback is not None and growth > 1 + 1e-9:
            longest = _longest_stable(feedback, integrator, step)
            warnings.append(
                f"{name} with {integrator.name} and steps of {step:g} s multiplies violations by "
                f"{growth:.3g} in every step; use steps below {longest:.3g} s, or smaller gains"
            )
    return warnings


def _name(strategy: object) -> str:
    return type(strategy).__name__


def _growth(feedback: tuple[float, float], integrator: Integrator, step: float) -> float | None:
    """``max |R(hs)|`` over the roots of ``s² + c₁ s + c₀``."""
    if integrator.stability is None or integrator.adaptive:
        return None
    roots = np.roots([1.0, *feedback]).astype(complex)
    return float(np.max(np.abs(integrator.stability(step * roots))))


def _longest_stable(feedback: tuple[float, float], integrator: Integrator, step: float) -> float:
    lower, upper = 0.0, step
    for _ in range(60):
        middle = (lower + upper) / 2
        growth = _growth(feedback, integrator, middle)
        stable = growth is not None and growth <= 1 + 1e-9
        lower, upper = (middle, upper) if stable else (lower, middle)
    return lower
