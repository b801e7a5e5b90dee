"""Singular positions of the constraints: who has a part in one, whether a run broke down there."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.driver import Driver
from dalembert.integrators.marching.steps import Steps
from dalembert.model.equations import Equations
from dalembert.model.model import Model

NEAR = 0.02
"""Smallest singular value of ``C``, relative to that at the start, that counts as near zero."""
AT_ONCE = 2000
"""States looked at in one go."""
LOST = 1e-6
"""Violation of a constraint, by its natural size, from which on a state tells nothing and a
corrected run has failed."""
SAMPLES, FINER = 200, 21
SHARE = 0.1
"""Share in the combination of equations that vanishes from which on a joint is named."""


class SingularPosition:
    """A position in or near which a combination of the constraint equations vanishes, ``cᵀC = 0``.

    Parameters
    ----------
    model : Model
    time, y : where
    p : (np,) parameters
    """

    def __init__(self, model: Model, time: float, y: np.ndarray, p: np.ndarray):
        self.model, self.time, self.y, self.p = model, time, y, p

    @cached_property
    def _alike(self) -> np.ndarray:
        """``C``, coordinates and equations measured by their natural sizes."""
        e = self.model.equations
        jacobian = ca.Function("C", [e.t, e.y, e.p], [e.jacobian])(self.time, self.y, self.p)
        return np.asarray(jacobian.full() * e.scales.displacements / e.scales.rows[:, None])

    @cached_property
    def _owners(self) -> list:
        """Constraints that have a part in it."""
        if not self._alike.size or not np.all(np.isfinite(self._alike)):
            return []
        part = np.abs(np.linalg.svd(self._alike)[0][:, -1])
        return self._named(np.flatnonzero(part > SHARE * part.max()))

    def _named(self, numbers: Iterable[int]) -> list:
        owners, rows = self.model.closure.owners, self.model.closure.rows
        return list(dict.fromkeys(owners[rows[k]][0] for k in numbers))

    @property
    def joints(self) -> str:
        """Names of the joints whose equations lose their independence."""
        names = [c.name for c in self._owners if not isinstance(c, Driver)]
        return ", ".join(names) or "the constraints"

    @property
    def stretched(self) -> str:
        """Names of the joints of the group that is stretched, where drivers move everything.

        All joints up to the driver carry the vanishing combination. What locks is one group of
        Assur: the block of ``C`` that is singular, in block triangular form (Dulmage and
        Mendelsohn) by whole bodies.
        """
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

        pattern = self.model.equations.jacobian.sparsity()
        rows, columns = pattern.size()
        if rows != columns or not self._owners:
            return self.joints
        filled = csr_array((np.ones(pattern.nnz()), pattern.get_triplet()), (rows, columns))
        matched = maximum_bipartite_matching(filled, perm_type="column")
        if np.any(matched < 0):
            return self.joints
        owners = np.array(self.model.guesses.owners)[matched]
        of_one_body = csr_array(owners[:, None] == owners)
        tied = filled[:, matched] + of_one_body
        count, block = connected_components(tied, connection="strong")
        groups = [np.flatnonzero(block == k) for k in range(count)]
        smallest = [
            np.linalg.svd(self._alike[np.ix_(group, matched[group])])[1][-1] for group in groups
        ]
        locked = self._named(groups[int(np.argmin(smallest))])
        return ", ".join(c.name for c in locked if not isinstance(c, Driver)) or self.joints

    @property
    def drivers(self) -> str:
        """Where the drivers stand, ``", driver 'motor' at crank.angle = 2.0944 rad (120°)"``."""
        known = [c for c in self.model.constraints if isinstance(c, Driver)]
        concerned = [c for c in known if c in self._owners] or known
        return "".join(f", {self._placed(driver)}" for driver in concerned)

    def _placed(self, driver: Driver) -> str:
        e = self.model.equations
        law = ca.Function("law", [e.t, e.p], [driver.law.value(e.t)])
        value = float(law(self.time, self.p))
        unit = driver.units()[0]
        degrees = f" ({np.degrees(value):.4g}°)" if unit == "rad" else ""
        return f"driver {driver.name!r} at {driver.measured} = {value:.5g} {unit}{degrees}"


def near_singular_position(
    e: Equations, steps: Steps, p: np.ndarray, lost_at: float, following: float
) -> tuple[float, float, np.ndarray] | None:
    """Time, smallest singular value of ``C`` and position where the run lost its constraints.

    Looked for from two steps before the last good state to two steps after it, along the straight
    line of its speeds; None where ``C`` keeps its rank. Its entries are measured by the natural
    sizes of coordinates and equations.

    Parameters
    ----------
    e : Equations as integrated
    steps : steps taken, ``x = [y; v; …]``
    p : (np,) parameters
    lost_at : time of the first output that violates the constraints
    following : length of the step that would have come next
    """
    if not e.constraint_count or not np.all(np.isfinite(steps.x[:, 0])):
        return None
    sizes = e.scales
    alike = ca.mtimes([ca.diag(1 / sizes.rows), e.jacobian, ca.diag(sizes.displacements)])
    seen_by_state = [e.constraints / sizes.rows, ca.densify(alike), e.pose_rate]
    if e.switches.count:  # on the sides where the state is
        seen_by_state = ca.substitute(seen_by_state, [e.switches.sides], [e.switches.actual])
    function = ca.Function("constraints", [e.t, e.y, e.v, e.p], seen_by_state)
    n, k = e.coordinate_count, e.speed_count
    times = np.append(steps.t[: steps.count], steps.end)

    def seen(j: int, after: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Smallest singular values some times after the beginning of step ``j``; time, position."""
        y, v, count = steps.x[:n, j], steps.x[n : n + k, j], after.size
        moved = y[:, None] + function(times[j], y, v, p)[2].full() * after
        tiled = (np.tile(column[:, None], count) for column in (v, p))
        found = function.map(count)(times[j] + after, moved, *tiled)[1].full()
        jacobians = found.reshape(found.shape[0], count, -1).transpose(1, 0, 2)
        known, smallest = np.isfinite(jacobians).all(axis=(1, 2)), np.full(count, np.inf)
        if known.any():
            smallest[known] = np.linalg.svd(jacobians[known], compute_uv=False)[:, -1]
        return list(zip(smallest.tolist(), (times[j] + after).tolist(), moved.T, strict=True))

    before = int(np.searchsorted(times, lost_at)) - 1
    good = max(min(_last_good(function, steps, times, n, k, p), before), 0)
    length = steps.h[min(good, steps.count - 1)] if steps.count else following
    found = [seen(j, np.zeros(1))[0] for j in range(max(good - 2, 0), good + 1)]
    first = found[0][0] if good == 0 else seen(0, np.zeros(1))[0][0]
    # twice the step: a fold is approached like a square root, so a straight line comes late
    low, high = 0.0, 2 * length
    for count in (2 * SAMPLES - 1, FINER, FINER):  # a line that begins near one crosses it steeply
        looks = np.linspace(low, high, count)
        ahead = seen(good, looks[1:])
        found += ahead
        least = 1 + ahead.index(min(ahead, key=lambda one: one[:2]))
        low, high = looks[least - 1], looks[min(least + 1, count - 1)]
    smallest, time, place = min(found, key=lambda one: one[:2])
    return (time, smallest, place) if smallest < NEAR * first else None


def _last_good(function: ca.Function, steps: Steps, times, n: int, k: int, p) -> int:
    """Number of the last state whose constraints hold."""
    for begin in range(0, times.size, AT_ONCE):
        t = times[begin : begin + AT_ONCE]
        x = steps.x[: n + k, begin : begin + t.size]
        violation = function.map(t.size)(t, x[:n], x[n:], np.tile(p[:, None], t.size))[0]
        lost = ~(np.abs(violation.full()).max(axis=0) < LOST)
        if lost.any():
            return max(begin + int(np.argmax(lost)) - 1, 0)
    return int(times.size) - 1
