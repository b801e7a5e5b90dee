"""The drawing of a mechanism: shapes on bodies, joints, springs, and how they move."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.driver import Driver
from dalembert.elements.pair import Pair, PointJoint
from dalembert.elements.planar.body import Bar, Body
from dalembert.elements.planar.gear import GearPair, RackAndPinion
from dalembert.elements.planar.point_on_curve import PointOnCurve
from dalembert.elements.planar.rigid_link import RigidLink
from dalembert.elements.planar.springs import Bushing
from dalembert.elements.planar.translational import PinInSlot, SlidingJoint, Translational
from dalembert.elements.point import Point
from dalembert.elements.springs import Actuator, PointPair, Spring
from dalembert.results.labelled import LabelledRecording
from dalembert.symbolic.expression import Expression

LINKS = {Spring: "spring", Actuator: "actuator", Bushing: "bushing"}
CURVE_SAMPLES = 181


def motion_scene(motion: LabelledRecording, keep: np.ndarray) -> dict[str, Any]:
    """Drawing and poses at the instants ``keep``."""
    return _Scene(motion, keep).build()


class _Scene:
    def __init__(self, motion: LabelledRecording, keep: np.ndarray):
        self.motion, self.model, self.keep = motion, motion.model, keep
        self.data = motion.data
        e = self.model.equations
        self.number = lambda sx: np.asarray(
            ca.Function("n", [e.p], [ca.densify(sx)])(motion.parameters).full()
        ).ravel()
        names = ["ground", *(b.name for b in self.model.bodies)]
        self.points: dict[str, list[tuple[float, ...]]] = {name: [] for name in names}
        self.shapes: dict[str, list[dict]] = {name: [] for name in names}

    def local(self, point: Point) -> list[float]:
        return self.number(point.local.sx).tolist()

    def build(self) -> dict[str, Any]:
        self.collect_points()
        self.size = self.extent()
        for constraint in self.model.constraints:
            self.shape_of_joint(constraint)
        for body in self.model.bodies:
            self.outline(body)
        gravity = self.model.parts.gravity
        return {
            "gravity": None if gravity is None else self.number(gravity.sx).tolist(),
            "bodies": [self.body(b) for b in self.model.bodies],
            "ground": {"shapes": self.shapes["ground"]},
            "joints": [self.joint(c) for c in self.model.constraints if self.is_drawn(c)],
            "links": self.links(),
            "points": [
                {"name": p.name, "body": b.name, "point": self.local(p)}
                for b in self.model.bodies
                for p in b.points.values()
            ],
        }

    # what lies on a body -------------------------------------------------------------
    def collect_points(self) -> None:
        for body in self.model.bodies:
            self.points[body.name] = [tuple(self.local(p)) for p in body.points.values()]
        for element in (*self.model.constraints, *self.model.forces):
            for name in ("point_i", "point_j", "point"):
                point = getattr(element, name, None)
                if isinstance(point, Point):
                    spot = tuple(self.local(point))
                    if spot not in self.points[point.body.name]:
                        self.points[point.body.name].append(spot)

    def extent(self) -> float:
        """Size of the mechanism, for symbols without a size of their own."""
        local = [np.linalg.norm(p) for points in self.points.values() for p in points]
        position = self.data["position"].values[self.keep[:1]].reshape(-1, 2)
        spread = np.ptp(position, axis=0).max() if position.size else 0.0
        return float(max([spread, *local])) or 1.0

    def outline(self, body: Body) -> None:
        shapes, points = self.shapes[body.name], self.points[body.name]
        if not body.rotates:
            shapes.append({"kind": "particle", "center": [0.0, 0.0]})
        elif isinstance(body, Bar):
            shapes.insert(0, self.bar(self.local(body.start), self.local(body.end)))
            extra = [p for p in points if abs(p[1]) > 1e-9 * self.size]
            if extra:
                ends = [self.local(body.start), self.local(body.end)]
                shapes.insert(0, {"kind": "polygon", "points": _hull([*ends, *map(list, extra)])})
        elif len(points) >= 3:
            corners = _hull([list(p) for p in points])
            polygon = {"kind": "polygon", "points": corners}
            shapes.insert(0, polygon if len(corners) > 2 else self.bar(*corners))
        elif len(points) == 2:
            shapes.insert(0, self.bar(list(points[0]), list(points[1])))
        elif len(points) == 1 and not shapes and np.linalg.norm(points[0]) > 1e-9 * self.size:
            shapes.append(self.bar([0.0, 0.0], list(points[0])))
            shapes.append({"kind": "particle", "center": [0.0, 0.0]})

    @staticmethod
    def bar(start: list, end: list) -> dict:
        return {"kind": "bar", "from": start, "to": end}

    def shape_of_joint(self, joint: Any) -> None:
        if isinstance(joint, GearPair):
            for point, radius in ((joint.point_i, joint.radius_i), (joint.point_j, joint.radius_j)):
                self.disc(point, float(self.number(radius.sx)[0]))
        elif isinstance(joint, RackAndPinion):
            self.disc(joint.point_j, float(self.number(joint.radius.sx)[0]))
            self.guide(joint)
        elif isinstance(joint, Translational) and not isinstance(joint, Driver):
            center, size = self.local(joint.point_j), 0.12 * self.size
            axis = self.number(joint.axis.sx)
            angle = float(np.arctan2(axis[1], axis[0]) - self.number(joint.angle.sx)[0])
            self.shapes[joint.point_j.body.name].append(
                {
                    "kind": "block",
                    "center": center,
                    "width": size,
                    "height": 0.6 * size,
                    "angle": angle,
                }
            )
            self.guide(joint)
        elif isinstance(joint, PinInSlot):
            self.guide(joint)
        elif isinstance(joint, PointOnCurve):
            self.curve(joint)

    def disc(self, point: Point, radius: float) -> None:
        self.shapes[point.body.name].append(
            {"kind": "disc", "center": self.local(point), "radius": radius}
        )

    def guide(self, joint: SlidingJoint) -> None:
        """A line along the axis, as long as the travel needs."""
        travel = self.motion.values(_named(joint.displacement))[self.keep]
        travel = travel[np.isfinite(travel)]
        low, high = (float(travel.min()), float(travel.max())) if travel.size else (0.0, 0.0)
        margin = 0.12 * self.size
        axis = self.number(joint.axis.sx)
        axis = axis / np.linalg.norm(axis)
        origin = np.array(self.local(joint.point_i))
        if isinstance(joint, RackAndPinion) and joint.kind == "rack":
            margin = 0.0
        self.shapes[joint.point_i.body.name].append(
            {
                "kind": "line",
                "from": (origin + (low - margin) * axis).tolist(),
                "to": (origin + (high + margin) * axis).tolist(),
            }
        )

    def curve(self, joint: PointOnCurve) -> None:
        low, high = joint.curve.interval()
        u = ca.SX.sym("u")
        place = ca.Function("curve", [u, self.model.equations.p], [joint.curve.position(u)])
        samples = np.linspace(low, high, CURVE_SAMPLES)[None, :]
        parameters = np.tile(self.motion.parameters[:, None], CURVE_SAMPLES)
        points = place.map(CURVE_SAMPLES)(samples, parameters).full().T
        shape = {"kind": "curve", "points": points.tolist(), "closed": bool(joint.curve.closed)}
        self.shapes[joint.body_i.name].append(shape)
        radius = float(self.number(joint.radius.sx)[0])
        if radius > 0:
            self.disc(joint.point_j, radius)

    # what moves ------------------------------------------------------------------------
    def body(self, body: Body) -> dict:
        at = self.data.sel(body=body.name)
        return {
            "name": body.name,
            "x": at["position"].values[self.keep, 0].tolist(),
            "y": at["position"].values[self.keep, 1].tolist(),
            "angle": at["angle"].values[self.keep].tolist(),
            "shapes": self.shapes[body.name],
        }

    @staticmethod
    def is_drawn(constraint: Any) -> bool:
        return isinstance(constraint, Pair) and not isinstance(constraint, Driver | RigidLink)

    def joint(self, joint: Any) -> dict:
        kinds = {"revolute", "translational", "weld", "pin_in_slot", "gear"}
        point = (
            joint.point_j
            if isinstance(joint, PointJoint | PointOnCurve)
            else joint.ends()[1].center
        )
        body, spot = point.body, self.local(point)
        if body.name == "ground" and isinstance(joint, PointJoint):
            body, spot = joint.point_i.body, self.local(joint.point_i)
        grounded = "ground" in (joint.ends()[0].name, joint.ends()[1].name)
        described = {
            "name": joint.name,
            "kind": joint.kind if joint.kind in kinds else "other",
            "body": body.name,
            "point": spot,
            "axis": self.number(joint.axis.sx).tolist()
            if isinstance(joint, SlidingJoint)
            else None,
            "grounded": grounded and joint.kind in ("revolute", "translational", "weld"),
        }
        if "joint" in self.data.coords and joint.name in self.data["joint"].values:
            at = self.data.sel(joint=joint.name)
            force = at["reaction_force"].values[self.keep]
            if np.isfinite(force).any():
                described["force_x"] = force[:, 0].tolist()
                described["force_y"] = force[:, 1].tolist()
                moment = at["reaction_moment"].values[self.keep]
                lever = 1e-9 * self.size * np.nanmax(np.abs(force))
                described["moment"] = np.where(np.abs(moment) > lever, moment, 0.0).tolist()
        return described

    def links(self) -> list[dict]:
        found = []
        for element in (*self.model.forces, *self.model.constraints):
            kind = LINKS.get(type(element)) or ("rigid" if isinstance(element, RigidLink) else None)
            if kind is None or not isinstance(element, PointPair | RigidLink):
                continue
            ends = (element.point_i, element.point_j)
            i, j = ({"body": p.body.name, "point": self.local(p)} for p in ends)
            if isinstance(element, Spring):
                damped = not element.damping.sx.is_zero()
                elastic = not element.stiffness.sx.is_zero() or element.law is not None
                if damped:
                    found.append({"name": element.name, "kind": "damper", "i": i, "j": j})
                if not elastic:
                    continue
            found.append({"name": element.name, "kind": kind, "i": i, "j": j})
        return found


def _named(sx: ca.SX) -> Expression:
    return Expression(sx, "displacement", "m")


def _hull(points: list[list[float]]) -> list[list[float]]:
    """Corners of the convex hull, anticlockwise; only the two ends of points in a line."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    size = max(np.ptp(np.array(ordered), axis=0).max(), 1e-300)

    def chain(path: list) -> list:
        kept: list = []
        for p in path:
            while len(kept) > 1:
                (ax, ay), (bx, by) = kept[-2:]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 1e-12 * size**2:
                    break
                kept.pop()
            kept.append(p)
        return kept

    return [list(p) for p in chain(ordered)[:-1] + chain(ordered[::-1])[:-1]]
