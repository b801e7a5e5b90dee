"""Woodpecker toy: a sleeve with play on a pole, a bird on a spring (Pfeiffer & Glocker 1996, 12.1).

Data and reference: Siconos (Acary and others, INRIA), example Woodpecker, file ``Woodpecker.ref``,
Moreau–Jean scheme with ``θ = 1/2`` and ``h = 2e-5 s``; ``(t, y, φ_S)`` of two of its rows.
The values for ``h → 0`` lie within 1e-4 of them.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.elements.base import option
from dalembert.elements.contact.unilateral import Gap, Impact, Unilateral

H = 2e-5
SICONOS = np.array(
    [
        [0.02, -4.373547052623864e-03, -4.523099830590930e-01],
        [0.06, -4.407447581115698e-03, -2.269439993526994e-01],
    ]
)


@dataclass(eq=False)
class Play(Unilateral):
    """Gaps and slips by formulas."""

    places: tuple = option("pairs of a gap and of the coordinate along it")
    restitution: float = option("along the gap", default=0.0)

    def gaps(self, rate):
        return [Gap(gap.sx, rate(along.sx)) for gap, along in self.places]

    def impact(self):
        return Impact(ca.SX(self.restitution), ca.SX(0), ca.SX(0.3))


def woodpecker() -> da.Model:
    r_o, r_m, h_m, l_m, l_g, h_s, l_s = 0.0025, 0.0031, 0.0058, 0.010, 0.015, 0.02, 0.0201
    system = da.System("woodpecker", gravity=(0.0, -9.81))
    sleeve = planar.Body(
        "sleeve",
        mass=3e-4,
        inertia=5e-9,
        position=(0.0, 0.0),
        angle=-0.1036,
        velocity=(0.0, -0.3411),
        angular_velocity=0.0,
    )
    bird = planar.Body("bird", mass=4.5e-3, inertia=7e-7, angle=-0.2788, angular_velocity=-7.4583)
    system.add(sleeve)
    system.add(bird)
    system.add(planar.UserConstraint("pole", sleeve.x))
    system.add(planar.UserConstraint("beside", bird.x))
    arm = l_m * sleeve.angle + l_g * bird.angle  # the toy is described for small angles
    system.add(planar.UserConstraint("arm", bird.y - sleeve.y - arm))
    system.add(planar.TorsionSpring("spring", sleeve, bird, stiffness=0.0056))
    beak = l_m + l_g - l_s - r_o - h_s * bird.angle
    along = sleeve.y + l_m * sleeve.angle + (l_g - l_s) * bird.angle
    system.add(Play("beak", ((beak, along),), 0.5))
    rub = sleeve.y + r_m * sleeve.angle
    ends = tuple((r_m - r_o + s * h_m * sleeve.angle, rub) for s in (1, -1))
    system.add(Play("ends", ends))
    return system.build()


@pytest.fixture(scope="module")
def model() -> da.Model:
    return woodpecker()


@pytest.mark.thorough
def test_equals_the_published_run(model):
    """Step by step the same scheme, so the same numbers: the sleeve slides, jams and slides."""
    motion = da.solve_nonsmooth(
        model, 0.06, step=H, outputs=SICONOS[:, 0], integrator=da.MoreauJean(projection=False)
    )
    assert motion.status.success
    assert motion.values("sleeve.y") == pytest.approx(SICONOS[:, 1], abs=1e-10)
    assert motion.values("bird.angle") == pytest.approx(SICONOS[:, 2], abs=1e-9)


@pytest.mark.thorough
def test_longer_steps_come_near(model):
    motion = da.solve_nonsmooth(
        model, 0.06, step=5 * H, outputs=SICONOS[:, 0], integrator=da.MoreauJean(projection=False)
    )
    assert motion.values("sleeve.y") == pytest.approx(SICONOS[:, 1], abs=1e-4)
    assert motion.values("bird.angle") == pytest.approx(SICONOS[:, 2], abs=1e-4)
