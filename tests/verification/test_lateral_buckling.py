"""A thin beam that a crank pushes up at its tip until it gives way sideways.

Data of the benchmark of Bauchau, Betsch, Cardona, Gerstmayr, Jonker, Masarati and Sonneville
(Validation of flexible multibody dynamics beam formulations using benchmark problems, Multibody
System Dynamics 37, 2016; its histories are curves): a clamped beam of 1 m, a link of 0.25 m on a
ball joint 0.1 mm beside its tip, a crank of 0.05 m turned by half a turn in 0.4 s.

- The heights of the middle before it gives way are those of the run that Sonneville keeps with his
  code (github.com/vspsonn/mb_sef_py, examples/beam_lateralbuckling; 20 elements on the special
  Euclidean group, generalised α with ρ = 0.9 and 1 ms). That run has no offset and buckles by
  rounding, so only the size of its sideways motion is comparable.
- The static tip load is 4.0126 √(E I_z G J)/L² (Michell 1899, Prandtl 1899), divided by
  √((1 − I_z/I_y)(1 − G J/E I_y)) for the bend that it has before.

Sideways at 0.156 s the middle is at −40.315, −40.425, −40.452 mm with steps of 1, 1/2 and 1/4 ms
(four elements of third order), −40.845 mm with two elements and the shortest step; from 0.2 s on
runs part: at 0.216 s −19.2, −18.4 and −18.2 mm.
"""

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

EI, EI_STRONG, GJ, TIME, OFFSET = 608.3, 60830.0, 877.2, 0.4, 1e-4
BEAM = {
    "length": 1.0,
    "axial_rigidity": 73e6,
    "shear_rigidity": 5.025e6,
    "shear_rigidity_z": 23.40e6,
    "torsional_rigidity": GJ,
    "bending_rigidity_y": EI_STRONG,
    "bending_rigidity_z": EI,
    "mass_per_length": 2.68,
    "rotary_inertia": (2.233e-3 + 22.33e-6, 2.233e-3, 22.33e-6),
}
HEIGHTS = {0.012: 1.0871033e-4, 0.048: 1.7219082e-3, 0.096: 6.4506312e-3, 0.12: 9.3838768e-3}
SIDEWAYS = 0.0437


def round_bar(axial: float, shear: float, twist: float, bend: float, mass: float, rotary: float):
    return {
        "axial_rigidity": axial,
        "shear_rigidity": shear,
        "torsional_rigidity": twist,
        "bending_rigidity_y": bend,
        "bending_rigidity_z": bend,
        "mass_per_length": mass,
        "rotary_inertia": (2 * rotary, rotary, rotary),
        "elements": 1,
        "order": 2,
    }


def mechanism() -> da.Model:
    system = da.System("lateral buckling", gravity=(0, 0, 0))
    ground, y, here = system.ground, {"axis": (0, 1, 0)}, (0, 0, 0)
    beam = system.add(spatial.Beam("beam", ground.frame(here), **BEAM, elements=4, order=2))
    link = system.add(
        spatial.Beam(
            "link",
            length=0.25,
            **round_bar(33.02e6, 10.81e6, 914.5, 1189.0, 1.212, 43.65e-6),
            position=(1, OFFSET, 0),
            rotation=np.column_stack([(0, 0, -1), (0, 1, 0), (1, 0, 0)]),
            relaxed=False,
        )
    )
    hub = (0.95, OFFSET, -0.25)
    crank = system.add(
        spatial.Beam(
            "crank",
            length=0.05,
            **round_bar(132.1e6, 43.22e6, 14630.0, 19020.0, 4.85, 698.3e-6),
            position=hub,
            rotation=np.eye(3),
        )
    )
    turned = da.where(da.t < TIME, np.pi / 2 * (1 - da.cos(np.pi * da.t / TIME)), np.pi)
    hinge = spatial.Revolute("hinge", ground.frame(hub, **y), crank.start.frame(here, **y))
    system.add(hinge)
    system.add(spatial.RotationalDriver("motor", hinge, -turned))
    system.add(spatial.Revolute("pin", crank.end.frame(here, **y), link.end.frame(here, **y)))
    tip = beam.end.frame((0, OFFSET, 0))
    system.add(spatial.Spherical("ball", tip, link.start.frame(here)))
    return system.build()


@pytest.mark.thorough
def test_buckling_under_way():
    motion = da.solve_dynamics(mechanism(), 0.182, step=1e-3, integrator=da.GeneralizedAlpha(0.9))
    assert motion.status.success
    middle = np.c_[motion["beam.node4.y"].values, motion["beam.node4.z"].values]
    for time, height in HEIGHTS.items():
        computed = middle[np.argmin(abs(motion.time - time)), 1]
        assert computed == pytest.approx(height, rel=2.5e-3)
    before = motion.time < 0.1
    assert abs(middle[before, 0]).max() < OFFSET
    assert abs(middle[:, 0]).max() == pytest.approx(SIDEWAYS, rel=0.1)


@pytest.mark.thorough
def test_static_load_of_a_tip():
    system = da.System("cantilever", gravity=(0, 0, 0))
    load = system.parameter("load", 0.0, "N")
    beam = system.add(spatial.Beam("beam", system.ground.frame((0, 0, 0)), **BEAM, elements=4))
    system.add(spatial.Force("push", beam.end.center, (0, 0, load)))
    model = system.build()
    narrow = 4.0126 * np.sqrt(EI * GJ)
    expected = narrow / np.sqrt((1 - EI / EI_STRONG) * (1 - GJ / EI_STRONG))

    def growth(share: float) -> float:
        """Square of the rate at which it moves sideways, which crosses zero straight."""
        modes = da.linearize(model, parameters={"load": share * expected}).data
        rate = modes["eigenvalue_real"].values + 1j * modes["eigenvalue_imag"].values
        slowest = rate[np.argmin(abs(rate))]
        return float((slowest**2).real)

    below, above = growth(0.99), growth(1.01)
    assert below < 0 < above
    critical = 0.99 - below * 0.02 / (above - below)
    assert critical == pytest.approx(1.0, abs=3e-3)
