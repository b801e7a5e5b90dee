"""Implicit integrators and differential-algebraic forms: order, damping, energy, gradients."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from registry import INTEGRATORS, STABILIZATIONS
from test_stabilization import OUTPUTS, chain, exact
from thorough import crossed, sampled

import dalembert as da
from dalembert import planar
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.integrators.runge_kutta.explicit import ExplicitRungeKutta

FORMS = {
    "index 3": da.DAE(),
    "index 2": da.DAE(index=2),
    "stabilised": da.DAE(index=2, stabilized=True),
    "index 1": da.DAE(index=1),
}
METHODS = {
    "BackwardEuler": da.BackwardEuler(),
    "Trapezoidal": da.Trapezoidal(),
    "Newmark": da.Newmark(),
    "Newmark, damped": da.Newmark(gamma=0.7, beta=0.4),
    "HHT": da.HHT(),
    "GeneralizedAlpha": da.GeneralizedAlpha(),
    "Radau": da.Radau(fixed=True),
}
ORDERS = {"BackwardEuler": 1, "Newmark, damped": 1, "Radau": 5}
"""Others 2. Multipliers are those of the states reached, so they have the order of these."""
LENGTHS = {"Radau": (0.02, 0.01, 0.005)}


def order(method: str, form: str) -> list[float]:
    """Theory for positions, speeds and multipliers.

    Radau IIA of three stages keeps the order 2s − 1 with index 1 and 2; with index 3 speeds have
    order s (Hairer, Lubich and Roche 1989). Generalised-α: Arnold and Brüls (2007).
    """
    if method == "Radau" and form == "index 3":
        return [5, 3, 3]
    return [ORDERS.get(method, 2)] * 3


PAIRS = [(m, f) for m in METHODS for f in FORMS if (m, f) != ("Newmark", "index 3")]
"""Undamped accelerations with constraints of positions only are refused, tested below."""


@pytest.mark.few(3)
@pytest.mark.parametrize(("method", "form"), PAIRS)
def test_measured_order(method, form):
    """Without projection errors fall with the order of theory, within 0.2."""
    steps = np.array(LENGTHS.get(method, (0.005, 0.0025, 0.00125)))
    rows = []
    for h in steps:
        motion = solved(chain(), METHODS[method], form, 0.64, h, outputs=OUTPUTS)
        assert motion.status.success
        pairs = [
            (getattr(motion.trajectory, n), getattr(exact().trajectory, n))
            for n in ("y", "v", "multiplier")
        ]
        rows.append([np.abs(computed - true).max() for computed, true in pairs])
    slopes = np.log(np.array(rows[-2]) / rows[-1]) / np.log(steps[-2] / steps[-1])
    np.testing.assert_allclose(slopes, order(method, form), atol=0.2)


@pytest.mark.few(3)
@pytest.mark.parametrize("stabilization", STABILIZATIONS)
@pytest.mark.parametrize("method", METHODS)
def test_order_with_elimination(method, stabilization):
    """The same order where a formulation gives accelerations, whatever the stabilisation."""
    steps, errors = LENGTHS.get(method, (0.005, 0.0025, 0.00125))[-2:], []
    for h in steps:
        motion = da.solve_dynamics(
            chain(),
            0.64,
            step=h,
            integrator=METHODS[method],
            outputs=OUTPUTS,
            stabilization=STABILIZATIONS[stabilization],
        )
        trajectory, true = motion.trajectory, exact().trajectory
        errors.append(
            [
                np.abs(getattr(trajectory, n) - getattr(true, n)).max()
                for n in ("y", "v", "multiplier")
            ]
        )
    slopes = np.log2(np.array(errors[0]) / errors[1])
    np.testing.assert_allclose(slopes, [ORDERS.get(method, 2)] * 3, atol=0.2)


def solved(model, integrator, form, end, step=None, stabilization=None, **options):
    return da.solve_dynamics(
        model,
        end,
        step=step,
        integrator=integrator,
        formulation=FORMS[form],
        stabilization=stabilization or da.Stabilization(),
        **options,
    )


@pytest.mark.product
@pytest.mark.parametrize(("method", "form", "step"), crossed(PAIRS, [1e-3, 1e-5]))
def test_constraints_hold_where_they_are_asked(method, form, step):
    """At its level a constraint holds to the tolerance of Newton's method, whatever the step.

    That is 1e-12 of what changes in a step, here ``h`` times at most 50 m/s², and round-off.
    """
    data = solved(chain(), METHODS[method], form, 200 * step, step).data
    bound = 1e-12 * 50 * step + 1e-14
    if form in ("index 3", "stabilised"):
        assert float(data.position_violation.max()) < bound
    if form in ("index 2", "stabilised"):
        assert float(data.velocity_violation.max()) < bound


@pytest.mark.thorough
def test_radau_meets_its_tolerance():
    """Errors of positions follow the tolerance over six decades, whatever the form."""
    for form in FORMS:
        for tolerance in 10.0 ** np.arange(-5, -12, -2):
            motion = solved(chain(), da.Radau(tolerance, tolerance), form, 0.64, outputs=OUTPUTS)
            assert motion.status.success
            assert np.abs(motion.trajectory.y - exact().trajectory.y).max() < 20 * tolerance


# oscillators ------------------------------------------------------------------------------
@functools.cache
def oscillator(stiffness: float = 10.0) -> da.Model:
    """``m = 1 kg``, ``x(0) = 0.1 m`` along a line, as in Example 5.3."""
    system = da.System("oscillator", gravity=(0.0, 0.0))
    mass = system.add(planar.Particle("mass", mass=1.0, position=(0.1, 0.0)))
    system.add(
        planar.Spring(
            "spring", system.ground.point(-1, 0), mass.center, stiffness=stiffness, free_length=1.0
        )
    )
    return system.build()


def place(integrator, step: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    motion = da.solve_dynamics(oscillator(), end, step=step, integrator=integrator)
    assert motion.status.success
    return motion.time, motion.values("mass.x").ravel()


def test_trapezoidal_rule_conserves_energy_and_is_not_accurate():
    """Example 5.3: it turns by ``2 atan(ωh/2)`` in a step; RK–Gill at ``2h`` is 100 times better.

    The leading errors of the phase, ``ω³h²/12`` and ``ω⁵H⁴/120`` per second, have the ratio
    ``10 h²/(ω²H⁴)``: 100 at H = 0.05 s, as the book reports, and 6.25 at H = 0.1 s.
    """
    omega, h, end = np.sqrt(10.0), 0.025, 8.0
    motion = da.solve_dynamics(oscillator(), end, step=h, integrator=da.Trapezoidal())
    energy = motion.data.energy.values
    assert np.abs(energy / energy[0] - 1).max() < 1e-12
    t, x = place(da.Trapezoidal(), h, end)
    turned = 2 * np.arctan(omega * h / 2) * np.arange(t.size)
    np.testing.assert_allclose(x, 0.1 * np.cos(turned), atol=1e-12)
    worst = np.abs(x - 0.1 * np.cos(omega * t)).max()
    for longer in (0.05, 0.1):
        t, x = place(da.RKGill(), longer, end)
        gill = np.abs(x - 0.1 * np.cos(omega * t)).max()
        assert worst / gill == pytest.approx(10 * h**2 / (omega**2 * longer**4), rel=0.1)


def amplification(integrator, stiffness: float, step: float) -> np.ndarray:
    """Matrix of one step for the motion along the spring, at the place where it is relaxed."""
    model = oscillator(stiffness)
    kernel, p = Dynamics(1.0, integrator=integrator).kernel(model), model.nominal
    _, mode = kernel.initial(model.start, 0.0, p)
    march = kernel.variants[mode].step
    x = np.zeros(march.size)
    columns = [
        march.tangents(1)(0.0, step, x, p, direction, np.zeros(p.size)).full().ravel()
        for direction in np.eye(march.size)
    ]
    memory = [6, 8, 12] if march.size > march.state_size else []  # v̇, s and the slope of v̇
    keep = [0, 2, *memory]
    return np.array(columns).T[np.ix_(keep, keep)]


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 1.0])
def test_spectral_radius_at_infinite_frequency(rho):
    """Generalised-α shrinks what is infinitely fast to ``ρ∞`` of it (Chung and Hulbert 1993)."""
    eigenvalues = np.linalg.eigvals(amplification(da.GeneralizedAlpha(rho), 1e12, 10.0))
    assert np.abs(eigenvalues).max() == pytest.approx(rho, abs=2e-3)


@pytest.mark.parametrize("alpha", [0.05, 0.2, 1 / 3])
def test_spectral_radius_of_hht(alpha):
    """``(1 − α)/(1 + α)`` is the principal one (Hilber, Hughes and Taylor 1977)."""
    computed = np.abs(np.linalg.eigvals(amplification(da.HHT(alpha), 1e12, 10.0)))
    assert np.min(np.abs(computed - (1 - alpha) / (1 + alpha))) < 2e-3
    assert computed.max() < 1


@pytest.mark.parametrize("method", ["BackwardEuler", "Trapezoidal", "Radau"])
def test_stability_function(method):
    """``R(± iωh)`` are the eigenvalues of one step of an oscillator."""
    integrator, step, omega = METHODS[method], 0.3, np.sqrt(10.0)
    eigenvalues = np.linalg.eigvals(amplification(integrator, 10.0, step))
    expected = integrator.stability(np.array([1j, -1j]) * omega * step)
    np.testing.assert_allclose(np.sort_complex(eigenvalues), np.sort_complex(expected), atol=1e-10)
    assert abs(integrator.stability(-1e9)) == pytest.approx(
        float(method == "Trapezoidal"), abs=1e-6
    )


# stiffness ----------------------------------------------------------------------------------
def pendulum(stiff: bool) -> da.Model:
    """A particle on a rod, or on a spring so stiff that it is one."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bob = system.add(planar.Particle("bob", mass=1.0, position=(0.6, -0.8)))
    if stiff:
        system.add(
            planar.Spring(
                "rod", system.ground.point(0, 0), bob.center, stiffness=1e9, free_length=1.0
            )
        )
    else:
        system.add(planar.RigidLink("rod", system.ground.point(0, 0), bob.center, length=1.0))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize("method", ["BackwardEuler", "Radau", "GeneralizedAlpha", "HHT"])
