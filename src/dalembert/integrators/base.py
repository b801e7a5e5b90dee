"""What an integrator is, and what it is given.

To write a new one: a frozen dataclass with ``step``, and for step size control ``attempt``.
Integrators see states and systems of equations, never a mechanism.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.integrators.step import Step
from dalembert.options import inherit_texts
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.semi_explicit import SemiExplicit


@dataclass(frozen=True, eq=False)
class Problem:
    """An initial value problem in the forms integrators want.

    Attributes
    ----------
    rate : ``(t, x, p) → ẋ``; None where the formulation gives no accelerations
    make_system : gives the same as a differential-algebraic ``system``
    correction : ``(t, x, p) → x`` applied after a step, or None
    upkeep : the same for steps without correction: what states need after every step, or None
    translates : a correction counts for earlier states as well, whose differences then stay
    controlled : how many leading entries of x the error control looks at
    positions : how many of these are positions; speeds follow, then the rest
    tangential : ``(t, x, p, error) → error`` along the constraints, or None
    sizes : (n,) natural sizes of the entries of x, units by default
    time : natural time [s]
    spare : algebraic variables that this problem lacks and others of the same run have
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
class Attempt:
    """An attempted step of an adaptive integrator, as one function.

    ``function`` maps ``([t; h; memory; x], [end; longest; p])``, before the end, to the next such
    column and to ``[t; h; error; accepted; stiffness]``; a rejected attempt leaves t and x as they
    are. The stiffness is an estimate of ``h ρ(∂F/∂x)``, 0 where the method makes none.

    Attributes
    ----------
    function : ca.Function
    memory : initial values of what the controller remembers
    called : the function in the form that is fastest compiled, if there is another
    work : operations of an attempt, about; those of the function where it is one of scalars
    """

    function: ca.Function
    memory: tuple[float, ...]
    called: ca.Function | None = None
    work: float | None = None

    @property
    def cost(self) -> float:
        """Operations of an attempt, about."""
        return float(self.function.n_instructions()) if self.work is None else self.work


@dataclass(frozen=True)
class Integrator:
    """Strategy object: how time advances."""

    def __init_subclass__(cls) -> None:
        inherit_texts(cls)

    @property
    def name(self) -> str:
        return type(self).__name__

    @property
    def methods(self) -> tuple[Integrator, ...]:
        """Methods between which a run changes; it begins with the first that suits the problem."""
        return (self,)

    @property
    def implicit(self) -> bool:
        """Solves equations in every step, so takes differential-algebraic systems."""
        return False

    @property
    def adaptive(self) -> bool:
        return False

    @property
    def controls_error(self) -> bool:
        """Keeps its errors below a tolerance, by the length of its steps or inside them."""
        return self.adaptive

    @property
    def run_tolerance(self) -> float | None:
        """Relative tolerance stated for whole runs; None where it is for steps, or for none."""
        return None

    @property
    def gradient_error(self) -> float:
        """Relative error of its gradients; none where they are derivatives of the steps taken."""
        return 0.0

    @property
    def convergence_order(self) -> int:
        """Order of the states in the length of the steps."""
        return self.order

    @property
    def order(self) -> int:
        """Order to which integrals over the run follow its steps."""
        return 4

    @property
    def evaluations(self) -> int | None:
        """Evaluations of the accelerations in one step, None where steps solve equations."""
        return None

    @property
    def longest_step(self) -> float | None:
        """Longest step of an adaptive method [s], if limited."""
        return None

    def longest_in(self, span: float) -> float:
        """Upper limit of the steps of an adaptive method in a run of that length [s]."""
        return self.longest_step or span / 4

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """``R(z)`` with ``x⁺ = R(hλ) x`` for ``ẋ = λx``, None where it is not a one-step method."""
        return None

    def check(self, problem: Problem) -> None:
        """Refuse a problem that has not the form this method needs; compiles nothing.

        Raises
        ------
        UnsupportedError
            Names a method or formulation that works.
        """
        if self.implicit:
            _ = problem.system  # which tells what cannot be written so

    def step(self, problem: Problem) -> Step:
        """One step of given length, of a problem that passes ``check``."""
        raise NotImplementedError

    def attempt(self, problem: Problem, step: Step) -> Attempt | None:
        """One attempt with error control; None for methods of fixed step."""
        return None
