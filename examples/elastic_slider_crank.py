"""Slider-crank with an elastic connecting rod: deflection of its mid-point.

Data of Simeon (Modelling a flexible slider crank mechanism by a mixed system of DAEs and PDEs,
Mathematical Modelling of Systems 2, 1996): a steel rod, driven at 150 rad/s.
"""

import itertools
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar
from dalembert.structures import Frame

CRANK, ROD, WIDTH, SPEED = 0.15, 0.3, 0.008, 150.0
MODULUS, DENSITY = 2e11, 7870.0


def rod_structure(elements: int = 8):
    structure = da.Structure("rod")
    section = {"area": WIDTH**2, "second_moment": WIDTH**4 / 12}
    nodes = [structure.node(f"n{k}", ROD * k / elements, 0.0) for k in range(elements + 1)]
    for k, ends in enumerate(itertools.pairwise(nodes)):
        beam = Frame(f"e{k}", *ends, **section, modulus=MODULUS, density=DENSITY)
        structure.add(beam)
    return structure.build()


def build(stiffening: bool = True) -> da.System:
    system = da.System("elastic slider-crank")
    speed = system.parameter("speed", SPEED, "rad/s")
    m_piston = system.parameter("m_piston", 0.0755, "kg")
    crank = system.add(planar.Bar("crank", length=CRANK, mass=0.36, angle=0.0))
    rod = system.add(
        planar.FlexibleBody(
            "rod",
            rod_structure(),
            interface={"big_end": "n0", "middle": "n4", "small_end": "n8"},
            modes=1,
            reference="big_end",
            stiffening=stiffening,
            angle=0.0,
        )
    )
    piston = system.add(planar.Particle("piston", mass=m_piston, position=(CRANK + ROD, 0.0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.point("big_end")))
    system.add(planar.Revolute("B", rod.point("small_end"), piston.center))
    system.add(planar.PinInSlot("guide", system.ground.center, piston.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, speed * da.t))
    return system


def bend(motion: da.Motion) -> np.ndarray:
    """Distance of the middle from the line between the ends, to its left."""
    ends = [motion[f"rod.{end}.position"].values for end in ("big_end", "small_end")]
    along = ends[1] - ends[0]
    off = motion["rod.middle.position"].values - ends[0]
    return (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.linalg.norm(along, axis=1)


def main(folder=None) -> dict[str, float]:
    motions = {
        "with stiffening by axial forces": solved(True),
        "small displacements only": solved(False),
    }
    bent = {name: bend(motion) for name, motion in motions.items()}
    numbers = dict(zip(("bend", "linear"), (abs(b).max() for b in bent.values()), strict=True))
    print(
        f"the middle of the rod bends up to {1e3 * numbers['bend']:.2f} mm off the line of its "
        f"ends; without what the axial force adds, {1e3 * numbers['linear']:.2f} mm"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2))
        motion = motions["with stiffening by axial forces"]
        worst = float(motion.time[np.argmax(abs(bend(motion)))])
        style.draw(left, motion, worst)
        left.set(title=f"t = {1e3 * worst:.1f} ms", xlabel="x [m]", ylabel="y [m]")
        for name, motion in motions.items():
            right.plot(1e3 * motion.time, 1e3 * bent[name], label=name)
        right.set(title="middle off the line of the ends [mm]", xlabel="t [ms]")
        right.legend(loc="lower left")
        style.save(figure, folder, "elastic_slider_crank")
    return numbers


def solved(stiffening: bool) -> da.Motion:
    model = build(stiffening).build()
    return da.solve_dynamics(model, 0.05, step=2.5e-4, integrator=da.Radau(fixed=True))


if __name__ == "__main__":
    main(*sys.argv[1:2])
