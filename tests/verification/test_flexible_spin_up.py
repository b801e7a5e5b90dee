"""A beam that is spun up about its end (Kane, Ryan and Banerjee; Simo and Vu-Quoc).

L = 10, EA = 2.8e7, GA = 1e7, EI = 1.4e4, ρA = 1.2, ρI = 6e-4, hub speed up to 6 rad/s, beyond the
first bending frequency of 3.8 rad/s: without centrifugal stiffening the beam folds. Displacements
of the tip in the rotating frame are those of a geometrically exact beam (spectral elements, Gauss
steps of fourth order), computed independently to nine digits; the steady elongation of linear
theory is ω²ρAL³/(3EA).
"""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.structures import TimoshenkoFrame

LENGTH, EA, GA, EI, MASS, ROTARY = 10.0, 2.8e7, 1e7, 1.4e4, 1.2, 6e-4
EXACT = {
    2.5: (-0.001322677, -0.151283559, -0.020621126),
    5.0: (-0.012654636, -0.468476183, -0.063716733),
    7.5: (-0.017741864, -0.559083459, -0.074778631),
}


def arm(length: float, count: int):
    structure = da.Structure("arm")
    nodes = [structure.node(f"n{k}", length * k / count, 0.0) for k in range(count + 1)]
    beam = {"area": 1.0, "second_moment": ROTARY / MASS, "shear_area": 1.0, "density": MASS}
    beam |= {"modulus": EA, "shear_modulus": GA}
    for k in range(count):
        structure.add(TimoshenkoFrame(f"e{k}", nodes[k], nodes[k + 1], **beam))
    return structure.build()


def spun(parts: int, stiffening: bool, **options) -> da.Motion:
    system = da.System("spin-up")
    length, count = LENGTH / parts, 8 if parts > 1 else 16
    structure, last = arm(length, count), None
    for k in range(parts):
        body = system.add(
            planar.FlexibleBody(
                f"part{k}",
                structure,
                interface={"root": "n0", "tip": f"n{count}"},
                modes=1,
                reference="root",
                stiffening=stiffening,
                position=(k * length, 0.0),
                angle=0.0,
            )
        )
        if last is None:
            turned = 6 / 15 * (da.t**2 / 2 + (15 / 2 / np.pi) ** 2 * (da.cos(RATE * da.t) - 1))
            system.add(planar.Revolute("hub", system.ground.point(0, 0), body.point("root")))
            system.add(planar.RotationalDriver("motor", system.ground, body, turned))
        else:
            system.add(planar.Weld(f"joint{k}", last.point("tip"), body.point("root")))
        last = body
    return da.solve_dynamics(system.build(), integrator=da.Radau(fixed=True), **options)


RATE = 2 * np.pi / 15


def tip(motion: da.Motion, parts: int) -> np.ndarray:
    """(K, 3) displacements of the tip and its turn in the rotating frame."""
    angle, last = motion["part0.angle"].values, f"part{parts - 1}"
    x, y = motion[f"{last}.tip.x"].values, motion[f"{last}.tip.y"].values
    c, s = np.cos(angle), np.sin(angle)
    turn = motion[f"{last}.angle"].values + motion[f"{last}.tip.turn"].values - angle
    return np.column_stack([c * x + s * y - LENGTH, c * y - s * x, turn])


@pytest.mark.parametrize(
    ("parts", "tolerance"), [(1, 5e-4), pytest.param(4, 1e-4, marks=pytest.mark.thorough)]
)
def test_tip_lags_behind(parts, tolerance):
    motion = spun(parts, True, duration=7.5, step=0.05, outputs=[2.5, 5.0, 7.5])
    assert np.abs(tip(motion, parts) - list(EXACT.values())).max() < tolerance


def test_without_stiffening_it_folds():
    motion = spun(1, False, duration=7.5, step=0.05, outputs=[2.5, 5.0, 7.5])
    assert abs(tip(motion, 1)[-1, 1]) > 2 * abs(EXACT[7.5][1])
