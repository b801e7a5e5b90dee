"""Speeds that must vanish: a disc that rolls, a knife edge that does not slide sideways."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

M, R, G = 1.3, 0.5, 9.81
A, C = M * R**2 / 4, M * R**2 / 2
LEAN, SPIN, TURN = 0.3, 4.0, 0.3
CHOICES = {
    "RangeSpace": {},
    "Projection": {"stabilization": da.Projection()},
    "Baumgarte": {"stabilization": da.Baumgarte()},
    "KKT": {"formulation": da.KKT()},
    "NullSpace": {"formulation": da.NullSpace(), "stabilization": da.Projection()},
    "VelocityPartitioning": {"formulation": da.VelocityPartitioning()},
    "AugmentedLagrangian": {"formulation": da.AugmentedLagrangian()},
    "Penalty": {"formulation": da.Penalty()},
    "index 3": {"formulation": da.DAE(3), "integrator": da.Radau()},
    "index 2": {"formulation": da.DAE(2), "integrator": da.Radau()},
    "stabilised index 2": {"formulation": da.DAE(2, stabilized=True), "integrator": da.Radau()},
    "index 1": {"formulation": da.DAE(1), "integrator": da.Radau()},
    "GeneralizedAlpha": {"formulation": da.DAE(3), "integrator": da.GeneralizedAlpha()},
    "DormandPrince": {"integrator": da.DormandPrince(1e-9, 1e-11)},
}


def disc(lean=LEAN, spin=SPIN, turn=TURN, parameters=False) -> da.Model:
    system = da.System("disc", gravity=(0.0, 0.0, -G))
    r, m = (system.parameter("r", R), system.parameter("m", M)) if parameters else (R, M)
    body = system.add(
        spatial.Body(
            "disc",
            mass=m,
            inertia=(m * r * r / 4, m * r * r / 2, m * r * r / 4),
            position=(0, 0, r * np.cos(lean)),
            rotation=da.rotation.axis_angle((1, 0, 0), lean),
            angular_velocity=(0, spin, turn),
        )
    )
    system.add(spatial.RollingDisc("roll", body, system.ground.frame(), radius=r))
    return system.build()


def classical(times: np.ndarray, lean: float, omega: np.ndarray) -> np.ndarray:
    """Lean θ and angular velocity ω of a rolling disc by Newton and Euler about its centre.

    In axes that do not spin: 1 along the motion, 2 the axle, 3 = 1 × 2 from the contact upwards;
    they turn with ``(ω₁, ω₃ tan θ, ω₃)``, and the centre moves with ``R (ω₂, −ω₁, 0)``.
    """
    i = M * R**2

    def rate(_, s):
        lean, w1, w2, w3 = s
        fall = (C + i) * w2 * w3 - A * w3**2 * np.tan(lean) + M * G * R * np.sin(lean)
        turn = w1 * (A * w3 * np.tan(lean) - C * w2)
        return [w1, fall / (A + i), -i * w1 * w3 / (C + i), turn / A]

    start = [lean, *omega]
    return solve_ivp(rate, (0, times[-1]), start, t_eval=times, rtol=1e-12, atol=1e-13).y


@pytest.mark.few(2)
@pytest.mark.parametrize("name", CHOICES)
def test_every_choice_rolls_the_same_way(name):
    model = disc()
    choice = {"integrator": da.RK4(), **CHOICES[name]}
    motion = da.solve_dynamics(model, 0.5, step=1e-3, outputs=[0.5], **choice)
    best = da.solve_dynamics(
        model, 0.5, outputs=[0.5], integrator=da.DormandPrince853(1e-12, 1e-12)
    )
    computed, expected = (one["disc.position"].values[-1] for one in (motion, best))
    np.testing.assert_allclose(computed, expected, atol=1e-7 if name == "Penalty" else 1e-6)
    assert abs(float(motion.data.velocity_violation[-1])) < 1e-6


def test_rolling_disc_against_eulers_equations():
    times = np.linspace(0.0, 1.0, 11)
    motion = da.solve_dynamics(
        disc(), 1.0, outputs=times, integrator=da.DormandPrince853(1e-12, 1e-12)
    )
    turned = motion["disc.rotation"].values.reshape(-1, 3, 3)
    local = np.einsum("ki,kij->kj", motion["disc.angular_velocity"].values, turned)
    lean, _, spin, _ = classical(times, LEAN, local[0])  # the first as assembly has made them
    np.testing.assert_allclose(motion["disc.z"].values, R * np.cos(lean), atol=1e-9)
    np.testing.assert_allclose(local[:, 1], spin, atol=1e-8)
    np.testing.assert_allclose(motion.data.balance_error, 0.0, atol=1e-9)


def test_gradients_of_what_rolls():
    motion = da.solve_dynamics(disc(parameters=True), 0.3, step=2e-3, stabilization=da.Projection())
    responses = [da.final("disc.x"), da.final("roll.force_norm")]
    direct, adjoint = (
        da.sensitivity(motion, responses, method=method).values for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9, atol=1e-12)
    p = motion.parameters
    for k in range(p.size):
        ends = []
        for sense in (1, -1):
            there = p.copy()
            there[k] += sense * 1e-5
            again = motion.analysis.replay(motion, there)
            ends.append([float(again[m].values[-1]) for m in ("disc.x", "roll.force_norm")])
        np.testing.assert_allclose(direct[:, k], np.subtract(*ends) / 2e-5, rtol=1e-6, atol=1e-9)


def sledge() -> da.Model:
    """Chaplygin's sledge on a plane: a knife edge at P, the mass centre a before it."""
    system = da.System("sledge")
    body = system.add(
        spatial.Body(
            "b",
            mass=2.0,
            inertia=(0.2, 0.2, 0.3),
            center_of_mass=(0.4, 0, 0),
            position=(0, 0, 0),
            rotation=da.rotation.axis_angle((0, 0, 1), 0.0),
            velocity=(1.0, 0, 0),
            angular_velocity=(0, 0, 0.7),
        )
    )
    plane = system.ground.frame()
    system.add(da.planar.UserConstraint("height", body.z))
    axes = body.rotation.sx
    from dalembert.symbolic.formulas.expression import Expression

    system.add(da.planar.UserConstraint("tilt_x", Expression(axes[2]), unit="rad"))
    system.add(da.planar.UserConstraint("tilt_y", Expression(axes[5]), unit="rad"))
    system.add(spatial.KnifeEdge("edge", body.frame(), plane))
    return system.build()


