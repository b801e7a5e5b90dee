"""Stage equations of implicit methods: unknowns, residuals, scales and first guess."""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.symbolic.equations.semi_explicit import SemiExplicit
from dalembert.symbolic.evaluation.kernel import condensed

ROUNDING = 16 * float(np.finfo(float).eps)
SIZE_FLOOR = 1e-9
"""Lower limit of the magnitude of an unknown or a state, relative to its natural size [-]."""
SMALL_ROWS = 1e-2
"""Lower limit of the scale of a row, relative to that of the largest row [-]."""


class StageEquations:
    """Differential-algebraic system with a minimal set of unknowns.

    The unknowns are ``u = [ẑ; k]``: algebraic variables ``ẑ = z / h^lag`` and the rates ``k`` of
    states whose rates depend on each other (``ẏ = A(y) v``). All other states follow explicitly,
    level by level: speeds from accelerations, positions from speeds, then work.

    Attributes
    ----------
    coupled : indices of the states with unknown rates
    levels : indices of the other states, in the order in which they follow
    count : number of unknowns
    """

    def __init__(self, system: SemiExplicit):
        self.system = system
        self.size, self.algebraic = system.x.numel(), system.z.numel()
        self.coupled, self.levels = _order(system)
        self.count = self.algebraic + len(self.coupled)
        s = system
        self.h, self.u = ca.SX.sym("h"), ca.SX.sym("u", self.count)
        lag = ca.vertcat(*(self.h**k for k in s.lag)) if any(s.lag) else 1
        scaled = lag * self.u[: self.algebraic, :]  # a slice of a scalar alone would be a row
        rate, algebraic = ca.substitute([s.rate, s.algebraic], [s.z], [scaled])
        rows = ca.vertcat(algebraic, self.u[self.algebraic :, :] - rate[self.coupled])
        inputs = [s.t, self.h, s.x, self.u, s.p]
        self.rate = ca.Function("rate", inputs, [ca.densify(rate)])
        self.rows = ca.Function("rows", inputs, [ca.densify(rows)])
        self._rate, self._rows = rate, rows
        self._lag = lag

    def stage_by_stage(self, u: ca.SX, stages: int) -> list[ca.SX]:
        """Unknowns split by stage; possibly empty."""
        return [u[k * self.count : (k + 1) * self.count, :] for k in range(stages)]

    @property
    def unknown_sizes(self) -> np.ndarray:
        """(count,) natural sizes of ``u``."""
        sizes = self.system.sizes
        scaled = sizes.algebraic / sizes.time ** np.array(self.system.lag)
        return np.concatenate([scaled, sizes.rates[self.coupled]])

    @property
    def row_sizes(self) -> np.ndarray:
        """(count,) natural sizes of the equations."""
        sizes = self.system.sizes
        return np.concatenate([sizes.rows, sizes.rates[self.coupled]])

    def residual_scale(self, tolerance: float) -> ca.Function:
        """``(t, h, x, u, p)`` → threshold below which each residual counts as zero.

        The terms of a dynamic equation are the magnitudes in ``|∂G/∂u| |u|`` and its value without
        ``u``; those of a constraint are its change within the step, ``h |∂G/∂x| |F|``. Rounding of
        the states adds ``|∂G/∂x| |x|``; for forces linear in u it is the rounding of the forces.
        """
        s, level = self.system, np.array([*self.system.depth, *(0 for _ in self.coupled)])
        by_unknown = ca.fabs(ca.jacobian(self._rows, self.u))
        at_zero = ca.substitute(self._rows, self.u, ca.SX.zeros(self.count))
        by_state = ca.fabs(ca.jacobian(at_zero, s.x))
        sizes = s.sizes
        floor, row_sizes = SIZE_FLOOR * self.unknown_sizes, self.row_sizes
        terms = ca.densify(ca.mtimes(by_unknown, floor + ca.fabs(self.u)) + ca.fabs(at_zero))
        change = self.h * ca.mtimes(by_state, ca.fabs(self._rate))
        constraints = [int(i) for i in np.flatnonzero(level)]
        terms[constraints, :] = change[constraints, :]
        noise = ca.densify(ca.mtimes(by_state, SIZE_FLOOR * sizes.states + ca.fabs(s.x)))
        scale = ca.SX.zeros(terms.numel())
        for depth in np.unique(level):
            rows = [int(i) for i in np.flatnonzero(level == depth)]
            for weight, part in ((tolerance, terms[rows]), (ROUNDING, noise[rows])):
                natural = row_sizes[rows]
                scale[rows] += weight * (part + SMALL_ROWS * natural * ca.mmax(part / natural))
        return ca.Function("row_scale", [s.t, self.h, s.x, self.u, s.p], [scale])

    def begin(self) -> ca.Function:
        """``(t, h, x, p) → u, ẋ`` with the accelerations at the state itself.

        Only ẋ is differentiated: u is a first guess.
        """
        s = self.system
        z = s.start.function(s.t, s.x, s.p)
        rate = ca.substitute(s.rate, s.z, z)
        guess = ca.vertcat(z / self._lag, rate[self.coupled])
        return condensed(
            "begin",
            [s.t, self.h, s.x, s.p],
            [ca.densify(guess), ca.densify(rate)],
            options={"never_inline": True, "is_diff_out": [False, True]},
        )


def _order(system: SemiExplicit) -> tuple[list[int], list[list[int]]]:
    """States with mutually dependent rates, and the levels of all other states."""
    sparsity = ca.jacobian_sparsity(system.rate, system.x)
    entries = np.ones(sparsity.nnz()), sparsity.row(), sparsity.colind()
    graph = scipy.sparse.csc_matrix(entries, sparsity.shape).tocsr()
    _, label = scipy.sparse.csgraph.connected_components(graph, directed=True, connection="strong")
    coupled = np.bincount(label)[label] > 1
    cyclic = coupled | (graph.diagonal() > 0)
    done, levels = cyclic.copy(), []
    while not done.all():
        # the remaining graph is acyclic, so some state depends on finished states only
        ready = ~done & (graph @ ~done == 0)
        levels.append([int(i) for i in np.flatnonzero(ready)])
        done |= ready
    return [int(i) for i in np.flatnonzero(cyclic)], levels
