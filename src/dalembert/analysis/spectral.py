"""What analyses of modes share, of mechanisms and of structures: a spectrum, and modes of it."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

import numpy as np

from dalembert.results.numbered import Numbered
from dalembert.results.result import Analysis, ParameterValues
from dalembert.results.status import eigenpairs_status
from dalembert.timing import Timing

M = TypeVar("M")
E = TypeVar("E", bound=Numbered)


class SpectralAnalysis(Analysis[M, E]):
    """Modes of a spectrum, numbered from 1.

    A spectrum has ``eigenvalues`` and ``displacements`` of some positions, those ``wanted`` and
    those ``following`` earlier ones, and tells what is ``left`` of its equation.
    """

    makes: ClassVar[type[Numbered]]
    """The modes."""

    def spectrum(self, model: M, p: np.ndarray) -> Any:
        """Eigenvalues and vectors at parameter values."""
        raise NotImplementedError

    def again(self, result: E, p: np.ndarray) -> Any:
        """The same at other ones."""
        return self.spectrum(result.model, p)

    def run(self, model: M, parameters: ParameterValues = None, progress: Any = False) -> E:
        """The modes."""
        timing, p = Timing(), model.values(parameters)  # type: ignore[attr-defined]
        modes = self.modes(self.spectrum(model, p))
        timing.lap("computation")
        build = {"build time [s]": round(model.build_time, 6)}  # type: ignore[attr-defined]
        modes.statistics.update(build, **timing.statistics)
        return modes

    def replay(self, result: E, p: np.ndarray) -> E:
        """The same modes at other parameter values."""
        found = self.again(result, p)
        positions = found.following(result.record, result.positions)
        return self.modes(found, positions, result.numbers[: positions.size])

    def modes(
        self,
        found: Any,
        positions: np.ndarray | None = None,
        numbers: np.ndarray | None = None,
    ) -> E:
        """Modes of a spectrum, at first all that are wanted."""
        positions = found.wanted() if positions is None else positions
        numbers = np.arange(1, positions.size + 1) if numbers is None else numbers
        text = f"{self.spoken}: {positions.size} mode(s)"
        return self.makes(  # type: ignore[return-value]
            found.model,
            self,
            found.p,
            numbers,
            found.eigenvalues[positions],
            found.displacements(positions),
            eigenpairs_status(text, found.left, found.time, found.residual),
            positions,
            found,
            found.statistics,
            found.doubts,
        )
