"""What a mechanism is, told before anything is simulated."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from dalembert.elements.planar.drivers import Driver
from dalembert.model.closure import Closure
from dalembert.model.description import Description
from dalembert.model.topology import Topology, analyse_topology


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
    velocity_corrections: dict[str, float]

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
        moved = {n: c for n, c in self.corrections.items() if abs(c) > 1e-6}
        if moved:
            listed = ", ".join(f"{n} by {c:+.3g}" for n, c in moved.items())
            found.append(("info", f"assembly moved given poses: {listed}"))
        if self.velocity_corrections:
            listed = ", ".join(f"{n} by {c:+.3g}" for n, c in self.velocity_corrections.items())
            found.append(("warning", f"initial speeds were inconsistent and projected: {listed}"))
        return found

    def to_dict(self) -> dict:
        """Plain data, for JSON."""
        return asdict(self) | {
            "summary": self.summary,
            "messages": [{"level": level, "text": text} for level, text in self.messages],
        }


def diagnose(d: Description, closure: Closure, mass: np.ndarray) -> Diagnosis:
    """Examine a closed mechanism; ``mass`` is its mass matrix."""
    is_driver = np.array([isinstance(c, Driver) for c, _ in closure.owners], dtype=bool)
    kept = np.zeros(len(closure.owners), dtype=bool)
    kept[closure.rows] = True
    n = closure.all_equations.coordinate_count
    own = sum(c.pose.numel() for k in d.constraints for c in k.own_coordinates())
    joint_rows = int(np.sum(~is_driver))
    independent_joint_rows = int(np.sum(kept & ~is_driver))
    redundancies = tuple(_redundancy(closure, k) for k in range(len(closure.owners)) if not kept[k])
    touched = {b.name for c in d.constraints for b in c.parts()}
    touched |= {b.name for f in d.forces if f.name != "gravity" for b in f.parts()}
    return Diagnosis(
        coordinates=n - own,
        joint_equations=joint_rows - own,
        driver_equations=int(np.sum(is_driver)),
        degrees_of_freedom=n - independent_joint_rows,
        gruebler=n - joint_rows,
        free=n - len(closure.rows),
        redundancies=redundancies,
        topology=analyse_topology(d.bodies, d.constraints, touched),
        massless=_massless(closure, mass),
        bodies=tuple(b.name for b in d.bodies),
        joints=tuple(c.name for c in d.constraints if not isinstance(c, Driver)),
        drivers=tuple(c.name for c in d.constraints if isinstance(c, Driver)),
        forces=tuple(f.name for f in d.forces),
        corrections=closure.start.corrections,
        velocity_corrections=closure.start.velocity_corrections,
    )


def _redundancy(closure: Closure, row: int) -> Redundancy:
    constraint, component = closure.owners[row]
    weights, *_ = np.linalg.lstsq(
        closure.jacobian[closure.rows].T, closure.jacobian[row], rcond=None
    )
    shared = [
        closure.owners[k][0].name
        for k, w in zip(closure.rows, weights, strict=True)
        if abs(w) > 1e-9 and closure.owners[k][0] is not constraint
    ]
    return Redundancy(constraint.name, component, tuple(dict.fromkeys(shared)))


def _massless(closure: Closure, mass: np.ndarray) -> tuple[str, ...]:
    """Bodies that take part in a free motion without kinetic energy."""
    basis = np.linalg.svd(closure.jacobian[closure.rows])[2][len(closure.rows) :].T
    if not basis.size:
        return ()
    values, vectors = np.linalg.eigh(basis.T @ mass @ basis)
    scale = max(np.abs(mass).max(), 1e-300)
    lost = basis @ vectors[:, values < 1e-12 * scale]
    moving = np.abs(lost).max(axis=1, initial=0.0) > 1e-6
    return tuple(dict.fromkeys(o for o, m in zip(closure.guesses.owners, moving, strict=True) if m))
