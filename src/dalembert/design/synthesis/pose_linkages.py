"""Linkages through poses: pairs of Burmester dyads with their defects."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from dalembert.design.synthesis.burmester import Dyad, burmester_dyads
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.slider_crank import SliderCrank

CLOSED = 1e-6
"""Relative deviation from the poses up to which a linkage passes them."""
SCAN = 720
"""Crank angles at which the range of a rocking crank is looked for."""


@dataclass(frozen=True, eq=False)
class PoseLinkage:
    """A linkage whose coupler takes all poses, and its defects as the crank drives it.

    Attributes
    ----------
    linkage : FourBar or SliderCrank, on the branch of the first pose
    crank_angles : (n,) at the poses
    branch_defect : the driven crank has to pass a dead centre between poses
    circuit_defect : the loop must be opened to reach some pose
    order_defect : the crank passes the poses in another order
    residual : largest deviation from the poses, by solving the loop at the crank angles
    """

    linkage: Linkage
    crank_angles: np.ndarray
    branch_defect: bool
    circuit_defect: bool
    order_defect: bool
    residual: float

    @property
    def defects(self) -> tuple[str, ...]:
        """Names of its defects."""
        named = {
            "branch": self.branch_defect,
            "circuit": self.circuit_defect,
            "order": self.order_defect,
        }
        return tuple(name for name, there in named.items() if there)


@dataclass(frozen=True, eq=False)
class PoseLinkages:
    """All linkages of pairs of dyads, those without defects first.

    Attributes
    ----------
    dyads : list of Dyad
    linkages : list of PoseLinkage, one for each pair that is a four-bar or a slider-crank
    """

    dyads: list[Dyad]
    linkages: list[PoseLinkage]


def pose_linkages(points: Any, angles: Any, samples: int = 24) -> PoseLinkages:
    """All four-bars and slider-cranks whose coupler takes two to five poses exactly.

    Five poses have up to four Burmester dyads and so up to six linkages. For fewer poses the dyads
    are samples. Each pair stands once, driven at the pivot that leaves the fewest defects. A pair
    of sliders is left out.

    Parameters
    ----------
    points : (n, 2) of a coupler point in each pose
    angles : (n,) of the coupler [rad]
    samples : of the dyads of less than five poses, about

    Raises
    ------
    AnalysisError
        Not two to five poses, or two that are one.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.2, u=0.5, v=0.6)
    >>> turn = [0.2, 0.9, 1.7, 2.6, 3.4]
    >>> found = da.pose_linkages(bar.path(turn), bar.coupler_angle(turn))
    >>> len(found.dyads), len(found.linkages)
    (4, 6)
    >>> bars = [one.linkage for one in found.linkages]
    >>> {0.4, 0.9} in [{round(one.crank, 6), round(one.follower, 6)} for one in bars]
    True
    """
    dyads = burmester_dyads(points, angles, samples)
    alpha = np.asarray(angles, dtype=float)
    z = np.asarray(points, dtype=float) @ [1, 1j]
    found = []
    for one, other in combinations(dyads, 2):
        drives = [(a, b) for a, b in ((one, other), (other, one)) if not a.is_slider]
        built = [_linkage(a, b, z, alpha) for a, b in drives]
        known = [linkage for linkage in built if linkage is not None]
        if known:
            found.append(min(known, key=_preference))
    return PoseLinkages(dyads, sorted(found, key=_preference))


def _preference(one: PoseLinkage) -> tuple[int, bool, float]:
    least = one.linkage.transmission(one.crank_angles)
    return len(one.defects), not one.linkage.crank_turns, -least


def _linkage(drive: Dyad, follow: Dyad, z: np.ndarray, alpha: np.ndarray) -> PoseLinkage | None:
    """The linkage of two dyads; None where it degenerates or does not pass the poses."""
    assert drive.center is not None
    rod = follow.places[0] - drive.places[0]
    size = float(np.max(abs(z - z[0]))) or abs(rod)
    radius = abs(drive.places[0] - drive.center)
    if min(abs(rod), radius) < CLOSED * size:
        return None
    point = (z[0] - drive.places[0]) * np.conj(rod) / abs(rod)
    shared: dict[str, float] = {
        **{"crank": float(radius), "coupler": float(abs(rod))},
        **{"x": drive.center.real, "y": drive.center.imag},
        **{"u": float(point.real), "v": float(point.imag)},
    }
    theta = np.angle(drive.places - drive.center)
    phi = np.angle(rod) + alpha - alpha[0]
    if follow.center is None:
        along = (follow.places[0] - drive.center) * np.exp(-1j * follow.direction)
        own = {"offset": float(along.imag), "angle": follow.direction}
        branches = np.sign(np.cos(phi - follow.direction))
        return _judged(SliderCrank, shared | own, branches, theta, phi, z, size)
    ground = follow.center - drive.center
    arm = follow.places - follow.center
    if min(abs(ground), abs(arm[0])) < CLOSED * size:
        return None
    own = {
        "ground": float(abs(ground)),
        "angle": float(np.angle(ground)),
        "follower": float(abs(arm[0])),
    }
    branches = np.sign(np.sin(np.angle(arm) - phi))
    return _judged(FourBar, shared | own, branches, theta, phi, z, size)


def _judged(
    kind: type[Linkage],
    numbers: dict[str, float],
    branches: np.ndarray,
    theta: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    size: float,
) -> PoseLinkage | None:
    """The linkage with its defects, its loop solved at all poses."""
    branches = np.where(branches == 0, 1, branches).astype(int)
    linkage = kind(**numbers, branch=int(branches[0]))
    solved, output = linkage.loop(linkage.numbers, branches, theta)
    places = linkage.points(linkage.numbers, branches, theta)
    off = np.maximum(abs(places - z) / size, abs(np.exp(1j * solved) - np.exp(1j * phi)))
    residual = float(np.max(off)) if np.all(np.isfinite(off)) else np.inf
    if not residual < np.sqrt(CLOSED):  # near a dead centre the loop solves to half the digits
        return None
    circuits = kind.circuits(linkage.numbers, theta, phi, output)
    branch, circuit = bool(np.ptp(branches)), bool(np.ptp(circuits))
    order = not (branch or circuit) and not _in_order(linkage, theta)
    return PoseLinkage(linkage, theta, branch, circuit, order, residual)


def _in_order(linkage: Linkage, theta: np.ndarray) -> bool:
    """Whether a crank on one branch passes the angles in their order, in either sense."""
    if linkage.crank_turns:
        return any(np.sum(np.diff(s * theta) % (2 * np.pi)) < 2 * np.pi for s in (1, -1))
    turn = np.arange(SCAN) * 2 * np.pi / SCAN
    opened = turn[~np.isfinite(linkage.coupler_angle(turn))]
    start = float(opened[0]) if opened.size else 0.0
    steps = np.diff((theta - start) % (2 * np.pi))
    return bool(np.all(steps > 0) or np.all(steps < 0))
