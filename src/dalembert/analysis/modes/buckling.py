"""Linear buckling: ``(K + λ K_g(u₀)) φ = 0`` with the displacements ``u₀`` of linear statics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np

from dalembert.analysis.equilibrium.static_equations import free_factors
from dalembert.analysis.equilibrium.statics import Statics
from dalembert.analysis.keywords import BucklingKeywords
from dalembert.analysis.modes.pencil import Geometric, Loaded, Pencil, Tangent, Term
from dalembert.analysis.modes.spectral import SpectralAnalysis
from dalembert.analysis.modes.spectrum import Spectrum
from dalembert.analysis.requirements import need_count
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.assembled.evaluation.eigenpairs import largest
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import options
from dalembert.results.analysis import ParameterValues
from dalembert.results.structural.modes import BucklingModes
from dalembert.text.arguments import check_arguments

LARGE = 0.1
"""Change of a load factor by displacements before buckling that causes a warning [-]."""


class BucklingSpectrum(Spectrum):
    """Eigenpairs of ``−K_g φ = μ K φ``, ``μ = 1/λ``."""

    @property
    def warnings(self) -> tuple[str, ...]:  # type: ignore[override]
        """Warning where displacements before buckling change the first load factor.

        The change of the stiffness along them, ``∂³W/∂u³ · u₀``, contains that by the stresses; in
        the shape ``φ`` of the mode, both are compared.
        """
        state, shape = self.pencil.left[0].state, self.shapes[:, 0]
        assembly = state.model.assembly
        by_stresses, whole = (
            float(shape @ (matrix(state.u, state.p) @ shape))
            for matrix in (assembly.geometric, assembly.stiffness_change)
        )
        if abs(whole - by_stresses) <= LARGE * abs(by_stresses):
            return ()
        factor, estimate = 1 / self.eigenvalues[0], "there may be none"
        if whole * by_stresses > 0:
            estimate = f"it may be nearer to {factor * by_stresses / whole:.3g}"
        return (
            "displacements before buckling change the stiffness like the stresses: the load factor "
            f"is {factor:.4g} without them, and {estimate} with them; follow the path of the load "
            "by solve_load_path",
        )


@options
class Buckling(SpectralAnalysis[StructuralModel, BucklingModes]):
    """Linear buckling as a strategy object.

    ``K_g = σ₀ · ∂²ε/∂u² (0)`` with the stresses ``σ₀`` of linear statics (Zienkiewicz & Taylor, The
    Finite Element Method 2, 2000, ch. 11). Displacements before buckling must be small. Prescribed
    displacements belong to every load case, as in statics.

    Parameters
    ----------
    count : number of modes; one more is computed to detect coincidence with the last one
    case : load case multiplied by the factor ``λ``
    constant : load case with constant factor, ``(K + K_g(u_c) + λ K_g(u₀)) φ = 0``
    negative : whether negative load factors count, too; modes are sorted by magnitude

    Raises
    ------
    UnsupportedError
        A count that is not positive.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> strut = da.Structure("strut")
    >>> EI = strut.parameter("EI", 2e4, unit="N m^2")
    >>> nodes = [strut.node(f"n{k}", 0.5 * k, 0) for k in range(5)]
    >>> for k in range(4):
    ...     numbers = dict(area=1e-3, second_moment=EI / 2e11, modulus=2e11)
    ...     beam = strut.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **numbers))
    >>> strut.support(nodes[0])
    >>> strut.load(nodes[4], fx=-1.0)
    >>> modes = da.Buckling(count=1).run(strut.build(), {"EI": 1e4})
    >>> round(float(modes.load_factors[0]) * 16 / (math.pi**2 * 1e4), 3)  # of π² E I/(2 L)²
    1.0
    """

    display_name = "linear buckling"
    kinds = ("structure",)
    instead = "use linearize about loaded equilibria"

    count: int = 3
    case: str = ""
    constant: str | None = None
    negative: bool = False

    def __post_init__(self) -> None:
        need_count(self)

    @staticmethod
    def modes_class(model: StructuralModel) -> type[BucklingModes]:
        return BucklingModes

    def run(
        self, model: StructuralModel, parameters: ParameterValues = None, progress: Any = False
    ) -> BucklingModes:
        """Buckling modes at parameter values.

        Raises
        ------
        SingularityError
            The structure is a mechanism, or it buckles under the constant load alone.
        AnalysisError
            Unknown load case; no load factor of the requested sign.
        """
        return super().run(model, parameters)

    def pencil(self, model: StructuralModel, p: np.ndarray) -> Pencil:
        statics = Statics().run(model, p)

        def loaded(case: str) -> Loaded:
            return Loaded(statics.model, p, statics.at(np.array([statics.case(case)])))

        stiffness: list[Term] = [Tangent(Loaded(statics.model, p))]
        if self.constant is not None:
            stiffness.append(Geometric(loaded(self.constant)))
        return Pencil(model, [Geometric(loaded(self.case), -1.0)], stiffness)

    def spectrum(self, model: StructuralModel, p: np.ndarray) -> Spectrum:
        pencil = self.pencil(model, p)
        a, b = pencil.matrices()
        factor = free_factors(pencil.model, b)
        if factor is None:
            raise AnalysisError("nothing in the structure can move; release a support")
        if self.constant is not None and factor.negative:
            raise SingularityError(
                f"load case {self.constant!r} alone makes the structure buckle; lower it"
            )
        values, vectors = largest(a, b, self.count + 1, factor.solve, self.negative)
        if not values.size:
            raise AnalysisError(
                f"load case {self.case!r} does not make the structure buckle in this direction; "
                "negative=True finds factors of the reversed load"
            )
        return BucklingSpectrum(pencil, (a, b), values, vectors, self.count)


@check_arguments
def solve_buckling(
    model: StructuralModel,
    count: int = 3,
    case: str = "",
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[BucklingKeywords],
) -> BucklingModes:
    """Load factors at which a structure buckles, ``(K + λ K_g(u₀)) φ = 0``.

    Parameters
    ----------
    model : StructuralModel
    count : of the modes
    case : load case multiplied by the factor
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Buckling``: constant, negative

    Raises
    ------
    AnalysisError
        Wrong options, unknown load case, no load factor; ``SingularityError`` where the structure
        is a mechanism.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> strut = da.Structure("strut")
    >>> nodes = [strut.node(f"n{k}", 0.5 * k, 0) for k in range(5)]
    >>> for k in range(4):
    ...     numbers = dict(area=1e-3, second_moment=1e-7, modulus=2e11)
    ...     beam = strut.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **numbers))
    >>> strut.support(nodes[0], ux=0, uy=0)
    >>> strut.support(nodes[4], uy=0)
    >>> strut.load(nodes[4], fx=-1.0)
    >>> factors = da.solve_buckling(strut.build(), 2).load_factors
    >>> (factors * 4 / (math.pi**2 * 2e4)).round(2)  # of π² E I/L²: 1 and, nearly, 4
    array([1.  , 4.03])
    """
    analysis = analysis_of(
        Buckling, "solve_buckling", model, parameters, count=count, case=case, **options
    )
    return analysis.run(model, parameters)
