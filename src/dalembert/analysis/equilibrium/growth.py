"""Growth of small motions about equilibria with states of first order, of many designs at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.sampled_stability import sampled_rates
from dalembert.analysis.modes.linearization_kernel import linearization_kernel
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks

GROWING = 1e-9
"""Threshold of growth: real part relative to the largest eigenvalue [-]."""
Evaluate: TypeAlias = Callable[..., list[np.ndarray]]
"""``(function, arguments …) → results``, with one row per design."""


def row_by_row(function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
    """Results of a function for rows of arguments, in the CasADi virtual machine."""
    results = function.map(len(arguments[0])).call([ca.DM(part.T) for part in arguments])
    return [result.full().T for result in results]


def growth_rates(
    model: Model, time: float, y: np.ndarray, p: np.ndarray, evaluate: Evaluate = row_by_row
) -> np.ndarray:
    """(designs, f) rates of motions about equilibria [1/s]; zero where they do not grow.

    Real parts of the eigenvalues of the linearised mechanism, with samples of blocks those of a
    common period.

    Parameters
    ----------
    model : with states of first order
    time : [s]
    y : (designs, n) equilibria
    p : (designs, np) parameters
    """
    kernel = linearization_kernel(model, AbsoluteCoordinates())
    x = np.hstack([y, np.zeros((len(y), model.equations.speed_count))])
    designs, size = x.shape
    motions, (states, rows) = kernel.small_motions(None).function, kernel.sizes
    arguments = np.full((designs * size, 1), time), *(np.repeat(a, size, axis=0) for a in (x, p))
    columns = evaluate(motions, *arguments, np.tile(np.eye(size), (designs, 1)))
    jacobian, tangency = (
        column.reshape(designs, size, -1).transpose(0, 2, 1) * states / sizes[:, None]
        for column, sizes in zip(columns, (states, rows), strict=True)
    )
    basis = np.tile(np.eye(size), (designs, 1, 1))
    if rows.size:
        basis = np.linalg.svd(tangency)[2][:, rows.size :].transpose(0, 2, 1)
    matrix = basis.transpose(0, 2, 1) @ jacobian @ basis
    if sampled_blocks(model):
        rates = sampled_rates(model, time, x, p, basis, matrix, evaluate)
        return np.where(rates > GROWING / model.scales.time, rates, 0.0)
    values = np.linalg.eigvals(matrix)
    largest = np.abs(values).max(axis=1, initial=0.0)[:, None]
    return np.where(values.real > GROWING * largest, values.real, 0.0)
