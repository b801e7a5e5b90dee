"""Frequencies of a beam that spins about its clamped end, stiffened by its centrifugal force.

Across the plane of rotation they are tabulated (Wright, Smith, Thresher and Wang, Vibration modes
of centrifugally stiffened beams, Journal of Applied Mechanics 49, 1982) by ``η = Ω √(ρA L⁴/EI)``;
in it each square is less by ``η²``. What stiffens is tension, so the beam first comes to rest in
its stretched length, by some damping that shifts frequencies by less than a thousandth.
"""

from __future__ import annotations

import numpy as np
import pytest
from thorough import sampled

import dalembert as da
from dalembert import planar
from dalembert.structures import Frame

ACROSS = {
    0: (3.5160, 22.0345, 61.6972),
    2: (4.1373, 22.6149, 62.2732),
    4: (5.5850, 24.2733, 63.9668),
    6: (7.3604, 26.8091, 66.6839),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("speed", sampled(ACROSS, 3))
def test_frequencies_in_the_plane_of_rotation(speed):
    structure, count = da.Structure("arm"), 16
    nodes = [structure.node(f"n{k}", k / count, 0.0) for k in range(count + 1)]
    section = {"area": 1.0, "second_moment": 1e-4, "modulus": 1e4, "density": 1.0}
    for k in range(count):
        structure.add(Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    system = da.System("spinning")
    arm = system.add(
        planar.FlexibleBody(
            "arm",
            structure.build(),
            interface={"root": "n0", "tip": f"n{count}"},
            modes=4,
            reference="root",
            stiffening=True,
            damping_ratio=0.02,
            position=(0, 0),
            angle=0.0,
            angular_velocity=float(speed),
        )
    )
    system.add(planar.Revolute("hub", system.ground.center, arm.point("root")))
    system.add(planar.RotationalDriver("motor", system.ground, arm, speed * da.t))
    steady = da.solve_dynamics(system.build(), 2.0, step=2e-3)  # until it is stretched
    spectrum = da.linearize(steady.model, about=steady).data["frequency"].values
    computed = np.sort(2 * np.pi * spectrum[spectrum > 0.1])[:3]
    expected = np.sqrt(np.array(ACROSS[speed]) ** 2 - speed**2)
    np.testing.assert_allclose(computed, expected, rtol=1e-2)
