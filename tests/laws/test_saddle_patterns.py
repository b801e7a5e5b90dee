"""Law of saddle-point matrices by stored places: those of blocks, for all kinds of matrices."""

import casadi as ca
import numpy as np
import pytest
import scipy

from dalembert.analysis.nonsmooth.mobility import Coupling
from dalembert.analysis.nonsmooth.saddle import saddle


def sparsity(pattern: np.ndarray) -> ca.Sparsity:
    return ca.sparsify(ca.DM(pattern.astype(float))).sparsity()


@pytest.mark.parametrize("kinds", [(1, 1), (1, 0), (0, 1), (0, 0)])
def test_matrices_of_coupled_speeds(kinds):
    rng, n, free, m = np.random.default_rng(3), 12, 3, 4
    coupled = slice(0, n - free)
    inertia, joints = np.zeros((n, n)), np.zeros((m, n))
    inertia[coupled, coupled] = rng.random((n - free, n - free)) < 0.3
    inertia += inertia.T + np.eye(n)
    joints[:, coupled] = rng.random((m, n - free)) < 0.6
    inertia, joints = inertia > 0, joints > 0
    coupling = Coupling.of(sparsity(inertia), sparsity(joints))
    speeds = coupling.coupled
    for k in range(3):  # the second matrix has fewer entries
        matrix = rng.normal(size=(n, n)) * (inertia if k != 1 else np.eye(n))
        rows = rng.normal(size=(m, n)) * joints
        parts = [
            scipy.sparse.csr_array(part) if kind else part
            for part, kind in zip((matrix, rows), kinds, strict=True)
        ]
        whole = coupling.saddle(*parts)
        if any(kinds):
            assert len(coupling.patterns) == (1, 2 if kinds[0] else 1, 2 if kinds[0] else 1)[k]
            whole = whole.toarray()
        expected = saddle(matrix[np.ix_(speeds, speeds)], rows[:, speeds])
        np.testing.assert_array_equal(whole, expected)