def test_chaplygin_sledge():
    """``u̇ = a ω²``, ``(J + m a²) ω̇ = −m a u ω``: forward speed and turn rate of the edge."""
    m, a, j = 2.0, 0.4, 0.3
    times = np.linspace(0.0, 2.0, 5)
    motion = da.solve_dynamics(
        sledge(), 2.0, outputs=times, integrator=da.DormandPrince853(1e-12, 1e-12)
    )

    def rate(_, s):
        return [a * s[1] ** 2, -m * a * s[0] * s[1] / (j + m * a**2)]

    expected = solve_ivp(rate, (0, 2), [1.0, 0.7], t_eval=times, rtol=1e-12, atol=1e-13).y
    np.testing.assert_allclose(motion["b.angular_velocity"].values[:, 2], expected[1], atol=1e-9)
    speed = np.linalg.norm(motion["b.velocity"].values, axis=1)
    np.testing.assert_allclose(speed, expected[0], atol=1e-9)


def skater(speeds: bool = True, bent: bool = False) -> da.Model:
    """A skate on a plane, in the plane: ``ẏ cos φ − ẋ sin φ = 0`` at its mass centre."""
    system = da.System("skater", gravity=(0.0, -1.0))
    body = system.add(
        da.planar.Body(
            "b",
            mass=1.0,
            inertia=0.5,
            position=(0, 0),
            angle=0.0,
            velocity=(0, 0),
            angular_velocity=1.5,
        )
    )
    across = body.velocity[1] * da.cos(body.angle) - body.velocity[0] * da.sin(body.angle)
    formula = across * abs(across) if bent else across
    system.add(da.planar.UserConstraint("skate", formula, speeds=speeds))
    return system.build()


@pytest.mark.parametrize("name", ["RangeSpace", "Projection", "index 3", "AugmentedLagrangian"])
def test_skate_on_a_slope(name):
    """With φ = ω t and u̇ = −g sin φ along the skate: ẋ = u cos φ, ẏ = u sin φ."""
    choice = {"integrator": da.RK4(), **CHOICES[name]}
    motion = da.solve_dynamics(skater(), 2.0, step=1e-3, outputs=[0.5, 1.0, 2.0], **choice)
    turn, w = 1.5 * motion.time, 1.5
    np.testing.assert_allclose(motion["b.angle"], turn, atol=1e-9)
    x = (turn / 2 + np.sin(2 * turn) / 4 - np.sin(turn)) / w**2
    y = (np.sin(turn) ** 2 / 2 + np.cos(turn) - 1) / w**2
    np.testing.assert_allclose(motion["b.position"], np.column_stack([x, y]), atol=1e-6)


def test_equations_of_speeds_are_linear_in_them():
    with pytest.raises(da.ModelError, match="skate: an equation of speeds must be linear"):
        skater(bent=True)
    with pytest.raises(da.ExpressionError, match="skate: depends on"):
        skater(speeds=False)


def test_kinematics_says_that_positions_depend_on_the_way():
    system = da.System("driven", gravity=(0, 0, -G))
    body = system.add(spatial.Body("disc", mass=M, inertia=(A, C, A), position=(0, 0, R)))
    system.add(spatial.RollingDisc("roll", body, system.ground.frame(), radius=R))
    for k, base in enumerate(((2, 0.3, 0), (0.4, 2, 0), (0.1, 0.2, 3))):
        local = 0.1 * np.eye(3)[k]
        far = float(np.linalg.norm(np.array(base) - local - [0, 0, R]))
        ends = system.ground.point(*base), body.point(*local)
        system.add(da.planar.DistanceDriver(f"d{k}", *ends, far))
    with pytest.raises(da.UnsupportedError, match="roll: positions depend on the path"):
        da.solve_kinematics(system.build(), 1.0)
