"""Shapes of a reduced structure in a frame that floats with it, with second-order displacements.

The frame is fixed in one interface, or follows the mean axes: small displacements then have zero
linear and angular momentum (Tisserand), ``Rᵀ M Φ = 0`` with the rigid motions ``R``. Modes of the
reduced structure with the frame at rest have either property, so that only the frame has rigid
motions, and the shapes are orthogonal.

Shapes ``φ_k, φ_l`` strain the structure in the second order, such as the shortening of a bent beam;
static displacements ``Θ_kl`` relieve the strain, ``K Θ_kl = −(∂K/∂u · φ_k) φ_l`` with the frame at
rest (static modal derivatives: Jain, Tiso, Rutzmoser and Rixen, A quadratic manifold for model
order reduction of nonlinear structural dynamics, Computers & Structures 188, 2017). Their inertia
causes centrifugal stiffening, as in Kane, Ryan and Banerjee (1987). With them the strain energy is
``½ qᵀ K q`` up to the third order, if products with a softer shape move only the stiffest of three
shapes, shared among equals.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from dalembert.elements.flexible.shapes import FloatingShapes, SectionShapes
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.reduction.basis import ShapeBasis, modes_of
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton
from dalembert.model.assembled.reduction.rigid import Interface, carry, rigid_motions, spins

NONE = 1e-7
"""Threshold of a second-order displacement, relative to the largest, below which it is omitted."""


class Relief:
    """Second-order displacements.

    Parameters
    ----------
    held : interface to which the frame is fixed
    shapes : (n, m) with the frame at rest, by increasing stiffness where they were chosen
    stiffness : (m, m) of the shapes
    pairs : (k, 2) shapes; None selects the pairs with significant displacements

    Attributes
    ----------
    shapes : (n, k) displacements of ``q_k q_l``
    """

    def __init__(
        self,
        reduced: CraigBampton,
        held: Interface,
        shapes: np.ndarray,
        stiffness: np.ndarray,
        pairs: np.ndarray | None,
    ):
        self.reduced, self.held, self.first, self.stiffness = reduced, held, shapes, stiffness
        count = shapes.shape[1]
        all_pairs = np.array(list(combinations_with_replacement(range(count), 2)), dtype=int)
        self.pairs = all_pairs.reshape(-1, 2) if pairs is None else pairs
        self.strained = [
            reduced.assembly.stiffness_change(shapes[:, k], reduced.p) for k in range(count)
        ]
        self.loads = np.stack([self.strained[k] @ shapes[:, l] for k, l in self.pairs], axis=1)
        self.moving = self._moving()
        self.full, self.moves = self.solve(-self.loads)
        self.third = shapes.T @ self.loads
        self.along = np.linalg.solve(stiffness, self.subtracted * self.third)
        self.shapes = (self.full + shapes @ self.along) * self.halves
        if pairs is None:
            sizes = np.abs(self.shapes).max(axis=0)
            self._select(sizes > NONE * sizes.max(initial=0.0))

    def _select(self, mask: np.ndarray) -> None:
        self.pairs = self.pairs[mask]
        for name in ("loads", "full", "moves", "third", "along", "shapes"):
            setattr(self, name, getattr(self, name)[:, mask])

    @property
    def halves(self) -> np.ndarray:
        """(k,) one half for squares, otherwise one."""
        return np.where(self.pairs[:, 0] == self.pairs[:, 1], 0.5, 1.0)

    @property
    def subtracted(self) -> np.ndarray:
        """(m, k) part of the full relief along shape i that is subtracted."""
        count = self.first.shape[1]
        return np.array([[1.0 - _share(i, k, l) for k, l in self.pairs] for i in range(count)])

    def _moving(self) -> np.ndarray:
        """Indices of the coordinates of the moving interfaces."""
        size = np.arange(sum(i.motions.shape[1] for i in self.reduced.interfaces))
        return np.setdiff1d(size, size[self.reduced.columns[self.held.name]])

    def solve(
        self, loads: np.ndarray, at_interfaces: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n, k) static displacements under loads, with the held interface fixed, the others rigid.

        They are the sum of constraint modes, whose coordinates are also returned, and of
        displacements with fixed interfaces, which are orthogonal in energy.
        """
        inner, reduced = self.reduced.assembly, self.reduced
        displacements = np.zeros_like(loads)
        if reduced.factor is not None:
            displacements[inner.free] = reduced.factor.solve(loads[inner.free])
        modes = reduced.shapes[:, self.moving]
        efforts = modes.T @ loads
        if at_interfaces is not None:
            efforts += at_interfaces
        if not self.moving.size:
            return displacements, efforts
        stiffness = reduced.stiffness[np.ix_(self.moving, self.moving)]
        moves = np.linalg.solve(stiffness, efforts)
        return displacements + modes @ moves, moves


def _share(i: int, k: int, l: int) -> float:
    """Part of the relief of shapes k and l along shape i, by their order of stiffness."""
    three = (i, k, l)
    return 1.0 / three.count(i) if i == max(three) else 0.0


NO_PAIRS = np.zeros((0, 2), dtype=int)
ROUND_OFF = 1e-13
"""Threshold below which an inertia integral is zero, relative to the norms of its two fields."""


