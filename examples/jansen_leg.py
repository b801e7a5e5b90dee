"""A walking leg from a drawing: lines are bars, triangles are plates, circles are pins.

The drawing `jansen_leg.svg` has the thirteen lengths of Theo Jansen (The Great Pretender, 2007).
Its foot stays within 1.5 mm of the ground for almost half a turn of the crank, in a step of 62 mm.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da

DRAWING = Path(__file__).with_name("jansen_leg.svg")


def main(folder=None) -> dict[str, float]:
    imported = da.import_model(DRAWING)
    model = imported.build()
    speed = model.parameters["speed"].value
    motion = da.solve_kinematics(model, 2 * np.pi / speed, outputs=721)
    x, y = (1e3 * motion[f"shank.foot.{axis}"].values for axis in "xy")
    stance = y < y.min() + 1.5
    print(f"foot within 1.5 mm of the ground for {np.mean(stance):.3f} of a turn")
    print(f"length of the step there: {np.ptp(x[stance]):.2f} mm, height {np.ptp(y):.2f} mm")
    if folder:
        draw(folder, motion, x, y)
    return {
        "share": float(np.mean(stance)),
        "step": float(np.ptp(x[stance])),
        "height": float(np.ptp(y)),
        "foot x": float(x[0]),
        "foot y": float(y[0]),
    }


def draw(folder, motion, x, y) -> None:
    figure, axes = plt.subplots(figsize=(6, 6))
    motion.draw(ax=axes)
    axes.plot(1e-3 * x, 1e-3 * y, linewidth=1.2)
    axes.set_title("Leg of Theo Jansen, from a drawing")
    style.save(figure, folder, "jansen_leg")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
