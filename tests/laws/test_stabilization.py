"""Stabilisation and integrators: violations stay small, and errors fall with the order claimed."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import CONSTRAINED, INTEGRATORS, STABILIZATIONS, model_of

import dalembert as da
from dalembert import planar, spatial
from dalembert.integrators.runge_kutta.explicit import ExplicitRungeKutta

ORDERS = {
    "Euler": (0.8, 1.2),
    "Heun": (1.8, 2.2),
    "RK4": (3.8, 4.2),
    "RKGill": (3.8, 4.2),
    "DormandPrince": (4.7, 5.6),
    "DormandPrince853": (7.7, 8.3),
}
"""Dormand and Prince made the leading error so small that the next order shows too."""
LENGTHS = {"DormandPrince": (0.004, 0.0025, 0.002), "DormandPrince853": (0.02, 0.016, 0.01)}
OUTPUTS = np.linspace(0.0, 0.64, 9)


@functools.cache
def chain():
    """Two bars on a pin, a driver of time and a spring: smooth, constrained, rheonomic."""
    system = da.System("chain", gravity=(0.0, -9.81))
    upper = system.add(planar.Bar("upper", length=0.6, mass=1.2, angle=-0.9, angular_velocity=0.4))
    lower = system.add(planar.Bar("lower", length=0.5, mass=0.7, angle=-1.3, angular_velocity=-0.6))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), upper.start))
    system.add(planar.Revolute("knee", upper.end, lower.start))
    system.add(
        planar.Spring(
            "spring",
            system.ground.point(1.4, 0.3),
            lower.end,
            stiffness=6.0,
            damping=0.4,
            free_length=0.9,
        )
    )
    return system.build()


@functools.cache
def exact():
    return da.solve_dynamics(
        chain(), 0.64, integrator=da.DormandPrince853(1e-14, 1e-14), outputs=OUTPUTS
    )


@pytest.mark.few(16)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_projection_closes_all_equations_at_every_output(name):
    """|Φ|, |Ψ| ≤ 1e-12 at steps and between them."""
    motion = da.solve_dynamics(model_of(name), 0.2, step=0.02, outputs=np.linspace(0, 0.2, 7))
    assert motion.status.success
    assert float(motion.data.position_violation.max()) < 1e-12
    assert float(motion.data.velocity_violation.max()) < 1e-12


def test_projection_every_few_steps_still_ends_on_the_constraints():
    motion = da.solve_dynamics(chain(), 0.5, step=0.01, stabilization=da.Projection(every=7))
    assert float(motion.data.position_violation[-1]) < 1e-12
    assert float(motion.data.position_violation.max()) < 1e-5


def test_baumgarte_keeps_bounded_what_drifts_without_it():
    """Violation of the later half no larger than of the first; without stabilisation it grows."""

    def halves(stabilization):
        motion = da.solve_dynamics(chain(), 8.0, step=0.01, stabilization=stabilization)
        violation = motion.data.position_violation.values
        return violation[:400].max(), violation[400:].max()

    held, drifting = halves(da.Baumgarte(alpha=20.0)), halves(da.Stabilization())
    assert held[1] < 1.5 * held[0]
    assert drifting[1] > 1.5 * drifting[0]
    assert held[1] < drifting[1] / 10


def errors(integrator: str, stabilization, steps) -> np.ndarray:
    """Largest errors of positions, speeds and multipliers, one row per step length."""
    rows = []
    for h in steps:
        method = INTEGRATORS[integrator]
        if method.adaptive:  # everything accepted: steps of given length
            method = type(method)(1e9, 1e9, max_step=h)
        motion = da.solve_dynamics(
            chain(), 0.64, step=h, integrator=method, outputs=OUTPUTS, stabilization=stabilization
        )
        trajectory, true = motion.trajectory, exact().trajectory
        rows.append(
            [
                np.abs(getattr(trajectory, n) - getattr(true, n)).max()
                for n in ("y", "v", "multiplier")
            ]
        )
    return np.array(rows)


@pytest.mark.few(3)
@pytest.mark.parametrize("stabilization", STABILIZATIONS)
@pytest.mark.parametrize(
    "integrator", [n for n, i in INTEGRATORS.items() if isinstance(i, ExplicitRungeKutta)]
)
def test_measured_order(integrator, stabilization):
    """Errors of positions, speeds and multipliers fall with the order claimed."""
    steps = np.array(LENGTHS.get(integrator, (0.01, 0.005, 0.0025)))
    table = errors(integrator, STABILIZATIONS[stabilization], steps)
    slopes = np.polyfit(np.log(steps), np.log(table), 1)[0]
    low, high = ORDERS[integrator]
    assert np.all((low < slopes) & (slopes < high)), slopes


def test_tolerance_of_the_adaptive_integrator_is_met():
    """Errors follow the tolerance over six decades."""
    for tolerance in 10.0 ** np.arange(-5, -12, -2):
        method = da.DormandPrince(tolerance, tolerance)
        motion = da.solve_dynamics(chain(), 0.64, integrator=method, outputs=OUTPUTS)
        assert np.abs(motion.trajectory.y - exact().trajectory.y).max() < 20 * tolerance


def test_outputs_do_not_change_the_motion():
    """Outputs between steps leave the steps as they are."""
    fine = da.solve_dynamics(chain(), 0.3, step=0.01, outputs=np.linspace(0, 0.3, 58))
    plain = da.solve_dynamics(chain(), 0.3, step=0.01, integrator=da.RK4())
    np.testing.assert_array_equal(fine.trajectory.y[:, -1], plain.trajectory.y[:, -1])


# energy -------------------------------------------------------------------------------------


@functools.cache
def swinging():
    """Two bars on a pin, nothing that puts in or takes energy."""
    system = da.System("swinging", gravity=(0.0, -9.81))
    upper = system.add(planar.Bar("upper", length=0.6, mass=1.2, angle=-0.4, angular_velocity=0.4))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), upper.start))
    return system.build()


def test_energy_projection_holds_energy_and_constraints():
    """Energy and both levels of constraints to round-off, at a step where RK4 loses energy."""
    options = {"step": 0.05, "integrator": da.RK4()}
    held = da.solve_dynamics(swinging(), 5.0, stabilization=da.EnergyProjection(), **options)
    free = da.solve_dynamics(swinging(), 5.0, stabilization=da.Projection(), **options)
    scale = float(abs(held.data.kinetic_energy).max())
    assert np.abs(held.data.balance_error).max() < 1e-13 * scale
    assert np.abs(free.data.balance_error).max() > 1e-8 * scale
    assert float(held.data.position_violation.max()) < 1e-12
    assert float(held.data.velocity_violation.max()) < 1e-12
    assert not held.warnings


def test_energy_projection_says_where_it_misleads():
    """More than one degree of freedom, and energy that is put in, are told; drivers are refused."""
    motion = da.solve_dynamics(chain(), 0.2, step=0.01, stabilization=da.EnergyProjection())
    assert any("2 degrees of freedom by one number" in text for text in motion.warnings)
    assert any("J were put in or dissipated" in text for text in motion.warnings)
    with pytest.raises(da.UnsupportedError, match=r"prescribes some.*Projection\(\)"):
        da.solve_dynamics(
            model_of("rotational driver Polynomial"), 0.1, stabilization=da.EnergyProjection()
        )


@functools.cache
def swinging_in_space():
    """Two bodies on hinges askew, with a link of two balls between them: one freedom."""
    system = da.System("askew", gravity=(0.4, -0.7, -9.81))
    hinges = {"a": ((0.0, 0.0, 0.0), (0.2, 1.0, 0.1)), "b": ((0.9, 0.3, 0.1), (1.0, 0.3, 0.2))}
    ends = []
    for name, (place, axis) in hinges.items():
        body = spatial.Body(
            name,
            mass=1.1,
            inertia=(0.2, 0.3, 0.25, 0.02, -0.01, 0.03),
            center_of_mass=(0.3, -0.2, 0.1),
            position=place,
            rotation=da.rotation.identity(),
        )
        system.add(body)
        hinge = system.ground.frame(place, axis=axis)
        system.add(spatial.Revolute(name.upper(), hinge, body.frame(axis=axis)))
        ends.append(body.point(0.1, 0.2, 0.3))
    reach = float(np.linalg.norm((0.9, 0.3, 0.1)))
    system.add(spatial.RigidLink("L", *ends, length=reach))
    return system.build()


def test_energy_projection_holds_energy_and_constraints_in_space():
    """As in the plane; nothing that stands still there is taken for something in time."""
    options = {"step": 0.05, "integrator": da.RK4()}
    model = swinging_in_space()
    assert model.diagnosis.degrees_of_freedom == 1
    held = da.solve_dynamics(model, 2.0, stabilization=da.EnergyProjection(), **options)
    free = da.solve_dynamics(model, 2.0, stabilization=da.Projection(), **options)
    scale = float(abs(held.data.kinetic_energy).max())
    assert np.abs(held.data.balance_error).max() < 1e-13 * scale
    assert np.abs(free.data.balance_error).max() > 1e-8 * scale
    assert float(held.data.position_violation.max()) < 1e-12
    assert float(held.data.velocity_violation.max()) < 1e-12
    assert not held.warnings


@pytest.mark.parametrize(
    "name", ["spatial screw", "constant velocity", "bevel gears", "point on helix"]
)
def test_energy_projection_takes_what_does_not_move_with_time(name):
    e = model_of(name).equations
    assert da.EnergyProjection().correction(e, da.RangeSpace()) is not None


@pytest.mark.parametrize("name", ["hinge driver", "sleeve driver", "spatial distance driver"])
def test_energy_projection_refuses_drivers_in_space(name):
    with pytest.raises(da.UnsupportedError, match=r"prescribes some.*Projection\(\)"):
        da.EnergyProjection().correction(model_of(name).equations, da.RangeSpace())


@pytest.mark.parametrize("integrator", ["Euler", "Heun", "RK4", "RKGill"])
def test_baumgarte_beyond_its_stability_is_flagged_with_the_number(integrator):
    """Below the bound violations stay, above they grow; the longest step is told."""
    h, method = 0.001, INTEGRATORS[integrator]
    bound = {"Euler": 2.0, "Heun": 2.0}.get(integrator, 2.785293563405282)  # |hs|, s = −α/2
    below, above = (da.Baumgarte(alpha=2 * share * bound / h) for share in (0.9, 1.1))
    run = functools.partial(da.solve_dynamics, swinging(), 80 * h, step=h, integrator=method)
    quiet, loud = run(stabilization=below), run(stabilization=above)
    assert not any("multiplies violations" in text for text in quiet.warnings)
    assert f"use steps below {h / 1.1:.3g} s" in loud.warnings[0]
    assert loud.data.position_violation[-1] > 1e3 * quiet.data.position_violation[-1]


ADAPTIVE = [name for name, integrator in INTEGRATORS.items() if integrator.adaptive]


@pytest.mark.few(2)
@pytest.mark.parametrize("integrator", ADAPTIVE)
def test_a_driven_mechanism_limits_the_step_by_its_corrections(integrator):
    """All motion is prescribed, so no error lies along the constraints; kinematics is the truth."""
    system = da.System("driven")
    crank = system.add(planar.Bar("crank", length=0.1, mass=1.0, angle=0.3))
    rod = system.add(planar.Bar("rod", length=0.3, mass=0.5, angle=-0.1))
    piston = system.add(planar.Body("piston", mass=0.4, inertia=0.01, position=(0.39, 0.0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, piston.center))
    system.add(planar.Prismatic("guide", system.ground.point(0, 0), piston.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 0.3 + 40 * da.t))
    model = system.build()
    motion = da.solve_dynamics(model, 0.5, integrator=INTEGRATORS[integrator], outputs=21)
    truth = da.solve_inverse_dynamics(model, 0.5, outputs=21).trajectory
    assert motion.status.success
    np.testing.assert_allclose(motion.trajectory.y, truth.y, atol=1e-12)
    np.testing.assert_allclose(motion.trajectory.v, truth.v, atol=1e-10)
    largest = np.abs(truth.multiplier).max()
    np.testing.assert_allclose(motion.trajectory.multiplier, truth.multiplier, atol=1e-9 * largest)
