"""Sampled blocks without a fixed point: refusal and messages."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel
from dalembert.elements.blocks.sampled_signals import Quantizer
from dalembert.errors import AnalysisError
from dalembert.model.graph.sampled_rates import sampled_blocks


def refuse_endless(kernel: StaticsKernel, time: float, y: np.ndarray, p: np.ndarray) -> None:
    """Raise if sampled states change whatever the position and the other states are.

    Raises
    ------
    AnalysisError
        Names these states.
    """
    if not sampled_blocks(kernel.model):
        return
    begin = kernel.model.equations.speed_count
    idle = np.zeros(kernel.equations.constraint_count)
    rates = kernel.static(time, y, idle, p)[0].full().ravel()[begin:]
    dependent = {row - begin for row in kernel.static.sparsity_out(2).row()}
    all_names = kernel.model.guesses.names
    names = [
        all_names[entry]
        for k, entry in enumerate(kernel.states)
        if k not in dependent and rates[k] != 0
    ]
    if names:
        raise AnalysisError(
            f"{', '.join(names)} changes at every sample, whatever the state, so that there is no "
            "equilibrium; run solve_dynamics, or remove the block"
        )


def unsettled_text(kernel: StaticsKernel) -> str:
    """Message about quantisers in a search without success; empty if there are none."""
    names = [b.name for b in sampled_blocks(kernel.model) if isinstance(b, Quantizer)]
    if not names:
        return ""
    return (
        f"; {', '.join(names)} quantises, so that fixed points are not unique and no derivative "
        "leads to one; use a ZeroOrderHold instead for the equilibrium"
    )
