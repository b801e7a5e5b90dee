"""The primitives of a mechanism in the plane, each as plain data with where and how it moves."""

from __future__ import annotations

import re
from functools import singledispatchmethod
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.look import (
    Arrow,
    Ball,
    Belt,
    Block,
    Disc,
    Limit,
    Link,
    Mark,
    Mesh,
    Path,
    Rail,
    Rotary,
    Segment,
    Travel,
    Twist,
)
from dalembert.elements.point import Point
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pivots import Pivots
from dalembert.symbolic.expression import Expression

CURVE_SAMPLES = 181
Place = dict[str, Any]


class Sketch:
    """Takes primitives one by one.

    Parameters
    ----------
    motion : whose elements are drawn
    keep : instants
    loads : forces, moments and stops are drawn too

    Attributes
    ----------
    size : of the mechanism, for what has no size of its own
    shapes : name of a body → what lies on it
    joints, links, symbols : what stands between bodies, or alone
    """

    size = 1.0

    def __init__(self, motion: LabelledRecording, keep: np.ndarray, loads: bool):
        self.motion, self.model, self.keep, self.loads = motion, motion.model, keep, loads
        self.data, self.parameters = motion.data, self.model.equations.p
        self.elements = [*self.model.constraints, *self.model.forces]
        self.pivots = Pivots(self.elements)
        names = ["ground", *(b.name for b in self.model.bodies)]
        self.shapes: dict[str, list[dict]] = {name: [] for name in names}
        self.joints: list[dict] = []
        self.links: list[dict] = []
        self.symbols: list[dict] = []
        self.later: list[tuple[dict, tuple[str, ...], ca.SX]] = []

    # numbers ---------------------------------------------------------------------------
    def number(self, sx: ca.SX) -> np.ndarray:
        """A formula of parameters."""
        value = ca.Function("n", [self.parameters], [ca.densify(sx)])
        return np.asarray(value(self.motion.parameters).full()).ravel()

    def size_of(self, sx: ca.SX) -> float:
        return float(self.number(sx)[0])

    def local(self, point: Point) -> list[float]:
        return self.number(point.local.sx).tolist()

    def place(self, point: Point) -> Place:
        return {"body": point.body.name, "point": self.local(point)}

    def fill_in(self) -> None:
        """Columns of what moves by itself, all in one pass over the states."""
        if not self.later:
            return
        columns = self.motion.columns([Expression(sx) for _, _, sx in self.later])
        for (described, names, _), values in zip(self.later, columns, strict=True):
            rows = values[self.keep].reshape(len(self.keep), len(names)).T
            described |= dict(zip(names, rows.tolist(), strict=True))

    # primitives ------------------------------------------------------------------------
    @singledispatchmethod
    def draw(self, look: Look, element: Any) -> None:
        raise NotImplementedError(f"{type(look).__name__} has no drawing in the plane")

    @draw.register
    def _(self, look: Segment, element: Any) -> None:
        ends = {"from": self.local(look.point_i), "to": self.local(look.point_j)}
        self.shapes[look.point_i.body.name].insert(0, {"kind": "bar", **ends})

    @draw.register
    def _(self, look: Ball, element: Any) -> None:
        shape = {"kind": "particle", "center": self.local(look.point)}
        self.shapes[look.point.body.name].append(shape)

    @draw.register
    def _(self, look: Disc, element: Any) -> None:
        shape = {"center": self.local(look.point), "radius": self.size_of(look.radius)}
        self.shapes[look.point.body.name].append({"kind": "disc", **shape})

    @draw.register
    def _(self, look: Block, element: Any) -> None:
        x, y = self.number(look.direction)
        wide = 0.12 * self.size
        shape: dict[str, Any] = {"kind": "block", "center": self.local(look.point)}
        shape |= {"width": wide, "height": 0.6 * wide, "angle": float(np.arctan2(y, x))}
        self.shapes[look.point.body.name].append(shape)

    @draw.register
    def _(self, look: Rail, element: Any) -> None:
        travel = self.motion.values(Expression(look.travel))[self.keep]
        travel = travel[np.isfinite(travel)]
        low, high = (float(travel.min()), float(travel.max())) if travel.size else (0.0, 0.0)
        margin, axis = 0.12 * self.size, self.number(look.direction)
        axis, origin = axis / np.linalg.norm(axis), np.array(self.local(look.point))
        ends = [(origin + s * axis).tolist() for s in (low - margin, high + margin)]
        shape = {"kind": "line", "from": ends[0], "to": ends[1]}
        self.shapes[look.point.body.name].append(shape)

    @draw.register
    def _(self, look: Path, element: Any) -> None:
        u = ca.SX.sym("u")
        place = ca.Function("path", [u, self.parameters], [look.position(u)])
        samples = np.linspace(*look.interval, CURVE_SAMPLES)[None, :]
        parameters = np.tile(self.motion.parameters[:, None], CURVE_SAMPLES)
        points = place.map(CURVE_SAMPLES)(samples, parameters).full().T.tolist()
        shape = {"kind": "curve", "points": points, "closed": bool(look.closed)}
        self.shapes[look.body.name].append(shape)

    @draw.register
    def _(self, look: Mark, element: Any) -> None:
        point, base = look.point, look.base
        bodies = [point.body.name, base.body.name if isinstance(base, Point) else base.name]
        if bodies[0] == "ground" and isinstance(base, Point):
            point = base
        described = _named(look, element) | self.place(point) | {"grounded": "ground" in bodies}
        self.joints.append(described | self.reaction(element))

    @draw.register
    def _(self, look: Mesh, element: Any) -> None:
        described = _named(look, element) | self.place(look.point) | self.reaction(element)
        described["mesh"] = [
            self.place(p) | {"radius": self.size_of(r)}
            for p, r in ((look.point, look.radius), (look.base, look.base_radius))
            if isinstance(p, Point)
        ]
        self.joints.append(described | {"grounded": False, "internal": look.internal})

    @draw.register
    def _(self, look: Link, element: Any) -> None:
        ends = {"i": self.place(look.point_i), "j": self.place(look.point_j)}
        self.links.append(_named(look, element) | ends)

    @draw.register
    def _(self, look: Rotary, element: Any) -> None:
        pivot = self.pivots.between(look.body_i, look.body_j)
        ends = [b.name if b is not None else "ground" for b in (look.body_i, look.body_j)]
        described = _named(look, element) | self.place(pivot) | dict(zip("ij", ends, strict=True))
        self.symbols.append(described)

    @draw.register
    def _(self, look: Belt, element: Any) -> None:
        pivots = [self.pivots.between(look.carrier, b) for b in (look.body_i, look.body_j)]
        ratio, (p, q) = self.size_of(look.ratio), [self.start(pivot) for pivot in pivots]
        unit = 0.3 * float(np.hypot(*(q - p))) / (abs(ratio) + 1)
        wheels = [
            self.place(pivot) | {"radius": unit * turns}
            for pivot, turns in zip(pivots, (abs(ratio), 1.0), strict=True)
        ]
        described = _named(look, element) | {"wheels": wheels, "crossed": ratio < 0}
        self.symbols.append(described)
        self.joints.append(described | wheels[1] | {"grounded": False} | self.reaction(element))

    @draw.register
    def _(self, look: Travel, element: Any) -> None:
        on = look.body.name if look.body is not None else "ground"
        described = _named(look, element) | self.place(look.point)
        self.symbols.append(described | {"on": on, "axis": self.number(look.direction).tolist()})

    @draw.register
    def _(self, look: Limit, element: Any) -> None:
        blocks = [(name, s) for name, shapes in self.shapes.items() for s in shapes]
        reach = {name: s["width"] / 2 for name, s in blocks if s["kind"] == "block"}
        found = self.pivots.wall(look, self.model.bodies, reach)
        if found is not None and self.loads:
            self.symbols.append(_named(look, element))
            self.later.append((self.symbols[-1], ("x", "y", "normal_x", "normal_y"), found))

    @draw.register
    def _(self, look: Arrow, element: Any) -> None:
        if self.loads:
            self.symbols.append(_named(look, element) | self.place(look.point))
            self.later.append((self.symbols[-1], ("force_x", "force_y"), look.force))

    @draw.register
    def _(self, look: Twist, element: Any) -> None:
        if self.loads:
            pivot = self.pivots.between(None, look.body)
            self.symbols.append(_named(look, element) | self.place(pivot))
            self.later.append((self.symbols[-1], ("moment",), look.moment))

    def start(self, point: Point) -> np.ndarray:
        """Where a point is at the first instant."""
        local = np.array(self.local(point))
        if point.body.name == "ground":
            return local
        at = self.data.sel(body=point.body.name)
        (x, y), angle = at["position"].values[self.keep[0]], at["angle"].values[self.keep[0]]
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x, y]) + np.array([[c, -s], [s, c]]) @ local

    def reaction(self, joint: Any) -> dict:
        """Columns of the force and moment that the joint bears."""
        if "joint" not in self.data.coords or joint.name not in self.data["joint"].values:
            return {}
        at = self.data.sel(joint=joint.name)
        force, moment = (at[f"reaction_{k}"].values[self.keep] for k in ("force", "moment"))
        if not np.isfinite(force).any():
            return {}
        lever = 1e-9 * self.size * np.nanmax(np.abs(force))
        moment = np.where(np.abs(moment) > lever, moment, 0.0)
        columns = {"force_x": force[:, 0], "force_y": force[:, 1], "moment": moment}
        return {name: column.tolist() for name, column in columns.items()}


def _named(look: Look, element: Any) -> dict[str, Any]:
    """Name of the element, what it is in words, and the symbol of the primitive."""
    what = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(element).__name__).lower()
    return {"name": element.name, "what": what, "symbol": type(look).__name__.lower()}
