"""What a mechanism is, told before anything is simulated."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import casadi as ca
import numpy as np
import scipy

from dalembert.elements.driver import Driver
from dalembert.errors import SingularityError
from dalembert.model.assembly.closure import Closure
from dalembert.model.assembly.independence import columns_of, least_fill
from dalembert.model.checks import doubts_of
from dalembert.model.description import Description
from dalembert.model.idle_freedom import idle_freedoms
from dalembert.model.tree.topology import Topology, analyse_topology
from dalembert.symbolic.formulas.expression import free_symbols
from dalembert.text.wording import card, messages, table

NOT_SHARED = 1e-9
"""Share of an equation in another, both of length one, that is rounding."""
NO_MASS = 1e-12
"""Mass, relative to the largest, that counts as none."""
NOT_MOVING = 1e-6
"""Part of a motion, relative to its largest, that is rounding."""
MOVED = 1e-6
"""Correction of a guess, in natural units, that is told."""


@dataclass(frozen=True)
class Redundancy:
    """A constraint equation that follows from others.

    Attributes
    ----------
    joint, component : which equation, e.g. ``"B"`` and ``1``
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
    """Degrees of freedom, redundancies, loops and doubtful bodies.

    Attributes
    ----------
    degrees_of_freedom : by the rank of the joints' Jacobian at the assembled position
    gruebler : coordinates − joint equations, the count that ignores redundancy
    driven : number of driver equations
    free : degrees of freedom that the drivers leave
    lost : joints that lose their independence in a singular position at the start
    doubts : what elements had better be otherwise
    searched : remark where the given poses are far from closed; empty otherwise
    idle : idle degrees of freedom, such as a rod that turns freely about its own axis
    corrections : given coordinate → change that assembly made; ``moved`` lists those to be told
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
    doubts: tuple[str, ...] = ()
    searched: str = ""
    idle: tuple[str, ...] = ()
    units: dict[str, str] = field(default_factory=dict)

    def refuse_massless(
        self,
        cure: str = "give mass and inertia to the bodies that move there, or constrain them",
    ) -> None:
        """Accelerations follow from forces where mass moves.

        Raises
        ------
        SingularityError
            Something can move without.
        """
        if self.massless:
            names = ", ".join(self.massless)
            raise SingularityError(f"{names}: can move without any mass moving; {cure}")

    def _change(self, name: str, change: float, per: str = "") -> str:
        unit = self.units.get(name, "")
        return f"{name} by {change:+.3g} {unit and unit + per}".rstrip()

    def __repr__(self) -> str:
        """The sentence, and what a user should know."""
        told = "".join(f"\n  {level}: {text}" for level, text in self.messages)
        return f"<Diagnosis: {self.summary}{told}>"

    @property
    def summary(self) -> str:
        n = self.degrees_of_freedom
        text = f"{n} degree{'' if n == 1 else 's'} of freedom"
        if self.driver_equations:
            text += f", {self.driver_equations} driven, {self.free} free"
        return text

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of everything a user should know."""
        found = []
        for redundancy in self.redundancies:
            found.append(("warning", f"redundant: {redundancy}; these reactions are not unique"))
        if self.lost:
            found.append(
                (
                    "warning",
                    f"the start is a singular position (dead centre or branch point): {self.lost} "
                    "lose their independence there; AugmentedLagrangian() passes through it",
                )
            )
        if self.massless:
            found.append(
                (
                    "warning",
                    f"{', '.join(self.massless)} can move without any mass moving: dynamics is "
                    "singular until mass or inertia is given",
                )
            )
        for name in self.topology.unconnected:
            found.append(("warning", f"body {name} is not connected to anything"))
        found += [("warning", doubt) for doubt in self.doubts]
        found += [("info", text) for text in self.idle]
        if self.searched:
            found.append(("warning", self.searched))
        if self.moved:
            listed = ", ".join(self._change(n, self.corrections[n]) for n in self.moved)
            found.append(("info", f"assembly moved given poses: {listed}"))
        if self.velocity_corrections:
            changes = self.velocity_corrections.items()
            listed = ", ".join(self._change(n, c, "/s") for n, c in changes)
            found.append(("warning", f"initial speeds were inconsistent and projected: {listed}"))
        return found

    def _repr_html_(self) -> str:
        return card("Diagnosis", self.summary, messages(self.messages), table(self.rows))

    @property
    def rows(self) -> list[tuple[str, Any]]:
        """What the mechanism consists of, by kind."""
        kinds = ("bodies", "joints", "drivers", "forces")
        listed = [(kind, ", ".join(getattr(self, kind))) for kind in kinds]
        counted = f"{self.coordinates} coordinates − {self.joint_equations} joint equations"
        loops = "; ".join("–".join(loop) for loop in self.topology.loops)
        rows = [("Grübler's count", f"{counted} = {self.gruebler}"), ("loops", loops), *listed]
        return [(name, text) for name, text in rows if text]

    def to_dict(self) -> dict:
        """Plain data, for JSON."""
        return asdict(self) | {
            "summary": self.summary,
            "messages": [{"level": level, "text": text} for level, text in self.messages],
        }


