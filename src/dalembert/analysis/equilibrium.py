"""Static equilibrium: positions at which applied forces and reactions balance.

``f(y, 0) − d(y, 0) − Cᵀ λ = 0``, ``Φ(y) = 0``. On the tangent space of the constraints this is
``r = Zᵀ f = 0``; Newton's method uses the tangent stiffness ``Zᵀ K Z`` made positive definite,
so that it descends towards a stable position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.factor import QrFactor
from dalembert.symbolic.implicit import ImplicitFunction, Stage

TOLERANCE = 1e-10


class StaticsKernel:
    """Compiled static equations of a model."""

    def __init__(self, model: Model):
        e = model.equations
        self.model = model
        at_rest = ca.substitute(e.force - e.bias, e.v, ca.SX.zeros(e.speed_count))
        forces = at_rest - ca.mtimes(e.jacobian.T, e.multiplier)
        self.balance = forces
        self.static = ca.Function(
            "static",
            [e.t, e.y, e.multiplier, e.p],
            [
                at_rest,
                e.jacobian,
                -ca.mtimes(ca.jacobian(forces, e.y), e.lift),
                e.mass,
                e.constraints,
            ],
            {"cse": True},
        )

    @property
    def configuration(self) -> ImplicitFunction:
        """``(t, [y; λ] nearby, p) → y, λ`` with their exact derivatives."""
        e = self.model.equations
        near = ca.SX.sym("near", e.coordinate_count + e.constraint_count)
        unknown = ca.vertcat(e.y, e.multiplier)
        residual = ca.vertcat(self.balance, e.constraints)
        factor = QrFactor(ca.jacobian(residual, unknown))
        stage = Stage(unknown, residual, near, factor.solve, factor.solve_transposed)
        return ImplicitFunction("equilibrium", [e.t, near, e.p], [stage], [unknown])

    def measured(self, measure: ca.SX) -> ImplicitFunction:
        """A measure of the equilibrium; speeds and accelerations are zero."""
        e = self.model.equations
        still = ca.vertcat(e.v, e.a)
        at_rest = ca.substitute(e.without_dropped(measure), still, ca.SX.zeros(still.numel()))
        found = self.configuration
        return ImplicitFunction("measured", found.inputs, found.stages, [at_rest])

    def near(self, s: Trajectory) -> np.ndarray:
        """Where the configuration is differentiated."""
        return np.vstack([s.y, s.multiplier[self.model.closure.rows]])


@dataclass(frozen=True)
class EquilibriumRecord:
    """What a gradient needs."""

    kernel: StaticsKernel


@dataclass(frozen=True)
class Equilibrium:
    """Static equilibrium as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are taken [s]
    tolerance : of the residual relative to the largest applied force
    max_iterations : of Newton's method
    """

    time: float = 0.0
    tolerance: float = TOLERANCE
    max_iterations: int = 200

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
        start: np.ndarray | None = None,
    ) -> Motion:
        """Find the equilibrium nearest to the assembled position, or to the pose ``start``.

        The result is a motion of one instant; ``statistics`` tells whether it is stable.

        Raises
        ------
        AssemblyError
            The mechanism cannot be assembled.
        """
        p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        return _Search(self, model, p).execute(start)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The equilibrium at other parameter values, reached from this one."""
        return self.run(motion.model, p, start=motion.trajectory.y[:, 0])

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
                "asked for; take the final value"
            )
        return motion


