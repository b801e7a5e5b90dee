"""Modes of vibration of structures: ``K φ = ω² M φ`` with the prescribed displacements at rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Unpack

import numpy as np

from dalembert.analysis.keywords import ModalKeywords
from dalembert.analysis.requirements import need_count, need_structure
from dalembert.analysis.spectral import SpectralAnalysis
from dalembert.analysis.structural.pencil import Geometric, Loaded, Mass, Pencil, Tangent, Term
from dalembert.analysis.structural.spectrum import Spectrum
from dalembert.analysis.structural.static_equations import free_factors
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError, SingularityError, UnsupportedError
from dalembert.model.assembled.evaluation.eigenpairs import nearest
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import options
from dalembert.results.result import ParameterValues
from dalembert.results.structural.modes import VibrationModes
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.factorise import indefinite_factors
from dalembert.text.arguments import check_arguments


@options
class Modal(SpectralAnalysis[StructuralModel, VibrationModes]):
    """Modes of vibration as a strategy object.

    Parameters
    ----------
    count : number of modes; one more is computed to detect coincidence with the last one
    lumped : lumped instead of consistent mass matrix
    shift : ``σ``: modes nearest to ``ω² = σ`` [rad²/s²]; negative for unsupported structures
    about : statics with one load case (``result.at([0])`` selects it): modes of the loaded state,
        with the tangent stiffness at large displacements, and ``K + K_g`` at small ones

    Raises
    ------
    UnsupportedError
        A count that is not positive; ``about`` with several load cases, or of another analysis.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("bar")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> k = bar.parameter("k", 100.0, unit="N/m")
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=k))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=4.0))
    >>> bar.support(a)
    >>> modes = da.Modal(count=1).run(bar.build(), {"k": 400.0})
    >>> round(float(modes.frequencies[0]) * 2 * math.pi, 6)  # √(k/m)
    10.0
    """

    spoken = "modes of vibration"
    modes_class = VibrationModes

    count: int = 6
    lumped: bool = False
    shift: float = 0.0
    about: StructuralResult | None = None

    def __post_init__(self) -> None:
        need_count(self)
        if self.about is None:
            return
        if not self.about.analysis.at_rest:
            kind = type(self.about.analysis).__name__
            raise UnsupportedError(f"Modal: about is of {kind}; use a result of solve_statics")
        if len(self.about.cases) != 1:
            raise UnsupportedError(
                f"Modal: about has the load cases {', '.join(map(repr, self.about.cases))}; "
                "select one with about=result.at([number])"
            )

    def run(
        self, model: StructuralModel, parameters: ParameterValues = None, progress: Any = False
    ) -> VibrationModes:
        """Modes of vibration at parameter values.

        Raises
        ------
        SingularityError
            A part moves freely and the shift is zero.
        AnalysisError
            No element has mass; ``about`` is of another structure, or failed.
        """
        if self.about is not None:
            parameters = self._loaded_parameters(self.about, model, parameters)
        return super().run(model, parameters)

    def replay(self, result: VibrationModes, p: np.ndarray) -> VibrationModes:
        """The same modes at other parameter values, by their order."""
        if self.about is None:
            return super().replay(result, p)
        statics = self.about.analysis.replay(self.about, p)
        self._loaded_parameters(statics, result.model, None)
        analysis = replace(self, about=statics.at([statics.case(self.about.cases[0])]))
        return super(Modal, analysis).replay(result, p)

    @staticmethod
    def _loaded_parameters(
        about: StructuralResult, model: StructuralModel, parameters
    ) -> np.ndarray:
        if about.model.structure is not model.structure:
            raise AnalysisError(f"about is a result of {about.model.name}, not of this structure")
        if parameters is not None:
            raise AnalysisError("about has its own parameter values; solve its statics with others")
        if not about.status.success:
            raise AnalysisError(f"about is no equilibrium: {about.status}", about.status.residual)
        return about.parameters

    def pencil(self, model: StructuralModel, p: np.ndarray) -> Pencil:
        unloaded = Loaded(model.linearized, p)
        stiffness: list[Term] = [Tangent(unloaded)]
        mass = Mass(unloaded, self.lumped)
        if self.about is not None:
            loaded = Loaded(self.about.model, p, self.about)
            if self.about.model.linear:
                stiffness.append(Geometric(loaded))
            else:
                stiffness, mass = [Tangent(loaded)], Mass(loaded, self.lumped)
        return Pencil(model, stiffness, [mass])

    def spectrum(self, model: StructuralModel, p: np.ndarray) -> Spectrum:
        pencil = self.pencil(model, p)
        a, b = pencil.matrices()
        if not a.shape[0]:
            raise AnalysisError("nothing in the structure can move; release a support")
        values, vectors = nearest(a, b, self.count + 1, self.shift, self._solve(pencil, a, b))
        return Spectrum(pencil, (a, b), values, vectors, self.count)

    def _solve(self, pencil: Pencil, a, b):
        matrix = a - self.shift * b
        if self.shift > 0 or self.about is not None:  # may be indefinite
            try:
                return indefinite_factors(matrix).solve
            except np.linalg.LinAlgError:
                raise SingularityError(
                    f"the stiffness is singular at the shift {self.shift:g}; give another one"
                ) from None
        try:
            factor = free_factors(pencil.model, matrix)
        except SingularityError as error:
            raise SingularityError(
                f"{error}; for an unsupported structure give a negative shift, of the size of the "
                "lowest ω² of interest"
            ) from None
        return factor.solve  # type: ignore[union-attr]


@check_arguments
def solve_modes(
    model: StructuralModel,
    count: int = 6,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[ModalKeywords],
) -> VibrationModes:
    """Frequencies and shapes of free vibration, ``K φ = ω² M φ``.

    Parameters
    ----------
    model : StructuralModel
    count : of the modes
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Modal``: lumped, shift, about

    Raises
    ------
    AnalysisError
        Wrong options, no mass; ``SingularityError`` where a part moves freely.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> chain = da.Structure("two masses")
    >>> nodes = [chain.node(name, x) for name, x in (("a", 0), ("b", 1), ("c", 2), ("d", 3))]
    >>> for k in range(3):
    ...     ends = nodes[k], nodes[k + 1]
    ...     spring = chain.add(structures.AxialSpring(f"k{k}", *ends, stiffness=9.0))
    >>> for node in nodes[1:3]:
    ...     mass = chain.add(structures.PointMass(f"m_{node.name}", node, mass=1.0))
    >>> for end in (nodes[0], nodes[3]):
    ...     chain.support(end)
    >>> modes = da.solve_modes(chain.build(), 2)
    >>> (modes.frequencies * 2 * math.pi)**2  # k/m and 3 k/m
    array([ 9., 27.])
    """
    analysis = analysis_of(Modal, "solve_modes", model, parameters, count=count, **options)
    need_structure(model, "solve_modes", "use linearize")
    return analysis.run(model, parameters)