def _touched(d: Description) -> set[str]:
    """Names of bodies that a constraint or force acts on, be it by a formula of where they are."""
    acting = [*d.constraints, *(f for f in d.forces if f.name != "gravity" and not f.internal)]
    found = {body.name for element in acting for body in element.parts()}
    symbols = [(body.name, ca.symvar(ca.vertcat(body.pose, body.twist))) for body in d.bodies]
    owners = {symbol.name(): name for name, listed in symbols for symbol in listed}
    for element in acting:
        if not element.parts():
            for _, formula, _ in element.checked_quantities():
                found |= {owners[s] for s in free_symbols(formula.sx) if s in owners}
    return found


def diagnose(d: Description, closure: Closure, mass: scipy.sparse.csc_array) -> Diagnosis:
    """Examine a closed mechanism; ``mass`` is its mass matrix."""
    is_driver = np.array([isinstance(c, Driver) for c, _ in closure.owners], dtype=bool)
    kept = np.zeros(len(closure.owners), dtype=bool)
    kept[closure.generic] = True
    n = closure.all_equations.speed_count
    own = sum(c.twist.numel() for k in d.constraints for c in k.own_coordinates())
    joint_rows = int(np.sum(~is_driver))
    independent_joint_rows = int(np.sum(kept & ~is_driver))
    redundancies = tuple(_redundancy(closure, k) for k in range(len(closure.owners)) if not kept[k])
    return Diagnosis(
        coordinates=n - own,
        joint_equations=joint_rows - own,
        driver_equations=int(np.sum(is_driver)),
        degrees_of_freedom=n - independent_joint_rows,
        gruebler=n - joint_rows,
        free=n - len(closure.generic),
        redundancies=redundancies,
        topology=analyse_topology(d.bodies, d.constraints, _touched(d)),
        massless=_massless(closure, mass),
        bodies=tuple(b.name for b in d.bodies),
        joints=tuple(c.name for c in d.constraints if not isinstance(c, Driver)),
        drivers=tuple(c.name for c in d.constraints if isinstance(c, Driver)),
        forces=tuple(f.name for f in d.forces),
        corrections=closure.start.corrections,
        moved=_moved(closure),
        velocity_corrections=closure.start.velocity_corrections,
        lost=closure.lost,
        doubts=doubts_of(d, closure.nominal),
        searched=_searched(closure),
        idle=idle_freedoms(d, closure),
        units=_units(closure),
    )


def _searched(closure: Closure) -> str:
    """Remark on a start that only a search from random places closed."""
    if (searched := closure.searched) is None:
        return ""
    change = closure.start.corrections
    sizes = dict(zip(closure.guesses.speed_names, closure.scales.displacements, strict=True))
    farthest = max(change, key=lambda name: abs(change[name]) / sizes[name], default="")
    count = len(searched.positions)
    moved = f"; it moved {farthest} by {change[farthest]:+.3g}, farthest of all" if farthest else ""
    return (
        f"the given poses are far from closed: a search from {searched.starts} random starts found "
        f"{count} assembled {'position' if count == 1 else 'positions'} and took the nearest"
        f"{moved}; give poses nearer to the assembly that is wanted"
    )


def _units(closure: Closure) -> dict[str, str]:
    """Units of the coordinates that assembly corrected."""
    start, guesses = closure.start, closure.guesses
    units = zip(guesses.speed_names, guesses.speed_units, strict=True)
    return {n: u for n, u in units if n in start.corrections or n in start.velocity_corrections}


def _moved(closure: Closure) -> tuple[str, ...]:
    """Given places that assembly has changed by more than can be called rounding."""
    sizes = zip(closure.guesses.speed_names, closure.scales.displacements, strict=True)
    change = closure.start.corrections
    return tuple(name for name, size in sizes if abs(change.get(name, 0.0)) > MOVED * size)


def _redundancy(closure: Closure, row: int) -> Redundancy:
    constraint, component = closure.owners[row]
    weights = closure.independence.kernel({row: -1.0})
    shared = [
        closure.owners[k][0].name
        for k in closure.rows
        if abs(weights[k]) > NOT_SHARED and closure.owners[k][0] is not constraint
    ]
    return Redundancy(constraint.name, component, tuple(dict.fromkeys(shared)))


def _massless(closure: Closure, mass: scipy.sparse.csc_array) -> tuple[str, ...]:
    """Bodies that take part in a free motion without kinetic energy, ``C δ = M δ = 0``."""
    scale = scipy.sparse.diags_array(closure.scales.displacements)
    weighed = scipy.sparse.csr_array(scale @ mass @ scale)
    largest = abs(weighed).max(axis=1).toarray().ravel()
    heavy = np.flatnonzero(largest > NO_MASS * largest.max(initial=0.0))
    moved = scipy.sparse.vstack([closure.jacobian[closure.rows], weighed[heavy]])
    motions = columns_of(moved, least_fill(moved))
    if not motions.free:
        return ()
    motion = np.abs(motions.any_kernel(np.random.default_rng(0)))
    moving = motion > NOT_MOVING * motion.max()
    return tuple(dict.fromkeys(o for o, m in zip(closure.guesses.owners, moving, strict=True) if m))
