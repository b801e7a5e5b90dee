"""Initial positions of a mechanism for many sets of parameters at once.

The square system of the start is solved by Newton's method for all sets, with one compiled step,
and by continuation from the nominal position if that fails, as ``continued`` and ``newton.solve``
do for a single set.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.model.assembly.assembly import ROUNDING
from dalembert.model.assembly.closure import Closure
from dalembert.model.assembly.continuation import FOLLOWED, SHORTEST
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.newton import TINY, relative
from dalembert.symbolic.once import once

Evaluate = Callable[..., list[np.ndarray]]
"""``(function, arguments …) → results``, with one row per set."""


class ManyStarts:
    """Assembled positions of a mechanism.

    Parameters
    ----------
    closure : Closure, with a regular start
    evaluate : evaluates compiled functions
    """

    def __init__(self, closure: Closure, evaluate: Evaluate):
        self.closure, self.evaluate = closure, evaluate

    def positions(self, p: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions on the branch of the nominal one.

        Parameters
        ----------
        p : (sets, np) parameters
        time : [s]

        Returns
        -------
        y : (sets, n) positions, or the last ones of Newton's method without convergence
        reached : (sets,) share of the path at which it failed; 1 otherwise
        found : (sets,) whether a position was found
        """
        count = len(p)
        first, anchor = self.closure.anchor
        y = np.tile(anchor, (count, 1))
        reached, step = np.zeros(count), np.ones(count)
        lost = np.zeros(count, dtype=bool)
        shortest = SHORTEST / (1.0 + abs(time) / self.closure.scales.time)
        while (going := np.flatnonzero((reached < 1.0) & ~lost)).size:
            target = np.minimum(1.0, reached[going] + step[going])
            here = first + target[:, None] * (p[going] - first)
            roots, accepted = self._solve(target * time, y[going], here)
            good, bad = going[accepted], going[~accepted]
            y[good], reached[good] = roots[accepted], target[accepted]
            step[good] *= 2
            step[bad] /= 2
            lost[bad] = step[bad] < shortest
            y[bad[lost[bad]]] = roots[~accepted][lost[bad]]
            reached[bad[lost[bad]]] = target[~accepted][lost[bad]]
        return y, reached, ~lost

    def gaps(self, t: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Index of the most violated equation, by natural sizes, and its violation.

        The index is −1 if there are only initial conditions.
        """
        _, value, _ = self._evaluate(np.full(len(y), t), y, p)
        rows = self.closure.pinned.rows
        joints = rows < len(self.closure.owners)
        if not joints.any():
            return np.full(len(y), -1), np.abs(value).max(axis=1, initial=0.0)
        open_by = np.abs(value[:, : rows.size][:, joints])
        scales = self.closure.scales.rows[rows[joints]]
        worst = np.argmax(np.nan_to_num(open_by / scales, nan=np.inf), axis=1)
        return rows[joints][worst], open_by[np.arange(len(y)), worst]

    def _evaluate(self, t: np.ndarray, y: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Position after Newton's step, residuals, and their thresholds."""
        return self.evaluate(start_step(self.closure), t[:, None], y, p)

    def _solve(self, t: np.ndarray, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Roots near positions by full steps, and whether they are accepted."""
        s = FOLLOWED
        here, best = y.copy(), y.copy()
        following, value, zero = self._evaluate(t, here, p)
        size = _size(value, zero)
        least = size.copy()
        ended = ~np.isfinite(size) | (size <= 1)
        for _ in range(s.max_iterations):
            if not (going := np.flatnonzero(~ended)).size:
                break
            there = following[going]
            new_following, new_value, new_zero = self._evaluate(t[going], there, p[going])
            new, old = _size(new_value, new_zero), size[going]
            nearer = _norm(new_value, zero[going]) < _norm(value[going], zero[going])
            near = old <= s.slack
            accepted = nearer | (~near & np.isfinite(new))
            at = going[accepted]
            here[at], size[at] = there[accepted], new[accepted]
            following[at], value[at] = new_following[accepted], new_value[accepted]
            zero[at] = new_zero[accepted]
            better = at[size[at] <= least[at]]
            best[better], least[better] = here[better], size[better]
            slow = nearer & near & (new > 1) & (new > old / 2)
            grown = ~nearer & (new > s.growth * least[going])
            ended[going] = slow | ~accepted | grown | (new <= 1)
        converged = size <= 1
        return np.where(converged[:, None], here, best), converged | (least <= s.slack)


@once
def start_step(closure: Closure) -> ca.Function:
    """``(t, y, p) → y ⊕ δ, r, zero`` with ``δ`` of Newton's step."""
    pinned = closure.pinned
    assembler, recipe, e = pinned.assembler, pinned.recipe, pinned.recipe.equations
    conditions = [recipe.position_conditions] if recipe.position_conditions.numel() else []
    residual = ca.vertcat(e.constraints, *conditions)[pinned.rows.tolist(), :]
    rows = ca.vertcat(residual, recipe.pinned)
    jacobian = ca.vertcat(
        ca.vertcat(e.position_jacobian, *map(e.by_displacement, conditions))[
            pinned.rows.tolist(), :
        ],
        e.by_displacement(recipe.pinned),
    )
    scales = closure.scales
    fixed_sizes = scales.displacements[list(recipe.positions.indices)]
    constraint_rows = pinned.rows[pinned.rows < scales.rows.size]
    condition_count = pinned.rows.size - constraint_rows.size
    natural = np.concatenate(
        [scales.rows[constraint_rows], np.full(condition_count, scales.length), fixed_sizes]
    )
    size = ca.SX(natural)
    for k in range(constraint_rows.size, pinned.rows.size):  # conditions: the size of their terms
        along = ca.mtimes(ca.fabs(jacobian[k, :]), ca.SX(scales.displacements))
        size[k] = ca.if_else(along > 0, along, 1.0)
    far = ca.mtimes(ca.fabs(e.lift).T, ca.fabs(e.y))
    zero = FOLLOWED.tolerance * size + ROUNDING * ca.mtimes(ca.fabs(jacobian), far)
    delta = -QrFactor(jacobian, natural, scales.displacements).solve(rows)
    shares = ca.SX(assembler.longest) / ca.fmax(ca.fabs(delta), TINY)
    limited = [shares[int(k)] for k in np.flatnonzero(np.isfinite(assembler.longest))]
    shortened = ca.mmin(ca.vertcat(1.0, *limited))
    there = e.manifold.retract(e.y, delta * shortened)
    outputs = [ca.densify(x) for x in (there, rows, zero)]
    return ca.Function("start_step", [e.t, e.y, e.p], outputs, {"cse": True})


def _size(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    """(sets,) largest residual, relative to its threshold."""
    with np.errstate(all="ignore"):
        return np.max(relative(value, zero), axis=1, initial=0.0)


def _norm(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return np.linalg.norm(relative(value, zero), axis=1)
