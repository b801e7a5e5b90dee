"""Base of modal analyses of mechanisms and structures."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from dalembert.results.analysis import Analysis, ParameterValues
from dalembert.results.modes import Numbered
from dalembert.results.status import eigenpairs_status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.timing import Timing

M = TypeVar("M")
E = TypeVar("E", bound=Numbered)


class SpectralAnalysis(Analysis[M, E]):
    """Modes of a spectrum, numbered from 1.

    A spectrum has ``eigenvalues`` and the ``displacements`` at positions, the positions ``wanted``
    and those ``following`` an earlier spectrum, and the residual ``left`` of its equation.
    """

    @staticmethod
    def modes_class(model: M) -> type[E]:
        """Class of the modes of a model."""
        raise NotImplementedError

    @classmethod
    def expression(cls, model: Any, measure: str | Expression) -> Expression:
        return cls.modes_class(model).formula(model, measure)

    count: int | None

    def spectrum(self, model: M, p: np.ndarray) -> Any:
        """Eigenvalues and vectors at parameter values."""
        raise NotImplementedError

    def again(self, result: E, p: np.ndarray) -> Any:
        """The spectrum of the model of a result at other parameter values."""
        return self.spectrum(result.model, p)

    def run(self, model: M, parameters: ParameterValues = None, progress: Any = False) -> E:
        """The wanted modes at parameter values."""
        self.for_model(model)
        timing, p = Timing(), model.values(parameters)  # type: ignore[attr-defined]
        modes = self.modes(self.spectrum(model, p))
        timing.lap("computation")
        build = {"build time [s]": round(model.build_time, 6)}  # type: ignore[attr-defined]
        modes.statistics.update(build, **timing.statistics)
        return modes

    def replay(self, result: E, p: np.ndarray) -> E:
        """The same modes at other parameter values."""
        spectrum = self.again(result, p)
        positions = spectrum.following(result.record, result.positions)
        return self.modes(spectrum, positions, result.numbers[: positions.size])

    def modes(
        self,
        spectrum: Any,
        positions: np.ndarray | None = None,
        numbers: np.ndarray | None = None,
    ) -> E:
        """Modes at positions of a spectrum, by default at all wanted ones."""
        positions = spectrum.wanted()[: self.count] if positions is None else positions
        numbers = np.arange(1, positions.size + 1) if numbers is None else numbers
        text = f"{self.display_name}: {positions.size} mode(s)"
        return self.modes_class(spectrum.model)(
            spectrum.model,
            self,
            spectrum.p,
            numbers,
            spectrum.eigenvalues[positions],
            spectrum.displacements(positions),
            eigenpairs_status(text, spectrum.left, spectrum.time, spectrum.residual),
            positions,
            spectrum,
            spectrum.statistics,
            spectrum.warnings,
        )
