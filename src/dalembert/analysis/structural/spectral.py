"""What analyses of modes of structures share: a pencil, its spectrum, and modes of it."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

import numpy as np

from dalembert.analysis.structural.pencil import Pencil
from dalembert.analysis.structural.spectrum import Spectrum
from dalembert.errors import UnsupportedError
from dalembert.results.result import Analysis, Given
from dalembert.results.status import Status, eigenpairs_status
from dalembert.results.structural.eigenmodes import EigenModes
from dalembert.structures.model import StructuralModel
from dalembert.timing import Timing

E = TypeVar("E", bound=EigenModes)


class SpectralAnalysis(Analysis[StructuralModel, E]):
    """Modes of ``A φ = λ B φ``.

    Parameters
    ----------
    count : of the modes; one more is found, to see whether it coincides with the last
    """

    makes: ClassVar[type[EigenModes]]
    """The modes."""
    count: int

    def __post_init__(self) -> None:
        if not self.count > 0:
            kind = type(self).__name__
            raise UnsupportedError(f"{kind}: count is {self.count}; it must be positive")

    def pencil(self, model: StructuralModel, p: np.ndarray) -> Pencil:
        """``A`` and ``B``."""
        raise NotImplementedError

    def spectrum(self, pencil: Pencil) -> Spectrum:
        """One eigenpair more than are wanted, if there is."""
        raise NotImplementedError

    def run(self, model: StructuralModel, parameters: Given = None, progress: Any = False) -> E:
        p, timing = model.values(parameters), Timing()
        modes = self._modes(p, self.spectrum(self.pencil(model, p)))
        timing.lap("computation")
        modes.statistics.update({"build time [s]": round(model.build_time, 6)}, **timing.statistics)
        return modes

    def replay(self, result: E, p: np.ndarray) -> E:
        """The same modes at other parameter values, by their order."""
        spectrum = self.spectrum(self.pencil(result.model, p))
        spectrum.align(result.record.shapes)
        return self._modes(p, spectrum)

    def _modes(self, p: np.ndarray, spectrum: Spectrum) -> E:
        pencil, count = spectrum.pencil, min(self.count, spectrum.values.size)
        return self.makes(  # type: ignore[return-value]
            pencil.model,
            self,
            p,
            np.arange(1, count + 1),
            spectrum.values[:count],
            spectrum.shapes[:, :count],
            self._status(spectrum, count),
            np.arange(count),
            spectrum,
            {"displacements": pencil.model.assembly.size, "free": int(pencil.free.size)},
        )

    def _status(self, spectrum: Spectrum, count: int) -> Status:
        """How well the eigenpairs fulfil their equation."""
        return eigenpairs_status(f"{self.spoken}: {count} mode(s)", spectrum.residual)
