"""Frames in space against textbook matrices and published large displacements."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import structures
from dalembert.elements.fem.graphs import ElementGraphs
from dalembert.elements.fem.nodal import rotation_matrix, rotation_vector
from dalembert.model.assembled.evaluation.block import ElementKind
from dalembert.model.assembled.load_case import CHANGES

SECTION = {
    "area": 2.0,
    "second_moment_y": 0.3,
    "second_moment_z": 0.5,
    "torsion_constant": 0.4,
    "modulus": 7.0,
    "shear_modulus": 3.0,
}
COLD = dict.fromkeys(("expansion", *CHANGES), 0.0)
SHEAR = {"shear_area_y": 1.5, "shear_area_z": 1.2}


def of_kind(cls, ends, orientation, **section):
    """Kind and data (m, 1) of one element."""
    kind = ElementKind(ElementGraphs(cls, 3, 2))
    inputs = {**COLD, "density": 0.0, "orientation": orientation, **section}
    numbers = [np.atleast_1d(inputs[name]) for name in kind.quantities]
    return kind, np.concatenate([np.ravel(ends), *numbers])[:, None]


def textbook_matrix(length, shear_softness=(0.0, 0.0)) -> np.ndarray:
    """Przemieniecki's 12 × 12 stiffness in the element's own axes (his equation 5.116)."""
    s, matrix = SECTION, np.zeros((12, 12))
    for first, stiffness in (
        (0, s["modulus"] * s["area"]),
        (3, s["shear_modulus"] * s["torsion_constant"]),
    ):
        ends = [first, first + 6]
        matrix[np.ix_(ends, ends)] += stiffness / length * np.array([[1, -1], [-1, 1]])
    for places, inertia, soft, sign in (
        ([1, 5, 7, 11], s["second_moment_z"], shear_softness[0], 1),  # v, turns about z
        ([2, 4, 8, 10], s["second_moment_y"], shear_softness[1], -1),  # w, turns about y
    ):
        h = sign * length
        block = np.array(
            [
                [12, 6 * h, -12, 6 * h],
                [6 * h, (4 + soft) * h**2, -6 * h, (2 - soft) * h**2],
                [-12, -6 * h, 12, -6 * h],
                [6 * h, (2 - soft) * h**2, -6 * h, (4 + soft) * h**2],
            ]
        )
        matrix[np.ix_(places, places)] += s["modulus"] * inertia / (length**3 * (1 + soft)) * block
    return matrix


def test_rotation_vectors():
    """Both maps and their slopes, on both sides of where series stand in for closed forms."""
    r = ca.SX.sym("r", 3)
    matrix = rotation_matrix(r)
    back = rotation_vector(matrix)
    both = ca.Function("both", [r], [matrix, back, ca.jacobian(back, r)])
    axis = np.array([0.36, -0.48, 0.8])
    for angle in (0.0, 1e-9, 1e-3, 0.45, 0.4999, 0.5001, 2.0, 3.0):
        computed, again, slope = (np.array(f) for f in both(angle * axis))
        expected = Rotation.from_rotvec(angle * axis).as_matrix()
        np.testing.assert_allclose(computed, expected, atol=1e-15)
        np.testing.assert_allclose(again.ravel(), angle * axis, atol=1e-14)
        np.testing.assert_allclose(slope, np.eye(3), atol=1e-12)
    slope = ca.vec(matrix)  # third derivatives at rest: of −θ²/6 [r]× and of the symmetric part
    for _ in range(3):
        slope = ca.jtimes(slope, r, ca.DM(axis))
    third = np.array(ca.Function("third", [r], [slope])(np.zeros(3))).reshape(3, 3, order="F")
    np.testing.assert_allclose(third, -np.cross(np.eye(3), axis), atol=1e-14)


@pytest.mark.few(1)
@pytest.mark.parametrize("shear", [False, True])
def test_stiffness_matrix_of_the_textbooks(shear):
    start, end = np.array([0.1, 0.2, 0.3]), np.array([1.0, 1.5, 0.9])
    towards, length = np.array([0.3, 0.2, 1.0]), np.linalg.norm(end - start)
    along = (end - start) / length
    side = towards - along * (along @ towards)
    side /= np.linalg.norm(side)
    own = np.kron(np.eye(4), np.array([along, side, np.cross(along, side)]))
    soft, cls, more = (0.0, 0.0), structures.SpaceFrame, {}
    if shear:
        cls, more = structures.TimoshenkoSpaceFrame, SHEAR
        e, g = SECTION["modulus"], SECTION["shear_modulus"]
        soft = (
            12 * e * SECTION["second_moment_z"] / (g * SHEAR["shear_area_y"] * length**2),
            12 * e * SECTION["second_moment_y"] / (g * SHEAR["shear_area_z"] * length**2),
        )
    kind, data = of_kind(cls, (start, end), towards, **SECTION, **more)
    computed = kind.tangents(np.zeros((12, 1)), data)[:, :, 0]
    np.testing.assert_allclose(computed, own.T @ textbook_matrix(length, soft) @ own, atol=1e-13)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("end", "side"), [((2, 0, 0), (0, 0, 1)), ((0, 2, 0), (0, 0, 1)), ((0, 0, 2), (0, 1, 0))]
)
def test_default_orientation(end, side):
    """The z axis; the y axis for vertical beams."""
    matrices = []
    for orientation in ((0.0, 0.0, 0.0), side):
        kind, data = of_kind(structures.SpaceFrame, ((0, 0, 0), end), orientation, **SECTION)
        matrices.append(kind.tangents(np.zeros((12, 1)), data))
    np.testing.assert_array_equal(matrices[0], matrices[1])


def test_energy_does_not_notice_a_rotation_of_the_displaced_element():
    rng, ends = np.random.default_rng(1), np.array([[0.1, 0.2, 0.3], [1.0, 1.5, 0.9]])
    kind, data = of_kind(structures.SpaceFrame, ends, (0.3, 0.2, 1.0), **SECTION)
    u = 0.2 * rng.standard_normal((2, 6))
    before = kind.measure("energy", u.reshape(12, 1), data)[0, 0]
    for vector in ([0.7, -1.2, 0.9], [0.0, 3.0, 0.0]):
        turn = Rotation.from_rotvec(vector)
        moved = np.empty((2, 6))
        moved[:, :3] = turn.apply(ends + u[:, :3]) - ends + 1.0
        moved[:, 3:] = (turn * Rotation.from_rotvec(u[:, 3:])).as_rotvec()
        after = kind.measure("energy", moved.reshape(12, 1), data)[0, 0]
        assert after == pytest.approx(before, rel=1e-12)


def bent(places, section, orientation=(0.0, 0.0, 0.0)):
    """A chain of frames, clamped at its first node."""
    structure = da.Structure("chain")
    nodes = [structure.node(f"n{k}", *place) for k, place in enumerate(places)]
    for k in range(len(nodes) - 1):
        structure.add(
            structures.SpaceFrame(
                f"e{k}", nodes[k], nodes[k + 1], **section, orientation=orientation
            )
        )
    structure.support(nodes[0])
    return structure, nodes[-1]


def test_bend_of_45_degrees():
    """Bathe and Bolourchi's bend, radius 100, force 600 across its plane; figures of GXBeam."""
    angles = np.linspace(0, np.pi / 4, 9)
    places = np.column_stack([100 * np.sin(angles), 100 * (1 - np.cos(angles)), 0 * angles])
    section = {"area": 1.0, "second_moment_y": 1 / 12, "second_moment_z": 1 / 12}
    section |= {"torsion_constant": 1 / 6, "modulus": 1e7, "shear_modulus": 5e6}
    structure, end = bent(places, section)
    structure.load(end, fz=600.0)
    result = da.solve_statics(structure.build(), nonlinear=True, steps=4)
    tip = [result[f"{end.name}.u{c}"] for c in "yxz"]
    np.testing.assert_allclose(tip, [-13.577384, -23.545303, 53.458008], rtol=0.01)


