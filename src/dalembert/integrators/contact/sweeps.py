"""Projected Gauss–Seidel sweeps with Anderson acceleration, in machine code.

A sweep visits all contacts: ``P_N ← max(minimum, P_N − u_N/H_NN)``, then ``P_j ← P_j − ρ u_j`` of
each tangential group, shortened to ``μ_j P_N``; the speeds of the bodies follow at once (Jourdan,
Alart & Jean, Comput. Methods Appl. Mech. Eng. 155, 1998). With the changes ``f`` of the last
sweeps, the next one begins from ``P − Σ γ_i ΔP_i``, where ``γ`` minimises ``|f − Σ γ_i Δf_i|``
(Anderson 1965; Walker & Ni, SIAM J. Numer. Anal. 49, 2011).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.machine_code import Loop, machine_code
from dalembert.integrators.contact.newton_arrays import problem_inputs
from dalembert.integrators.contact.other_places import SweepCounts, SweepOutputs, SweepSettings
from dalembert.integrators.contact.places import Inputs
from dalembert.symbolic.native.toolchain import Call

DEPTH, GROWTH, REGULARIZATION = 10, 4.0, 1e-12
"""Stored sweeps; growth of the squared changes after which they are forgotten; regularisation of
the least-squares problem relative to its diagonal [-]."""
SWEEPS = 300
"""Upper limit of sweeps before Newton's method takes over."""


def swept(
    problem: FrictionProblem, impulses: np.ndarray, tolerance: float, limit: int = SWEEPS
) -> np.ndarray:
    """Impulses after sweeps; the same ones where no machine code is available.

    Parameters
    ----------
    problem : FrictionProblem
    impulses : (n, k) initial guess
    tolerance : change of the speed of a contact at which the sweeps end [m/s]
    limit : upper limit of sweeps
    """
    operator, code = problem.matrix, machine_code("sweep.c", "sweeps.c")
    if code is None or not isinstance(operator, Delassus) or not problem.shape[0]:
        return impulses
    if operator.is_dense:
        idle = _idle(problem.shape, problem.groups)
        sweeps = idle.pop() if idle else DenseSweeps(code, problem)
        result = sweeps(problem, operator, impulses, tolerance, limit)
        idle.append(sweeps)
    else:
        result, speeds = np.array(impulses), operator.directions.shape[1]
        inputs = problem_inputs(problem, operator)
        inputs[Inputs.SETTINGS] = SweepSettings.numbers(_settings(tolerance))
        arrays = Inputs.arranged(inputs), _outputs(result, operator.response(result.ravel()))
        sizes = _counts(problem, limit, speeds), _work(problem, speeds)
        Loop(code, *arrays, *sizes)()
    return result if np.isfinite(result).all() else impulses


def _counts(problem: FrictionProblem, limit: int, speeds: int) -> list[int]:
    """Integers of the loop."""
    contacts, components = problem.shape
    counts = {
        SweepCounts.CONTACTS: contacts,
        SweepCounts.COMPONENTS: components,
        SweepCounts.GROUPS: len(problem.groups),
        SweepCounts.MAX_SWEEPS: limit,
        SweepCounts.SPEEDS: speeds,
        SweepCounts.DEPTH: DEPTH,
    }
    return SweepCounts.listed(counts)


def _settings(tolerance: float) -> dict[int, float]:
    """Settings of the loop."""
    return {
        SweepSettings.TOLERANCE: tolerance,
        SweepSettings.GROWTH: GROWTH,
        SweepSettings.REGULARIZATION: REGULARIZATION,
    }


def _outputs(impulses: np.ndarray, speeds: np.ndarray) -> list[np.ndarray]:
    """Outputs of the loop."""
    return SweepOutputs.arranged({SweepOutputs.IMPULSE: impulses, SweepOutputs.SPEEDS: speeds})


def _work(problem: FrictionProblem, speeds: int) -> int:
    """Size of the memory of the loop."""
    rows, own = problem.velocity.size, problem.shape[1] + DEPTH * (1 + 2 * DEPTH)
    return own + (3 + 2 * DEPTH) * rows + (1 + DEPTH) * speeds


class DenseSweeps:
    """Sweeps with the matrix ``H`` itself, on arrays that remain in place from call to call.

    The velocities of the contacts take the place of the speeds of the bodies, so that directions
    are unit vectors.

    Parameters
    ----------
    code : machine code
    problem : with as many contacts as those of the calls
    """

    def __init__(self, code: Call, problem: FrictionProblem):
        rows, (count, _) = problem.velocity.size, problem.shape
        self._impulses, self._speeds = np.zeros(problem.shape), np.zeros(rows)
        self._responses = np.zeros((rows, rows))
        self._settings = SweepSettings.numbers(_settings(0.0))
        vectors = [np.zeros(problem.shape) for _ in range(4)]
        self._velocity, self._mobility, self._weights, self._shift = vectors
        self._friction, self._minimum = np.zeros((count, len(problem.groups))), np.zeros(count)
        number = np.arange(rows, dtype=np.int32)
        starts = np.arange(rows + 1, dtype=np.int32)
        inputs = {
            Inputs.DIRECTIONS: np.ones(rows),
            Inputs.RESPONSES: self._responses,
            Inputs.VELOCITY: self._velocity,
            Inputs.FRICTION: self._friction,
            Inputs.MINIMUM: self._minimum,
            Inputs.MOBILITY: self._mobility,
            Inputs.WEIGHTS: self._weights,
            Inputs.SHIFT: self._shift,
            Inputs.SETTINGS: self._settings,
            Inputs.DIRECTION_ROWS: starts,
            Inputs.DIRECTION_COLUMNS: number,
            Inputs.RESPONSE_ROWS: rows * starts,
            Inputs.RESPONSE_COLUMNS: np.tile(number, rows),
            Inputs.GROUP_STARTS: problem.starts.astype(np.int32),
        }
        arrays = Inputs.arranged(inputs), _outputs(self._impulses, self._speeds)
        sizes = _counts(problem, SWEEPS, rows), _work(problem, rows)
        self._loop = Loop(code, *arrays, *sizes)

    def __call__(
        self,
        problem: FrictionProblem,
        operator: Delassus,
        impulses: np.ndarray,
        tolerance: float,
        limit: int,
    ) -> np.ndarray:
        """Impulses after sweeps, arguments as of ``swept``."""
        self._responses[:], self._velocity[:] = operator.product.T, problem.velocity
        self._friction[:], self._minimum[:] = problem.friction, problem.minimum
        self._mobility[:], self._weights[:] = problem.mobility, problem.weights
        self._shift[:] = operator.shift.reshape(problem.shape)
        self._settings[SweepSettings.TOLERANCE] = tolerance
        self._impulses[:], self._speeds[:] = impulses, operator.product @ impulses.ravel()
        self._loop.counts[SweepCounts.MAX_SWEEPS] = limit
        self._loop()
        return self._impulses.copy()


@lru_cache(maxsize=256)
def _idle(shape: tuple[int, int], groups: tuple[int, ...]) -> list[DenseSweeps]:
    """Sweeps over contacts of some number and components that no call uses."""
    return []
