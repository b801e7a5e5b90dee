"""Planar circles, bores and half-planes, and the revolute joint with clearance."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements import curves
from dalembert.elements.base import Look, Vector, quantity
from dalembert.elements.contact.contact import ClearanceJoint
from dalembert.elements.contact.hull import Boundary
from dalembert.elements.contact.shapes import Flat, Hollow, Round
from dalembert.elements.curves import FormulaCurve
from dalembert.elements.look import Disc, Pin
from dalembert.elements.planar.joint import InPlane
from dalembert.elements.rotation import unit
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Circle(Round):
    """Planar disc.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("discs")
    >>> a = system.add(planar.Body("a", mass=1.0, inertia=0.01, velocity=(1, 0)))
    >>> b = system.add(planar.Body("b", mass=1.0, inertia=0.01, position=(0.3, 0)))
    >>> discs = [contact.Circle(body.center, 0.1) for body in (a, b)]
    >>> law = contact.Hertz(stiffness=1e7)
    >>> touch = system.add(planar.Contact("touch", *discs, law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.2, integrator=da.DormandPrince(1e-9, 1e-9))
    >>> round(motion["b.vx"][-1].item(), 5)  # the whole speed is transferred
    1.0
    """

    space = 2

    def look(self, near: ca.SX) -> list[Look]:
        return [Disc(self.point, self.radius.sx)]


@dataclass(eq=False)
class Bore(Hollow):
    """Planar round hole, touched from inside.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("roller in a ring", gravity=(0, -10))
    >>> roller = system.add(planar.Body("roller", mass=1.0, inertia=0.005, position=(0, -0.4005)))
    >>> ring = contact.Bore(system.ground.center, 0.5)
    >>> rim, law = contact.Circle(roller.center, 0.1), contact.KelvinVoigt(stiffness=2e4)
    >>> touch = system.add(planar.Contact("touch", ring, rim, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["touch.penetration"].item() * 1e3, 6)  # m g/k [mm]
    0.5
    """

    space = 2

    def boundary(self) -> Boundary:
        (x, y), radius = ca.vertsplit(self.point.local.sx), self.radius.sx
        u = curves.u.sx
        across, up = Expression(x + radius * ca.cos(u)), Expression(y - radius * ca.sin(u))
        return Boundary(FormulaCurve(across, up))

    def look(self, near: ca.SX) -> list[Look]:
        return [Disc(self.point, self.radius.sx)]


@dataclass(eq=False)
class HalfPlane(Flat):
    """Material on one side of a straight line.

    Parameters
    ----------
    point : point of a body on the line
    normal : (2,) outward normal in the axes of the body

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("slope", gravity=(0, -10))
    >>> block = system.add(planar.Particle("block", mass=1.0))
    >>> slope = contact.HalfPlane(system.ground.center, normal=(-0.6, 0.8))
    >>> law = contact.Restitution()
    >>> touch = system.add(planar.Contact("touch", slope, contact.Vertex(block.center), law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.5, step=0.05)
    >>> motion["block.velocity"][-1].values.round(6)  # 0.6 g t down the slope
    array([-2.4, -1.8])
    """

    space = 2
    normal: Vector = quantity("", "outward normal in body axes", default=(0.0, 1.0), size=2)

    @property
    def outward(self) -> ca.SX:
        return self.carrier.turned(unit(self.normal.sx, "HalfPlane.normal"))

    @property
    def along(self) -> list[ca.SX]:
        x, y = ca.vertsplit(unit(self.normal.sx, "HalfPlane.normal"))
        return [ca.vertcat(y, -x)]


@dataclass(eq=False)
class ClearanceRevolute(InPlane, ClearanceJoint):
    """A journal in a bearing with clearance, free while ``g = clearance − |r_j − r_i| > 0``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("play", gravity=(0, -10))
    >>> shaft = system.add(planar.Particle("shaft", mass=4.0, position=(0, -0.00101)))
    >>> bearing = system.add(planar.ClearanceRevolute("bearing", system.ground.center, shaft.center,
    ...     radius=0.02, clearance=0.001, law=planar.contact.KelvinVoigt(stiffness=1e7)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["shaft.y"].item() * 1e6, 3)  # clearance plus m g/k [µm]
    -1004.0
    """

    hole, inside = Bore, Circle

    def look(self) -> list[Look]:
        return [Pin(self.point_j, self.point_i)]
