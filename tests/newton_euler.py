"""Newton–Euler equations of every body, written from the labelled results of a motion only."""

from __future__ import annotations

from types import SimpleNamespace

import casadi as ca
import numpy as np
import spatial_twins
from twins import complex_step, context, cross

from dalembert.elements.base import Constraint
from dalembert.elements.driver import AlongDirection
from dalembert.elements.planar import Coupling, UserConstraint
from dalembert.elements.spatial.couplings import CoupledJoints


class Snapshot:
    """One output time of a motion.

    Parameters
    ----------
    motion : Motion
    k : index of the time
    case : registered case with the twins of its loads and joint places, if there are any
    """

    def __init__(self, motion, k: int, case=None):
        self.model, self.case = (
            motion.model,
            case or SimpleNamespace(loads=None, place={}, residual=None),
        )
        self.data = motion.data.isel(time=k)
        self.t, self.p = float(self.data.time), motion.parameters
        self.y, self.v = self.data.coordinates.values, self.data.speeds.values
        self.seen = context(self.model, self.t, self.y, self.p, self.v)

    def frame(self, body):
        return self.seen.body[body.name]

    def number(self, expression) -> np.ndarray:
        """A formula of parameters as numbers."""
        symbols = ca.vertcat(*(p.sx for p in self.model.parameters.values()))
        return ca.Function("n", [symbols], [expression.sx])(self.p).full().ravel()

    def place(self, joint) -> np.ndarray:
        """Where a joint's reaction is reported, by hand."""
        if joint.name in self.case.place:
            return self.case.place[joint.name](self.seen)
        if hasattr(joint, "point_j"):
            return self.frame(joint.point_j.body).at(self.number(joint.point_j.local))
        return self.frame(joint.ends()[1]).r

    def reaction(self, joint: Constraint) -> list[tuple]:
        """Loads of a joint: (body name, force, place, moment)."""
        if isinstance(joint, UserConstraint):
            return self._user(joint)
        if isinstance(joint, AlongDirection):
            along = self.number(joint.direction)
            effort = float(self.data.effort.sel(driver=joint.name))
            place = self.frame(joint.point.body).at(self.number(joint.point.local))
            force = effort * along / np.linalg.norm(along)
            return [(joint.point.body.name, force, place, 0.0 if len(force) == 2 else 0 * force)]
        here = self.data.sel(joint=joint.name)
        force, moment, place = (
            here.reaction_force.values,
            here.reaction_moment.values,
            self.place(joint),
        )
        first, second = joint.ends()
        if isinstance(joint, CoupledJoints):
            return self._coupled(joint)
        if isinstance(joint, Coupling):
            return self._coupling(joint, moment)
        return [(second.name, force, place, moment), (first.name, -force, place, -moment)]

    def _coupling(self, joint, moment: float) -> list[tuple]:
        """M on body j, −ratio M on body i; their carrier takes what is left."""
        ratio, nothing = float(self.number(joint.ratio)[0]), np.zeros(2)
        carrier = joint.carrier.name if joint.carrier is not None else "ground"
        moments = {joint.body_j.name: moment, joint.body_i.name: -ratio * moment}
        moments[carrier] = moments.get(carrier, 0.0) - (1 - ratio) * moment
        return [(n, nothing, self.seen.body[n].r, m) for n, m in moments.items()]

    def _coupled(self, joint) -> list[tuple]:
        """What the twin's equations ask for of every body: ``−λᵀ ∂Φ/∂δ``."""
        names = self.model.equation_names
        rows = [k for k, name in enumerate(names) if name.startswith(f"{joint.name}[")]
        size = self.v.size
        slope = complex_step(
            lambda step: self.case.residual(
                context(self.model, self.t, spatial_twins.moved(self.model, self.y, step), self.p)
            )[rows],
            np.zeros(size),
        )
        effort = -self.data.multiplier.values[rows] @ slope
        loads, k = [], 0
        for body in self.model.bodies:
            frame, here = self.frame(body), effort[k : k + body.twist.numel()]
            loads.append((body.name, here[:3], frame.r, frame.R @ here[3:]))
            k += here.size
        return loads

    def _user(self, joint) -> list[tuple]:
        multiplier = float(self.data.multiplier.sel(equation=f"{joint.name}[0]"))
        slope = complex_step(
            lambda y: self.case.residual(context(self.model, self.t, y, self.p)), self.y
        )[0]
        loads, k = [], 0
        for body in self.model.bodies:
            wrench = -multiplier * slope[k : k + 3]
            loads.append((body.name, wrench[:2], self.frame(body).r, wrench[2]))
            k += body.pose.numel()
        return loads

    def loads(self) -> list[tuple]:
        """All forces but weight: of joints and drivers, then applied ones."""
        computed = [load for joint in self.model.constraints for load in self.reaction(joint)]
        return computed + (self.case.loads(self.seen) if self.case.loads else [])

    def imbalance(self, gravity=(0.0, 0.0)) -> float:
        """Largest ``m (r̈ − g) − Σ F`` or ``J φ̈ − Σ (M + (r_P − r) × F)`` of all bodies."""
        rest = {}
        for body in self.model.bodies:
            if body.dimension == 3:
                rest[body.name] = self._inertial(body, np.asarray(gravity))
                continue
            here = self.data.sel(body=body.name)
            mass, inertia = (float(self.number(q)[0]) for q in (body.mass, body.inertia))
            rest[body.name] = np.append(
                mass * (here.acceleration.values - gravity),
                inertia * float(here.angular_acceleration),
            )
        for name, force, place, moment in self.loads():
            if name in rest:
                turned = spatial_twins.cross if len(force) == 3 else cross
                rest[name] -= np.append(
                    force, moment + turned(place - self.seen.body[name].r, force)
                )
        turning = {b.name: b.twist.numel() for b in self.model.bodies}
        return max(np.abs(r[: turning[n]]).max() for n, r in rest.items())

    def _inertial(self, body, gravity) -> np.ndarray:
        """``m (r̈_C − g)`` and ``J ω̇ + ω × J ω`` of a body in space, inertial axes."""
        here, frame = self.data.sel(body=body.name), self.frame(body)
        mass = float(self.number(body.mass)[0])
        if not body.rotates:
            return np.append(mass * (here.acceleration.values - gravity), np.zeros(3))
        cross, arm = spatial_twins.cross, frame.vector(frame.center)
        w, accelerated = here.angular_velocity.values, here.angular_acceleration.values
        center = here.acceleration.values + cross(accelerated, arm) + cross(w, cross(w, arm))
        xx, yy, zz, xy, yz, xz = self.number(body.inertia)
        local = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        inertia = frame.R @ local @ frame.R.T
        moment = inertia @ accelerated + cross(w, inertia @ w)
        return np.append(mass * (center - gravity), moment)

    def power(self, loads: list[tuple]) -> float:
        """Power of loads: Σ F · v(place) + M ω."""
        total = 0.0
        for name, force, place, moment in loads:
            frame = self.seen.body[name]
            total += force @ frame.velocity_at(place) + np.dot(moment, frame.w)
        return total
