"""Sampled states of a model and their rates in a search for fixed points.

A fixed point of ``z⁺ = f(t, y, v, z)`` with the sample time ``T`` is a rest position of
``ż = (f − z)/T``, so that an equilibrium determines sampled states as it does continuous ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.elements.blocks.sampled import Sampled, sampled_values
from dalembert.errors import UnsupportedError
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model


def sampled_blocks(model: Model) -> tuple[Sampled, ...]:
    """The sampled blocks of a model."""
    return tuple(e for e in model.parts.elements.values() if isinstance(e, Sampled))


def determined(model: Model, e: Equations) -> list[int]:
    """Numbers of the sampled states that a fixed point determines: they do not stay as they are."""
    own = [k for block in sampled_blocks(model) for k in sampled_entries(e, block.states.pose)]
    return [k for k in own if not e.pose_rate[k].is_zero()]


def sampled_entries(e: Equations, symbols: ca.SX) -> list[int]:
    """Numbers of the coordinates that are the states of sampled blocks."""
    rows, columns = ca.jacobian(symbols, e.y).sparsity().get_triplet()
    return [int(columns[k]) for k in np.argsort(rows)]


def with_sampled_rates(model: Model) -> Equations:
    """Equations of a model at rest in which sampled states have rates.

    Raises
    ------
    UnsupportedError
        A block samples forces of constraints, which an equilibrium computes afterwards.
    """
    e, blocks = model.equations, sampled_blocks(model)
    if not blocks:
        return e
    rate = ca.SX(e.pose_rate)
    for block in blocks:
        symbols, values = sampled_values((block,))
        values = e.without_dropped(values)
        if ca.depends_on(values, e.multiplier):
            raise UnsupportedError(
                f"{block.name} samples forces of joints, with which no equilibrium is solved; "
                "sample positions, or run solve_dynamics until the motion rests"
            )
        values = ca.substitute(values, e.a, ca.SX.zeros(e.a.numel()))
        rate[sampled_entries(e, symbols)] = (values - symbols) / block.period
    return replace(e, pose_rate=rate)


def sampled_maps(model: Model, sets: Sequence[tuple[Sampled, ...]]) -> list[ca.SX]:
    """Coordinates after the samples of sets of blocks, expressions in ``t, y, v, v̇, λ, p``."""
    e, maps = model.equations, []
    for blocks in sets:
        symbols, values = sampled_values(blocks)
        after = ca.SX(e.y)
        after[sampled_entries(e, symbols)] = e.without_dropped(values)
        maps.append(after)
    return maps
