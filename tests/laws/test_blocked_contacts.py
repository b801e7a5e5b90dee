"""Contacts of driven bodies: those that nothing opens, and those that look blocked and are not."""

import numpy as np
import pytest
import scipy

import dalembert as da
from dalembert import planar
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus

contact = planar.contact


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_a_driver_that_presses_a_held_body_has_no_solution(integrator):
    """A ram moves towards the axis of a wheel: its speed over the rounding of a mobility that is
    zero is no impulse."""
    system = da.System("press", gravity=(0, -9.81))
    ram = system.add(planar.Body("ram", mass=1.0, inertia=0.1, position=(0.04, 0.13)))
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.01, position=(0, 0)))
    system.add(planar.Revolute("pin", system.ground.center, wheel.center))
    guide = system.add(planar.Prismatic("guide", system.ground.center, ram.center, axis=(0.3, 1)))
    system.add(planar.TranslationalDriver("drive", guide, 0.13 - 0.1 * da.t))
    shapes = [contact.Rectangle(ram, (0.1, 0.02)), contact.Circle(wheel, 0.1)]
    system.add(planar.Collisions("touch", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=1e-3, integrator=integrator)
    assert not motion.status.success
    assert abs(motion.record.loss).max() == 0.0
    assert abs(motion.record.impulse).max(initial=0.0) == 0.0


def test_many_contacts_of_one_freedom():
    """Six gaps of one pinned body, of which one closes; arms and speeds of two gears in mesh."""
    table = np.array(
        [
            [-1.421, 0.366, -0.021, 0.099],
            [1.539, 0.2, 0.678, 0.01],
            [-1.508, 0.192, 0.433, 0.099],
            [-1.46, 0.292, 0.055, 0.098],
            [-1.407, 0.379, -0.022, 0.099],
            [-1.353, 0.454, 0.259, 0.102],
        ]
    )
    arms, velocity, friction = table[:, :2], table[:, 2:], np.full((6, 1), 0.1)
    directions = scipy.sparse.csr_array(arms.reshape(-1, 1))
    inertia, joints = scipy.sparse.csr_array(np.eye(1)), scipy.sparse.csr_array((0, 1))
    matrix = Delassus(directions, directions.copy(), inertia, joints, np.zeros(12))
    solution = da.ContactSolver().solve(FrictionProblem(matrix, velocity, friction, (1,), 0.17))
    assert solution.converged
    speed = float((arms * solution.impulses).sum())  # the fifth gap closes first
    assert speed == pytest.approx(-0.022 / 1.407, rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("beside", [1e-5, 1e-6])
def test_an_obtuse_corner_passes_the_corner_of_a_tooth(beside):
    """It is beside the flank of the tooth, below which no corner of it can hit the top."""
    system = da.System("tooth", gravity=(0, 0))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=0.1, position=(-beside, 0.01)))
    rail = system.ground.point(-beside, 0)
    guide = system.add(planar.Prismatic("guide", rail, slider.center, axis=(0, 1)))
    system.add(planar.TranslationalDriver("drive", guide, 0.01 - 0.5 * da.t))
    bulged = [(-0.05, -0.05), (-0.002, -0.05), (0.0, 0.0), (-0.002, 0.05), (-0.05, 0.05)]
    tooth = [(0.0, -0.2), (0.1, -0.2), (0.1, 0.0), (0.0, 0.0)]
    shapes = [contact.Outline(slider, bulged), contact.Outline(system.ground, tooth)]
    system.add(planar.Collisions("touch", shapes, friction=0.1))
    motion = da.solve_nonsmooth(system.build(), 0.04, step=1e-3)
    assert motion.status.success
    assert motion.impulse("touch").sum() == 0.0
    assert motion["slider.y"][-1] == pytest.approx(-0.01)
