"""A cantilever plate of quadrilaterals beside scikit-fem, and what a gradient costs.

Linear statics of a 2 m × 1 m plate in plane stress, one side held, the other pulled down.
scikit-fem assembles the same matrix (bilinear quadrilaterals, 2 × 2 points), and SciPy's SuperLU
factors it with the order and pivots that suit it best; dalembert takes its usual solver.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np
import scipy.sparse.linalg as linalg

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from benchmarks.solvers.base import installed
from dalembert import structures

MODULUS, POISSON, THICKNESS, PULL = 2e11, 0.3, 0.01, -1000.0


def grid(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and quadrilaterals, ``rows`` along the short side."""
    x, y = np.meshgrid(np.linspace(0, 2, 2 * rows + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    i, j = np.meshgrid(np.arange(2 * rows), np.arange(rows), indexing="ij")
    first = (i * (rows + 1) + j).ravel()
    cells = np.column_stack([first, first + rows + 1, first + rows + 2, first + 1])
    return np.column_stack([x.ravel(), y.ravel()]), cells


def build(rows: int, parameters: int) -> da.Structure:
    """The plate with its thickness in ``parameters`` patches."""
    points, cells = grid(rows)
    structure = da.Structure("plate")
    h = [structure.parameter(f"h{k}", THICKNESS) for k in range(parameters)]
    nodes = structure.add_nodes("nodes", points)
    patch = np.arange(len(cells)) * parameters // len(cells)
    thickness = np.array(h, dtype=object)[patch]
    given = {"thickness": thickness, "modulus": MODULUS, "poisson": POISSON}
    structure.add_elements("skin", structures.Quadrilateral, nodes, cells, **given)
    structure.support(nodes.where(x=0.0))
    edge = nodes.where(x=2.0)
    structure.load(edge, fy=PULL / len(edge))
    return structure


def peer(rows: int) -> Callable[[], tuple[float, float, float]]:
    """Assembly and whole analysis by scikit-fem: seconds, seconds, deflection."""
    from skfem import BilinearForm, ElementQuad1, ElementVector, InteriorBasis, MeshQuad, condense
    from skfem.helpers import ddot, eye, sym_grad, trace

    points, cells = grid(rows)
    mesh = MeshQuad(points.T.copy(), cells.T.copy())
    basis = InteriorBasis(mesh, ElementVector(ElementQuad1()), intorder=3)
    shear = MODULUS / (2 * (1 + POISSON))
    bulk = MODULUS * POISSON / (1 - POISSON**2)

    @BilinearForm
    def stiffness(u, v, _):
        strain = sym_grad(u)
        stress = 2 * shear * strain + bulk * eye(trace(strain), 2)
        return THICKNESS * ddot(stress, sym_grad(v))

    def run() -> tuple[float, float, float]:
        start = time.perf_counter()
        matrix = stiffness.assemble(basis)
        assembled = time.perf_counter()
        load = np.zeros(matrix.shape[0])
        edge = basis.nodal_dofs[1][np.flatnonzero(points[:, 0] == 2.0)]
        load[edge] = PULL / edge.size
        held = basis.nodal_dofs[:, points[:, 0] == 0.0].ravel()
        free = np.setdiff1d(np.arange(load.size), held)
        inner = condense(matrix, load, D=held, expand=False)
        options = {"permc_spec": "MMD_AT_PLUS_A", "options": {"SymmetricMode": True}}
        u = np.zeros(load.size)
        u[free] = linalg.splu(inner[0].tocsc(), diag_pivot_thresh=0.0, **options).solve(inner[1])
        return assembled - start, time.perf_counter() - start, float(u.min())

    return run


def seconds(call: Callable[[], object]) -> float:
    """Wall time of one call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def measure(effort: Effort) -> Iterator[Row]:
    rows, parameters = (10, 20) if effort.quick else (160, 200)
    model = build(rows, parameters).build()
    linear, rest = model.linearized, np.zeros(len(model.degrees))
    result = da.solve_statics(model)
    compliance, stress = da.final("compliance"), da.final("skin.sxx.max")
    jobs: dict[str, Callable[[], object]] = {
        "assembly": lambda: linear.assembly.stiffness(rest, model.nominal),
        "analysis": lambda: da.solve_statics(model),
        f"adjoint of the compliance by {parameters}": lambda: da.sensitivity(result, compliance),
        f"adjoint of a stress by {parameters}": lambda: da.sensitivity(result, stress),
    }
    spent: dict[str, list[float]] = {name: [] for name in jobs}
    theirs: list[tuple[float, float, float]] = []
    other = peer(rows) if installed("skfem") else None
    for job in jobs.values():
        job()  # compiles
    for _ in range(effort.rounds):
        if other is not None:
            theirs.append(other())
        for name, job in jobs.items():
            spent[name].append(seconds(job))
    if theirs:
        gap = abs(theirs[0][2] / result.displacements.min() - 1)
        assert gap < 1e-8, f"deflections differ by {gap:.1e}"
    whole = float(np.median(spent["analysis"]))
    for k, (name, found) in enumerate(spent.items()):
        note = str(result.statistics["solver"]) if name == "analysis" else ""
        if k > 1:
            note = f"{np.median(found) / whole:.2f} analyses"
        row = Row(f"plate of {len(model.degrees)} unknowns", name)
        row.samples["dalembert"] = Sample.of(found, "s", note)
        if theirs and k < 2:
            row.samples["scikit-fem"] = Sample.of([t[k] for t in theirs], "s")
        yield row


CASE = Case("plate", "linear statics of a plate, and gradients", measure)
