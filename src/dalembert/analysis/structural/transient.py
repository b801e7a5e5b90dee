"""Transient analysis of structures: ``M a + C v + ∂W/∂u(u) = P(t)`` step by step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Unpack

import numpy as np

from dalembert.analysis.keywords import TransientKeywords
from dalembert.analysis.kinematics.branches import place_outputs
from dalembert.analysis.progress import Reported
from dalembert.analysis.requirements import need_structure
from dalembert.analysis.structural.transient_equation import Rayleigh
from dalembert.analysis.structural.transient_run import TransientRun, motion_at
from dalembert.analysis.structural.transient_start import STARTS
from dalembert.analysis.times import Time, analysis_of, evaluate_times
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.newmark.family import Newmark, NewmarkFamily
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import options
from dalembert.results.analysis import Analysis, ParameterValues
from dalembert.results.structural.motion import StructuralMotion
from dalembert.text.arguments import check_arguments


@options(eq=False)
class Transient(Analysis[StructuralModel, StructuralMotion]):
    """Motion of a structure under loads and support motions that may depend on time.

    Parameters
    ----------
    duration : length of the run from t = 0 [s]
    step : step length, by default a thousandth of the run [s]
    outputs : number of equally spaced times, or the times [s]; default every step
    integrator : ``Newmark()`` (average acceleration), ``HHT()`` or ``GeneralizedAlpha()``
    nonlinear : for large displacements
    lumped : diagonal mass matrix instead of the consistent one
    damping : Rayleigh
    case : name of the load case; optional if there is only one
    start : ``"rest"``, from the initial motion of ``structure.initial``; ``"statics"``, from
        equilibrium under the loads at t = 0

    Raises
    ------
    AnalysisError, UnsupportedError
        Another choice.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("oscillator")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=100.0))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=1.0))
    >>> bar.support(a)
    >>> bar.initial(b, vx=2.0)
    >>> analysis = da.Transient(duration=0.5, step=1e-3, integrator=da.Newmark())
    >>> motion = analysis.run(bar.build())
    >>> round(da.evaluate(motion, da.maximum("b.ux")), 4)  # v/ω
    0.2
    """

    display_name = "transient"

    duration: float | None = None
    step: float | None = None
    outputs: int | Sequence[float] | None = None
    integrator: NewmarkFamily = field(default_factory=Newmark)
    nonlinear: bool = False
    lumped: bool = False
    damping: Rayleigh = field(default_factory=Rayleigh)
    case: str = ""
    start: str = "rest"

    def __post_init__(self) -> None:
        if not isinstance(self.integrator, NewmarkFamily):
            raise UnsupportedError(
                f"integrator is {self.integrator!r}; transients of structures accept Newmark(), "
                "HHT() or GeneralizedAlpha()"
            )
        if not isinstance(self.damping, Rayleigh):
            raise AnalysisError(f"damping is {self.damping!r}; give Rayleigh(mass=, stiffness=)")
        if self.start not in STARTS:
            known = " or ".join(map(repr, STARTS))
            raise AnalysisError(f"start is {self.start!r}; it must be {known}")

    def case_of(self, model: StructuralModel) -> str:
        """Name of the load case that acts.

        Raises
        ------
        AnalysisError
            No load case of this name.
        """
        if self.case in model.loads:
            return self.case
        if not self.case and len(model.loads) == 1:
            return next(iter(model.loads))
        known = ", ".join(map(repr, model.loads))
        raise AnalysisError(f"no load case {self.case!r}; give case= one of {known}")

    def run(
        self,
        model: StructuralModel,
        parameters: ParameterValues = None,
        progress: Reported = False,
    ) -> StructuralMotion:
        """Integrate; a failed run keeps its steps, and its status names the reason.

        Raises
        ------
        AnalysisError
            Wrong step, duration or outputs.
        SingularityError
            The run cannot begin.
        """
        if "t" in model.parameters:
            raise AnalysisError(
                f"{model.name}: 't' is a parameter, but the time in transient analyses; rename the "
                "parameter"
            )
        p = model.values(parameters)
        return TransientRun(evaluate_times(self, model, p), model, p).execute(progress)

    def resample(self, motion: StructuralMotion, times: np.ndarray) -> StructuralMotion:
        """The motion at other times within the run.

        Between the ends of two steps it is computed by a shorter step from the first one, a smooth
        function of the parameters.

        Raises
        ------
        AnalysisError
            A time outside the run.
        """
        record = motion.record
        branches = place_outputs(record.steps, times)
        return motion_at(record.march, self, times, branches, motion.status, motion.statistics)

    def replay(self, motion: StructuralMotion, p: np.ndarray) -> StructuralMotion:
        """The same steps and outputs at other parameter values."""
        return TransientRun(self, motion.model, p).execute(False).at(motion.time)


@check_arguments
def solve_transient(
    model: StructuralModel,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: Reported = False,
    **options: Unpack[TransientKeywords],
) -> StructuralMotion:
    """Motion of a structure, ``M a + C v + ∂W/∂u(u) = P(t)``, with its exact gradients.

    Parameters
    ----------
    model : StructuralModel
    duration : [s]
    parameters : new values of parameters, without rebuilding
    progress : True for a bar, or a function of the fraction done
    **options : fields of ``Transient``: step, outputs, integrator, nonlinear, lumped, damping, …

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
    analysis = analysis_of(
        Transient, "solve_transient", model, parameters, duration=duration, **options
    )
    need_structure(model, "solve_transient", "use solve_dynamics")
    return analysis.run(model, parameters, progress)
