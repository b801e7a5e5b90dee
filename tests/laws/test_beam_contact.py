"""Contact of beams along their length: gaps, virtual work, energy, gradients, files, refusals."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements.contact.beam_line import BeamLine
from dalembert.elements.flexible.nodes import gauss
from dalembert.errors import BudgetError
from dalembert.io import load

kit, solid = planar.contact, spatial.contact
STRIP = {
    "length": 0.8,
    "axial_rigidity": 300.0,
    "shear_rigidity": 120.0,
    "bending_rigidity": 2.0,
    "mass_per_length": 0.7,
}
RAIL = {name: STRIP[name] for name in STRIP if name != "bending_rigidity"} | {
    "torsional_rigidity": 1.5,
    "bending_rigidity_y": 2.0,
    "bending_rigidity_z": 1.2,
}
LAW = kit.HuntCrossley(stiffness=2e4, damping=0.3)


def strip(system: da.System, elements: int = 2, order: int = 2, **start):
    beam = planar.Beam("strip", **STRIP, **start, elements=elements, order=order)
    return system.add(beam)


def on_disc() -> da.System:
    """A free strip that falls on a free disc, with friction; its numbers are parameters."""
    system = da.System("strip on a disc")
    radius, k = system.parameter("radius", 0.1, "m"), system.parameter("k", 2e4)
    mu, length = system.parameter("mu", 0.3), system.parameter("length", 0.8, "m")
    disc = planar.Body("disc", mass=1.0, inertia=0.01, position=(0.03, 0), angular_velocity=9.0)
    disc = system.add(disc)
    place = {"position": (-0.4, 0.11), "angle": 0.0, "velocity": (0, -1.5)}
    numbers = STRIP | {"length": length}
    beam = planar.Beam("strip", **numbers, **place, elements=2, order=2)
    line = kit.BeamLine(system.add(beam), radius=0.005, stations=3)
    law = kit.HuntCrossley(stiffness=k, damping=0.3, exponent=1)
    friction = kit.Coulomb(mu, slip_speed=0.05)
    shapes = kit.Circle(disc.center, radius), line
    system.add(planar.Contact("touch", *shapes, law=law, friction=friction))
    return system


# gaps ----------------------------------------------------------------------------------------
@pytest.mark.few(1)
@pytest.mark.parametrize("stations", [None, 1, 4])
def test_gaps_of_a_straight_strip_are_distances_of_its_stations(stations):
    system = da.System("gaps")
    start, angle = np.array([-0.3, 0.2]), 0.4
    beam = strip(system, position=start, angle=angle)
    line = kit.BeamLine(beam, radius=0.01, stations=stations)
    corners = [(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)]
    shapes = {
        "plane": kit.HalfPlane(system.ground.point(0, 0.1), (3, 4)),
        "disc": kit.Circle(system.ground.point(0.1, 0), 0.05),
        "bore": kit.Bore(system.ground.center, 2.0),
        "polygon": kit.Polygon(system.ground, corners),
    }
    for name, shape in shapes.items():
        system.add(planar.Contact(name, shape, line, law=LAW))
    model = system.build()
    count = stations or 2
    along = np.concatenate([(e + gauss(count)[0]) * 0.4 for e in range(2)])
    places = start + along[:, None] * (np.cos(angle), np.sin(angle))
    beyond = np.abs(places) - (0.3, 0.2)
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    expected = {
        "plane": (places - (0, 0.1)) @ (0.6, 0.8),
        "disc": np.linalg.norm(places - (0.1, 0), axis=1) - 0.05,
        "bore": 2.0 - np.linalg.norm(places, axis=1),
        "polygon": outside + np.minimum(beyond.max(axis=1), 0),
    }
    e, begin = model.equations, model.start
    for name, distances in expected.items():
        measures = [model[f"{name}.gap{k + 1}"].sx for k in range(2 * count)]
        gaps = ca.Function("gaps", [e.y, e.p], [ca.vertcat(*measures)])(begin.y, model.nominal)
        np.testing.assert_allclose(gaps.full().ravel(), distances - 0.01, atol=1e-12)


# forces --------------------------------------------------------------------------------------
def test_forces_on_a_bent_strip_and_a_disc_are_opposite():
    """The resultants and moments of the generalised forces by nodes and of the disc vanish."""
    system = da.System("pair")
    disc = system.add(planar.Body("disc", mass=1.0, inertia=1.0))
    line = kit.BeamLine(strip(system, position=(0, 0)), radius=0.02)
    friction = kit.Coulomb(0.4, slip_speed=0.1)
    touch = planar.Contact("c", kit.Circle(disc.center, 0.3), line, law=LAW, friction=friction)
    touch = system.add(touch)
    parts = touch.parts()
    pose, twist = (ca.vertcat(*(getattr(b, n) for b in parts)) for n in ("pose", "twist"))
    pairs = touch.powers(lambda s: ca.jtimes(s, pose, twist))
    velocity, effort = (ca.vertcat(*column) for column in zip(*pairs, strict=True))
    forces = ca.Function("f", [pose, twist], [ca.mtimes(ca.jacobian(velocity, twist).T, effort)])
    rng = np.random.default_rng(3)
    nodes = np.c_[np.linspace(-0.4, 0.4, 5), 0.3 + 0.02 * rng.standard_normal(5), rng.random(5)]
    y = np.vstack([[0.01, 0.02, 0.3], nodes])
    v = rng.standard_normal(y.shape)
    f = forces(y.ravel(), v.ravel()).full().reshape(-1, 3)
    assert np.abs(f[0]).min() > 1e-3
    np.testing.assert_allclose(f[:, :2].sum(axis=0), 0.0, atol=1e-11)
    moments = y[:, 0] * f[:, 1] - y[:, 1] * f[:, 0] + f[:, 2]
    assert moments.sum() == pytest.approx(0.0, abs=1e-11)


def test_energy_is_balanced_and_linear_momentum_is_constant():
    model = on_disc().build()
    motion = da.solve_dynamics(model, 0.06, integrator=da.DormandPrince(rtol=1e-9, atol=1e-11))
    assert motion.status.success
    assert motion["touch.force"].max() > 1.0 and np.abs(motion["touch.friction_force"]).max() > 0.3
    assert np.abs(motion.data.balance_error).max() < 1e-7
    mass = 0.7 * 0.8 * np.array([1, 4, 2, 4, 1]) / 12  # Simpson's rule integrates the polynomials
    names = ["strip.start", *(f"strip.node{k}" for k in (1, 2, 3)), "strip.end"]
    momentum = 1.0 * motion["disc.velocity"].values
    for m, name in zip(mass, names, strict=True):
        momentum = momentum + m * motion[f"{name}.velocity"].values
    np.testing.assert_allclose(momentum, [[0.0, -0.84]] * len(momentum), atol=1e-8)


@pytest.mark.thorough
def test_a_strip_comes_to_rest_on_rigid_stations():
    system = da.System("strip", gravity=(0, -10))
    rigid = {"axial_rigidity": 1e4, "shear_rigidity": 4e3, "bending_rigidity": 1.0}
    place = {"position": (0, 0.02), "angle": 0.05, "velocity": (0.3, 0)}
    strip = {"length": 1.0, "mass_per_length": 3.0, "elements": 4, "order": 1, "damping": 1e-3}
    line = kit.BeamLine(system.add(planar.Beam("strip", **strip, **rigid, **place)), radius=0.01)
    floor, friction = kit.HalfPlane(system.ground.center), kit.Coulomb(0.3)
    law = kit.Restitution(0.0)
    system.add(planar.Contact("touch", floor, line, law=law, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3)
    assert motion.status.success
    gaps = np.array([motion[f"touch.gap{k}"].values for k in range(4)])
    np.testing.assert_allclose(gaps[:, -1], 0.0, atol=1e-9)
    assert abs(motion["strip.start.vx"].values[-1]) < 1e-4  # of 0.3, stopped by friction


def test_coarse_steps_of_a_stiff_beam_are_warned_about():
    """The runs that estimate the error may diverge, without warnings of NumPy."""
    system = da.System("strip", gravity=(0, -9.81))
    rigid = {"axial_rigidity": 2e4, "shear_rigidity": 8e3, "bending_rigidity": 5.0}
    place = {"position": (0, 0.5), "angle": 0.1, "velocity": (0.5, 0)}
    strip = {"length": 1.0, "mass_per_length": 1.0, "elements": 4, "damping": 1e-3}
    line = kit.BeamLine(system.add(planar.Beam("strip", **strip, **rigid, **place)), radius=0.01)
    law, friction = kit.Restitution(0.5), kit.Coulomb(0.3)
    floor = kit.HalfPlane(system.ground.center)
    system.add(planar.Contact("touch", floor, line, law=law, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=2e-2, integrator=da.MoreauJean())
    assert motion.status.success
    assert any("depends on the step" in t or "are long for this" in t for t in motion.warnings)


# gradients -----------------------------------------------------------------------------------
@pytest.mark.thorough
def test_direct_and_adjoint_gradients_are_those_of_the_motion():
    model = on_disc().build()
    integrator = da.DormandPrince853(rtol=1e-11, atol=1e-13)
    responses = [da.final("disc.angular_velocity"), da.final("strip.end.y"), da.final("disc.y")]
    motion = da.solve_dynamics(model, 0.03, integrator=integrator)
    direct, adjoint = (
        da.sensitivity(motion, responses, method=m).values for m in ("direct", "adjoint")
    )
    size = np.abs(direct).max(axis=0)
    assert size.min() > 0 and np.max(np.abs(direct - adjoint) / size) < 1e-9
    for k, name in enumerate(model.parameters):
        nominal, ends = float(model.parameters[name].value), []
        for sign in (1, -1):
            moved = {name: nominal * (1 + 1e-4 * sign)}
            run = da.solve_dynamics(model, 0.03, integrator=integrator, parameters=moved)
            ends.append(np.array([run[r.measure].values[-1] for r in responses]))
        slope = (ends[0] - ends[1]) / (2e-4 * nominal)
        assert np.max(np.abs(direct[:, k] - slope)) < 3e-6 * size[k], name


# space ---------------------------------------------------------------------------------------
@pytest.mark.thorough
def test_a_spatial_beam_rests_on_a_plane():
    system = da.System("beam", gravity=(0, 0, -10))
    place = {"position": (-0.4, 0, 0.0099)}
    beam = system.add(spatial.Beam("rail", **RAIL, **place, elements=2))
    floor, line = solid.HalfSpace(system.ground.frame()), solid.BeamLine(beam, radius=0.01)
    law, friction = solid.KelvinVoigt(stiffness=1e5, damping=300.0), solid.Coulomb(0.3)
    system.add(spatial.Contact("floor", floor, line, law=law, friction=friction))
    motion = da.solve_dynamics(system.build(), 0.1, step=2e-3, integrator=da.BackwardEuler())
    assert motion["floor.force"][-1].item() == pytest.approx(0.7 * 0.8 * 10, rel=1e-6)
    assert motion["floor.penetration"][-1].item() == pytest.approx(0.7 * 0.8 * 10 / 1e5, rel=1e-6)


def test_a_spatial_beam_that_hits_a_ball_keeps_energy_and_momentum():
    system = da.System("beam on a ball", gravity=(0, 0, 0))
    ball = {"mass": 1.0, "inertia": (0.004,) * 3, "angular_velocity": (3.0, 9.0, 2.0)}
    ball = system.add(spatial.Body("ball", **ball))
    place = {"position": (-0.35, 0.03, 0.112), "velocity": (0, 0.1, -1.5)}
    beam = system.add(spatial.Beam("rail", **RAIL, **place, elements=1, order=2))
    shapes = solid.Sphere(ball.center, 0.1), solid.BeamLine(beam, radius=0.01, stations=4)
    friction = solid.Coulomb(0.3, slip_speed=0.05)
    system.add(spatial.Contact("touch", *shapes, law=LAW, friction=friction))
    model = system.build()
    motion = da.solve_dynamics(model, 0.05, integrator=da.DormandPrince(rtol=1e-9, atol=1e-11))
    assert motion["touch.force"].max() > 1.0 and motion["touch.friction_force"].max() > 0.3
    assert np.abs(motion.data.balance_error).max() < 1e-7
    momentum = motion["ball.velocity"].values
    for m, name in zip((1, 4, 1), ("rail.start", "rail.node1", "rail.end"), strict=True):
        momentum = momentum + 0.56 * m / 6 * motion[f"{name}.velocity"].values
    np.testing.assert_allclose(momentum, [[0.0, 0.056, -0.84]] * len(momentum), atol=1e-8)


# files ---------------------------------------------------------------------------------------
FILE = """\
format = 1
[beams.strip]
length = 0.8
axial_rigidity = 300
shear_rigidity = 120
bending_rigidity = 2
mass_per_length = 0.7
position = [0, 0.02]
angle = 0
[forces.touch]
type = "Contact"
shape_i = { type = "HalfPlane", point = "ground" }
shape_j = { type = "BeamLine", beam = "strip", radius = 0.02, stations = 2 }
law = { type = "KelvinVoigt", stiffness = 1e4 }
"""


def test_a_file_names_the_beam(tmp_path):
    path = tmp_path / "strip.toml"
    path.write_text(FILE, encoding="utf-8")
    system = load(path)
    line = system.elements["touch"].shape_j
    assert isinstance(line, BeamLine) and line.beam is system.elements["strip"]
    assert len(line.spots()) == 8
    path.write_text(FILE.replace('beam = "strip"', 'beam = "strap"'), encoding="utf-8")
    with pytest.raises(da.ModelError, match=r"unknown beam 'strap'.*strip"):
        load(path)


# refusals ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda s, b: kit.BeamLine(s.ground), "beam must be a beam"),
        (lambda s, b: kit.BeamLine(b, stations=0), "stations is 0; give a whole number from 1"),
        (lambda s, b: kit.BeamLine(b, stations=True), "stations is True"),
        (lambda s, b: kit.BeamLine(b, stations=10**9), "stations on strip.*give fewer"),
        (lambda s, b: kit.BeamLine(b, radius=-0.1), "line.radius|shape_j.radius"),
        (lambda s, b: kit.BeamLine(b, radius=float("nan")), "radius"),
    ],
)
def test_invalid_lines_are_refused(make, message):
    system = da.System("refused")
    beam = strip(system, position=(0, 0))

    def build() -> None:
        floor, line = kit.HalfPlane(system.ground.center), make(system, beam)
        system.add(planar.Contact("c", floor, line, law=LAW))
        system.build()

    with pytest.raises((da.ModelError, BudgetError), match=message):
        build()


def test_pairs_without_contact_are_refused():
    system = da.System("refused")
    beam = strip(system, position=(0, 0))
    line = kit.BeamLine(beam)
    with pytest.raises(da.ModelError, match="ties strip to itself"):
        planar.Contact("c", line, kit.BeamLine(beam), law=LAW)
    with pytest.raises(da.ModelError, match="no contact of Vertex and BeamLine"):
        planar.Contact("c", system.ground.center, line, law=LAW)
    ball = solid.Sphere(system.ground.point(0, 0, 0), 0.1)
    with pytest.raises(da.ModelError, match="lies in a plane"):
        planar.Contact("c", ball, line, law=LAW)
