"""Vibration of structures: ``K φ = ω² M φ`` with the prescribed displacements at rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.static_equations import free_factors
from dalembert.analysis.modes.pencil import Geometric, Loaded, Mass, Pencil, Tangent, Term
from dalembert.analysis.modes.spectrum import Spectrum
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.assembled.evaluation.eigenpairs import Solve, nearest
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.result import StructuralResult
from dalembert.sparse.factorise import indefinite_factors

COUNT = 6
"""Default number of modes."""


def vibration(
    analysis: Any, model: StructuralModel, p: np.ndarray, about: StructuralResult | None
) -> Spectrum:
    """Modes of vibration nearest to the shift, without loads or about a loaded state.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Modal``
    model : StructuralModel
    p : (np,) parameters
    about : statics with one load case

    Raises
    ------
    AnalysisError
        Nothing can move, or nothing has mass.
    SingularityError
        A part moves freely and the shift is zero.
    """
    pencil = vibration_pencil(model, p, analysis.lumped, about)
    a, b = pencil.matrices()
    if not a.shape[0]:
        raise AnalysisError("nothing in the structure can move; release a support")
    count, shift = analysis.count or COUNT, analysis.shift
    indefinite = shift > 0 or about is not None
    solve = _solver(model, a - shift * b, shift, indefinite)
    values, vectors = nearest(a, b, count + 1, shift, solve)
    return Spectrum(pencil, (a, b), values, vectors, count)


def vibration_pencil(
    model: StructuralModel, p: np.ndarray, lumped: bool, about: StructuralResult | None
) -> Pencil:
    """``K`` and ``M``; with ``K + K_g`` or the tangent stiffness of a loaded state."""
    unloaded = Loaded(model.linearized, p)
    stiffness: list[Term] = [Tangent(unloaded)]
    mass = Mass(unloaded, lumped)
    if about is not None:
        loaded = Loaded(about.model, p, about)
        if about.model.linear:
            stiffness.append(Geometric(loaded))
        else:
            stiffness, mass = [Tangent(loaded)], Mass(loaded, lumped)
    return Pencil(model, stiffness, [mass])


def _solver(model: StructuralModel, matrix: Any, shift: float, indefinite: bool) -> Solve:
    """Solver with factors of the shifted stiffness."""
    if indefinite:
        try:
            return indefinite_factors(matrix).solve
        except np.linalg.LinAlgError:
            raise SingularityError(
                f"the stiffness is singular at the shift {shift:g}; give another one"
            ) from None
    try:
        factor = free_factors(model, matrix)
    except SingularityError as error:
        raise SingularityError(
            f"{error}; for an unsupported structure give a negative shift, of the size of the "
            "lowest ω² of interest"
        ) from None
    return factor.solve  # type: ignore[union-attr]
