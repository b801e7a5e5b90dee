"""Geometrically nonlinear statics: Newton's method under loads that grow step by step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.requirements import need_positive
from dalembert.analysis.structural.static_equations import (
    ForceResidual,
    StaticEquations,
    StaticsRecord,
    full_steps,
)
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import options
from dalembert.results.result import Analysis, ParameterValues
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.solver import Factors
from dalembert.symbolic.equations.newton import Ending, Equations, Residual, solve
from dalembert.timing import Timing

SHORTEST = 1e-6
"""Lower limit of a load step, as a share of the load."""


@options
class NonlinearStatics(Analysis[StructuralModel, StructuralResult]):
    """Equilibrium at large displacements, ``∂W/∂u (U, p) = P`` with ``U_p`` prescribed.

    Loads and prescribed displacements grow together in ``steps`` equal steps; a step in which
    Newton's method fails is halved. Every load case starts from rest.

    Parameters
    ----------
    steps : number of load steps
    tolerance : residual relative to the largest force
    max_iterations : of Newton's method per step

    Raises
    ------
    UnsupportedError
        A number that is not positive.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> arch = da.Structure("arch")
    >>> left, top = arch.node("left", -1, 0), arch.node("top", 0, 0.1)
    >>> bar = arch.add(structures.Truss("bar", left, top, area=1e-4, modulus=1e7))
    >>> arch.support(left)
    >>> arch.support(top, ux=0)
    >>> arch.load(top, fy=1.0)
    >>> result = da.NonlinearStatics(steps=4).run(arch.build())
    >>> linear = da.solve_statics(arch.build())
    >>> result["top.uy"] < linear["top.uy"]  # it stiffens as it rises
    True
    """

    spoken = "nonlinear statics"
    at_rest = True

    steps: int = 10
    tolerance: float = 1e-10
    max_iterations: int = 25

    def __post_init__(self) -> None:
        need_positive(self, ("tolerance",), ("steps", "max_iterations"))

    def run(
        self, model: StructuralModel, parameters: ParameterValues = None, progress: Any = False
    ) -> StructuralResult:
        """Displacements and reactions of every load case; a failed run keeps the last equilibrium.

        Raises
        ------
        SingularityError
            The structure is a mechanism before any load acts.
        """
        p, timing = model.values(parameters), Timing()
        paths = [LoadPath(self, StaticEquations(model, p, case)) for case in model.loads]
        interrupted = False
        try:
            with progress_reporter(progress, f"loading {model.name}") as report:
                for k, path in enumerate(paths):
                    for share in path.follow():
                        report((k + share) / len(paths))
        except KeyboardInterrupt:
            interrupted = True
        u = np.stack([path.u for path in paths], axis=1)
        forces = np.stack([path.forces() for path in paths], axis=1)
        worst = min(paths, key=lambda path: path.reached)
        residual = max(path.residual for path in paths)
        if interrupted:
            text = f"load case {worst.case!r}: stopped at {worst.reached:.4g} of the load"
            status = Status(Outcome.INTERRUPTED, text, worst.reached, residual)
        elif worst.failure:
            text = f"{worst.failure} or take more steps"
            status = Status(Outcome.NOT_CONVERGED, text, worst.reached, residual)
        else:
            status = Status(Outcome.COMPLETED, "nonlinear statics", 1.0, residual)
        timing.lap("loading")
        record = [path.record() for path in paths]
        warnings = [
            path.stability_warning(entry) for path, entry in zip(paths, record, strict=True)
        ]
        warnings = [text for text in warnings if text]
        if status.success:
            text = "not a stable position" if warnings else "stable"
            status = replace(status, message=f"{status.message}, {text}")
        timing.lap("outputs")
        iterations = sum(path.iterations for path in paths)
        factors = [entry.factor for entry in record if entry.factor is not None]
        statistics: dict[str, Any] = {
            "iterations": iterations,
            "factorisations": iterations + len(factors),
            "solver": factors[0].name if factors else "none",
            "stable": not warnings,
            "build time [s]": round(model.build_time, 6),
            **timing.statistics,
        }
        return StructuralResult(
            model, self, p, list(model.loads), u, forces, status, statistics, record, warnings
        )


class LoadPath:
    """Equilibria of one load case under increasing shares of the load."""

    def __init__(self, analysis: NonlinearStatics, equations: StaticEquations):
        self.analysis, self.equations = analysis, equations
        self.case, self.u = equations.case, np.zeros(len(equations.model.degrees))
        self.reached, self.iterations, self.residual = 0.0, 0, 0.0

    @property
    def failure(self) -> str:
        """Message where no equilibrium under the whole load was found; empty otherwise."""
        if self.reached >= 1.0:
            return ""
        return (
            f"load case {self.case!r}: no equilibrium beyond {self.reached:.4g} of the load "
            "(a limit point?); lower the load"
        )

    def follow(self) -> Iterator[float]:
        """Shares of the load with an equilibrium, up to the whole load or until a step fails."""
        step = 1.0 / self.analysis.steps
        while self.reached < 1.0:
            target = min(1.0, self.reached + step)
            u = self._newton(target)
            if u is not None:
                self.u, self.reached = u, target
                yield target
                continue
            step /= 2
            if step < SHORTEST:
                break

    def _newton(self, share: float) -> np.ndarray | None:
        """Equilibrium under a share of the load; None where Newton's method fails.

        Raises
        ------
        SingularityError
            The structure is a mechanism before any load acts.
        """
        u, equations = self.u.copy(), self.equations
        u[equations.held] = share * equations.prescribed
        equilibrium = Equilibrium(equations, share)
        solution = solve(equilibrium, u, full_steps(self.analysis))
        self.iterations += solution.iterations
        if solution.ending is Ending.SINGULAR and self.reached == 0 and not self.iterations:
            equilibrium.step(u, equilibrium.residual(u))  # raises with the nodes that can move
        if not solution.accepted:
            return None
        self.residual = solution.residual
        return solution.x

    def forces(self) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        return self.equations.forces(self.u, self.reached)

    def stability_warning(self, record: StaticsRecord) -> str:
        """Warning about an equilibrium whose stiffness is not positive definite; empty if it is."""
        negative = record.factor.negative if isinstance(record.factor, Factors) else 0
        if not negative:
            return ""
        where = f"load case {self.case!r}" if self.case else "the load"
        return (
            f"{where}: the equilibrium is not stable: its stiffness has {negative} negative "
            f"eigenvalue{'s' * (negative > 1)}, so that the load is beyond a bifurcation or limit "
            "point, and the structure moves to another equilibrium; solve_buckling and "
            "solve_load_path locate that point, a small transverse load or an imperfection leads "
            "to the stable path"
        )

    def record(self) -> StaticsRecord:
        """Tangent stiffness at the end, for gradients; no factors after a failure."""
        matrix = self.equations.stiffness(self.u, self.reached)
        return StaticsRecord(None if self.failure else self.equations.factor(matrix), matrix)


class Equilibrium(Equations[np.ndarray]):
    """Equilibrium of the free displacements under a share of the load."""

    def __init__(self, equations: StaticEquations, share: float):
        self.equations, self.share = equations, share

    def residual(self, x: np.ndarray) -> ForceResidual:
        return self.equations.residual(x, self.share)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, ForceResidual)
        factor = self.equations.factor(residual.stiffness)
        return np.zeros(0) if factor is None else factor.solve(residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        u = x.copy()
        u[self.equations.free] += step
        return u
