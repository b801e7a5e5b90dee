"""A belt on a turning drum: the tensions of its ends compared with the capstan equation.

A drum turns under a belt that is held at one end and loaded at the other. Where it slides, the
tension grows along the drum as ``T2/T1 = e^(mu phi)`` (Euler and Eytelwein), independently of the
radius. The belt is a beam of 10, 20 and 40 elements in contact along its length. The gradient of
the tension by the coefficient of friction is that of the equation, ``phi T2``.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

RADIUS, LOAD, FRICTION, WRAP = 0.1, 100.0, 0.3, math.pi
"""Radius of the drum [m], tension of the loaded end [N], coefficient of friction, wrap [rad]."""
SPAN = 0.3
"""Lengths of the belt at both ends that leave the drum, over the radius."""
DURATION = 0.15
"""Time after which load and speed of the drum are constant [s]."""
ELEMENTS = (10, 20, 40)


def build(elements: int) -> da.System:
    system = da.System("capstan")
    friction = system.parameter("friction", FRICTION)
    drum = system.add(planar.Body("drum", mass=1.0, inertia=0.01, position=(0, 0), angle=0.0))
    system.add(planar.Revolute("axle", system.ground.center, drum.center))
    turn = -(da.t - 0.02 * (1 - da.exp(-da.t / 0.02)))  # from rest to 1 rad/s
    system.add(planar.RotationalDriver("motor", system.ground, drum, da.Formula(turn)))
    length = RADIUS * (WRAP + 2 * SPAN)
    start = -RADIUS * math.cos(SPAN), -RADIUS * math.sin(SPAN)
    belt = system.add(
        planar.Beam(
            "belt",
            length=length,
            curvature=-1 / RADIUS,  # wound on the drum at the start
            axial_rigidity=1e5,
            shear_rigidity=1e5,
            bending_rigidity=1e-4,
            mass_per_length=1.0,
            rotary_inertia=1e-5,
            damping=1e-3,
            position=start,
            angle=math.pi / 2 + SPAN,
            elements=elements,
            order=2,
        )
    )
    anchor = system.ground.point(0, start[1])
    system.add(planar.PinInSlot("anchor", anchor, belt.start.center, axis=(1, 0)))
    load = LOAD * (1 - da.exp(-da.t / 0.005))
    system.add(planar.Force("load", belt.end, (0, -load)))
    system.add(
        planar.Contact(
            "touch",
            planar.contact.Circle(drum.center, RADIUS),
            planar.contact.BeamLine(belt),
            law=planar.contact.KelvinVoigt(stiffness=1e8 * length, damping=1e4 * length),
            friction=planar.contact.Coulomb(friction, slip_speed=0.01),
        )
    )
    return system


def run(elements: int) -> da.Motion:
    model = build(elements).build()
    return da.solve_dynamics(model, DURATION, step=5e-3, integrator=da.BackwardEuler())


def tension(motion: da.Motion, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Angle of stations from the loaded end [rad], and radius times their line load [N]."""
    fractions = (np.arange(elements)[:, None] + 0.5 + np.array([-0.5, 0.5]) / math.sqrt(3)).ravel()
    length = RADIUS * (WRAP + 2 * SPAN) / (2 * elements)  # of a station
    forces = [motion[f"touch.force{k + 1}"].values[-1] for k in range(2 * elements)]
    angle = (1 - fractions / elements) * (WRAP + 2 * SPAN) - SPAN
    return angle, RADIUS * np.array(forces) / length


def main(folder=None) -> dict[str, float]:
    ratio = math.exp(FRICTION * WRAP)
    numbers = {}
    for elements in ELEMENTS:
        motion = run(elements)
        held = float(motion["anchor.force_norm"].values[-1])
        numbers[f"error of {elements} elements"] = held / LOAD / ratio - 1
        if elements == ELEMENTS[0]:
            slope = da.sensitivity(motion, da.final("anchor.force_norm"), method="adjoint")
            by_friction = slope.sel(parameter="friction").item()
            numbers["tension by friction"] = by_friction / (LOAD * WRAP * ratio)
    for name, value in numbers.items():
        print(f"{name}: {value:.6f}")
    if folder:
        figure, (picture, left, right) = plt.subplots(1, 3, figsize=(9.6, 3.2))
        style.draw(picture, motion, DURATION)
        picture.set(title="belt on a drum", xlabel="x [m]", ylabel="y [m]")
        wrap = np.linspace(0, WRAP, 100)
        left.plot(wrap, LOAD * np.exp(FRICTION * wrap), color=style.GREY, lw=4, alpha=0.4)
        left.plot(*tension(motion, elements), ".", ms=4)
        left.set(xlabel="wrap [rad]", ylabel="R times line load [N]", title="tension")
        errors = [abs(numbers[f"error of {n} elements"]) for n in ELEMENTS]
        right.loglog(ELEMENTS, errors, "o-")
        right.set(xlabel="elements", ylabel="relative error", title="error of e^(mu phi)")
        style.save(figure, folder, "capstan")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
