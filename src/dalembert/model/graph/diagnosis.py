"""Diagnosis of a mechanism: degrees of freedom, redundancies, loops and warnings."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.driver import Driver
from dalembert.errors import SingularityError
from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.regularity import shared_constraints
from dalembert.model.graph.checks import element_warnings
from dalembert.model.graph.description import Description
from dalembert.model.graph.idle_freedom import idle_freedoms, massless_bodies
from dalembert.model.graph.tree.spanning_tree import Topology, analyse_topology
from dalembert.symbolic.formulas.expression import free_symbols
from dalembert.text.wording import card, messages, table

MOVED = 1e-6
"""Threshold for reporting the correction of a guess, in natural units."""


@dataclass(frozen=True)
class Redundancy:
    """A redundant constraint equation.

    Attributes
    ----------
    joint, component : of the equation, e.g. ``"B"`` and ``1``
    shared_with : joints whose equations it depends on; their reactions are not unique
    """

    joint: str
    component: int
    shared_with: tuple[str, ...]

    def __str__(self) -> str:
        others = ", ".join(self.shared_with) or "others"
        return f"equation {self.component + 1} of {self.joint} follows from {others}"


@dataclass(frozen=True)
class Diagnosis:
    """Degrees of freedom, redundancies, loops and warnings.

    Attributes
    ----------
    degrees_of_freedom : by the rank of the joints' Jacobian at the assembled position
    gruebler : coordinates − joint equations, ignoring redundancy
    driven : number of driver equations
    free : degrees of freedom without drivers
    lost : joints that lose their independence in a singular position at the start
    element_warnings : warnings of elements
    searched : remark if the initial poses are far from an assembly; empty otherwise
    idle : idle degrees of freedom, such as a rod that rotates freely about its own axis
    corrections : initial coordinate → change by assembly; ``moved`` lists those to report
    units : coordinate → unit of its corrections, ``m`` or ``rad``
    """

    coordinates: int
    joint_equations: int
    driver_equations: int
    degrees_of_freedom: int
    gruebler: int
    free: int
    redundancies: tuple[Redundancy, ...]
    topology: Topology
    massless: tuple[str, ...]
    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    drivers: tuple[str, ...]
    forces: tuple[str, ...]
    corrections: dict[str, float]
    moved: tuple[str, ...]
    velocity_corrections: dict[str, float]
    lost: str = ""
    element_warnings: tuple[str, ...] = ()
    searched: str = ""
    idle: tuple[str, ...] = ()
    units: dict[str, str] = field(default_factory=dict)

    def refuse_massless(
        self,
        cure: str = "give mass and inertia to the bodies that move there, or constrain them",
    ) -> None:
        """Check that no motion is free of mass, so that forces determine accelerations.

        Raises
        ------
        SingularityError
            A body can move without any mass moving.
        """
        if self.massless:
            names = ", ".join(self.massless)
            raise SingularityError(f"{names}: can move without any mass moving; {cure}")

    def _change(self, name: str, change: float, per: str = "") -> str:
        unit = self.units.get(name, "")
        return f"{name} by {change:+.3g} {unit and unit + per}".rstrip()

    def __repr__(self) -> str:
        """The summary and all messages."""
        lines = "".join(f"\n  {level}: {text}" for level, text in self.messages)
        return f"<Diagnosis: {self.summary}{lines}>"

    @property
    def summary(self) -> str:
        n = self.degrees_of_freedom
        text = f"{n} degree{'' if n == 1 else 's'} of freedom"
        if self.driver_equations:
            text += f", {self.driver_equations} driven, {self.free} free"
        return text

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of all warnings and remarks."""
        items = []
        for redundancy in self.redundancies:
            items.append(("warning", f"redundant: {redundancy}; these reactions are not unique"))
        if self.lost:
            items.append(
                (
                    "warning",
                    f"the start is a singular position (dead centre or branch point): {self.lost} "
                    "lose their independence there; AugmentedLagrangian() passes through it",
                )
            )
        if self.massless:
            items.append(
                (
                    "warning",
                    f"{', '.join(self.massless)} can move without any mass moving: dynamics is "
                    "singular until mass or inertia is given",
                )
            )
        for name in self.topology.unconnected:
            items.append(("warning", f"body {name} is not connected to anything"))
        items += [("warning", text) for text in self.element_warnings]
        items += [("info", text) for text in self.idle]
        if self.searched:
            items.append(("warning", self.searched))
        if self.moved:
            listed = ", ".join(self._change(n, self.corrections[n]) for n in self.moved)
            items.append(("info", f"assembly moved given poses: {listed}"))
        if self.velocity_corrections:
            changes = self.velocity_corrections.items()
            listed = ", ".join(self._change(n, c, "/s") for n, c in changes)
            items.append(("warning", f"initial speeds were inconsistent and projected: {listed}"))
        return items

    def _repr_html_(self) -> str:
        return card("Diagnosis", self.summary, messages(self.messages), table(self.rows))

    @property
    def rows(self) -> list[tuple[str, Any]]:
        """(label, text): degrees of freedom, loops and parts by kind."""
        kinds = ("bodies", "joints", "drivers", "forces")
        parts = [(kind, ", ".join(getattr(self, kind))) for kind in kinds]
        counted = f"{self.coordinates} coordinates − {self.joint_equations} joint equations"
        loops = "; ".join("–".join(loop) for loop in self.topology.loops)
        rows = [("Grübler's count", f"{counted} = {self.gruebler}"), ("loops", loops), *parts]
        return [(name, text) for name, text in rows if text]

    def to_dict(self) -> dict:
        """Plain data, for JSON."""
        return asdict(self) | {
            "summary": self.summary,
            "messages": [{"level": level, "text": text} for level, text in self.messages],
        }


