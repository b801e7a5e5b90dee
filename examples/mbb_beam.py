"""The MBB beam: topology optimisation with a thousand parameters.

The model is half of a beam on two supports with a central load. Every element has a density; its
modulus is the cube of the densities around it, weighted by a cone (SIMP with a density filter). The
compliance is minimised for half of the volume, with adjoint gradients and the method of moving
asymptotes. The problem is that of Sigmund (2001); Andreassen et al. (2011) report a compliance of
233.71 for 60 by 20 elements and this filter, by 88 lines of Matlab and optimality criteria.

    python examples/mbb_beam.py FOLDER 60
"""

import sys

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import structures

SHARE, POWER, VOID = 0.5, 3, 1e-9


def weights(columns: int, rows: int) -> np.ndarray:
    """(elements, elements) cone of a radius of 4 % of the length, rows of sum one."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    middles = np.column_stack([x.ravel(), y.ravel()])
    apart = np.linalg.norm(middles[:, None] - middles, axis=2)
    cone = np.maximum(max(0.04 * columns, 1.5) - apart, 0)
    return cone / cone.sum(axis=1, keepdims=True)


def build(columns: int = 30) -> tuple[da.Structure, da.Expression]:
    """The beam and its volume, as a share of what could be filled."""
    rows = columns // 3
    beam = da.Structure("MBB beam")
    density = [beam.parameter(f"rho{k}", SHARE, bounds=(0.0, 1.0)) for k in range(columns * rows)]
    cone = ca.sparsify(ca.DM(weights(columns, rows)))
    filtered = ca.mtimes(cone, ca.vertcat(*(one.sx for one in density)))
    moduli = [
        da.Expression(VOID + (1 - VOID) * filtered[k] ** POWER) for k in range(columns * rows)
    ]
    points, cells = structures.rectangle_mesh((columns, rows), (columns, rows), "quad")
    middle = points[cells].mean(axis=1).astype(int)  # numbered as the densities are
    order = middle[:, 0] * rows + middle[:, 1]
    mesh = beam.add_mesh(
        "beam",
        (points, cells),
        thickness=1.0,
        modulus=np.array([moduli[k] for k in order], dtype=object),
        poisson=0.3,
    )
    beam.support(mesh.nodes().where(x=0), ux=0)
    beam.support(mesh.nodes().where(x=columns, y=0), uy=0)
    beam.load(mesh.nodes().where(x=0, y=rows), fy=-1.0)
    return beam, da.Expression(ca.sum1(filtered) / (columns * rows), "volume")


def main(folder=None, columns=30) -> dict[str, float]:
    columns = int(columns)
    beam, volume = build(columns)
    best = da.optimize(
        beam.build(),
        da.final("2*strain_energy", name="compliance"),
        subject_to=[da.Limit(da.final(volume), upper=SHARE)],
        analysis=da.Statics(),
        method="mma",
        max_iterations=120,
        tolerance=1e-5,
    )
    own = np.array(list(best.x.values()))
    filtered = (weights(columns, columns // 3) @ own).reshape(columns, columns // 3)
    numbers = {
        "compliance of the uniform beam": best.history[0].objective,
        "compliance": best.fun,
        "volume": float(filtered.mean()),
        "analyses": float(best.runs),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    print(best.message)
    if folder:
        picture(folder, filtered, [i.objective for i in best.history])
    return numbers


def picture(folder, filtered: np.ndarray, history: list[float]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 2.8), width_ratios=(2.2, 1))
    whole = np.vstack([filtered[::-1], filtered]).T
    left.imshow(whole, origin="lower", cmap="Greys", vmin=0, vmax=1, interpolation="nearest")
    left.set(title=f"density, compliance {history[-1]:.1f}", xticks=[], yticks=[])
    left.grid(visible=False)
    right.semilogy(history)
    right.set(title="compliance", xlabel="iteration")
    style.save(figure, folder, "mbb_beam")


if __name__ == "__main__":
    main(*sys.argv[1:])
