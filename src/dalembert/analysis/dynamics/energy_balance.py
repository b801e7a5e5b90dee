"""Whether the energy of a motion is that put in and not dissipated."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.status import Outcome

ROUNDING = 1e-9, 1e-6
"""Shares of the energies themselves, and of the mechanism's natural energy, that tell nothing."""
QUARTER = 0.25
"""Of the largest share of the energy that may come from nowhere: what is told."""


def check_balance(balance: float) -> None:
    """A share above 0.

    Raises
    ------
    AnalysisError
        It is none.
    """
    if not balance > 0:
        raise AnalysisError(f"balance is {balance}; it must be a positive share")


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
        return energy_errors(self.energies, self.work)

    @property
    def moved(self) -> float:
        """The energy that took part: kinetic, of storages since the start, dissipated, put in."""
        return float(energy_moved(self.energies, self.work, self.natural))

    @cached_property
    def worst(self) -> tuple[float, float, float]:
        """Largest error over the energy that took part, the error itself [J], and its time [s]."""
        with np.errstate(all="ignore"):
            shares = np.abs(self.errors) / self.moved
        shares = np.where(np.isfinite(shares), shares, np.inf)
        k = int(np.argmax(shares))
        return float(shares[k]), float(self.errors[k]), float(self.t[k])

    def objection(self, limit: float, cure: str) -> tuple[Outcome, str] | None:
        """Why the run must not be called completed, if so; ``limit`` is of the share."""
        if self.worst[0] <= limit:
            return None
        return Outcome.UNBALANCED, f"{self.text}; {cure}"

    def doubts(self, limit: float) -> list[str]:
        """What should be known of an error within the limit."""
        if not QUARTER * limit < self.worst[0] <= limit:
            return []
        return [f"{self.text}; the steps are long for this motion"]

    @property
    def text(self) -> str:
        """The worst error, told."""
        share, error, time = self.worst
        what = "appeared" if error > 0 else "vanished"
        return (
            f"{abs(error):.3g} J {what} by t = {time:.9g} s, {share:.0%} of the {self.moved:.3g} J "
            "that took part in the motion"
        )


def energy_errors(energies: np.ndarray, work: np.ndarray) -> np.ndarray:
    """(…, K) energy that came from nowhere [J], of (…, 2, K) as in ``EnergyBalance``."""
    total = energies.sum(axis=-2) + work[..., 0, :] - work[..., 1, :]
    return np.asarray(total - total[..., :1])


def energy_moved(energies: np.ndarray, work: np.ndarray, natural: float) -> np.ndarray:
    """(…,) energy that took part [J]."""
    kinetic, potential = energies[..., 0, :], energies[..., 1, :]
    parts = (kinetic, potential - potential[..., :1], work[..., 0, :], work[..., 1, :])
    least = ROUNDING[0] * np.abs(energies).max(axis=(-2, -1)) + ROUNDING[1] * natural
    return np.asarray(sum(np.abs(part).max(axis=-1) for part in parts) + least)
