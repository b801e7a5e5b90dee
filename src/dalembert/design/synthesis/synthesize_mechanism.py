"""From what shall be done to the dimensions of a mechanism of one's own that do it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.design.synthesis.mechanism import FoundMechanism, mechanism_task
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.model.model import Model


@dataclass(frozen=True, eq=False)
class MechanismSynthesis:
    """What was found, best first.

    Attributes
    ----------
    solutions : FoundMechanism each
    starts : how many mechanisms it began with
    """

    target: Target
    solutions: list[FoundMechanism]
    starts: int

    @property
    def best(self) -> FoundMechanism:
        return self.solutions[0]

    def __repr__(self) -> str:
        found = len(self.solutions)
        return f"<MechanismSynthesis: {found} mechanisms, least error {self.best.error:.3g}>"


def synthesize_mechanism(
    target: Target,
    model: Model,
    *,
    point: str = "",
    body: str = "",
    output: str = "",
    vary: Sequence[str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    speed: float = 1.0,
    order: bool = True,
    starts: int = 8,
    rng: int | None = 0,
    progress: Callable[[float], None] | None = None,
) -> MechanismSynthesis:
    """Parameters with which a mechanism of any topology does what the target says.

    Least squares from the model as it is and from random ones whose motor turns all the way,
    polished by IPOPT with exact derivatives; every solution is run through a turn again.

    Parameters
    ----------
    target : ``Target.path``, ``Target.motion`` or ``Target.function``
    model : driven by one motor of constant speed, such as ``da.six_bar(...).build()``
    point, body, output : measures of the model that the target is about: a point, the body that is
        guided, an angle or a place
    vary, bounds : parameters, all with two bounds by default
    speed : of the motor [rad/s]
    order : free timing passes the entries in their order
    starts : how many mechanisms are polished, the model itself first
    rng : seed of the starts
    progress : a function of the fraction done

    Raises
    ------
    AnalysisError
        A measure that the target needs is not named, a parameter has no bounds, or no start leads
        to a mechanism that turns.

    Examples
    --------
    >>> import dalembert as da
    >>> chain = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}
    >>> joints = {"A": (0, 0), "B": (0, 1), "C": (3, 2.5), "D": (3, 0)}
    >>> tip = {"coupler": {"P": (1.5, 3)}}
    >>> system = da.linkage_from_chain(chain, joints, "frame", "crank", tip, reach=0.5)
    >>> aim = da.Target.path([(1.5, 3.0), (1.0, 3.1), (0.5, 3.0)])
    >>> found = da.synthesize_mechanism(aim, system.build(), point="coupler.P", starts=1)
    >>> found.best.error < 1e-12  # it passes the three points
    True
    """
    task = mechanism_task(target, model, point, body, output, vary, bounds, speed, order)
    generator, found, begun = np.random.default_rng(rng), [], 0
    nominal = np.array([model.parameters[n].value for n in task.vary])
    for k in range(starts):
        run = task.turned(nominal) if k == 0 else None
        drawn = (nominal, run) if run is not None else task.drawn(generator)
        if drawn is None:
            continue
        begun += 1
        made = task.solved(*drawn)
        if made is not None:
            found.append(made)
        if progress:
            progress((k + 1) / starts)
    if not found:
        raise AnalysisError(
            f"none of {begun} starts leads to a mechanism whose motor turns all the way; give more "
            "starts, or a model that comes near the target"
        )
    found.sort(key=lambda solution: solution.error)
    return MechanismSynthesis(target, _distinct(found), begun)


def _distinct(found: list[FoundMechanism]) -> list[FoundMechanism]:
    kept: list[FoundMechanism] = []
    for one in found:
        mine = list(one.parameters.values())
        if not any(
            np.allclose(mine, list(other.parameters.values()), rtol=1e-4, atol=1e-6)
            for other in kept
        ):
            kept.append(one)
    return kept
