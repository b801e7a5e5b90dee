"""Basis of the shapes of a floating body, in coordinates of a reduced structure.

The shapes are modes of the reduced structure with the frame at rest, as combinations of its
coordinates. The combinations are constant while parameters change, so that shapes follow
smoothly: of the fixed-interface modes, whose order, signs and sizes are arbitrary, only the space
they span is used, in the basis with ``Yᵀ Φ = I`` where ``Y = M Φ`` at the reference parameters.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from dalembert.errors import AnalysisError, ModelError
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton
from dalembert.model.assembled.reduction.rigid import Interface
from dalembert.text.wording import unknown

MEAN = "mean"
"""Name of the frame that follows the mean axes."""
LOST = 0.1
"""Lower limit of the cosine between a mode and the reference space of modes."""


@dataclass(frozen=True, eq=False)
class ShapeBasis:
    """Shapes of a body in the coordinates of a reduction.

    Attributes
    ----------
    frame : name of the interface to which the frame is fixed, or ``"mean"``
    coordinates : (r, m) of the shapes: motions of interfaces, then fixed-interface modes
    mass : (f, f) sparse, with fixed interfaces
    momenta : (f, k) ``Y`` of the fixed-interface modes
    """

    frame: str
    coordinates: np.ndarray
    mass: Any
    momenta: np.ndarray

    def held(self, reduced: CraigBampton) -> Interface | None:
        """The interface to which the frame is fixed; None for mean axes."""
        return frame_interface(reduced.interfaces, self.frame)

    def adapt(self, reduced: CraigBampton) -> tuple[np.ndarray, np.ndarray]:
        """``(Yᵀ Φ)⁻¹`` (k, k), and the shapes (r, m) in the coordinates of a reduction.

        Raises
        ------
        AnalysisError
            A mode has left the reference space of modes.
        """
        count = self.momenta.shape[1]
        if not count:
            return np.zeros((0, 0)), self.coordinates
        modes = reduced.shapes[reduced.assembly.free, -count:]
        overlap = self.momenta.T @ modes
        cosines = scipy.linalg.eigvalsh(overlap.T @ overlap, modes.T @ (self.mass @ modes))
        if not cosines[0] > LOST**2:
            raise AnalysisError(
                f"of the {count} lowest modes between the interfaces one has changed places with "
                "another one that is left out, so that the shapes do not follow; take modes= one "
                "more or less, or declare the structure with parameters nearer to these"
            )
        coordinates = self.coordinates.copy()
        coordinates[-count:] = np.linalg.solve(overlap, self.coordinates[-count:])
        return np.linalg.inv(overlap), coordinates


def modal_basis(
    reduced: CraigBampton, degrees: Numbering, positions: np.ndarray, frame: str
) -> ShapeBasis:
    """Modes with the frame at rest, of unit size.

    Raises
    ------
    ModelError
        Unknown frame, an interface without rotations, or no mass.
    """
    interface = frame_interface(reduced.interfaces, frame)
    rigid = 0 if interface is not None else (3 if degrees.dimension == 2 else 6)
    coordinates = _modes(reduced, interface, rigid)
    coordinates = coordinates / _sizes(reduced.shapes @ coordinates, degrees, positions)
    free, count = reduced.assembly.free, reduced.frequencies.size
    modes = reduced.shapes[free, reduced.shapes.shape[1] - count :]
    mass = reduced.assembly.inner(reduced.assembly.mass(reduced.p))
    return ShapeBasis(frame, coordinates, mass, mass @ modes)


def frame_interface(interfaces: list[Interface], frame: str) -> Interface | None:
    """The interface of this name, with rotations; None for mean axes."""
    if frame == MEAN:
        return None
    by_name = {i.name: i for i in interfaces}
    if frame not in by_name:
        raise ModelError(unknown("frame", frame, [*by_name, MEAN]), "frame")
    if not by_name[frame].turns:
        raise ModelError(
            f"the interface {frame!r} does not turn, as its nodes have no rotations and lie in a "
            f"line; take more of them, another one, or {MEAN!r}",
            "frame",
        )
    return by_name[frame]


def _modes(reduced: CraigBampton, interface: Interface | None, rigid: int) -> np.ndarray:
    """(r, m) modes of the reduced structure with the frame at rest."""
    size = reduced.stiffness.shape[0]
    moving = np.arange(size)
    if interface is not None:
        moving = np.setdiff1d(moving, moving[reduced.columns[interface.name]])
    if not moving.size:
        return np.zeros((size, 0))
    a, b = (m[np.ix_(moving, moving)] for m in (reduced.stiffness, reduced.mass))
    vectors = modes_of(a, b)[1]
    modes = np.zeros((size, len(moving) - rigid))
    modes[moving] = vectors[:, rigid:]
    return modes


def modes_of(stiffness: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(m,) squared frequencies, clipped at zero, and (m, m) modes of unit mass."""
    if not len(mass):
        return np.zeros(0), np.zeros((0, 0))
    try:
        squares, modes = scipy.linalg.eigh(stiffness, mass)
    except scipy.linalg.LinAlgError:
        raise ModelError(
            "the mass of its shapes is not positive definite; give all elements a density"
        ) from None
    return np.maximum(squares, 0.0), modes


def _sizes(shapes: np.ndarray, degrees: Numbering, positions: np.ndarray) -> np.ndarray:
    """(m,) largest displacements, or rotations times the length of the structure."""
    length = float(np.ptp(positions, axis=0).max())
    sizes = np.where(degrees.rotations, length, 1.0)
    return np.abs(sizes[:, None] * shapes).max(axis=0, initial=0.0)
