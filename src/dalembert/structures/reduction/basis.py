"""Which shapes of a reduced structure a floating body takes, and their sizes.

They are modes of the reduced structure with the frame at rest, as combinations of its coordinates.
These combinations stay as they were chosen while parameters change, so that shapes follow them
smoothly: of the modes between the interfaces, whose order, signs and sizes mean nothing, only the
space they span is taken, in the basis with ``Yᵀ Φ = I`` where ``Y = M Φ`` as it was.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from dalembert.errors import AnalysisError, ModelError
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.interface import Interface
from dalembert.text.wording import unknown

MEAN = "mean"
"""Name of the frame that follows the mean axes."""
LOST = 0.1
"""Cosine to the space that the modes spanned below which one has left it."""


@dataclass(frozen=True, eq=False)
class ShapeBasis:
    """Shapes of a body by the coordinates of a reduction.

    Attributes
    ----------
    frame : name of the interface that the frame is fixed in, or ``"mean"``
    coordinates : (r, m) of the shapes: motions of interfaces, then modes between them
    mass : (f, f) sparse, between the interfaces
    momenta : (f, k) ``Y`` of the modes between the interfaces
    """

    frame: str
    coordinates: np.ndarray
    mass: Any
    momenta: np.ndarray

    def held(self, reduced: CraigBampton) -> Interface | None:
        """The interface in which the frame is fixed."""
        return frame_interface(reduced.interfaces, self.frame)

    def turned(self, reduced: CraigBampton) -> tuple[np.ndarray, np.ndarray]:
        """``(Yᵀ Φ)⁻¹`` (k, k), and the shapes (r, m) by the coordinates of this reduction.

        Raises
        ------
        AnalysisError
            A mode has left the space that the modes spanned.
        """
        count = self.momenta.shape[1]
        if not count:
            return np.zeros((0, 0)), self.coordinates
        modes = reduced.shapes[reduced.assembly.free, -count:]
        seen = self.momenta.T @ modes
        cosines = scipy.linalg.eigvalsh(seen.T @ seen, modes.T @ (self.mass @ modes))
        if not cosines[0] > LOST**2:
            raise AnalysisError(
                f"of the {count} lowest modes between the interfaces one has changed places with "
                "another one that is left out, so that the shapes do not follow; take modes= one "
                "more or less, or declare the structure with parameters nearer to these"
            )
        found = self.coordinates.copy()
        found[-count:] = np.linalg.solve(seen, self.coordinates[-count:])
        return np.linalg.inv(seen), found


def modal_basis(
    reduced: CraigBampton, degrees: Numbering, places: np.ndarray, frame: str
) -> ShapeBasis:
    """Modes with the frame at rest, of unit size.

    Raises
    ------
    ModelError
        No such frame, or an interface that does not tell how it turns; no mass.
    """
    held = frame_interface(reduced.interfaces, frame)
    rigid = 0 if held is not None else (3 if degrees.dimension == 2 else 6)
    coordinates = _modes(reduced, held, rigid)
    coordinates = coordinates / _sizes(reduced.shapes @ coordinates, degrees, places)
    free, count = reduced.assembly.free, reduced.frequencies.size
    modes = reduced.shapes[free, reduced.shapes.shape[1] - count :]
    mass = reduced.assembly.inner(reduced.assembly.mass(reduced.p))
    return ShapeBasis(frame, coordinates, mass, mass @ modes)


def frame_interface(interfaces: list[Interface], frame: str) -> Interface | None:
    """The interface of this name, which turns; none for mean axes."""
    if frame == MEAN:
        return None
    known = {i.name: i for i in interfaces}
    if frame not in known:
        raise ModelError(unknown("frame", frame, [*known, MEAN]), "frame")
    if not known[frame].turns:
        raise ModelError(
            f"the interface {frame!r} does not turn, as its nodes have no rotations and lie in a "
            f"line; take more of them, another one, or {MEAN!r}",
            "frame",
        )
    return known[frame]


def _modes(reduced: CraigBampton, held: Interface | None, rigid: int) -> np.ndarray:
    """(r, m) modes of the reduced structure with the frame at rest."""
    size = reduced.stiffness.shape[0]
    kept = np.arange(size)
    if held is not None:
        kept = np.setdiff1d(kept, kept[reduced.columns[held.name]])
    if not kept.size:
        return np.zeros((size, 0))
    a, b = (m[np.ix_(kept, kept)] for m in (reduced.stiffness, reduced.mass))
    vectors = modes_of(a, b)[1]
    found = np.zeros((size, len(kept) - rigid))
    found[kept] = vectors[:, rigid:]
    return found


def modes_of(stiffness: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(m,) squares of the frequencies, not below zero, and (m, m) modes of unit mass."""
    if not len(mass):
        return np.zeros(0), np.zeros((0, 0))
    try:
        squares, modes = scipy.linalg.eigh(stiffness, mass)
    except scipy.linalg.LinAlgError:
        raise ModelError(
            "the mass of its shapes is not positive definite; give all elements a density"
        ) from None
    return np.maximum(squares, 0.0), modes


def _sizes(shapes: np.ndarray, degrees: Numbering, places: np.ndarray) -> np.ndarray:
    """(m,) largest displacements, or turns of the whole length."""
    length = float(np.ptp(places, axis=0).max())
    sizes = np.where(degrees.rotations, length, 1.0)
    return np.abs(sizes[:, None] * shapes).max(axis=0, initial=0.0)