def floating_shapes(
    reduced: CraigBampton,
    degrees: Numbering,
    positions: np.ndarray,
    basis: ShapeBasis,
    pairs: np.ndarray | None,
    structure,
) -> FloatingShapes:
    """Shapes of a reduced structure.

    Parameters
    ----------
    positions : (nodes, d) of the nodes [m]
    pairs : (k, 2) shapes whose products have second-order displacements, which cause centrifugal
        stiffening; None selects the significant pairs

    Raises
    ------
    ModelError
        Second-order displacements in mean axes.
    """
    stiffness, mass = (
        reduced.assembly.stiffness(np.zeros(reduced.assembly.size), reduced.p),
        reduced.assembly.mass(reduced.p),
    )
    interface = basis.held(reduced)
    origin = mass_centre(mass, degrees, positions) if interface is None else interface.place
    rigid = rigid_motions(degrees, positions - origin)
    shapes = reduced.shapes @ basis.adapt(reduced)[1]
    if interface is None:
        shapes -= rigid @ momentum_shares(mass, rigid, shapes)
    modal = symmetric(shapes.T @ (stiffness @ shapes))
    if not shapes.shape[1]:
        pairs = NO_PAIRS
    amplitudes = shapes
    if pairs is None or len(pairs):
        if interface is None:
            raise ModelError(
                "second-order displacements need a frame that is fixed in an interface; give "
                "frame= the name of one",
                structure.name,
            )
        relief = Relief(reduced, interface, shapes, modal, pairs)
        pairs, amplitudes = relief.pairs, np.concatenate([shapes, relief.shapes], axis=1)
    fields = np.concatenate([rigid, amplitudes, carry(degrees, amplitudes)], axis=1)
    counted = _counted(rigid.shape[1], shapes.shape[1], amplitudes.shape[1])
    inertia = _cleared(fields.T @ (mass @ fields)) * counted
    own = slice(rigid.shape[1], rigid.shape[1] + shapes.shape[1])
    modal_mass = inertia[own, own]
    squares, modes = modes_of(modal, modal_mass)
    carrying = modal_mass @ modes
    return FloatingShapes(
        dimension=degrees.dimension,
        frequencies=np.sqrt(squares),
        stiffness=modal,
        mass=modal_mass,
        critical=symmetric(2 * carrying @ (np.sqrt(squares)[:, None] * carrying.T)),
        pairs=pairs,
        inertia=inertia,
        counted=counted,
        sections={i.name: _section(i, origin, amplitudes) for i in reduced.interfaces},
        origin=origin,
        displacements=amplitudes,
        structure=structure,
        p=reduced.p,
    )


def mass_centre(mass, degrees: Numbering, positions: np.ndarray) -> np.ndarray:
    """(d,) centre of mass [m].

    Raises
    ------
    ModelError
        The structure has no mass.
    """
    d = degrees.dimension
    shift = rigid_motions(degrees, positions)[:, :d]
    momentum = mass @ shift
    total = float(shift[:, 0] @ momentum[:, 0])
    if not total > 0:
        raise ModelError("a flexible body needs mass; give its elements a density")
    weights = momentum[degrees.table[:, 0], 0]
    return (weights @ positions) / total


def momentum_shares(mass, rigid: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Rigid motions with the momenta of the shapes, ``(Rᵀ M R)⁻¹ Rᵀ M Φ``."""
    momenta = mass @ rigid
    return np.linalg.solve(rigid.T @ momenta, momenta.T @ shapes)


def _section(interface: Interface, origin: np.ndarray, amplitudes: np.ndarray) -> SectionShapes:
    """Motion of a section from the displacements of its nodes."""
    d = origin.size
    moves = np.linalg.lstsq(interface.motions, amplitudes[interface.degrees], rcond=None)[0]
    return SectionShapes(
        interface.place - origin, _without_roundoff(moves[:d]), _without_roundoff(moves[d:])
    )


def _without_roundoff(rows: np.ndarray) -> np.ndarray:
    """Rows with round-off set to zero."""
    return np.where(np.abs(rows) > ROUND_OFF * np.abs(rows).max(initial=0.0), rows, 0.0)


def _counted(rigid: int, shapes: int, amplitudes: int) -> np.ndarray:
    """(N, N) mask of the inertia entries that are included: one or zero.

    Entries up to the second order of the coordinates are included, the order of the displacements,
    and all entries between rates of amplitudes, so that the energy of a non-rotating frame is a sum
    of squares: without them the mass matrix is indefinite at deflections of two per cent.
    """
    orders = np.repeat([1, 2], [shapes, amplitudes - shapes])
    rotations = spins(3 if rigid == 6 else 2).shape[0]
    order = np.concatenate([np.zeros(rigid, dtype=int), *[orders] * (1 + rotations)])
    mask = order[:, None] + order <= 2
    rates = slice(rigid, rigid + amplitudes)
    mask[rates, rates] = True
    return mask.astype(float)


def symmetric(matrix: np.ndarray) -> np.ndarray:
    return (matrix + matrix.T) / 2


def _cleared(products: np.ndarray) -> np.ndarray:
    """Symmetric part with round-off set to zero."""
    size = np.sqrt(np.maximum(np.diag(products), 0.0))
    products = symmetric(products)
    return np.where(np.abs(products) > ROUND_OFF * np.outer(size, size), products, 0.0)
