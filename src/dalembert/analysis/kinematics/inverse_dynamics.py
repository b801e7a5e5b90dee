"""Inverse dynamics: driver efforts and reactions of a driven mechanism.

With the motion from kinematics, ``Cᵀ λ = f − d − M v̇`` gives every multiplier (1.49). States of
first order, ``ẋ = f(t, y, v, x)``, are integrated along this motion from their start, as they
depend on the past: the run is then one of forward dynamics, in which the drivers prescribe the
motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack, overload

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.keywords import OverTimeKeywords
from dalembert.analysis.kinematics.kernel import kinematics_kernel
from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.analysis.timeline import run_times, uniform_grid
from dalembert.analysis.times import Time, analysis_of
from dalembert.formulations.kkt import KKT
from dalembert.model.graph.coordinates import DrivenCoordinates
from dalembert.model.graph.model import Model
from dalembert.options import options
from dalembert.results.batch.batch import Batch
from dalembert.results.motion import Motion
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns


@options
class InverseDynamics(Kinematics):
    """Kinematic simulation with driver efforts and reactions as a strategy object.

    A model with states of first order is run by ``Dynamics`` with the default integrator, which
    controls their error; the outputs are the same, and gradients include the states. Rigid contacts
    are ignored, with a warning where bodies would overlap.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lift", gravity=(0, -10))
    >>> cabin = system.add(planar.Particle("cabin", mass=500.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cabin.center, axis=(0, 1)))
    >>> drive = planar.CoordinateDriver("drive", cabin.center, 0.5 * da.t**2, direction=(0, 1))
    >>> winch = system.add(drive)
    >>> analysis = da.InverseDynamics(duration=1.0, step=0.5)
    >>> round(da.evaluate(analysis.run(system.build()), da.maximum("drive.effort")), 6)  # m (g + a)
    5500.0
    """

    display_name = "inverse dynamics"
    instead = "use solve_transient"

    @property
    def efforts(self) -> bool:
        return True

    def for_model(self, model: Model) -> Any:
        """The analysis as run for a model: forward dynamics if it has states of first order.

        Raises
        ------
        AnalysisError
            Not a mechanism, or with states not fully driven.
        """
        super().for_model(model)
        if not model.equations.states:
            return self
        kinematics_kernel(model)  # refuses models that are not fully driven
        return Dynamics(
            duration=self.duration,
            t_span=self.t_span,
            outputs=self._outputs(),
            coordinates=DrivenCoordinates(),
            formulation=KKT(),
        )

    def _outputs(self) -> Any:
        """Outputs as given, by default every step."""
        start, end, step, requested = run_times(self)
        if requested is not None:
            return self.outputs
        last = self.duration if self.t_span is None else self.t_span[1]  # may follow parameters
        return [*uniform_grid(start, end, step)[:-1].tolist(), last]


@overload
def solve_inverse_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Unpack[OverTimeKeywords],
) -> Motion: ...


@overload
def solve_inverse_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: ManyDesigns,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[OverTimeKeywords],
) -> Batch: ...


@check_arguments
def solve_inverse_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Any = None,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[OverTimeKeywords],
) -> Motion | Batch:
    """Motion, driver efforts and reactions of a fully driven mechanism, ``Cᵀλ = f − d − M v̇``.

    States of first order are integrated along the motion.

    Parameters
    ----------
    model : fully driven Model with masses
    duration : [s]
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    progress : True for a progress bar, or a function of the completed fraction
    workers : number of workers of a batch, by default one for each core
    **options : fields of ``InverseDynamics``: step, outputs, t_span

    Raises
    ------
    AnalysisError
        Not fully driven, a singular start, or wrong options; ``AssemblyError`` where the mechanism
        cannot be assembled.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("arm", gravity=(0, -10))
    >>> arm = system.add(planar.Bar("arm", length=1.0, mass=3.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, arm.start))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, arm, da.t))
    >>> motion = da.solve_inverse_dynamics(system.build(), "pi/2", step="pi/4")
    >>> motion["motor.effort"].values.round(6) + 0.0  # m g l/2 cos t
    array([15.      , 10.606602,  0.      ])
    """
    analysis = analysis_of(
        InverseDynamics, "solve_inverse_dynamics", model, parameters, duration=duration, **options
    )
    return run_analysis(analysis, model, parameters, progress, workers)  # type: ignore[no-any-return]
