"""Base classes of integrators and the initial value problem they solve.

A new integrator is a frozen dataclass with ``step`` and, for step size control, ``attempt``.
Integrators see states and systems of equations, never a mechanism.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.step import Step
from dalembert.options import inherit_texts, options
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.newton import NewtonSettings
from dalembert.symbolic.equations.semi_explicit import SemiExplicit
from dalembert.symbolic.once import CacheOwner


@dataclass(frozen=True, eq=False)
class Problem:
    """Initial value problem in the forms that integrators need.

    Attributes
    ----------
    rate : ``(t, x, p) → ẋ``; None if the formulation provides no accelerations
    make_system : builds the equivalent differential-algebraic ``system``
    correction : ``(t, x, p) → x`` applied after a step, or None
    upkeep : the same for steps without correction: normalisation after every step, or None
    translates : a correction also applies to earlier states, so that differences are unchanged
    controlled : number of leading entries of x under error control
    positions : number of these that are positions; speeds follow, then the rest
    tangential : ``(t, x, p, error) → error`` along the constraints, or None
    sizes : (n,) natural sizes of the entries of x, ones by default
    time : natural time [s]
    spare : number of algebraic variables that other variants of the run have in addition
    """

    rate: ImplicitFunction | None
    make_system: Callable[[], SemiExplicit]
    correction: ImplicitFunction | None
    controlled: int
    positions: int
    tangential: ca.Function | None = None
    upkeep: ImplicitFunction | None = None
    translates: bool = False
    sizes: np.ndarray | None = None
    time: float = 1.0
    spare: int = 0

    @cached_property
    def system(self) -> SemiExplicit:
        """The problem as a differential-algebraic system, for implicit methods."""
        return self.make_system()


@dataclass(frozen=True)
class Attempt(CacheOwner):
    """Attempted step of an adaptive integrator, as one function.

    ``function`` maps ``([t; h; memory; x], [end; longest; p])``, before the end, to the next such
    column and to ``[t; h; error; accepted; stiffness]``; a rejected attempt leaves t and x
    unchanged. The stiffness is an estimate of ``h ρ(∂F/∂x)``, 0 for methods without one.

    Attributes
    ----------
    function : ca.Function
    memory : initial values of the memory of the step size controller
    called : equivalent function with calls, fastest when compiled; None if there is no such form
    work : approximate operations of an attempt; default the instructions of ``function``
    """

    function: ca.Function
    memory: tuple[float, ...]
    called: ca.Function | None = None
    work: float | None = None

    @property
    def cost(self) -> float:
        """Approximate number of operations of an attempt."""
        return float(self.function.n_instructions()) if self.work is None else self.work


@dataclass(frozen=True)
class Integrator:
    """Strategy object for advancing in time."""

    def __init_subclass__(cls) -> None:
        inherit_texts(cls)

    @property
    def name(self) -> str:
        return type(self).__name__

    @property
    def methods(self) -> tuple[Integrator, ...]:
        """Methods a run switches between; it begins with the first that fits the problem."""
        return (self,)

    @property
    def implicit(self) -> bool:
        """True for methods that solve equations in every step and accept DAE systems."""
        return False

    @property
    def adaptive(self) -> bool:
        return False

    @property
    def controls_error(self) -> bool:
        """True for methods with error control, by step length or inside a step."""
        return self.adaptive

    @property
    def run_tolerance(self) -> float | None:
        """Relative tolerance of a whole run; None if the tolerance is per step or absent."""
        return None

    @property
    def gradient_error(self) -> float:
        """Relative error of gradients; 0 if they are exact derivatives of the steps taken."""
        return 0.0

    @property
    def convergence_order(self) -> int:
        """Order of convergence of the states in the step length."""
        return self.order

    @property
    def order(self) -> int:
        """Order of quadrature over the steps of the run."""
        return 4

    @property
    def evaluations(self) -> int | None:
        """Evaluations of the accelerations per step, None for implicit methods."""
        return None

    @property
    def longest_step(self) -> float | None:
        """Upper limit of the step of an adaptive method [s], None if unlimited."""
        return None

    def longest_in(self, span: float) -> float:
        """Upper limit of the step [s] of an adaptive method in a run of length ``span``."""
        return self.longest_step or span / 4

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """``R(z)`` with ``x⁺ = R(hλ) x`` for ``ẋ = λx``; None for multistep methods."""
        return None

    def check(self, problem: Problem) -> None:
        """Raise if the problem lacks the form this method needs; compiles nothing.

        Raises
        ------
        UnsupportedError
            Names a method or formulation that works.
        """
        if self.implicit:
            _ = problem.system  # raises if it cannot be written as a DAE

    def step(self, problem: Problem) -> Step:
        """Step of prescribed length, for a problem that passes ``check``."""
        raise NotImplementedError

    def attempt(self, problem: Problem, step: Step) -> Attempt | None:
        """Attempted step with error control; None for fixed-step methods."""
        return None


@options(kw_only=True)
class ImplicitIntegrator(Integrator, ABC):
    """Integrator that solves equations in every step by Newton's method.

    Equations count as solved when each residual is below ``tolerance`` times the terms of its
    equation (for constraints: times their change within the step), or below rounding.

    Parameters
    ----------
    tolerance : relative residual at which the iteration ends [-]
    max_iterations : upper limit of Newton iterations; a step that needs more fails

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or ``max_iterations`` below 1.
    """

    tolerance: float = 1e-12
    max_iterations: int = 20

    def __post_init__(self) -> None:
        if not self.tolerance > 0 or self.max_iterations < 1:
            raise UnsupportedError(
                f"{self.name}(tolerance={self.tolerance}, max_iterations={self.max_iterations}): "
                "the tolerance must be positive and at least one iteration allowed"
            )

    @property
    def implicit(self) -> bool:
        return True

    @property
    def newton(self) -> NewtonSettings:
        return NewtonSettings(tolerance=self.tolerance, max_iterations=self.max_iterations)

    @abstractmethod
    def step(self, problem: Problem) -> Step:
        """Step of prescribed length."""
