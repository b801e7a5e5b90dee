"""Hydraulic cylinder with a valve and compressible oil."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look, Powers, Rate, Scalar, quantity
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.look import Cylinder
from dalembert.elements.springs import PointPair
from dalembert.elements.stateful import Stateful, signal
from dalembert.symbolic.formulas.expression import t

SMOOTH = 1e-4
"""Pressure difference, relative to that of the supply, below which a flow is laminar [-]."""


@dataclass(eq=False)
class HydraulicCylinder(Stateful, PointPair):
    """Cylinder between two points whose chambers a 4/3-way valve fills with compressible oil.

        p_A' = E/(V_A + A_A x) (Q_A − A_A ẋ − c (p_A − p_B))
        p_B' = E/(V_B + A_B (h − x)) (Q_B + A_B ẋ + c (p_A − p_B)),      F = p_A A_A − p_B A_B − b ẋ

    with the extension ``x = s − s_0`` of the distance ``s`` of the points, and the flows of an
    opening ``u``: for ``u > 0``, ``Q_A = k u √(p_S − p_A)`` and ``Q_B = −k u √(p_B − p_T)``, for
    ``u < 0`` with the pressures of supply and tank exchanged (Merritt, Hydraulic Control Systems,
    1967, ch. 6). Roots are laminar below 1e-4 of the supply pressure.

    Parameters
    ----------
    opening : ``u`` of the valve, −1 to 1; a formula of t and measures that may be assigned later
    area, rod_side_area : ``A_A`` and ``A_B`` [m²]
    stroke : ``h`` [m]
    retracted_length : ``s_0``, the distance of the points at ``x = 0`` [m]
    rated_flow, rated_pressure : flow ``k √Δp`` of the open valve at a pressure difference ``Δp``
        across one edge [m³/s], [Pa]
    supply, tank : pressures ``p_S`` and ``p_T`` [Pa]
    bulk_modulus : ``E`` of the oil [Pa]
    dead_volume : ``V_A = V_B`` [m³]
    leakage : ``c`` between the chambers [m³/(s Pa)], which is [m⁴ s/kg]
    damping : ``b`` [N s/m]
    start_a, start_b : pressures at the start; of the tank by default [Pa]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("press")
    >>> ram = system.add(planar.Particle("ram", mass=50.0, position=(1.2, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, ram.center))
    >>> sizes = dict(area=2e-3, rod_side_area=1e-3, stroke=0.5, retracted_length=1.0)
    >>> valve = dict(rated_flow=1e-4, rated_pressure=1e6)
    >>> ends = system.ground.center, ram.center
    >>> part = planar.HydraulicCylinder("cylinder", *ends, opening=0.5, **valve, **sizes)
    >>> cylinder = system.add(part)
    >>> motion = da.solve_dynamics(system.build(), 0.5)
    >>> round(motion["ram.vx"][-1].item(), 3)  # k u √p_S/√(A_A² + A_B³/A_A)
    0.075
    """

    fixed_states = ("pressure_a", "pressure_b")

    opening: Scalar = signal("", "opening of the valve, -1 to 1", default=0.0)
    area: Scalar = quantity("m^2", "area of the piston", default=1e-3, above=0.0)
    rod_side_area: Scalar = quantity("m^2", "area on the side of the rod", default=1e-3, above=0.0)
    stroke: Scalar = quantity("m", "stroke", default=1.0, above=0.0)
    retracted_length: Scalar = quantity("m", "distance of the points if retracted", default=0.0)
    rated_flow: Scalar = quantity("m^3/s", "flow of the open valve", default=1e-3, above=0.0)
    rated_pressure: Scalar = quantity("Pa", "its pressure difference", default=3.5e6, above=0.0)
    supply: Scalar = quantity("Pa", "pressure of the supply", default=1e7, above=0.0)
    tank: Scalar = quantity("Pa", "pressure of the tank", default=0.0, minimum=0.0)
    bulk_modulus: Scalar = quantity("Pa", "bulk modulus of the oil", default=1.4e9, above=0.0)
    dead_volume: Scalar = quantity("m^3", "volume of each line", default=1e-4, above=0.0)
    leakage: Scalar = quantity(
        "m^4 s/kg", "leakage of the piston, m³/(s Pa)", default=0.0, minimum=0.0
    )
    damping: Scalar = quantity("N s/m", "viscous friction", default=0.0, minimum=0.0)
    start_a: Scalar = quantity("Pa", "pressure at the start", default=None)
    start_b: Scalar = quantity("Pa", "pressure at the start, rod side", default=None)

    def conditions(self) -> list[Condition]:
        text = "its supply pressure is below that of the tank"
        return [*super().conditions(), (self.supply.sx - self.tank.sx, text)]

    def state_units(self) -> Sequence[str]:
        return ("Pa", "Pa")

    def initial_states(self) -> list[ca.SX]:
        starts = (self.start_a, self.start_b)
        return [self.tank.sx if start is None else start.sx for start in starts]

    @property
    def _extension(self) -> ca.SX:
        return self.coordinate() - self.retracted_length.sx

    def flows(self) -> tuple[ca.SX, ca.SX]:
        """``Q_A``, ``Q_B``."""
        u, (a, b) = self.input_of("opening"), ca.vertsplit(self.states.pose)
        source, tank = self.supply.sx, self.tank.sx
        out = u >= 0
        a_from, b_from = ca.if_else(out, source, tank), ca.if_else(out, tank, source)
        gain = self.rated_flow.sx / ca.sqrt(self.rated_pressure.sx) * ca.fabs(u)
        return gain * self._root(a_from - a), gain * self._root(b_from - b)

    def _root(self, difference: ca.SX) -> ca.SX:
        """``√|p| sign p``, linear about zero."""
        return difference / ca.sqrt(ca.sqrt(difference**2 + (SMOOTH * self.supply.sx) ** 2))

    def rates(self) -> ca.SX:
        (a, b), x = ca.vertsplit(self.states.pose), self._extension
        speed = rate_of(self.coordinate(), self.parts()[:-1], t.sx)
        flow_a, flow_b = self.flows()
        leak = self.leakage.sx * (a - b)
        volume_a = self.dead_volume.sx + self.area.sx * x
        volume_b = self.dead_volume.sx + self.rod_side_area.sx * (self.stroke.sx - x)
        rate_a = (flow_a - self.area.sx * speed - leak) / volume_a
        rate_b = (flow_b + self.rod_side_area.sx * speed + leak) / volume_b
        return self.bulk_modulus.sx * ca.vertcat(rate_a, rate_b)

    def force(self, speed: ca.SX) -> ca.SX:
        """``F``, positive pushes the points apart."""
        a, b = ca.vertsplit(self.states.pose)
        return a * self.area.sx - b * self.rod_side_area.sx - self.damping.sx * speed

    def powers(self, rate: Rate) -> Powers:
        speed = rate(self.coordinate())
        return [(speed, self.force(speed))]

    def dissipation(self, rate: Rate) -> Powers:
        speed = rate(self.coordinate())
        return [(speed, -self.damping.sx * speed)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        s = self.coordinate()
        speed = rate(s)
        own = {
            "length": (s, "m"),
            "rate": (speed, "m/s"),
            "force": (self.force(speed), "N"),
            "power": (self.force(speed) * speed, "W"),
            **self.state_measures(),
        }
        if self.connected:
            a, b = self.flows()
            own |= {"flow_a": (a, "m^3/s"), "flow_b": (b, "m^3/s")}
        return own

    def parts(self) -> list[Coordinates]:
        return [*super().parts(), self.states]

    def look(self) -> list[Look]:
        return [Cylinder(self.point_i, self.point_j)]
