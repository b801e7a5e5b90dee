"""Dead-centre synthesis: crank–rockers from the swing angle and the crank advance."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage_fit import QUIET
from dalembert.errors import AnalysisError
from dalembert.text.arguments import check_arguments


@check_arguments
def dead_centre_four_bar(
    swing: float, advance: float = 0.0, ground: float = 1.0, minimum_crank_ratio: float = 0.1
) -> FourBar:
    """Crank–rocker with prescribed swing and advance, and the best transmission angle.

    At the dead centres crank and coupler are collinear, ``B = (c + d) e^{iθ}`` and
    ``B = (c − d) e^{i(θ + α)}``, with the crank at ``θ`` and ``θ + π + α``; the follower turns by
    the swing between them. The minimum transmission angle, where crank and ground are collinear, is
    maximised.
    Source: J. Volmer, *Getriebetechnik*, ch. on crank–rockers by dead centres (Alt's task).

    Parameters
    ----------
    swing : swing angle of the rocker [rad], between 0 and π
    advance : ``α`` [rad]: the crank turns by ``π + α`` in one stroke, by ``π − α`` in the other
    ground : length of the frame
    minimum_crank_ratio : minimum ratio of crank and frame length; without advance, the optimum
        would be a crank of zero length

    Raises
    ------
    AnalysisError
        No crank–rocker has this swing and advance.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> bar = da.dead_centre_four_bar(swing=math.radians(60), advance=math.radians(10))
    >>> bar.kind, round(math.degrees(bar.transmission()), 1) > 30
    ('crank-rocker', True)
    """
    if not 0 < swing < math.pi or not abs(advance) < math.pi / 2:
        raise AnalysisError(
            f"the swing is between 0 and π and the advance between ±π/2 [rad], got {swing:g}, "
            f"{advance:g}"
        )
    names = ("crank", "coupler", "follower", "theta", "psi", "cosine")
    x = [ca.SX.sym(name) for name in names]
    solvers = [_programme(x, sense * swing, advance) for sense in (1, -1)]
    candidates: list[tuple[float, FourBar]] = []
    for solver, size in ((solver, s) for solver in solvers for s in (0.6, 0.9, 1.3)):
        half = math.sin(swing / 2)
        start = [size * half, 1.0, size, 0.6, math.pi / 2, 0.9]
        result = solver(
            x0=start,
            lbx=[minimum_crank_ratio, 0.01, 0.01, -math.pi, -2 * math.pi, 0],
            ubx=[1.0, 10, 10, math.pi, 2 * math.pi, 1],
            lbg=0,
            ubg=[0, 0, 0, 0, *[math.inf] * 6],
        )
        if solver.stats()["success"]:
            q = np.array(result["x"]).ravel()
            lengths = dict(zip(("crank", "coupler", "follower"), q * ground, strict=False))
            candidates.append((q[5], FourBar(**lengths, ground=ground)))
    if not candidates:
        raise AnalysisError(
            f"no crank–rocker swings by {math.degrees(swing):.4g}° with an advance of "
            f"{math.degrees(advance):.4g}°; reduce one of them"
        )
    return min(candidates, key=lambda pair: pair[0])[1]


def _programme(x: list[ca.SX], swing: float, advance: float) -> ca.Function:
    d, c, f, theta, psi, cosine = x
    rows = []
    for length, angle, follower in (
        (c + d, theta, psi),
        (c - d, theta + advance, psi + swing),
    ):
        rows += [length * turn(angle) - f * turn(follower) for turn in (ca.cos, ca.sin)]
    equations = [rows[0] - 1, rows[1], rows[2] - 1, rows[3]]
    shortest, longest, product = (1 - d) ** 2, (1 + d) ** 2, 2 * c * f * cosine
    squares = c**2 + f**2
    limits = [shortest - squares + product, squares + product - longest, c - d - 1e-3, 1 - d - 1e-3]
    limits += [
        ca.sin(psi - theta) - 1e-3,
        ca.sin(psi + swing - theta - advance) - 1e-3,
    ]  # one branch
    problem = {"x": ca.vertcat(*x), "f": cosine, "g": ca.vertcat(*equations, *limits)}
    settings: dict[str, Any] = {"ipopt.tol": 1e-12, "ipopt.max_iter": 500, "error_on_fail": False}
    return ca.nlpsol("dead_centres", "ipopt", problem, QUIET | settings)
