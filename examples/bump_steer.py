"""Minimum bump steer of a double wishbone: optimal position of the inner end of the tie rod.

The wheel of the suspension of double_wishbone.py moves up and down by 80 mm. The root mean square
of the toe angle over the travel is minimised over height and distance of the inner ball of the tie
rod. The length of the rod follows from zero toe at rest.
"""

import sys

import double_wishbone
import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da

TOE = "asin((upright.axle.x - upright.x)/0.1)"
PLACES = ["rod_y", "rod_z"]


def main(folder=None) -> dict[str, float]:
    model = double_wishbone.build().build()
    travel = da.Kinematics(2 * np.pi, outputs=121)
    best = da.optimize(model, da.rms(TOE, name="toe"), vary=PLACES, analysis=travel)
    tangent, _ = double_wishbone.without_bump_steer(model)
    moved = travel.run(model, {"rod_z": tangent})
    numbers = {
        "toe before [deg rms]": np.degrees(best.history[0].objective),
        "toe without bump steer at rest [deg rms]": np.degrees(
            da.evaluate(moved, da.rms(TOE, name="toe"))
        ),
        "toe after [deg rms]": np.degrees(best.fun),
        **{f"{name} [m]": best.x[name] for name in PLACES},
        "toe at full bump [deg]": np.degrees(best.motion.values(TOE)[30]),
    }
    print(*(f"{name}: {value:.6g}" for name, value in numbers.items()), sep="\n")
    print(best.message)
    if folder:
        figure, left, right = style.beside(9.0, 4.6)
        style.space(left, best.motion, np.pi / 2, trace="upright.wheel")
        left.set_title("at full bump")
        shown = (("as drawn", best.initial), ("tangent at rest", moved), ("best", best.motion))
        for label, motion in shown:
            rise = 1e3 * (motion.values("upright.z") - 0.3)
            right.plot(np.degrees(motion.values(TOE))[:91], rise[:91], label=label)
        right.set(title="toe [deg] over the travel of the wheel [mm]")
        right.legend()
        style.save(figure, folder, "bump_steer")
        plt.close("all")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
