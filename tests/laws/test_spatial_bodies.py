"""Bodies in space: orientations and measures against SciPy, inertia against points of mass."""

from __future__ import annotations

import itertools
import re

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial

MOMENTS = (0.3, 0.25, 0.2, 0.02, -0.01, 0.03)
SEQUENCES = ["".join(s) for s in itertools.product("xyz", repeat=3) if s[0] != s[1] != s[2]]


def free(**arguments) -> da.Model:
    system = da.System("free")
    system.parameter("p", 0.7)
    arguments = {
        name: f(system.parameters["p"]) if callable(f) else f for name, f in arguments.items()
    }
    system.add(spatial.Body("b", **{"mass": 1.3, "inertia": MOMENTS, **arguments}))
    return system.build()


def values(model: da.Model, *formulas, y=None, v=None, a=None):
    """Formulas of the body at a state, the start if none is given."""
    e = model.all_equations
    arguments = [e.y, e.v, model.bodies[0].acceleration_symbols, e.p]
    f = ca.Function("f", arguments, [ca.densify(x.sx) for x in formulas])
    state = model.start.y if y is None else y, model.start.v if v is None else v
    computed = f.call([*state, np.zeros(6) if a is None else a, model.nominal])
    return [x.full().ravel() for x in computed]


def matrix_at(model, **state) -> np.ndarray:
    return values(model, model.bodies[0].rotation, **state)[0].reshape(3, 3)


TURNS = {
    "axis and angle": (
        lambda p: da.rotation.axis_angle((1, 2, -2), p),
        lambda p: Rotation.from_rotvec(p * np.array([1, 2, -2]) / 3),
    ),
    "formula of an axis": (
        lambda p: da.rotation.axis_angle((p, 1, 0), 0.4),
        lambda p: Rotation.from_rotvec(0.4 * np.array([p, 1, 0]) / np.hypot(p, 1)),
    ),
    "matrix of formulas": (
        lambda p: [[da.cos(p), -da.sin(p), 0], [da.sin(p), da.cos(p), 0], [0, 0, 1]],
        lambda p: Rotation.from_rotvec([0, 0, p]),
    ),
    "one after the other": (
        lambda p: da.rotation.euler("zx", p, 0.3) @ da.rotation.bryant(0.1, p, 0.2),
        lambda p: Rotation.from_euler("ZX", [p, 0.3]) * Rotation.from_euler("XYZ", [0.1, p, 0.2]),
    ),
    "SciPy": (
        lambda p: Rotation.from_rotvec([0.3, 2, 1]),
        lambda p: Rotation.from_rotvec([0.3, 2, 1]),
    ),
}


@pytest.mark.parametrize("name", TURNS)
def test_orientations_are_those_of_scipy(name):
    arguments, wanted = TURNS[name]
    np.testing.assert_allclose(
        matrix_at(free(rotation=arguments)), wanted(0.7).as_matrix(), atol=1e-14
    )


@pytest.mark.few(4)
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_about_body_axes_are_those_of_scipy(sequence):
    """Given and read back, in every quadrant."""
    rng = np.random.default_rng(4)
    for angles in rng.uniform(-3, 3, (4, 3)):
        model = free(rotation=da.rotation.euler(sequence, *angles))
        wanted = Rotation.from_euler(sequence.upper(), angles)
        np.testing.assert_allclose(matrix_at(model), wanted.as_matrix(), atol=1e-14)
        (computed,) = values(model, model.bodies[0].euler(sequence))
        np.testing.assert_allclose(computed, wanted.as_euler(sequence.upper()), atol=1e-12)
    (computed,) = values(model, model.expression("b.bryant"))
    np.testing.assert_allclose(computed, wanted.as_euler("XYZ"), atol=1e-12)


@pytest.mark.parametrize(
    ("sequence", "angles", "warning"),
    [
        ("xyz", (0.1, np.pi / 2 - 0.01, 0.2), "b: its angles xyz are 0.57° from their singular"),
        ("zxz", (0.1, np.pi / 2 - 0.01, 0.2), None),
        ("zxz", (0.1, 0.0, 0.2), "b: its angles zxz are 0° from their singular attitude"),
        ("xyz", (0.1, 0.0, 0.2), None),
        ("zx", (0.1, 0.0), None),
    ],
)
def test_angles_near_a_singular_attitude_are_warned_about(sequence, angles, warning):
    messages = free(rotation=da.rotation.euler(sequence, *angles)).diagnosis.messages
    computed = [text for level, text in messages if "singular attitude" in text]
    assert len(computed) == (warning is not None)
    assert not computed or (
        computed[0].startswith(warning) and ("warning", computed[0]) in messages
    )


def test_nearly_orthonormal_axes_are_corrected():
    turn = Rotation.from_rotvec([0.3, 2, 1]).as_matrix()
    computed = matrix_at(free(rotation=turn + 3e-7))
    np.testing.assert_allclose(computed @ computed.T, np.eye(3), atol=1e-14)
    assert np.abs(computed - turn).max() < 1e-6


