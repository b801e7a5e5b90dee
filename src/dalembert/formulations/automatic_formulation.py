"""The choice of a formulation left to what it costs, among those that are accurate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from dalembert.errors import DalembertError, UnsupportedError
from dalembert.formulations.base import Formulation, Merits, SaddleSolver
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.velocity_partitioning import VelocityPartitioning
from dalembert.model.inertia import Inertia

CANDIDATES: tuple[Formulation, ...] = (RangeSpace(), NullSpace(), VelocityPartitioning())
ACCURATE = 1e-8
"""Relative error of accelerations at the start up to which operations alone decide."""
LONG = 40_000
"""Operations of a step by the first candidate from which no other is made: that takes long, and
sparse factors suit long mechanisms best."""


@dataclass(frozen=True)
class AutomaticFormulation(Formulation):
    """``RangeSpace``, ``NullSpace`` or ``VelocityPartitioning``, whichever needs fewest operations.

    Counted are accelerations and corrections. Those whose accelerations at the start are
    inaccurate, by an independent solution of (5.7), are out; where all are, it is ``Kkt`` if that
    is better. Implicit integrators, which do the elimination themselves, get ``RangeSpace``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length=1.0, mass=1.0))
    >>> pin = system.add(planar.Revolute("pin", system.ground, bob.start))
    >>> motion = da.solve_dynamics(
    ...     system.build(), 0.1, step=0.01, formulation=da.AutomaticFormulation()
    ... )
    >>> motion.statistics["formulation"]
    'RangeSpace'
    """

    def chosen(self, merits: Callable[[Formulation], Merits], implicit: bool) -> Formulation:
        if implicit:
            return CANDIDATES[0]
        found: dict[Formulation, Merits] = {}
        for candidate in (*CANDIDATES, Kkt()):
            if isinstance(candidate, Kkt) and any(m.error <= ACCURATE for m in found.values()):
                break
            try:
                found[candidate] = merits(candidate)
            except DalembertError:  # where all refuse, a run by the first one tells why
                continue
            if found[candidate].error <= ACCURATE and found[candidate].operations > LONG:
                break
        if not found:
            return CANDIDATES[0]
        least = max(min(m.error for m in found.values()), ACCURATE)
        accurate = [f for f, m in found.items() if m.error <= least]
        return min(accurate, key=lambda f: found[f].operations)

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> SaddleSolver:
        raise UnsupportedError(
            "AutomaticFormulation() is chosen for runs of solve_dynamics; give RangeSpace() or "
            "another formulation here"
        )
