"""Six-axis robot arm: the torques of its motors along a smooth motion.

Geometry and masses of the Unimation Puma 560 after Armstrong, Khatib and Burdick (1986), as in P.
Corke's *Robotics, Vision and Control*; the inertia tensor of the third link is corrected to be
physically possible. Each joint is a hinge about z of the previous link, with frames by Denavit and
Hartenberg. The arm moves from rest to rest. Inverse dynamics computes the torques, and the gradient
their increase per payload. At rest in the pose of the book, the motors of shoulder and elbow carry
31.64 N m and 6.04 N m.
"""

import sys

import numpy as np
import style

import dalembert as da
from dalembert import spatial

G, DURATION = 9.81, 1.5
NOMINAL = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])
REACH = np.array([0.9, -0.6, 0.8, 0.5, 0.7, -1.2])
LINKS = [  # d, a, α; mass, mass centre and moments in the link's frame
    (0, 0, np.pi / 2, 0.0, (0, 0, 0), (0.175, 0.35, 0.175)),
    (0, 0.4318, 0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
    (0.15005, 0.0203, -np.pi / 2, 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.078, 0.0125)),
    (0.4318, 0, np.pi / 2, 0.82, (0, 0.019, 0), (1.8e-3, 1.3e-3, 1.8e-3)),
    (0, 0, -np.pi / 2, 0.34, (0, 0, 0), (0.3e-3, 0.4e-3, 0.3e-3)),
    (0, 0, 0, 0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]


def placed(angles) -> list[np.ndarray]:
    """(4, 4) frames of the links, ``Rz(θ) Tz(d) Tx(a) Rx(α)`` one after the other."""
    frame, found = np.eye(4), []
    for (d, a, twist, *_), angle in zip(LINKS, angles, strict=True):
        c, s, u, w = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist)
        step = [[c, -s * u, s * w, a * c], [s, c * u, -c * w, a * s], [0, w, u, d], [0, 0, 0, 1]]
        frame = frame @ np.array(step)
        found.append(frame)
    return found


def build(reach=REACH, start=NOMINAL) -> da.System:
    """A motion by ``reach`` from ``start``, at rest before and after."""
    system = da.System("robot arm", gravity=(0.0, 0.0, -G))
    payload = system.parameter("payload", 0.0, "kg", bounds=(0.0, 2.5))
    rise = (da.t / DURATION) ** 3 * (10 - 15 * da.t / DURATION + 6 * (da.t / DURATION) ** 2)
    before = system.ground
    for k, ((d, a, twist, mass, center, moments), frame) in enumerate(
        zip(LINKS, placed(start), strict=True), start=1
    ):
        link = spatial.Body(
            f"link{k}",
            mass=mass,
            inertia=moments,
            center_of_mass=center,
            position=tuple(frame[:3, 3]),
            rotation=frame[:3, :3],
        )
        system.add(link)
        turn = da.rotation.axis_angle((1, 0, 0), -twist)
        c, s = np.cos(twist), np.sin(twist)
        hinge = link.frame((-a, -d * s, -d * c), rotation=turn)
        joint = spatial.Revolute(f"J{k}", before.frame(rotation=da.rotation.identity()), hinge)
        system.add(joint)
        law = start[k - 1] + reach[k - 1] * rise
        system.add(spatial.RotationalDriver(f"motor{k}", joint, law))
        before = link
    hand = before.point(0, 0, 0.1)
    system.add(spatial.Force("load", hand, (0, 0, -payload * G)))
    before.add_point("hand", (0, 0, 0.1))
    return system


def torques(motion) -> np.ndarray:
    """(6, K) of the motors."""
    return np.stack([motion[f"motor{k}.effort"].values for k in range(1, 7)])


def main(folder=None) -> dict[str, float]:
    motion = da.solve_inverse_dynamics(build().build(), DURATION, step=0.01)
    found = torques(motion)
    shoulder = da.at(0.0, "motor2.effort")
    gradient = da.sensitivity(motion, shoulder, method="adjoint").sel(parameter="payload")
    numbers = {
        "shoulder at rest [N m]": found[1, 0],
        "elbow at rest [N m]": found[2, 0],
        "wrist at rest [N m]": found[4, 0],
        "largest torque of the shoulder [N m]": float(abs(found[1]).max()),
        "shoulder per payload at rest [N m/kg]": float(gradient.squeeze()),
    }
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, left, right = style.beside()
        style.space(left, motion, DURATION, trace="link6.hand")
        left.set_title("at the end, and path of the hand")
        for k, torque in enumerate(found, start=1):
            right.plot(motion.time, torque, label=f"joint {k}")
        right.set(xlabel="time [s]", ylabel="torque [N m]", title="torques of the motors")
        right.legend(ncols=3)
        style.save(figure, folder, "robot_arm")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
