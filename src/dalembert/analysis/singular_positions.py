"""Singular positions of the constraints: the joints involved, and detection after a failed run."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.driver import Driver
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model

NEAR = 0.02
"""Smallest singular value of ``C``, relative to that at the start, that counts as near zero."""
AT_ONCE = 2000
"""Number of states evaluated at once."""
LOST = 1e-6
"""Threshold of constraint violation, by natural size, above which a state is meaningless and a
corrected run has failed."""
SAMPLES, FINER = 200, 21
SHARE = 0.1
"""Threshold of the share in the vanishing combination of equations above which a joint is named."""


class SingularPosition:
    """A position in or near which a combination of the constraint equations vanishes, ``cᵀC = 0``.

    Parameters
    ----------
    model : Model
    time, y : instant and position
    p : (np,) parameters
    """

    def __init__(self, model: Model, time: float, y: np.ndarray, p: np.ndarray):
        self.model, self.time, self.y, self.p = model, time, y, p

    @cached_property
    def _scaled_jacobian(self) -> np.ndarray:
        """``C`` with coordinates and equations scaled by their natural sizes."""
        e = self.model.equations
        jacobian = ca.Function("C", [e.t, e.y, e.p], [e.jacobian])(self.time, self.y, self.p)
        return np.asarray(jacobian.full() * e.scales.displacements / e.scales.rows[:, None])

    @cached_property
    def _owners(self) -> list:
        """Constraints involved in the vanishing combination."""
        if not self._scaled_jacobian.size or not np.all(np.isfinite(self._scaled_jacobian)):
            return []
        shares = np.abs(np.linalg.svd(self._scaled_jacobian)[0][:, -1])
        return self._owners_of(np.flatnonzero(shares > SHARE * shares.max()))

    def _owners_of(self, numbers: Iterable[int]) -> list:
        owners, rows = self.model.closure.owners, self.model.closure.rows
        return list(dict.fromkeys(owners[rows[k]][0] for k in numbers))

    @property
    def joints(self) -> str:
        """Names of the joints whose equations become dependent."""
        names = [c.name for c in self._owners if not isinstance(c, Driver)]
        return ", ".join(names) or "the constraints"

    @property
    def stretched(self) -> str:
        """Names of the joints of the locked group, where drivers determine all motion.

        All joints up to the driver carry the vanishing combination. The locked part is one Assur
        group: the singular block of ``C`` in block triangular form (Dulmage and Mendelsohn) by
        whole bodies.
        """
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

        sparsity = self.model.equations.jacobian.sparsity()
        rows, columns = sparsity.size()
        if rows != columns or not self._owners:
            return self.joints
        pattern = csr_array((np.ones(sparsity.nnz()), sparsity.get_triplet()), (rows, columns))
        matching = maximum_bipartite_matching(pattern, perm_type="column")
        if np.any(matching < 0):
            return self.joints
        owners = np.array(self.model.guesses.owners)[matching]
        same_body = csr_array(owners[:, None] == owners)
        adjacency = pattern[:, matching] + same_body
        count, block = connected_components(adjacency, connection="strong")
        groups = [np.flatnonzero(block == k) for k in range(count)]
        smallest = [
            np.linalg.svd(self._scaled_jacobian[np.ix_(group, matching[group])])[1][-1]
            for group in groups
        ]
        locked = self._owners_of(groups[int(np.argmin(smallest))])
        return ", ".join(c.name for c in locked if not isinstance(c, Driver)) or self.joints

    @property
    def drivers(self) -> str:
        """Values of the drivers, ``", driver 'motor' at crank.angle = 2.0944 rad (120°)"``."""
        drivers = [c for c in self.model.constraints if isinstance(c, Driver)]
        involved = [c for c in drivers if c in self._owners] or drivers
        return "".join(f", {self._value(driver)}" for driver in involved)

    def _value(self, driver: Driver) -> str:
        e = self.model.equations
        law = ca.Function("law", [e.t, e.p], [driver.law.value(e.t)])
        value = float(law(self.time, self.p))
        unit = driver.units()[0]
        degrees = f" ({np.degrees(value):.4g}°)" if unit == "rad" else ""
        return f"driver {driver.name!r} at {driver.measured} = {value:.5g} {unit}{degrees}"


def near_singular_position(
    e: Equations, steps: Steps, p: np.ndarray, lost_at: float, following: float
) -> tuple[float, float, np.ndarray] | None:
    """Time, smallest singular value of ``C`` and position where a run lost its constraints.

    The search covers two steps before and after the last valid state, the latter along the straight
    line of its speeds; None where ``C`` keeps its rank. Entries of ``C`` are scaled by the natural
    sizes of coordinates and equations.

    Parameters
    ----------
    e : Equations as integrated
    steps : accepted steps, ``x = [y; v; …]``
    p : (np,) parameters
    lost_at : time of the first output that violates the constraints
    following : length of the next step
    """
    if not e.constraint_count or not np.all(np.isfinite(steps.x[:, 0])):
        return None
    scales = e.scales
    scaled = ca.mtimes([ca.diag(1 / scales.rows), e.jacobian, ca.diag(scales.displacements)])
    outputs = [e.constraints / scales.rows, ca.densify(scaled), e.pose_rate]
    if e.switches.count:  # with the signs at the state
        outputs = ca.substitute(outputs, [e.switches.sides], [e.switches.actual])
    function = ca.Function("constraints", [e.t, e.y, e.v, e.p], outputs)
    n, k = e.coordinate_count, e.speed_count
    times = np.append(steps.t[: steps.count], steps.end)

    def samples(j: int, after: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Smallest singular values at times ``after`` the start of step ``j``; time, position."""
        y, v, count = steps.x[:n, j], steps.x[n : n + k, j], after.size
        moved = y[:, None] + function(times[j], y, v, p)[2].full() * after
        tiled = (np.tile(column[:, None], count) for column in (v, p))
        jacobians = function.map(count)(times[j] + after, moved, *tiled)[1].full()
        jacobians = jacobians.reshape(jacobians.shape[0], count, -1).transpose(1, 0, 2)
        finite, smallest = np.isfinite(jacobians).all(axis=(1, 2)), np.full(count, np.inf)
        if finite.any():
            smallest[finite] = np.linalg.svd(jacobians[finite], compute_uv=False)[:, -1]
        return list(zip(smallest.tolist(), (times[j] + after).tolist(), moved.T, strict=True))

    last_before = int(np.searchsorted(times, lost_at)) - 1
    last_valid = max(min(_last_valid(function, steps, times, n, k, p), last_before), 0)
    length = steps.h[min(last_valid, steps.count - 1)] if steps.count else following
    candidates = [samples(j, np.zeros(1))[0] for j in range(max(last_valid - 2, 0), last_valid + 1)]
    first = candidates[0][0] if last_valid == 0 else samples(0, np.zeros(1))[0][0]
    # twice the step: a fold is approached like a square root, so a straight line comes late
    lower, upper = 0.0, 2 * length
    for count in (2 * SAMPLES - 1, FINER, FINER):  # a line that begins near one crosses it steeply
        grid = np.linspace(lower, upper, count)
        samples_ahead = samples(last_valid, grid[1:])
        candidates += samples_ahead
        lowest = 1 + samples_ahead.index(min(samples_ahead, key=lambda sample: sample[:2]))
        lower, upper = grid[lowest - 1], grid[min(lowest + 1, count - 1)]
    smallest, time, position = min(candidates, key=lambda sample: sample[:2])
    return (time, smallest, position) if smallest < NEAR * first else None


def _last_valid(function: ca.Function, steps: Steps, times, n: int, k: int, p) -> int:
    """Index of the last state that satisfies the constraints."""
    for begin in range(0, times.size, AT_ONCE):
        t = times[begin : begin + AT_ONCE]
        x = steps.x[: n + k, begin : begin + t.size]
        violation = function.map(t.size)(t, x[:n], x[n:], np.tile(p[:, None], t.size))[0]
        lost = ~(np.abs(violation.full()).max(axis=0) < LOST)
        if lost.any():
            return max(begin + int(np.argmax(lost)) - 1, 0)
    return int(times.size) - 1
