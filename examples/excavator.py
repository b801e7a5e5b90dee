"""The arm of an excavator digs: three cylinders fed by one pump, against measured soil resistance.

The model is the file ``excavator.toml``, in the usual units of such machines, with the soil
resistance in ``soil.csv``. At rest the bucket cylinder carries only the weight of the bucket, F = m
g x/h with the lever arms x of the weight about the wrist and h of the cylinder.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da

HERE = Path(__file__).parent
CYLINDERS = ("boom", "stick", "bucket")


def build() -> da.System:
    return da.load_model(HERE / "excavator.toml")


def held_by_hand(motion) -> float:
    """Force of the bucket cylinder at the start, from the moments about the wrist [N]."""
    first = motion.at(0.0)
    lug, front, wrist, center = (
        first.values(f"{name}.position")[0]
        for name in ("bucket.lug", "stick.front", "bucket.hinge", "bucket")
    )
    along = (lug - front) / np.hypot(*(lug - front))
    arm = lug - wrist
    lever = arm[0] * along[1] - arm[1] * along[0]
    weight = motion.model.parameters["bucket_mass"].value * 9.81
    return weight * (center - wrist)[0] / lever


def main(folder=None) -> dict[str, float]:
    model = build().build()
    motion = da.solve_inverse_dynamics(
        model, "2*lowering + digging", step="20 ms", parameters={"pump": "1800 rpm"}
    )
    efforts = {name: motion.values(f"{name}_cylinder.effort") for name in CYLINDERS}
    table = motion.to_dataframe("bucket.tooth.y", *(f"{n}_cylinder.power" for n in CYLINDERS))
    numbers = {
        "lasts": float(motion.time[-1]),
        "held": float(efforts["bucket"][0]),
        "by_hand": float(held_by_hand(motion)),
        "depth": float(-table["bucket.tooth.y"].min()),
        "largest": max(float(np.abs(effort).max()) for effort in efforts.values()),
    }
    print(
        f"{numbers['lasts']:.2f} s, {numbers['depth']:.2f} m deep, largest force "
        f"{numbers['largest'] / 1e3:.0f} kN; the bucket is held by {numbers['held']:.1f} N, by "
        f"hand {numbers['by_hand']:.1f} N"
    )
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), width_ratios=(1.4, 1))
        left.axhspan(-1.4, 0, color="#8c6d46", alpha=0.15, lw=0)
        tooth = motion.values("bucket.tooth.position")
        left.plot(*tooth.T, color=style.GREY, ls=":", lw=1.2)
        for time, alpha in ((0.0, 0.2), (3.0, 0.35), (5.0, 1.0)):
            style.draw(left, motion, time, alpha)
        left.set(title="arm at 0, 3 and 5 s", xlabel="x [m]", ylabel="y [m]", aspect="equal")
        for name, effort in efforts.items():
            right.plot(motion.time, effort / 1e3, label=name)
        right.set(title="force of the cylinders [kN]", xlabel="time [s]")
        right.legend()
        style.save(figure, folder, "excavator")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
