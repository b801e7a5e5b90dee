"""States about which a mechanism is linearised."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.modes.linearization_kernel import Linearized, linearization_kernel
from dalembert.errors import AnalysisError
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion


def linearized(
    analysis: Any,
    model: Model,
    p: np.ndarray,
    about: Motion | None,
    near: np.ndarray | None = None,
) -> Linearized:
    """Linearised system about a result, the static equilibrium or the assembled state.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Modal``
    model : Model
    p : (n,) parameters
    about : equilibrium, or motion whose last instant is the state
    near : pose near which an equilibrium is searched

    Raises
    ------
    AnalysisError
        No equilibrium was found.
    """
    if about is not None and not about.analysis.at_rest:
        return _last_instant(about, analysis.coordinates)
    if about is None and analysis.equilibrium:
        about = Equilibrium(analysis.time).run(model, p, start=near)
    if about is not None:
        return _at_rest(about, analysis.coordinates)
    kernel = linearization_kernel(model, analysis.coordinates)
    state = model.assemble(p, analysis.time)
    x = kernel.state(analysis.time, state.y, state.v, p)
    return Linearized(kernel, analysis.time, x, p, kernel.assembled, state.y, state.residual)


def _at_rest(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about an equilibrium."""
    status, s = motion.status, motion.trajectory
    kernel = linearization_kernel(motion.model, coordinates)
    if not status.success:
        raise AnalysisError(f"no equilibrium, {status}", status.residual)
    time, near = float(s.t[0]), motion.record.kernel.near(s)[:, 0]
    x = kernel.state(time, s.y[:, 0], s.v[:, 0], motion.parameters)
    return Linearized(kernel, time, x, motion.parameters, kernel.resting, near, status.residual)


def _last_instant(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about the end of a motion, without dependence on the parameters."""
    s, kernel = motion.trajectory, linearization_kernel(motion.model, coordinates)
    x = kernel.state(float(s.t[-1]), s.y[:, -1], s.v[:, -1], motion.parameters)
    return Linearized(kernel, float(s.t[-1]), x, motion.parameters)
