"""Kernel of a model for strategies of a run; automatic strategies choose by cost."""

from __future__ import annotations

from dalembert.analysis.dynamics.formulation_cost import cost_and_error
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.formulations.base import Formulation, Performance
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
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
