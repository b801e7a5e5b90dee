"""Newmark family of integrators: Newmark, generalised-α and HHT methods."""

from __future__ import annotations

from abc import ABC, abstractmethod

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import ImplicitIntegrator, Problem
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
        ``DAE(index=3)`` and no projection, where perturbations of accelerations grow.

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


@options
class GeneralizedAlpha(NewmarkFamily):
    """Generalised-α (Chung and Hulbert 1993) for constrained systems (Arnold and Brüls 2007).

    ``α_m = (2ρ − 1)/(ρ + 1)``, ``α_f = ρ/(ρ + 1)``, ``γ = 1/2 − α_m + α_f``, ``β = (γ + 1/2)²/4``:
    oscillations much faster than the step shrink to ``ρ`` times in every step.

    Parameters
    ----------
    rho_inf : ``ρ`` from 0 (asymptotic annihilation) to 1 (no damping) [-]

    Raises
    ------
    UnsupportedError
        ``ρ`` outside 0…1.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> implicit = dict(formulation=da.DAE(index=3), integrator=da.GeneralizedAlpha(rho_inf=0.8))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.01, **implicit)
    >>> bool(motion["position_violation"].max() < 1e-9), motion["balance_error"][-1].item() < 1e-3
    (True, True)
    """

    rho_inf: float = 0.8

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.rho_inf <= 1:
            raise UnsupportedError(
                f"GeneralizedAlpha(rho_inf={self.rho_inf}): the spectral radius at infinite "
                "frequency is between 0 and 1"
            )

    @property
    def coefficients(self) -> NewmarkCoefficients:
        rho = self.rho_inf
        return _second_order((2 * rho - 1) / (rho + 1), rho / (rho + 1))


@options
class HHT(NewmarkFamily):
    """Hilber, Hughes and Taylor (1977): ``α_f = α``, ``γ = 1/2 + α``, ``β = (1 + α)²/4``.

    The spectral radius at infinite frequency is ``(1 − α)/(1 + α)``. Some texts write ``−α``.

    Parameters
    ----------
    alpha : 0 (no damping) to 1/3 [-]

    Raises
    ------
    UnsupportedError
        ``α`` outside 0…1/3.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bar = da.Structure("stiff oscillator")
    >>> a, b = bar.node("a", 0), bar.node("b", 1)
    >>> spring = bar.add(structures.AxialSpring("spring", a, b, stiffness=1e8))
    >>> mass = bar.add(structures.PointMass("mass", b, mass=1.0))
    >>> bar.support(a)
    >>> bar.initial(b, ux=1.0)
    >>> motion = da.solve_transient(bar.build(), 5.0, step=0.05, integrator=da.HHT(alpha=0.1))
    >>> bool(abs(motion["b.ux"][-1]) < 1e-6)  # high frequencies are damped out
    True
    """

    alpha: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.alpha <= 1 / 3:
            raise UnsupportedError(
                f"HHT(alpha={self.alpha}): alpha is between 0 and 1/3 (texts with negative alpha "
                "use the opposite sign)"
            )

    @property
    def coefficients(self) -> NewmarkCoefficients:
        return _second_order(0.0, self.alpha)


def _second_order(alpha_m: float, alpha_f: float) -> NewmarkCoefficients:
    gamma = 0.5 - alpha_m + alpha_f
    return NewmarkCoefficients((gamma + 0.5) ** 2 / 4, gamma, alpha_m, alpha_f)
