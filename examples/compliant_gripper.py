"""A gripper jaw on two leaf springs: the exact beam compared with its pseudo-rigid-body model.

Two parallel leaves guide the jaw without a hinge. Howell's model (Compliant Mechanisms, 2001)
replaces each leaf by a rigid link of length ``γ l`` and springs ``K = 2 γ K_Θ E I/l``, γ = 0.8517
and K_Θ = 2.65: a parallelogram of rigid bars, which is also computed here.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar
from dalembert.structures import Material, rectangle

LENGTH, APART = 0.06, 0.02
SHARE, STIFFNESS = 0.8517, 2.65
LEAF = rectangle(0.01, 0.0005).planar_beam(Material(200e9, 0.3, 7800.0))
FORCES = np.linspace(2.0, 20.0, 7)


def jaw(system: da.System, length: float) -> planar.Body:
    force = system.parameter("force", float(FORCES[0]), "N", bounds=(0.0, 30.0))
    made = system.add(
        planar.Body("jaw", mass=0.02, inertia=1e-5, position=(APART / 2, length), angle=0.0)
    )
    system.add(planar.Force("grip", made.center, (force, 0.0)))
    return made


def compliant() -> da.Model:
    """The jaw on leaves that are clamped at both ends."""
    system = da.System("compliant gripper")
    held = jaw(system, LENGTH)
    for k, x in enumerate((0.0, APART)):
        system.add(
            planar.Beam(
                f"leaf{k + 1}",
                system.ground.point(x, 0.0),
                held.point(x - APART / 2, 0.0),
                angle_i=np.pi / 2,
                angle_j=np.pi / 2,
                length=LENGTH,
                **LEAF,
            )
        )
    return system.build()


def pseudo_rigid() -> da.Model:
    """The same by rigid links and springs."""
    system = da.System("pseudo-rigid body")
    bar, foot = SHARE * LENGTH, (1 - SHARE) / 2 * LENGTH
    held = jaw(system, bar + 2 * foot)
    spring = 2 * SHARE * STIFFNESS * LEAF["bending_rigidity"] / LENGTH
    for k, x in enumerate((0.0, APART)):
        link = system.add(
            planar.Bar(
                f"link{k + 1}", length=bar, mass=1e-3, position=(x, LENGTH / 2), angle=np.pi / 2
            )
        )
        ends = (
            ("foot", system.ground.point(x, foot), link.start, system.ground),
            ("head", held.point(x - APART / 2, -foot), link.end, held),
        )
        for name, place, end, body in ends:
            system.add(planar.Revolute(f"{name}{k + 1}", place, end))
            system.add(
                planar.TorsionSpring(
                    f"{name}_spring{k + 1}", body, link, stiffness=spring, free_angle=np.pi / 2
                )
            )
    return system.build()


def strokes(model: da.Model) -> tuple[np.ndarray, list[da.Motion]]:
    """Displacement of the jaw by force [m]."""
    found = [da.solve_equilibrium(model, parameters={"force": force}) for force in FORCES]
    return np.array([float(f["jaw.x"].values[0]) - APART / 2 for f in found]), found


def main(folder=None) -> dict[str, float]:
    exact, found = strokes(compliant())
    model, _ = strokes(pseudo_rigid())
    numbers = {
        "stroke": float(exact[-1]),
        "pseudo_rigid": float(model[-1]),
        "tilt": float(found[-1]["jaw.angle"].values[0]),
    }
    print(
        f"at {FORCES[-1]:g} N the jaw moves {1e3 * exact[-1]:.3f} mm (pseudo-rigid bodies "
        f"{1e3 * model[-1]:.3f} mm) and tilts by {1e3 * numbers['tilt']:.2f} mrad"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.6))
        for motion, colour in ((found[0], style.GREY), (found[-1], style.BLUE)):
            for k in (1, 2):
                beam = motion.model.parts.elements[f"leaf{k}"]
                inner = [b.name for b in beam.nodes.values()]
                x, y = ([float(motion[f"{n}.{q}"].values[0]) for n in inner] for q in "xy")
                corner = -APART / 2 if k == 1 else APART / 2
                place = float(motion["jaw.x"].values[0]) + corner
                xs = [APART * (k - 1), *x, place]
                ys = [0.0, *y, float(motion["jaw.y"].values[0])]
                left.plot(1e3 * np.array(xs), 1e3 * np.array(ys), color=colour)
            at = float(motion["jaw.x"].values[0]), float(motion["jaw.y"].values[0])
            ends = 1e3 * (at[0] + np.array([-1, 1]) * APART / 2)
            left.plot(ends, [1e3 * at[1]] * 2, color=colour, lw=6, solid_capstyle="round")
        left.set(title="leaves at 2 and 20 N", xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
        right.plot(FORCES, 1e3 * exact, "o-", ms=4, label="exact beams")
        right.plot(FORCES, 1e3 * model, "--", label="pseudo-rigid bodies")
        right.set(title="stroke of the jaw [mm]", xlabel="force [N]")
        right.legend()
        style.save(figure, folder, "compliant_gripper")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
