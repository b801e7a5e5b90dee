"""Update rule of the Newmark family as a linear map.

In the form of Arnold and Brüls (2007), with algorithmic accelerations ``α`` beside the true ``a``:

    w = v + h ((1/2 − β) α + β α⁺),    v⁺ = v + h ((1 − γ) α + γ α⁺),
    (1 − α_m) α⁺ + α_m α = (1 − α_f) a⁺ + α_f a,

where ``w`` is the mean speed: ``u⁺ = u + h w``, or ``ẏ ≈ A(ȳ) w`` on a manifold. The rule is
linear in ``a⁺``, the only unknown of a step, determined by the equations of motion at its end.
``α ≈ a(t + δ h)`` with ``δ = α_m − α_f`` is stored as ``s = (α − a) / h``, so that starts and
changes of the step length preserve the order.

Steps of mechanisms evaluate the rule with expressions of a graph, steps of structures with columns
of numbers; the transpose serves the latter, since a graph is differentiated automatically.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple


@dataclass(frozen=True)
class NewmarkCoefficients:
    """``β``, ``γ``, ``α_m`` and ``α_f`` as above."""

    beta: float
    gamma: float
    alpha_m: float = 0.0
    alpha_f: float = 0.0

    @property
    def shift(self) -> float:
        """``δ``: time shift of the algorithmic accelerations, in steps."""
        return self.alpha_m - self.alpha_f

    @property
    def undamped(self) -> bool:
        """True without numerical dissipation at any frequency."""
        return self.gamma == 0.5 and self.shift == 0


class Moving(NamedTuple):
    """State at the start or end of a step, its change, or its adjoint weights.

    Attributes
    ----------
    u, v, a : displacements, speeds and accelerations
    s : memory of the method
    """

    u: Any
    v: Any
    a: Any
    s: Any


class Course(NamedTuple):
    """Speeds and algorithmic accelerations of a step.

    Attributes
    ----------
    mean : ``w``
    end : ``v⁺``
    algorithmic : ``α⁺``
    """

    mean: Any
    end: Any
    algorithmic: Any


@dataclass(frozen=True)
class StepRule:
    """Update rule for one step length, with ``α⁺ = κ a⁺ + μ a − ν α``.

    Attributes
    ----------
    h : length [s]
    kappa, mu, nu : ``(1−α_f)/(1−α_m)``, ``α_f/(1−α_m)``, ``α_m/(1−α_m)``
    early : parts of ``α`` in mean speed and speed at the end, ``h (1/2 − β)`` and ``h (1 − γ)``
    late : parts of ``α⁺``, ``h β`` and ``h γ``
    """

    h: Any
    kappa: float
    mu: float
    nu: float
    early: tuple[Any, Any]
    late: tuple[Any, Any]

    @classmethod
    def of(cls, c: NewmarkCoefficients, h: Any) -> StepRule:
        """The rule of a method for steps of length ``h``, a number or an expression."""
        complement = 1 - c.alpha_m
        factors = (1 - c.alpha_f) / complement, c.alpha_f / complement, c.alpha_m / complement
        return cls(h, *factors, (h * (0.5 - c.beta), h * (1 - c.gamma)), (h * c.beta, h * c.gamma))

    @property
    def slopes(self) -> tuple[Any, Any]:
        """Derivatives of ``u⁺`` and ``v⁺`` by ``a⁺``, ``κ h² β`` and ``κ h γ``."""
        return self.kappa * self.h * self.late[0], self.kappa * self.late[1]

    def predicted(self, v: Any, a: Any, s: Any) -> Course:
        """The course of a step with ``a⁺ = 0``."""
        algorithmic = a + self.h * s
        following = self.mu * a - self.nu * algorithmic
        mean, end = (
            v + early * algorithmic + late * following
            for early, late in zip(self.early, self.late, strict=True)
        )
        return Course(mean, end, following)

    def corrected(self, predicted: Course, a: Any) -> Course:
        """The course of a step with accelerations ``a⁺`` at its end."""
        part = self.kappa * a
        return Course(
            predicted.mean + self.late[0] * part,
            predicted.end + self.late[1] * part,
            predicted.algorithmic + part,
        )

    def memory(self, course: Course, a: Any) -> Any:
        """``s⁺``."""
        return (course.algorithmic - a) / self.h

    def weigh_acceleration(self, weights: Moving) -> Any:
        """Weight of ``a⁺`` from the weights at the end of the step."""
        return weights.a - weights.s / self.h + self.kappa * self._weigh_algorithmic(weights)

    def weigh_start(self, weights: Moving) -> Moving:
        """Weights of the state at the start of the step."""
        following = self._weigh_algorithmic(weights)
        mean = self.h * weights.u
        algorithmic = self.early[0] * mean + self.early[1] * weights.v - self.nu * following
        a = self.mu * following + algorithmic
        return Moving(weights.u, weights.v + mean, a, self.h * algorithmic)

    def _weigh_algorithmic(self, weights: Moving) -> Any:
        """Weight of ``α⁺``."""
        late = self.late[0] * self.h * weights.u + self.late[1] * weights.v
        return late + weights.s / self.h
