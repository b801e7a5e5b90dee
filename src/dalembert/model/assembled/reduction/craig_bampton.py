"""Craig–Bampton reduction: constraint modes of the interfaces, and modes between them.

With interface displacements ``u_b = X c`` and the others ``u_i``,

    u = Ψ c + Φ η,     Ψ_i = −K_ii⁻¹ K_ib X,     K_ii φ = ω² M_ii φ

(Craig and Bampton, Coupling of substructures for dynamic analyses, AIAA Journal 6, 1968). It is
exact in statics, and in vibration with all modes; it contains the rigid motions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError, SingularityError
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.eigenpairs import nearest
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.evaluation.stiffness_solvers import factors_of
from dalembert.model.assembled.reduction.rigid import Interface
from dalembert.sparse.solver import Factors


@dataclass(frozen=True, eq=False)
class CraigBampton:
    """A structure in coordinates of its interfaces and a few fixed-interface modes.

    Attributes
    ----------
    assembly : with the displacements of the interfaces prescribed
    interfaces : interfaces in the order of the columns
    p : (np,) parameter values
    shapes : (n, r) displacements of unit coordinates: interfaces in order, then modes
    stiffness, mass : (r, r)
    frequencies : (k,) of the fixed-interface modes [rad/s]
    factor : factors of the stiffness with fixed interfaces
    """

    assembly: Assembly
    interfaces: list[Interface]
    p: np.ndarray
    shapes: np.ndarray
    stiffness: np.ndarray
    mass: np.ndarray
    frequencies: np.ndarray
    factor: Factors | None

    @property
    def columns(self) -> dict[str, slice]:
        """Name of an interface → its columns."""
        ends = np.cumsum([0, *(i.motions.shape[1] for i in self.interfaces)])
        return {i.name: slice(*ends[k : k + 2]) for k, i in enumerate(self.interfaces)}


def craig_bampton(
    assembly: Assembly,
    degrees: Numbering,
    p: np.ndarray,
    interfaces: list[Interface],
    modes: int,
    up_to: float | None = None,
) -> CraigBampton:
    """Reduce a structure.

    Parameters
    ----------
    assembly : without supports
    modes : upper limit of the number of fixed-interface modes
    up_to : upper limit of their frequency [rad/s]

    Raises
    ------
    ModelError, SingularityError
        There are supports, or parts that move without strain with fixed interfaces.
    """
    if assembly.prescribed.size:
        place = degrees.place(int(assembly.prescribed[0]))
        raise ModelError(
            "has supports; a body floats, so remove them and hold it by joints",
            f"support {place[0]}.{place[1]}",
        )
    size = len(degrees)
    held = np.concatenate([np.zeros(0, dtype=int), *(i.degrees for i in interfaces)])
    inner = Assembly(assembly.blocks, size, held, assembly.pattern)
    free, rest = inner.free, np.zeros(size)
    stiffness, mass = inner.stiffness(rest, p), inner.mass(p)
    try:
        factor = factors_of(inner.inner(stiffness), degrees, free)
    except SingularityError as error:
        raise SingularityError(f"with the interfaces at rest {error}") from None
    shapes = _constraint_modes(interfaces, size)
    if factor is not None:
        shapes[free] = -factor.solve((stiffness @ shapes)[free])
    vectors, frequencies = np.zeros((size, 0)), np.zeros(0)
    if factor is not None and modes:
        vectors, frequencies = _fixed_modes(inner, stiffness, mass, factor, modes, up_to)
    shapes = np.concatenate([shapes, vectors], axis=1)
    reduced = [shapes.T @ (matrix @ shapes) for matrix in (stiffness, mass)]
    k, m = ((matrix + matrix.T) / 2 for matrix in reduced)
    return CraigBampton(inner, interfaces, p, shapes, k, m, frequencies, factor)


def _constraint_modes(interfaces: list[Interface], size: int) -> np.ndarray:
    """Unit motions of the interfaces, zero elsewhere."""
    shapes, column = np.zeros((size, sum(i.motions.shape[1] for i in interfaces))), 0
    for interface in interfaces:
        count = interface.motions.shape[1]
        shapes[interface.degrees, column : column + count] = interface.motions
        column += count
    return shapes


def _fixed_modes(
    inner: Assembly, stiffness, mass, factor: Factors, modes: int, up_to: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Fixed-interface modes, and their frequencies."""
    a, b = inner.inner(stiffness), inner.inner(mass)
    try:
        values, vectors = nearest(a, b, min(modes, a.shape[0]), 0.0, factor.solve)
    except AnalysisError as error:
        raise AnalysisError(f"modes between the interfaces: {error}") from None
    frequencies = np.sqrt(values)
    if up_to is not None:
        selected = frequencies <= up_to
        frequencies, vectors = frequencies[selected], vectors[:, selected]
    shapes = np.zeros((inner.size, frequencies.size))
    shapes[inner.free] = vectors
    return shapes, frequencies
