"""The smallest cams for one law: a roller with pressure angles up to 30°, and a flat face.

The follower rises by a cycloidal law, dwells and returns. The base circle for a roller is limited
by the pressure angle and by the curvature of the pitch curve, that for a flat face only by the
curvature, because its profile must be convex: ρ = R + s + s''.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da


def main(folder=None) -> dict[str, float]:
    law = da.CycloidalRise(
        height=0.02, duration=math.pi / 2, dwell=math.pi / 4, fall=math.pi / 2, period=2 * math.pi
    )
    limit = math.radians(30)
    roller = da.RollerCam.smallest(law, limit, roller_radius=0.006, minimum_radius=0.003)
    flat = da.FlatFaceCam.smallest(law, minimum_radius=0.003)
    pressure = math.degrees(abs(roller.pressure_angle()).max())
    print(f"roller: base radius {1e3 * roller.base_radius:.2f} mm")
    print(f"        pressure angle at most {pressure:.2f} deg")
    low, high = flat.face
    width = 1e3 * (high - low)
    print(f"flat face: base radius {1e3 * flat.base_radius:.2f} mm, {width:.1f} mm wide")
    if folder:
        figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), width_ratios=(1, 1, 1.1))
        around = np.linspace(0, 2 * math.pi, 200)
        circle = np.stack([np.cos(around), np.sin(around)])
        for ax, cam, title in ((axes[0], roller, "roller"), (axes[1], flat, "flat face")):
            ax.fill(*1e3 * cam.profile().T, fc=(style.BLUE, 0.2), ec=style.BLUE, lw=1.5)
            ax.plot(*1e3 * cam.base_radius * circle, "--", color=style.GREY, lw=0.8)
            ax.plot(0, 0, "o", mfc="0.3", mec="0.2", ms=5)
            ax.set(title=title, aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
        centre = 1e3 * roller.pitch(np.array([0.0]))[0][:, None]
        axes[0].plot(*1e3 * roller.pitch().T, ":", color=style.ORANGE, lw=1)
        axes[0].fill(*(centre + 6 * circle), fc=(style.ORANGE, 0.3), ec=style.ORANGE)
        face = 1e3 * flat.base_radius
        axes[1].plot([1e3 * low, 1e3 * high], [face, face], color=style.ORANGE, lw=3)
        axes[2].plot(np.degrees(roller.turn), np.degrees(roller.pressure_angle()))
        axes[2].axhline(30, color=style.GREY, lw=0.8)
        axes[2].axhline(-30, color=style.GREY, lw=0.8)
        axes[2].set(title="pressure angle of the roller [deg]", xlabel="cam [deg]")
        style.save(figure, folder, "smallest_cam")
    return {
        "pressure": pressure,
        "least radius": float(flat.radius().min()),
        "undercut": float(roller.undercut() or flat.undercut()),
        "base": roller.base_radius,
    }


if __name__ == "__main__":
    main(*sys.argv[1:])
