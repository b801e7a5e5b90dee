"""Compliant contacts of a step as rigid ones with a compliance, by Newton's method.

    P_N = Ψ(u_N⁺) = h f̄(δ, δ⁺, δ̇),    δ⁺ = δ + h δ̇,    δ̇ = −(θ u_N⁺ + (1−θ) u_N)

decreases with ``u_N⁺``. About a velocity ``w`` it is a rigid contact with the offset ``−w − Ψ/κ``
and the compliance ``1/κ``, ``κ = −Ψ'(w)``:  ``0 ≤ u_N⁺ + P_N/κ − w − Ψ/κ ⟂ P_N ≥ 0``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.force_laws import ForceLaws
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.impulses import Impulses
from dalembert.integrators.contact.mean_force import mean_force
from dalembert.integrators.contact.schemes import Approach

STIFFEST, SOFTEST = 1e-12, 1e10
"""Lower and upper limit of a compliance relative to the mobility of its contact [-]."""


class CompliantContacts:
    """Compliant contacts of one step.

    Parameters
    ----------
    laws : ForceLaws
    approach : Approach of all contacts
    mobility : (n,) change of the normal velocity by a unit normal impulse [1/kg]
    theta : of the scheme

    Attributes
    ----------
    rows : (c,) numbers of the compliant contacts
    offsets : (c,) offsets of their normal velocities [m/s]
    compliance : (n,) ``1/κ``, zero for rigid contacts [1/kg]
    residual : largest violation of ``P_N = Ψ(u_N⁺)``, as a speed [m/s]
    """

    def __init__(self, laws: ForceLaws, approach: Approach, mobility: np.ndarray, theta: float):
        contacts = approach.contacts
        self._laws, self._h, self._theta = laws, approach.h, theta
        numbers = laws.of(contacts)
        self.rows = np.flatnonzero(laws.compliant(contacts))
        self._numbers, self._depth = numbers[self.rows], -contacts.distance[self.rows]
        self._before, self._mobility = approach.before[self.rows, 0], mobility[self.rows]
        self.compliance, self.offsets = np.zeros(contacts.count), np.zeros(self.rows.size)
        self.residual, self._share = np.inf, 1.0
        self._last: tuple[np.ndarray, tuple[np.ndarray, np.ndarray]] | None = None
        self._velocity = approach.free[self.rows, 0]
        if self.rows.size:
            self._linearize()

    def law(self, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``Ψ`` and ``κ`` (c,) at normal velocities (c,) after the step; those of the last call if
        the velocities are the same."""
        if self._last is None or not np.array_equal(velocity, self._last[0]):
            self._last = velocity.copy(), self._law(velocity)
        return self._last[1]

    def _law(self, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        h, theta = self._h, self._theta
        rate = -(theta * velocity + (1 - theta) * self._before)
        start, end = self._depth, self._depth + h * rate

        def force(depth: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, ...]:
            inside = np.maximum(start, end) > 0
            return tuple(self._laws(self._numbers[inside], depth, rate)[:3])

        mean = mean_force(force, start, end, rate)  # type: ignore[arg-type]
        return h * mean.value, h * theta * (h * mean.by_end + mean.by_rate)

    def update(self, impulses: np.ndarray, after: np.ndarray, scale: float) -> bool:
        """Linearise about computed velocities unless the impulses satisfy the laws.

        Parameters
        ----------
        impulses, after : (n,) normal impulses and velocities
        scale : residual that counts as zero [m/s]

        Returns
        -------
        Whether the conditions have changed.
        """
        if not self.rows.size:
            self.residual = 0.0
            return False
        velocity = after[self.rows]
        violation = np.abs(impulses[self.rows] - self.law(velocity)[0]) * self._mobility
        last, self.residual = self.residual, float(violation.max())
        if self.residual <= scale:
            return False
        self._share = min(1.0, 2 * self._share) if self.residual < last else self._share / 2
        self._velocity = self._velocity + self._share * (velocity - self._velocity)
        self._linearize()
        return True

    def solution(
        self, impulses: Impulses, after: np.ndarray, solver: ContactSolver, size: float
    ) -> Impulses:
        """Impulses that include the residual of the laws; zero where these have no force.

        Parameters
        ----------
        after : (n, k) velocities after the step
        size : speed that residuals are compared with [m/s]
        """
        if not self.rows.size:
            return impulses
        pressing, residual = impulses.impulses.copy(), max(impulses.residual, self.residual)
        pressing[self.rows[self.law(after[self.rows, 0])[0] <= 0]] = 0.0
        return replace(
            impulses,
            impulses=pressing,
            residual=residual,
            converged=impulses.converged and self.residual <= solver.tolerance * size,
            accepted=impulses.accepted and self.residual <= solver.acceptable * size,
        )

    def fractions(self, after: np.ndarray) -> np.ndarray:
        """(n,) length of the step over the duration of each contact, ``√(2 κ H)/π`` [-]."""
        fractions = np.zeros(after.size)
        if not self.rows.size:
            return fractions
        fractions[self.rows] = np.sqrt(2 * self.law(after[self.rows])[1] * self._mobility) / np.pi
        return fractions

    def stored(self, after: np.ndarray) -> float:
        """Change of the elastic energy in the step [J]."""
        if not self.rows.size:
            return 0.0
        rate = -(self._theta * after[self.rows] + (1 - self._theta) * self._before)
        ends = np.stack([self._depth, self._depth + self._h * rate])
        energies = self._laws(self._numbers, np.maximum(ends, 0.0).T, 0 * ends.T)[3]
        return float((energies[:, 1] - energies[:, 0]).sum())

    def _linearize(self) -> None:
        impulse, slope = self.law(self._velocity)
        compliance = self._mobility * SOFTEST
        np.divide(1.0, slope, out=compliance, where=slope * compliance > 1)
        compliance = np.maximum(compliance, STIFFEST * self._mobility)
        self.offsets = -self._velocity - impulse * compliance
        self.compliance[self.rows] = compliance
