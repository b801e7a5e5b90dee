"""What gradients save: analyses until the same optimum of one mechanism with twenty parameters."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from benchmarks.design_methods import N, arm


def task(model: da.Model) -> dict:
    last = f"link{N - 1}.end"
    bend = " + ".join(f"(a{k} - a{k - 1})**2" for k in range(1, N))
    size = " + ".join(f"l{k}" for k in range(N))
    return {
        "minimize": da.final(f"{bend} + 0.1*({size})", name="bend and size"),
        "subject_to": [
            da.Limit(da.final(f"{last}.x", name="x"), 1.2, 1.2),
            da.Limit(da.final(f"{last}.y", name="y"), 0.9, 0.9),
        ],
        "analysis": da.Kinematics(t_span=(0.0, 1e-3), outputs=2),
    }


@pytest.fixture
def counted(monkeypatch) -> list[int]:
    """Number of analyses, whoever asks for them."""
    count = [0]
    honest = {name: getattr(da.Kinematics, name) for name in ("run", "replay")}

    def counting(name: str):
        def called(self, *arguments, **options):
            count[0] += 1
            return honest[name](self, *arguments, **options)

        return called

    for name in honest:
        monkeypatch.setattr(da.Kinematics, name, counting(name))
    return count


@pytest.mark.thorough
def test_ten_times_fewer_analyses_than_with_differences(counted):
    model = arm()
    exact = da.optimize(model, **task(model))
    with_gradients, counted[0] = counted[0], 0
    differences = da.optimize(model, **task(model), gradient="finite-difference")
    assert exact.success, exact.message
    assert exact.fun == pytest.approx(differences.fun, rel=1e-5)
    np.testing.assert_allclose(list(exact.x.values()), list(differences.x.values()), atol=2e-3)
    assert counted[0] >= 10 * with_gradients, (counted[0], with_gradients)
