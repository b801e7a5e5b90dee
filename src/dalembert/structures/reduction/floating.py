"""Shapes of a reduced structure in a frame that floats with it.

The frame is fixed in one interface, or follows the mean axes: small displacements then have no
linear and angular momentum (Tisserand), ``Rᵀ M Φ = 0`` with the rigid motions ``R``. Modes of the
reduced structure with the frame at rest have either property, so that rigid motions belong to the
frame alone, and the shapes are orthogonal.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg as dense

from dalembert.elements.flexible.shapes import FloatingShapes, SectionShapes
from dalembert.errors import ModelError
from dalembert.structures.numbering import Numbering
from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.interface import Interface
from dalembert.structures.reduction.rigid import carried, rigid_motions, spins
from dalembert.structures.reduction.second_order import second_order_shapes
from dalembert.text import unknown

MEAN = "mean"
"""Name of the frame that follows the mean axes."""
ROUND_OFF = 1e-13
"""Share of the two fields it is a product of below which an integral counts as zero."""


def floating_shapes(
    reduced: CraigBampton,
    degrees: Numbering,
    places: np.ndarray,
    frame: str,
    second_order: bool,
    structure,
) -> FloatingShapes:
    """Shapes of a reduced structure.

    Parameters
    ----------
    places : (nodes, d)
    frame : name of an interface, or ``"mean"``
    second_order : with displacements of second order, which make centrifugal stiffening

    Raises
    ------
    ModelError
        No such frame, or an interface that does not tell how it turns.
    """
    mass = reduced.assembly.mass(reduced.p)
    held = _frame_interface(reduced.interfaces, frame)
    origin = _mass_centre(mass, degrees, places) if held is None else held.place
    rigid = rigid_motions(degrees, places - origin)
    coordinates, squares = _modes(reduced, held, rigid.shape[1])
    shapes = reduced.shapes @ coordinates
    shapes, norm = _at_unit_size(shapes, degrees, places)
    modal_mass = norm**2
    pairs = np.zeros((0, 2), dtype=int)
    amplitudes = shapes
    if second_order and shapes.shape[1]:
        if held is None:
            raise ModelError(
                "second-order displacements need a frame that is fixed in an interface; give "
                "frame= the name of one",
                structure.name,
            )
        pairs, second = second_order_shapes(reduced, held, shapes, squares * modal_mass)
        amplitudes = np.concatenate([shapes, second], axis=1)
    fields = np.concatenate([rigid, amplitudes, carried(degrees, amplitudes)], axis=1)
    return FloatingShapes(
        dimension=degrees.dimension,
        frequencies=np.sqrt(squares),
        stiffness=squares * modal_mass,
        mass=modal_mass,
        pairs=pairs,
        inertia=_cleared(fields.T @ (mass @ fields)) * _up_to_second(rigid, shapes, pairs),
        sections={i.name: _section(i, origin, amplitudes) for i in reduced.interfaces},
        origin=origin,
        displacements=amplitudes,
        structure=structure,
        p=reduced.p,
    )


def _frame_interface(interfaces: list[Interface], frame: str) -> Interface | None:
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


def _modes(
    reduced: CraigBampton, held: Interface | None, rigid: int
) -> tuple[np.ndarray, np.ndarray]:
    """(r, m) modes of the reduced structure with the frame at rest, and their ``ω²``."""
    size = reduced.stiffness.shape[0]
    kept = np.arange(size)
    if held is not None:
        kept = np.setdiff1d(kept, kept[reduced.columns[held.name]])
    if not kept.size:
        return np.zeros((size, 0)), np.zeros(0)
    a, b = (m[np.ix_(kept, kept)] for m in (reduced.stiffness, reduced.mass))
    try:
        squares, vectors = dense.eigh(a, b)
    except dense.LinAlgError:
        raise ModelError(
            "the mass of its shapes is not positive definite; give all elements a density"
        ) from None
    if held is None:
        squares, vectors = squares[rigid:], vectors[:, rigid:]
    found = np.zeros((size, squares.size))
    found[kept] = vectors
    return found, squares


def _at_unit_size(
    shapes: np.ndarray, degrees: Numbering, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Shapes whose largest displacement, or turn of the whole length, is one metre.

    Also by what they were multiplied.
    """
    length = float(np.ptp(places, axis=0).max())
    sizes = np.where(degrees.rotations, length, 1.0)
    largest = np.abs(sizes[:, None] * shapes).max(axis=0, initial=0.0)
    return shapes / largest, 1.0 / largest


def _mass_centre(mass, degrees: Numbering, places: np.ndarray) -> np.ndarray:
    d = degrees.dimension
    shift = rigid_motions(degrees, places)[:, :d]
    momentum = mass @ shift
    total = float(shift[:, 0] @ momentum[:, 0])
    if not total > 0:
        raise ModelError("a flexible body needs mass; give its elements a density")
    weights = momentum[degrees.table[:, 0], 0]
    return (weights @ places) / total


def _section(interface: Interface, origin: np.ndarray, amplitudes: np.ndarray) -> SectionShapes:
    """Motion of the section, read off the displacements of its nodes."""
    d = origin.size
    own = np.linalg.lstsq(interface.motions, amplitudes[interface.degrees], rcond=None)[0]
    return SectionShapes(interface.place - origin, _small(own[:d]), _small(own[d:]))


def _small(rows: np.ndarray) -> np.ndarray:
    """Without round-off."""
    return np.where(np.abs(rows) > ROUND_OFF * np.abs(rows).max(initial=0.0), rows, 0.0)


def _up_to_second(rigid: np.ndarray, shapes: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """One where an entry of the inertia counts in the second order of the coordinates, else zero.

    Strain energy and displacements are not known beyond.
    """
    orders = np.repeat([1, 2], [shapes.shape[1], len(pairs)])
    rotations = spins(3 if rigid.shape[1] == 6 else 2).shape[0]
    every = np.concatenate([np.zeros(rigid.shape[1], dtype=int), *[orders] * (1 + rotations)])
    return np.where(every[:, None] + every <= 2, 1.0, 0.0)


def _cleared(products: np.ndarray) -> np.ndarray:
    """Symmetric, without what is nothing but round-off."""
    size = np.sqrt(np.maximum(np.diag(products), 0.0))
    symmetric = (products + products.T) / 2
    return np.where(np.abs(symmetric) > ROUND_OFF * np.outer(size, size), symmetric, 0.0)
