"""A closed belt of four beams on two pulleys, compared with the theory of creep and slip.

The belt lies on the surface of a pulley where it enters it, so that strands with the tensions
``T1 > T2`` move with ``ω1 (R + r)`` and ``ω2 (R + r)``. Equal lengths of unstretched belt pass both
in a time: ``ω2/ω1 = (1 + T2/EA)/(1 + T1/EA)``. The moments on the pulleys are ``(T1 − T2)(R + r)``.
Where the belt slides along all of one pulley, ``T1/T2 = e^(μ π R/(R + r))`` (Euler and Eytelwein).
"""

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

contact = planar.contact
RADIUS, HALF, APART, FRICTION = 0.1, 0.002, 0.3, 0.5
PULL, STIFFNESS, LOAD, SPEED = 200.0, 1e4, 8.0, 10.0
ENTRY = 1 - da.exp(-da.t / 0.02)


def drive(half: int = 16, strand: int = 15, slip: float = 0.0) -> da.Model:
    """A motor, and a pulley with a load, or one that a brake turns more slowly.

    Parameters
    ----------
    half, strand : elements on half a turn, and of a strand
    slip : difference of the speeds, relative to that of the motor; zero with a load
    """
    system = da.System("belt drive")
    outer = (RADIUS + HALF) / math.cos(math.pi / half / 2) + 1e-6  # chords just clear the pulleys
    data = {"axial_rigidity": STIFFNESS, "shear_rigidity": STIFFNESS, "bending_rigidity": 1e-3}
    data |= {"mass_per_length": 0.05, "rotary_inertia": 1e-5, "damping": 1e-3, "order": 1}
    straight = data | {"length": APART, "elements": strand}
    bent = data | {"length": math.pi * outer, "curvature": 1 / outer, "elements": half}
    low = system.add(planar.Beam("low", position=(0, -outer), angle=0.0, **straight))
    right = system.add(planar.Beam("right", low.end, **bent))
    high = system.add(planar.Beam("high", right.end, **straight))
    left = planar.Beam("left", high.end, low.start, angle_j=2 * math.pi, **bent)
    belt = [low, right, high, system.add(left)]
    pulleys = [
        system.add(planar.Body(name, mass=0.5, inertia=5e-3, position=(x, 0), angle=0.0))
        for name, x in (("driver", 0.0), ("driven", APART))
    ]
    driver, driven = pulleys
    system.add(planar.Revolute("axle", system.ground.center, driver.center))
    system.add(planar.PinInSlot("slide", system.ground.center, driven.center, axis=(1, 0)))
    turn = SPEED * (da.t - 0.03 * (1 - da.exp(-da.t / 0.03)))
    system.add(planar.RotationalDriver("motor", system.ground, driver, da.Formula(turn)))
    system.add(planar.Force("pull", driven.center, (PULL * ENTRY, 0)))
    rest = {"stiffness": 0.0, "damping": 300.0, "free_length": 0.0}
    system.add(planar.Spring("damper", system.ground.point(1, 0), driven.center, **rest))
    if slip:
        braked = da.Formula((1 - slip) * turn)
        system.add(planar.RotationalDriver("brake", system.ground, driven, braked))
    else:
        system.add(planar.Torque("load", driven, -LOAD * (1 - da.exp(-((da.t / 0.05) ** 2)))))
    lines = [contact.BeamLine(beam, HALF) for beam in belt]
    shapes = [*lines, *(contact.Circle(pulley, RADIUS) for pulley in pulleys)]
    system.add(planar.Collisions("touch", shapes, friction=FRICTION))
    return system.build()


def moment(motion: da.Motion, pulley: str, t: float) -> float:
    """Moment of the contact forces on a pulley about its axle."""
    forces, total = motion.contact_forces(t), 0.0
    center = [motion[f"{pulley}.{axis}"].sel(time=t, method="nearest").item() for axis in "xy"]
    for names, place, force in zip(forces.bodies, forces.places, forces.forces, strict=True):
        if pulley in names:
            arm, sign = place - center, 1 if names[1] == pulley else -1
            total += sign * (arm[0] * force[1] - arm[1] * force[0])
    return total


@pytest.mark.thorough
def test_the_belt_creeps_by_its_stretch():
    motion = da.solve_nonsmooth(drive(), 0.4, step=1e-3)
    assert motion.status.success
    assert np.abs(motion.data.balance_error).max() < 1e-8 * motion.data.input_energy.max()
    last = motion.time > 0.25
    turned = [np.ptp(motion[f"{name}.angle"].values[last]) for name in ("driven", "driver")]
    tensions = [PULL / 2 + sign * LOAD / (RADIUS + HALF) / 2 for sign in (-1, 1)]
    creep = (1 + tensions[0] / STIFFNESS) / (1 + tensions[1] / STIFFNESS)
    assert turned[0] / turned[1] == pytest.approx(creep, abs=1.5e-3)
    moments = [moment(motion, "driven", t) for t in np.arange(0.35, 0.4, 2e-3)]
    assert np.mean(moments) == pytest.approx(LOAD, rel=0.02)


@pytest.mark.thorough
def test_the_belt_slides_with_the_ratio_of_tensions_of_euler():
    motion = da.solve_nonsmooth(drive(slip=0.3), 0.3, step=1e-3)
    assert motion.status.success
    assert np.abs(motion.data.balance_error).max() < 1e-8 * motion.data.input_energy.max()
    last = motion.time > 0.2
    difference = motion["motor.moment"].values[last].mean() / (RADIUS + HALF)
    ratio = (PULL + difference) / (PULL - difference)
    exact = math.exp(FRICTION * math.pi * RADIUS / (RADIUS + HALF))
    assert ratio == pytest.approx(exact, rel=0.03)


def test_a_coarse_belt_starts():
    """Parts of the belt that are clamped to each other do not touch."""
    motion = da.solve_nonsmooth(drive(6, 6), 0.01, step=2e-3)
    assert motion.status.success
    assert motion["driven.angular_velocity"].values[-1] > 0
    assert np.abs(motion.data.balance_error).max() < 1e-9
