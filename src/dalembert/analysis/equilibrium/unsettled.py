"""Sampled blocks without a fixed point: refusal and messages."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel
from dalembert.elements.blocks.sampled_signals import Quantizer
from dalembert.errors import AnalysisError
from dalembert.model.graph.sampled_rates import sampled_blocks


def refuse_endless(kernel: StaticsKernel, rates: np.ndarray) -> None:
    """Raise if sampled states change whatever the position and the other states are.

    Parameters
    ----------
    rates : (states,) rates of the states of the kernel at the start

    Raises
    ------
    AnalysisError
        Names these states.
    """
    all_names = kernel.model.guesses.names
    names = [all_names[kernel.states[k]] for k in np.flatnonzero(endless(kernel, rates))]
    if names:
        raise AnalysisError(
            f"{', '.join(names)} changes at every sample, whatever the state, so that there is no "
            "equilibrium; run solve_dynamics, or remove the block"
        )


def endless(kernel: StaticsKernel, rates: np.ndarray) -> np.ndarray:
    """(…, states) whether sampled states change, and their rates depend on no coordinate."""
    if not sampled_blocks(kernel.model):
        return np.zeros(rates.shape, dtype=bool)
    begin = kernel.model.equations.speed_count
    dependent = [row - begin for row in set(kernel.static.sparsity_out(2).row()) if row >= begin]
    changing = rates != 0
    changing[..., dependent] = False
    return changing


def unsettled_text(kernel: StaticsKernel) -> str:
    """Message about quantisers in a search without success; empty if there are none."""
    names = [b.name for b in sampled_blocks(kernel.model) if isinstance(b, Quantizer)]
    if not names:
        return ""
    return (
        f"; {', '.join(names)} quantises, so that fixed points are not unique and no derivative "
        "leads to one; use a ZeroOrderHold instead for the equilibrium"
    )
