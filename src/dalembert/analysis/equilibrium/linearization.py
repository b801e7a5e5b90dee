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

from dalembert.analysis.contact.unseen import unseen_contacts
from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.linearization_kernel import Linearized, linearization_kernel
from dalembert.analysis.keywords import LinearizationKeywords
from dalembert.analysis.served import need_mechanism
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.mechanism_modes import Modes
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.result import Analysis
from dalembert.results.status import eigenpairs_status
from dalembert.text.spelling import spelled

ABSOLUTE = AbsoluteCoordinates()
STEADY = 1e-3
"""Change of the matrix within a natural time that a steady motion may show."""
OF_AN_INSTANT = (
    "the motion is not steady in these coordinates: eigenvalues are those of an instant and say "
    "little about stability; coordinates=JointCoordinates() helps where only cyclic angles change, "
    "with the bodies that do not spin carrying the others"
)
__all__ = ["Linearization", "Modes", "MotionLinearization", "linearize"]


@options
class Linearization(Analysis[Model, Modes]):
    """Linearisation as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are taken [s]
    equilibrium : first find the static equilibrium; otherwise take the assembled state
    coordinates : in which small motions are described. In a steady motion, such as of a wheel that
        rolls or of a governor that turns, eigenvalues mean something where nothing but cyclic
        coordinates change: those of joints, ``JointCoordinates()``

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

    time: float = 0.0
    equilibrium: bool = True
    coordinates: Coordinates = ABSOLUTE

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
    ) -> Modes:
        """Linearise about the equilibrium or the assembled state.

        Raises
        ------
        AnalysisError
            No equilibrium was found.
        """
        p = model.values(parameters)
        return modes_of(self, self._state(model, p))

    def _state(self, model: Model, p: np.ndarray) -> Linearized:
        if self.equilibrium:
            return at_rest(Equilibrium(self.time).run(model, p), self.coordinates)
        kernel, state = linearization_kernel(model, self.coordinates), model.assemble(p, self.time)
        x = kernel.state(self.time, state.y, state.v, p)
        return Linearized(kernel, self.time, x, p, kernel.assembled, state.y, state.residual)

    def replay(self, modes: Modes, p: np.ndarray) -> Modes:
        """The same modes at other parameter values, told by their shapes, not their order."""
        if self.equilibrium:
            start = modes.record.near[: modes.model.equations.coordinate_count]
            found = Equilibrium(self.time).run(modes.model, p, start=start)
            state = at_rest(found, self.coordinates)
        else:
            state = self._state(modes.model, p)
        return modes_of(self, state, modes)


@dataclass(frozen=True)
class MotionLinearization(Analysis[Model, Modes]):
    """Linearisation about the last instant of a motion.

    Parameters
    ----------
    motion : Motion
    coordinates : as of ``Linearization``
    """

    spoken = "modes"

    motion: Motion
    coordinates: Coordinates = ABSOLUTE

    def run(
        self, model: Model, parameters: Mapping[str, float] | np.ndarray | None = None
    ) -> Modes:
        """The modes at the end of the motion."""
        if model is not self.motion.model:
            raise AnalysisError("the motion is of another model; linearize with the one it is of")
        p = self.motion.parameters if parameters is None else model.values(parameters)
        return modes_of(
            self, last_instant(self.motion.analysis.replay(self.motion, p), self.coordinates)
        )

    def replay(self, modes: Modes, p: np.ndarray) -> Modes:
        """The same modes at the end of the motion at other parameter values."""
        motion = self.motion.analysis.replay(self.motion, p)
        return modes_of(self, last_instant(motion, self.coordinates), modes)


def at_rest(motion: Motion, coordinates: Coordinates) -> Linearized:
    """The system about an equilibrium.

    Raises
    ------
    AnalysisError
        The search for it failed.
    """
    status, s = motion.status, motion.trajectory
    kernel = linearization_kernel(motion.model, coordinates)
    if not status.success:
        raise AnalysisError(f"linearize: no equilibrium, {status}", status.residual)
    time, near = float(s.t[0]), motion.record.kernel.near(s)[:, 0]
    x = kernel.state(time, s.y[:, 0], s.v[:, 0], motion.parameters)
    return Linearized(kernel, time, x, motion.parameters, kernel.resting, near, status.residual)


def last_instant(motion: Motion, coordinates: Coordinates) -> Linearized:
    """The system about the end of a motion; how it depends on the parameters is not told."""
    s, kernel = motion.trajectory, linearization_kernel(motion.model, coordinates)
    x = kernel.state(float(s.t[-1]), s.y[:, -1], s.v[:, -1], motion.parameters)
    return Linearized(kernel, float(s.t[-1]), x, motion.parameters)


def modes_of(analysis: Any, state: Linearized, earlier: Modes | None = None) -> Modes:
    """One mode of each conjugate pair by increasing ``|s|``, or those that earlier ones became."""
    if earlier is None:
        positions = state.one_of_each_pair()
        numbers = np.arange(1, positions.size + 1)
    else:
        positions = state.following(earlier.record, earlier.positions)
        numbers = earlier.numbers
    return Modes(
        state.model,
        analysis,
        state.p,
        numbers,
        state.eigenvalues[positions],
        state.displacements(positions),
        eigenpairs_status(f"{numbers.size} mode(s)", state.left, state.time, state.residual),
        positions,
        state,
        warnings=_doubts(state),
    )


def _doubts(state: Linearized) -> tuple[str, ...]:
    """A motion that is not steady, and contacts that small motions would open or close."""
    y, model = state.kernel.bodies(state.time, state.x, state.p)[:, None], state.model
    still, none = np.zeros((model.equations.speed_count, 1)), np.zeros((0, 1))
    instant = Trajectory(np.array([state.time]), y, still, still, none, np.zeros((2, 1)))
    unsteady = (OF_AN_INSTANT,) if state.unsteadiness > STEADY else ()
    return (*unsteady, *unseen_contacts(model, instant, state.p, forces=True))


@spelled
def linearize(
    model: Model,
    at: Motion | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    coordinates: Coordinates = ABSOLUTE,
    **options: Unpack[LinearizationKeywords],
) -> Modes:
    """Eigenfrequencies, damping ratios and mode shapes on the constraint tangent space.

    Those of a structure are found by ``solve_modes``, some of many.

    Parameters
    ----------
    model : Model
    at : a motion or equilibrium whose last instant is the state; default: search the equilibrium
    parameters : new values of parameters, without rebuilding
    coordinates : in which small motions are described; ``JointCoordinates()`` about a steady motion
        in which cyclic coordinates change
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
            given = ", ".join([*(parameters or ()), *options])
            raise AnalysisError(f"linearize: {given} cannot be given with at=, which has its own")
        if at.analysis.at_rest:
            analysis = Linearization(float(at.time[0]), coordinates=coordinates)
            return modes_of(analysis, at_rest(at, coordinates))
        return modes_of(MotionLinearization(at, coordinates), last_instant(at, coordinates))
    made = analysis_of(
        Linearization, "linearize", model, parameters, coordinates=coordinates, **options
    )
    need_mechanism(model, "linearize", "take solve_modes")
    return made.run(model, parameters)
