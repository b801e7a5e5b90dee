"""Planar region with a polygonal outline and holes, whose dimensions may be formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import ModelError
from dalembert.model.meshes.boundary import Circle, Edge, Piece
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, splines_of
from dalembert.symbolic.formulas.parameter import Parameter


class Region:
    """Loops of a region at the values of its parameters, and formulas of its numbers.

    Attributes
    ----------
    loops : of pieces, the outline first
    formulas : number of a coordinate or radius → its formula
    values : all coordinates and radii: x and y of each vertex and centre, then the radii
    """

    def __init__(
        self, vertices: Sequence[Any], holes: Sequence[Any], parameters: Mapping[str, Parameter]
    ):
        self._parameters = list(parameters.values())
        self.values: list[float] = []
        self.formulas: dict[int, Expression] = {}
        self.loops: list[list[Piece]] = [self._outline(vertices, "edge", "vertices")]
        for k, hole in enumerate(holes):
            group = f"hole{k + 1}"
            if _is_circle(hole):
                self.loops.append([self._circle(hole, group)])
            else:
                self.loops.append(self._outline(hole, group, f"holes[{k}]"))
        self._check()

    def _number(self, value: Any, entity: str) -> float:
        number = len(self.values)
        expression = as_expression(value, entity, "m")
        if expression.sx.is_constant():
            self.values.append(float(expression.sx))
        else:
            symbols = [parameter.sx for parameter in self._parameters]
            function = ca.Function("shape", symbols, [expression.sx], {"allow_free": True})
            if function.has_free():
                free = ", ".join(function.get_free())
                raise ModelError(f"depends on {free}; give parameters=system.parameters", entity)
            values = [parameter.value for parameter in self._parameters]
            self.values.append(float(function(*values)))
            self.formulas[number] = expression
        return self.values[-1]

    def _place(self, place: Any, entity: str) -> tuple[int, np.ndarray]:
        if not isinstance(place, (list, tuple, np.ndarray)) or len(place) != 2:
            raise ModelError(f"expected two coordinates, got {place!r:.60}", entity)
        number = len(self.values)
        return number, np.array([self._number(value, entity) for value in place])

    def _outline(self, vertices: Sequence[Any], group: str, entity: str) -> list[Piece]:
        if len(vertices) < 3:
            raise ModelError(f"has {len(vertices)} vertices; an area needs three", entity)
        placed = [self._place(vertex, f"{entity}[{k}]") for k, vertex in enumerate(vertices)]
        following = placed[1:] + placed[:1]
        edges: list[Piece] = []
        for k, ((i, start), (j, end)) in enumerate(zip(placed, following, strict=True)):
            if np.array_equal(start, end):
                raise ModelError("is at the same place as the vertex before", f"{entity}[{k + 1}]")
            name = f"edge{k + 1}" if group == "edge" else group
            edges.append(Edge((i, j), start, end, name))
        return edges

    def _circle(self, hole: Any, group: str) -> Circle:
        entity = f"holes[{int(group[4:]) - 1}]"
        number, center = self._place(hole[0], f"{entity}.center")
        radius = self._number(hole[1], f"{entity}.radius")
        if not radius > 0:
            raise ModelError(f"the radius is {radius:g}; give a positive length", entity)
        return Circle(number, center, radius, group)

    def _check(self) -> None:
        """Check that no pieces cross, and that holes lie in the outline and beside each other."""
        outlines = [_chords(loop) for loop in self.loops]
        for k, loop in enumerate(outlines):
            entity = "vertices" if k == 0 else f"holes[{k - 1}]"
            if _crosses_itself(loop):
                raise ModelError(
                    "edges cross or touch; order the vertices along the outline", entity
                )
            if k and not _inside(loop[0], outlines[0]):
                raise ModelError("is not within the outline; move it inside", entity)
            for j in range(k):
                if _cross(loop, outlines[j]) or (j and _inside(loop[0], outlines[j])):
                    other = "the outline" if j == 0 else f"holes[{j - 1}]"
                    raise ModelError(f"crosses or touches {other}; move them apart", entity)

    @property
    def area(self) -> float:
        """Area of the region [m²]."""
        outline, *holes = (abs(_area(_chords(loop))) for loop in self.loops)
        return outline - sum(holes)

    def moved(self, points: np.ndarray, along_x: np.ndarray, along_y: np.ndarray) -> np.ndarray:
        """(count, 2) formulas of the points whose displacements by numbers have these weights."""
        numbers = sorted(self.formulas)
        formulas = [self.formulas[k] for k in numbers]
        change = ca.vertcat(
            *(f.sx - self.values[k] for f, k in zip(formulas, numbers, strict=True))
        )
        splines = splines_of(*formulas)
        result = np.empty(points.shape, dtype=object)
        for axis, weights in enumerate((along_x, along_y)):
            weights = np.where(np.abs(weights) > 1e-12, weights, 0.0)
            column = points[:, axis] + ca.mtimes(ca.sparsify(ca.DM(weights)), change)
            for k, row in enumerate(ca.vertsplit(column)):
                moves = weights[k].any()
                value = Expression(row, splines=splines) if moves else float(points[k, axis])
                result[k, axis] = value
        return result


def _is_circle(hole: Any) -> bool:
    return len(hole) == 2 and isinstance(hole[0], (list, tuple, np.ndarray))


def _chords(loop: Sequence[Piece]) -> np.ndarray:
    """(n, 2) vertices of a loop, of a circle by 48 points."""
    shares = (np.arange(48) / 48) if isinstance(loop[0], Circle) else (0.0,)
    return np.array([piece.at(float(s)) for piece in loop for s in shares])


def _area(loop: np.ndarray) -> float:
    x, y = loop.T
    return float(x @ np.roll(y, -1) - np.roll(x, -1) @ y) / 2


def _inside(place: np.ndarray, loop: np.ndarray) -> bool:
    (x0, y0), (x1, y1) = loop.T, np.roll(loop, -1, axis=0).T
    spans = (y0 > place[1]) != (y1 > place[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = x0 + (place[1] - y0) * (x1 - x0) / (y1 - y0)
    return bool((spans & (place[0] < at)).sum() % 2)


def _crossings(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(n, m) whether edges of two loops cross or touch."""
    p, q = first[:, None], np.roll(first, -1, axis=0)[:, None]
    r, s = second[None], np.roll(second, -1, axis=0)[None]

    def side(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        u, v = b - a, c - a
        turn = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        scale = np.linalg.norm(u, axis=-1) * np.linalg.norm(v, axis=-1)
        return np.where(np.abs(turn) <= 1e-12 * scale, 0.0, np.sign(turn))

    apart = (np.minimum(p, q) > np.maximum(r, s)) | (np.maximum(p, q) < np.minimum(r, s))
    straddle = (side(p, q, r) * side(p, q, s) <= 0) & (side(r, s, p) * side(r, s, q) <= 0)
    return np.asarray(straddle & ~apart.any(axis=-1))


def _cross(first: np.ndarray, second: np.ndarray) -> bool:
    return bool(_crossings(first, second).any())


def _crosses_itself(loop: np.ndarray) -> bool:
    n = len(loop)
    crossings = _crossings(loop, loop)
    i, j = np.indices((n, n))
    beside = ((i - j) % n <= 1) | ((j - i) % n <= 1)
    if n > 3 and (crossings & ~beside).any():
        return True
    u, v = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    turn = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    size = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    return bool(((turn <= 1e-12 * size) & ((u * v).sum(axis=1) < 0)).any()) or _area(loop) == 0