def test_measures_are_the_derivatives_of_the_motion():
    """ω and α by differences of matrices; velocity and acceleration by those of positions."""
    motion = da.solve_dynamics(
        free(
            center_of_mass=(0.1, 0.2, -0.1),
            rotation=Rotation.from_rotvec([0.3, 2, 1]),
            angular_velocity=(3.0, -2.0, 1.0),
            velocity=(1.0, 2.0, 3.0),
            position=(0.0, 0.0, 0.0),
        ),
        0.02,
        step=0.001,
    )
    matrix = np.array(motion["b.rotation"]).reshape(-1, 3, 3)
    spin, local = (
        np.array(motion["b.angular_velocity"]),
        np.array(motion["b.angular_velocity_local"]),
    )
    h, mid = 0.001, slice(2, -2)

    def rate(x):
        return (x[:-4] - 8 * x[1:-3] + 8 * x[3:-1] - x[4:]) / (12 * h)

    skew = rate(matrix) @ np.transpose(matrix[mid], (0, 2, 1))
    seen = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=-1)
    np.testing.assert_allclose(spin[mid], seen, atol=1e-8)
    np.testing.assert_allclose(np.einsum("kij,kj->ki", matrix, local), spin, atol=1e-13)
    for name, of in (("angular_acceleration", "angular_velocity"), ("velocity", "position")):
        computed, slope = np.array(motion[f"b.{name}"])[mid], rate(np.array(motion[f"b.{of}"]))
        np.testing.assert_allclose(computed, slope, atol=1e-7)
    np.testing.assert_allclose(
        np.array(motion["b.acceleration"])[mid], rate(np.array(motion["b.velocity"])), atol=1e-7
    )
    e = np.array(motion["b.euler_parameters"])
    np.testing.assert_allclose(
        Rotation.from_quat(np.roll(e, -1, axis=1)).as_matrix(), matrix, atol=1e-13
    )


def test_velocities_hold_in_inertial_axes_after_assembly_has_turned_the_body():
    system = da.System("wheel")
    arguments = {"mass": 1.0, "inertia": MOMENTS, "center_of_mass": (0.1, 0.0, 0.2)}
    turn = da.rotation.bryant(0.3, -0.2, 0.9)
    wheel = spatial.Body("wheel", **arguments, rotation=turn, angular_velocity=(0.0, 3.0, 4.0))
    system.add(wheel)
    axis = (0.0, 0.6, 0.8)
    system.add(spatial.Revolute("O", system.ground.frame(axis=axis), wheel.frame(axis=(0, 0, 1))))
    model = system.build()
    e = model.all_equations
    computed = ca.Function("w", [e.y, e.v], [wheel.angular_velocity.sx, wheel.axes])
    spin, axes = (x.full() for x in computed(model.start.y, model.start.v))
    np.testing.assert_allclose(axes[:, 2], axis, atol=1e-12)
    np.testing.assert_allclose(spin.ravel(), [0, 3, 4], atol=1e-11)


def test_a_rigid_cloud_of_points_is_the_body_of_its_moments():
    """Parallel axes and turned axes: kinetic energy and momentum of 8 masses anywhere."""
    rng = np.random.default_rng(2)
    masses, places = rng.uniform(0.1, 1.0, 8), rng.standard_normal((8, 3))
    center = masses @ places / masses.sum()
    s = places - center
    inertia = np.einsum("k,ki,ki->", masses, s, s) * np.eye(3)
    inertia -= np.einsum("k,ki,kj->ij", masses, s, s)
    model = free(mass=masses.sum(), inertia=inertia, center_of_mass=center)
    body = model.bodies[0]
    y, v = model.equations.manifold.go(model.start.y, rng.standard_normal(6)), rng.normal(size=6)
    points = [body.point(*place).velocity for place in places]
    energy, *speeds = values(model, model.expression("b.kinetic_energy"), *points, y=y, v=v)
    speeds = np.array(speeds)
    assert energy[0] == pytest.approx(masses @ np.sum(speeds**2, axis=1) / 2, rel=1e-12)
    np.testing.assert_allclose(masses @ speeds, masses.sum() * v[:3], atol=1e-12)


