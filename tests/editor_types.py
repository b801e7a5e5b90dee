"""What editors and checkers know of the public names; mypy judges it with the package.

Calls that are wrong stand here with the error that they must give: mypy refuses an ``ignore`` that
nothing needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_type

import numpy as np

import dalembert as da
from dalembert import planar, spatial

if TYPE_CHECKING:
    system = da.System("x")
    bob = system.add(planar.Bar("bob", length="1 m", mass=1.0))
    assert_type(bob, planar.Bar)
    hinge = system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), bob.start))
    assert_type(hinge, spatial.Spherical)
    model = system.build()
    motion = da.solve_dynamics(model, "1 s", step=0.1, integrator=da.RK4(), outputs=[0.0, "1 s"])
    assert_type(motion, da.Motion)
    assert_type(motion.at([0.1]), da.Motion)
    assert_type(motion.at(0.1), da.Motion)
    driven = da.solve_kinematics(model, 1.0, step="1 ms")
    assert_type(driven.at(np.array([0.1])), da.Motion)
    structure = da.Structure("s")
    bar = structure.add(
        da.structures.Truss("t", structure.node("a", 0), structure.node("b", 1), area=1, modulus=1)
    )
    assert_type(bar, da.structures.Truss)
    da.solve_dynamics(model, 1.0, stp=0.1)  # type: ignore[call-overload]
    da.solve_dynamics(model, 1.0, integrator="RK4")  # type: ignore[call-overload]
    da.solve_statics(structure.build(), solvr="auto")  # type: ignore[call-overload]