def test_stiff_spring_is_a_rod(method):
    """``ωh = 316``: RK4 diverges, these take the step of the slow motion, as with the rod."""
    free, step = da.Stabilization(), 0.01
    arguments = {"step": step, "stabilization": free}
    assert not da.solve_dynamics(
        pendulum(True), 1.0, integrator=da.RK4(), **arguments
    ).status.success
    spring = da.solve_dynamics(pendulum(True), 1.0, integrator=METHODS[method], **arguments)
    rod = solved(pendulum(False), METHODS[method], "index 3", 1.0, step)
    assert spring.status.success and rod.status.success
    difference = spring.values("bob.position") - rod.values("bob.position")
    assert np.abs(difference).max() < 1e-4


# gradients ----------------------------------------------------------------------------------
@functools.cache
def varied() -> da.Model:
    system = da.System("chain", gravity=(0.0, -9.81))
    number = system.parameter
    upper = system.add(
        planar.Bar(
            "upper",
            length=number("l", 0.6),
            mass=number("m", 1.2),
            angle=-0.9,
            angular_velocity=number("w", 0.4),
        )
    )
    lower = system.add(planar.Bar("lower", length=0.5, mass=0.7, angle=-1.3))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), upper.start))
    system.add(planar.Revolute("knee", upper.end, lower.start))
    system.add(
        planar.Spring(
            "spring",
            system.ground.point(1.4, 0.3),
            lower.end,
            stiffness=number("k", 6.0),
            damping=number("c", 0.4),
            free_length=0.9,
        )
    )
    return system.build()


