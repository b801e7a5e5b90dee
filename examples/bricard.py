"""Bricard's mechanism: a loop of six hinges that moves although its count of freedom is zero.

Gruebler's formula yields zero, but for these lengths and axes one of the thirty equations is
redundant. The diagnosis names it. ``AugmentedLagrangian`` retains all equations; ``RangeSpace``,
used here, removes one. IFToMM benchmark A04: five rods of 1 m and 1 kg, released at rest.
"""

import sys
from itertools import pairwise

import numpy as np
import style

import dalembert as da
from dalembert import spatial

POINTS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
AXES = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)], float)


def build() -> da.System:
    system = da.System("Bricard", gravity=(0.0, -9.81, 0.0))
    bodies, middles = [system.ground], [np.zeros(3)]
    for k, (start, end) in enumerate(pairwise(POINTS), start=1):
        along, middle = abs(end - start) > 0.5, (start + end) / 2
        rod = spatial.Body(
            f"rod{k}",
            mass=1.0,
            inertia=tuple(np.where(along, 1 / 600, 1.01 / 12)),
            position=tuple(middle),
            rotation=da.rotation.identity(),
            points={"start": tuple(start - middle), "end": tuple(end - middle)},
        )
        bodies.append(system.add(rod))
        middles.append(middle)
    for k, (point, axis) in enumerate(zip(POINTS, AXES, strict=True)):
        ends = (
            bodies[n].frame(tuple(point - middles[n]), axis=tuple(axis)) for n in (k, (k + 1) % 6)
        )
        system.add(spatial.Revolute(f"J{k}", *ends))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    (redundancy,) = model.diagnosis.redundancies
    motion = da.solve_dynamics(
        model,
        10.0,
        integrator=da.DormandPrince(1e-8, 1e-8),
        outputs=501,
    )
    numbers = {
        "degrees of freedom": float(model.diagnosis.degrees_of_freedom),
        "degrees of freedom by Gruebler": float(model.diagnosis.gruebler),
        "x of P2 after 10 s [m]": float(motion["rod2.end.x"][-1]),
        "largest error of the energy [J]": float(abs(motion["balance_error"]).max()),
    }
    print(redundancy, *(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, 0.6, trace="rod2.end")
        left.set_title("after 0.6 s, and path of P2")
        for axis in "xyz":
            right.plot(motion.time, motion[f"rod2.end.{axis}"], label=axis)
        right.set(xlabel="time [s]", ylabel="P2 [m]", title="released at rest")
        right.legend(ncols=3)
        style.save(figure, folder, "bricard")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
