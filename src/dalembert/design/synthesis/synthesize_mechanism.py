"""From what shall be done to the dimensions of a mechanism of one's own that do it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.synthesis.found_mechanism import FoundMechanism, MechanismSynthesis
from dalembert.design.synthesis.mechanism_search import MechanismSearch
from dalembert.design.synthesis.mechanism_task import MechanismTask, mechanism_task
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible, searching
from dalembert.model.model import Model
from dalembert.options import random_generator
from dalembert.results.motion import Motion


@interruptible
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
    progress: Reported = False,
) -> MechanismSynthesis:
    """Parameters with which a mechanism of any topology does what the target says.

    Least squares from the model as it is and from random ones whose motor turns all the way,
    polished by IPOPT with exact derivatives; every solution is run through a turn again. Ctrl-C
    ends it with the solutions found until then.

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
    progress : True for a bar, or a function of the fraction done
    rng : seed of the starts

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
    search, found, begun, done = MechanismSearch(task), list[FoundMechanism](), 0, 0
    generator = random_generator(rng)
    with progress_reporter(progress, "mechanisms") as report:
        try:
            with searching():
                for k in range(starts):
                    drawn = _start(task, generator, k)
                    made = None if drawn is None else search.solved(*drawn)
                    begun += drawn is not None
                    found += [] if made is None else [made]
                    done += 1
                    report(done / starts)
        except KeyboardInterrupt:
            if not found:
                raise
    if not found:
        raise AnalysisError(
            f"none of {begun} starts leads to a mechanism whose motor turns all the way; give more "
            "starts, or a model that comes near the target"
        )
    found.sort(key=lambda solution: solution.error)
    return MechanismSynthesis(
        target, _distinct(found), begun, str(model.name), interrupted=done < starts
    )


def _start(
    task: MechanismTask, rng: np.random.Generator, k: int
) -> tuple[np.ndarray, Motion] | None:
    """The model itself at first, where its motor turns; then others, drawn within the bounds."""
    nominal = np.array([task.model.parameters[n].value for n in task.vary])
    run = task.turned(nominal) if k == 0 else None
    return task.drawn(rng) if run is None else (nominal, run)


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
