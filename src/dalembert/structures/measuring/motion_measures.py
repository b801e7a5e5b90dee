"""Measures of motions: velocities, accelerations, kinetic energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.errors import AnalysisError
from dalembert.structures.evaluation.block import ElementBlock
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.measuring.measures import Measure, State, Weights


@dataclass(kw_only=True)
class MovingState(State):
    """A state with velocities and accelerations (n,), and the mass matrix of the analysis."""

    v: np.ndarray
    a: np.ndarray
    mass: scipy.sparse.csc_matrix
    lumped: bool


@dataclass(kw_only=True)
class MovingWeights(Weights):
    """Weights of a moving state."""

    v: np.ndarray
    a: np.ndarray

    @classmethod
    def zero(cls, size: int, parameters: int) -> MovingWeights:
        u, forces, v, a = (np.zeros(size) for _ in range(4))
        return cls(u=u, forces=forces, p=np.zeros(parameters), v=v, a=a)


def _moving(s: State) -> MovingState:
    if not isinstance(s, MovingState):
        raise AnalysisError(
            "velocities, accelerations and kinetic energy are defined for motions only; use "
            "solve_transient"
        )
    return s


@dataclass
class Velocity(Measure):
    """Time derivative of a displacement."""

    degree: int
    unit: str = "m/s"

    def value(self, s: State) -> float:
        return float(_moving(s).v[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.v[self.degree] += weight  # type: ignore[attr-defined]


@dataclass
class Acceleration(Measure):
    """Second time derivative of a displacement."""

    degree: int
    unit: str = "m/s^2"

    def value(self, s: State) -> float:
        return float(_moving(s).a[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.a[self.degree] += weight  # type: ignore[attr-defined]


@dataclass
class KineticEnergy(Measure):
    """``vᵀ M v / 2`` with the mass matrix of the analysis, which rotates with the elements."""

    blocks: list[ElementBlock]
    unit: str = "J"

    def value(self, s: State) -> float:
        moving = _moving(s)
        turning = [b for b in self.blocks if b.kind.turning(moving.lumped)]
        if not turning:
            return float(moving.v @ (moving.mass @ moving.v)) / 2
        return float(sum(self._of(b, moving)[0].sum() for b in self.blocks))

    def pull(self, s: State, weight: float, into: Weights) -> None:
        moving = _moving(s)
        for b in self.blocks:
            _, by_u, by_v, by_data = self._of(b, moving)
            into.u += weight * b.scatter(by_u, into.u.size)
            into.v += weight * b.scatter(by_v, into.u.size)  # type: ignore[attr-defined]
            into.p += weight * b.pull_data(s.p, by_data)

    @staticmethod
    def _of(b: ElementBlock, s: MovingState) -> tuple[np.ndarray, ...]:
        """Energies of the elements of a block, and their derivatives."""
        return b.kind.kinetic_energy(b.gather(s.u), b.gather(s.v), b.data(s.p), s.lumped)


def moving_measure(name: str, degrees: Numbering, blocks: list[ElementBlock]) -> Measure | None:
    """``node.vx``, ``node.ax``, ``node.vrz``, …, ``kinetic_energy``; None for other names."""
    if name == "kinetic_energy":
        return KineticEnergy(blocks)
    owner, _, quantity = name.partition(".")
    kind: type[Velocity | Acceleration] | None
    kind = {"v": Velocity, "a": Acceleration}.get(quantity[:1])  # type: ignore[assignment]
    if kind is None:
        return None
    for direction, unit in ((f"u{quantity[1:]}", "m"), (quantity[1:], "rad")):
        degree = degrees.get((owner, direction))
        if degree is not None and degrees.rotations[degree] == (unit == "rad"):
            return kind(degree, f"{unit}/s" if kind is Velocity else f"{unit}/s^2")
    return None
