"""Contact at the nearest point of a beam: distances, virtual work, energy, gradients."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

kit, solid = planar.contact, spatial.contact
RIGIDITIES = {"axial_rigidity": 300.0, "shear_rigidity": 120.0, "bending_rigidity": 2.0}
STRIP = {"length": 0.8, "mass_per_length": 0.7, **RIGIDITIES}


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("place", [(0.1, 0.15), (-0.45, 0.1), (0.3, -0.12), (0.21, 0.2)])
def test_the_gap_is_the_distance_from_the_curve(order, place):
    system = da.System("gap")
    beam = planar.Beam("strip", **STRIP, position=(-0.4, 0), elements=2, order=order)
    beam = system.add(beam)
    shapes = kit.BeamSurface(beam, 0.01), kit.Circle(system.ground.point(*place), 0.02)
    law = kit.KelvinVoigt(stiffness=1e3)
    touch = system.add(planar.Contact("touch", *shapes, law=law))
    count = 2 * order + 1
    x = np.linspace(-0.4, 0.4, count)
    nodes = np.c_[x, 0.5 * x**2 - 0.03 * np.cos(5 * x)]
    poses = ca.vertcat(*(s.body.pose for s in beam.sections))
    (gap,) = touch.gaps(lambda s: s)
    gap = ca.Function("gap", [poses, system.ground.pose], [gap.distance])
    xi, curve = np.linspace(0, 1, 4001), []
    for e in range(2):
        corners = nodes[e * order : (e + 1) * order + 1]
        curve.append(beam.shapes.values(xi) @ corners)
    nearest = np.linalg.norm(np.vstack(curve) - place, axis=1).min()
    poses = np.c_[nodes, np.zeros(count)].ravel()
    assert float(gap(poses, 0)) == pytest.approx(nearest - 0.03, abs=1e-6)


def falling() -> da.System:
    """A free strip that falls on a small free disc, and on another strip across it."""
    system = da.System("strips")
    radius, k = system.parameter("radius", 0.02, "m"), system.parameter("k", 2e3)
    mu = system.parameter("mu", 0.3)
    disc = planar.Body("disc", mass=0.2, inertia=1e-3, position=(0.07, 0), angular_velocity=9.0)
    disc = system.add(disc)
    start = {"position": (-0.4, 0.03), "angle": 0.0, "velocity": (0, -1.0)}
    upper = system.add(planar.Beam("upper", **STRIP, **start, elements=2, order=2))
    below = {"position": (-1.05, 0.0), "angle": 0.0}
    lower = system.add(planar.Beam("lower", **STRIP, **below, elements=2, order=1))
    law = kit.HuntCrossley(stiffness=k, damping=0.3, exponent=1)
    friction = kit.Coulomb(mu, slip_speed=0.05)
    pairs = {
        "roller": (kit.BeamSurface(upper, 0.005), kit.Circle(disc.center, radius)),
        "beams": (kit.BeamSurface(lower, 0.02), kit.BeamLine(upper, 0.01)),
    }
    for name, shapes in pairs.items():
        system.add(planar.Contact(name, *shapes, law=law, friction=friction))
    return system


def test_forces_on_a_roller_and_between_beams_are_opposite():
    system = falling()
    model = system.build()
    e, start = model.equations, model.start
    rng = np.random.default_rng(5)
    for name in ("roller", "beams"):
        touch = system.elements[name]
        parts = touch.parts()
        pose, twist = (ca.vertcat(*(getattr(b, n) for b in parts)) for n in ("pose", "twist"))
        pairs = touch.powers(lambda s, pose=pose, twist=twist: ca.jtimes(s, pose, twist))
        velocity, effort = (ca.vertcat(*column) for column in zip(*pairs, strict=True))
        force = ca.mtimes(ca.jacobian(velocity, twist).T, effort)
        free = [s for s in ca.symvar(force) if s.name() in model.parameters]
        values = [float(model.parameters[s.name()].value) for s in free]
        forces = ca.Function("f", [pose, twist, ca.vertcat(*free)], [force])
        y = ca.Function("y", [e.y], [pose])(start.y).full().reshape(-1, 3)
        y[:, 1] += np.where([b.name.startswith("upper") for b in parts], -0.012, 0.0)
        y += 0.003 * rng.standard_normal(y.shape)
        f = forces(y.ravel(), rng.standard_normal(y.size), values).full().reshape(-1, 3)
        assert np.abs(f).max() > 0.1, name
        np.testing.assert_allclose(f[:, :2].sum(axis=0), 0.0, atol=1e-10)
        moments = y[:, 0] * f[:, 1] - y[:, 1] * f[:, 0] + f[:, 2]
        assert moments.sum() == pytest.approx(0.0, abs=1e-10)


@pytest.mark.thorough
def test_energy_and_gradients():
    model = falling().build()
    integrator = da.DormandPrince853(rtol=1e-10, atol=1e-12)
    responses = [
        da.final("disc.angular_velocity"),
        da.final("upper.end.y"),
        da.final("lower.end.y"),
    ]
    motion = da.solve_dynamics(model, 0.04, integrator=integrator)
    assert motion["roller.force"].max() > 1.0 and motion["beams.force"].max() > 0.1
    assert np.abs(motion.data.balance_error).max() < 1e-7
    direct, adjoint = (
        da.sensitivity(motion, responses, method=m).values for m in ("direct", "adjoint")
    )
    size = np.abs(direct).max(axis=0)
    assert size.min() > 0 and np.max(np.abs(direct - adjoint) / size) < 1e-9
    for k, name in enumerate(model.parameters):
        nominal, ends = float(model.parameters[name].value), []
        for sign in (1, -1):
            moved = {name: nominal * (1 + 1e-4 * sign)}
            run = da.solve_dynamics(model, 0.04, integrator=integrator, parameters=moved)
            ends.append(np.array([run[r.measure].values[-1] for r in responses]))
        slope = (ends[0] - ends[1]) / (2e-4 * nominal)
        assert np.max(np.abs(direct[:, k] - slope)) < 1e-4 * size[k], name


@pytest.mark.thorough
def test_a_ball_on_a_spatial_cantilever():
    system = da.System("ball on a cantilever", gravity=(0, 0, -10))
    rigid = {"axial_rigidity": 1e6, "shear_rigidity": 1e6, "torsional_rigidity": 1e3}
    rigid |= {"bending_rigidity_y": 1e3, "bending_rigidity_z": 1e3}
    arm = spatial.Beam("arm", system.ground.frame(), length=1.0, **rigid, elements=2)
    ball = system.add(spatial.Particle("ball", mass=0.3, position=(0.5, 0, 0.019)))
    for k, axis in enumerate(((1, 0, 0), (0, 1, 0))):
        side = system.ground.frame((0.5, 0, 0), axis=axis)
        system.add(spatial.PointOnPlane(f"side{k}", side, ball.center))
    shapes = solid.BeamSurface(system.add(arm)), solid.Sphere(ball.center, 0.02)
    system.add(spatial.Contact("touch", *shapes, law=solid.KelvinVoigt(stiffness=1e5)))
    rest = da.solve_equilibrium(system.build())
    deflection = 3 * (0.5**3 / 3e3 + 0.5 / 1e6)
    assert rest["ball.z"].item() == pytest.approx(0.02 - 3 / 1e5 - deflection, abs=1e-7)


def test_invalid_surfaces_are_refused():
    system = da.System("refused")
    beam = system.add(planar.Beam("strip", **STRIP, position=(0, 0)))
    law = kit.KelvinVoigt(stiffness=1e3)
    with pytest.raises(da.ModelError, match="BeamSurface: beam must be a beam"):
        kit.BeamSurface(system.ground)
    surface, floor = kit.BeamSurface(beam), kit.HalfPlane(system.ground.center)
    with pytest.raises(da.ModelError, match="no contact of HalfPlane and BeamSurface"):
        planar.Contact("c", floor, surface, law=law)
    with pytest.raises(da.ModelError, match="ties strip to itself"):
        planar.Contact("c", surface, kit.BeamLine(beam), law=law)


@pytest.mark.parametrize("stations", [1, 2])
@pytest.mark.parametrize("other", ["surface", "ball"])
def test_shapes_that_may_pass_between_stations_are_warned_about(other, stations):
    system = da.System("crossing")
    rigidities = dict.fromkeys(("axial_rigidity", "shear_rigidity", "torsional_rigidity"), 1e6)
    rigidities |= {"bending_rigidity_y": 10.0, "bending_rigidity_z": 10.0, "elements": 5}
    ground = system.ground
    beam, rail = (
        system.add(spatial.Beam(name, ground.frame(place), length=0.5, **rigidities))
        for name, place in (("beam", (0.0, 0.0, 0.0)), ("rail", (0.0, 0.2, 0.0)))
    )
    shapes = {"surface": solid.BeamSurface(rail, 0.02), "ball": solid.Sphere(rail.end, 0.02)}
    line = solid.BeamLine(beam, 0.01, stations=stations)
    law = solid.KelvinVoigt(stiffness=1e3)
    system.add(spatial.Contact("touch", shapes[other], line, law=law))
    warnings = [
        text for text in system.build().diagnosis.element_warnings if "between them" in text
    ]
    assert len(warnings) == (stations == 1)
    assert all("0.1 m apart" in text and "0.06 m across" in text for text in warnings)
