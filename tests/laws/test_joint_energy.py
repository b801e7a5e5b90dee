"""Law of jointed mechanisms with contacts: no step gains energy, whatever its length."""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.dynamics.residual_check import energy_errors
from dalembert.analysis.model_residuals import ModelResiduals

G = 9.81


def chain(count: int, depth: float = 50.0) -> da.Model:
    """Links that fall from a horizontal start, the last one onto a floor."""
    system = da.System("chain", gravity=(0.0, -G))
    last, length = system.ground.point(0.0, 0.0), 2.0 / count
    for k in range(count):
        bar = system.add(planar.Bar(f"bar{k}", length=length, mass=1.0, angle=0.3 + 0.2 * (k % 2)))
        system.add(planar.Revolute(f"joint{k}", last, bar.start))
        last = bar.end
    return on_floor(system, bar, depth)


def on_floor(system: da.System, body: planar.Bar, depth: float) -> da.Model:
    """The model with a disc at the centre of a bar above a floor."""
    floor = planar.contact.HalfPlane(system.ground.point(0.0, -depth))
    disc, law = planar.contact.Circle(body.center, 0.05), {"restitution": 0.8, "friction": 0.2}
    system.add(planar.Collisions("hits", [disc, floor], **law))
    return system.build()


def four_bar(depth: float) -> da.Model:
    system = da.System("four-bar", gravity=(0.0, -G))
    start = {"angle": np.pi / 2, "angular_velocity": 1.0}
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.5, **start))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return on_floor(system, coupler, depth)


def watt_linkage(damping: float = 0.0) -> da.Model:
    """Watt's straight-line linkage with a spring at its coupler."""
    system = da.System("Watt", gravity=(0.0, -G))
    left = system.add(planar.Bar("left", length=1.0, mass=1.0, angle=0.2))
    middle = system.add(planar.Bar("middle", length=0.5, mass=0.5, angle=1.5))
    right = system.add(planar.Bar("right", length=1.0, mass=1.0, angle=3.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), left.start))
    system.add(planar.Revolute("A", left.end, middle.start))
    system.add(planar.Revolute("B", middle.end, right.end))
    system.add(planar.Revolute("O2", system.ground.point(2.0, 0.5), right.start))
    spring = {"stiffness": 200.0, "free_length": 0.5, "damping": damping}
    system.add(planar.Spring("spring", system.ground.point(1.0, 2.0), middle.center, **spring))
    return on_floor(system, middle, 50.0)


def spatial_links(depth: float) -> da.Model:
    """A double pendulum of spinning bodies on ball joints."""
    system, last = da.System("links", gravity=(0.0, 0.0, -G)), None
    for k in range(2):
        start = {"position": (0.5 + k, 0.0, 0.0), "angular_velocity": (1.0, 2.0, 3.0)}
        link = spatial.Body(f"link{k}", mass=1.0, inertia=(0.01, 0.08, 0.085), **start)
        system.add(link)
        last = last or system.ground.point(0.0, 0.0, 0.0)
        system.add(spatial.Spherical(f"joint{k}", last, link.point(-0.5, 0.0, 0.1 * k)))
        last = link.point(0.5, 0.0, 0.0)
    floor = spatial.contact.HalfSpace(system.ground.frame((0.0, 0.0, -depth)))
    ball = spatial.contact.Sphere(link.center, 0.05)
    system.add(spatial.Collisions("hits", [ball, floor], restitution=0.8))
    return system.build()


def top() -> da.Model:
    """A fast top on a ball joint, with its axis horizontal at the start."""
    system = da.System("top", gravity=(0.0, 0.0, -G))
    start = {"position": (0.0, 1.0, 0.0), "angular_velocity": (0.0, 150.0, 0.0)}
    rotor = system.add(spatial.Body("rotor", mass=15.0, inertia=(0.24, 0.47, 0.24), **start))
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor.point(0, -1, 0)))
    floor = spatial.contact.HalfSpace(system.ground.frame((0.0, 0.0, -50.0)))
    ball = spatial.contact.Sphere(rotor.center, 0.05)
    system.add(spatial.Collisions("hits", [ball, floor], restitution=0.8))
    return system.build()


def driven_pendulum() -> da.Model:
    """A double pendulum whose first link turns at a constant rate."""
    system = da.System("driven", gravity=(0.0, -G))
    first = system.add(planar.Bar("first", length=1.0, mass=1.0, angle=0.2))
    second = system.add(planar.Bar("second", length=1.0, mass=1.0, angle=0.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0), first.start))
    system.add(planar.Revolute("A", first.end, second.start))
    system.add(planar.RotationalDriver("motor", system.ground, first, 0.2 + 3 * da.t))
    return on_floor(system, second, 50.0)


CASES = {
    "double pendulum": (lambda: chain(2), 2e-3, 100),
    "double pendulum that hits": (lambda: chain(2, 1.2), 4e-3, 250),
    "chain of ten": (lambda: chain(10), 1e-3, 100),
    "four-bar that hits": (lambda: four_bar(-0.1), 4e-3, 250),
    "Watt linkage with a spring": (watt_linkage, 1e-3, 100),
    "spatial links that hit": (lambda: spatial_links(1.2), 4e-3, 150),
    "top": (top, 1e-3, 100),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()], ids=str)
@pytest.mark.parametrize("name", CASES)
def test_no_step_gains_energy(name, scheme):
    build, h, count = CASES[name]
    model = build()
    motion = da.solve_nonsmooth(model, h * count, step=h, integrator=scheme)
    assert motion.status.success, motion.status
    residuals = ModelResiduals(model, motion.record.ends, motion.parameters)
    energy = residuals.energies.sum(axis=0)
    moved = np.ptp(residuals.energies, axis=1).max()
    assert np.diff(energy).max() <= 1e-12 * moved
    assert residuals.violations.max() <= 1e-12
    assert ("hit" in name) == bool(motion.record.pressing.any())
    corrections = motion.statistics["work of corrections of positions [J]"]
    assert abs(corrections) <= 1e-11 * moved  # positions at the ends of the steps are exact


@pytest.mark.few(1)
@pytest.mark.parametrize("build", [driven_pendulum, lambda: watt_linkage(5.0)])
def test_work_of_drivers_and_dampers_balances_energy(build):
    model = build()
    motion = da.solve_nonsmooth(model, 0.4, step=2e-3)
    record, parameters = motion.record, motion.parameters
    energies = ModelResiduals(model, record.ends, parameters).energies
    errors = energy_errors(energies, record.ends.work)
    assert np.abs(errors).max() <= 1e-11 * np.ptp(energies, axis=1).max()


def test_motion_is_of_second_order():
    """Errors beside a run with error control fall by four for half the step."""
    model, duration = four_bar(50.0), 0.4
    free = da.solve_dynamics(model, duration, outputs=[duration])
    exact = free["crank.angle"][-1].item()
    errors = [
        abs(da.solve_nonsmooth(model, duration, step=h)["crank.angle"][-1].item() - exact)
        for h in (4e-3, 2e-3)
    ]
    assert errors[1] < 1e-4
    assert 3.6 < errors[0] / errors[1] < 4.4
