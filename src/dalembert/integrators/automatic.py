"""Automatic switching between an explicit and an implicit integrator."""

from __future__ import annotations

from dalembert.integrators.base import Integrator, Problem
from dalembert.integrators.error_control import ErrorControlled
from dalembert.integrators.runge_kutta.explicit import DormandPrince
from dalembert.integrators.runge_kutta.implicit import Radau
from dalembert.options import options

STEP_SHARE = 1e-3
"""Tolerance of an explicit step relative to the tolerance of the run [-]."""
INTERVALS = 200
"""Minimum number of steps of a run without ``max_step`` [-]."""


@options
class AutomaticIntegrator(ErrorControlled):
    """Error control with Dormand–Prince 5(4) or, where the problem is stiff, Radau IIA of order 5.

    The run begins with the explicit method. When stability and not accuracy limits its steps,
    ``h ρ(∂F/∂x)`` is large in most of them (Hairer and Wanner 1996, IV.2). The run then switches
    to the implicit method and continues with it while it advances faster for the same cost; the
    explicit method is tried again at intervals. The idea is that of LSODA (Petzold 1983).
    Formulations without accelerations are integrated by the implicit method alone.

    Parameters
    ----------
    rtol : relative tolerance of the run [-]; explicit steps keep a thousandth of it, because errors
        of steps accumulate and the motion may amplify them. The estimate of implicit steps is
        pessimistic by more than that
    atol : absolute tolerance of the run [m, rad, m/s, rad/s]; by default a hundredth of rtol,
        at least 1e-10, times the natural sizes
    max_step : longest step [s]; a 200th of the run if None, so that forces, switches, contacts and
        events that act for a short time are not stepped over. Those much shorter than a step
        still need a ``max_step``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("hard buffer")
    >>> mass = system.add(planar.Particle("mass", mass=1.0, velocity=(1, 0)))
    >>> stiff = planar.Force("buffer", mass.center, (-1e6 * mass.x - 1e6 * mass.vx, 0))
    >>> force = system.add(stiff)
    >>> motion = da.solve_dynamics(system.build(), 1.0, integrator=da.AutomaticIntegrator())
    >>> motion.statistics["implicit steps"] > 0  # explicit steps would stay below 4 µs
    True
    """

    rtol: float = 1e-6

    @property
    def methods(self) -> tuple[Integrator, ...]:
        atol = None if self.atol is None else STEP_SHARE * self.atol
        explicit = DormandPrince(STEP_SHARE * self.rtol, atol, self.max_step)
        return explicit, Radau(rtol=self.rtol, atol=self.atol, max_step=self.max_step)

    @property
    def run_tolerance(self) -> float:
        return self.rtol

    @property
    def order(self) -> int:
        return min(method.order for method in self.methods)

    def longest_in(self, span: float) -> float:
        return self.max_step or span / INTERVALS

    def check(self, problem: Problem) -> None:
        explicit, implicit = self.methods
        (implicit if problem.rate is None else explicit).check(problem)
