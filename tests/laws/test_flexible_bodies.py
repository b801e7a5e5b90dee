"""Flexible bodies are their finite elements, seen from a frame that floats with them."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from flexible_bodies import KINDS, beam, block, flexible

import dalembert as da
from dalembert import planar, spatial
from dalembert.model.assembled.reduction.rigid import node_positions
from dalembert.results.pictures.picture import pose_of
from dalembert.results.pictures.scene import motion_scene

SPACES = pytest.mark.parametrize("dimension", [2, 3])
BOTH = pytest.mark.parametrize("stiffening", [False, True])


def state(body, seed: int = 0, size: float = 0.1):
    """Pose, twist at random; Euler parameters have length one."""
    rng = np.random.default_rng(seed)
    y, v = rng.normal(size=body.pose.numel()), rng.normal(size=body.twist.numel())
    y[-body.shapes.count :] *= size
    if body.dimension == 3:
        y[3:7] /= np.linalg.norm(y[3:7])
    return y, v


def values(body, y, v, *expressions):
    column = [ca.densify(e) for e in expressions]
    computed = ca.Function("f", [body.pose, body.twist], column).call([ca.DM(y), ca.DM(v)])
    return [np.array(x.full()).squeeze() for x in computed]


def nodal_velocities(body, y, v):
    """(n,) velocities of all nodes in the axes of the frame, written out."""
    d, shapes = body.dimension, body.shapes
    model = shapes.structure
    a, grown = values(
        body, y, v, body.amplitudes, ca.jtimes(body.amplitudes, body.pose, body.pose_rate)
    )
    (axes,) = values(body, y, v, body.frame_axes)
    spin = np.array([0, 0, v[2]]) if d == 2 else v[3:6]
    places = node_positions(model.blocks, model.degrees, shapes.p) - shapes.origin
    u, w = shapes.displacements @ a, shapes.displacements @ grown
    for row, place in zip(model.degrees.table, places, strict=True):
        arm = np.zeros(3)
        arm[:d] = place + u[row[:d]]
        w[row[:d]] += axes.T @ v[:d] + np.cross(spin, arm)[:d]
        w[row[d:]] += spin[-1:] if d == 2 else spin
    return w


def energies(body, size: float) -> tuple[float, float]:
    """Kinetic energy of a random motion, and that of the finite elements."""
    y, v = state(body, size=size)
    v[-body.shapes.count :] *= size
    mass, _ = values(body, y, v, *body.inertia_by_speeds())
    w, model = nodal_velocities(body, y, v), body.shapes.structure
    return v @ mass @ v / 2, w @ (model.assembly.mass(model.nominal) @ w) / 2


@SPACES
def test_kinetic_energy_is_that_of_the_finite_elements(dimension):
    computed, expected = energies(flexible(dimension), 0.1)
    assert computed == pytest.approx(expected, rel=1e-12)


@pytest.mark.few(1)
@SPACES
def test_kinetic_energy_with_stiffening_is_so_to_the_second_order(dimension):
    body = flexible(dimension, stiffening=True)
    errors = [abs(np.subtract(*energies(body, size))) for size in (0.02, 0.01)]
    assert errors[0] / errors[1] == pytest.approx(8.0, rel=0.2)


@SPACES
@BOTH
def test_free_motion_keeps_energy_and_momenta(dimension, stiffening):
    """Of ``M v̇ + d = 0``, which is without elastic forces: they do not change momenta."""
    body = flexible(dimension, stiffening=stiffening)
    mass, bias = body.inertia_by_speeds()
    momentum = ca.mtimes(mass, body.twist)
    acceleration = ca.solve(mass, -bias)
    energy = ca.dot(body.twist, momentum) / 2
    linear, arm = momentum[:dimension], body.pose[:dimension]
    if dimension == 2:
        angular = momentum[2] + arm[0] * linear[1] - arm[1] * linear[0]
    else:
        angular = body.turned(momentum[3:6]) + ca.cross(arm, linear)
    conserved = ca.vertcat(energy, linear, angular)
    change = ca.jtimes(
        conserved, ca.vertcat(body.pose, body.twist), ca.vertcat(body.pose_rate, acceleration)
    )
    computed, size = values(body, *state(body), change, conserved)
    assert np.abs(computed).max() < 1e-10 * np.abs(size).max()


@SPACES
@BOTH
def test_mass_centre_moves_with_the_momentum(dimension, stiffening):
    """Of solid elements, which interpolate any rigid motion of what is displaced."""
    structure, ends = block(dimension)
    body = flexible(dimension, structure, interface=ends, stiffening=stiffening)
    y, v = state(body)
    velocity = ca.jtimes(body.mass_center, body.pose, body.pose_rate)
    mass, moved = values(body, y, v, body.inertia_by_speeds()[0], velocity)
    np.testing.assert_allclose((mass @ v)[:dimension], body.shapes.total_mass * moved, rtol=1e-10)


@SPACES
def test_clamped_body_vibrates_as_the_full_structure(dimension):
    """Frequencies in the retained band, against modes of the finite elements."""
    options = {"interface": {"root": "n0", "tip": "n12"}, "modes": 6}
    body = flexible(dimension, beam(dimension, 12), **options)
    modes = da.solve_modes(beam(dimension, 12, clamped=True), 4)
    expected = 2 * np.pi * modes.frequencies[:4]
    np.testing.assert_allclose(body.shapes.frequencies[:4], expected, rtol=1e-3)


@pytest.mark.few(1)
@SPACES
def test_sags_as_the_full_structure(dimension):
    """Equilibrium of a clamped body under gravity, against statics of the finite elements."""
    gravity = (0.0, -1.0, 0.4)[:dimension]
    system = da.System("sag", gravity=gravity)
    body = system.add(flexible(dimension, modes=20, position=(0.0,) * dimension))
    hold = planar.Weld if dimension == 2 else spatial.Weld
    ground = system.ground.center if dimension == 2 else system.ground.frame()
    system.add(hold("clamp", ground, body.point("root")))
    equilibrium = da.solve_equilibrium(system.build())
    sag = da.solve_statics(beam(dimension, clamped=True, gravity=gravity))
    expected = [float(sag[f"n4.{u}"]) for u in ("ux", "uy", "uz")[:dimension]]
    deflection = np.ravel(equilibrium["rod.tip.deflection"])
    np.testing.assert_allclose(deflection, expected, rtol=1e-6, atol=1e-12)


@pytest.mark.few(1)
@SPACES
def test_stiff_body_moves_as_a_rigid_one(dimension):
    stiff = beam(dimension, modulus=2e13)
    place = (0.0,) * dimension
    ends = []
    for kind in ("flexible", "rigid"):
        system = da.System(kind, gravity=(0.3, -9.81, 0.5)[:dimension])
        rod = flexible(dimension, stiff, modes=0, position=place)
        if kind == "rigid":
            rod = _rigid(rod, dimension)
        system.add(rod)
        pin = planar.Revolute if dimension == 2 else spatial.Spherical
        system.add(pin("pin", system.ground.point(*place), rod.point("root")))
        options = {"duration": 0.2, "step": 0.02, "integrator": da.Radau(fixed=True)}
        motion = da.solve_dynamics(system.build(), **options)
        ends.append(motion["rod.tip.position"].values[-1])
    np.testing.assert_allclose(*ends, atol=2e-5)


def _rigid(flexible, dimension: int):
    """The rigid body of the same inertia."""
    shapes = flexible.shapes
    d, n, mass = dimension, shapes.rotations, shapes.total_mass
    (center,) = values(flexible, *state(flexible, size=0.0), flexible._centre())
    about = shapes.inertia[d : d + n, d : d + n]
    points = {k: s.place - (center if d == 2 else 0) for k, s in shapes.sections.items()}
    if d == 2:
        inertia = about.item() - mass * center @ center
        return planar.Body("rod", mass, inertia, position=center, angle=0.0, points=points)
    inertia = about - mass * (center @ center * np.eye(3) - np.outer(center, center))
    arguments = {"center_of_mass": center, "position": np.zeros(3), "rotation": np.eye(3)}
    return spatial.Body("rod", mass, inertia, points=points, **arguments)


@pytest.mark.few(1)
@SPACES
def test_frames_give_one_motion(dimension):
    """A frame fixed in an end and mean axes differ by the square of the displacements."""
    apart = [_apart(dimension, speed) for speed in (0.4, 0.2)]
    assert apart[0] / apart[1] > 3.5
    assert apart[0] < 1e-3


def _apart(dimension: int, speed: float) -> float:
    """Largest distance of the tips of two free bodies that a blow sets in motion."""
    results = []
    for frame in ("root", "mean"):
        system = da.System("free")
        body = flexible(dimension, reference=frame, modes=0, **_placed(frame, dimension))
        system.add(body)
        push = tuple(speed * x for x in (0.3, 1.0, 0.5)[:dimension])
        force = [p * da.sin(np.pi * da.t / 0.1) for p in push]
        kind = KINDS[dimension].Force
        system.add(kind("push", body.point("tip"), force))
        options = {"duration": 0.05, "step": 2.5e-4, "outputs": 11}
        motion = da.solve_dynamics(system.build(), **options)
        results.append(motion["rod.tip.position"].values)
    return float(np.abs(results[0] - results[1]).max())


def _placed(frame: str, dimension: int) -> dict:
    at = np.zeros(dimension)
    if frame == "mean":
        at = beam(dimension).floating({"root": "n0", "tip": "n4"}, 0, frame="mean").origin
    turned = {"angle": 0.0} if dimension == 2 else {"rotation": np.eye(3)}
    return {"position": at, **turned}


@pytest.mark.few(1)
@SPACES
def test_free_body_keeps_its_energy(dimension):
    system = da.System("free")
    spin = {"angular_velocity": 3.0} if dimension == 2 else {"angular_velocity": (3.0, 1.0, 2.0)}
    body = system.add(flexible(dimension, reference="mean", modes=0, **spin))
    system.initial(body.q1, 0.02)
    motion = da.solve_dynamics(system.build(), 0.2, step=1e-4, outputs=21)
    assert np.abs(motion["energy"] - motion["energy"][0]).max() < 1e-6 * float(motion["energy"][0])


@pytest.mark.thorough
@SPACES
def test_gradients_pass_through_it(dimension):
    """Direct, adjoint and differences, by what holds it, damps it and moves it."""
    system = da.System("swing", gravity=(0.0, -9.81, 0.0)[:dimension])
    stiffness = system.parameter("k", 30.0)
    ratio, place = system.parameter("ratio", 0.05), system.parameter("x", 0.1)
    at = (place, 0.0, 0.0)[:dimension]
    turned = {"angle": 0.0} if dimension == 2 else {"rotation": np.eye(3)}
    soft = beam(dimension, modulus=2e7)
    body = system.add(
        flexible(dimension, soft, modes=0, position=at, damping_ratio=ratio, **turned)
    )
    pin = planar.Revolute if dimension == 2 else spatial.Spherical
    system.add(pin("pin", system.ground.point(*at), body.point("root")))
    anchor = system.ground.point(*(1.0, 0.5, 0.2)[:dimension])
    spring = KINDS[dimension].Spring
    system.add(spring("spring", anchor, body.point("tip"), stiffness=stiffness))
    motion = da.solve_dynamics(system.build(), 0.02, step=5e-4, integrator=da.RK4())
    tip = da.final("rod.tip.y")
    computed = [
        da.sensitivity(motion, tip, method=method).values.ravel()
        for method in ("direct", "adjoint", "finite-difference")
    ]
    np.testing.assert_allclose(computed[1], computed[0], rtol=1e-8, atol=1e-13)
    np.testing.assert_allclose(computed[2], computed[0], rtol=1e-5, atol=1e-9)


def test_the_structure_is_recovered():
    """A clamped beam that gravity bends, damped until it rests, has the moments of statics."""
    gravity, soft = (0.0, -1.0), {"count": 2, "modulus": 2e8}
    system = da.System("sag", gravity=gravity)
    options = {"position": (0.0, 0.0), "damping_ratio": 1.0, "modes": 6}
    body = system.add(flexible(2, beam(2, **soft), interface={"root": "n0"}, **options))
    system.add(planar.Weld("clamp", system.ground.center, body.point("root")))
    motion = da.solve_dynamics(system.build(), 4.0, step=0.5, integrator=da.Radau(fixed=True))
    structure = motion.structure("rod")
    statics = da.solve_statics(beam(2, clamped=True, gravity=gravity, **soft))
    np.testing.assert_allclose(
        structure.displacements[:, -1], statics.displacements[:, 0], rtol=1e-6
    )
    for end in "ij":
        moment = float(statics[f"e0.moment_{end}"])
        assert float(structure[f"e0.moment_{end}"][-1]) == pytest.approx(moment, rel=1e-6)
    with pytest.raises(da.AnalysisError, match="no flexible body 'rot'"):
        motion.structure("rot")


WRONG = [
    ({"interface": {}}, "needs an interface"),
    ({"interface": ["nowhere"]}, "unknown node 'nowhere'"),
    ({"interface": {"a": "n0", "b": ["n0", "n1"]}}, "which another interface holds too"),
    ({"reference": "middle"}, "unknown frame 'middle'"),
    ({"reference": "mean", "stiffening": True}, "second-order displacements need a frame"),
    ({"parameters": {"F": 1.0}}, "F"),
    ({"modes": -1}, "modes must be a number of modes; got -1"),
    ({"up_to": 0.0}, "up_to must be a frequency"),
    ({"reference": 3}, "name of an interface or 'mean'"),
    ({"structure": "beam"}, "must be a model of nodes and finite"),
]


@pytest.mark.parametrize(("options", "message"), WRONG)
def test_invalid_arguments_are_refused(options, message):
    with pytest.raises(da.ModelError, match=message):
        flexible(2, **options)


def test_too_small_interfaces_are_refused():
    """One node of solid elements does not turn, two do not tell of a frame in one of them."""
    structure, ends = block(2)
    corners = {name: nodes[0] for name, nodes in ends.items()}
    with pytest.raises(da.ModelError, match="with the interfaces at rest the structure is a mech"):
        flexible(2, structure, interface={"root": corners["root"]}, reference="mean")
    with pytest.raises(da.ModelError, match="'root' does not turn"):
        flexible(2, structure, interface=corners)


def test_supports_are_refused():
    with pytest.raises(da.ModelError, match=r"rod: .*has supports"):
        flexible(2, beam(2, clamped=True))


def test_one_name_for_two_parameters_is_refused():
    system = da.System("x")
    system.parameter("E", 1e9)
    system.add(flexible(2))
    with pytest.raises(da.ModelError, match="parameter 'E' of its structure"):
        system.build()


def test_mean_axes_hold_no_joint():
    system = da.System("x")
    body = system.add(flexible(2, reference="mean"))
    with pytest.raises(da.ModelError, match="not fixed to its material"):
        system.add(planar.Revolute("pin", system.ground.center, body))


def test_moves_as_the_full_structure():
    """A clamped beam under a sudden force, against implicit dynamics of the finite elements."""
    full, force = beam(2, 12, clamped=True).structure, (0.0, 0.02)
    full.load(full.nodes["n12"], fx=force[0], fy=force[1])
    fine = da.solve_transient(full.build(), 0.3, step=2e-4, outputs=301)
    expected = np.column_stack([fine["n12.ux"].values, fine["n12.uy"].values])
    system = da.System("clamped")
    ends = {"root": "n0", "tip": "n12"}
    body = flexible(2, beam(2, 12), interface=ends, modes=2, position=(0.0, 0.0))
    system.add(body)
    system.add(planar.Weld("clamp", system.ground.center, body.point("root")))
    system.add(planar.Force("force", body.point("tip"), force))
    options = {"step": 1e-3, "outputs": 301, "integrator": da.Radau(fixed=True)}
    motion = da.solve_dynamics(system.build(), 0.3, **options)
    apart = motion["rod.tip.deflection"].values - expected
    assert np.abs(apart).max() < 0.01 * np.abs(expected).max()


@pytest.mark.few(1)
@SPACES
def test_drawings_show_it_deformed(dimension):
    """Pieces in a row, from section to section."""
    system = da.System("picture")
    body = system.add(flexible(dimension, position=(0.3,) * dimension))
    system.initial(body.q1, 0.2)
    motion = da.solve_dynamics(system.build(), 1e-6, step=1e-6)
    scene = motion_scene(motion, np.arange(2))
    poses = {b["name"]: pose_of(b) for b in scene["bodies"]}
    pieces = [b for b in scene["bodies"] if b.get("of") == "rod" and b["shapes"]]
    assert len(pieces) == 4
    ends = [motion[f"rod.{end}.position"].values for end in ("root", "tip")]
    np.testing.assert_allclose(poses["rod/1"][1], ends[0], atol=1e-12)
    np.testing.assert_allclose(poses["rod.tip"][1], ends[1], atol=1e-12)
    turn, place = poses["rod/4"]
    reached = place + turn[:, :, 0] * pieces[-1]["shapes"][0]["to"][0]
    np.testing.assert_allclose(reached, ends[1], atol=0.02)  # a piece keeps its length