ADAPTIVE = [("Radau, adaptive", form) for form in FORMS]
PROJECTED = [(m, f, True) for m in METHODS for f in FORMS]


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("method", "form", "projected"),
    sampled([*PROJECTED, *((*pair, False) for pair in [*PAIRS, *ADAPTIVE])], 3),
)
def test_gradients(method, form, projected):
    """Through steps, memory and branches: direct = adjoint, and both as differences say."""
    integrator = METHODS.get(method, da.Radau(1e-5, 1e-6))
    stabilization = da.Projection() if projected else da.Stabilization()
    outputs = [0.0, 0.107, 0.2]
    motion = solved(varied(), integrator, form, 0.2, 0.02, stabilization, outputs=outputs)
    response = da.mean(varied()["knee.force"][1])
    direct, adjoint, differences = (
        da.sensitivity(motion, response, method=m).values
        for m in ("direct", "adjoint", "finite-difference")
    )
    size = np.abs(direct).max()
    assert np.abs(direct - adjoint).max() < 1e-9 * size
    assert np.abs(direct - differences).max() < 1e-6 * size


EXPLICIT = [n for n, i in INTEGRATORS.items() if isinstance(i, ExplicitRungeKutta)]


# refusals -------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", EXPLICIT)
def test_explicit_methods_refuse(name):
    with pytest.raises(da.UnsupportedError, match=rf"{name} is explicit.*RangeSpace"):
        solved(chain(), INTEGRATORS[name], "index 3", 0.1, 0.01)


