"""Whether the energy of a motion is that put in and not dissipated."""

from __future__ import annotations

from functools import cached_property

import numpy as np

ROUNDING = 1e-9, 1e-6
"""Shares of the energies themselves, and of the mechanism's natural energy, that tell nothing."""


class EnergyBalance:
    """``E − E₀ + dissipated − input`` along a trajectory, and what it is compared with.

    Parameters
    ----------
    energies : (2, K) kinetic and potential energy from the start on [J]
    work : (2, K) dissipated and put in since the start [J]
    t : (K,) [s]
    natural : energy of the mechanism's own size [J]
    """

    def __init__(self, energies: np.ndarray, work: np.ndarray, t: np.ndarray, natural: float):
        self.energies, self.work, self.t, self.natural = energies, work, t, natural

    @property
    def errors(self) -> np.ndarray:
        """(K,) energy that came from nowhere [J]."""
        dissipated, given = self.work
        total = self.energies.sum(axis=0) + dissipated - given
        return total - total[0]

    @property
    def moved(self) -> float:
        """The energy that took part: kinetic, of storages since the start, dissipated, put in."""
        kinetic, potential = self.energies
        parts = (kinetic, potential - potential[0], *self.work)
        least = ROUNDING[0] * np.abs(self.energies).max() + ROUNDING[1] * self.natural
        return float(sum(np.abs(part).max() for part in parts) + least)

    @cached_property
    def worst(self) -> tuple[float, float, float]:
        """Largest error over the energy that took part, the error itself [J], and its time [s]."""
        with np.errstate(all="ignore"):
            shares = np.abs(self.errors) / self.moved
        shares = np.where(np.isfinite(shares), shares, np.inf)
        k = int(np.argmax(shares))
        return float(shares[k]), float(self.errors[k]), float(self.t[k])

    @property
    def text(self) -> str:
        """The worst error, told."""
        share, error, time = self.worst
        what = "appeared" if error > 0 else "vanished"
        return (
            f"{abs(error):.3g} J {what} by t = {time:.9g} s, {share:.0%} of the {self.moved:.3g} J "
            "that took part in the motion"
        )
