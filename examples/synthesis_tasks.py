"""Six synthesis tasks, each with a mechanism that solves it.

The tasks are a function (the logarithm from 1 to 2 by crank angles of 60° and 90°), poses of a
body, a crank–rocker with a given swing between its dead centres, all four-bars through five points
with given pivots, a six-bar of Watt's second kind along a line, and a geared five-bar along another
line.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da

SWING, ADVANCE = math.radians(60), math.radians(10)
ARGUMENT = np.linspace(1, 2, 7)
CRANK, FOLLOWER = math.radians(60), math.radians(90)
POSES = [(0.0, 0.0, 0.0), (0.5, 0.6, 20.0), (1.2, 1.0, 45.0), (2.0, 1.1, 70.0), (2.8, 0.9, 90.0)]
FIVE = [(-0.3, 0.6), (0.0, 0.9), (0.4, 1.0), (0.8, 0.85), (1.1, 0.5)]
SIX = {"A": (4, 0), "B": (0, 0), "C": (8, 0), "F": (1, 0.5)}
SIX |= {"D": (4.5, 3), "E": (6.5, 2.2), "G": (9, 3)}
LINE = [(8.8 + 0.1 * k, 3.0) for k in range(6)]
GEARED = {"O1": (0, 0), "O2": (3, 0), "A": (0.5, 0.5), "B": (3.6, 0.8), "C": (2, 3.5)}
EDGE = [(1.7 + 0.1 * k, 3.5) for k in range(6)]


def function() -> da.Solution:
    wanted = FOLLOWER * np.log10(ARGUMENT) / math.log10(2)
    target = da.Target.function(CRANK * (ARGUMENT - 1), wanted)
    return da.synthesize(target, crank_turns=False, starts=6).best


def motion() -> da.Solution:
    points = [(x, y) for x, y, _ in POSES]
    target = da.Target.motion(points, [math.radians(angle) for *_, angle in POSES])
    bounds = dict.fromkeys(("crank", "coupler", "follower", "ground"), (0.5, 4.0))
    return da.synthesize(target, crank_turns=False, bounds=bounds, starts=12).best


def along(line, model, point: str):
    return da.synthesize_mechanism(da.Target.path(line), model, point=point, starts=2).best


def pins(bar: da.FourBar, theta: float) -> np.ndarray:
    """Pivot, crank pin, coupler point, follower pin and the other pivot, as complex numbers."""
    phi, _ = bar.loop(bar.numbers, bar.branch, np.array([theta]))
    base = complex(bar.x, bar.y)
    crank = base + bar.crank * np.exp(1j * theta)
    turned = np.exp(1j * phi[0])
    end = crank + bar.coupler * turned
    point, other = (
        crank + complex(bar.u, bar.v) * turned,
        base + bar.ground * np.exp(1j * bar.angle),
    )
    return np.array([base, crank, point, end, crank, end, other])


def main(folder=None) -> dict[str, float]:
    made = {"function": function(), "motion": motion()}
    rocker = da.dead_centre_four_bar(SWING, ADVANCE)
    five = da.five_point_four_bars(FIVE)
    six = along(
        LINE, da.six_bar("watt II", SIX, {"upper": {"P": (9, 3)}}, reach=1.0).build(), "upper.P"
    )
    geared = da.geared_five_bar(GEARED, -1.0, {"left": {"P": (2, 3.5)}}, reach=0.8).build()
    edge = along(EDGE, geared, "left.P")
    whole = [one for one in five.four_bars if one.on_one_branch]
    found = {f"error of the {name}": one.error for name, one in made.items()}
    found |= {f"rocker: {name}": getattr(rocker, name) for name in rocker.lengths}
    found |= {"least transmission": rocker.transmission(), "four-bars": len(five.four_bars)}
    found |= {"of five points": len(whole), "error of the six-bar": six.error}
    found |= {"error of the geared five-bar": edge.error}
    print(*(f"{name}: {value:.6g}" for name, value in found.items()), sep="\n")
    if folder:
        picture(folder, made, rocker, whole, six, edge)
    return found


def picture(folder, made, rocker, whole, six, edge) -> None:
    figure, axes = plt.subplots(2, 3, figsize=(10.5, 6.4))
    drawn_function(axes[0, 0], made["function"])
    drawn_motion(axes[0, 1], made["motion"])
    drawn_rocker(axes[0, 2], rocker)
    drawn_five(axes[1, 0], whole)
    for ax, best, line, title in (
        (axes[1, 1], six, LINE, "a six-bar along a line"),
        (axes[1, 2], edge, EDGE, "a geared five-bar along another"),
    ):
        style.draw(ax, best.entries, float(best.entries.time[0]))
        ax.plot(*np.asarray(best.curve()).T, color=style.ORANGE, lw=1)
        ax.plot(*np.transpose(line), "o", color="k", ms=3, zorder=9)
        ax.set(title=title)
    for ax in axes.ravel()[1:]:
        ax.set_xticklabels([])
        ax.set_yticklabels([])
    style.save(figure, folder, "synthesis_tasks")


def drawn(ax, bar: da.FourBar, theta: float, colour: str, alpha: float = 1.0) -> None:
    z = pins(bar, theta)
    ax.plot(z.real, z.imag, color=colour, lw=1.6, alpha=alpha)
    ax.plot(z[[1, 3]].real, z[[1, 3]].imag, "o", ms=4, mfc="w", mec="0.2", alpha=alpha, zorder=5)
    ax.plot(z[[0, 6]].real, z[[0, 6]].imag, "o", ms=5, color="0.3", zorder=5)
    ax.set_aspect("equal", adjustable="datalim")


def drawn_function(ax, best: da.Solution) -> None:
    fine = np.linspace(best.crank_angles[0], best.crank_angles[-1], 100)
    turned = np.degrees(best.linkage.output(fine) - best.linkage.output(fine)[0])
    x = 1 + (fine - fine[0]) / CRANK
    ax.plot(x, abs(turned), label="four-bar")
    ax.plot(ARGUMENT, 90 * np.log10(ARGUMENT) / math.log10(2), "ko", ms=3, label="logarithm")
    ax.set(title="a function: log x", xlabel="x, 60° of the crank", ylabel="follower [°]")
    ax.legend()


def drawn_motion(ax, best: da.Solution) -> None:
    for k, (x, y, angle) in enumerate(POSES):
        along = 0.35 * np.exp(1j * math.radians(angle))
        ends = complex(x, y) + np.array([-along, along])
        ax.plot(ends.real, ends.imag, color="k", lw=3, zorder=6)
        ax.plot(x, y, "o", color="k", ms=4)
        if k in (0, len(POSES) - 1):
            drawn(ax, best.linkage, best.crank_angles[k], style.BLUE, 0.9 if k == 0 else 0.4)
    ax.set(title="poses of a body")


def drawn_rocker(ax, bar: da.FourBar) -> None:
    for sign, colour in ((1, style.BLUE), (-1, style.ORANGE)):
        reach = bar.coupler + sign * bar.crank
        cosine = (bar.ground**2 + reach**2 - bar.follower**2) / (2 * bar.ground * reach)
        way = math.acos(cosine)
        for theta in (way, -way) if sign > 0 else (math.pi + way, math.pi - way):
            z = pins(bar, theta)
            if abs(abs(z[3] - z[0]) - reach) < 1e-6:
                drawn(ax, bar, theta, colour)
    ax.set(title="a rocker of 60°, its ways 190° and 170°")


def drawn_five(ax, whole) -> None:
    turn = np.linspace(0, 2 * np.pi, 721)
    for one, colour in zip(whole, style.COLOURS, strict=False):
        path = one.linkage.path(turn)
        ax.plot(*path.T, color=colour, lw=1)
        drawn(ax, one.linkage, one.crank_angles[2], colour, 0.35)
    ax.plot(*np.transpose(FIVE), "o", color="k", ms=4, zorder=9)
    ax.set_aspect("equal", adjustable="box")
    ax.set(title="all that lead through five points", xlim=(-1.6, 2.4), ylim=(-1.4, 2.0))


if __name__ == "__main__":
    main(*sys.argv[1:])
