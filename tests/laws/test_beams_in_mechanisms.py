"""Geometrically exact beams: strains know no rigid motion, inertia is that of the rigid bar,
elements converge by their order, gradients and energies are exact."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from thorough import crossed

import dalembert as da
from dalembert import planar, spatial

PLANE = {
    "length": 0.8,
    "curvature": 0.4,
    "axial_rigidity": 300.0,
    "shear_rigidity": 120.0,
    "bending_rigidity": 2.0,
    "mass_per_length": 0.7,
    "rotary_inertia": 0.01,
}
SPACE = {name: PLANE[name] for name in ("length", "curvature", "axial_rigidity")} | {
    "shear_rigidity": 120.0,
    "shear_rigidity_z": 90.0,
    "torsional_rigidity": 1.5,
    "bending_rigidity_y": 2.0,
    "bending_rigidity_z": 1.2,
    "mass_per_length": 0.7,
}
MESHES = [(1, 1), (2, 2), (1, 3)]


def free(dimension: int, elements: int, order: int, **more) -> da.System:
    """A beam that touches nothing, whose numbers are parameters."""
    system = da.System("free")
    numbers = {n: system.parameter(n, v) for n, v in (PLANE if dimension == 2 else SPACE).items()}
    if dimension == 2:
        start = {"position": (0.1, -0.3), "angle": 0.5, "angular_velocity": 1.2}
        system.add(planar.Beam("arm", **numbers, **start, elements=elements, order=order, **more))
        return system
    inertia = tuple(system.parameter(f"J{k}", v) for k, v in enumerate((0.03, 0.02, 0.015)))
    start = {
        "position": (0.1, -0.3, 0.2),
        "rotation": da.rotation.axis_angle((0.2, -0.4, 1.0), 0.7),
        "angular_velocity": (0.5, -0.7, 1.1),
        "velocity": (0.2, 0.1, -0.3),
    }
    arguments = numbers | {"rotary_inertia": inertia} | start
    system.add(spatial.Beam("arm", **arguments, elements=elements, order=order, **more))
    return system


@functools.cache
def free_model(dimension: int, elements: int, order: int) -> da.Model:
    return free(dimension, elements, order).build()


def bent(model: da.Model, size: float = 0.15) -> np.ndarray:
    """A position with all strains."""
    e, rng = model.equations, np.random.default_rng(4)
    return e.manifold.go(model.start.y, size * rng.standard_normal(e.speed_count))


@pytest.mark.few(2)
@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("dimension", [2, 3])
def test_it_starts_free_of_strain_and_moves_as_one(dimension, mesh):
    model = free_model(dimension, *mesh)
    e, s, p = model.equations, model.start, model.nominal
    stored = ca.Function("V", [e.t, e.y, e.p], [e.potential])
    assert float(stored(0, s.y, p)) == pytest.approx(0.0, abs=1e-24)
    rates = ca.Function("dV", [e.t, e.y, e.v, e.p], [e.rate(ca.gradient(e.potential, e.y))])
    np.testing.assert_allclose(rates(0, s.y, s.v, p).full(), 0.0, atol=1e-11)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("dimension", [2, 3])
def test_energy_does_not_change_when_the_whole_is_moved(dimension, mesh):
    model = free_model(dimension, *mesh)
    e, p, y = model.equations, model.nominal, bent(model)
    stored = ca.Function("V", [e.t, e.y, e.p], [e.potential])
    if dimension == 2:
        c, s, places = np.cos(2.3), np.sin(2.3), y.reshape(-1, 3)
        moved = np.c_[places[:, :2] @ np.array([[c, -s], [s, c]]).T + (3, -2), places[:, 2] + 2.3]
    else:
        turn, places = Rotation.from_rotvec((0.4, -1.9, 1.3)), y.reshape(-1, 7)
        turns = turn * Rotation.from_quat(places[:, 3:], scalar_first=True)
        there = turn.apply(places[:, :3]) + np.array([3, -2, 1])
        moved = np.c_[there, turns.as_quat(scalar_first=True)]
    before, after = (float(stored(0, x, p)) for x in (y, moved.ravel()))
    assert before > 0.1
    assert after == pytest.approx(before, rel=1e-11)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("dimension", [2, 3])
def test_mass_is_that_of_the_rigid_bar(dimension, mesh):
    """Its kinetic energy and momenta turning about its start are those of the arc, in any place."""
    system = free(dimension, *mesh)
    system.parameters["curvature"].value = 0.0
    straight = system.build()
    e, s, p = straight.equations, straight.start, straight.nominal
    energy = ca.Function("T", [e.y, e.v, e.p], [e.kinetic_energy])
    rho, length = PLANE["mass_per_length"], PLANE["length"]
    if dimension == 2:
        about = rho * length**3 / 3 + PLANE["rotary_inertia"] * length
        expected = about * 1.2**2 / 2
        v = s.v
    else:
        turn = Rotation.from_quat(s.y[3:7], scalar_first=True)
        spin = turn.inv().apply((0.5, -0.7, 1.1))
        shift = turn.inv().apply((0.2, 0.1, -0.3))
        inertia = length * np.diag((0.03, 0.02, 0.015))
        inertia += rho * length**3 / 3 * np.diag((0.0, 1.0, 1.0))
        centre = np.array([length / 2, 0, 0])
        expected = spin @ inertia @ spin / 2 + rho * length * shift @ shift / 2
        expected += rho * length * shift @ np.cross(spin, centre)
        v = s.v
    assert float(energy(s.y, v, p)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_inertia_takes_the_power_that_energy_grows_by(dimension):
    """``vᵀ (M v̇ + d) = dT/dt`` for any accelerations, in bent positions."""
    model = free_model(dimension, 2, 2)
    e, rng = model.equations, np.random.default_rng(1)
    taken = ca.dot(e.v, ca.mtimes(e.mass, e.a) + e.bias)
    grown = ca.jtimes(e.kinetic_energy, ca.vertcat(e.y, e.v), ca.vertcat(e.pose_rate, e.a))
    function = ca.Function("powers", [e.y, e.v, e.a, e.p], [taken, grown])
    v, a = rng.standard_normal((2, e.speed_count))
    computed = [float(x) for x in function(bent(model), v, a, model.nominal)]
    assert computed[0] == pytest.approx(computed[1], rel=1e-10)


def cantilever(elements: int, order: int) -> da.Model:
    system = da.System("cantilever")
    arm = system.add(
        planar.Beam(
            "arm",
            system.ground.point(0, 0),
            length=1.0,
            axial_rigidity=1e4,
            shear_rigidity=4e3,
            bending_rigidity=1.0,
            elements=elements,
            order=order,
            mass_per_length=1.0,
        )
    )
    system.add(planar.Force("F", arm.end.center, (1.0, 3.0)))
    return system.build()


def tip(elements: int, order: int) -> float:
    return float(da.solve_equilibrium(cantilever(elements, order))["arm.end.y"].values[0])


@pytest.mark.few(1)
@pytest.mark.parametrize(("order", "meshes"), [(1, (8, 16)), (2, (4, 8)), (3, (2, 4))])
def test_deflections_converge_by_twice_the_order(order, meshes):
    exact = tip(8, 4)
    errors = [abs(tip(n, order) - exact) for n in meshes]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * order, abs=0.35)


def test_clamped_ends_are_welded_nodes():
    """A beam clamped to a hub swings as one whose own start is welded there."""
    results = []
    for clamped in (True, False):
        system = da.System("hub", gravity=(0, -9.81))
        hub = system.add(planar.Body("hub", mass=0.5, inertia=0.02, position=(0, 0), angle=0.3))
        system.add(planar.Revolute("O", system.ground.center, hub.center))
        numbers = PLANE | {"elements": 1, "order": 2}
        if clamped:
            arm = system.add(planar.Beam("arm", hub.point(0.1, 0.05), angle_i=0.2, **numbers))
        else:
            arm = system.add(planar.Beam("arm", **numbers, angle=0.5))
            system.add(planar.Weld("W", hub.point(0.1, 0.05), arm.start, angle=0.2))
        motion = da.solve_dynamics(system.build(), 0.2, step=1e-3)
        results.append([motion[f"arm.end.{q}"].values[-1] for q in ("x", "y", "angle")])
    np.testing.assert_allclose(results[0], results[1], atol=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize(("dimension", "integrator"), crossed([2, 3], [da.HHT(), da.RK4()]))
def test_gradients_are_exact(dimension, integrator):
    """Direct = adjoint = differences, by every number of a free beam with a start and a load."""
    system = free(dimension, 1, 2, damping=0.01)
    arm = system.elements["arm"]
    if dimension == 2:
        system.add(planar.Force("F", arm.end.center, (0.5, -1.0)))
    else:
        system.add(spatial.Force("F", arm.end.center, (0.5, -1.0, 0.7)))
    motion = da.solve_dynamics(system.build(), 0.05, step=1e-3, integrator=integrator)
    response = da.final("arm.end.y")
    direct, adjoint, quotients = (
        da.sensitivity(motion, response, method=m).values
        for m in ("direct", "adjoint", da.FiniteDifference())
    )
    size = np.abs(direct).max()
    np.testing.assert_allclose(adjoint, direct, rtol=1e-9, atol=1e-11 * size)
    np.testing.assert_allclose(quotients, direct, rtol=1e-5, atol=1e-7 * size)


@pytest.mark.few(1)
@pytest.mark.parametrize("dimension", [2, 3])
def test_free_beams_keep_energy_and_momenta(dimension):
    """Bent, spun and let go: no drift above 1e-8 per second."""
    model = free_model(dimension, 1, 2)
    e = model.equations
    system = free(dimension, 1, 2)
    arm = system.elements["arm"]
    pull = da.where(da.t < 0.2, 1.0, 0.0)
    if dimension == 2:
        system.add(planar.Force("F", arm.end.center, (3.0 * pull, -2.0 * pull)))
    else:
        system.add(spatial.Force("F", arm.end.center, (3.0 * pull, -2.0 * pull, pull)))
    integrator = da.DormandPrince853(rtol=1e-11, atol=1e-12)
    motion = da.solve_dynamics(system.build(), 1.2, integrator=integrator, outputs=[0.2, 1.2])
    total = motion["kinetic_energy"].values + motion["potential_energy"].values
    assert total[0] > 0.1
    assert abs(total[1] - total[0]) < 1e-8 * total[0]
    momentum = ca.Function("p", [e.y, e.v, e.p], [e.inertia.times(e.v)])
    y, v = motion.trajectory.y, motion.trajectory.v
    d = 2 if dimension == 2 else 3
    per_node = 3 if dimension == 2 else 6
    moved = [
        momentum(y[:, k], v[:, k], model.nominal).full().reshape(-1, per_node)[:, :d].sum(axis=0)
        for k in (0, 1)
    ]
    np.testing.assert_allclose(moved[1], moved[0], atol=1e-8 * np.abs(moved[0]).max())


def test_forces_inside_balance_the_load():
    equilibrium = da.solve_equilibrium(cantilever(8, 3))
    x, y, angle = (float(equilibrium[f"arm.end.{q}"].values[0]) for q in ("x", "y", "angle"))
    moment = float(equilibrium["arm.start_bending_moment"].values[0])
    assert moment == pytest.approx(3.0 * x - 1.0 * y, rel=1e-4)
    axial = float(equilibrium["arm.end_axial_force"].values[0])
    assert axial == pytest.approx(np.cos(angle) + 3 * np.sin(angle), rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"elements": 0}, "elements is 0"),
        ({"order": 7}, "order is 7"),
        ({"length": -1.0}, "arm.length: is -1 m, but it must be above 0"),
    ],
)
def test_invalid_numbers_are_refused(arguments, message):
    system = da.System("wrong")

    def build() -> None:
        system.add(planar.Beam("arm", **(PLANE | arguments)))
        system.build()

    with pytest.raises(da.ModelError, match=message):
        build()


def test_a_spatial_beam_needs_frames():
    system = da.System("wrong")
    body = system.add(spatial.Body("hub", mass=1, inertia=(1, 1, 1)))
    with pytest.raises(da.ModelError, match=r"frame_i must be a frame.*hub\.frame"):
        system.add(spatial.Beam("arm", body.point(0, 0, 0), **SPACE))


def test_joint_coordinates_have_no_tree_for_it():
    with pytest.raises(da.UnsupportedError, match=r"arm: mass between bodies.*AbsoluteCoordinates"):
        da.solve_dynamics(free_model(2, 1, 1), 0.1, coordinates=da.JointCoordinates())


def test_small_vibrations_are_those_of_the_slender_cantilever():
    """``ω = λ² √(E I/(ρ A L⁴))``, λ = 1.8751, 4.6941, 7.8548."""
    system = da.System("cantilever")
    system.add(
        planar.Beam(
            "arm",
            system.ground.center,
            length=1.0,
            axial_rigidity=1e6,
            shear_rigidity=1e6,
            bending_rigidity=1.0,
            mass_per_length=1.0,
        )
    )
    frequencies = np.sort(da.linearize(system.build()).data["frequency"].values)[:3]
    expected = np.array([1.875104, 4.694091, 7.854757]) ** 2 / (2 * np.pi)
    np.testing.assert_allclose(frequencies, expected, rtol=1e-3)


def test_a_pinned_bar_turns_by_its_momentum_exactly():
    """One stiff element of first order reaches the angle ``ω t`` of the rigid bar."""
    system = da.System("bar")
    stiff = {"axial_rigidity": 1e10, "shear_rigidity": 1e10, "bending_rigidity": 1e10}
    arm = system.add(
        planar.Beam(
            "arm",
            length=1.0,
            mass_per_length=1.0,
            rotary_inertia=1.0,
            position=(0, 0),
            angle=0.0,
            angular_velocity=1.0,
            elements=1,
            order=1,
            **stiff,
        )
    )
    system.add(planar.Revolute("O", system.ground.center, arm.start.center))
    motion = da.solve_dynamics(system.build(), 0.5, step=5e-6, outputs=[0.25, 0.5])
    np.testing.assert_allclose(motion["arm.end.angle"].values, [0.25, 0.5], atol=1e-9)
    place = np.arctan2(motion["arm.end.y"].values, motion["arm.end.x"].values)
    np.testing.assert_allclose(place, [0.25, 0.5], atol=1e-9)


def test_modes_of_a_beam_that_turns_name_what_has_them():
    """Its nodes go round in any coordinates; the shapes of a flexible body do not."""
    system = da.System("rotor")
    arm = system.add(planar.Beam("arm", **PLANE | {"curvature": 0.0}, angular_velocity=3.0))
    system.add(planar.Revolute("hub", system.ground.center, arm.start.center))
    system.add(planar.RotationalDriver("motor", system.ground, arm.start, 3.0 * da.t))
    modes = da.linearize(system.build(), equilibrium=False)
    assert any("nodes of arm go round" in w and "FlexibleBody" in w for w in modes.warnings)
