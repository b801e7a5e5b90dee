"""Stability of equilibria of sampled loops.

Between samples small motions follow ``ẋ = A x`` with held outputs, at a sample ``x⁺ = S x``. Over
the common period of all blocks ``x⁺ = M x`` with the product ``M`` of ``exp(A Δt)`` and ``S``; the
equilibrium is stable if no eigenvalue of ``M`` exceeds one.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import lcm

import casadi as ca
import numpy as np

from dalembert.elements.blocks.sampled import Sampled
from dalembert.errors import UnsupportedError
from dalembert.formulations.kkt import KKT
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks, sampled_maps
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import once

FINEST = 10**9
"""Upper limit of the denominators of sample times in seconds."""
MOST = 10_000
"""Upper limit of the samples in a common period."""
Instants = list[tuple[float, tuple[Sampled, ...]]]
"""Time to the next sample [s], and blocks."""


def sampled_rates(
    model: Model,
    time: float,
    x: np.ndarray,
    p: np.ndarray,
    basis: np.ndarray,
    matrix: np.ndarray,
    evaluate: Callable[..., list[np.ndarray]],
) -> np.ndarray:
    """(designs, f) rates ``ln|μ|/P`` of the eigenvalues ``μ`` of a common period ``P`` [1/s].

    Parameters
    ----------
    model, time : plant, and instant [s]
    x, p : (designs, N) states in coordinates of the bodies, and parameters
    basis : (designs, N, f) small motions, orthonormal in natural sizes
    matrix : (designs, f, f) ``A`` with held outputs
    evaluate : function and rows of arguments → rows of results

    Raises
    ------
    UnsupportedError
        The sample times have no common period of a moderate number of samples.
    """
    from scipy.linalg import expm

    instants = sample_instants(sampled_blocks(model))
    sets = list(dict.fromkeys(blocks for _, blocks in instants))
    slopes = _slopes(model, time, x, p, sets, evaluate)
    back = basis.transpose(0, 2, 1)
    samples = {blocks: back @ part @ basis for blocks, part in zip(sets, slopes, strict=True)}
    whole, flows = np.eye(matrix.shape[1]), dict[float, np.ndarray]()
    for wait, blocks in instants:
        if wait not in flows:
            flows[wait] = expm(matrix * wait)
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


def _slopes(
    model: Model,
    time: float,
    x: np.ndarray,
    p: np.ndarray,
    sets: list[tuple[Sampled, ...]],
    evaluate: Callable[..., list[np.ndarray]],
) -> list[np.ndarray]:
    """(designs, N, N) ``∂x⁺/∂x`` of samples in natural sizes, with accelerations and forces."""
    (designs, size), e = x.shape, model.equations
    scale = np.concatenate([e.scales.coordinates, e.scales.speeds])
    arguments = np.full((designs * size, 1), time), *(np.repeat(a, size, axis=0) for a in (x, p))
    unit = np.tile(np.eye(size), (designs, 1))
    still = np.zeros((designs * size, 1)), np.zeros((designs * size, p.shape[1]))
    columns = evaluate(
        sampled_function(model, tuple(sets)).tangent, *arguments, still[0], unit, still[1]
    )
    slopes = []
    for part in columns:
        whole = np.tile(np.eye(size), (designs, 1, 1))
        whole[:, : e.coordinate_count] = part.reshape(designs, size, -1).transpose(0, 2, 1)
        slopes.append(whole * scale / scale[:, None])
    return slopes


@once
def sampled_function(model: Model, sets: tuple[tuple[Sampled, ...], ...]) -> ImplicitFunction:
    """``(t, [y; v], p) → y⁺`` after the samples of each set of blocks."""
    e = model.equations
    positions = KKT().acceleration(e, e.constraint_acceleration, sampled_maps(model, sets))
    inputs = [e.t, ca.vertcat(e.y, e.v), e.p]
    return ImplicitFunction("samples", inputs, positions.stages, positions.outputs)
