"""``solve_dynamics`` and ``solve_transient``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.keywords import DynamicsKeywords
from dalembert.analysis.progress import Reported
from dalembert.analysis.times import Time, analysis_of
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.motion import Motion
from dalembert.results.structural.motion import StructuralMotion
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns

Controller = Callable[[float, dict[str, float]], Any]
"""``(t, outputs) → inputs`` by name, or numbers in the order of ``model.inputs``."""


@overload
def solve_dynamics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: Reported = False,
    controller: Controller | None = None,
    sample_time: Time | None = None,
    **options: Unpack[DynamicsKeywords],
) -> Motion: ...


@overload
def solve_dynamics(
    model: StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: Reported = False,
    **options: Unpack[DynamicsKeywords],
) -> StructuralMotion: ...


@overload
def solve_dynamics(
    model: Model | StructuralModel,
    duration: Time | None = None,
    *,
    parameters: ManyDesigns,
    progress: Reported = False,
    workers: int | None = None,
    **options: Unpack[DynamicsKeywords],
) -> Batch: ...


@check_arguments
def solve_dynamics(
    model: Model | StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Any = None,
    progress: Reported = False,
    workers: int | None = None,
    controller: Controller | None = None,
    sample_time: Time | None = None,
    **options: Unpack[DynamicsKeywords],
) -> Motion | StructuralMotion | Batch:
    """Integrate the equations of motion, ``M v̇ + d = f − Cᵀλ``, ``C v̇ = ξ`` (5.2).

    Those of a structure are ``M a + C v + ∂W/∂u(u) = P(t)``.

    Parameters
    ----------
    model : Model or StructuralModel
    duration : [s]
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    progress : True for a progress bar, or a function of the completed fraction
    workers : number of workers of a batch, by default one for each core
    controller : Python function ``(t, outputs) → inputs`` of the model by name, called once per
        sample; between samples the inputs are constant. Such a run has no gradients
    sample_time : of the controller [s]
    **options : fields of ``Dynamics``: step, outputs, integrator; formulation, … of a mechanism;
        nonlinear, damping, … of a structure

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
    if controller is not None:
        return _controlled(model, parameters, progress, controller, sample_time, duration, options)
    if sample_time is not None:
        raise AnalysisError("sample_time belongs to a controller; give controller=, too")
    return _solve("solve_dynamics", model, parameters, progress, workers, duration, options)  # type: ignore[no-any-return]


@check_arguments
def solve_transient(
    model: StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: Reported = False,
    **options: Unpack[DynamicsKeywords],
) -> StructuralMotion:
    """Motion of a structure, ``M a + C v + ∂W/∂u(u) = P(t)``; the same as ``solve_dynamics``.

    Parameters
    ----------
    model : StructuralModel
    duration : [s]
    parameters : new values of parameters, without rebuilding
    progress : True for a progress bar, or a function of the completed fraction
    **options : fields of ``Dynamics``: step, outputs, integrator, nonlinear, lumped, damping, …

    Raises
    ------
    AnalysisError
        Wrong options; ``SingularityError`` where the run cannot begin.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("oscillator")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=100.0))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=1.0))
    >>> bar.support(a)
    >>> bar.load(b, fx=5.0)  # all at once
    >>> motion = da.solve_transient(bar.build(), math.pi / 10, step=math.pi / 1000)
    >>> round(float(motion["b.ux"][-1]), 4)  # twice F/k after half a period
    0.1
    """
    return _solve("solve_transient", model, parameters, progress, None, duration, options)  # type: ignore[no-any-return]


def _controlled(
    model: Any,
    parameters: Any,
    progress: Reported,
    controller: Controller,
    sample_time: Any,
    duration: Any,
    options: Any,
) -> Motion:
    """Dynamics with inputs by a Python function."""
    from dalembert.model.graph.controlled import ControlledModel

    if sample_time is None:
        raise AnalysisError("a controller needs its sample_time; give sample_time=, in seconds")
    if model.kind != "mechanism":
        raise UnsupportedError("a structure has no controllers; a controller needs a mechanism")
    if not (
        parameters is None
        or (isinstance(parameters, Mapping) and all(map(_single, parameters.values())))
    ):
        raise UnsupportedError("a controller runs one design; use Stepper.lanes for many")
    plant = ControlledModel(model, controller, sample_time)
    motion = _solve("solve_dynamics", plant, parameters, progress, None, duration, options)
    if plant.block.python_law.error is not None:
        raise plant.block.python_law.error
    return motion  # type: ignore[no-any-return]


def _single(value: Any) -> bool:
    return isinstance(value, str) or np.ndim(value) == 0


def _solve(
    verb: str,
    model: Any,
    parameters: Any,
    progress: Reported,
    workers: int | None,
    duration: Any,
    options: Any,
) -> Any:
    """Dynamics of a model, from the arguments of a function."""
    analysis = analysis_of(Dynamics, verb, model, parameters, duration=duration, **options)
    return run_analysis(analysis, model, parameters, progress, workers)
