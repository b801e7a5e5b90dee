"""Linearisation about a state: eigenfrequencies, damping ratios, mode shapes.

The first-order system ``ẋ = F(x)`` with accelerations from (5.7) is linearised on the tangent
space of ``Φ = 0, Ψ = 0``: with a basis ``T`` of it, ``A = T⁺ (∂F/∂x) T``. At rest this gives the
usual modes of ``(ZᵀMZ, ZᵀDZ, ZᵀKZ)``; it holds in motion too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.linearization_kernel import Linearized, linearization_kernel
from dalembert.analysis.keywords import LinearizationKeywords
from dalembert.analysis.requirements import need_mechanism
from dalembert.analysis.spectral import SpectralAnalysis
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.mechanism_modes import Modes
from dalembert.results.motion import Motion
from dalembert.results.result import ParameterValues
from dalembert.text.arguments import check_arguments

ABSOLUTE = AbsoluteCoordinates()
"""Default coordinates."""
__all__ = ["Linearization", "Modes", "MotionLinearization", "linearize"]


@options
class Linearization(SpectralAnalysis[Model, Modes]):
    """Linearisation as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are evaluated [s]
    equilibrium : linearise about the static equilibrium; otherwise about the assembled state
    coordinates : coordinates of small motions. In a steady motion, such as that of a rolling wheel
        or a spinning governor, eigenvalues are meaningful if only cyclic coordinates change, as
        with ``JointCoordinates()``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(0, -0.981)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=0.981))
    >>> modes = da.Linearization().run(system.build())
    >>> modes.eigenvalues.imag.round(6)  # √(g/l)
    array([3.162278])
    """

    spoken = "modes"
    modes_class = Modes

    time: float = 0.0
    equilibrium: bool = True
    coordinates: Coordinates = ABSOLUTE

    def spectrum(self, model: Model, p: np.ndarray) -> Linearized:
        """Linearised system about the equilibrium or the assembled state.

        Raises
        ------
        AnalysisError
            No equilibrium was found.
        """
        if self.equilibrium:
            return at_rest(Equilibrium(self.time).run(model, p), self.coordinates)
        kernel, state = linearization_kernel(model, self.coordinates), model.assemble(p, self.time)
        x = kernel.state(self.time, state.y, state.v, p)
        return Linearized(kernel, self.time, x, p, kernel.assembled, state.y, state.residual)

    def again(self, result: Modes, p: np.ndarray) -> Linearized:
        if not self.equilibrium:
            return self.spectrum(result.model, p)
        start = result.record.near[: result.model.equations.coordinate_count]
        equilibrium = Equilibrium(self.time).run(result.model, p, start=start)
        return at_rest(equilibrium, self.coordinates)


@dataclass(frozen=True)
class MotionLinearization(SpectralAnalysis[Model, Modes]):
    """Linearisation about the last instant of a motion.

    Parameters
    ----------
    motion : Motion
    coordinates : as in ``Linearization``
    """

    spoken = "modes"
    modes_class = Modes

    motion: Motion
    coordinates: Coordinates = ABSOLUTE

    def run(self, model: Model, parameters: ParameterValues = None, progress: Any = False) -> Modes:
        """The modes at the end of the motion, by default at its own parameters."""
        if model is not self.motion.model:
            raise AnalysisError("the motion belongs to another model; pass the model of the motion")
        return super().run(model, self.motion.parameters if parameters is None else parameters)

    def spectrum(self, model: Model, p: np.ndarray) -> Linearized:
        return last_instant(self.motion.analysis.replay(self.motion, p), self.coordinates)


def at_rest(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about an equilibrium.

    Raises
    ------
    AnalysisError
        The search for the equilibrium failed.
    """
    status, s = motion.status, motion.trajectory
    kernel = linearization_kernel(motion.model, coordinates)
    if not status.success:
        raise AnalysisError(f"linearize: no equilibrium, {status}", status.residual)
    time, near = float(s.t[0]), motion.record.kernel.near(s)[:, 0]
    x = kernel.state(time, s.y[:, 0], s.v[:, 0], motion.parameters)
    return Linearized(kernel, time, x, motion.parameters, kernel.resting, near, status.residual)


def last_instant(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about the end of a motion, without dependence on the parameters."""
    s, kernel = motion.trajectory, linearization_kernel(motion.model, coordinates)
    x = kernel.state(float(s.t[-1]), s.y[:, -1], s.v[:, -1], motion.parameters)
    return Linearized(kernel, float(s.t[-1]), x, motion.parameters)


@check_arguments
def linearize(
    model: Model,
    at: Motion | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    coordinates: Coordinates = ABSOLUTE,
    **options: Unpack[LinearizationKeywords],
) -> Modes:
    """Eigenfrequencies, damping ratios and mode shapes on the constraint tangent space.

    Use ``solve_modes`` for the lowest modes of a structure.

    Parameters
    ----------
    model : Model
    at : a motion or equilibrium whose last instant is the state; by default the equilibrium
    parameters : new values of parameters, without rebuilding
    coordinates : coordinates of small motions; ``JointCoordinates()`` about a steady motion with
        changing cyclic coordinates
    **options : fields of ``Linearization``: time, equilibrium

    Raises
    ------
    AnalysisError
        No equilibrium was found, or wrong options; ``SingularityError`` where a free motion has no
        mass.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> part = system.add(spring)
    >>> modes = da.linearize(system.build())
    >>> modes.damping_ratios.round(6), (modes.frequencies * 2 * math.pi).round(6)
    (array([0.1]), array([10.]))
    """
    if at is not None:
        if parameters or options:
            names = ", ".join([*(parameters or ()), *options])
            raise AnalysisError(f"linearize: {names} cannot be given with at=, which has its own")
        if at.analysis.at_rest:
            analysis = Linearization(float(at.time[0]), coordinates=coordinates)
            return analysis.modes(at_rest(at, coordinates))
        return MotionLinearization(at, coordinates).modes(last_instant(at, coordinates))
    linearization = analysis_of(
        Linearization, "linearize", model, parameters, coordinates=coordinates, **options
    )
    need_mechanism(model, "linearize", "use solve_modes")
    return linearization.run(model, parameters)
