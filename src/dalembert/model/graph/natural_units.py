"""Estimation of the natural units of a mechanism at its guesses.

All units are covariant: a mechanism written in other units of length, mass or time has the same
scales in those units.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.contact.beam_line import BeamLine
from dalembert.elements.contact.beam_surface import BeamSurface
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact import ShapeContact
from dalembert.elements.contact.shapes import Shape
from dalembert.errors import ModelError
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.description import Description
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.scales import Scales
from dalembert.symbolic.formulas.expression import Expression, free_symbols

STATIONS = 9
"""Points on a curved boundary by which its size is estimated."""
Quantity = tuple[str, Expression, Mapping]
"""Name, formula and properties of a checked quantity."""


def scales_of(d: Description, equations: Equations, guesses: Guesses, p: np.ndarray) -> Scales:
    """Scales of a mechanism with parameter values ``p``."""
    at = _AtGuesses(d, equations, guesses, p)
    length = at.length
    displacements = np.where(guesses.metres, length, 1.0)
    for k in np.flatnonzero([unit not in ("m", "rad") for unit in guesses.speed_units]):
        per_unit = _largest(at.jacobian[at.in_metres][:, k].data)
        displacements[k] = length / per_unit if per_unit else 1.0
    mass = _largest(at.masses * (displacements / length) ** 2)
    force = at.force(displacements) / length
    rate = at.rate(displacements, np.where(at.in_metres, length, 1.0))
    if mass and force:
        rate = max(rate, np.sqrt(force / (mass * length)))
    rate = rate or 1.0
    mass = mass or force / (length * rate**2) or 1.0
    return Scales(
        length=length,
        size=at.size,
        distance=at.distance,
        mass=mass,
        time=1.0 / rate,
        force=force or mass * length * rate**2,
        coordinates=at.with_states(at.reach(displacements), displacements, force * length, rate),
        displacements=displacements,
        rows=np.where(at.in_metres, length, 1.0),
    )


def collision_shapes(d: Description) -> Iterator[Shape]:
    """Shapes of ``Collisions``."""
    for element in d.elements.values():
        if isinstance(element, Collisions):
            for group in element.groups.values():
                yield from group


def contact_shapes(d: Description) -> Iterator[Shape]:
    """Shapes of all contact elements."""
    yield from collision_shapes(d)
    for element in d.elements.values():
        if isinstance(element, ShapeContact):
            yield from element.shapes


def body_sizes(d: Description, e: Equations, p: np.ndarray) -> dict[str, float]:
    """Size of the largest contact shape of each body, by names; bodies without extent have none.

    The ground has none, as its extent does not affect any motion.
    """
    shapes = [shape for shape in contact_shapes(d) if d.ground not in shape.bodies]
    parameters = {symbol.name() for symbol in ca.vertsplit(e.p)}
    formulas = [_formulas(shape, parameters) for shape in shapes]
    values = ca.Function("sizes", [e.p], [f for own in formulas for f in own]).call([p])
    numbers, sizes = iter(values), dict[str, float]()
    for shape, own in zip(shapes, formulas, strict=True):
        extents = [float(np.ptp(next(numbers).full(), axis=1).max(initial=0.0)) for _ in own]
        size = max((extent for extent in extents if np.isfinite(extent)), default=0.0)
        for body in shape.bodies if size > 0 else ():
            sizes[body.name] = max(size, sizes.get(body.name, 0.0))
    return sizes


def _formulas(shape: Shape, parameters: set[str]) -> list[ca.SX]:
    """Rows of values whose ranges are lengths of a shape, which depend on parameters only."""
    own = (formula.sx for _, formula, meta in shape.checked_quantities("") if meta["unit"] == "m")
    rows = [ca.horzcat(-ca.vec(f), ca.vec(f)) for f in own]  # radii and halves of sizes
    corners = _corners(shape)
    boundary = shape.boundary()
    if boundary is not None and boundary.curve is not None:
        first, last = boundary.curve.interval()
        stations = np.linspace(float(first), float(last), STATIONS)
        corners += [boundary.curve.position(ca.SX(station)) for station in stations]
    if len(corners) > 1:
        rows.append(ca.horzcat(*corners))
    return [row for row in rows if free_symbols(row) <= parameters]


def _corners(shape: Shape) -> list[ca.SX]:
    """Corners of the solids of a shape, or ends of a chord of a beam along it; none of a shape
    without solids."""
    if isinstance(shape, (BeamLine, BeamSurface)):
        return [ca.SX.zeros(1), shape.beam.length.sx / (shape.beam.count - 1)]
    try:
        return [corner for solid in shape.solids() for corner in solid.hull.corners]
    except ModelError:
        return []


class _AtGuesses:
    """Values of the equations at the guesses, with zero for missing ones."""

    def __init__(self, d: Description, e: Equations, guesses: Guesses, p: np.ndarray):
        self.d, self.e, self.p, self.guesses = d, e, p, guesses
        self.y, self.v = guesses.values(p)
        self.owners = d.rows
        units = [c.units()[k] for c, k in self.owners]
        self.in_metres = np.array([unit == "m" for unit in units], dtype=bool)
        drift = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        stiffness = e.by_displacement(e.force)
        outputs = [e.constraints, e.jacobian, drift, e.mass, e.force, stiffness, e.lift]
        values = ca.Function("at_guesses", [e.t, e.y, e.v, e.p], outputs)(0.0, self.y, self.v, p)
        self.gaps, self.drift, self.forces = (values[k].full().ravel() for k in (0, 2, 4))
        self.jacobian, self.stiffness = values[1].sparse().tocsr(), values[5].sparse().tocoo()
        self.masses = values[3].sparse().diagonal()
        self.lift = abs(values[6].sparse()).tocsr()
        self._parameters = {symbol.name() for symbol in ca.vertsplit(e.p)}

    @cached_property
    def length(self) -> float:
        """The largest arm or length of a constraint; else any length; else 1."""
        if self._of_joints:
            return self._of_joints
        return max(self._length_of_free_bodies(), _largest(self.gaps[self.in_metres])) or 1.0

    @cached_property
    def _of_joints(self) -> float:
        return max(self._largest_arm(), self._largest_length(self.d.constraints))

    @cached_property
    def size(self) -> float:
        """The largest arm of a joint, or the side of a square or cube that as many bodies fill as
        have contact shapes, each of the size of the largest one; independent of positions. The
        length without any, and at most the length."""
        sizes = body_sizes(self.d, self.e, self.p)
        dimension = max((shape.dimension for shape in contact_shapes(self.d)), default=3)
        packed = max(sizes.values(), default=0.0) * len(sizes) ** (1 / dimension)
        return min(max(self._of_joints, packed) or self.length, self.length)

    @property
    def distance(self) -> float:
        """Largest coordinate in metres."""
        return _largest(self.y[np.array(self.guesses.units) == "m"])

    def _length_of_free_bodies(self) -> float:
        """The largest length of a body or a force element; at least the size of the smallest shape
        of ``Collisions``, as positions near the origin are no sizes."""
        elements = [*self.d.bodies, *self.d.forces]
        sizes = self._sizes([shape.checked_quantities("") for shape in collision_shapes(self.d)])
        return max(self._largest_length(elements), min(sizes[sizes > 0], default=0.0))

    def _sizes(self, parts: list[list[Quantity]]) -> np.ndarray:
        """Largest length of each part; 0 where it has none."""
        own = [self._in_metres(part) for part in parts]
        values = iter(self._lengths([quantity for part in own for quantity in part]))
        return np.array([max((_largest(next(values)) for _ in part), default=0.0) for part in own])

    def _largest_arm(self) -> float:
        """``|∂Φ/∂φ|`` over the equations in metres of a constraint: an arm, independent of φ."""
        angles = np.array([unit == "rad" for unit in self.guesses.speed_units], dtype=bool)
        squares = self.jacobian.multiply(self.jacobian).tocsr()[:, angles]
        owner = [id(constraint) for constraint, _ in self.owners]
        by_constraint: dict[tuple[int, int], float] = {}
        entries = squares.tocoo()
        for row, column, square in zip(entries.row, entries.col, entries.data, strict=True):
            if self.in_metres[row]:
                at = owner[row], column
                by_constraint[at] = by_constraint.get(at, 0.0) + square
        return float(np.sqrt(_largest(np.array(list(by_constraint.values())))))

    def _largest_length(self, elements: list) -> float:
        """Largest quantity in metres that depends on parameters only."""
        return _largest(self._sizes([element.checked_quantities() for element in elements]))

    def _in_metres(self, quantities: list[Quantity]) -> list[Quantity]:
        """Those in metres that depend on parameters only."""
        own = self._parameters
        return [q for q in quantities if q[2]["unit"] == "m" and free_symbols(q[1].sx) <= own]

    def _lengths(self, quantities: list[Quantity]) -> list[np.ndarray]:
        """Values of the quantities in metres that depend on parameters only."""
        formulas = [formula.sx for _, formula, _ in self._in_metres(quantities)]
        values = ca.Function("lengths", [self.e.p], formulas).call([self.p])
        return [value.full() for value in values]

    def reach(self, displacements: np.ndarray) -> np.ndarray:
        """Largest change of each coordinate by displacements of these sizes."""
        if self.e.manifold.flat:
            return displacements
        if not displacements.size:
            return np.ones(self.e.coordinate_count)
        sizes = self.lift.multiply(displacements).max(axis=1).toarray().ravel()
        return np.where(np.array(self.guesses.units) == "m", sizes, 1.0)

    def with_states(
        self, sizes: np.ndarray, displacements: np.ndarray, energy: float, rate: float
    ) -> np.ndarray:
        """Sizes of coordinates with those of states of first order.

        A state has the size of its initial value or of its change in the natural time, or of the
        change that its forces need to do the natural work, whichever is smaller; else 1.
        """
        states = list(self.e.states)
        if not states:
            return sizes
        outputs = [self.e.pose_rate[states], ca.jacobian(self.e.force, self.e.y[states])]
        function = ca.Function("states", [self.e.t, self.e.y, self.e.v, self.e.p], outputs)
        rates, slopes = (out.full() for out in function(0.0, self.y, self.v, self.p))
        own = np.maximum(np.abs(self.y[states]), np.abs(rates.ravel()) / rate)
        gains = np.abs(slopes * displacements[:, None]).max(axis=0, initial=0.0)
        for k, state in enumerate(states):
            acting = energy / gains[k] if gains[k] > 0 and np.isfinite(gains[k]) else 0.0
            candidates = [size for size in (own[k], acting) if size > 0 and np.isfinite(size)]
            sizes[state] = min(candidates, default=1.0)
        return sizes

    def force(self, displacements: np.ndarray) -> float:
        """Largest work of an applied force along a displacement of its scale."""
        k = self.stiffness
        elastic = np.abs(k.data) * displacements[k.row] * displacements[k.col]
        return max(_largest(self.forces * displacements), _largest(elastic))

    def rate(self, displacements: np.ndarray, rows: np.ndarray) -> float:
        """Fastest initial or driven speed, relative to the scale of its displacement."""
        return max(_largest(self.v / displacements), _largest(self.drift / rows))


def _largest(values: np.ndarray) -> float:
    """Largest finite magnitude; 0 for an empty array."""
    values = np.abs(np.asarray(values, dtype=float))
    return float(np.max(values, initial=0.0, where=np.isfinite(values)))
