"""Beams without joints in ``solve_nonsmooth``: energy of thin ropes, gradients of their steps."""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

contact = planar.contact


def thrown(elements: int = 10) -> da.Model:
    """An undamped rope that a force whips, above a floor that it does not reach."""
    system = da.System("thrown rope", gravity=(0, -9.81))
    push = system.parameter("push", 0.5)
    data = {"axial_rigidity": 1e3, "shear_rigidity": 1e3, "bending_rigidity": 1e-3}
    data |= {"mass_per_length": 0.1, "rotary_inertia": 1e-5, "elements": elements, "order": 1}
    start = {"position": (0, 50), "angle": 0.3, "angular_velocity": 6.0, "velocity": (1, 0)}
    rope = system.add(planar.Beam("rope", length=0.5, curvature=3.0, **data, **start))
    system.add(planar.Force("whip", rope.end, (push * da.sin(20 * da.t), 0)))
    shapes = [contact.BeamLine(rope, 0.004), contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("touch", shapes, friction=0.3))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("step", [2e-3, 4e-3])
def test_a_whipped_rope_does_not_gain_energy(step):
    """With linearised forces it gained 10⁸ times its energy; steps of 4 ms are divided."""
    motion = da.solve_nonsmooth(thrown(), 0.5, step=step)
    assert motion.status.success
    assert np.abs(motion.data.balance_error).max() < 1e-6
    assert motion["rope.strain_energy"].max() < 0.2


def test_gradients_of_steps_with_means_over_the_path():
    model, final = thrown(4), [da.final("rope.end.x"), da.final("rope.node2.angle")]
    motion = da.solve_nonsmooth(model, 0.05, step=2e-3)
    direct, adjoint = (
        da.sensitivity(motion, final, method=method).sel(parameter="push").values
        for method in ("direct", "adjoint")
    )
    ends = []
    for push in (0.5 + 1e-4, 0.5 - 1e-4):
        run = da.solve_nonsmooth(model, 0.05, step=2e-3, parameters={"push": push})
        ends.append([run[response.measure].values[-1] for response in final])
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9)
    np.testing.assert_allclose(direct, np.subtract(*ends) / 2e-4, rtol=1e-6)
