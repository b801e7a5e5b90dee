"""Linear statics of structures: ``K_ff U_f = P_f − K_fp U_p`` (8.17), reactions by (8.18)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse.linalg as linalg

from dalembert.errors import SingularityError
from dalembert.results.status import Outcome, Status
from dalembert.results.structural import StructuralResult
from dalembert.structures.model import StructuralModel

SINGULAR = 1e-13
"""Stiffness of a motion, relative to the stiffest, that counts as none."""


@dataclass(frozen=True)
class StaticsRecord:
    """What a gradient needs: the stiffness, and the factors of its free part ``K_ff``."""

    factor: linalg.SuperLU | None
    stiffness: Any


@dataclass(frozen=True)
class Statics:
    """Linear statics as a strategy object; all load cases share one factorisation."""

    def run(
        self,
        model: StructuralModel,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
    ) -> StructuralResult:
        """Displacements and reactions of every load case.

        Raises
        ------
        SingularityError
            The structure can move without straining; names the nodes that do.
        """
        model = model.linearized
        p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        assembly, size = model.assembly, len(model.degrees)
        free, held = assembly.free, assembly.prescribed
        rest = np.zeros(size)
        stiffness = assembly.stiffness(rest, p)
        factor = factorised(model, stiffness[free][:, free])
        start = assembly.internal_forces(rest, p)
        u = np.zeros((size, len(model.loads)))
        forces = np.zeros_like(u)
        for k, load in enumerate(model.loads.values()):
            applied = load.values(p)
            u[held, k] = model.prescribed.values(p)
            if factor is not None:
                open_by = applied - start - stiffness @ u[:, k]
                u[free, k] = factor.solve(open_by[free])
            internal = start + stiffness @ u[:, k]
            forces[:, k] = applied
            forces[held, k] = internal[held]
        residual = self._residual(model, p, u, forces)
        status = Status(Outcome.COMPLETED, "linear statics", 0.0, residual)
        record = StaticsRecord(factor, stiffness)
        statistics = {"displacements": size, "free": int(free.size)}
        return StructuralResult(
            model, self, p, list(model.loads), u, forces, status, statistics, [record] * u.shape[1]
        )

    @staticmethod
    def _residual(model: StructuralModel, p, u: np.ndarray, forces: np.ndarray) -> float:
        """Largest force left over, relative to the largest."""
        left = [
            np.abs(model.assembly.internal_forces(u[:, k], p) - forces[:, k]).max(initial=0.0)
            for k in range(u.shape[1])
        ]
        return float(max(left, default=0.0) / max(np.abs(forces).max(initial=0.0), 1e-300))

    def replay(self, result: StructuralResult, p: np.ndarray) -> StructuralResult:
        """The same analysis at other parameter values."""
        return self.run(result.model, p)


def factorised(model: StructuralModel, matrix) -> linalg.SuperLU | None:
    """Sparse factors of the stiffness of the free displacements.

    Raises
    ------
    SingularityError
        It is singular: names the nodes that can move without straining anything.
    """
    if not matrix.shape[0]:
        return None
    options = {"permc_spec": "MMD_AT_PLUS_A", "options": {"SymmetricMode": True}}
    scale = float(abs(matrix).max())
    try:
        factor = linalg.splu(matrix.tocsc(), diag_pivot_thresh=0.0, **options)
    except RuntimeError:
        factor = linalg.splu((matrix + SINGULAR * scale * _eye(matrix)).tocsc(), **options)
    motion = np.random.default_rng(0).standard_normal(matrix.shape[0])
    for _ in range(2):  # inverse iteration finds the softest motion
        motion = factor.solve(motion / np.linalg.norm(motion))
        if not np.all(np.isfinite(motion)):
            raise SingularityError("the stiffness matrix is singular; support the structure")
    softest = 1.0 / np.linalg.norm(motion)
    if softest < 10 * SINGULAR * scale:
        shape = np.abs(motion) / np.abs(motion).max()
        places = [list(model.degrees)[k] for k in model.assembly.free]
        moving = dict.fromkeys(place[0] for place, s in zip(places, shape, strict=True) if s > 0.1)
        raise SingularityError(
            f"the structure is a mechanism: {', '.join(list(moving)[:8])} can move without "
            "straining anything; support them or add elements"
        )
    return factor


def _eye(matrix):
    from scipy.sparse import identity

    return identity(matrix.shape[0], format="csc")
