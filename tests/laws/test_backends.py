"""Steps of elements of many kinds are the same on every backend, but for rounding."""

import numpy as np
import pytest
from registry import model_of

import dalembert as da
from dalembert.symbolic.native import c_compiler, llvm

ROUNDING = 1e-11
"""Relative, of twenty steps; adding up in another order is all that may differ."""
needs_compiler = pytest.mark.skipif(
    c_compiler.find_compiler() is None, reason="no C compiler on this machine"
)
KINDS = (
    "internal gears on an arm",
    "rotational driver Table of formulas",
    "plane frame",
    "friction in slot",
    "contact",
    "cable",
    "universal",
    "link of two hinges askew",
    "spatial coupling",
)
"""Among them splines, switches, square roots, inner solutions, Euler parameters."""
RUNS = [("jit", name) for name in KINDS] + [
    pytest.param("c", name, marks=needs_compiler) for name in ("contact", "universal")
]


@pytest.fixture(autouse=True)
def quickly(tmp_path, monkeypatch):
    """Compiled anew, and quickly."""
    monkeypatch.setenv("DALEMBERT_CACHE", str(tmp_path))
    monkeypatch.setattr(c_compiler, "OPTIMISED", "-O0")


@pytest.mark.few(1)
@pytest.mark.parametrize(("backend", "name"), RUNS)
def test_steps_are_the_same_on_every_backend(backend, name):
    options = {"step": 1e-3, "outputs": 3}
    expected, computed = (
        da.solve_dynamics(model_of(name), 0.02, backend=b, **options) for b in ("vm", backend)
    )
    assert computed.statistics["backend"] == {"jit": llvm.Llvm.name, "c": "C"}[backend]
    for field in ("y", "v", "a", "multiplier", "work"):
        wanted = getattr(expected.trajectory, field)
        size = max(1.0, float(np.abs(wanted).max(initial=0.0)))
        np.testing.assert_allclose(
            getattr(computed.trajectory, field), wanted, rtol=0, atol=ROUNDING * size
        )
