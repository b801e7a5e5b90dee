"""What a mechanism is, told before anything is simulated."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from dalembert.model.topology import Topology


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
