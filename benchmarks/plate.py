"""A cantilever plate of quadrilaterals: dalembert beside scikit-fem, and what a gradient costs.

Linear statics of a 2 m × 1 m plate in plane stress, one side held, the other pulled down. First
table: assembly of the stiffness, the whole analysis (assembly, factors, solution, reactions, check
for mechanisms), one adjoint gradient of the compliance and of the largest stress by all
thicknesses, and one column of the direct method, in units of the analysis. scikit-fem assembles the
same matrix (bilinear quadrilaterals, 2 × 2 points); both are factorised by SciPy's SuperLU with the
same options. Second, with ``--large``: a plate and a truss of a million unknowns, each in a process
of its own, with the memory they needed.

    pip install "dalembert[bench]" && python benchmarks/plate.py
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import scipy.sparse.linalg as linalg

import dalembert as da
from dalembert import structures

MODULUS, POISSON, THICKNESS, PULL = 2e11, 0.3, 0.01, -1000.0


def grid(rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and quadrilaterals, ``rows`` along the short side."""
    x, y = np.meshgrid(np.linspace(0, 2, 2 * rows + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    i, j = np.meshgrid(np.arange(2 * rows), np.arange(rows), indexing="ij")
    first = (i * (rows + 1) + j).ravel()
    cells = np.column_stack([first, first + rows + 1, first + rows + 2, first + 1])
    return np.column_stack([x.ravel(), y.ravel()]), cells


def build(rows: int, parameters: int, kind: str = "plate") -> da.Structure:
    """The plate with its thickness in ``parameters`` patches, or a truss of the same nodes."""
    points, cells = grid(rows)
    structure = da.Structure(kind)
    h = [structure.parameter(f"h{k}", THICKNESS) for k in range(parameters)]
    nodes = structure.add_nodes("nodes", points)
    if kind == "plate":
        patch = np.arange(len(cells)) * parameters // len(cells)
        structure.add_elements(
            "skin",
            structures.Quadrilateral,
            nodes,
            cells,
            thickness=np.array(h, dtype=object)[patch],
            modulus=MODULUS,
            poisson=POISSON,
        )
    else:
        sides = [cells[:, pair] for pair in ([0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3])]
        bars = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0)
        structure.add_elements(
            "bars", structures.Truss, nodes, bars, area=h[0] * 0.01, modulus=MODULUS
        )
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


def compare(rows: int, parameters: int, rounds: int) -> None:
    """The first table, in turns."""
    model = build(rows, parameters).build()
    linear, p = model.linearized, model.nominal
    rest = np.zeros(len(model.degrees))
    other = peer(rows)
    compliance, stress = da.final("compliance"), da.final("skin.sxx.max")
    one = ["h0"]

    def gradient(response, wrt=None, method="adjoint"):
        return lambda: da.sensitivity(result, response, wrt, method)

    result = da.solve_statics(model)
    jobs = {
        "assembly": lambda: linear.assembly.stiffness(rest, p),
        "analysis": lambda: da.solve_statics(model),
        "adjoint, compliance": gradient(compliance),
        "adjoint, largest stress": gradient(stress),
        "direct, one parameter": gradient(compliance, one, "direct"),
    }
    times: dict[str, list[float]] = {name: [] for name in jobs}
    theirs: list[tuple[float, float, float]] = []
    for name in jobs:
        jobs[name]()  # compiles
    for _ in range(rounds):
        theirs.append(other())
        for name, job in jobs.items():
            times[name].append(seconds(job))
    whole = statistics.median(times["analysis"])
    print(f"{len(model.degrees)} unknowns, {parameters} parameters")
    deflection = result.displacements.min()
    print(f"  deflection {deflection:.10e} m, scikit-fem {theirs[0][2]:.10e} m")
    fem = [statistics.median(column) for column in zip(*theirs, strict=True)]
    print(f"  scikit-fem: assembly {fem[0]:.3f} s, analysis {fem[1]:.3f} s")
    for name, found in times.items():
        middle = statistics.median(found)
        beside = {"assembly": fem[0], "analysis": fem[1]}.get(name)
        ratio = f"{beside / middle:6.2f} × as fast as scikit-fem" if beside else ""
        print(f"  {name:<26} {middle:8.3f} s {middle / whole:7.3f} analyses {ratio}")


def large(kind: str, rows: int) -> None:
    """One analysis and one gradient, with time and memory."""
    start = time.perf_counter()
    model = build(rows, 10, kind).build()
    built = time.perf_counter()
    result = da.solve_statics(model)
    solved = time.perf_counter()
    gradient = da.sensitivity(result, da.final("compliance"), method="adjoint")
    done = time.perf_counter()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"{kind}: {len(model.degrees)} unknowns, built {built - start:.1f} s, solved "
        f"{solved - built:.1f} s, gradient {done - solved:.1f} s, {memory:.1f} GiB at most, "
        f"residual {result.status.residual:.1e}, d compliance / d h0 {gradient.values[0, 0]:.6g}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rows", type=int, default=160, help="cells along the short side")
    parser.add_argument("--parameters", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--large", action="store_true", help="a million unknowns too")
    parser.add_argument("--only", choices=("plate", "truss"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.only:
        large(given.only, 500)
        return
    compare(given.rows, given.parameters, given.rounds)
    if given.large:
        for kind in ("plate", "truss"):
            subprocess.run([sys.executable, __file__, "--only", kind], check=True)


if __name__ == "__main__":
    main()
