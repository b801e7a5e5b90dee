"""Structures: laws that every kind of element keeps, and gradients by all three methods."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from thorough import crossed

import dalembert as da
from dalembert import structures
from dalembert.analysis.equilibrium.statics import solve_statics
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.model.assembled.evaluation.inertia import from_rest


def triangle(dimension: int, make):
    """Three elements between three nodes in general position, every number a parameter."""
    structure = da.Structure(f"triangle in {dimension}-D")
    rng = np.random.default_rng(dimension)
    corners = np.vstack([np.zeros(dimension), np.eye(dimension), 2 * np.eye(dimension)])
    places = corners[: max(dimension + 1, 3)] + rng.uniform(
        -0.2, 0.2, (max(dimension + 1, 3), dimension)
    )
    nodes = [
        structure.node(
            f"n{k}", *(structure.parameter(f"x{k}{i}", float(c)) for i, c in enumerate(place))
        )
        for k, place in enumerate(places)
    ]
    for i in range(len(nodes)):
        for j in range(i):
            make(structure, f"e{j}{i}", nodes[j], nodes[i])
    return structure, nodes


def spring(structure, name, i, j):
    k = structure.parameter(f"k_{name}", 1.0 + len(structure.elements))
    structure.add(structures.AxialSpring(name, i, j, stiffness=k))


def truss(structure, name, i, j):
    n = len(structure.elements)
    area = structure.parameter(f"A_{name}", 0.5 + 0.1 * n)
    modulus = structure.parameter(f"E_{name}", 3.0 + n)
    density = structure.parameter(f"rho_{name}", 2.0)
    structure.add(structures.Truss(name, i, j, area=area, modulus=modulus, density=density))


def frame(structure, name, i, j, kind=structures.Frame, **more):
    n = len(structure.elements)
    values = {"area": 0.5 + 0.1 * n, "modulus": 3.0 + n, "density": 2.0}
    if kind.dimensions == (2,):
        values["second_moment"] = 0.04
    else:
        values |= {"second_moment_y": 0.04, "second_moment_z": 0.06, "torsion_constant": 0.03}
        values["shear_modulus"] = 1.3
        more["orientation"] = [structure.parameter(f"o{k}_{name}", 0.4 + k * k) for k in range(3)]
    numbers = {k: structure.parameter(f"{k}_{name}", v) for k, v in values.items()}
    structure.add(kind(name, i, j, **numbers, **more))


def timoshenko_frame(structure, name, i, j):
    area = structure.parameter(f"shear_area_{name}", 0.3)
    more = {"shear_modulus": structure.parameter(f"G_{name}", 1.3), "shear_area": area}
    frame(structure, name, i, j, structures.TimoshenkoFrame, **more)


def space_frame(structure, name, i, j):
    frame(structure, name, i, j, structures.SpaceFrame)


def timoshenko_space_frame(structure, name, i, j):
    more = {f"shear_area_{a}": structure.parameter(f"A{a}_{name}", 0.3) for a in "yz"}
    frame(structure, name, i, j, structures.TimoshenkoSpaceFrame, **more)


def attached(structure, nodes):
    """Springs to the ground, a mass and an inertia at the last node."""
    for cls in (
        structures.GroundSpring,
        structures.GroundRotationSpring,
        structures.PointMass,
        structures.PointInertia,
    ):
        numbers = {
            f.name: structure.parameter(f"{cls.__name__}_{f.name}", 0.3 + 0.1 * k)
            for k, f in enumerate(cls.quantity_fields())
        }
        structure.add(cls(f"at_{cls.__name__}", nodes[-1], **numbers))


def cell(cls, **options):
    """One distorted cell, every number a parameter."""
    structure, d = da.Structure(cls.__name__), cls.cell.dimension
    rng = np.random.default_rng(d)
    places = np.array(cls.cell.nodes) + rng.uniform(-0.05, 0.05, (cls.node_count, d))
    nodes = [
        structure.node(
            f"n{k}", *(structure.parameter(f"x{k}{i}", float(c)) for i, c in enumerate(place))
        )
        for k, place in enumerate(places)
    ]
    values = {"modulus": 3.0, "poisson": 0.3, "density": 2.0, "thickness": 0.5}
    values |= {"expansion": 0.02, "temperature": 0.0}
    numbers = {f.name: structure.parameter(f.name, values[f.name]) for f in cls.quantity_fields()}
    structure.add(cls("cell", nodes, **numbers, **options))
    return structure, nodes


LINES = {
    f"{make.__name__} {dimension}-D": (dimension, functools.partial(triangle, dimension, make))
    for make, dimensions in (
        (spring, (1, 2, 3)),
        (truss, (1, 2, 3)),
        (frame, (2,)),
        (timoshenko_frame, (2,)),
        (space_frame, (3,)),
        (timoshenko_space_frame, (3,)),
    )
    for dimension in dimensions
}
CELLS = {
    name: (cls.cell.dimension, functools.partial(cell, cls))
    for name, cls in ELEMENTS.items()
    if hasattr(cls, "cell")
}
STRAIN = (2, functools.partial(cell, structures.Quadrilateral, plane_strain=True))
CASES = LINES | CELLS | {"Quadrilateral in plane strain": STRAIN}
HELD = {"attached 2-D": LINES["frame 2-D"], "attached 3-D": LINES["space_frame 3-D"]}


@functools.cache
def model_of(name: str):
    dimension, make = (CASES | HELD)[name]
    structure, nodes = make()
    if name in HELD:
        attached(structure, nodes)
    settlement = structure.parameter("settlement", 0.02)
    structure.support(nodes[0])
    for k, node in enumerate(nodes[1:dimension], 1):  # just enough to hold it
        held = {f"u{'xyz'[i]}": settlement if i == k else 0.0 for i in range(k, dimension)}
        structure.support(node, **held)
    for k, node in enumerate(nodes[1:4]):
        free = [c for c in "xyz"[:dimension] if (node.name, f"u{c}") not in structure.supports]
        for c in free:
            structure.load(node, **{f"f{c}": structure.parameter(f"F{c}{k}", 0.06 - 0.04 * k)})
    return structure.build()


def test_every_element_is_under_these_laws():
    """The registry knows no element that no case below contains."""
    models = [model_of(name) for name in CASES | HELD]
    assert set(ELEMENTS.values()) == {b.kind.cls for m in models for b in m.blocks}


def places_of(model) -> np.ndarray:
    """(nodes, d) coordinates."""
    numbers = [
        [model.parameters[f"x{name[1:]}{i}"].value for i in range(node.dimension)]
        for name, node in model.structure.nodes.items()
    ]
    return np.array(numbers)


def displaced(model, moved: np.ndarray, turn=(0.0, 0.0, 0.0)) -> np.ndarray:
    """Displacements (n,) that move the nodes by (nodes, d) and turn those that can."""
    u = np.zeros(len(model.degrees))
    for k, name in enumerate(model.structure.nodes):
        for i in range(moved.shape[1]):
            u[model.degrees[name, "u" + "xyz"[i]]] = moved[k, i]
        for i in range(3):
            if (name, "r" + "xyz"[i]) in model.degrees:
                u[model.degrees[name, "r" + "xyz"[i]]] = turn[i]
    return u


def rigid_motions(model, dimension: int) -> list[np.ndarray]:
    """Small translations, then rotations."""
    place = places_of(model)
    motions = [displaced(model, np.ones((len(place), 1)) * e) for e in np.eye(dimension)]
    spatial = np.zeros((len(place), 3))
    spatial[:, :dimension] = place
    turns = np.eye(3)[{1: [], 2: [2], 3: [0, 1, 2]}[dimension]]
    for turn in turns:
        motions.append(displaced(model, np.cross(turn, spatial)[:, :dimension], turn))
    return motions


@pytest.mark.parametrize("name", CASES)
def test_stiffness_is_symmetric_and_free_of_rigid_motions(name):
    dimension, make = CASES[name]
    model = make()[0].build().linearized
    size = len(model.degrees)
    matrix = model.assembly.stiffness(np.zeros(size), model.nominal).toarray()
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-13 * max(1.0, matrix.max()))
    for motion in rigid_motions(model, dimension):
        np.testing.assert_allclose(matrix @ motion, 0.0, atol=1e-12)
    values = np.linalg.eigvalsh(matrix)
    assert np.sum(values > 1e-6) == size - dimension * (dimension + 1) // 2


@pytest.mark.parametrize("name", CASES)
def test_large_displacements_leave_rigid_motions_without_force(name):
    """The exact energy does not notice a rotation, however large."""
    dimension, make = CASES[name]
    model = make()[0].build()
    place = places_of(model)
    stiffest = abs(model.assembly.stiffness(np.zeros(len(model.degrees)), model.nominal)).max()
    axis = np.array([0.3, -0.5, 0.8]) if dimension == 3 else np.array([0.0, 0.0, 1.0])
    for angle in (1e-6, 2.1, 5.0):
        vector = angle * axis / np.linalg.norm(axis)
        turn = Rotation.from_rotvec(vector).as_matrix()[:dimension, :dimension]
        if dimension == 1:
            turn = np.eye(1)
        u = displaced(model, place @ turn.T - place + 0.7, vector)
        forces = model.assembly.internal_forces(u, model.nominal)
        np.testing.assert_allclose(forces, 0.0, atol=1e-12 * max(1.0, stiffest / 10))


@pytest.mark.few(7)
@pytest.mark.parametrize("name", CASES)
def test_tangents_are_the_slopes_of_forces_wherever_elements_are(name):
    """Of strain by displacements, of inertia by displacements, velocities and accelerations."""
    model = CASES[name][1]()[0].build()
    rng, p, size = np.random.default_rng(3), model.nominal, len(model.degrees)
    motion = list(0.3 * rng.standard_normal((3, size)))
    inertia = functools.partial(model.assembly.inertia_forces, p=p, lumped=False)
    slopes = model.assembly.inertia_slopes(motion, p, lumped=False)
    for which, exact in enumerate([model.assembly.stiffness(motion[0], p), *slopes]):
        columns = []
        for shift in 1e-5 * np.eye(size):
            ahead, behind = list(motion), list(motion)
            ahead[max(which - 1, 0)] = ahead[max(which - 1, 0)] + shift
            behind[max(which - 1, 0)] = behind[max(which - 1, 0)] - shift
            force = inertia if which else lambda m: model.assembly.internal_forces(m[0], p)
            columns.append((force(ahead) - force(behind)) / 2e-5)
        computed = np.stack(columns, axis=1)
        np.testing.assert_allclose(
            exact.toarray(), computed, atol=1e-7 * max(1, abs(computed).max())
        )


MATRICES = ["mass", "lumped mass", "tangent", "geometric", "change"]


@pytest.mark.few(3)
@pytest.mark.parametrize("name", CASES)
def test_masses(name):
    """Both mass matrices: symmetric, positive, the whole mass in every direction."""
    dimension, make = CASES[name]
    model = make()[0].build()
    motions = rigid_motions(model, dimension)
    whole = sum(
        b.kind.measure("mass", b.gather(motions[0]), b.data(model.nominal)).sum()
        for b in model.blocks
    )
    consistent, lumped = (
        model.assembly.mass(model.nominal, lumped=kind).toarray() for kind in (False, True)
    )
    np.testing.assert_array_equal(lumped, np.diag(np.diag(lumped)))
    for matrix in (consistent, lumped):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-14)
        assert np.linalg.eigvalsh(matrix).min() > (-1e-14 if whole == 0 else 1e-5)
        for motion in motions[:dimension]:
            assert motion @ matrix @ motion == pytest.approx(whole, rel=1e-12)


@pytest.mark.few(3)
@pytest.mark.parametrize(("name", "what"), crossed(CASES | HELD, MATRICES, 2))
def test_derivatives_of_matrices(name, what):
    """``aᵀ 𝗠 b`` by direct and adjoint products and by differences."""
    model = model_of(name)
    rng = np.random.default_rng(5)
    u, a, b, du = 0.05 * rng.standard_normal((4, len(model.degrees)))
    p, dp = model.nominal, rng.uniform(-0.1, 0.1, model.nominal.size)
    assembly, lumped = model.assembly, what == "lumped mass"

    def product(h: float) -> float:
        if "mass" in what:
            return float(a @ (assembly.mass(p + h * dp, lumped) @ b))
        name = {"geometric": "geometric", "change": "stiffness_change"}.get(what, "stiffness")
        return float(a @ (getattr(assembly, name)(u + h * du, p + h * dp) @ b))

    if "mass" in what:
        pushed = a @ assembly.push_inertia(from_rest(b), p, dp, lumped)
        pulled = assembly.pull_inertia(from_rest(b), p, a, lumped) @ dp
    else:
        pushed = a @ assembly.push_stiffness(b, u, p, du, dp, what)
        u_bar, p_bar = assembly.pull_stiffness(a, b, u, p, what)
        pulled = u_bar @ du + p_bar @ dp
    scale = max(abs(pushed), abs(product(0.0)), 1e-6)
    assert pulled == pytest.approx(pushed, abs=1e-11 * scale)
    h = 1e-3
    wide, narrow = ((product(k) - product(-k)) / (2 * k) for k in (h, h / 2))
    assert (4 * narrow - wide) / 3 == pytest.approx(pushed, abs=1e-6 * scale)


@pytest.mark.parametrize("name", ["space_frame 3-D", "Quadrilateral8"])
def test_lumped_masses_of_weightless_elements(name):
    """Scales are those of any density; a density that grows from zero has its exact slope."""
    model = model_of(name)
    p, dp = model.nominal.copy(), np.zeros(model.nominal.size)
    for k, parameter in enumerate(model.parameters):
        if parameter.startswith("density"):
            p[k], dp[k] = 0.0, 1.0
    a, b = np.random.default_rng(7).standard_normal((2, len(model.degrees)))
    expected = a @ (model.assembly.mass(p + dp, lumped=True) @ b)
    assert a @ (model.assembly.mass(p, lumped=True) @ b) == 0
    pushed = model.assembly.push_inertia(from_rest(b), p, dp, True)
    assert a @ pushed == pytest.approx(expected, rel=1e-12)
    pulled = model.assembly.pull_inertia(from_rest(b), p, a, True)
    assert pulled @ dp == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_the_change_of_stiffness_is_the_slope_of_the_tangent(name):
    model = model_of(name)
    u = np.random.default_rng(6).standard_normal(len(model.degrees))
    p, h = model.nominal, 1e-4
    computed = model.linearized.assembly.stiffness_change(u, p).toarray()
    ahead, behind = (model.assembly.stiffness(s * u, p).toarray() for s in (h, -h))
    expected = (ahead - behind) / (2 * h)
    np.testing.assert_allclose(computed, expected, atol=1e-5 * max(np.abs(expected).max(), 1.0))


@pytest.mark.parametrize("name", CASES)
def test_geometric_stiffness_turns_the_forces_of_stresses(name):
    """A rigid rotation ``ω`` of an element with stresses turns its forces: ``K_g r_ω = ω × f``.
    Nodes that rotate in space are left out, as moments about fixed axes are no gradient there."""
    model, rng = model_of(name), np.random.default_rng(8)
    for block in model.linearized.blocks:
        data, kind = block.data(model.nominal), block.kind
        d, n, per_node = kind.dimension, kind.node_count, block.degrees.shape[0] // kind.node_count
        u = rng.standard_normal(block.degrees.shape)
        matrices = kind.geometric(u, data)
        np.testing.assert_allclose(matrices, matrices.swapaxes(0, 1), atol=1e-12)
        if d == 1:
            np.testing.assert_allclose(matrices, 0.0, atol=1e-12)
        if d == 1 or (d == 3 and kind.cls.turns):
            continue
        forces = np.einsum("ije,je->ie", kind.tangents(0 * u, data), u)
        spin = rng.standard_normal(3) if d == 3 else np.array([0.0, 0.0, 1.0])
        skew = np.cross(spin, np.eye(3))[:d, :d].T
        rotation, turned = np.zeros_like(u), np.zeros_like(u)
        for k in range(n):
            rows = slice(k * per_node, k * per_node + d)
            rotation[rows] = skew @ data[k * d : (k + 1) * d]
            turned[rows] = skew @ forces[rows]
            rotation[rows.stop : (k + 1) * per_node] = 1.0
        computed = np.einsum("ije,je->ie", matrices, rotation)
        np.testing.assert_allclose(computed, turned, atol=1e-11 * max(1.0, np.abs(turned).max()))


@pytest.mark.parametrize("name", CASES)
def test_equilibrium_and_work(name):
    """Forces and reactions balance; twice the strain energy is the work of the forces."""
    model = model_of(name)
    result = solve_statics(model)
    scale = np.abs(result.forces).max()
    for direction in ("ux", "uy", "uz")[: CASES[name][0]]:
        total = sum(result.forces[k, 0] for p, k in model.degrees.items() if p[1] == direction)
        assert total == pytest.approx(0.0, abs=1e-11 * scale)
    assert result["compliance"] == pytest.approx(2 * result["strain_energy"], rel=1e-12)
    assert result.status.residual < 1e-12


@pytest.mark.few(2)
@pytest.mark.parametrize(("name", "nonlinear"), crossed(CASES | HELD, [False, True]))
def test_direct_adjoint_and_differences_agree(name, nonlinear):
    """Displacements, reactions, all quantities of elements and totals, by every parameter."""
    model = model_of(name)
    options = {"nonlinear": True, "tolerance": 1e-13, "steps": 2} if nonlinear else {}
    result = solve_statics(model, **options)
    assert result.status.success
    last = list(model.structure.nodes)[-1]
    totals = [f"{last}.ux", "n0.fx", "compliance", "strain_energy", "mass"]
    responses = [da.final(m) for m in totals]
    product = model["n0.fx"] * model[f"{last}.ux"] + next(iter(model.parameters.values()))
    responses.append(da.final(product, "product"))
    for block in model.blocks:
        element, stress = block.names.name(0), hasattr(block.kind.cls, "cell")
        measures = [f"{element}.{m}" for m in [*block.kind.measures, *["sxx_n1"] * stress]]
        each = [model[m] / (abs(result[m]) + 1e-6) * (2 + k) for k, m in enumerate(measures)]
        responses.append(da.final(sum(each), f"all of {element}"))
    names = list(model.parameters)
    adjoint, direct = (
        da.sensitivity(result, responses, method=m).values for m in ("adjoint", "direct")
    )
    some = slice(None, None, max(1, len(names) // 8))
    differences = da.sensitivity(
        result, responses, wrt=names[some], method="finite-difference"
    ).values
    scale = np.maximum(np.abs(direct).max(axis=1, keepdims=True), 1e-7)
    assert (np.abs(adjoint - direct) / scale).max() < 1e-9
    assert (np.abs(differences - direct[:, some]) / scale).max() < 1e-6
    along = np.random.default_rng(7).choice([-1.0, 1.0], len(names)) * np.abs(model.nominal)
    quotients = along_differences(result, responses, along)  # by all parameters together
    scale = np.maximum(np.abs(direct) @ np.abs(along), 1e-7)
    assert (np.abs(quotients - direct @ along) / scale).max() < 1e-6


def along_differences(result, responses, along):
    """Change of responses along a direction of the parameters, by Richardson's quotients."""

    def central(h: float) -> np.ndarray:
        ends = [
            result.analysis.replay(result, result.parameters + side * h * along) for side in (1, -1)
        ]
        values = [np.array([da.evaluate(end, r) for r in responses]) for end in ends]
        return (values[0] - values[1]) / (2 * h)

    return (4 * central(5e-5) - central(1e-4)) / 3


