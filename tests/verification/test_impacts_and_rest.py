"""Falls of a few steps, forces at rest, and spins after rough impacts, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch

contact = planar.contact
SCHEMES = pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
COMPILED = pytest.mark.parametrize("compiled", [True, False], ids=["machine code", "general"])
G, R = 9.81, 0.1


def ball(height: float, gravity: float = G, velocity: float = 0.0, **laws: float) -> da.Model:
    """A ball over a floor."""
    system = da.System("ball", gravity=(0, -gravity))
    start = {"position": (0, R + height), "velocity": (velocity, 0)}
    body = system.add(planar.Body("ball", mass=1.0, inertia=0.4 * R**2, **start))
    system.add(
        planar.Collisions(
            "floor", [contact.Circle(body, R), contact.HalfPlane(system.ground)], **laws
        )
    )
    return system.build()


@pytest.mark.few(1)
@COMPILED
def test_falls_of_two_steps_do_not_depend_on_rounding(compiled, monkeypatch):
    """From ``h = k a h²`` bodies hit at ``√(2k) a h``, of which round-off changes the last digit:
    those of one ``k`` all rebound or all rest."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    for k, rebounds in ((1.5, False), (2.0, True), (3.0, True)):
        for gravity, step in ((9.81, 1e-2), (1.62, 3e-3)):
            height = k * gravity * step**2
            model = ball(height, gravity, restitution=0.9)
            motion = da.solve_nonsmooth(model, 4 * step, step=step)
            risen = motion["ball.vy"].values.max() > 0.5 * gravity * step
            assert risen == rebounds, (k, gravity, step)


@pytest.mark.few(1)
@COMPILED
@pytest.mark.parametrize("restitution", [0.0, 0.7])
def test_a_ball_at_rest_carries_its_weight_in_every_step(restitution, compiled, monkeypatch):
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    step = 4e-3
    motion = da.solve_nonsmooth(ball(0.02, restitution=restitution), 0.9, step=step)
    forces = motion.impulse("floor").values[-20:] / step
    np.testing.assert_allclose(forces, G, rtol=1e-6)
    assert abs(motion["ball.vy"].values[-20:]).max() < 1e-9


def test_a_box_at_rest_after_tumbling_carries_its_weight_in_every_step():
    system, step = da.System("box", gravity=(0, -G)), 5e-3
    start = {"position": (0, 0.2), "angle": 0.3, "velocity": (0.5, 0)}
    body = system.add(planar.Body("box", mass=1.0, inertia=0.01, **start))
    shapes = [contact.Rectangle(body, (0.3, 0.2)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, restitution=0.2, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 1.5, step=step)
    forces = motion.impulse("floor").values[-10:] / step
    np.testing.assert_allclose(forces, G, rtol=1e-6)


@pytest.mark.few(2)
@SCHEMES
@pytest.mark.parametrize("step", [4e-3, 1e-3])
def test_a_ball_that_hits_the_floor_obliquely_rolls(scheme, step):
    """``v = v₀/(1 + k)`` and ``ω = −v/r``, ``k = 2/5``, where friction stops the slip."""
    model = ball(0.3, velocity=1.0, friction=0.5, restitution=0.5)
    motion = da.solve_nonsmooth(model, 0.3, step=step, integrator=scheme)
    assert motion["ball.vx"][-1].item() == pytest.approx(1 / 1.4, rel=1e-8)
    assert motion["ball.angular_velocity"][-1].item() == pytest.approx(-1 / 1.4 / R, rel=1e-8)


@pytest.mark.few(1)
@COMPILED
def test_discs_that_collide_obliquely_spin_by_friction(compiled, monkeypatch):
    """Slip that lasts: ``P = (1 + e) m v/2`` and ``ω = μ P r/I`` of both."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    system, inertia = da.System("discs"), 0.5 * R**2
    first = {"position": (0, 0), "velocity": (2.0, 3.0)}
    bodies = [
        system.add(planar.Body("a", mass=1.0, inertia=inertia, **first)),
        system.add(planar.Body("b", mass=1.0, inertia=inertia, position=(0.5, 0.45))),
    ]
    shapes = [contact.Circle(body, R) for body in bodies]
    system.add(planar.Collisions("hit", shapes, restitution=0.8, friction=0.1))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=1e-3)
    spins = [motion[f"{name}.angular_velocity"][-1].item() for name in "ab"]
    impulse = np.linalg.norm([motion["b.vx"][-1], motion["b.vy"][-1]]) / np.sqrt(1 + 0.1**2)
    assert spins == pytest.approx([spins[0]] * 2, rel=1e-8)
    assert abs(spins[0]) == pytest.approx(0.1 * impulse * R / inertia, rel=1e-8)


def test_impacts_of_a_contact_with_restitution_have_the_levers_of_the_surfaces():
    system = da.System("ball", gravity=(0, -G))
    start = {"position": (0, R + 0.3), "velocity": (1.0, 0)}
    body = system.add(planar.Body("ball", mass=1.0, inertia=0.4 * R**2, **start))
    laws = {"law": contact.Restitution(0.5), "friction": contact.Coulomb(0.5)}
    shapes = contact.Circle(body, R), contact.HalfPlane(system.ground)
    system.add(planar.Contact("floor", *shapes, **laws))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=4e-3)
    assert motion["ball.angular_velocity"][-1].item() == pytest.approx(-1 / 1.4 / R, rel=1e-8)


@pytest.mark.few(1)
@COMPILED
def test_rebounds_do_not_depend_on_forces_on_other_bodies(compiled, monkeypatch):
    """Beside a ball that a stiff spring presses on the floor by 900 g."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    system = da.System("balls", gravity=(0, -G))
    falling = system.add(planar.Particle("falling", mass=1.0, position=(0, R + 0.05)))
    pressed = system.add(planar.Particle("pressed", mass=1.0, position=(1, R)))
    anchor = system.ground.point(1, 1)
    spring = {"stiffness": 1e4, "free_length": 0.9 + 0.9}
    system.add(planar.Spring("press", pressed.center, anchor, **spring))
    shapes = [contact.Circle(body.center, R) for body in (falling, pressed)]
    shapes.append(contact.HalfPlane(system.ground))
    system.add(planar.Collisions("floor", shapes, restitution=1.0))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=1e-3)
    height = 0.5 * motion["falling.vy"] ** 2 + G * (motion["falling.y"] - R)
    np.testing.assert_allclose(height, G * 0.05, rtol=1e-6)
    assert motion["falling.y"][-1].item() > R + 0.04
