"""Nonsmooth contact dynamics: contacts by time stepping with fixed steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from typing import Unpack

import numpy as np

from dalembert.analysis.dynamics.residual_check import check_balance
from dalembert.analysis.keywords import NonsmoothKeywords
from dalembert.analysis.kinematics.kinematics import refuse_outside
from dalembert.analysis.nonsmooth.between_steps import interpolate
from dalembert.analysis.nonsmooth.contact_forces import contact_forces
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.analysis.nonsmooth.free_bodies.sleeping_bodies import SleepRule
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.analysis.timeline import OverTime
from dalembert.analysis.times import Time, analysis_of
from dalembert.errors import AnalysisError
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import AnticipatedImpacts, ContactScheme
from dalembert.model.graph.model import Model
from dalembert.options import options
from dalembert.results.contact_forces import ContactForces
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.text.arguments import check_arguments


@options
class Nonsmooth(OverTime[NonsmoothMotion]):
    """Dynamics with contacts as a strategy object.

    Impacts are not located: all contacts of a step are solved together as impulses. The motion is
    of first order in the step, and so are gradients; both of second order with force laws alone.

    Parameters
    ----------
    integrator : ``AnticipatedImpacts()`` or ``MoreauJean()``
    solver : solver of the impulses
    balance : largest error of the energy balance, relative to the exchanged energy, with which a
        run still counts as completed
    separate_impacts : whether steps are divided where impacts on connected bodies follow each other
        within one step, which would otherwise count as one
    sleep_after : time at rest after which free bodies that press on each other take no part in the
        steps, until another body presses on them or their forces change [s]; None: never. No
        gradients
    sleep_speed : upper limit of the speeds of bodies at rest [m/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("landing", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> contact = planar.contact
    >>> shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    >>> hits = system.add(planar.Collisions("hits", shapes))
    >>> analysis = da.Nonsmooth(duration=0.4, step=0.01, integrator=da.MoreauJean())
    >>> motion = analysis.run(system.build())
    >>> round(motion["ball.y"][-1].item(), 6)  # it lies on its radius
    0.1
    """

    display_name = "dynamics with contacts"
    kinds = ("mechanism",)
    instead = "use solve_dynamics"
    integrates = True
    executions = {"mechanism": NonsmoothRun}

    integrator: ContactScheme = field(default_factory=AnticipatedImpacts)
    solver: ContactSolver = field(default_factory=ContactSolver)
    balance: float = 0.25
    separate_impacts: bool = False
    sleep_after: float | None = None
    sleep_speed: float = 1e-3

    def __post_init__(self) -> None:
        if not isinstance(self.integrator, ContactScheme):
            raise AnalysisError(
                f"integrator is {self.integrator!r}; give AnticipatedImpacts() or MoreauJean()"
            )
        if not isinstance(self.solver, ContactSolver):
            raise AnalysisError(f"solver is {self.solver!r}; give ContactSolver()")
        check_balance(self.balance)
        check_sleep(self)

    def checks(self, model: Model) -> dict[str, Callable[[], object]]:
        """Checks of the options, of the shapes at the start, and whether bodies can sleep."""

        def start() -> None:
            if model.kind in self.kinds:
                run = NonsmoothRun(self, model, None)
                run.state_at_start()
                if self.sleep_after is not None:
                    FreeBodyMarch.of(run.step, SleepRule.of(self))

        return {**super().checks(model), "": start}

    def resample(self, motion: NonsmoothMotion, times: np.ndarray) -> NonsmoothMotion:
        """The motion at other times within the run, linear within steps.

        Raises
        ------
        AnalysisError
            A time outside the run.
        """
        refuse_outside(times, motion.record.t)
        return replace(motion, trajectory=interpolate(motion.model, motion.record, times))

    def contact_forces(self, motion: NonsmoothMotion, row: int) -> ContactForces:
        """Positions and mean forces of the contacts of the step at an output."""
        return contact_forces(motion, row)


def check_sleep(analysis: Nonsmooth) -> None:
    """Raise unless the options of sleeping bodies are positive and their steps allow it."""
    for name in ("sleep_after", "sleep_speed"):
        value = getattr(analysis, name)
        if value is not None and not value > 0:
            raise AnalysisError(f"{name} is {value!r}; give a positive number")
    if analysis.sleep_after is not None and analysis.separate_impacts:
        raise AnalysisError("sleep_after and separate_impacts exclude each other; leave out one")


@check_arguments
def solve_nonsmooth(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Unpack[NonsmoothKeywords],
) -> NonsmoothMotion:
    """Integrate ``M dv = (f − d) dt − Cᵀ dΛ + Wᵀ dP``, ``0 ≤ g ⟂ dP_N ≥ 0``.

    Impacts follow Newton's, Poisson's or the energetic law, and friction follows Coulomb's law, in
    fixed steps. Contacts with a force law have ``dP_N = N(−g, −ġ) dt`` instead.

    Parameters
    ----------
    model : Model with ``Collisions``, or other elements with gaps of rigid contacts
    duration : [s]
    parameters : new values of parameters, without rebuilding
    progress : True for a bar, or a function of the fraction done
    **options : fields of ``Nonsmooth``: step, outputs, integrator, solver, t_span

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError``, ``SingularityError`` where the run cannot begin.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pile", gravity=(0, -10))
    >>> low = system.add(planar.Particle("low", mass=1.0, position=(0, 0.1)))
    >>> high = system.add(planar.Particle("high", mass=2.0, position=(0, 0.31)))
    >>> balls = [planar.contact.Circle(ball.center, 0.1) for ball in (low, high)]
    >>> floor = planar.contact.HalfPlane(system.ground.center)
    >>> pile = system.add(planar.Collisions("pile", [*balls, floor]))
    >>> motion = da.solve_nonsmooth(system.build(), 0.5, step=0.01)
    >>> round(motion["high.y"][-1].item(), 4)  # on top of the other
    0.3
    """
    return analysis_of(
        Nonsmooth, "solve_nonsmooth", model, parameters, duration=duration, **options
    ).run(model, parameters, progress)
