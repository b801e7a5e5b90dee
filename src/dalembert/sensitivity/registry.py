"""Which engine differentiates the results of which analysis."""

from __future__ import annotations

from collections.abc import Sequence

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.equilibrium import Equilibrium
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.nonlinear_statics import NonlinearStatics
from dalembert.analysis.statics import Statics
from dalembert.errors import UnsupportedError
from dalembert.responses.base import Response
from dalembert.results.motion import Motion
from dalembert.sensitivity.dynamics import DynamicsEngine
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.pointwise import PointwiseEngine
from dalembert.sensitivity.samples import take_sample
from dalembert.sensitivity.statics import StaticsEngine

ENGINES: dict[type, type[Engine]] = {
    Dynamics: DynamicsEngine,
    Kinematics: PointwiseEngine,
    Equilibrium: PointwiseEngine,
    Statics: StaticsEngine,
    NonlinearStatics: StaticsEngine,
}
"""Analysis → engine; subclasses of an analysis use the same."""


def engine_of(motion: Motion, responses: Sequence[Response]) -> Engine:
    """The engine for responses of a result.

    Raises
    ------
    UnsupportedError
        The analysis has none.
    """
    for kind in type(motion.analysis).__mro__:
        if kind in ENGINES:
            return ENGINES[kind]([take_sample(motion, r) for r in responses])
    raise UnsupportedError(
        f"gradients of {type(motion.analysis).__name__} are not available; use "
        "method='finite-difference'"
    )
