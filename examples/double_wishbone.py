"""Double-wishbone suspension on a bump: camber, toe, and the gradient of bump steer.

The points are those of a passenger car. Two wishbones on hinges, the upright on two spherical
joints and a tie rod leave one degree of freedom, the wheel travel. Newton's method with the exact
gradient moves the inner end of the tie rod so that the initial bump steer vanishes.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

TRAVEL = 0.08


def build() -> da.System:
    system = da.System("double wishbone")
    rod_y = system.parameter("rod_y", -0.4, "m", bounds=(-0.45, -0.35))
    rod_z = system.parameter("rod_z", 0.3, "m", bounds=(0.27, 0.33))
    arm_z = system.parameter("arm_z", 0.525, "m", bounds=(0.5, 0.55))
    rod = system.derived(
        "rod", da.sqrt((0.15 - 0.2) ** 2 + (-0.75 - rod_y) ** 2 + (0.3 - rod_z) ** 2), "m"
    )

    def body(name, position, points):
        made = spatial.Body(name, position=position, rotation=da.rotation.identity(), points=points)
        return system.add(made)

    lower = body("lower_arm", (0, -0.75, 0.1), {"ball": (0, 0, 0)})
    upper = body("upper_arm", (0.04, -0.675, 0.525), {"ball": (0, 0, 0)})
    balls = {"lower": (0, 0.05, -0.2), "upper": (0.04, 0.125, 0.225), "steer": (0.15, 0.05, 0)}
    upright = body("upright", (0, -0.8, 0.3), {**balls, "wheel": (0, 0, 0), "axle": (0, 0.1, 0)})

    along, across = (0.4, -0.05, 0.005), (0.15, -0.04, 0.53 - arm_z)
    bushes = (
        ("lower", lower, (-0.2, -0.4, 0.15), (-0.2, 0.35, 0.05), along),
        ("upper", upper, (0.1, -0.45, arm_z), (0.06, 0.225, arm_z - 0.525), across),
    )
    for name, arm, place, local, axis in bushes:
        ends = system.ground.frame(place, axis=axis), arm.frame(local, axis=axis)
        system.add(spatial.Revolute(name, *ends))
    for name, arm in (("lower", lower), ("upper", upper)):
        system.add(spatial.Spherical(f"{name}_ball", arm.points["ball"], upright.points[name]))
    rack = system.ground.point(0.2, rod_y, rod_z)
    system.add(spatial.RigidLink("tie_rod", rack, upright.points["steer"], length=rod))
    law = 0.3 + TRAVEL * da.sin(da.t)
    system.add(spatial.CoordinateDriver("bump", upright.points["wheel"], law, direction=(0, 0, 1)))
    return system


BUMP_STEER = "upright.angular_velocity.z / upright.vz"


def without_bump_steer(model: da.Model) -> tuple[float, float]:
    """Height of the inner end of the tie rod that makes the gradient vanish, by Newton's method."""
    height, steer = 0.3, da.at(0.0, BUMP_STEER)
    for _ in range(4):
        motion = da.solve_kinematics(model, 0.1, outputs=2, parameters={"rod_z": height})
        slope = da.sensitivity(motion, steer, method="adjoint").sel(parameter="rod_z")
        gradient = da.evaluate(motion, steer)
        height -= gradient / float(slope.squeeze())
    return height, gradient


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_kinematics(model, 2 * np.pi, outputs=201)
    height, left_over = without_bump_steer(model)
    corrected = da.solve_kinematics(model, 2 * np.pi, outputs=201, parameters={"rod_z": height})
    numbers = {
        "bump steer [deg/m]": np.degrees(da.evaluate(motion, da.at(0.0, BUMP_STEER))),
        "height of the tie rod without bump steer [m]": height,
        "bump steer there [deg/m]": np.degrees(left_over),
        "toe at full bump [deg]": toe(motion)[50],
        "toe at full bump without bump steer [deg]": toe(corrected)[50],
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, np.pi / 2, trace="upright.wheel")
        left.set_title("at full bump")
        rise = 1e3 * (motion["upright.z"] - 0.3)
        right.plot(toe(motion)[:151], rise[:151], label="toe")
        right.plot(toe(corrected)[:151], rise[:151], label="toe, tie rod moved")
        camber = np.degrees(np.arcsin((motion["upright.axle.z"] - motion["upright.z"]) / 0.1))
        right.plot(camber[:151], rise[:151], label="camber")
        right.set(xlabel="angle [°]", ylabel="travel [mm]", title="toe and camber over the travel")
        right.legend()
        style.save(figure, folder, "double_wishbone")
    return numbers


def toe(motion) -> np.ndarray:
    """Angle of the wheel from above, anticlockwise [deg]."""
    x, y = (motion[f"upright.axle.{axis}"] - motion[f"upright.{axis}"] for axis in "xy")
    return np.degrees(np.arctan2(-x, y).values)


if __name__ == "__main__":
    main(*sys.argv[1:])
