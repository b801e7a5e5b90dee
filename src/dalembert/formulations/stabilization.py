"""Stabilisation of constraint violations: none, Baumgarte, projection (5.4)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.formulations.base import NONE, Formulation, Level, memory_symbols, state_symbols
from dalembert.model.graph.equations import Equations
from dalembert.options import options
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage, Trial

FIRST_ITERATIONS = 2
"""Iterations of the position correction before its residual is checked: they reduce a violation
``ε`` to ``ε³``."""
CLOSED = 1e-13
"""Threshold of violations in natural units below which a position is not corrected further [-]."""


@dataclass(frozen=True)
class Stabilization:
    """No stabilisation, ``C v̇ = ξ`` (5.2): violations grow with the errors of the integrator.

    A new stabilisation changes ``ξ`` in ``constraint_acceleration`` or corrects states after a
    step in ``correction``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 5.0, step=0.02, stabilization=da.Stabilization())
    >>> violation = motion["position_violation"]
    >>> bool(violation[-1] > 10 * violation[20] > 0)  # the rod grows
    True
    """

    @property
    def period(self) -> int:
        """Number of steps between corrections."""
        return 1

    def constraint_acceleration(self, e: Equations) -> ca.SX:
        """``ξ`` used by the formulation."""
        return e.constraint_acceleration

    def correction(self, e: Equations, formulation: Formulation) -> ImplicitFunction | None:
        """``(t, x, p) → x`` applied to the state after a step, or None."""
        return None

    def tangential(self, e: Equations, formulation: Formulation) -> ca.Function | None:
        """``(t, x, p, error) → error`` without the part that the correction removes, or None."""
        return None

    def reference_energy(self, e: Equations) -> ca.SX:
        """Initial value of the reference energy; zero if the stabilisation has none."""
        return ca.SX(0)

    @property
    def exact_levels(self) -> frozenset[Level]:
        """Levels at which every state satisfies the constraints because of the correction."""
        return NONE

    @property
    def translates(self) -> bool:
        """Whether a correction shifts earlier states as well and keeps their differences."""
        return False

    @property
    def feedback(self) -> tuple[float, float] | None:
        """``(c₁, c₀)`` of ``Φ̈ + c₁Φ̇ + c₀Φ = 0`` if violations are fed back, else None."""
        return None

    def check(self, formulation: Formulation) -> None:
        """Refuse a formulation that it does not support.

        Raises
        ------
        UnsupportedError
            Feedback of violations with a formulation that has no ``ξ``.
        """
        if self.feedback is not None and formulation.refuses_feedback:
            raise UnsupportedError(formulation.refuses_feedback)

    def warnings(self, freedom: int, exchanged: float) -> list[str]:
        """Warnings about this choice.

        Parameters
        ----------
        freedom : degrees of freedom without the driven ones
        exchanged : largest energy supplied or dissipated during the run [J]
        """
        return []


@options
class Baumgarte(Stabilization):
    """``ξ_stab = ξ − α Φ̇ − β Φ`` (5.16–5.17); critical with ``β = α²/4``, the default.

    Parameters
    ----------
    alpha : gain of the velocity violation [1/s]
    beta : gain of the position violation [1/s²]; None for the critical value

    Raises
    ------
    UnsupportedError
        A gain that is not positive.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> model = system.build()
    >>> violation = {}
    >>> for name, method in (("none", da.Stabilization()), ("Baumgarte", da.Baumgarte(alpha=20.0))):
    ...     motion = da.solve_dynamics(model, 5.0, step=0.02, stabilization=method)
    ...     violation[name] = motion["position_violation"][-1].item()
    >>> violation["Baumgarte"] < 0.1 * violation["none"]
    True
    """

    alpha: float = 10.0
    beta: float | None = None

    def __post_init__(self) -> None:
        if not self.alpha > 0 or (self.beta is not None and not self.beta > 0):
            raise UnsupportedError(
                f"Baumgarte(alpha={self.alpha}, beta={self.beta}): both gains must be positive"
            )

    @property
    def feedback(self) -> tuple[float, float]:
        return self.alpha, self.alpha**2 / 4 if self.beta is None else self.beta

    def constraint_acceleration(self, e: Equations) -> ca.SX:
        alpha, beta = self.feedback
        stabilised = e.constraint_acceleration - alpha * e.velocity_constraints
        return stabilised - beta * e.constraints


@options
class Projection(Stabilization):
    """Mass-orthogonal projection of positions, then of speeds (5.21).

    ``M δ + C(ỹ)ᵀ μ = 0``, ``Φ(ỹ ⊕ δ) = 0`` by a few iterations with one factorisation at the
    incoming position, then ``M (v − ṽ) + Cᵀ σ = 0``, ``Ψ(y, v) = 0`` in one solve.

    Parameters
    ----------
    every : correct after every k-th step
    iterations : number of iterations of the position correction; two if these converge

    Raises
    ------
    UnsupportedError
        ``every`` or ``iterations`` below one.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 5.0, step=0.02, stabilization=da.Projection())
    >>> [bool(motion[f"{kind}_violation"].max() < 1e-12) for kind in ("position", "velocity")]
    [True, True]
    """

    every: int = 1
    iterations: int = 4

    def __post_init__(self) -> None:
        if self.every < 1 or self.iterations < 1:
            raise UnsupportedError(
                f"Projection(every={self.every}, iterations={self.iterations}): "
                "both must be at least 1"
            )

    @property
    def period(self) -> int:
        return self.every

    @property
    def exact_levels(self) -> frozenset[Level]:
        return frozenset({Level.POSITION, Level.SPEED}) if self.every == 1 else NONE

    def correction(self, e: Equations, formulation: Formulation) -> ImplicitFunction | None:
        m = e.constraint_count
        if m == 0:
            return None
        position, moved = self._position_stage(e, formulation)
        sigma, v = ca.SX.sym("sigma", m), ca.SX.sym("v_new", e.speed_count)

        def at_corrected(expression: ca.SX) -> ca.SX:
            return ca.substitute(expression, e.y, moved)

        inertia, c = e.inertia.substitute(e.y, moved), at_corrected(e.jacobian)
        psi = at_corrected(e.velocity_constraints)
        solver = formulation.saddle_at(e, inertia, c).corrector
        step, sigma_value = solver.solve(ca.SX.zeros(e.speed_count), -psi)
        residual = ca.vertcat(
            inertia.times(v - e.v) + ca.mtimes(c.T, sigma), ca.substitute(psi, e.v, v)
        )
        velocity = Stage(
            ca.vertcat(v, sigma),
            residual,
            ca.vertcat(e.v + step, sigma_value),
            solver.solve_stacked,
            solver.solve_stacked,
        )
        return ImplicitFunction(
            "projection",
            [e.t, state_symbols(e), e.p],
            [position, velocity],
            [ca.vertcat(moved, v, memory_symbols(e))],
        )

    def tangential(self, e: Equations, formulation: Formulation) -> ca.Function | None:
        """Tangential errors: ``M e + Cᵀ μ = M ẽ``, ``C e = 0`` for positions and speeds."""
        m = e.constraint_count
        if m == 0:
            return None
        n, k = e.coordinate_count, e.speed_count
        error = ca.SX.sym("error", state_symbols(e).numel())
        solver = formulation.saddle_at(e, e.inertia, e.jacobian).corrector

        def tangential_part(part: ca.SX) -> ca.SX:
            return solver.solve(e.inertia.times(part), ca.SX.zeros(m))[0]

        moved = tangential_part(ca.mtimes(e.manifold.reading, error[:n]))
        parts = ca.mtimes(e.lift, moved), tangential_part(error[n : n + k]), error[n + k :]
        inputs = [e.t, state_symbols(e), e.p, error]
        return ca.Function("tangential", inputs, [ca.densify(ca.vertcat(*parts))])

    def _position_stage(self, e: Equations, formulation: Formulation) -> tuple[Stage, ca.SX]:
        """Stage for ``(δ, μ)`` and the corrected position as an expression of ``δ``."""
        n, m = e.speed_count, e.constraint_count
        delta, mu = ca.SX.sym("delta", n), ca.SX.sym("mu", m)
        raw = formulation.saddle_at(e, e.inertia, e.jacobian)
        solver = raw.corrector
        moved = e.manifold.retract(e.y, delta)
        violation = ca.substitute(e.constraints, e.y, moved)
        if e.slips:  # corrections obey the nonholonomic constraints
            violation += ca.mtimes(e.slip_jacobian, delta)
        residual = ca.vertcat(e.inertia.times(delta) + ca.mtimes(e.jacobian.T, mu), violation)
        value_delta, value_mu = ca.SX.zeros(n), ca.SX.zeros(m)
        trial = None
        for k in range(self.iterations):
            if k == FIRST_ITERATIONS:
                scaled_violation = violation / (CLOSED * e.scales.rows)
                trial = Trial(ca.vertcat(value_delta, value_mu), ca.sumsqr(scaled_violation) / m)
            violation_at = ca.substitute(violation, delta, value_delta)
            step, multiplier = solver.solve(ca.SX.zeros(n), -violation_at)
            value_delta, value_mu = value_delta + step, value_mu + multiplier
        unknown = ca.vertcat(delta, mu)
        change = ca.sparsify(ca.jacobian(violation, delta) - e.jacobian)  # of C by the correction

        def solve(rhs: ca.SX, transposed: bool = False) -> ca.SX:
            # the factors belong to the incoming position; a few terms of the series in the change
            # of C compensate for that, and refinements for approximate factors
            total = term = solver.solve_stacked(rhs)
            for _ in range(3):
                source = total if solver is not raw else term
                x, z = source[:n], source[n:]
                if transposed:
                    residual_change = ca.vertcat(ca.mtimes(change.T, z), ca.SX.zeros(m, x.shape[1]))
                else:
                    residual_change = ca.vertcat(ca.SX.zeros(n, x.shape[1]), ca.mtimes(change, x))
                if solver is not raw:
                    products = ca.mtimes(e.jacobian.T, z), ca.mtimes(e.jacobian, x)
                    residual_change += (
                        ca.vertcat(e.inertia.times(x) + products[0], products[1]) - rhs
                    )
                term = -solver.solve_stacked(residual_change)
                total = total + term
            return total

        stage = Stage(
            unknown,
            residual,
            ca.vertcat(value_delta, value_mu),
            solve,
            lambda rhs: solve(rhs, transposed=True),
            trial,
        )
        return stage, moved