GOOD = {"mass": 1.0, "inertia": (1, 1, 1)}
WRONG = {
    "triangle": ({"inertia": (1, 1, 3)}, "b: no body has the moments of inertia (1, 1, 3): none"),
    "negative": ({"inertia": (-1, 1, 1)}, "b: no body has the moments of inertia (-1, 1, 1)"),
    "products": ({"inertia": (1, 1, 1, 0.9, 0, 0)}, "Ixz = (0.9, 0, 0): tr(J)/2 − J"),
    "formula": ({"inertia": lambda p: (p, 1, 2)}, "moments of inertia (0.7, 1, 2): none may"),
    "not symmetric": (
        {"inertia": [[1, 0.1, 0], [0.2, 1, 0], [0, 0, 1]]},
        "b.inertia: the matrix is not symmetric: entries 1,2 and 2,1 are 0.1 and 0.2",
    ),
    "two numbers": ({"inertia": (1, 1)}, "b.inertia: give (Ixx, Iyy, Izz)"),
    "no inertia": ({"inertia": None}, "b: mass is given but inertia is missing"),
    "not orthonormal": (
        {"rotation": [[1, 0, 0], [0, 1.001, 0], [0, 0, 1]]},
        "b.rotation: the axes are not orthonormal, off by 0.002",
    ),
    "left-handed": ({"rotation": np.diag([1, 1, -1])}, "b.rotation: the axes are left-handed"),
    "matrix of a wrong formula": (
        {"rotation": lambda p: [[p, 0, 0], [0, 1, 0], [0, 0, 1]]},
        "b: its rotation is none: an axis has no length, or a matrix is off orthonormal by 0.592",
    ),
    "axis of a wrong formula": (
        {"rotation": lambda p: da.rotation.axis_angle((p - 0.7, 0, 0), 1.0)},
        "b: its rotation is none: an axis has no length",
    ),
    "many rotations": ({"rotation": Rotation.identity(3)}, "b.rotation: one rotation is needed"),
    "a number": ({"rotation": 3.0}, "b.rotation: give da.rotation.axis_angle(axis, angle)"),
    "moving": ({"rotation": lambda p: da.rotation.bryant(da.t, 0, 0)}, "b: depends on t; only"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_bodies_that_there_are_not_are_refused(wrong):
    arguments, message = WRONG[wrong]
    with pytest.raises(da.DalembertError, match=re.escape(message)):
        free(**GOOD | arguments)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: da.rotation.axis_angle((0, 0, 0), 1.0), "a direction needs a length"),
        (lambda: da.rotation.euler("xq", 1, 2), "a sequence of axes consists of x, y and z"),
        (lambda: da.rotation.euler("xyz", 1, 2), "'xyz' takes 3 angles, got 2"),
        (
            lambda: spatial.Body("b").euler("xxy"),
            "none twice in a row, as 'xyz' or 'zxz'; got 'xxy'",
        ),
        (lambda: spatial.Particle("b", mass=1.0).point(0, 0, 1), "no point but (0, 0, 0)"),
        (lambda: spatial.Particle("b", inertia=(1, 1, 1)), "unknown keyword 'inertia'"),
        (lambda: spatial.Particle("b", mass=1.0).frame(), "b: a particle has no frame"),
        (lambda: spatial.Body("b").frame(axis=(0, 0, 0)), "frame of b: a direction needs a length"),
        (lambda: spatial.Body("b").frame(axis=(0, 0, 1), x=(0, 0, 2)), "axis and x are parallel"),
        (
            lambda: spatial.Body("b").frame(axes=np.diag([1, 1, 1.1])),
            "frame of b: the axes are not orthonormal, off by 0.21",
        ),
    ],
)
def test_invalid_directions_are_refused(make, message):
    with pytest.raises(da.ModelError, match=re.escape(message)):
        make()


def test_formulas_of_axes_are_checked_at_their_values():
    system = da.System("s")
    p = system.parameter("p", 0.0)
    body = system.add(spatial.Body("b", **GOOD))
    system.add(spatial.Revolute("J", system.ground.frame(axis=(0, p, p)), body))
    with pytest.raises(da.ModelError, match="J: the axes of a frame of ground are off orthonormal"):
        system.build()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda b, d: spatial.Force("F", b, (1, 2)), "F.vector: expected 3 component(s), got 2"),
        (lambda b, d: spatial.Force("F", b, (1, 2, 3), follows=d), "follows d, a particle"),
        (lambda b, d: spatial.Force("F", b, (1, 2, 3), follows=3), "follows must be a body"),
        (lambda b, d: spatial.Torque("F", d, (1, 2, 3)), "d is a particle; a moment cannot act"),
        (lambda b, d: spatial.Torque("F", b, (1, 2, 3), reaction_on=b), "ties b to itself"),
        (
            lambda b, d: spatial.Bushing("F", b, d, stiffness=(1, 1, 1)),
            "d is a particle and has no",
        ),
        (lambda b, d: spatial.TorsionSpring("F", b, 3), "frame_j must be a frame of a body"),
        (lambda b, d: spatial.JointActuator("F", 3, 1.0), "joint must leave a motion free"),
    ],
)
def test_invalid_forces_are_refused(make, message):
    body, dot = spatial.Body("b", **GOOD), spatial.Particle("d", mass=1.0)
    with pytest.raises(da.DalembertError, match=re.escape(message)):
        make(body, dot)