def test_mechanisms_name_their_nodes():
    structure = da.Structure("hinge")
    a, b, c = (structure.node(n, *p) for n, p in (("a", (0, 0)), ("b", (1, 0)), ("c", (2, 0))))
    for name, i, j in (("ab", a, b), ("bc", b, c)):
        structure.add(structures.Truss(name, i, j, area=1.0, modulus=1.0))
    structure.support(a)
    structure.support(c)
    structure.load(b, fy=1.0)
    with pytest.raises(da.SingularityError, match=r"b can move without significant strain \(uy\)"):
        solve_statics(structure.build())


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda s, n: s.node("loose", 3.0, 3.0), "loose: is not connected"),
        (
            lambda s, n: s.load(n[0], fx=1.0),
            "fx: ux is prescribed, so the force there is a reaction",
        ),
        (lambda s, n: s.support(n[1], uz=0.0), "unknown direction 'uz'"),
        (lambda s, n: s.load(n[1], mz=1.0), "load n1: mz: no element turns this node; connect"),
        (lambda s, n: s.support(n[1], rz=0.0), "support n1: rz: no element turns this node"),
        (lambda s, n: s.initial(n[1], vrz=1.0), "initial n1.vrz: rz: no element turns this"),
        (lambda s, n: s.node("flat", 1.0), "has 1 coordinates"),
        (lambda s, n: s.support(n[0], ux=1.0) or s.support(n[0], ux=2.0), "prescribed twice"),
    ],
)
def test_wrong_structures_are_refused(spoil, message):
    structure, nodes = triangle(2, truss)
    structure.support(nodes[0])

    def build():
        spoil(structure, nodes)
        structure.build()

    with pytest.raises(da.ModelError, match=message):
        build()


