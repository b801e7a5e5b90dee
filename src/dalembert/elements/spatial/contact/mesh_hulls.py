"""Meshes as several convex hulls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.base import Look, option
from dalembert.elements.contact.hull import Solid
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.spatial.contact.polyhedron import MOST, ConvexHull
from dalembert.elements.spatial.look import Surface
from dalembert.elements.spatial.mesh import Mesh
from dalembert.elements.spatial.surface import SurfaceMesh
from dalembert.errors import ModelError
from dalembert.packages import optional_package

SINGLE = 1.2e-7
"""Rounding of coordinates in files, by the largest one; binary files have single precision."""


@dataclass(eq=False)
class MeshHulls(Shape):
    """A mesh as several convex hulls, which approximate its concave parts; for ``Collisions``.

    The parts are computed with CoACD (``pip install dalembert[mesh]``), Wei, Liu, Ling & Su, ACM
    Transactions on Graphics 41 (2022). A convex mesh is its own hull; of more than 40 corners,
    those are left out that change it least.

    Parameters
    ----------
    body : body of a mesh
    concavity : largest distance of the surface from the hulls, by the size of the mesh [-]
    most : upper limit of the number of hulls; none by default

    Raises
    ------
    ModelError
        No mesh, or an impossible option.
    UnsupportedError
        CoACD is not installed.

    Examples
    --------
    >>> import tempfile, trimesh
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     size = trimesh.creation.box((0.2, 0.1, 0.05)).export(f"{folder}/brick.stl")
    ...     file = f"{folder}/brick.stl"
    ...     brick = spatial.Mesh("brick", file=file, mass=2.0, position=(0, 0, 0.025))
    >>> len(spatial.contact.MeshHulls(brick).solids())  # convex
    1
    """

    space = 3
    body: Mesh = option("body with the form of a mesh")
    concavity: float = option("largest distance of surface and hulls, by the size", default=0.05)
    most: int | None = option("upper limit of the number of hulls", default=None)

    def __post_init__(self) -> None:
        if not isinstance(self.body, Mesh):
            raise ModelError(f"needs a spatial.Mesh, got {self.body!r:.60}", "MeshHulls")
        if not 0.01 <= self.concavity <= 1:
            text = f"concavity is {self.concavity!r}; give a number from 0.01 to 1"
            raise ModelError(text, "MeshHulls")
        if self.most is not None and self.most < 1:
            raise ModelError(f"most is {self.most!r}; give 1 or more", "MeshHulls")
        self.forms = self._parts(self.body.surface)
        super().__post_init__()

    def _parts(self, surface: SurfaceMesh) -> list[ConvexHull]:
        """Hulls of the parts of a surface; itself if it is convex."""
        from scipy.spatial import ConvexHull as Qhull

        entity = f"MeshHulls of {self.body.name}"
        hull, rounding = Qhull(surface.corners), SINGLE * np.abs(surface.corners).max()
        if hull.volume - surface.volume <= rounding * hull.area:  # convex
            return [self._convex(surface.corners[hull.vertices], entity)]
        coacd: Any = optional_package("coacd", entity, "give several contact.Polyhedron")
        coacd.set_log_level("error")
        parts = coacd.run_coacd(
            coacd.Mesh(surface.corners, surface.triangles),
            threshold=self.concavity,
            max_convex_hull=self.most or -1,
            decimate=True,
            max_ch_vertex=MOST,
        )
        return [ConvexHull.of(np.asarray(corners), entity) for corners, _ in parts]

    def _convex(self, corners: np.ndarray, entity: str) -> ConvexHull:
        """The hull of the corners of a convex mesh, or of those that come nearest to it."""
        if len(corners) <= MOST:
            return ConvexHull.of(corners, entity, self.body.name)
        size = float(np.ptp(corners, axis=0).max())
        chosen, distance = _reduced_hull(corners, MOST)
        if distance > self.concavity * size:
            raise ModelError(
                f"its {len(corners)} corners are convex, and the hull of {MOST} of them, the most "
                f"in collisions, is up to {distance / size:.2g} of the size of the mesh inside its "
                f"surface, where concavity={self.concavity:g} permits less; give a larger "
                "concavity, or use boxes, capsules, cylinders and spheres",
                entity,
            )
        return ConvexHull.of(corners[chosen], entity, self.body.name)

    @property
    def carrier(self) -> Any:
        return self.body

    def solids(self) -> list[Solid]:
        return [Solid(self.body, form.scaled(self.body.scale.sx)) for form in self.forms]

    def look(self, near: Any) -> list[Look]:
        scale = self.body.scale.sx
        return [Surface(self.body, form.corners, form.triangles, scale) for form in self.forms]


def _reduced_hull(points: np.ndarray, most: int) -> tuple[np.ndarray, float]:
    """Numbers of at most ``most`` of the points (n, 3), and the largest distance of the others from
    the planes of their convex hull.

    The corners are extreme along the axes; then the one farthest outside of their hull is added.
    """
    from scipy.spatial import ConvexHull as Qhull

    ends = np.concatenate([points.argmin(axis=0), points.argmax(axis=0)])
    chosen = list(dict.fromkeys(int(k) for k in ends))
    chosen = _with_volume(points, chosen)
    while True:
        planes = Qhull(points[chosen]).equations
        outside = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        outside[chosen] = 0.0
        farthest = int(np.argmax(outside))
        if len(chosen) >= most or outside[farthest] <= 0:
            return np.array(chosen), float(max(outside[farthest], 0.0))
        chosen.append(farthest)


def _with_volume(points: np.ndarray, chosen: list[int]) -> list[int]:
    """The chosen points, and others until they enclose a volume."""
    for _ in range(3):
        relative = points[chosen] - points[chosen[0]]
        basis, sizes, _ = np.linalg.svd(relative.T)
        flat = sizes < 1e-6 * np.ptp(points, axis=0).max()
        rank = int(np.count_nonzero(~flat))
        if rank == 3:
            break
        away = np.abs((points - points[chosen[0]]) @ basis[:, rank:]).max(axis=1)
        chosen = [*chosen, int(np.argmax(away))]
    return chosen