def test_princeton_beam():
    """Tip under 8.896 N at several angles, against ANSYS beam elements (Exudyn's test model)."""
    length, height, width, e, nu = 0.508, 12.3777e-3, 3.2024e-3, 71.7e9, 0.31
    odd = np.arange(1, 40, 2)  # Saint-Venant's torsion of a rectangle
    series = np.sum(np.tanh(odd * np.pi * height / (2 * width)) / odd**5)
    torsion = height * width**3 * (1 / 3 - 64 * width / (np.pi**5 * height) * series)
    section = {
        "area": height * width,
        "second_moment_y": height * width**3 / 12,
        "second_moment_z": width * height**3 / 12,
        "torsion_constant": torsion,
        "modulus": e,
        "shear_modulus": e / (2 * (1 + nu)),
    }
    places = np.column_stack([np.linspace(0, length, 11), np.zeros((11, 2))])
    structure, end = bent(places, section, orientation=(0, 1, 0))
    for beta in (0, 30, 60, 90):
        angle = np.radians(beta)
        structure.load(end, f"{beta}", fy=8.896 * np.cos(angle), fz=8.896 * np.sin(angle))
    result = da.solve_statics(structure.build(), nonlinear=True, steps=4)
    expected_y = [1.071417630e-2, 1.011169630e-2, 6.604665004e-3, 0.0]
    expected_z = [0.0, 7.939482948e-2, 0.129887616, 0.146245978]
    np.testing.assert_allclose(result[f"{end.name}.uy"], expected_y, rtol=0.01, atol=1e-12)
    np.testing.assert_allclose(result[f"{end.name}.uz"], expected_z, rtol=0.01, atol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("axis", ["y", "z"])
def test_roll_up_by_most_of_a_circle(axis):
    """A moment rolls a straight beam up by 1.8 π; its nodes lie on a circle."""
    angle, count = 1.8 * np.pi, 12
    section = SECTION | {"area": 100.0}
    inertia = section[f"second_moment_{'z' if axis == 'y' else 'y'}"]  # own y points along z
    places = np.column_stack([np.linspace(0, 1, count + 1), np.zeros((count + 1, 2))])
    structure, end = bent(places, section)
    structure.load(end, **{f"m{axis}": angle * section["modulus"] * inertia})
    result = da.solve_statics(structure.build(), nonlinear=True, steps=12)
    assert result.status.success
    assert result[f"{end.name}.r{axis}"] == pytest.approx(angle, rel=1e-9)
    tip = np.sin(angle) / angle - 1, (1 - np.cos(angle)) / angle
    across = result[f"{end.name}.u{'z' if axis == 'y' else 'y'}"] * (-1 if axis == "y" else 1)
    np.testing.assert_allclose([result[f"{end.name}.ux"], across], tip, atol=5e-5)


def test_section_forces_of_a_cantilever():
    """Moments, shear and torque at the clamped end by statics."""
    places = [(0, 0, 0), (1.0, 0, 0), (2.0, 0, 0)]
    structure, end = bent(places, SECTION, orientation=(0, 1, 0))
    structure.load(end, fy=3e-3, fz=5e-3, mx=2e-3)
    result = da.solve_statics(structure.build())
    computed = [
        result[f"e0.{m}"] for m in ("moment_z_i", "moment_y_i", "shear_y", "shear_z", "torque")
    ]
    # shear is that of the force on the end i
    np.testing.assert_allclose(computed, [-6e-3, 1e-2, -3e-3, -5e-3, 2e-3], atol=1e-14)
    assert result["n0.mz"] == pytest.approx(-6e-3, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"orientation": (1.0, 0.0, 0.0)}, "b: has an orientation along its own axis"),
        ({"node_j": "twin"}, "b: has no length; its nodes must lie apart"),
    ],
)
def test_impossible_frames_are_refused(change, message):
    structure = da.Structure("wrong")
    a, b = structure.node("a", 0, 0, 0), structure.node("b_end", 1, 0, 0)
    twin = structure.node("twin", 0, 0, 0)
    other = structure.node("other", 0, 1, 0)
    structure.add(structures.SpaceFrame("fine", twin, other, **SECTION))
    structure.add(structures.SpaceFrame("fine_too", a, b, **SECTION))
    ends = (a, twin) if "node_j" in change else (a, b)
    more = {k: v for k, v in change.items() if k == "orientation"}
    structure.add(structures.SpaceFrame("b", *ends, **SECTION, **more))
    with pytest.raises(da.ModelError, match=message):
        structure.build()


