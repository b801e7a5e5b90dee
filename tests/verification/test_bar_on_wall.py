"""An elastic bar is thrown against a wall (Doyen, Ern and Piperno 2011; textbook wave solution).

L = 10, E = 900, ρ = 1, 10 m/s, 5 away: it touches at 0.5 s, the wall gives ``√(Eρ) v = 300`` until
a wave has gone along it and back, ``2 L/c = 2/3`` s, and it leaves with the speed it came with.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures

COUNT = 40


def test_force_and_time_of_contact():
    structure = structures.Structure("bar")
    nodes = [structure.node(f"n{k}", 5 + 10.0 * k / COUNT, 0.0) for k in range(COUNT + 1)]
    for k in range(COUNT):
        ends = nodes[k], nodes[k + 1]
        structure.add(structures.Truss(f"e{k}", *ends, area=1.0, modulus=900.0, density=1.0))
    system = da.System("bar")
    bar = system.include("bar", structure, velocity=(-10.0, 0.0))
    system.add(planar.UnilateralConstraint("wall", system.formula("bar_n0.x"), restitution=0.0))
    integrator = da.DormandPrince(rtol=1e-6, atol=1e-8)
    motion = da.solve_dynamics(system.build(), 1.4, integrator=integrator, outputs=1401)
    assert motion.status.success
    assert motion.impacts[0].time == pytest.approx(0.5, abs=1e-6)
    time, force = motion.time, motion["wall.normal_force"].values
    assert time[force > 0].max() == pytest.approx(0.5 + 2 / 3, rel=0.02)
    within = (time > 0.55) & (time < 1.1)  # away from the oscillations of both fronts
    assert force[within].mean() == pytest.approx(300.0, rel=0.02)
    momentum = np.mean([motion[f"bar_n{k}.vx"].values[-1] for k in range(COUNT + 1)])
    assert momentum == pytest.approx(10.0, rel=0.05)
