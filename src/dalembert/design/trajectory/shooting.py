"""Multiple shooting (Bock and Plitt 1984): steps of an integrator lead from knot to knot."""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property

import casadi as ca

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.steered import half_of
from dalembert.design.trajectory.transcription import Block, Points, Rows, Transcription
from dalembert.errors import AnalysisError
from dalembert.formulations.base import Formulation
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection, Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.runge_kutta.explicit import RK4
from dalembert.options import options


@options
class MultipleShooting(TrajectoryMethod):
    """Steps of an integrator from knot to knot, which a run takes again: the plan is that run.

    Parameters
    ----------
    steps : in each interval, an even number; eight or more where the integrator is of order two
        or less, or parabolas of the control that it sees otherwise than the objective pay
    formulation, stabilization, integrator : of the steps, as in ``Dynamics``; of fixed steps

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
    >>> round(best.duration, 6), best.deviation < 1e-9  # 2 √(m x/F); a run takes the same steps
    (1.0, True)
    """

    spoken = "multiple shooting"

    steps: int = 4
    formulation: Formulation = field(default_factory=RangeSpace)
    stabilization: Stabilization = field(default_factory=Projection)
    integrator: Integrator = field(default_factory=RK4)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.steps < 2 or self.steps % 2:
            raise AnalysisError(f"steps is {self.steps}; give an even number")

    def transcription(self, physics: Physics, duration: tuple[float, float]) -> Transcription:
        half = half_of(physics, self.forward(duration[1]), self.steps // 2)
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
    """The state at a knot is where the steps of the integrator lead from the knot before.

    Accelerations and multipliers are unknowns at knots and in the middles, where measures need
    them, and follow from the equations of motion there.

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

    def _led(self, share: float, y: ca.MX, v: ca.MX) -> tuple[ca.MX, ca.MX]:
        """States half an interval after a share of it, interval by interval."""
        t, u = self.knots.t[:, :-1], self.own("u")
        ends = [u[:, :-1], self.own("u_middle"), u[:, 1:]]
        h = ca.repmat(self.h, 1, self.n)
        given = ca.vertcat(t, h, *(part[k, :] for k in range(u.shape[0]) for part in ends))
        q = ca.repmat(self.own("q"), 1, self.n)
        found = self.half.map(self.n)(t + share * h, h, y, v, q, given)
        return found[0], found[1]

    @cached_property
    def middles(self) -> Points:
        y, v = self._led(0.0, self.knots.y[:, :-1], self.knots.v[:, :-1])
        return self.between(y, v, self.own("a_middle"))

    def equations(self) -> list[Rows]:
        physics, s = self.physics, self.physics.model.scales
        y, v = self._led(0.5, self.middles.y, self.middles.v)
        away = ca.vertcat(
            (self.knots.y[:, 1:] - y) / s.coordinates, (self.knots.v[:, 1:] - v) / s.speeds
        )
        moved = physics.rows("balance", "acceleration")
        return [
            Rows(
                "constraints at the beginning", self.knots.at(0, physics.rows("position", "speed"))
            ),
            Rows("equations of motion", self.knots.of(moved)),
            Rows("equations in the middle of intervals", self.middles.of(moved)),
            Rows("steps from knot to knot", away),
        ]
