"""Equilibrium and modes: balance of moments, exact gradients, closed-form frequencies."""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

GRAVITY = 9.81


def propped_bar() -> da.Model:
    """A bar on a pin, held by an inclined spring; everything a parameter."""
    system = da.System("propped bar", gravity=(0.0, -GRAVITY))
    length = system.parameter("length", 1.2, unit="m")
    mass = system.parameter("mass", 3.0, unit="kg")
    stiffness = system.parameter("stiffness", 400.0, unit="N/m")
    free = system.parameter("free", 0.5, unit="m")
    anchor = system.parameter("anchor", 1.0, unit="m")
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=0.2))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    top = system.ground.point(0.3, anchor)
    system.add(planar.Spring("spring", top, bar.end, stiffness=stiffness, free_length=free))
    return system.build()


def test_moments_balance_about_the_pin():
    rest = da.solve_equilibrium(propped_bar())
    assert rest.status.success
    assert rest.statistics["stable"]
    end = rest["bar.end.position"].values[0]
    pull = rest["spring.force"].values[0] * (np.array([0.3, 1.0]) - end)
    pull /= np.linalg.norm(np.array([0.3, 1.0]) - end)
    moment = end[0] * pull[1] - end[1] * pull[0] - 3.0 * GRAVITY * end[0] / 2
    assert moment == pytest.approx(0.0, abs=1e-8)


def test_gradients_of_an_equilibrium():
    """Direct = adjoint to round-off, both equal to Richardson differences."""
    rest = da.solve_equilibrium(propped_bar())
    responses = [da.final("bar.angle"), da.final("spring.force"), da.final("pin.force_norm")]
    adjoint, direct, differences = (
        da.sensitivity(rest, responses, method=method).values
        for method in ("adjoint", "direct", "finite-difference")
    )
    scale = np.abs(adjoint).max(axis=1, keepdims=True)
    assert np.all(np.abs(adjoint - direct) <= 1e-9 * scale)
    assert np.all(np.abs(adjoint - differences) <= 1e-6 * scale)


def test_modes_of_two_masses_on_springs():
    """ω² = k/m (3 ± √5)/2 for two equal masses on two equal springs in line."""
    system = da.System("chain")
    blocks = []
    last = system.ground.center
    for k in (1, 2):
        block = system.add(planar.Particle(f"m{k}", mass=2.0, position=(float(k), 0.0)))
        system.add(planar.Spring(f"k{k}", last, block.center, stiffness=50.0, free_length=1.0))
        rail = system.add(planar.UserConstraint(f"rail{k}", block.y))
        assert rail.units() == ["m"]
        blocks.append(block)
        last = block.center
    modes = da.linearize(system.build())
    expected = np.sqrt(25.0 * (3 + np.array([-1, 1]) * np.sqrt(5)) / 2) / (2 * np.pi)
    assert modes.frequencies == pytest.approx(expected, rel=1e-10)
    assert modes.stable


def test_damping_ratio_and_growth():
    """s = −ζω ± iω√(1 − ζ²) of a damped pendulum, and a positive exponent when it stands."""
    for angle, standing in ((-np.pi / 2, False), (np.pi / 2, True)):
        system = da.System("pendulum", gravity=(0.0, -GRAVITY))
        rod = system.add(planar.Bar("rod", length=1.0, mass=2.0, angle=angle))
        joint = system.add(planar.Revolute("pin", system.ground.center, rod.start))
        system.add(planar.JointFriction("rub", joint, viscous=0.3))
        modes = da.linearize(system.build(), equilibrium=False)
        inertia, restoring = 2.0 / 3, 2.0 * GRAVITY / 2 * (-1 if standing else 1)
        roots = np.roots([inertia, 0.3, restoring])
        for value in modes.eigenvalues:
            assert np.abs(roots - value).min() == pytest.approx(0.0, abs=1e-10)
        assert modes.stable is not standing


