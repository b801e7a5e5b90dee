"""What only the augmented methods of Ch. 7 pass: singular positions, and very long runs.

Sources: IFToMM A02 (N four-bars, all bars aligned twice in every turn or swing) against the exact
one equation of its motion; IFToMM A01 (simple pendulum over 2000 s) against elliptic functions.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipj, ellipk
from test_double_four_bar import exact, mechanism

import dalembert as da
from dalembert import planar
from dalembert.results.status import Outcome

G = 9.81
EVERY = da.AugmentedLagrangian()


@pytest.mark.thorough
@pytest.mark.parametrize(
    "integrator",
    [da.DormandPrince853(1e-11, 1e-11), da.DormandPrince(1e-9, 1e-9)],
    ids=lambda i: i.name,
)
def test_double_four_bar_through_all_singular_positions(integrator):
    """Positions within 1e-6 over 10 s; every swing passes two positions where C loses rank."""
    times = np.array([1.0, 2.0, 4.0, 5.0, 10.0])
    motion = da.solve_dynamics(
        mechanism().build(),
        10.0,
        formulation=EVERY,
        integrator=integrator,
        outputs=times,
    )
    angle = exact(times, through=True).y[0]
    computed = motion.data.point_position.sel(point="crank0.end").values
    np.testing.assert_allclose(computed.T, [np.cos(angle), np.sin(angle)], atol=1e-6)
    np.testing.assert_allclose(motion.data.balance_error, 0.0, atol=1e-5)
    assert float(motion.data.position_violation.max()) < 1e-12


def parallelogram(motor: bool = False) -> da.Model:
    """No gravity, unit speed: the angle is t − 1, so at t = 1 all bars lie on one line."""
    system = da.System("parallelogram")
    cranks = []
    for k in range(2):
        place = (2 * k + np.cos(1) / 2, -np.sin(1) / 2)
        bar = planar.Bar(
            f"crank{k}", length=1.0, mass=1.0 + k, position=place, angle=-1.0, angular_velocity=1.0
        )
        cranks.append(system.add(bar))
        system.add(planar.Revolute(f"O{k}", system.ground.point(2 * k, 0), bar.start))
    coupler = system.add(planar.Bar("coupler", length=2.0, mass=1.0, angle=0.0))
    system.add(planar.Revolute("A0", cranks[0].end, coupler.start))
    system.add(planar.Revolute("A1", cranks[1].end, coupler.end))
    if motor:
        system.add(planar.RotationalDriver("motor", system.ground, cranks[0], da.t - 1))
    return system.build()


INTEGRATORS = {
    "RK4": da.RK4(),
    "DormandPrince": da.DormandPrince(1e-8, 1e-8),
    "DormandPrince853": da.DormandPrince853(1e-8, 1e-8),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("motor", [False, True])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_output_exactly_in_the_singular_position(integrator, motor):
    """A step or an output ends where C loses rank; the parallelogram stays one: θ = t − 1."""
    motion = da.solve_dynamics(
        parallelogram(motor),
        2.0,
        step=0.01,
        formulation=EVERY,
        outputs=21,
        integrator=INTEGRATORS[integrator],
    )
    assert motion.status.success, motion.status
    # in the position itself, no correction sees the way the bars can fold: the error of one step
    limit = np.where(abs(motion.time - 1) < 1e-9, 1e-6, 1e-8)
    for crank in ("crank0", "crank1"):
        assert np.all(abs(motion[f"{crank}.angle"].values - (motion.time - 1)) < limit)
    assert np.all(abs(motion["coupler.angle"].values) < limit)
    assert float(motion.data.position_violation.max()) < 1e-12


@pytest.mark.parametrize("motor", [False, True])
def test_range_space_says_where_it_breaks_down_and_what_passes(motor):
    motion = da.solve_dynamics(
        parallelogram(motor), 2.0, step=0.01, formulation=da.RangeSpace(), outputs=21
    )
    assert motion.status.outcome is Outcome.SINGULAR
    assert "formulation=AugmentedLagrangian()" in motion.status.message
    assert "t = 1 s" in motion.status.message
    assert "O0, O1, A0, A1 lose their independence" in motion.status.message
    assert ("driver 'motor' at crank0.angle = 0 rad (0°)" in motion.status.message) is motor


def test_kinematics_that_begins_in_a_singular_position_names_who_is_concerned():
    wrong = r"driver 'motor' at crank0.angle = 0 rad \(0°\): O0, O1, A0, A1 lose their independence"
    with pytest.raises(da.AnalysisError, match=wrong):
        da.solve_kinematics(parallelogram(motor=True), t_span=(1.0, 2.0))


def test_a_step_too_long_is_not_called_singular():
    """A pendulum whose constraint matrix always has full rank, with steps of half a turn."""
    system = da.System("pendulum", gravity=(0.0, -G))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.0, angular_velocity=200.0))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    motion = da.solve_dynamics(system.build(), 10.0, step=0.05, integrator=da.Euler())
    assert "AugmentedLagrangian" not in motion.status.message


@pytest.mark.thorough
def test_simple_pendulum_over_2000_seconds():
    """Positions within 1e-3 at 4000 outputs, the benchmark's high accuracy; here 1e-5."""
    system = da.System("pendulum", gravity=(0.0, -G))
    bob = system.add(planar.Particle("bob", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    times, k = np.linspace(0.0, 2000.0, 4001)[1:], np.sin(np.pi / 4)
    motion = da.solve_dynamics(
        system.build(),
        2000.0,
        outputs=times,
        integrator=da.DormandPrince853(1e-11, 1e-11),
    )
    sine = k * ellipj(ellipk(k**2) - times * np.sqrt(G), k**2)[0]
    angle = 2 * np.arcsin(sine)
    expected = np.stack([np.sin(angle), -np.cos(angle)])
    np.testing.assert_allclose(expected[:, -1], [-0.81460307, -0.58001883], atol=1e-7)
    np.testing.assert_allclose(motion.trajectory.y[:2], expected, atol=1e-5)
