"""Modes of small motions about a state: frequencies, damping ratios, shapes.

A mechanism is a first-order system ``ẋ = F(x)`` with accelerations from (5.7), linearised on the
tangent space of ``Φ = 0, Ψ = 0``: with a basis ``T`` of it that moves along the motion,
``A = T⁺ ((∂F/∂x) T − Ṫ)``. At rest this gives the usual modes of ``(ZᵀMZ, ZᵀDZ, ZᵀKZ)``; in a
steady motion the eigenvalues are those of whirl and nutation. A structure without
damping has ``K φ = ω² M φ``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.modes.linearization_kernel import linearization_kernel
from dalembert.analysis.modes.linearized import Linearized
from dalembert.analysis.modes.spectral import SpectralAnalysis
from dalembert.analysis.modes.vibration import vibration
from dalembert.analysis.requirements import need_count
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.graph.model import Model
from dalembert.options import only_for, options
from dalembert.results.analysis import ParameterValues
from dalembert.results.live import LiveFunctions
from dalembert.results.mechanism_modes import MechanismModes
from dalembert.results.modes import Modes
from dalembert.results.motion import Motion
from dalembert.results.result import Result
from dalembert.results.sources import Row
from dalembert.results.structural.modes import VibrationModes
from dalembert.results.structural.result import StructuralResult

if TYPE_CHECKING:
    from dalembert.results.state_space import StateSpace

ABSOLUTE = AbsoluteCoordinates()
"""Default coordinates."""


@options
class Modal(SpectralAnalysis[Any, Modes]):
    """Modes of small motions as a strategy object.

    Without ``about``, a mechanism moves about its static equilibrium, a structure about its
    unloaded configuration.

    Parameters
    ----------
    count : number of modes, by default all of a mechanism and six of a structure
    about : state about which the motions are small. Of a mechanism, an equilibrium, or a motion
        whose last instant counts. Of a structure, statics with one load case (``result.at([0])``
        selects it), with the tangent stiffness at large displacements, and ``K + K_g`` at small
        ones
    time : instant at which laws and forces of a mechanism are evaluated [s]
    equilibrium : about the static equilibrium of a mechanism; otherwise about its assembled state
    coordinates : coordinates of small motions of a mechanism. Eigenvalues are those of a steady
        motion if its linear system does not change along the motion: that of symmetric rotors and
        rolling wheels in any coordinates; that of a spinning governor, of which only cyclic
        coordinates change, in ``JointCoordinates()``
    lumped : lumped instead of consistent mass matrix of a structure
    shift : ``σ``: modes of a structure nearest to ``ω² = σ`` [rad²/s²]; negative for unsupported
        structures

    Raises
    ------
    UnsupportedError
        A count that is not positive; ``about`` with several load cases, or of another analysis.
    AnalysisError
        ``time`` or ``equilibrium`` together with ``about``.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("bar")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> k = bar.parameter("k", 100.0, unit="N/m")
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=k))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=4.0))
    >>> bar.support(a)
    >>> modes = da.Modal(count=1).run(bar.build(), {"k": 400.0})
    >>> round(float(modes.frequencies[0]) * 2 * math.pi, 6)  # √(k/m)
    10.0
    """

    display_name = "modes"

    count: int | None = None
    about: Annotated[Result | None, StructuralResult | None] = None
    time: float = only_for("mechanism", default=0.0)
    equilibrium: bool = only_for("mechanism", default=True)
    coordinates: Coordinates = only_for("mechanism", default=ABSOLUTE)
    lumped: bool = only_for("structure", default=False)
    shift: float = only_for("structure", default=0.0)

    def __post_init__(self) -> None:
        need_count(self)
        about: Any = self.about
        if about is None:
            return
        if not hasattr(about, "model"):
            raise AnalysisError(
                f"Modal: about is {about!r}; give a motion of a mechanism or a result of statics"
            )
        if name := "time" if self.time else "" if self.equilibrium else "equilibrium":
            raise AnalysisError(f"Modal: {name} cannot be given with about=, which has its own")
        if about.model.kind == "structure" and not about.analysis.at_rest:
            kind = type(about.analysis).__name__
            raise UnsupportedError(f"Modal: about is of {kind}; use a result of solve_statics")
        if about.model.kind == "structure" and len(about.cases) != 1:
            raise UnsupportedError(
                f"Modal: about has the load cases {', '.join(map(repr, about.cases))}; "
                "select one with about=result.at([number])"
            )

    @staticmethod
    def modes_class(model: Any) -> type[Modes]:
        return VibrationModes if isinstance(model, StructuralModel) else MechanismModes

    def run(
        self,
        model: Model | StructuralModel,
        parameters: ParameterValues = None,
        progress: Any = False,
    ) -> Modes:
        """Modes at parameter values, by default those of ``about``.

        Raises
        ------
        SingularityError
            A free motion has no mass; a part of a structure moves freely and the shift is zero.
        AnalysisError
            No equilibrium was found, no element has mass; ``about`` is of another model, or failed.
        """
        about: Any = self.about
        if about is not None:
            if _source(about.model) is not _source(model):
                raise AnalysisError(f"about is a result of {about.model.name}, not of this model")
            parameters = about.parameters if parameters is None else parameters
        return super().run(model, parameters, progress)

    def spectrum(self, model: Any, p: np.ndarray, near: np.ndarray | None = None) -> Any:
        """Linearised system of a mechanism, or eigenpairs of a structure."""
        about = self._about(p)
        if isinstance(model, StructuralModel):
            return vibration(self, model, p, about)
        return linearized(self, model, p, about, near)

    def live_obstacle(self, result: Modes) -> str:
        from dalembert.analysis.live.modes_module import obstacle
        from dalembert.analysis.live.structure_module import vibration_obstacle

        if isinstance(result, VibrationModes):
            return vibration_obstacle(result)
        assert isinstance(result, MechanismModes)
        return obstacle(result)

    def live_functions(
        self, result: Modes, rows: Sequence[Row], times: np.ndarray
    ) -> LiveFunctions:
        from dalembert.analysis.live.modes_module import modes_functions
        from dalembert.analysis.live.structure_module import vibration_functions

        if isinstance(result, VibrationModes):
            return vibration_functions(result, rows, times)
        assert isinstance(result, MechanismModes)
        return modes_functions(result, rows, times)

    def state_space(
        self, result: Modes, inputs: Any, outputs: Any, damping: Any, damping_ratio: float
    ) -> StateSpace:
        """State-space model of the linear system of a result."""
        from dalembert.analysis.frequency.state_space import state_space

        return state_space(result, inputs, outputs, damping, damping_ratio)

    def again(self, result: Modes, p: np.ndarray) -> Any:
        at_equilibrium = isinstance(result.model, Model) and self.equilibrium and not self.about
        count = result.model.equations.coordinate_count if at_equilibrium else 0
        return self.spectrum(result.model, p, result.record.near[:count] if count else None)

    def _about(self, p: np.ndarray) -> Any:
        """The state about which motions are small, at parameter values."""
        about: Any = self.about
        if about is not None and not np.array_equal(p, about.parameters):
            cases = getattr(about, "cases", None)
            about = about.analysis.replay(about, p)
            about = about if cases is None else about.at([about.case(cases[0])])
        if isinstance(about, StructuralResult) and not about.status.success:
            raise AnalysisError(f"about is no equilibrium: {about.status}", about.status.residual)
        return about


def _source(model: Any) -> Any:
    """The description of a structure, whose variants for small displacements share it; the model
    of a mechanism."""
    return getattr(model, "structure", model)


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
    start = kernel.assembled, state.y, state.residual
    return Linearized(kernel, analysis.time, x, p, *start).steadiest


def _at_rest(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about an equilibrium."""
    status, s = motion.status, motion.trajectory
    kernel = linearization_kernel(motion.model, coordinates)
    if not status.success:
        raise AnalysisError(f"no equilibrium, {status}", status.residual)
    time, near = float(s.t[0]), motion.record.kernel.near(s)[:, 0]
    x = kernel.state(time, s.y[:, 0], s.v[:, 0], motion.parameters)
    stable, p = bool(motion.statistics.get("stable", True)), motion.parameters
    return Linearized(kernel, time, x, p, kernel.resting, near, status.residual, stable)


def _last_instant(motion: Motion, coordinates: Coordinates) -> Linearized:
    """Linearised system about the end of a motion, without dependence on the parameters."""
    s, kernel = motion.trajectory, linearization_kernel(motion.model, coordinates)
    x = kernel.state(float(s.t[-1]), s.y[:, -1], s.v[:, -1], motion.parameters)
    return Linearized(kernel, float(s.t[-1]), x, motion.parameters).steadiest
