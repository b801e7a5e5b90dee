"""Diagnosis of a mechanism that cannot be assembled: the open joint and its gap.

At the position of minimum violation every joint of an open loop is slightly open. So one of them
is released while the others are closed: it then shows the whole gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint
from dalembert.elements.pair import PointJoint
from dalembert.errors import AssemblyError
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.assembly import Assembler
from dalembert.model.graph.assembly.position_search import SearchResult
from dalembert.model.graph.description import Description
from dalembert.model.graph.tree.spanning_tree import analyse_topology
from dalembert.symbolic.nonlinear_program import ipopt

CLOSED = 1e-6
"""Threshold for closed joints: violation in natural units."""
SUSPECT = 0.1
"""Threshold for suspected joints: violation relative to the largest one."""
TOLERANCE, MAX_ITERATIONS = 1e-9, 300
"""Of the search for the closest position."""
MAX_SUSPECTS = 6
"""Upper limit of suspects that are tested."""


@dataclass(frozen=True, eq=False)
class OpenPosition:
    """Closest position of a mechanism that cannot be assembled.

    Attributes
    ----------
    parts, parameters, time : the mechanism, (np,) values of its parameters, the instant [s]
    guess, y : (n,) coordinates of the placed guesses, and of the closest position
    joint : name of the joint or driver that stays open
    ends : (2, 2) the two points that should coincide, as rows, if there are two
    gap, text : its gap, as a short text and as a sentence
    loop : joints of the loop that does not close
    """

    parts: Description
    parameters: np.ndarray
    time: float
    guess: np.ndarray
    y: np.ndarray
    joint: str
    ends: np.ndarray | None
    gap: str
    text: str
    loop: tuple[str, ...]


def failure(
    assembler: Assembler,
    d: Description,
    t: float,
    y: np.ndarray,
    p: np.ndarray,
    searched: SearchResult | None = None,
) -> AssemblyError:
    """The error with the closest position near ``y``, or near the best one of a search."""
    if searched is not None and searched.residual < _open(assembler, t, y, p):
        y = searched.best
    position = _Failure(assembler, d, t, y, p).open_position()
    in_loop = f", in the loop {'–'.join(position.loop)}" if position.loop else ""
    search_text = ""
    if searched is not None:
        search_text = (
            f" (no start of {searched.starts} random ones led to an assembly; smallest relative "
            f"residual {searched.residual:.2g})"
        )
    return AssemblyError(
        f"the mechanism cannot be assembled at t = {t:g} s: {position.text}{in_loop}{search_text}; "
        f"check the lengths {'of this loop ' if position.loop else ''}and the positions of fixed "
        "points, or give poses nearer to the closed mechanism",
        float(np.abs(assembler.residual(t, position.y, p).value).max(initial=0.0)),
        position,
    )


def _open(assembler: Assembler, t: float, y: np.ndarray, p: np.ndarray) -> float:
    """Largest residual in natural sizes."""
    residual = assembler.residual(t, y, p)
    relative = np.abs(residual.value / residual.scale)
    return float(np.max(np.nan_to_num(relative, nan=np.inf), initial=0.0))


@dataclass(frozen=True, eq=False)
class _Demand:
    """Equations of a joint, a driver or an initial condition."""

    name: str
    rows: list[int]
    unit: str
    compared: tuple[ca.SX, ca.SX] | None
    joint: Constraint | None


class _Failure:
    def __init__(self, assembler: Assembler, d: Description, t: float, y, p: np.ndarray):
        self.assembler, self.d, self.t, self.y, self.p = assembler, d, t, y, p
        holding = [c for c in d.constraints if c.equations.numel()]
        ends = np.cumsum([0, *(c.equations.numel() for c in holding)]).tolist()
        self.demands = {
            c.name: _Demand(c.name, list(range(*span)), c.units()[0], c.measured_and_target(), c)
            for c, span in zip(holding, pairwise(ends), strict=True)
        }
        of_position = [(m, v) for m, v in d.conditions if not self.of_speed(m.sx - v.sx)]
        for row, (m, v) in enumerate(of_position, assembler.equation_count):
            name = f"the initial value of {m.name or 'a formula'}"
            self.demands[name] = _Demand(name, [row], m.unit, (m.sx, v.sx), None)

    def of_speed(self, expression: ca.SX) -> bool:
        return bool(ca.depends_on(expression, self.assembler.equations.v))

    def open_position(self) -> OpenPosition:
        """The closest position, open at the demand without which all others can be satisfied."""
        violation = self.violations(self.y)
        worst = max(violation, key=lambda name: violation[name])
        loops = analyse_topology(self.d.bodies, self.d.constraints, set()).loops
        loop = next((joints for joints in loops if worst in joints), ())
        for name in self.suspects(violation, worst, loop):
            demand = self.demands[name]
            y = self.closest(demand.rows)
            others = self.violations(y)
            if others.pop(name) > CLOSED and max(others.values(), default=0.0) <= CLOSED:
                return self.position(y, demand, loop if name in loop else ())
        return self.position(self.y, self.demands[worst], loop)

    def closest(self, loose: list[int]) -> np.ndarray:
        """Position of minimum violation of some equations that satisfies all others."""
        assembler, scale = self.assembler, self.assembler.scales.displacements
        sizes = assembler.residual(self.t, self.y, self.p).scale
        x = ca.SX.sym("x", scale.size)
        there = assembler.manifold.retract(ca.SX(self.y), ca.SX(scale) * x)
        residual = assembler.position(self.t, there, self.p)[0] / sizes
        others = sorted(set(range(sizes.size)) - set(loose))
        problem = {"x": x, "f": ca.sumsqr(residual[loose]), "g": residual[others]}
        solver = ipopt("closest", problem, TOLERANCE, MAX_ITERATIONS)
        step = scale * solver(x0=0, lbg=0, ubg=0)["x"].full().ravel()
        return assembler.displaced(self.y, step)

    def suspects(self, violation: dict[str, float], worst: str, loop: tuple[str, ...]) -> list[str]:
        """Open demands: prescribed lengths and angles first, then joints."""
        open_names = [n for n, v in violation.items() if v > SUSPECT * violation[worst]]
        prescribed = [n for n in open_names if self.demands[n].compared is not None]
        prescribed.sort(key=lambda name: (self.demands[name].joint is not None, -violation[name]))
        return list(dict.fromkeys([*prescribed, *loop[len(loop) // 2 :][:1], worst]))[:MAX_SUSPECTS]

    def violations(self, y: np.ndarray) -> dict[str, float]:
        """Demand → largest violation, in natural units."""
        residual = self.assembler.residual(self.t, y, self.p)
        relative = np.nan_to_num(np.abs(residual.value) / residual.scale, nan=np.inf)
        return {name: float(relative[d.rows].max()) for name, d in self.demands.items()}

    def position(self, y: np.ndarray, demand: _Demand, loop: tuple[str, ...]) -> OpenPosition:
        guess, ends = (
            self.assembler.start(self.t, self.p).full().ravel(),
            self.ends(y, demand.joint),
        )
        gap, text = self.gap_texts(y, demand, ends)
        return OpenPosition(self.d, self.p, self.t, guess, y, demand.name, ends, gap, text, loop)

    def ends(self, y: np.ndarray, joint: Constraint | None) -> np.ndarray | None:
        """(2, 2) the points of a joint."""
        if not isinstance(joint, PointJoint):
            return None
        ends = (joint.point_i.position.sx, joint.point_j.position.sx)
        return np.array([self.number(end, y) for end in ends])

    def gap_texts(self, y: np.ndarray, demand: _Demand, ends: np.ndarray | None) -> tuple[str, str]:
        """The gap of a demand, as a short text and as a sentence."""
        bodies = [part.name for part in demand.joint.parts()] if demand.joint else []
        name = f"{demand.name} ({', '.join(bodies)})" if bodies else demand.name
        if demand.compared is not None:
            reached, wanted = (float(self.number(sx, y)[0]) for sx in demand.compared)
            if not np.isfinite(reached):
                wish = _amount(wanted, demand.unit)
                return f"{wish} wanted", (
                    f"{name} requires {wish}, but its measure is undefined ({reached:g}) at "
                    "the given poses, where axes are perpendicular or points coincide"
                )
            bound = "at most" if reached < wanted else "at least"
            limit = f"{bound} {_amount(reached, demand.unit)} can be reached"
            short = (
                f"{_amount(wanted, demand.unit)} wanted, {bound} {_amount(reached, demand.unit)}"
            )
            return short, f"{name} requires {_amount(wanted, demand.unit)}, {limit}"
        assert demand.joint is not None
        left, units = np.abs(self.number(demand.joint.equations, y)), demand.joint.units()
        gap = float(np.linalg.norm(left[[unit == "m" for unit in units]]))
        if ends is not None and gap > CLOSED * self.assembler.scales.length:
            short = _amount(gap, "m")
            return short, f"{name} stays open: its points are {short} apart at best, 0 m wanted"
        k = int(np.argmax(left))
        short = _amount(left[k], units[k])
        return short, f"{name} stays open by {short} at best, {_amount(0.0, units[k])} wanted"

    def number(self, expression: ca.SX, y: np.ndarray) -> np.ndarray:
        e = self.assembler.equations
        fixed = at_ground(self.d.ground, ca.densify(expression))
        return ca.Function("n", [e.t, e.y, e.p], [fixed])(self.t, y, self.p).full().ravel()


def _amount(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".rstrip()
