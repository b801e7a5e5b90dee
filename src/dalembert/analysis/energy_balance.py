"""Whether the energy of a motion is that put in and not dissipated."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.kernel import Kernel
from dalembert.symbolic.once import once

ROUNDING = 1e-9, 1e-6
"""Shares of the energies themselves, and of the mechanism's natural energy, that tell nothing."""


class EnergyBalance:
    """``E − E₀ + dissipated − input`` along a trajectory, and what it is compared with.

    Parameters
    ----------
    model : Model
    trajectory : from the start on, with the work done since
    p : (np,) parameters
    """

    def __init__(self, model: Model, trajectory: Trajectory, p: np.ndarray):
        self.model, self.s, self.p = model, trajectory, p

    @cached_property
    def energies(self) -> np.ndarray:
        """(2, K) kinetic and potential energy [J]."""
        s = self.s
        mapped = _energies(self.model, s.t.size)
        return mapped(s.t, s.y, s.v, np.tile(self.p[:, None], s.t.size))[0]

    @property
    def errors(self) -> np.ndarray:
        """(K,) energy that came from nowhere [J]."""
        dissipated, given = self.s.work
        total = self.energies.sum(axis=0) + dissipated - given
        return total - total[0]

    @property
    def moved(self) -> float:
        """The energy that took part: kinetic, of storages since the start, dissipated, put in."""
        kinetic, potential = self.energies
        parts = (kinetic, potential - potential[0], *self.s.work)
        least = ROUNDING[0] * np.abs(self.energies).max() + ROUNDING[1] * self.model.scales.energy
        return float(sum(np.abs(part).max() for part in parts) + least)

    @cached_property
    def worst(self) -> tuple[float, float, float]:
        """Largest error over the energy that took part, the error itself [J], and its time [s]."""
        with np.errstate(all="ignore"):
            shares = np.abs(self.errors) / self.moved
        shares = np.where(np.isfinite(shares), shares, np.inf)
        k = int(np.argmax(shares))
        return float(shares[k]), float(self.errors[k]), float(self.s.t[k])

    @property
    def text(self) -> str:
        """The worst error, told."""
        share, error, time = self.worst
        what = "appeared" if error > 0 else "vanished"
        return (
            f"{abs(error):.3g} J {what} by t = {time:.9g} s, {share:.0%} of the {self.moved:.3g} J "
            "that took part in the motion"
        )


@once
def _energies(model: Model, count: int) -> Kernel:
    """``(t, y, v, p) → [T; V]`` for so many columns."""
    e = model.all_equations
    both = ca.densify(ca.vertcat(e.kinetic_energy, e.potential))
    return Kernel(ca.Function("energies", [e.t, e.y, e.v, e.p], [both]).map(count))