def test_load_cases_share_one_factorisation():
    structure, nodes = triangle(2, truss)
    structure.support(nodes[0])
    structure.support(nodes[1])
    structure.load(nodes[2], case="push", fx=1.0)
    structure.load(nodes[2], case="pull", fx=-2.0)
    result = solve_statics(structure.build())
    assert result.cases == ["push", "pull"]
    np.testing.assert_allclose(result["n2.ux"][1], -2 * result["n2.ux"][0], rtol=1e-13)
    assert da.evaluate(result, da.at(1, "n2.ux")) == result["n2.ux"][1]


def test_a_structure_takes_gravity_as_a_system_does():
    """By the constructor or the method, the load of the unnamed case."""

    def column(built: da.System) -> float:
        foot, top = built.node("foot", 0.0, 0.0), built.node("top", 0.0, 2.0)
        numbers = {"area": 1e-3, "second_moment": 1e-7, "modulus": 2e9, "density": 1000.0}
        built.add(structures.Frame("column", foot, top, **numbers))
        built.support(foot)
        return float(solve_statics(built.build())["column.force"])

    by_method = da.Structure("column")
    by_method.gravity(0, -9.81)
    fields = {"gravity": (0, -9.81)}
    forces = [column(s) for s in (da.Structure("a", **fields), da.System("b", **fields), by_method)]
    assert forces == pytest.approx([-9.81] * 3)
    with pytest.raises(da.ModelError, match="gravity: needs 2 numbers, got 3"):
        column(da.Structure("column", gravity=(0, 0, -9.81)))
