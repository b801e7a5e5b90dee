"""Linearised increments of an impact with compression and expansion.

Along an impact, ``u_j = u_{j−1} + H P_j``, and each increment satisfies

    P_j − proj(P_j − ρ (u_j − lowest_j)) = 0,      P_N,j ≥ minimum_j

on the branches that its contacts took: open, sticking or slipping. The active sets of compression
and expansion are those of their increments. Its conditions follow from the law,

    compression   lowest = (1 − s) min(u_N⁻, 0)                     s from 0 to 1
    expansion     lowest = −s e min(u_N⁻, 0) (Newton),   minimum: e P_c in total (Poisson)
    restoration   minimum such that W = W_0 − e² W_c (energetic),   W = −∫ u_N dP_N

and the instant ``s`` at which a slip ends from ``u_T = 0``: friction may turn back there.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.impact_path import LARGEST, Increment, Phase
from dalembert.integrators.contact.semismooth_newton import pieces
from dalembert.sensitivity.nonsmooth.proximal_factors import Entries, ProximalFactors

SAME = 1e-6
"""Relative accuracy with which impulses reach their upper limit [-]."""


class ImpactSystem:
    """Equations of all increments of one impact.

    Unknowns of each increment: impulses, velocities after it, energies taken up by the contacts;
    then the ends of increments that are ends of slip, and the last impulses that restore energy.
    Inputs: velocities before, changes ``R_j`` of the velocities after each increment at constant
    impulses, coefficients of the laws.

    Parameters
    ----------
    matrix : (n k, n k) ``H``
    laws : ContactLaws of the contacts
    groups : widths of the groups of tangential components
    increments : of the impact
    """

    def __init__(
        self,
        matrix: np.ndarray,
        laws: ContactLaws,
        groups: tuple[int, ...],
        increments: list[Increment],
    ):
        self.matrix, self.laws, self.groups, self.increments = matrix, laws, groups, increments
        self.before = increments[0].before
        self.shape = n, k = self.before.shape
        self.stride = n * (2 * k + 1)
        self.normal = np.arange(n) * k  # of a normal component
        self.columns = FIRST + len(groups)
        self.ends, self.last = self._slip_ends(), self._last_restored()
        self.extra = {(j, -1): i for i, j in enumerate(self.ends)}
        pairs = sorted((j, i) for i, j in enumerate(self.last) if j >= 0)
        self.extra |= {pair: len(self.ends) + i for i, pair in enumerate(pairs)}
        self.size = len(increments) * self.stride + len(self.extra)
        self.by_z, self.by_input = Entries(), Entries()
        for j in range(len(increments)):
            self._motion(j)
            self._conditions(j)
            self._energy(j)
        for (j, i), number in self.extra.items():
            row = len(increments) * self.stride + number
            self._slip_end(row, j) if i < 0 else self._restored(row, j, i)
        inputs = (1 + len(increments)) * n * k + n * self.columns
        self.inputs = self.by_input.matrix((self.size, inputs))
        weight = np.zeros(self.size)
        for j in range(len(increments)):
            weight[self.impulses(j)] = 1.0
        self.factors = ProximalFactors.of([(0, 0, self.by_z.matrix((self.size,) * 2))], weight)

    def push(self, inputs: np.ndarray) -> np.ndarray:
        """Changes (n k, c) of the sums of the impulses."""
        z = self.factors.solve(self.inputs @ inputs)
        return np.asarray(sum(z[self.impulses(j)] for j in range(len(self.increments))))

    def pull(self, impulses: np.ndarray) -> np.ndarray:
        """Weights of the inputs from those of the impulses."""
        weights = np.zeros((self.size, impulses.shape[1]))
        for j in range(len(self.increments)):
            weights[self.impulses(j)] = impulses
        return np.asarray(self.inputs.T @ self.factors.solve(weights, transposed=True))

    def impulses(self, j: int) -> np.ndarray:
        """Places of the impulses of an increment, and of its conditions."""
        return j * self.stride + np.arange(self.before.size)

    def velocities(self, j: int) -> np.ndarray:
        """Places of the velocities after an increment, and of the equations of motion."""
        return self.impulses(j) + self.before.size

    def energies(self, j: int) -> np.ndarray:
        """Places of the energies after an increment."""
        return j * self.stride + 2 * self.before.size + np.arange(self.shape[0])

    def coefficient(self, number: int) -> np.ndarray:
        """Places of a coefficient of the laws among the inputs."""
        first = (1 + len(self.increments)) * self.before.size
        return first + np.arange(self.shape[0]) * self.columns + number

    def _phase(self, phase: Phase) -> list[int]:
        return [j for j, part in enumerate(self.increments) if part.phase is phase]

    @cached_property
    def _pressed(self) -> np.ndarray:
        """(n,) normal impulses of the compression."""
        parts = (self.increments[j].impulses[:, 0] for j in self._phase(Phase.COMPRESSION))
        return np.asarray(sum(parts))

    def _slip_ends(self) -> list[int]:
        """Increments that end where a slip does: the next one passes this end."""
        parts = self.increments
        return [
            j
            for j in range(len(parts) - 1)
            if parts[j + 1].ended.any() and parts[j].phase is parts[j + 1].phase
        ]

    def _last_restored(self) -> np.ndarray:
        """(n,) last increment in which a contact restores energy, -1 without any."""
        last = np.full(self.shape[0], -1)
        for j in self._phase(Phase.RESTORATION):
            last[self.increments[j].minimum > 0] = j
        return last

    def _add(self, rows: np.ndarray, change: Any, values: np.ndarray) -> None:
        """Add ``values · change`` to rows; a change is that of unknowns, or ``(None, inputs)``."""
        if isinstance(change, tuple):
            self.by_input.add(rows, change[1], -values)
        else:
            self.by_z.add(rows, change, values)

    def _velocity(self, j: int) -> Any:
        """Velocities after an increment: unknowns, or the input before the first."""
        return self.velocities(j) if j >= 0 else (None, np.arange(self.before.size))

    def _motion(self, j: int) -> None:
        """``u_j − u_{j−1} − H P_j = R_j − R_{j−1}``."""
        rows, size = self.velocities(j), self.before.size
        one = np.ones(size)
        self._add(rows, self.velocities(j), one)
        before = self._velocity(j - 1)
        self._add(rows, before, -one)
        grid = np.broadcast_arrays(rows[:, None], self.impulses(j)[None])
        self.by_z.add(grid[0].ravel(), grid[1].ravel(), -self.matrix.ravel())
        self._add(rows, (None, size * (j + 1) + np.arange(size)), -one)
        if j:
            self._add(rows, (None, size * j + np.arange(size)), one)

    def _conditions(self, j: int) -> None:
        """Impulses and velocities on the branches of an increment."""
        part, (n, k) = self.increments[j], self.shape
        share = 0.5 if part.centred else 1.0  # of the increment at the instant of its conditions
        speeds = part.before + share * (part.after - part.before)
        speeds[:, 0] -= part.lowest
        laws, eye = self.laws.friction, np.eye(k)
        least = share * part.minimum
        problem = FrictionProblem(self.matrix, speeds, laws, self.groups, minimum=least)
        z = share * part.impulses - speeds / problem.mobility
        active = np.flatnonzero((z[:, 0] > least) | self._pushed(j))
        own, coupled = np.tile(eye, (n, 1, 1)), np.zeros((n, k, k))
        own[active], coupled[active] = pieces(problem, z, active)
        pressed, row = z[:, 0] > least, np.zeros(n)
        row[active] = 1.0
        by_minimum, pressure = np.zeros((n, k)), np.maximum(z[:, 0], least)
        by_minimum[:, 0] = -row * ~pressed
        for number, (components, friction) in enumerate(problem.discs):
            length = np.linalg.norm(z[:, components], axis=1)
            slips = ((length > friction * pressure) | (friction == 0)) & (length > 0)
            way = z[:, components] / np.where(length > 0, length, 1.0)[:, None]
            turned = (row * slips)[:, None] * way
            by_minimum[:, components] = -(~pressed * friction)[:, None] * turned
            for component, slope in enumerate((-pressure[:, None] * turned).T):
                place = self.normal + components.start + component
                rows = self.impulses(j)[place]
                self._add(rows, (None, self.coefficient(FIRST + number)), slope)
        rows = self.impulses(j).reshape(n, k)
        blocks = np.broadcast_arrays(rows[:, :, None], rows[:, None, :])
        places = blocks[0].ravel(), blocks[1].ravel()
        self.by_z.add(*places, share * own.ravel())
        self.by_z.add(places[0], places[1] + self.before.size, share * coupled.ravel())
        if part.centred:
            before = self._velocity(j - 1)
            columns = (before[1] if j == 0 else before).reshape(n, 1, k)
            columns = np.broadcast_to(columns, coupled.shape).ravel()
            change = columns if j else (None, columns)
            self._add(places[0], change, (1 - share) * coupled.ravel())
        for component in range(k):
            self._lowest(j, rows[:, component], -coupled[:, component, 0])
            self._minimum(j, rows[:, component], share * by_minimum[:, component])

    def _lowest(self, j: int, rows: np.ndarray, factors: np.ndarray) -> None:
        """Add ``factors d(lowest_j)`` to rows."""
        part, closing = self.increments[j], np.minimum(self.before[:, 0], 0.0)
        e, closes = self.laws.restitution, self.before[:, 0] < 0
        done = sum(part.span) / 2 if part.centred else part.span[1]
        by_speed, by_done = (1 - done) * closes, -closing
        if part.phase is not Phase.COMPRESSION:
            newton = self.laws.follows(ImpactLaw.NEWTON) * bool(self._phase(Phase.EXPANSION))
            done = done if part.phase is Phase.EXPANSION else 1.0
            by_speed, by_done = -done * e * newton * closes, -e * newton * closing
            self._add(rows, (None, self.coefficient(0)), -factors * done * newton * closing)
        self._add(rows, (None, self.normal), factors * by_speed)
        if part.phase is not Phase.RESTORATION:
            share = 0.5 if part.centred else 1.0
            self._end(j, rows, share * factors * by_done)
            self._begin(j, rows, (1 - share) * factors * by_done)

    def _pushed(self, j: int) -> np.ndarray:
        """(n,) mask of the contacts whose impulses in an increment depend on a law."""
        poisson = self.laws.follows(ImpactLaw.POISSON) & (self._pressed > 0)
        expands = self.increments[j].phase is Phase.EXPANSION
        return np.asarray((self.increments[j].minimum > 0) | (poisson & expands))

    def _minimum(self, j: int, rows: np.ndarray, factors: np.ndarray) -> None:
        """Add ``factors d(minimum_j)`` to rows."""
        part, runs = self.increments[j], self._pushed(j) & (self.last != j)
        if not self._pushed(j).any():
            return
        compression, pressed = self._phase(Phase.COMPRESSION), self._pressed
        size = self.laws.restitution * pressed
        share = part.minimum / np.where(size > 0, size, 1.0)
        if part.phase is Phase.EXPANSION:
            share = np.full(size.shape, part.span[1] - part.span[0])
        self._add(rows, (None, self.coefficient(0)), factors * runs * share * pressed)
        for i in compression:
            place = self.impulses(i)[self.normal]
            self._add(rows, place, factors * runs * share * self.laws.restitution)
        if part.phase is Phase.EXPANSION:
            self._end(j, rows, factors * runs * size)
            self._begin(j, rows, -factors * runs * size)
            return
        self._end(j, rows, factors * runs * part.minimum)
        for i in map(int, np.flatnonzero(self.last == j)):
            self._add(rows[i : i + 1], self._place(j, i), factors[i : i + 1])

    def _end(self, j: int, rows: np.ndarray, factors: np.ndarray) -> None:
        """Add ``factors ds_j`` to rows if the increment ends at an end of slip, or passes one: the
        latter has a constant length, as another one follows with the next branch."""
        phase, parts = self.increments[j].phase, self.increments
        if phase is Phase.RESTORATION or (j, -1) in self.extra:
            moved = j
        else:
            moved = j - 1 if j + 1 < len(parts) and parts[j + 1].phase is phase else -1
        if (moved, -1) in self.extra:
            self._add(rows, np.full(rows.size, self._place(moved, -1)[0]), factors)

    def _begin(self, j: int, rows: np.ndarray, factors: np.ndarray) -> None:
        """Add ``factors ds_{j−1}`` to rows; a phase begins with 0."""
        if j and self.increments[j - 1].phase is self.increments[j].phase:
            self._end(j - 1, rows, factors)

    def _place(self, j: int, i: int) -> np.ndarray:
        return np.array([len(self.increments) * self.stride + self.extra[j, i]])

    def _energy(self, j: int) -> None:
        """``W_j − W_{j−1} + P_N,j (u_N,j−1 + u_N,j)/2 = 0``."""
        part, rows, one = self.increments[j], self.energies(j), np.ones(self.shape[0])
        self._add(rows, self.energies(j), one)
        if j:
            self._add(rows, self.energies(j - 1), -one)
        mean = (part.before[:, 0] + part.after[:, 0]) / 2
        self._add(rows, self.impulses(j)[self.normal], mean)
        half = part.impulses[:, 0] / 2
        self._add(rows, self.velocities(j)[self.normal], half)
        before = self.velocities(j - 1)[self.normal] if j else (None, self.normal)
        self._add(rows, before, half)

    def _slip_end(self, row: int, j: int) -> None:
        """``u_T = 0`` after increment ``j``."""
        i, group = np.argwhere(self.increments[j + 1].ended)[0]
        first = 1 + sum(self.groups[:group])
        components = slice(first, first + self.groups[group])
        slip = self.increments[j].before[i, components]
        place = self.velocities(j).reshape(self.shape)[i, components]
        self._add(np.full(slip.size, row), place, slip / np.linalg.norm(slip))

    def _restored(self, row: int, j: int, i: int) -> None:
        """Energy, or largest impulse, of a contact after the last increment that restores it."""
        part, e = self.increments[j], self.laws.restitution[i]
        rows, one = np.array([row]), np.ones(1)
        if part.impulses[i, 0] > part.minimum[i] * (1 + SAME):  # pressed by others
            self._add(rows, self._place(j, i), one)
            return
        compression = self._phase(Phase.COMPRESSION)
        restored = [m for m in self._phase(Phase.RESTORATION) if m <= j]
        pressed = self._pressed[i]
        returned = sum(self.increments[m].impulses[i, 0] for m in restored)
        coefficient = (None, self.coefficient(0)[i : i + 1])
        if returned >= LARGEST * e * pressed * (1 - SAME):
            for m in restored:
                self._add(rows, self.impulses(m)[self.normal[i : i + 1]], one)
            for m in compression:
                self._add(rows, self.impulses(m)[self.normal[i : i + 1]], -LARGEST * e * one)
            self._add(rows, coefficient, -LARGEST * pressed * one)
            return
        energy = -sum(
            p.impulses[i, 0] * (p.before[i, 0] + p.after[i, 0]) / 2
            for p in (self.increments[m] for m in compression)
        )
        self._add(rows, self.energies(j)[i : i + 1], one)
        self._add(rows, self.energies(restored[0] - 1)[i : i + 1], -one)
        self._add(rows, self.energies(compression[-1])[i : i + 1], e**2 * one)
        self._add(rows, coefficient, 2 * e * energy * one)
