"""Equilibria of a structure under its load cases, each reached by load steps from rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.load_steps import LoadSteps, StepControl
from dalembert.analysis.equilibrium.stability import equilibrium_text, instability_warnings
from dalembert.analysis.equilibrium.static_equations import StaticEquations, StaticsRecord
from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.timing import Timing

BEYOND = (
    "the load is beyond a bifurcation or limit point, and the structure moves to another "
    "equilibrium; solve_buckling and solve_load_path locate that point, a small transverse load "
    "or an imperfection leads to the stable path"
)


class StructureEquilibrium:
    """Equilibria ``∂W/∂u (U, p) = P`` with ``U_p`` prescribed, one for each load case.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    model : StructuralModel
    p : (np,) parameters
    """

    def __init__(self, analysis: Any, model: StructuralModel, p: np.ndarray):
        self.analysis, self.model, self.p = analysis, model, p
        control = StepControl.of(analysis)
        self.paths = [LoadSteps(control, StaticEquations(model, p, case)) for case in model.loads]

    def execute(self, progress: Reported = False) -> StructuralResult:
        """Displacements and reactions; a failed run keeps the last equilibria."""
        timing, paths, model = Timing(), self.paths, self.model
        interrupted = self._follow(progress)
        u = np.stack([path.u for path in paths], axis=1)
        unbalanced = [path.unbalanced() for path in paths]
        forces = [path.forces(part) for path, part in zip(paths, unbalanced, strict=True)]
        timing.lap("loading")
        record = [path.record() for path in paths]
        warnings = self._instabilities(record)
        sizes = [path.equations.size(part) for path, part in zip(paths, unbalanced, strict=True)]
        residual, iterations = max(sizes), sum(path.iterations for path in paths)
        timing.lap("outputs")
        factors = [entry.factor for entry in record if entry.factor is not None]
        statistics: dict[str, Any] = {
            "iterations": iterations,
            "stable": not warnings,
            "residual [N or N m]": residual,
            "factorisations": iterations + len(factors),
            "solver": factors[0].name if factors else "none",
            "build time [s]": round(model.build_time, 6),
            **timing.statistics,
        }
        return StructuralResult(
            model,
            self.analysis,
            self.p,
            list(model.loads),
            u,
            np.stack(forces, axis=1),
            self._status(interrupted, equilibrium_text(residual, iterations, not warnings)),
            statistics,
            record,
            warnings,
        )

    def _follow(self, progress: Reported) -> bool:
        """Take all load steps; returns whether they were interrupted."""
        count = len(self.paths)
        try:
            with progress_reporter(progress, f"loading {self.model.name}") as report:
                for k, path in enumerate(self.paths):
                    for share in path.follow():
                        report((k + share) / count)
        except KeyboardInterrupt:
            return True
        return False

    def _status(self, interrupted: bool, text: str) -> Status:
        """Status of the load case with the smallest share of its load."""
        worst = min(self.paths, key=lambda path: path.reached)
        outcome = Outcome.COMPLETED
        if interrupted:
            outcome = Outcome.INTERRUPTED
            text = f"load case {worst.case!r}: stopped at {worst.reached:.4g} of the load"
        elif worst.failure:
            outcome, text = Outcome.NOT_CONVERGED, f"{worst.failure} or take more steps"
        return Status(outcome, text, worst.reached, max(path.residual for path in self.paths))

    def _instabilities(self, record: list[StaticsRecord]) -> list[str]:
        warnings: list[str] = []
        for path, entry in zip(self.paths, record, strict=True):
            where = f"load case {path.case!r}" if path.case else "the load"
            warnings += instability_warnings(entry.negative, BEYOND, where)
        return warnings
