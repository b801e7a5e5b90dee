"""``solve_dynamics`` of mechanisms and structures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack, overload

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.keywords import DynamicsKeywords, TransientKeywords
from dalembert.analysis.requirements import need_model
from dalembert.analysis.structural.transient import Transient
from dalembert.analysis.times import Time, analysis_of
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.motion import Motion
from dalembert.results.structural.motion import StructuralMotion
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns


@overload
def solve_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Unpack[DynamicsKeywords],
) -> Motion: ...


@overload
def solve_dynamics(
    model: StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Unpack[TransientKeywords],
) -> StructuralMotion: ...


@overload
def solve_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: ManyDesigns,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[DynamicsKeywords],
) -> Batch: ...


@overload
def solve_dynamics(
    model: StructuralModel,
    duration: Time | None = None,
    *,
    parameters: ManyDesigns,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[TransientKeywords],
) -> Batch: ...


@check_arguments
def solve_dynamics(
    model: Model | StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Any = None,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Any,
) -> Motion | StructuralMotion | Batch:
    """Integrate the equations of motion, ``M v̇ + d = f − Cᵀλ``, ``C v̇ = ξ`` (5.2).

    A structure is solved as by ``solve_transient``, with the same options.

    Parameters
    ----------
    model : Model or StructuralModel
    duration : [s]
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    progress : True for a progress bar, or a function of the completed fraction
    workers : number of workers of a batch, by default one for each core
    **options : fields of ``Dynamics``: step, outputs, formulation, stabilization, integrator, …

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError``, ``SingularityError`` where the run cannot begin.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("fall", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0))
    >>> motion = da.solve_dynamics(system.build(), "2 s", step="10 ms")
    >>> round(float(motion["stone.y"][-1]), 9)
    -20.0
    """
    if isinstance(model, StructuralModel):
        analysis: Any = analysis_of(
            Transient, "solve_dynamics", model, parameters, duration=duration, **options
        )
    else:
        analysis = analysis_of(
            Dynamics, "solve_dynamics", model, parameters, duration=duration, **options
        )
    need_model(model, "solve_dynamics")
    return run_analysis(analysis, model, parameters, progress, workers)  # type: ignore[no-any-return]
