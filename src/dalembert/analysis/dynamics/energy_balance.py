"""Energy balance of a motion: change of energy against work put in and dissipated."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.status import Outcome

ROUNDING = 1e-9, 1e-6
"""Rounding: share of the energies themselves, and of the mechanism's natural energy."""
WARNING = 0.25
"""Share of the permitted energy error from which on a warning is given."""


def check_balance(balance: float) -> None:
    """Check that the permitted energy error is a positive share.

    Raises
    ------
    AnalysisError
        It is not positive.
    """
    if not balance > 0:
        raise AnalysisError(f"balance is {balance}; it must be a positive share")


class EnergyBalance:
    """``E − E₀ + dissipated − input`` along a trajectory, relative to the energy that took part.

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
        """(K,) energy error [J]."""
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
        """Outcome and message if the error exceeds a share ``limit`` of the energy, else None."""
        if self.worst[0] <= limit:
            return None
        return Outcome.UNBALANCED, f"{self.text}; {cure}"

    def warnings(self, limit: float) -> list[str]:
        """Warning about an error within the limit."""
        if not WARNING * limit < self.worst[0] <= limit:
            return []
        return [f"{self.text}; the steps are long for this motion"]

    @property
    def text(self) -> str:
        """The largest error in words."""
        share, error, time = self.worst
        verb = "appeared" if error > 0 else "vanished"
        return (
            f"{abs(error):.3g} J {verb} by t = {time:.9g} s, {share:.0%} of the {self.moved:.3g} J "
            "that took part in the motion"
        )


def energy_errors(energies: np.ndarray, work: np.ndarray) -> np.ndarray:
    """(…, K) energy error [J] from arrays (…, 2, K) as in ``EnergyBalance``."""
    total = energies.sum(axis=-2) + work[..., 0, :] - work[..., 1, :]
    return np.asarray(total - total[..., :1])


def energy_moved(energies: np.ndarray, work: np.ndarray, natural: float) -> np.ndarray:
    """(…,) energy that took part [J]."""
    kinetic, potential = energies[..., 0, :], energies[..., 1, :]
    parts = (kinetic, potential - potential[..., :1], work[..., 0, :], work[..., 1, :])
    least = ROUNDING[0] * np.abs(energies).max(axis=(-2, -1)) + ROUNDING[1] * natural
    return np.asarray(sum(np.abs(part).max(axis=-1) for part in parts) + least)
