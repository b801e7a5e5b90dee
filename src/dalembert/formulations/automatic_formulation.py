"""Automatic choice of the cheapest accurate formulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from dalembert.errors import DalembertError, UnsupportedError
from dalembert.formulations.base import Formulation, Performance, SaddleSolver
from dalembert.formulations.kkt import KKT
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.velocity_partitioning import VelocityPartitioning
from dalembert.model.graph.inertia import Inertia

CANDIDATES: tuple[Formulation, ...] = (RangeSpace(), NullSpace(), VelocityPartitioning())
ACCURATE = 1e-8
"""Upper limit of the relative error of initial accelerations of an accurate formulation."""
LONG = 40_000
"""Threshold of the operations per step of the first candidate above which no other is evaluated:
building them takes long, and sparse factors suit long mechanisms best."""


@dataclass(frozen=True)
class AutomaticFormulation(Formulation):
    """``RangeSpace``, ``NullSpace`` or ``VelocityPartitioning`` with the fewest operations.

    The count includes accelerations and corrections. Formulations whose initial accelerations
    differ from an independent solution of (5.7) are excluded; if all are, ``KKT`` is used if it is
    more accurate. Implicit integrators, which perform the elimination themselves, use
    ``RangeSpace``.

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

    def select(
        self, performance: Callable[[Formulation], Performance], implicit: bool
    ) -> Formulation:
        if implicit:
            return CANDIDATES[0]
        evaluated: dict[Formulation, Performance] = {}
        for candidate in (*CANDIDATES, KKT()):
            if isinstance(candidate, KKT) and any(e.error <= ACCURATE for e in evaluated.values()):
                break
            try:
                evaluated[candidate] = performance(candidate)
            except DalembertError:  # if all candidates fail, the run by the first reports why
                continue
            if evaluated[candidate].error <= ACCURATE and evaluated[candidate].operations > LONG:
                break
        if not evaluated:
            return CANDIDATES[0]
        limit = max(min(e.error for e in evaluated.values()), ACCURATE)
        accurate = [f for f, e in evaluated.items() if e.error <= limit]
        return min(accurate, key=lambda f: evaluated[f].operations)

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> SaddleSolver:
        raise UnsupportedError(
            "AutomaticFormulation() makes its choice in solve_dynamics; give RangeSpace() or "
            "another formulation here"
        )
