"""Driveline with two universal joints: varying speed of the middle shaft, constant output speed.

With the first fork in the plane of the shafts at the start, tan φ2 = tan φ1 / cos β: the speed of
the middle shaft varies between ω cos β and ω / cos β, and its inertia causes a varying torque. The
forks of the middle shaft are in one plane, so the second joint compensates the variation. The
revolute, universal, prismatic, universal and revolute joints leave one degree of freedom to four
bodies.
"""

import math
import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

AHEAD, ASIDE, UP = (1, 0, 0), (0, 1, 0), (0, 0, 1)
BETA, SPEED = 0.5, 10.0


def build() -> da.System:
    system = da.System("universal driveline")
    beta = system.parameter("beta", BETA, "rad", bounds=(0.1, 0.9))
    length = system.parameter("L", 0.8, "m")
    speed = system.parameter("speed", SPEED, "rad/s")
    inertia = system.parameter("J", 0.02, "kg m^2")
    drag = system.parameter("drag", 5.0, "N m")
    far, level, bent = (
        (length * da.cos(beta), length * da.sin(beta), 0),
        da.rotation.identity(),
        da.rotation.axis_angle(UP, beta),
    )

    def shaft(name, moments, place, rotation, middle=(0, 0, 0)):
        made = spatial.Body(
            name,
            mass=2.0,
            inertia=moments,
            position=place,
            rotation=rotation,
            center_of_mass=middle,
        )
        return system.add(made)

    first = shaft("input", (0.01, 0.02, 0.02), (0, 0, 0), level)
    sleeve = shaft("sleeve", (inertia, 0.04, 0.04), (0, 0, 0), bent, (length / 4, 0, 0))
    tube = shaft("tube", (inertia, 0.04, 0.04), far, bent, (-length / 4, 0, 0))
    last = shaft("output", (0.01, 0.02, 0.02), far, level)

    bearing, outer = (system.ground.frame(place, axis=AHEAD, x=ASIDE) for place in ((0, 0, 0), far))
    forks = {body.name: body.frame(axis=ASIDE, x=AHEAD) for body in (first, last)}
    forks |= {body.name: body.frame(axis=UP, x=AHEAD) for body in (sleeve, tube)}
    splines = (body.frame(axis=AHEAD, x=UP) for body in (sleeve, tube))
    hinge = spatial.Revolute("A", bearing, first.frame(axis=AHEAD, x=ASIDE))
    end = spatial.Revolute("B", outer, last.frame(axis=AHEAD, x=ASIDE))
    system.add(hinge)
    system.add(spatial.Universal("U1", forks["input"], forks["sleeve"]))
    system.add(spatial.Prismatic("spline", *splines))
    system.add(spatial.Universal("U2", forks["tube"], forks["output"]))
    system.add(end)
    system.add(spatial.RotationalDriver("motor", hinge, speed * da.t))
    system.add(spatial.JointActuator("load", end, -drag))
    return system


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_inverse_dynamics(model, 2 * math.pi / SPEED, step=math.pi / 1000)
    angle = SPEED * motion.time
    ratio = motion["sleeve.angular_velocity_local.x"] / SPEED
    exact = math.cos(BETA) / (1 - (math.sin(BETA) * np.cos(angle)) ** 2)
    fastest = da.maximum("sleeve.angular_velocity_local.x / speed")
    slope = da.sensitivity(motion, fastest, method="adjoint").sel(parameter="beta")
    numbers = {
        "fastest / input": float(ratio.max()),
        "slowest / input": float(ratio.min()),
        "largest error of the ratio": float(abs(ratio - exact).max()),
        "largest error of the output speed [rad/s]": float(
            abs(motion["output.angular_velocity_local.x"] - SPEED).max()
        ),
        "slope of fastest / input by beta [1/rad]": float(slope.squeeze()),
        "largest torque [N m]": float(motion["motor.effort"].max()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        for name, values in (
            ("middle shaft", ratio),
            ("output", motion["output.angular_velocity_local.x"] / SPEED),
        ):
            right.plot(np.degrees(angle), values, label=name)
        style.space(left, motion)
        left.set_title("input, telescopic and output shaft")
        right.set(xlabel="input [°]", ylabel="speed / input", title="unevenness")
        right.legend()
        style.save(figure, folder, "universal_driveline")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
