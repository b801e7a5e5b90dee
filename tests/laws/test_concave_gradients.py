"""Gradients of motions along concave gaps: direct, adjoint, differences.

Steps of ``AnticipatedImpacts`` take means of velocities over the path where bodies on these become
faster, as directions in the middle of the step then leave gaps closed at its end. Bodies begin in
contact for all parameters, so that differences of the run confirm the derivatives.
"""

from __future__ import annotations

import numpy as np
import pytest
from directional import assert_slopes

import dalembert as da
from dalembert import planar

BOWL = 0.5
SCHEME = da.AnticipatedImpacts()
SOLVER = da.ContactSolver(tolerance=1e-13)


def rolling_disc() -> da.Model:
    """A disc in a bore, on its circle at any angle, with a speed along it."""
    system = da.System("disc in a bore", gravity=(0.0, -9.81))
    size, mass = system.parameter("size", 0.1, "m"), system.parameter("mass", 2.0, "kg")
    lean, speed = system.parameter("lean", 0.6, "rad"), system.parameter("speed", -0.3, "m/s")
    friction, bowl = system.parameter("friction", 0.1), system.parameter("bowl", BOWL, "m")
    arm = bowl - size
    start = {"position": (arm * da.sin(lean), -arm * da.cos(lean)), "angle": 0.0}
    start |= {"velocity": (speed * da.cos(lean), speed * da.sin(lean))}
    disc = planar.Body("body", mass=mass, inertia=mass * size**2 / 2, **start)
    shapes = [planar.contact.Circle(system.add(disc), size)]
    shapes.append(planar.contact.Bore(system.ground.center, bowl))
    system.add(planar.Collisions("touch", shapes, friction=friction))
    return system.build()


def box_in_a_bore() -> da.Model:
    """Two corners slide on the circle."""
    system = da.System("box in a bore", gravity=(0.0, -9.81))
    width, height = system.parameter("width", 0.3, "m"), system.parameter("height", 0.2, "m")
    lean, turn = system.parameter("lean", 0.5, "rad"), system.parameter("turn", -1.0, "rad/s")
    friction = system.parameter("friction", 0.1)
    arm = da.sqrt(BOWL**2 - width**2 / 4) - height / 2
    start = {"position": (arm * da.sin(lean), -arm * da.cos(lean)), "angle": lean}
    start |= {"velocity": (turn * arm * da.cos(lean), turn * arm * da.sin(lean))}
    box = planar.Body("body", mass=1.0, inertia=0.01, angular_velocity=turn, **start)
    shapes = [planar.contact.Rectangle(system.add(box), (width, height))]
    shapes.append(planar.contact.Bore(system.ground.center, BOWL))
    system.add(planar.Collisions("touch", shapes, friction=friction))
    return system.build()


def disc_in_a_valley() -> da.Model:
    """A disc on a smooth curve, from its lowest point."""
    system = da.System("disc in a valley", gravity=(0.0, -9.81))
    size, speed = system.parameter("size", 0.1, "m"), system.parameter("speed", 0.8, "m/s")
    friction, pull = system.parameter("friction", 0.2), system.parameter("pull", 5.0, "N")
    start = {"position": (0.0, size), "velocity": (speed, 0.0), "angle": 0.0}
    disc = system.add(planar.Body("body", mass=1.0, inertia=0.005, **start))
    system.add(planar.Force("pull", disc.center, (pull, 0.0)))
    u = da.curves.u
    curve = da.FormulaCurve(-u, u**2, -1.0, 1.0, closed=False)
    shapes = [planar.contact.Circle(disc, size), planar.contact.Profile(system.ground, curve)]
    system.add(planar.Collisions("touch", shapes, friction=friction))
    return system.build()


NAMES = ["body.x", "body.vx", "body.angle"]
CHANGE = 1e-4
"""Relative change of the parameters."""
MODELS = {"disc": rolling_disc, "box": box_in_a_bore, "valley": disc_in_a_valley}


@pytest.mark.thorough
@pytest.mark.parametrize("name", MODELS)
def test_run_along_a_concave_gap(name):
    motion = da.solve_nonsmooth(MODELS[name](), 0.05, step=5e-3, integrator=SCHEME, solver=SOLVER)
    record = motion.record
    assert motion.status.success
    assert np.unique(record.step[record.curved]).size > 7
    responses = [da.final(name) for name in NAMES]
    direct, adjoint = (
        da.sensitivity(motion, responses, method=method) for method in ("direct", "adjoint")
    )
    scale = abs(direct.values).max()
    np.testing.assert_allclose(adjoint.values, direct.values, rtol=1e-9, atol=1e-11 * scale)
    p = np.array([parameter.value for parameter in motion.model.parameters.values()])

    def ends(parameters: np.ndarray) -> np.ndarray:
        other = motion.analysis.run(motion.model, parameters)
        return np.array([other[name][-1].item() for name in NAMES])

    assert_slopes(direct.values, ends, p, CHANGE, 1e-6)
