"""Inverse dynamics: the efforts of the drivers and all reactions of a driven mechanism.

With the motion known from kinematics, ``Cᵀ λ = f − d − M v̇`` gives every multiplier (1.49).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, overload

from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.served import need_mechanism
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.batch import Batch
from dalembert.results.motion import Motion

if TYPE_CHECKING:
    from dalembert.results.designs import ManyDesigns


@options
class InverseDynamics(Kinematics):
    """Kinematic simulation followed by the forces it needs, as a strategy object."""

    spoken = "inverse dynamics"

    @property
    def efforts(self) -> bool:
        return True


@overload
def solve_inverse_dynamics(
    model: Model,
    duration: float | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Any,
) -> Motion: ...


@overload
def solve_inverse_dynamics(
    model: Model,
    duration: float | None = None,
    *,
    parameters: ManyDesigns,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Any,
) -> Batch: ...


def solve_inverse_dynamics(
    model: Model,
    duration: float | None = None,
    *,
    parameters: Any = None,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Any,
) -> Motion | Batch:
    """Motion, driver efforts and reactions of a fully driven mechanism, ``Cᵀλ = f − d − M v̇``.

    Parameters
    ----------
    model : fully driven Model with masses
    duration : [s]
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    progress : True for a bar, or a function of the fraction done
    workers : of a batch; by default one for each core
    **options : fields of ``InverseDynamics``: step, outputs, t_span

    Raises
    ------
    AnalysisError
        Not fully driven, a singular start, or wrong options; ``AssemblyError`` where the mechanism
        cannot be put together.
    """
    made = InverseDynamics.of("solve_inverse_dynamics", duration=duration, **options)
    need_mechanism(model, "solve_inverse_dynamics", "take solve_transient")
    return run_analysis(made, model, parameters, progress, workers)  # type: ignore[no-any-return]
