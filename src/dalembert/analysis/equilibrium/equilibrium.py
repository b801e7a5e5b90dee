"""Static equilibrium: balance of applied forces, internal forces and reactions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.equilibrium_batch import EquilibriumBatch
from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.equilibrium.mechanism_equilibrium import mechanism_equilibrium
from dalembert.analysis.equilibrium.structure_equilibrium import structure_equilibrium
from dalembert.analysis.keywords import EquilibriumKeywords
from dalembert.analysis.requirements import need_positive
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.options import only_for, options
from dalembert.results.analysis import Analysis, ParameterValues
from dalembert.results.batch.batch import Batch
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row
from dalembert.results.structural.result import StructuralResult
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns


@options
class Equilibrium(Analysis[Any, Any]):
    """Static equilibrium at displacements of any size, as a strategy object.

    A mechanism is in equilibrium near its assembled position, a structure under each of its load
    cases: loads and prescribed displacements grow together from rest, and a load step in which
    Newton's method fails is halved.

    Parameters
    ----------
    time : instant at which laws and forces of a mechanism are evaluated [s]
    tolerance : tolerance of the residual, relative to the largest force
    max_iterations : upper limit of Newton iterations, in each load step of a structure; by default
        200 for a mechanism, 25 for a structure
    steps : number of load steps of a structure

    Raises
    ------
    UnsupportedError
        A number that is not positive.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> weight = system.parameter("weight", 2.0, unit="kg", bounds=(1, 5))
    >>> pan = system.add(planar.Particle("pan", mass=weight, position=(0, -0.1)))
    >>> spring = planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0)
    >>> hung = system.add(spring)
    >>> analysis = da.Equilibrium()  # an analysis that can be repeated and optimised
    >>> model = system.build()
    >>> [round(analysis.run(model, {"weight": m})["pan.y"].item(), 6) for m in (2, 4)]  # -m g/k
    [-0.2, -0.4]
    >>> arch = da.Structure("arch")  # stiffens as it rises
    >>> left, top = arch.node("left", -1, 0), arch.node("top", 0, 0.1)
    >>> bar = arch.add(da.structures.Truss("bar", left, top, area=1e-4, modulus=1e7))
    >>> arch.support(left)
    >>> arch.support(top, ux=0)
    >>> arch.load(top, fy=1.0)
    >>> risen, linear = (kind.run(arch.build()) for kind in (analysis, da.Statics()))
    >>> risen["top.uy"] < linear["top.uy"]
    True
    """

    display_name = "static equilibrium"
    at_rest = True
    batched = EquilibriumBatch

    time: float = only_for("mechanism", default=0.0)
    tolerance: float = 1e-10
    max_iterations: int | None = None
    steps: int = only_for("structure", default=10)

    def __post_init__(self) -> None:
        counts = ("steps", "max_iterations") if self.max_iterations is not None else ("steps",)
        need_positive(self, ("tolerance",), counts)

    def run(
        self,
        model: Model | StructuralModel,
        parameters: ParameterValues = None,
        progress: Any = False,
        start: np.ndarray | None = None,
    ) -> Any:
        """Compute the equilibrium; ``statistics`` contains its stability.

        The result of a mechanism is a motion with one instant, near the assembled position or near
        the pose ``start``.

        Raises
        ------
        AssemblyError, SingularityError
            The mechanism cannot be assembled; the structure moves without strain.
        """
        self.for_model(model)
        p = model.values(parameters)
        if isinstance(model, StructuralModel):
            return structure_equilibrium(self, model, p, progress)
        return mechanism_equilibrium(self, model, p, start)

    def live_obstacle(self, result: Any) -> str:
        from dalembert.analysis.live.equilibrium_module import obstacle

        return obstacle(result) if isinstance(result, Motion) else super().live_obstacle(result)

    def live_functions(self, result: Any, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
        from dalembert.analysis.live.equilibrium_module import equilibrium_functions

        return equilibrium_functions(result, rows, times)

    def replay(self, result: Any, p: np.ndarray) -> Any:
        """The equilibrium at other parameter values; of a mechanism, starting from this one."""
        start = result.trajectory.y[:, 0] if isinstance(result, Motion) else None
        return self.run(result.model, p, start=start)

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The same, at the instant of the equilibrium.

        Raises
        ------
        AnalysisError
            Any other time.
        """
        if np.any(times != self.time):
            raise AnalysisError(
                f"an equilibrium has one instant, t = {self.time:g} s, and t = {times[0]:g} s was "
                "requested; use the final value"
            )
        return motion


@overload
def solve_equilibrium(
    model: Model,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> Motion: ...


@overload
def solve_equilibrium(
    model: StructuralModel,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> StructuralResult: ...


@overload
def solve_equilibrium(
    model: Model | StructuralModel,
    *,
    parameters: ManyDesigns,
    workers: int | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> Batch: ...


@check_arguments
def solve_equilibrium(
    model: Model | StructuralModel,
    *,
    parameters: Any = None,
    workers: int | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> Motion | StructuralResult | Batch:
    """Static equilibrium at displacements of any size, ``f − d − Cᵀλ = 0`` at rest.

    A mechanism is solved near its assembled position, a structure under each of its load cases.

    Parameters
    ----------
    model : Model or StructuralModel
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    workers : number of workers of a batch, by default one for each core
    **options : fields of ``Equilibrium``: time, tolerance, max_iterations, steps

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError`` where the mechanism cannot be assembled. A search that
        does not converge reports it in its status.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lamp in the wind", gravity=(0, -10))
    >>> lamp = system.add(planar.Particle("lamp", mass=2.0, position=(0.1, -1)))
    >>> cord = system.add(planar.RigidLink("cord", system.ground.center, lamp.center, length=1.0))
    >>> wind = system.add(planar.Force("wind", lamp.center, (15.0, 0)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> rest["lamp.position"][0].values.round(6)  # along (F, -m g), a 3-4-5 triangle
    array([ 0.6, -0.8])
    """
    analysis = analysis_of(Equilibrium, "solve_equilibrium", model, parameters, **options)
    return run_analysis(analysis, model, parameters, workers=workers)  # type: ignore[no-any-return]
