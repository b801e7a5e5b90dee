"""Multiple shooting (Bock and Plitt 1984) with the steps of an integrator between knots."""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.transcription import Block, Points, Rows, Transcription
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.formulations.base import WORK, Formulation
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection, Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.runge_kutta.explicit import RK4
from dalembert.model.graph.scheduled import SteeredModel
from dalembert.options import options


@options
class MultipleShooting(TrajectoryMethod):
    """Steps of an integrator from knot to knot; the plan equals the forward run by the same steps.

    Parameters
    ----------
    steps : number of steps in each interval, even; eight or more for integrators of order two or
        less, which otherwise sample the parabolas of a control differently from the objective
    formulation, stabilization, integrator : as in ``Dynamics``; the integrator has fixed steps

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-4, 4))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> task = dict(controls=["push"], duration=(0.5, 3), end={"cart.x": 1, "cart.vx": 0})
    >>> shots = da.MultipleShooting(intervals=8)
    >>> best = da.optimize_trajectory(system.build(), da.final("time"), **task, method=shots)
    >>> round(best.duration, 6), best.deviation < 1e-9  # 2 √(m x/F); the run has the same steps
    (1.0, True)
    """

    display_name = "multiple shooting"

    steps: int = 4
    formulation: Formulation = field(default_factory=RangeSpace)
    stabilization: Stabilization = field(default_factory=Projection)
    integrator: Integrator = field(default_factory=RK4)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.steps < 2 or self.steps % 2:
            raise AnalysisError(f"steps is {self.steps}; give an even number")

    def transcription(self, physics: Physics, duration: tuple[float, float]) -> Transcription:
        half = half_interval(physics, self.forward(duration[1]), self.steps // 2)
        return Shooting(physics, self.intervals, duration, half)

    def forward(self, duration: float) -> Dynamics:
        return Dynamics(
            duration,
            step=duration / (self.steps * self.intervals),
            formulation=self.formulation,
            stabilization=self.stabilization,
            integrator=self.integrator,
        )

    def finer(self, steps: bool) -> MultipleShooting:
        return replace(self, steps=4 * self.steps) if steps else super().finer(steps)  # type: ignore[return-value]

    @property
    def expands(self) -> bool:
        return False


class Shooting(Transcription):
    """The state at a knot is integrated from the previous knot.

    Accelerations and multipliers are unknowns at knots and in the middles, as measures need them,
    and are determined by the equations of motion there.

    Parameters
    ----------
    half : ``(t, h, y, v, q, w) → (y, v)`` after half of an interval
    """

    def __init__(
        self, physics: Physics, intervals: int, duration: tuple[float, float], half: ca.Function
    ):
        super().__init__(physics, intervals, duration)
        self.half = half
        self.blocks["a_middle"] = Block.free("a_middle", self.blocks["a"].size, intervals)

    def _integrate(self, fraction: float, y: ca.MX, v: ca.MX) -> tuple[ca.MX, ca.MX]:
        """States half an interval later, starting at a fraction of each interval."""
        t, u = self.knots.t[:, :-1], self.variables("u")
        ends = [u[:, :-1], self.variables("u_middle"), u[:, 1:]]
        h = ca.repmat(self.h, 1, self.n)
        steering = ca.vertcat(t, h, *(part[k, :] for k in range(u.shape[0]) for part in ends))
        q = ca.repmat(self.variables("q"), 1, self.n)
        states = self.half.map(self.n)(t + fraction * h, h, y, v, q, steering)
        return states[0], states[1]

    @cached_property
    def middles(self) -> Points:
        y, v = self._integrate(0.0, self.knots.y[:, :-1], self.knots.v[:, :-1])
        return self.between(y, v, self.variables("a_middle"))

    def equations(self) -> list[Rows]:
        physics, s = self.physics, self.physics.model.scales
        y, v = self._integrate(0.5, self.middles.y, self.middles.v)
        defects = ca.vertcat(
            (self.knots.y[:, 1:] - y) / s.coordinates, (self.knots.v[:, 1:] - v) / s.speeds
        )
        motion_rows = physics.rows("balance", "acceleration")
        return [
            Rows(
                "constraints at the beginning", self.knots.at(0, physics.rows("position", "speed"))
            ),
            Rows("equations of motion", self.knots.of(motion_rows)),
            Rows("equations in the middle of intervals", self.middles.of(motion_rows)),
            Rows("steps from knot to knot", defects),
        ]


def half_interval(physics: Physics, run: Dynamics, steps: int) -> ca.Function:
    """Integration ``(t, h, y, v, q, w) → (y, v)`` over half an interval, under a control.

    ``h`` is the length of the interval; ``steps`` steps cover half of it. ``w`` contains its start
    and length, and for each control the values at its ends and in its middle.

    Raises
    ------
    UnsupportedError
        The integrator is adaptive or a multistep method.
    """
    steered = SteeredModel(physics.model, physics.controls)
    step = _step(steered, run.kernel(steered), physics.p)
    t, h = ca.MX.sym("t"), ca.MX.sym("h")
    count = physics.equations.coordinate_count, physics.equations.speed_count
    y, v = (ca.MX.sym(name, size) for name, size in zip("yv", count, strict=True))
    q, w = ca.MX.sym("q", len(physics.vary)), ca.MX.sym("w", steered.steering.numel())
    p = ca.MX(ca.DM(physics.p))
    for k, name in enumerate(physics.vary):
        p[list(physics.model.parameters).index(name)] = q[k]
    other_states = ca.MX(step.size_in(2)[0] - sum(count), 1)
    x, step_size = ca.vertcat(y, v, other_states), h / (2 * steps)
    for k in range(steps):
        x = step(t + k * step_size, step_size, x, ca.vertcat(p, w))
    ends = x[: count[0]], x[count[0] : sum(count)]
    half = ca.Function("half", [t, h, y, v, q, w], list(map(ca.densify, ends)))
    return half if run.integrator.implicit else half.expand("half", {"cse": True})


def _step(steered: SteeredModel, kernel: DynamicsKernel, p: np.ndarray) -> ca.Function:
    """Step function ``(t, h, x, p) → x⁺`` of the variant at the start of the model."""
    integrator = kernel.integrator
    if integrator.adaptive:
        raise UnsupportedError(
            f"{integrator.name} chooses its steps; shooting takes fixed ones, such as RK4() or "
            "Radau(fixed=True)"
        )
    start = steered.start
    parameters = np.r_[p, np.zeros(steered.steering.numel())]
    parameters[p.size + 1] = 1.0  # a length of time
    x = kernel.start.function(0.0, start.y, start.v, parameters).full().ravel()
    if x.size > start.y.size + start.v.size + WORK.numel():
        raise UnsupportedError(
            "shooting does not support switches of friction and stops; smooth them"
        )
    step = kernel.variants[kernel.choose(0.0, x, parameters)].step
    if step.begin is not None:
        raise UnsupportedError(
            f"{integrator.name} remembers earlier steps; shooting takes methods that do not, such "
            "as RK4() or Radau(fixed=True)"
        )
    return step.function