def _touched(d: Description) -> set[str]:
    """Names of bodies that an element acts on, also by a formula of their positions."""
    acting = [*d.constraints, *(f for f in d.forces if f.name != "gravity" and not f.internal)]
    contacts = [e for e in d.elements.values() if isinstance(e, Collisions)]
    names = {body.name for element in (*acting, *contacts) for body in element.parts()}
    symbols = [(body.name, ca.symvar(ca.vertcat(body.pose, body.twist))) for body in d.bodies]
    owners = {symbol.name(): name for name, listed in symbols for symbol in listed}
    for element in acting:
        if not element.parts():
            for _, formula, _ in element.checked_quantities():
                names |= {owners[s] for s in free_symbols(formula.sx) if s in owners}
    return names


def diagnose(d: Description, closure: Closure, mass: scipy.sparse.csc_array) -> Diagnosis:
    """Diagnosis of an assembled mechanism; ``mass`` is its mass matrix."""
    is_driver = np.array([isinstance(c, Driver) for c, _ in closure.owners], dtype=bool)
    is_generic = np.zeros(len(closure.owners), dtype=bool)
    is_generic[closure.generic] = True
    n = closure.all_equations.speed_count
    own = sum(c.twist.numel() for k in d.constraints for c in k.own_coordinates())
    joint_rows = int(np.sum(~is_driver))
    independent_joint_rows = int(np.sum(is_generic & ~is_driver))
    redundancies = tuple(
        _redundancy(closure, k) for k in range(len(closure.owners)) if not is_generic[k]
    )
    return Diagnosis(
        coordinates=n - own,
        joint_equations=joint_rows - own,
        driver_equations=int(np.sum(is_driver)),
        degrees_of_freedom=n - independent_joint_rows,
        gruebler=n - joint_rows,
        free=n - len(closure.generic),
        redundancies=redundancies,
        topology=analyse_topology(d.bodies, d.constraints, _touched(d)),
        massless=massless_bodies(d, closure, mass),
        bodies=tuple(b.name for b in d.bodies),
        joints=tuple(c.name for c in d.constraints if not isinstance(c, Driver)),
        drivers=tuple(c.name for c in d.constraints if isinstance(c, Driver)),
        forces=tuple(f.name for f in d.forces),
        corrections=closure.start.corrections,
        moved=_moved(closure),
        velocity_corrections=closure.start.velocity_corrections,
        lost=closure.lost,
        element_warnings=element_warnings(d, closure.nominal),
        searched=_searched(closure),
        idle=idle_freedoms(d, closure),
        units=_units(closure),
    )


def _searched(closure: Closure) -> str:
    """Remark on a start that was assembled by a search from random positions."""
    if (search := closure.searched) is None:
        return ""
    change = closure.start.corrections
    sizes = dict(zip(closure.guesses.speed_names, closure.scales.displacements, strict=True))
    farthest = max(change, key=lambda name: abs(change[name]) / sizes[name], default="")
    count = len(search.positions)
    moved = f"; it moved {farthest} by {change[farthest]:+.3g}, farthest of all" if farthest else ""
    return (
        f"the given poses are far from closed: a search from {search.starts} random starts found "
        f"{count} assembled {'position' if count == 1 else 'positions'} and took the nearest"
        f"{moved}; give poses nearer to the assembly that is wanted"
    )


def _units(closure: Closure) -> dict[str, str]:
    """Units of the coordinates that assembly corrected."""
    start, guesses = closure.start, closure.guesses
    units = zip(guesses.speed_names, guesses.speed_units, strict=True)
    return {n: u for n, u in units if n in start.corrections or n in start.velocity_corrections}


def _moved(closure: Closure) -> tuple[str, ...]:
    """Initial coordinates that assembly has changed by more than rounding."""
    sizes = zip(closure.guesses.speed_names, closure.scales.displacements, strict=True)
    change = closure.start.corrections
    return tuple(name for name, size in sizes if abs(change.get(name, 0.0)) > MOVED * size)


def _redundancy(closure: Closure, row: int) -> Redundancy:
    constraint, component = closure.owners[row]
    shared = shared_constraints(closure.owners, closure.independence, row)
    return Redundancy(constraint.name, component, shared)
