"""Functions of small motions about a state: linearisation, samples of blocks."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.analysis.equilibrium.growth import GROWING
from dalembert.analysis.equilibrium.sampled_stability import sample_instants, sampled_function
from dalembert.analysis.modes.linearization_kernel import (
    LinearizationKernel,
    linearization_kernel,
)
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks
from dalembert.symbolic.equations.implicit import ImplicitFunction


def linear_functions(
    kernel: LinearizationKernel, origin: ImplicitFunction, small: ImplicitFunction
) -> tuple[dict[str, ca.Function], dict[str, Any]]:
    """``state(t, near, p) → x`` and ``tangent(t, x, p, q) → J q, G q``, with natural sizes.

    Parameters
    ----------
    kernel : LinearizationKernel
    origin : dependence of the state on a state nearby and on the parameters
    small : small motions in some axes
    """
    _, near, _ = origin.input_sizes
    t, p = ca.MX.sym("t"), ca.MX.sym("p", kernel.e.p.numel())
    beside, x = ca.MX.sym("near", near), ca.MX.sym("x", small.input_sizes[1])
    q = ca.MX.sym("q", x.numel())
    functions = {
        "state": ca.Function("state", [t, beside, p], [origin.function(t, beside, p)]),
        "tangent": ca.Function("tangent", [t, x, p, q], list(small.function(t, x, p, q))),
    }
    states, rows = kernel.sizes
    return functions, {"sizes": {"states": states, "rows": rows}}


def small_motions(model: Model) -> tuple[dict[str, ca.Function], dict[str, Any]]:
    """Functions and constants for the growth of small motions about an equilibrium with states.

    With sampled blocks ``samples(t, x, p, q)`` is ``∂x⁺/∂x q`` of each set of blocks that sample
    together, and ``instants`` lists the waiting time after each set in a common period.
    """
    kernel = linearization_kernel(model, AbsoluteCoordinates())
    functions, data = linear_functions(kernel, kernel.resting, kernel.small_motions(None))
    data |= {"growing": GROWING, "natural": model.scales.time, "instants": None}
    if blocks := sampled_blocks(model):
        instants = sample_instants(blocks)
        sets = list(dict.fromkeys(sampled for _, sampled in instants))
        data["instants"] = [[wait, sets.index(sampled)] for wait, sampled in instants]
        functions["samples"] = _samples(kernel, sampled_function(model, tuple(sets)))
    return functions, data


def _samples(kernel: LinearizationKernel, function: ImplicitFunction) -> ca.Function:
    """``(t, x, p, q) → ∂x⁺/∂x q`` of each set of blocks, one after the other."""
    t, p = ca.MX.sym("t"), ca.MX.sym("p", kernel.e.p.numel())
    x = ca.MX.sym("x", function.input_sizes[1])
    q, still = ca.MX.sym("q", x.numel()), ca.MX.zeros(p.numel())
    moved = function.tangent.call([t, x, p, ca.MX(0), q, still])
    speeds = q[kernel.e.coordinate_count :]
    return ca.Function(
        "samples", [t, x, p, q], [ca.vertcat(*(ca.vertcat(part, speeds) for part in moved))]
    )