@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6, 1e8])
def test_soft_beside_stiff(stiffness):
    """A pendulum on a cart that a spring holds comes to hang below it, however stiff the spring."""
    system = da.System("trolley", gravity=(0.0, -9.81))
    cart = system.add(planar.Body("cart", mass=1.0, inertia=1.0, position=(0.1, 0.0)))
    bar = system.add(planar.Bar("bar", length=1.0, mass=0.5, angle=-0.4))
    system.add(planar.Prismatic("rail", system.ground.point(0, 0), cart.center, axis=(1, 0)))
    system.add(planar.Revolute("pin", cart.center, bar.start))
    anchor = system.ground.point(-1, 0)
    system.add(planar.Spring("s", anchor, cart.center, stiffness=stiffness, free_length=1.0))
    rest = da.solve_equilibrium(system.build())
    assert rest.status.success
    assert rest.statistics["stable"]
    assert float(rest["cart.x"][0]) == pytest.approx(0.0, abs=1e-9)
    assert float(rest["bar.angle"][0]) == pytest.approx(-np.pi / 2, abs=1e-7)


def hung(stiffness: float | None) -> da.Model:
    """A bar on a soft spring and on a stiff one, or on a rigid link instead."""
    system = da.System("hung", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, angle=0.2, position=(0.5, 0.1)))
    top, side = system.ground.point(0, 1), system.ground.point(1, 1)
    if stiffness is None:
        system.add(planar.RigidLink("stiff", top, bar.start, length=1.0))
    else:
        system.add(planar.Spring("stiff", top, bar.start, stiffness=stiffness, free_length=1.0))
    system.add(planar.Spring("soft", side, bar.end, stiffness=100.0, free_length=0.9))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize("ratio", [1e2, 1e4, 1e6, 1e8, 1e10, 1e11])
def test_stiff_springs_beside_soft_ones(ratio):
    """The stiff one turns far on the way; in the end it is as good as rigid."""
    rigid = da.solve_equilibrium(hung(None)).trajectory.y[:, 0]
    rest = da.solve_equilibrium(hung(100.0 * ratio))
    assert rest.status.success and rest.statistics["stable"], rest.status
    assert rest.statistics["iterations"] < 60
    np.testing.assert_allclose(rest.trajectory.y[:, 0], rigid, atol=1 / ratio + 1e-7)


@pytest.mark.parametrize("ratio", [1e8, 1e10, 1e12])
def test_soft_and_stiff_parts_are_solved_together(ratio):
    """Two bars on springs at their pins: moments of the second one are no bigger than round-off."""
    system = da.System("bars", gravity=(0.0, -9.81))
    body, pin = system.ground, system.ground.point(0, 0)
    for k, stiffness in enumerate((50.0 * ratio, 50.0)):
        bar = system.add(planar.Bar(f"b{k}", length=1.0, mass=1.0, angle=0.1))
        system.add(planar.Revolute(f"O{k}", pin, bar.start))
        system.add(planar.TorsionSpring(f"T{k}", body, bar, stiffness=stiffness))
        body, pin = bar, bar.end
    rest = da.solve_equilibrium(system.build())
    assert rest.status.success, rest.status
    first, second = (float(rest[f"b{k}.angle"].values[0]) for k in range(2))
    assert abs(50.0 * (second - first) + 9.81 / 2 * np.cos(second)) < 1e-9


def free_beside_pinned(**loads) -> da.Model:
    """A pinned body in balance, and a body beside it that nothing holds."""
    system = da.System("free", **loads)
    pinned = system.add(planar.Body("pinned", mass=1.0, inertia=1.0))
    system.add(planar.Revolute("pin", system.ground.center, pinned.center))
    system.add(planar.Body("free", mass=1.0, inertia=1.0, position=(1.0, 0.0)))
    return system.build()


def test_bodies_that_nothing_holds_are_named():
    """Each with its coordinates and the remedy; those in equilibrium by a warning."""
    rest = da.solve_equilibrium(free_beside_pinned())
    assert rest.status.success
    (warning,) = rest.warnings
    assert "pinned (angle), free (x, y, angle) in 4 directions" in warning
    assert "attach them by a joint, spring or support" in warning
    falling = da.solve_equilibrium(free_beside_pinned(gravity=(0.0, -GRAVITY)))
    assert not falling.status.success
    assert "nothing balances the forces on free (y): attach" in falling.status.message


def test_bodies_that_springs_hold_are_not_named():
    assert not da.solve_equilibrium(propped_bar()).warnings
    assert not da.solve_equilibrium(hung(3.0)).warnings
