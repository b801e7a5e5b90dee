"""Projective elimination: each basis spans what the constraints permit, and switches in time."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from registry import RELATED, definite, model_of
from thorough import crossed

import dalembert as da
from dalembert.formulations.null_space import LARGEST_SVD
from dalembert.formulations.partition import largest_volume
from dalembert.symbolic.equations.factor import NullSpaceBasis

BASES = ("partitioning", "qr", "gram-schmidt", "svd")
ORTHONORMAL = ("qr", "gram-schmidt", "svd")


def evaluated(model, expressions) -> list[np.ndarray]:
    """Expressions of t, y, p at the start."""
    e = model.equations
    function = ca.Function("f", [e.t, e.y, e.p], [ca.densify(x) for x in expressions])
    return [x.full() for x in function.call([0.0, model.start.y, model.nominal])]


def basis_of(name: str, basis: str) -> NullSpaceBasis:
    model = model_of(name)
    e = model.equations
    return definite(da.NullSpace(basis), model).solver(e.inertia, e.jacobian, e.massless).basis


@pytest.mark.few(13)
@pytest.mark.parametrize(("name", "basis"), crossed(RELATED, BASES))
def test_basis(name, basis):
    """C D = 0, C x₂ = r₂, Cᵀ z = w, and D of full rank."""
    model, rng = model_of(name), np.random.default_rng(3)
    if basis == "svd" and model.equations.speed_count > LARGEST_SVD:
        pytest.skip("too many speeds for this basis")
    computed, c = basis_of(name, basis), model.equations.jacobian
    m, n = c.shape
    rhs, force = ca.SX(rng.standard_normal((m, 2))), ca.mtimes(c.T, ca.SX(np.arange(1.0, m + 1)))
    jacobian, d, x, z = evaluated(
        model, [c, computed.matrix, computed.particular(rhs), computed.multipliers(force)]
    )
    size = np.abs(jacobian).max()
    assert d.shape == (n, n - m)
    np.testing.assert_allclose(jacobian @ d, 0, atol=1e-13 * size * max(1, np.abs(d).max()))
    np.testing.assert_allclose(jacobian @ x, evaluated(model, [rhs])[0], atol=1e-12)
    np.testing.assert_allclose(z.ravel(), np.arange(1.0, m + 1), atol=1e-11)
    if basis in ORTHONORMAL:
        np.testing.assert_allclose(d.T @ d, np.eye(n - m), atol=1e-13)
    else:
        assert np.linalg.matrix_rank(d) == n - m


def test_largest_volume_bounds_all_coefficients():
    """No other row exceeds the chosen ones, for matrices in which a greedy choice fails too."""
    rng = np.random.default_rng(0)
    for n, k in [(9, 1), (12, 5), (30, 11)]:
        for _ in range(20):
            rows = np.linalg.qr(rng.standard_normal((n, k)) * rng.uniform(0.01, 1, (n, 1)))[0]
            chosen = list(largest_volume(rows))
            assert np.abs(rows @ np.linalg.inv(rows[chosen])).max() <= 1.01


def bars(count: int) -> da.Model:
    """A hanging chain."""
    system = da.System("chain", gravity=(0.0, -9.81))
    end = system.ground.point(0, 0)
    for k in range(count):
        bar = system.add(da.planar.Bar(f"bar{k}", length=0.4, mass=1.0, angle=-0.5 - 0.3 * k))
        system.add(da.planar.Revolute(f"pin{k}", end, bar.start))
        end = bar.end
    return system.build()


def test_singular_values_of_many_speeds_are_refused():
    count = LARGEST_SVD // 3 + 1
    with pytest.raises(da.UnsupportedError, match=rf"{3 * count} speeds.*basis='qr'"):
        da.solve_dynamics(bars(count), 0.1, formulation=da.NullSpace("svd"))


@pytest.mark.few(1)
@pytest.mark.parametrize("basis", BASES)
def test_runs_agree_with_range_space(basis):
    model = bars(2)
    expected = da.solve_dynamics(model, 0.5, step=0.005)
    motion = da.solve_dynamics(model, 0.5, step=0.005, formulation=da.NullSpace(basis))
    assert motion.status.success
    np.testing.assert_allclose(motion.trajectory.y, expected.trajectory.y, atol=1e-10)
    np.testing.assert_allclose(
        motion.trajectory.multiplier, expected.trajectory.multiplier, atol=1e-7
    )


def massless_rod() -> da.Model:
    """A slider-crank whose rod weighs nothing: three speeds without mass."""
    system = da.System("massless rod", gravity=(0.0, -9.81))
    crank = system.add(
        da.planar.Bar("crank", length=0.2, mass=0.4, angle=0.3, angular_velocity=9.0)
    )
    rod = system.add(da.planar.Bar("rod", length=0.5, mass=0.0, angle=-0.1))
    slider = system.add(da.planar.Body("slider", mass=3.0, inertia=0.01, angle=0.0))
    system.add(da.planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(da.planar.Revolute("A", crank.end, rod.start))
    system.add(da.planar.Revolute("B", rod.end, slider.center))
    system.add(da.planar.Prismatic("C", system.ground.point(0, 0), slider.center))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "formulation", [*map(da.NullSpace, BASES), da.VelocityPartitioning()], ids=str
)
def test_massless_body(formulation):
    """v̇ and λ as the saddle system has them, though M is singular."""
    model = massless_rod()
    e = model.equations
    assert len(e.massless) == 3
    state = (0.0, np.concatenate([model.start.y, model.start.v, [0, 0]]), model.nominal)
    (a, force), (a_kkt, force_kkt) = (
        definite(f, model).acceleration(e, e.constraint_acceleration).function(*state)
        for f in (formulation, da.KKT())
    )
    np.testing.assert_allclose(a.full(), a_kkt.full(), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(force.full(), force_kkt.full(), rtol=1e-9, atol=1e-9)


def test_wrong_choices_are_told():
    with pytest.raises(da.UnsupportedError, match=r"'cholesky'.*partitioning, gram-schmidt, qr"):
        da.NullSpace("cholesky")
    with pytest.raises(da.UnsupportedError, match="limit=1"):
        da.NullSpace(limit=1)
    e = bars(1).equations
    with pytest.raises(da.UnsupportedError, match="choose"):
        da.NullSpace().solver(e.inertia, e.jacobian, e.massless)