class _Search:
    def __init__(self, analysis: Equilibrium, model: Model, p: np.ndarray):
        self.analysis, self.model, self.p = analysis, model, p
        self.kernel = model.compiled("statics", lambda: StaticsKernel(model))
        self.lift = np.eye(model.equations.coordinate_count)

    def evaluate(self, y: np.ndarray, multiplier: np.ndarray):
        parts = self.kernel.static(self.analysis.time, y, multiplier, self.p)
        force, c, stiffness, mass, phi = (a.full() for a in parts)
        return force.ravel(), c, stiffness, mass, phi.ravel()

    def balance(self, y: np.ndarray):
        """Multipliers, tangent basis, reduced residual and stiffness at a position."""
        zero = np.zeros(self.model.equations.constraint_count)
        force, c, _, _, _ = self.evaluate(y, zero)
        multiplier = np.linalg.lstsq(c.T, force, rcond=None)[0] if c.size else zero
        _, _, stiffness, mass, _ = self.evaluate(y, multiplier)
        z = np.linalg.svd(c)[2][c.shape[0] :].T if c.size else np.eye(force.size)
        return multiplier, z, z.T @ force, z.T @ stiffness @ z, z.T @ mass @ z, force

    def execute(self, start: np.ndarray | None = None) -> Motion:
        y = self.model.assemble(self.p, self.analysis.time).y
        if start is not None:
            moved = self.onto_constraints(start)
            y = y if moved is None else moved
        iterations, scale, residual = 0, 1e-12, np.inf
        while iterations < self.analysis.max_iterations:
            iterations += 1
            multiplier, z, r, k, m, force = self.balance(y)
            scale = max(scale, np.abs(force).max(initial=0.0), 1e-3 * np.abs(k).max(initial=0.0))
            residual = float(np.abs(r).max(initial=0.0))
            if residual <= self.analysis.tolerance * scale:
                break
            y = self.step(y, z, r, k, m)
        return self.result(y, multiplier, k, residual, scale, iterations)

    def step(self, y, z, r, k, m) -> np.ndarray:
        """Damped Newton step on the constraint manifold."""
        symmetric = (k + k.T) / 2
        values, vectors = np.linalg.eigh(symmetric)
        floor = 1e-6 * max(np.abs(values).max(initial=0.0), 1e-12)
        if values.min(initial=np.inf) > floor:
            move = np.linalg.solve(k, r)
        else:  # not a minimum: turn negative curvature around and descend
            curvature = np.maximum(np.abs(values), floor)
            move = vectors @ ((vectors.T @ r) / curvature)
        move *= min(1.0, 0.5 / max(np.abs(z @ move).max(initial=0.0), 1e-300))
        before = float(r @ r)
        for _ in range(30):
            trial = self.onto_constraints(y + z @ move)
            if trial is not None:
                new = self.balance(trial)[2]
                if new @ new < before or values.min(initial=0.0) <= floor:
                    return trial
            move = move / 2
        return y + z @ move

    def onto_constraints(self, y: np.ndarray) -> np.ndarray | None:
        zero = np.zeros(self.model.equations.constraint_count)
        for _ in range(20):
            _, c, _, _, phi = self.evaluate(y, zero)
            if np.abs(phi).max(initial=0.0) < 1e-13:
                return y
            y = y - np.linalg.lstsq(c, phi, rcond=None)[0]
        return y if np.abs(phi).max(initial=0.0) < 1e-10 else None

    def result(self, y, multiplier, k, residual, scale, iterations) -> Motion:
        n = self.model.equations.speed_count
        converged = residual <= self.analysis.tolerance * scale
        eigenvalues = np.linalg.eigvalsh((k + k.T) / 2) if k.size else np.array([])
        stable = bool(np.all(eigenvalues > 0))
        text = f"residual {residual:.3g} N after {iterations} iterations, " + (
            "stable" if stable else "not a stable position"
        )
        outcome = Outcome.COMPLETED if converged else Outcome.NOT_CONVERGED
        column = (-1, 1)
        trajectory = Trajectory(
            np.array([self.analysis.time]),
            y.reshape(column),
            np.zeros((n, 1)),
            np.zeros((n, 1)),
            self.model.all_multipliers(multiplier.reshape(column)),
            np.zeros((2, 1)),
        )
        return Motion(
            self.model,
            self.analysis,
            self.p,
            trajectory,
            Status(outcome, text, self.analysis.time, residual),
            {"iterations": iterations, "stable": stable, "residual [N or N m]": residual},
            record=EquilibriumRecord(self.kernel),
        )


def solve_equilibrium(
    model: Model, *, parameters: Mapping[str, float] | None = None, **options: Any
) -> Motion:
    """Static equilibrium near the assembled position, ``f − d − Cᵀλ = 0`` at rest.

    Parameters
    ----------
    model : Model
    parameters : new values of parameters, without rebuilding
    **options : fields of ``Equilibrium``: time, tolerance, max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError`` where the mechanism cannot be put together. A search that
        does not converge says so in its status.
    """
    try:
        analysis = Equilibrium(**options)
    except TypeError as error:
        raise AnalysisError(f"solve_equilibrium: {error}") from None
    return analysis.run(model, parameters)
