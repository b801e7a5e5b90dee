"""Exact linkages through poses: pairs of Burmester dyads with their defects."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.synthesis.burmester import Dyad, burmester_dyads
from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.slider_crank import SliderCrank

TOLERANCE = 1e-6
"""Upper limit of the relative deviation from the poses."""
SCAN = 720
"""Number of crank angles for the range of a rocking crank."""


@dataclass(frozen=True, eq=False)
class PoseLinkage:
    """A linkage with its coupler in all poses, and the defects of its motion.

    Attributes
    ----------
    linkage : FourBar or SliderCrank, on the branch of the first pose
    crank_angles : (n,) at the poses
    branch_defect : the driven crank passes a dead centre between poses
    circuit_defect : a pose is on another circuit
    order_defect : the crank passes the poses in another order
    residual : largest deviation from the poses, from the solution of the loop
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
        return tuple(name for name, present in named.items() if present)


@dataclass(frozen=True, eq=False)
class PoseLinkages:
    """All linkages of pairs of dyads, linkages without defects first.

    Attributes
    ----------
    dyads : list of Dyad
    linkages : list of PoseLinkage, for each pair that is a four-bar or a slider-crank
    """

    dyads: list[Dyad]
    linkages: list[PoseLinkage]


def pose_linkages(points: ArrayLike, angles: ArrayLike, samples: int = 24) -> PoseLinkages:
    """All four-bars and slider-cranks that guide the coupler through two to five poses exactly.

    Five poses have up to four Burmester dyads and up to six linkages. For fewer poses the dyads
    are samples. Each pair is driven at the pivot with the fewest defects. Pairs of sliders are
    excluded.

    Parameters
    ----------
    points : (n, 2) positions of a coupler point in each pose
    angles : (n,) angles of the coupler [rad]
    samples : approximate number of dyads for fewer than five poses

    Raises
    ------
    AnalysisError
        There are not two to five poses, or two poses are equal.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.2, u=0.5, v=0.6)
    >>> turn = [0.2, 0.9, 1.7, 2.6, 3.4]
    >>> result = da.pose_linkages(bar.path(turn), bar.coupler_angle(turn))
    >>> len(result.dyads), len(result.linkages)
    (4, 6)
    >>> bars = [candidate.linkage for candidate in result.linkages]
    >>> {0.4, 0.9} in [{round(b.crank, 6), round(b.follower, 6)} for b in bars]
    True
    """
    dyads = burmester_dyads(points, angles, samples)
    alpha = np.asarray(angles, dtype=float)
    z = np.asarray(points, dtype=float) @ [1, 1j]
    linkages = []
    for dyad, other in combinations(dyads, 2):
        drives = [(a, b) for a, b in ((dyad, other), (other, dyad)) if not a.is_slider]
        candidates = [_linkage(a, b, z, alpha) for a, b in drives]
        valid = [linkage for linkage in candidates if linkage is not None]
        if valid:
            linkages.append(min(valid, key=_preference))
    return PoseLinkages(dyads, sorted(linkages, key=_preference))


def _preference(candidate: PoseLinkage) -> tuple[int, bool, float]:
    """Sorting key: number of defects, rocking crank, negative transmission angle."""
    transmission = candidate.linkage.transmission(candidate.crank_angles)
    return len(candidate.defects), not candidate.linkage.crank_turns, -transmission


def _linkage(drive: Dyad, follow: Dyad, z: np.ndarray, alpha: np.ndarray) -> PoseLinkage | None:
    """The linkage of two dyads; None if it degenerates or does not pass the poses."""
    assert drive.center is not None
    rod = follow.places[0] - drive.places[0]
    size = float(np.max(abs(z - z[0]))) or abs(rod)
    radius = abs(drive.places[0] - drive.center)
    if min(abs(rod), radius) < TOLERANCE * size:
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
        slider = (follow.places[0] - drive.center) * np.exp(-1j * follow.direction)
        specific = {"offset": float(slider.imag), "angle": follow.direction}
        branches = np.sign(np.cos(phi - follow.direction))
        return _check_linkage(SliderCrank, shared | specific, branches, theta, phi, z, size)
    ground = follow.center - drive.center
    arm = follow.places - follow.center
    if min(abs(ground), abs(arm[0])) < TOLERANCE * size:
        return None
    specific = {
        "ground": float(abs(ground)),
        "angle": float(np.angle(ground)),
        "follower": float(abs(arm[0])),
    }
    branches = np.sign(np.sin(np.angle(arm) - phi))
    return _check_linkage(FourBar, shared | specific, branches, theta, phi, z, size)


def _check_linkage(
    kind: type[Linkage],
    numbers: dict[str, float],
    branches: np.ndarray,
    theta: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    size: float,
) -> PoseLinkage | None:
    """The linkage with its defects, from the solution of the loop at all poses."""
    branches = np.where(branches == 0, 1, branches).astype(int)
    linkage = kind(**numbers, branch=int(branches[0]))
    coupler_angles, output = linkage.loop(linkage.numbers, branches, theta)
    positions = linkage.points(linkage.numbers, branches, theta)
    deviation = np.maximum(
        abs(positions - z) / size, abs(np.exp(1j * coupler_angles) - np.exp(1j * phi))
    )
    residual = float(np.max(deviation)) if np.all(np.isfinite(deviation)) else np.inf
    if not residual < np.sqrt(TOLERANCE):  # near a dead centre the loop has half the digits
        return None
    circuits = kind.circuits(linkage.numbers, theta, phi, output)
    branch, circuit = bool(np.ptp(branches)), bool(np.ptp(circuits))
    order = not (branch or circuit) and not _in_order(linkage, theta)
    return PoseLinkage(linkage, theta, branch, circuit, order, residual)


def _in_order(linkage: Linkage, theta: np.ndarray) -> bool:
    """Whether a crank on one branch passes the angles in order, in either sense."""
    if linkage.crank_turns:
        return any(np.sum(np.diff(s * theta) % (2 * np.pi)) < 2 * np.pi for s in (1, -1))
    turn = np.arange(SCAN) * 2 * np.pi / SCAN
    open_angles = turn[~np.isfinite(linkage.coupler_angle(turn))]
    start = float(open_angles[0]) if open_angles.size else 0.0
    steps = np.diff((theta - start) % (2 * np.pi))
    return bool(np.all(steps > 0) or np.all(steps < 0))
