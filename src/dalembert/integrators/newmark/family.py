"""Newmark family: Newmark, generalised-α and HHT methods."""

from __future__ import annotations

from abc import ABC, abstractmethod

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Problem
from dalembert.integrators.implicit import ImplicitIntegrator
from dalembert.integrators.newmark.rule import NewmarkCoefficients
from dalembert.integrators.newmark.step import NewmarkStep, check
from dalembert.options import options


@options(kw_only=True)
class NewmarkFamily(ImplicitIntegrator, ABC):
    """Method defined by its four coefficients, in the form of Arnold and Brüls (2007)."""

    @property
    @abstractmethod
    def coefficients(self) -> NewmarkCoefficients:
        """Coefficients of the method."""

    def check(self, problem: Problem) -> None:
        check(self.coefficients, problem, self.name)

    @property
    def convergence_order(self) -> int:
        return 2

    def step(self, problem: Problem) -> NewmarkStep:
        return NewmarkStep(self.coefficients, problem, self)


@options
class Newmark(NewmarkFamily):
    """Newmark (1959): ``v⁺ = v + h((1 − γ) v̇ + γ v̇⁺)``, positions with ``β`` likewise.

    ``γ = 1/2`` has order 2 and no damping, larger ``γ`` order 1.

    Parameters
    ----------
    gamma, beta : ``γ`` and ``β``; unconditionally stable for ``2β ≥ γ ≥ 1/2``

    Raises
    ------
    UnsupportedError
        ``γ`` below 1/2 (unstable) or ``β`` that is not positive; at run time: ``γ = 1/2`` with
        ``Dae(index=3)`` and no projection, where perturbations of accelerations grow.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("oscillator")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=100.0))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=1.0))
    >>> bar.support(a)
    >>> bar.initial(b, ux=1.0)
    >>> motion = da.solve_transient(bar.build(), 50.0, step=0.05, integrator=da.Newmark())
    >>> kinetic, strain = motion["kinetic_energy"], 50 * motion["b.ux"]**2
    >>> bool(abs(kinetic + strain - 50).max() < 1e-9)  # conserves k x²/2
    True
    """

    gamma: float = 0.5
    beta: float = 0.25

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gamma < 0.5 or not self.beta > 0:
            raise UnsupportedError(
                f"Newmark(gamma={self.gamma}, beta={self.beta}): needs gamma ≥ 1/2 (unstable "
                "below) and beta > 0"
            )

    @property
    def convergence_order(self) -> int:
        return 2 if self.gamma == 0.5 else 1

    @property
    def coefficients(self) -> NewmarkCoefficients:
        return NewmarkCoefficients(self.beta, self.gamma)
