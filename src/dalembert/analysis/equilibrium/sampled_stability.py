"""Stability of equilibria of sampled loops.

Between samples small motions follow ``ẋ = A x`` with held outputs, at a sample ``x⁺ = S x``. Over
the common period of all blocks ``x⁺ = M x`` with the product ``M`` of ``exp(A Δt)`` and ``S``; the
equilibrium is stable if no eigenvalue of ``M`` exceeds one.
"""

from __future__ import annotations

from fractions import Fraction
from math import lcm

import casadi as ca
import numpy as np

from dalembert.analysis.modes.linearized import Linearized
from dalembert.elements.blocks.sampled import Sampled
from dalembert.errors import UnsupportedError
from dalembert.formulations.kkt import KKT
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks, sampled_maps
from dalembert.symbolic.equations.implicit import ImplicitFunction

FINEST = 10**9
"""Upper limit of the denominators of sample times in seconds."""
MOST = 10_000
"""Upper limit of the samples in a common period."""
Instants = list[tuple[float, tuple[Sampled, ...]]]
"""Time to the next sample [s], and blocks."""


def sampled_growth(linear: Linearized) -> np.ndarray:
    """Rates ``ln|μ|/P`` of the eigenvalues ``μ`` of a common period ``P`` [1/s].

    Parameters
    ----------
    linear : plant with held outputs, in coordinates of the bodies

    Raises
    ------
    UnsupportedError
        The sample times have no common period of a moderate number of samples.
    """
    from scipy.linalg import expm

    instants = sample_instants(sampled_blocks(linear.model))
    basis, scale = linear.basis, linear.sizes[0]
    samples = dict.fromkeys(blocks for _, blocks in instants)
    for blocks, slopes in zip(samples, _slopes(linear, list(samples)), strict=True):
        samples[blocks] = basis.T @ (slopes * scale / scale[:, None]) @ basis
    whole, flows = np.eye(len(linear.matrix)), dict[float, np.ndarray]()
    for wait, blocks in instants:
        if wait not in flows:
            flows[wait] = expm(linear.matrix * wait)
        whole = flows[wait] @ samples[blocks] @ whole
    period = sum(wait for wait, _ in instants)
    with np.errstate(divide="ignore"):
        rates: np.ndarray = np.log(np.abs(np.linalg.eigvals(whole))) / period
    return rates


def sample_instants(blocks: tuple[Sampled, ...]) -> Instants:
    """Time to the next sample [s] and the blocks that sample, over a common period.

    Raises
    ------
    UnsupportedError
        The sample times have no common period of a moderate number of samples.
    """
    periods = [Fraction(block.period).limit_denominator(FINEST) for block in blocks]
    whole = lcm(*(k.denominator for k in periods))
    counts = [int(k * whole) for k in periods]
    common = lcm(*counts)
    if sum(common // count for count in counts) > MOST:
        names = ", ".join(block.name for block in blocks)
        raise UnsupportedError(
            f"the sample times of {names} have no common period of at most {MOST} samples, which "
            "decides about the stability of the equilibrium; choose multiples of one sample time"
        )
    times: dict[Fraction, list[Sampled]] = {}
    for block, count in zip(blocks, counts, strict=True):
        first = Fraction(block.beginning).limit_denominator(FINEST)
        for k in range(common // count):
            instant = (first + Fraction(k * count, whole)) % Fraction(common, whole)
            times.setdefault(instant, []).append(block)
    order = sorted(times)
    following = [*order[1:], order[0] + Fraction(common, whole)]
    return [(float(b - a), tuple(times[a])) for a, b in zip(order, following, strict=True)]


def sampled_function(model: Model, sets: list[tuple[Sampled, ...]]) -> ImplicitFunction:
    """``(t, [y; v], p) → y⁺`` after the samples of each set of blocks."""
    e = model.equations
    positions = KKT().acceleration(e, e.constraint_acceleration, sampled_maps(model, sets))
    inputs = [e.t, ca.vertcat(e.y, e.v), e.p]
    return ImplicitFunction("samples", inputs, positions.stages, positions.outputs)


def _slopes(linear: Linearized, sets: list[tuple[Sampled, ...]]) -> list[np.ndarray]:
    """``∂x⁺/∂x`` of samples, accelerations and multipliers included."""
    e, x, size = linear.model.equations, linear.x, linear.x.size
    function = sampled_function(linear.model, sets)
    unit, still = np.eye(size), np.zeros((linear.p.size, size))
    arguments = [ca.DM(k) for k in (linear.time, x, linear.p, 0, unit, still)]
    columns = function.tangent.map(size).call(arguments)
    slopes = []
    for rows in columns:
        whole = np.eye(size)
        whole[: e.coordinate_count] = rows.full()
        slopes.append(whole)
    return slopes
