"""Whoever solves a sparse system, the answers, the gradients and the refusals are the same."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import scipy.sparse as sparse

import dalembert as da
from dalembert import structures
from dalembert.model.assembled.evaluation.stiffness_solvers import better_iterative
from dalembert.sparse import factorise, pardiso
from dalembert.sparse.factorise import SuperLUFactors
from dalembert.sparse.pardiso import PardisoFactors

PARDISO = pytest.param(
    "PARDISO",
    marks=pytest.mark.skipif(not pardiso.available(), reason="pypardiso is not installed"),
)
FACTORS = {"SuperLU": SuperLUFactors, "PARDISO": PardisoFactors}
DIRECT = pytest.mark.parametrize("solver", ["SuperLU", PARDISO])


@pytest.fixture
def chosen(solver, monkeypatch):
    """Factors of every size by this solver."""
    monkeypatch.setattr(factorise, "PARDISO_ROWS", 1)
    monkeypatch.setattr(pardiso, "available", lambda: solver == "PARDISO")
    return solver


def matrix(kind: str, n: int = 60) -> sparse.csc_matrix:
    """Sparse, with entries of very different sizes."""
    rng = np.random.default_rng(3)
    random = sparse.random(n, n, 0.1, random_state=rng, data_rvs=rng.standard_normal)
    sizes = sparse.diags(10.0 ** rng.uniform(-2, 2, n))
    if kind == "general":
        return (random + 3 * sparse.eye(n) @ sizes).tocsc()
    signs = np.ones(n) if kind == "positive" else np.where(np.arange(n) < 7, -1.0, 1.0)
    whole = random @ random.T * 0.01 + 4 * sparse.diags(signs)
    return (sizes @ (whole + whole.T) @ sizes).tocsc()


@DIRECT
@pytest.mark.parametrize("kind", ["positive", "indefinite", "general"])
def test_factors_solve_systems_and_transposed_ones(solver, kind):
    a, many = matrix(kind), np.random.default_rng(1).standard_normal((60, 3))
    factors = FACTORS[solver](a)
    for trans, whole in (("N", a), ("T", a.T)):
        for rhs in (many, many[:, 0]):
            solution = factors.solve(rhs, trans)
            size = abs(whole).sum(axis=1).max() * np.abs(solution).max() + np.abs(rhs).max()
            assert solution.shape == rhs.shape
            assert np.abs(whole @ solution - rhs).max() <= 1e-13 * size


@DIRECT
def test_pivots_count_negative_eigenvalues(chosen):
    a = matrix("indefinite")
    expected = int((np.linalg.eigvalsh(a.toarray()) < 0).sum())
    assert factorise.symmetric_factors(a).negative == expected > 0


@DIRECT
def test_singular_matrices_are_refused(chosen):
    a = matrix("general").tolil()
    a[5] = 0.0
    with pytest.raises(np.linalg.LinAlgError):
        factorise.general_factors(a.tocsc())


@DIRECT
def test_a_saddle_point_finds_its_pivots(chosen):
    """Zeros on the diagonal: pivots are looked for elsewhere."""
    rng = np.random.default_rng(0)
    c = rng.standard_normal((4, 12))
    a = sparse.block_array([[sparse.diags(rng.uniform(1, 2, 12)), c.T], [c, None]]).tocsc()
    rhs = rng.standard_normal(16)
    for factors in (factorise.general_factors, factorise.indefinite_factors):
        assert a @ factors(a).solve(rhs) == pytest.approx(rhs, abs=1e-11)


@DIRECT
def test_threads_share_factors(solver):
    a = matrix("positive")
    factors, sides = FACTORS[solver](a), np.random.default_rng(2).standard_normal((40, 60))
    alone = [factors.solve(side) for side in sides]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(factors.solve, sides))
    assert np.array_equal(alone, together)


def plate(held: str = "edge", rows: int = 6) -> da.Structure:
    """Two patches of quadrilaterals pulled down at one end."""
    x, y = np.meshgrid(np.linspace(0, 2, 2 * rows + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    i, j = np.meshgrid(np.arange(2 * rows), np.arange(rows), indexing="ij")
    first = (i * (rows + 1) + j).ravel()
    cells = np.column_stack([first, first + rows + 1, first + rows + 2, first + 1])
    structure = da.Structure("plate")
    nodes = structure.add_nodes("n", np.column_stack([x.ravel(), y.ravel()]))
    h = [structure.parameter(name, 0.01) for name in ("left", "right")]
    thickness = np.array(h, dtype=object)[(first >= first.mean()).astype(int)]
    structure.add_elements(
        "skin", structures.Quadrilateral, nodes, cells, thickness=thickness, modulus=2e11
    )
    if held == "edge":
        structure.support(nodes.where(x=0.0))
    elif held == "corner":
        structure.support(nodes.where(x=0.0, y=0.0))
    structure.load(nodes.where(x=2.0), fy=-1000.0)
    structure.load(nodes.where(x=2.0), case="pull", fx=1e4)
    return structure


def block() -> da.Structure:
    """A solid held at one end."""
    structure = da.Structure("block")
    axis = np.linspace(0, 1, 5)
    points = np.stack(np.meshgrid(2 * axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(125).reshape(5, 5, 5)
    lower = number[:-1, :-1, :-1].ravel()
    steps = [0, 25, 30, 5, 1, 26, 31, 6]
    nodes = structure.add_nodes("n", points)
    modulus = structure.parameter("modulus", 1e9)
    cells = lower[:, None] + np.array(steps)
    structure.add_elements("b", structures.Hexahedron, nodes, cells, modulus=modulus)
    structure.support(nodes.where(x=0.0))
    structure.load(nodes.where(x=2.0), fz=3.0)
    return structure


def lattice() -> da.Structure:
    """A frame in space: nodes turn."""
    structure = da.Structure("lattice")
    a = structure.parameter("area", 1e-3)
    nodes = [structure.node(f"n{k}", 0.5 * k, 0.1 * (k % 2), 0.05 * k) for k in range(30)]
    for k in range(29):
        member = structures.SpaceFrame(
            f"m{k}",
            nodes[k],
            nodes[k + 1],
            area=a,
            modulus=2e11,
            shear_modulus=8e10,
            torsion_constant=1e-6,
            second_moment_y=1e-6,
            second_moment_z=2e-6,
        )
        structure.add(member)
    structure.support(nodes[0])
    structure.load(nodes[-1], fz=-10.0)
    return structure


def same(one, other, tolerance):
    for name in ("displacements", "forces"):
        left, right = getattr(one, name), getattr(other, name)
        assert np.abs(left - right).max() <= tolerance * np.abs(right).max()


@DIRECT
def test_statics_by_either_factors(chosen):
    model = plate().build()
    result = da.solve_statics(model, solver="direct")
    assert result.statistics["solver"] == chosen
    gradients = [
        da.sensitivity(result, da.at(1, "compliance"), method=m).values
        for m in ("adjoint", "direct")
    ]
    assert gradients[0] == pytest.approx(gradients[1], rel=1e-10)


@pytest.mark.parametrize("structure", [plate, block, lattice])
def test_conjugate_gradients_find_what_factors_find(structure):
    pytest.importorskip("pyamg")
    model = structure().build()
    direct, iterative = (da.solve_statics(model, solver=s) for s in ("direct", "iterative"))
    same(iterative, direct, 1e-7)
    assert iterative.statistics["solver"].startswith("conjugate gradients")
    assert 0 < iterative.statistics["iterations"] < 200
    assert iterative.status.residual < 1e-7
    for method in ("adjoint", "direct"):
        slopes = [
            da.sensitivity(r, da.at(1, "compliance"), method=method).values
            for r in (iterative, direct)
        ]
        assert slopes[0] == pytest.approx(slopes[1], rel=1e-7)


@pytest.mark.parametrize("solver", ["SuperLU", PARDISO, "iterative"])
@pytest.mark.parametrize("held", ["nowhere", "corner"])
def test_every_solver_reports_floating_structures(solver, held, monkeypatch):
    if solver == "iterative":
        pytest.importorskip("pyamg")
    monkeypatch.setattr(factorise, "PARDISO_ROWS", 1)
    monkeypatch.setattr(pardiso, "available", lambda: solver == "PARDISO")
    option = "iterative" if solver == "iterative" else "direct"
    with pytest.raises(
        da.SingularityError, match=r"mechanism: n.* can move without significant strain"
    ):
        da.solve_statics(plate(held).build(), solver=option)


@pytest.mark.parametrize("height", [0.0, 0.7])
def test_a_part_that_moves_alone_is_told_by_conjugate_gradients(height):
    pytest.importorskip("pyamg")
    structure = plate()
    end, far = structure.node("end", 5.0, 0.0), structure.node("far", 6.0, height)
    structure.add(structures.Truss("loose", end, far, area=1e-4, modulus=2e11))
    structure.support(far)
    with pytest.raises(da.SingularityError, match="end can move without significant strain"):
        da.solve_statics(structure.build(), solver="iterative")


def test_the_solver_is_chosen_by_size_and_memory():
    pytest.importorskip("pyamg")
    blocks = plate().build().linearized.assembly.blocks
    assert not better_iterative(1_000, blocks, 1e3)
    assert not better_iterative(1_000_000, blocks, 1e11)
    assert better_iterative(1_000_000, blocks, 5e8)
    with pytest.raises(da.UnsupportedError, match="solver must be one of auto, direct, iterative"):
        da.solve_statics(plate().build(), solver="magic")


@pytest.mark.parametrize("limit", [0, 10**9])
@pytest.mark.parametrize("shape", [(7,), (7, 1), (7, 4), (7, 0)])
def test_dense_factors_solve_for_columns_together_and_one_by_one(shape, limit, monkeypatch):
    monkeypatch.setattr(factorise, "COLUMNWISE", limit)
    rng = np.random.default_rng(1)
    dense, rhs = rng.normal(size=(7, 7)), rng.normal(size=shape)
    factors = factorise.DenseFactors(dense)
    for trans, own in {"N": dense, "T": dense.T}.items():
        solution = factors.solve(rhs, trans)
        assert solution.shape == shape
        np.testing.assert_allclose(own @ solution, rhs, atol=1e-12)


@pytest.mark.parametrize("trans", ["N", "T"])
def test_sparse_factors_solve_for_groups_of_columns(trans):
    """More columns at once are left to threads of BLAS, which start slowly."""
    system, rhs = matrix("general"), np.random.default_rng(2).normal(size=(60, 21))
    factors, widths = SuperLUFactors(system), []

    class Recorded:
        def solve(self, part, trans):
            widths.append(part.shape[1])
            return factors.solve(part, trans)

    group = SuperLUFactors(system)
    group._factors = Recorded()
    left = system if trans == "N" else system.T
    np.testing.assert_allclose(left @ group.solve(rhs, trans), rhs, atol=1e-10)
    assert sum(widths) == 21 and max(widths) <= 8
