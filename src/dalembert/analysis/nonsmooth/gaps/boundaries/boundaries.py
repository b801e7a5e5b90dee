"""Boundaries of one element at a position: smooth curves and outlines of polygons."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.smooth_curve import SampledCurve, SmoothCurve
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Polygons
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.elements.contact.hull import Boundary
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel


@dataclass(frozen=True, eq=False)
class LocalBoundaries:
    """Boundaries in the axes of their bodies, with parameter values.

    Attributes
    ----------
    p : (np,) parameters
    curves : different smooth curves
    vertices : (v, 2) of all polygons
    centers, radii : (b, 2), (b,) of balls around all boundaries
    """

    p: np.ndarray
    curves: list[SampledCurve]
    vertices: np.ndarray
    centers: np.ndarray
    radii: np.ndarray


class Boundaries:
    """Boundaries of the shapes of one element, in the axes of their bodies.

    Parameters
    ----------
    model : Model
    listed : boundaries of all shapes

    Attributes
    ----------
    curves : different smooth curves
    curve_of : (b,) number of the curve of each boundary, -1 for a polygon
    counts : (b,) numbers of vertices; a smooth curve has none
    vertices : (2, v) formulas of all boundaries
    """

    def __init__(self, model: Model, listed: list[Boundary]):
        p = model.all_equations.p
        self.curves: list[SmoothCurve] = []
        numbers: dict[tuple, int] = {}
        of_object: dict[int, int] = {}
        for boundary in listed:
            if boundary.curve is None or id(boundary.curve) in of_object:
                continue
            curve = SmoothCurve(boundary.curve, p, model.nominal)
            number = numbers.setdefault(curve.text, len(self.curves))
            if number == len(self.curves):
                self.curves.append(curve)
            of_object[id(boundary.curve)] = number
        self.curve_of = np.array([of_object.get(id(b.curve), -1) for b in listed], dtype=int)
        self.counts = np.array([len(b.vertices) for b in listed], dtype=int)
        self.starts = np.cumsum([0, *self.counts])
        vertices = [vertex for b in listed for vertex in b.vertices]
        self.vertices = ca.densify(ca.horzcat(*vertices)) if vertices else ca.SX(2, 0)
        self._vertices = Kernel(ca.Function("vertices", [p], [self.vertices]))
        self._last: LocalBoundaries | None = None

    def at(self, p: np.ndarray) -> LocalBoundaries:
        """Boundaries with parameter values."""
        if self._last is None or not np.array_equal(self._last.p, p):
            curves = [SampledCurve(curve, p) for curve in self.curves]
            vertices = self._vertices(p)[0].T
            balls = self._balls(curves, vertices)
            self._last = LocalBoundaries(p.copy(), curves, vertices, *balls)
        return self._last

    def _balls(
        self, curves: list[SampledCurve], vertices: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(b, 2) centres and (b,) radii of balls around all boundaries."""
        centers, radii = np.zeros((self.counts.size, 2)), np.zeros(self.counts.size)
        for number, curve in enumerate(curves):
            own = self.curve_of == number
            centers[own], radii[own] = curve.center, curve.radius
        for b in np.flatnonzero(self.counts):
            own = vertices[self.starts[b] : self.starts[b + 1]]
            centers[b] = own.mean(axis=0)
            radii[b] = np.linalg.norm(own - centers[b], axis=1).max()
        return centers, radii

    @property
    def features(self) -> int:
        """Largest number of arcs or sides of a boundary."""
        return max([*(curve.arcs for curve in self.curves), *self.counts], default=1)


class PlacedBoundaries:
    """Boundaries at a position.

    Parameters
    ----------
    boundaries : of one element
    geometry : of the same element
    at : Positions
    p : (np,) parameters
    """

    def __init__(
        self, boundaries: Boundaries, geometry: HullGeometry, at: Positions, p: np.ndarray
    ):
        self.boundaries, self._local = boundaries, boundaries.at(p)
        self.first_shape = len(geometry.shapes) - len(geometry.boundaries)
        self.origins, x = at.origins[self.first_shape :, :2], at.axes
        self.axes = np.stack([x, np.stack([-x[:, 1], x[:, 0]], axis=1)], axis=2)

    def to_world(self, b: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """Inertial components of vectors in the axes of boundaries."""
        turned: np.ndarray = (self.axes[b] @ vectors[:, :, None])[..., 0]
        return turned

    def to_local(self, b: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        """Components of inertial vectors in the axes of boundaries."""
        turned: np.ndarray = np.einsum("nij,ni->nj", self.axes[b], vectors)
        return turned

    def localized(self, b: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Inertial positions in the axes of boundaries."""
        return self.to_local(b, places - self.origins[b])

    @cached_property
    def balls(self) -> tuple[np.ndarray, np.ndarray]:
        """(b, 2) centres and (b,) radii of balls around all boundaries."""
        every = np.arange(len(self.origins))
        return self.origins + self.to_world(every, self._local.centers), self._local.radii

    @cached_property
    def arms(self) -> np.ndarray:
        """(b,) largest distances of points from the origins of the bodies."""
        centers, radii = self.balls
        arms: np.ndarray = np.linalg.norm(centers - self.origins, axis=1) + radii
        return arms

    def polygons(self, b: np.ndarray) -> Polygons:
        """Outlines at their positions."""
        boundaries = self.boundaries
        counts = boundaries.counts[b]
        number = np.minimum(np.arange(counts.max(initial=1)), counts[:, None] - 1)
        local = self._local.vertices[boundaries.starts[b][:, None] + number]
        corners = self.origins[b][:, None] + local @ np.swapaxes(self.axes[b], 1, 2)
        return Polygons.of(corners, counts)

    def by_curve(self, b: np.ndarray) -> list[tuple[SampledCurve, np.ndarray]]:
        """Curves, and the rows of the boundaries that have them."""
        number = self.boundaries.curve_of[b]
        return [
            (self._local.curves[k], np.flatnonzero(number == k))
            for k in np.unique(number[number >= 0])
        ]
