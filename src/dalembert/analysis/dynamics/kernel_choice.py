"""Kernel of a model for strategies of a run; automatic strategies choose by cost and accuracy."""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.formulations.base import Formulation, Performance, state_symbols
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.once import once


@once
def dynamics_kernel(
    model: Model,
    coordinates: Coordinates,
    formulation: Formulation,
    stabilization: Stabilization,
    integrator: Integrator,
    backend: str,
) -> DynamicsKernel:
    """Compiled functions, created once per model and choice of strategies."""
    strategies = formulation, stabilization, integrator
    chosen = coordinates.chosen(
        lambda candidate: dynamics_kernel(model, candidate, *strategies, backend).operations
    )
    if chosen is not coordinates:
        return dynamics_kernel(model, chosen, *strategies, backend)

    def merits_with(candidate: Formulation) -> Performance:
        kernel = dynamics_kernel(model, coordinates, candidate, stabilization, integrator, backend)
        return cost_and_error(kernel)

    selected = formulation.select(merits_with, integrator.implicit)
    if selected is not formulation:
        return dynamics_kernel(model, coordinates, selected, stabilization, integrator, backend)
    return DynamicsKernel(model, chosen, *strategies, BACKENDS[backend]())


def cost_and_error(kernel: DynamicsKernel) -> Performance:
    """Operations of a step, and the error of its accelerations at the start.

    The reference accelerations come from a pivoting factorisation of (5.7), with equations and
    unknowns in natural units. The error counts as zero where there is no reference: the saddle
    matrix is singular because equations are redundant, or friction depends on multipliers.
    """
    variant, x = kernel.beginning
    e, p, start = variant.equations, kernel.model.nominal, 0.0
    reference = None if e.rubbing.nnz() else _accelerations(e, start, x, p)
    accelerations = variant.rate.function(start, x, p).full().ravel()
    n = e.coordinate_count
    accelerations = accelerations[n : n + e.speed_count] / (e.scales.speeds / e.scales.time)
    if reference is None:
        error = 0.0 if np.isfinite(accelerations).all() else np.inf
    else:
        error = np.max(np.abs(accelerations - reference), initial=0.0)
        error /= max(1.0, np.max(np.abs(reference), initial=0.0))
    return Performance(kernel.operations, float(error) if error == error else np.inf)


def _accelerations(e: Equations, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray | None:
    """``v̇`` in natural units by sparse LU, refined once; None without a unique solution."""
    s, inputs = e.scales, [e.t, state_symbols(e), e.p]
    right = ca.vertcat(e.force - e.bias, e.constraint_acceleration)
    empty = ca.SX(e.constraint_count, e.constraint_count)
    matrix = ca.blockcat([[e.mass, e.jacobian.T], [e.jacobian, empty]])
    evaluate = ca.Function("saddle", inputs, [matrix, ca.densify(right)])
    saddle, b = evaluate(t, x, p)
    rows = np.concatenate([s.efforts, s.rows / s.time**2])
    columns = np.concatenate([s.speeds / s.time, s.multipliers])
    scaled = scipy.sparse.csc_array(saddle.sparse())
    scaled = scipy.sparse.csc_array(scaled.multiply(1 / rows[:, None]).multiply(columns[None, :]))
    b = b.full().ravel() / rows
    try:
        factors = general_factors(scaled)
    except np.linalg.LinAlgError:
        return None
    z = factors.solve(b)
    z += factors.solve(b - scaled @ z)
    accurate = np.isfinite(z).all() and np.linalg.norm(b - scaled @ z) <= 1e-10 * (
        np.linalg.norm(b) + np.linalg.norm(abs(scaled) @ np.abs(z))
    )
    return z[: e.speed_count] if accurate else None
