"""Assembly: from guesses to a configuration that satisfies every joint and driver.

The guesses are first projected onto ``Φ = 0``. Then, in the order of declaration (angles before
positions), as many given coordinates as the constraints leave independent are *held* at exactly
their given values, so that a crank starts at the angle its user wrote; the rest follows. This
choice, the recipe, is made once; with it the assembled state is the root of a square system and
so a differentiable function of the parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.equations import Equations
from dalembert.model.guesses import Guesses
from dalembert.model.independence import independent_units
from dalembert.symbolic.expression import stack
from dalembert.symbolic.factor import QrFactor
from dalembert.symbolic.implicit import ImplicitFunction, Stage

POSITION_TOLERANCE = 1e-11
MISSING_WEIGHT = 1e-2
SEARCH_SAMPLES = 361


@dataclass(frozen=True)
class Held:
    """Coordinates (or speeds) held at their guesses; -1 in ``given`` order means: a constant."""

    indices: tuple[int, ...] = ()
    constants: tuple[float | None, ...] = ()


@dataclass
class AssembledState:
    """Consistent initial state.

    Attributes
    ----------
    y, v : (n,) arrays
    corrections : coordinate name → change made to a given guess
    residual : largest remaining violation
    velocity_correction : largest change made to given speeds that were inconsistent
    """

    y: np.ndarray
    v: np.ndarray
    residual: float
    corrections: dict[str, float] = field(default_factory=dict)
    velocity_corrections: dict[str, float] = field(default_factory=dict)
    projected_speeds: bool = False


class Assembler:
    """Finds consistent initial states of one system for any parameter values.

    Parameters
    ----------
    equations : Equations with all constraint rows
    guesses : Guesses
    row_names : (m,) name of the joint or driver behind each row
    initial : prescribed measures, (expression − value) in y or v
    searches : (coordinate, rows, range) of curve parameters without a guess
    """

    def __init__(
        self,
        equations: Equations,
        guesses: Guesses,
        row_names: list[str],
        initial: list[ca.SX],
        searches: list[tuple[int, list[int], tuple[float, float]]],
    ):
        self.searches = searches
        self.e, self.guesses, self.row_names = equations, guesses, row_names
        e = equations
        speeds = [ca.depends_on(r, e.v) for r in initial]
        self.initial_position = stack(r for r, s in zip(initial, speeds, strict=True) if not s)
        self.initial_speed = stack(r for r, s in zip(initial, speeds, strict=True) if s)
        residual = ca.vertcat(e.constraints, self.initial_position)
        self._position = ca.Function(
            "position", [e.t, e.y, e.p], [residual, ca.jacobian(residual, e.y)]
        )
        psi = ca.vertcat(e.velocity_constraints, self.initial_speed)
        self._velocity = ca.Function(
            "velocity", [e.t, e.y, e.v, e.p], [psi, ca.jacobian(psi, e.v), e.mass], {"cse": True}
        )
        self.guess = guesses.function(e.p)
        self.weight = np.array([1.0 if g is not None else MISSING_WEIGHT for g in guesses.pose])

    # positions ---------------------------------------------------------------
    def project(self, t: float, p: np.ndarray, attempts: int = 12) -> np.ndarray:
        """Nearest assembled configuration to the guesses, from several starts if need be."""
        guess = self.guess(p)[0].full().ravel()
        missing = self.guesses.missing
        rng = np.random.default_rng(0)
        best, worst = guess, np.inf
        for attempt in range(attempts):
            start = guess.copy()
            if attempt:
                angle = np.array([u == "rad" for u in self.guesses.units])
                spread = np.where(missing, np.where(angle, np.pi / 2, 0.5), 0.02 * attempt)
                start += spread * rng.uniform(-1, 1, start.size)
            y, residual = self.close(t, self._search(t, start, p), p)
            if residual < worst:
                best, worst = y, residual
            if worst < POSITION_TOLERANCE:
                return best
        raise self.failure(t, best, p)

    def _search(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Put a missing curve parameter where its curve is nearest."""
        for index, rows, (low, high) in self.searches:
            samples = np.linspace(low, high, SEARCH_SAMPLES)
            table = np.tile(y[:, None], samples.size)
            table[index] = samples
            times, parameters = np.full(samples.size, t), np.tile(p[:, None], samples.size)
            residual = self._position.map(samples.size)(times, table, parameters)[0].full()
            y = table[:, np.argmin(np.linalg.norm(residual[rows], axis=0))]
        return y

    def close(
        self, t: float, y: np.ndarray, p: np.ndarray, rows: list[int] | None = None
    ) -> tuple[np.ndarray, float]:
        """Nearby root of the constraints by Levenberg–Marquardt, and the violation left.

        ``rows`` selects some of the equations. Given coordinates move less than missing ones.
        """
        keep = slice(None) if rows is None else rows
        r, jacobian = (a[keep] for a in self._evaluate(t, y, p))
        norm, damping = float(np.linalg.norm(r)), 1e-3
        for _ in range(200):
            if norm < 1e-15 or not np.isfinite(norm):
                break
            scaled = jacobian / self.weight
            normal = scaled @ scaled.T
            level = damping * norm * max(np.trace(normal) / max(r.size, 1), 1e-300)
            lift = np.linalg.lstsq(normal + level * np.eye(r.size), r, rcond=1e-14)[0]
            step = -(scaled.T @ lift) / self.weight
            step *= min(1.0, 1.0 / max(float(np.abs(step).max()), 1e-300))
            r_new, j_new = (a[keep] for a in self._evaluate(t, y + step, p))
            new = float(np.linalg.norm(r_new))
            if new < norm:
                settled = norm < 1e-13 and new > 0.5 * norm
                y, r, jacobian, norm, damping = y + step, r_new, j_new, new, damping / 5
                if settled:
                    break
            elif damping > 1e12 or norm < 1e-13:
                break
            else:
                damping *= 4
        worst = float(np.abs(r).max(initial=0.0))
        return y, worst if np.isfinite(worst) else np.inf

    def _evaluate(self, t: float, y: np.ndarray, p: np.ndarray):
        r, jacobian = self._position(t, y, p)
        return r.full().ravel(), jacobian.full()

    def failure(self, t: float, y: np.ndarray, p: np.ndarray) -> AssemblyError:
        r, _ = self._evaluate(t, y, p)
        names = [*self.row_names, *["initial condition"] * self.initial_position.numel()]
        k = int(np.nanargmax(np.abs(r))) if np.any(np.isfinite(r)) else 0
        largest = float(abs(r[k]))
        return AssemblyError(
            f"the mechanism cannot be assembled at t = {t:g} s: {names[k]} stays open by "
            f"{largest:.3g} at best; check the lengths, or give poses nearer to the closed "
            "mechanism",
            largest,
        )

    def choose_held(
        self, t: float, y: np.ndarray, p: np.ndarray, rows: list[int], free: set[int]
    ) -> Held:
        """Coordinates to hold so that with the independent rows the system is square.

        ``free`` lists given coordinates that cannot be had; they count as missing.
        """
        _, jacobian = self._evaluate(t, y, p)
        m = self.e.constraint_count
        keep = [*rows, *range(m, jacobian.shape[0])]
        given = [None if k in free else g for k, g in enumerate(self.guesses.pose)]
        chosen = independent_units(jacobian[keep], self.guesses.priority(given))
        constants = tuple(None if given[k] is not None else float(y[k]) for k in chosen)
        return Held(tuple(chosen), constants)

    def position_residual(self, rows: list[int], held: Held) -> ca.SX:
        """Square system of the assembled position."""
        e = self.e
        targets = [
            self.guesses.pose[k] if c is None else ca.SX(c)
            for k, c in zip(held.indices, held.constants, strict=True)
        ]
        pinned = stack(e.y[k] - g for k, g in zip(held.indices, targets, strict=True))
        return ca.vertcat(e.constraints[rows], self.initial_position, pinned)

    # speeds ------------------------------------------------------------------
    def choose_held_speeds(
        self, t: float, y: np.ndarray, p: np.ndarray, rows: list[int]
    ) -> tuple[Held, dict[str, float]]:
        """Speeds to hold, and by how much given ones miss what these imply."""
        n = self.e.speed_count
        psi, jacobian, _ = (a.full() for a in self._velocity(t, y, np.zeros(n), p))
        m = self.e.constraint_count
        keep = [*rows, *range(m, jacobian.shape[0])]
        chosen = independent_units(jacobian[keep], self.guesses.priority(self.guesses.twist))
        given = self.guess(p)[1].full().ravel()
        matrix = np.vstack([jacobian[keep], np.eye(n)[chosen]])
        rhs = np.concatenate([-psi.ravel()[keep], given[chosen]])
        v = np.linalg.solve(matrix, rhs) if n else np.zeros(0)
        miss = {
            self.guesses.names[k]: float(v[k] - given[k])
            for k in range(n)
            if self.guesses.twist[k] is not None
            and abs(v[k] - given[k]) > 1e-6 * (1 + abs(given[k]))
        }
        constants = tuple(None if self.guesses.twist[k] is not None else 0.0 for k in chosen)
        if miss:  # remember where the missing speeds went: the projection starts from there
            filled = tuple(
                None if g is not None else float(v[k]) for k, g in enumerate(self.guesses.twist)
            )
            return Held((), filled), miss
        return Held(tuple(chosen), constants), miss

    def initial_state(
        self, rows: list[int], held: Held, speeds: Held, projected: bool
    ) -> ImplicitFunction:
        """``(t, y_start, p) → (y0, v0)`` for given recipe, with derivatives by ``p``.

        ``y_start`` is the assembled position itself; it only tells where to differentiate.
        """
        e = self.e
        start = ca.SX.sym("y_start", e.coordinate_count)
        residual = self.position_residual(rows, held)
        factor = QrFactor(ca.jacobian(residual, e.y))
        position = Stage(e.y, residual, start, factor.solve, factor.solve_transposed)
        demanded = ca.vertcat(e.velocity_constraints[rows], self.initial_speed)
        constant = [ca.SX(x) if x is not None else None for x in speeds.constants]
        if projected:
            c = ca.jacobian(demanded, e.v)
            sigma = ca.SX.sym("sigma", demanded.numel())
            goal = stack(
                g if c0 is None else c0 for g, c0 in zip(self.guesses.twist, constant, strict=True)
            )
            unknown = ca.vertcat(e.v, sigma)
            balance = ca.mtimes(e.metric, e.v - goal) + ca.mtimes(c.T, sigma)
            equations = ca.vertcat(balance, demanded)
        else:
            pinned = stack(
                e.v[k] - (self.guesses.twist[k] if c0 is None else c0)
                for k, c0 in zip(speeds.indices, constant, strict=True)
            )
            unknown = e.v
            equations = ca.vertcat(demanded, pinned)
        speed_factor = QrFactor(ca.jacobian(equations, unknown))
        at_zero = ca.substitute(equations, unknown, ca.SX.zeros(unknown.numel()))
        velocity = Stage(
            unknown,
            equations,
            speed_factor.solve(-at_zero),
            speed_factor.solve,
            speed_factor.solve_transposed,
        )
        return ImplicitFunction(
            "initial_state", [e.t, start, e.p], [position, velocity], [e.y, e.v]
        )