def test_plane_and_space_frames_agree():
    """A bent in the x-y plane: same stiffness and masses as its plane twin."""
    section = {"density": 3.0, "modulus": 7.0, "area": 2.0}
    plane = ElementKind(ElementGraphs(structures.TimoshenkoFrame, 2, 2))
    ends = np.array([[0.1, 0.2, 0.0], [1.0, 1.5, 0.0]])
    more = {**COLD, "second_moment": 0.5, "shear_modulus": 3.0, "shear_area": 1.5}
    flat = np.array([*ends[:, :2].ravel(), *[(section | more)[n] for n in plane.quantities]])
    own_y = np.array([-1.3, 0.9, 0.0])
    spatial = {**SECTION, **SHEAR, **section}
    space, data = of_kind(structures.TimoshenkoSpaceFrame, ends, own_y, **spatial)
    pick = np.ix_([0, 1, 5, 6, 7, 11], [0, 1, 5, 6, 7, 11])
    at_rest = np.zeros((6, 1)), flat[:, None]
    np.testing.assert_allclose(
        space.tangents(np.zeros((12, 1)), data)[:, :, 0][pick],
        plane.tangents(*at_rest)[:, :, 0],
        atol=1e-13,
    )
    np.testing.assert_allclose(
        space.masses(data)[:, :, 0][pick], plane.masses(flat[:, None])[:, :, 0], atol=1e-14
    )


def test_consistent_mass_of_the_textbooks():
    """Archer's matrix m/420 (156, 22 L, 54, −13 L; …) for an Euler–Bernoulli beam."""
    kind, length = ElementKind(ElementGraphs(structures.Frame, 2, 2)), 1.7
    numbers = {**COLD, "area": 0.4, "second_moment": 0.1, "modulus": 2.0, "density": 3.0}
    data = np.array([0, 0, length, 0, *[numbers[n] for n in kind.quantities]])[:, None]
    mass, h = 0.4 * 3.0 * length, length
    bending = [
        [156, 22 * h, 54, -13 * h],
        [22 * h, 4 * h**2, 13 * h, -3 * h**2],
        [54, 13 * h, 156, -22 * h],
        [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
    ]
    expected = np.zeros((6, 6))
    expected[np.ix_([0, 3], [0, 3])] = mass / 6 * np.array([[2, 1], [1, 2]])
    expected[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = mass / 420 * np.array(bending)
    np.testing.assert_allclose(kind.masses(data)[:, :, 0], expected, atol=1e-14)
