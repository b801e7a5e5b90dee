"""How the pictures of the examples look, and how a mechanism is drawn in them."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from dalembert.results.pictures.outlines import outline
from dalembert.results.pictures.picture import Picture, pose_of
from dalembert.results.pictures.scene import motion_scene

BLUE, ORANGE, GREEN, PINK, YELLOW, SKY = COLOURS = (
    "#0072b2",
    "#d55e00",
    "#009e73",
    "#b65c98",
    "#c98b00",
    "#3f9bd6",
)
GREY = "0.45"

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.titlesize": 10,
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.alpha": 0.25,
        "axes.prop_cycle": plt.cycler(color=COLOURS),
        "legend.frameon": False,
        "lines.linewidth": 1.6,
        "figure.constrained_layout.use": True,
        "savefig.dpi": 110,
    }
)


def save(figure, folder, name: str) -> None:
    """Write the picture into the folder and close it."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    figure.savefig(Path(folder) / f"{name}.png")
    plt.close(figure)


def draw(ax, motion, time: float = 0.0, alpha: float = 1.0, colours=COLOURS) -> None:
    """The mechanism at the output nearest to a time."""
    k = int(np.argmin(abs(motion.time - time)))
    scene = motion_scene(motion, np.array([k]))
    poses = {b["name"]: [part[0] for part in pose_of(b)] for b in scene["bodies"]}
    poses["ground"] = [np.eye(2), np.zeros(2)]

    def placed(body: str, *points) -> np.ndarray:
        turn, place = poses[body]
        return np.vstack(points) @ turn.T + place

    names = [b["name"] for b in scene["bodies"]]
    bodies = [
        (b["name"], b["shapes"], colours[names.index(b.get("of", b["name"])) % len(colours)])
        for b in scene["bodies"]
    ]
    for name, shapes, colour in [("ground", scene["ground"]["shapes"], "0.72"), *bodies]:
        for shape in shapes:
            _shape(ax, shape, placed(name, outline(shape)), colour, alpha)
    for link in scene["links"]:
        i, j = (placed(link[e]["body"], link[e]["point"])[0] for e in "ij")
        ax.plot(*_coil(i, j, link["symbol"]).T, color="0.3", lw=1.1, alpha=alpha, zorder=4)
    for joint in scene["joints"]:
        if joint["symbol"] in ("pin", "slotpin"):
            ((x, y),) = placed(joint["body"], joint["point"])
            face = "0.3" if joint["grounded"] else "white"
            ax.plot(x, y, "o", ms=5, mfc=face, mec="0.2", mew=1, alpha=alpha, zorder=5)
    ax.set_aspect("equal", adjustable="datalim")


def _shape(ax, shape: dict, points: np.ndarray, colour: str, alpha: float) -> None:
    kind = shape["kind"]
    if kind == "line":
        ax.plot(*points.T, color=colour, lw=1, alpha=alpha, zorder=1)
    elif kind == "bar":
        ax.plot(*points.T, color=colour, lw=4, alpha=alpha, zorder=3, solid_capstyle="round")
    elif kind == "particle":
        ax.plot(*points.T, "o", color=colour, ms=7, alpha=alpha, zorder=5)
    else:
        ax.fill(*points.T, fc=(colour, 0.18 * alpha), ec=(colour, alpha), lw=1.4, zorder=2)


def _coil(i: np.ndarray, j: np.ndarray, symbol: str) -> np.ndarray:
    """A zigzag from i to j for springs, a straight line for other links."""
    if symbol != "coil":
        return np.array([i, j])
    along = j - i
    across = np.array([-along[1], along[0]]) * 0.03
    steps = np.linspace(0.15, 0.85, 17)
    sides = np.array([0, *[1, -1] * 7, 1, 0])
    return np.array(
        [i, *(i + s * along + k * across for s, k in zip(steps, sides, strict=True)), j]
    )


def space(ax, motion, time: float = 0.0, trace: str = "") -> None:
    """A mechanism in space at the output nearest to a time, and the path of a point."""
    k = int(np.argmin(abs(motion.time - time)))
    some = np.linspace(0, motion.time.size - 1, 40).astype(int)
    Picture(motion, np.r_[k, some], ax).show(0)
    if trace:
        ax.plot(*(motion[f"{trace}.{axis}"] for axis in "xyz"), color=PINK, lw=1)


def beside(width: float = 9.0, height: float = 3.6):
    """A figure with a picture in space on the left and a diagram on the right."""
    figure = plt.figure(figsize=(width, height))
    figure.get_layout_engine().set(wspace=0.1)
    left = figure.add_subplot(1, 2, 1, projection="3d")
    left.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    left.locator_params(nbins=4)
    return figure, left, figure.add_subplot(1, 2, 2)
