"""Geometrically nonlinear statics: Newton's method under loads that grow step by step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.structural.numbers import require
from dalembert.analysis.structural.statics import StaticsRecord, factorised
from dalembert.errors import SingularityError
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel

SHORTEST = 1e-6
"""Share of the load below which a step is not halved any more."""
STANDS = 1e-13
"""Change of the displacements that only round-off makes, where residuals cannot fall further."""
ROUNDING = 1e-13
"""Residual relative to ``|K| |u|``, row by row, that is then taken for round-off."""


@dataclass(frozen=True)
class NonlinearStatics:
    """Equilibrium at large displacements, ``∂W/∂u (U, p) = P`` with ``U_p`` prescribed.

    Loads and prescribed displacements grow together in ``steps`` equal steps; a step in which
    Newton's method fails is halved. Every load case starts from rest.

    Parameters
    ----------
    steps : number of load steps
    tolerance : of the residual relative to the largest force
    max_iterations : of Newton's method in a step

    Raises
    ------
    UnsupportedError
        A number that is not positive.
    """

    steps: int = 10
    tolerance: float = 1e-10
    max_iterations: int = 25

    def __post_init__(self) -> None:
        require(self, ("tolerance",), ("steps", "max_iterations"))

    def run(
        self,
        model: StructuralModel,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
    ) -> StructuralResult:
        """Displacements and reactions of every load case; keeps the last equilibrium it found.

        Raises
        ------
        SingularityError
            The structure is a mechanism before any load acts.
        """
        p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        paths = [LoadPath(self, model, p, case) for case in model.loads]
        u = np.stack([path.follow() for path in paths], axis=1)
        forces = np.stack([path.forces() for path in paths], axis=1)
        worst = min(paths, key=lambda path: path.reached)
        residual = max(path.residual for path in paths)
        if worst.reached < 1.0:
            text = (
                f"load case {worst.case!r}: no equilibrium beyond {worst.reached:.4g} of the load "
                "(a limit point?); lower the load or take more steps"
            )
            status = Status(Outcome.NOT_CONVERGED, text, worst.reached, residual)
        else:
            status = Status(Outcome.COMPLETED, "nonlinear statics", 1.0, residual)
        record = [path.record() for path in paths]
        statistics = {"iterations": sum(path.iterations for path in paths)}
        return StructuralResult(
            model, self, p, list(model.loads), u, forces, status, statistics, record
        )

    def replay(self, result: StructuralResult, p: np.ndarray) -> StructuralResult:
        """The same analysis at other parameter values."""
        return self.run(result.model, p)


class LoadPath:
    """One load case on its way from rest."""

    def __init__(self, analysis: NonlinearStatics, model: StructuralModel, p: np.ndarray, case):
        self.analysis, self.model, self.p, self.case = analysis, model, p, case
        self.assembly = model.assembly
        self.applied = model.loads[case].values(p)
        self.held = model.prescribed.values(p)
        self.u = np.zeros(len(model.degrees))
        self.reached, self.iterations, self.residual = 0.0, 0, 0.0

    def follow(self) -> np.ndarray:
        """Displacements (n,) at the full load, or where the path was lost."""
        step = 1.0 / self.analysis.steps
        while self.reached < 1.0:
            target = min(1.0, self.reached + step)
            found = self._newton(target)
            if found is not None:
                self.u, self.reached = found, target
                continue
            step /= 2
            if step < SHORTEST:
                break
        return self.u

    def _newton(self, share: float) -> np.ndarray | None:
        """Equilibrium under a share of the load, None where Newton's method fails."""
        u, free = self.u.copy(), self.assembly.free
        u[self.assembly.prescribed] = share * self.held
        stands, noise = False, np.zeros(free.size)
        for _ in range(self.analysis.max_iterations):
            internal = self.assembly.internal_forces(u, self.p)
            rest = (share * self.applied - internal)[free]
            scale = max(np.abs(share * self.applied).max(), np.abs(internal).max(), 1e-300)
            size = np.abs(rest).max(initial=0.0) / scale
            if not np.isfinite(size):
                return None
            if size < self.analysis.tolerance or (stands and np.all(np.abs(rest) <= noise)):
                self.residual = float(size)
                return u
            if stands:
                return None
            rows = self.assembly.stiffness(u, self.p)[free]
            try:
                change = factorised(self.model, rows[:, free]).solve(rest)  # type: ignore[union-attr]
            except SingularityError:
                if share == 0 or (self.reached == 0 and not self.iterations):
                    raise
                return None
            u[free] += change
            stands = np.abs(change).max() < STANDS * max(np.abs(u).max(), 1e-300)
            noise = ROUNDING * (abs(rows) @ np.abs(u)) if stands else noise
            self.iterations += 1
        return None

    def forces(self) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        found = self.reached * self.applied
        internal = self.assembly.internal_forces(self.u, self.p)
        held = self.assembly.prescribed
        found[held] = (internal - found)[held]
        return found

    def record(self) -> StaticsRecord:
        """Tangent stiffness at the end, for gradients; no factors where the path was lost."""
        matrix, free = self.assembly.stiffness(self.u, self.p), self.assembly.free
        whole = self.reached >= 1.0
        return StaticsRecord(
            factorised(self.model, matrix[free][:, free]) if whole else None, matrix
        )
