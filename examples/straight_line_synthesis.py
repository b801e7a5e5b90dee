"""Synthesis of a four-bar whose coupler point passes six points on a line, and its two cognates.

The problem is from the literature on evolutionary search, where the sum of squared distances
decreased from 1.5e-2 to 4.1e-5. With an atlas of coupler curves and exact derivatives the points
are met to round-off. The theorem of Roberts and Chebyshev yields two more four-bars with the same
coupler curve; one of them has a crank that rotates with the first.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da

POINTS = np.array([(20.0, 20.0 + 5 * k) for k in range(6)])
BOUNDS = {
    **dict.fromkeys(("ground", "crank", "coupler", "follower"), (5.0, 60.0)),
    **dict.fromkeys(("x", "y", "u", "v"), (-60.0, 60.0)),
}


def draw(ax, bar: da.FourBar, theta: float, colour: str) -> None:
    """Crank, coupler triangle and follower."""
    origin = complex(bar.x, bar.y)
    pin = origin + bar.crank * np.exp(1j * theta)
    end = pin + bar.coupler * np.exp(1j * bar.coupler_angle(theta))
    far = origin + bar.ground * np.exp(1j * bar.angle)
    point = complex(*bar.path(theta))
    for line in ((origin, pin), (end, far)):
        ax.plot(np.real(line), np.imag(line), color=colour, lw=3, solid_capstyle="round")
    triangle = np.array([pin, end, point])
    ax.fill(triangle.real, triangle.imag, fc=(colour, 0.2), ec=colour, lw=1.2)
    ax.plot(np.real([origin, far]), np.imag([origin, far]), "o", mfc="0.3", mec="0.2", ms=5)


def main(folder=None) -> dict[str, float]:
    found = da.synthesize(
        da.Target.path(POINTS), bounds=BOUNDS, transmission=math.radians(30), starts=24
    )
    best = found.best
    bar, theta = best.linkage, best.crank_angles
    cognate = bar.cognates()[1]
    ahead = np.angle(1 - complex(bar.u, bar.v) / bar.coupler)
    turn = np.linspace(0, 2 * math.pi, 361)
    curve = bar.path(turn)
    off = abs(cognate.path(turn + ahead) - curve).max()
    print(found)
    print(f"sum of squared distances {best.error:.2g}, {bar.kind}")
    print(", ".join(f"{name} = {value:.4f}" for name, value in bar.numbers.items()))
    print(f"least transmission angle {math.degrees(bar.transmission()):.1f} deg")
    if folder:
        figure, axes = plt.subplots(1, 2, figsize=(9, 4.4))
        for ax, each, shift, title in zip(
            axes, (bar, cognate), (0.0, ahead), (f"found: {bar.kind}", "cognate"), strict=True
        ):
            ax.plot(*curve.T, color=style.PINK, lw=1)
            ax.plot(*POINTS.T, "o", color="black", ms=4, zorder=6)
            draw(ax, each, theta[2] + shift, style.BLUE if each is bar else style.ORANGE)
            ax.set(title=title, xlabel="x", ylabel="y", aspect="equal")
        style.save(figure, folder, "straight_line_synthesis")
    return {"error": best.error, "off": float(off), "transmission": bar.transmission()}


if __name__ == "__main__":
    main(*sys.argv[1:])