@pytest.mark.parametrize("form", ["index 3", "index 2", "stabilised"])
def test_baumgarte_needs_index_1(form):
    with pytest.raises(da.UnsupportedError, match=r"Baumgarte.*DAE\(index=1\)"):
        solved(chain(), da.Radau(), form, 0.1, 0.01, da.Baumgarte())


def test_baumgarte_holds_index_1():
    """``Φ̈ + αΦ̇ + βΦ = 0``: violations stay bounded that drift without it."""

    def last(stabilization):
        motion = solved(chain(), da.Trapezoidal(), "index 1", 8.0, 0.01, stabilization)
        return float(motion.data.position_violation[-1])

    assert last(da.Baumgarte(20.0)) < last(da.Stabilization()) / 10


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: da.DAE(index=4), "index=4"),
        (lambda: da.DAE(index=3, stabilized=True), "index=2, stabilized=True"),
        (lambda: da.Newmark(gamma=0.4), "unstable"),
        (lambda: da.Newmark(beta=0.0), "beta"),
        (lambda: da.HHT(-0.1), "alpha"),
        (lambda: da.GeneralizedAlpha(1.2), "rho_inf=1.2"),
        (lambda: da.Radau(rtol=0.0), "rtol=0.0"),
        (lambda: da.Radau(max_step=-1.0), "max_step"),
        (lambda: da.BackwardEuler(tolerance=0.0), "tolerance"),
        (lambda: da.Trapezoidal(max_iterations=0), "max_iterations=0"),
    ],
)
def test_wrong_numbers_are_refused_by_name(make, said):
    with pytest.raises(da.UnsupportedError, match=said):
        make()


@pytest.mark.parametrize("integrator", [da.Newmark(), da.HHT(0.0), da.GeneralizedAlpha(1.0)])
def test_undamped_accelerations_need_more_than_positions(integrator):
    with pytest.raises(da.UnsupportedError, match="without damping"):
        solved(chain(), integrator, "index 3", 0.1, 0.01)
    assert solved(chain(), integrator, "index 3", 4.0, 0.01, da.Projection()).status.success


def test_what_iterates_by_itself_is_refused():
    with pytest.raises(da.UnsupportedError, match=r"AugmentedLagrangian.*RangeSpace\(\)"):
        da.solve_dynamics(chain(), 0.1, formulation=da.AugmentedLagrangian(), integrator=da.Radau())


def test_newmark_needs_all_speeds():
    with pytest.raises(da.UnsupportedError, match=r"HHT needs all speeds.*Trapezoidal\(\)"):
        da.solve_dynamics(
            chain(), 0.1, step=0.01, formulation=da.VelocityPartitioning(), integrator=da.HHT()
        )


@pytest.mark.parametrize("method", METHODS)
def test_failed_newton_says_so(method):
    """One iteration is not enough: the run ends at the last good state, with the residual."""
    integrator = replace(METHODS[method], max_iterations=1, tolerance=1e-15)
    motion = solved(chain(), integrator, "index 2", 2.0, 0.1)
    assert motion.status.outcome.value == "not converged"
    assert "Newton's method did not converge at t = " in motion.status.message
    assert "residual" in motion.status.message
    assert np.isfinite(motion.data.position.values).all()
