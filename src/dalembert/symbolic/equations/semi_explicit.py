"""Semi-explicit differential-algebraic systems."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.symbolic.equations.implicit import ImplicitFunction


@dataclass(frozen=True, eq=False)
class Sizes:
    """Natural sizes of the variables and equations of a system.

    Attributes
    ----------
    time : [s]
    states, algebraic : (n,), (k,) of the variables
    rows : (k,) of the algebraic equations
    """

    time: float
    states: np.ndarray
    algebraic: np.ndarray
    rows: np.ndarray

    @property
    def rates(self) -> np.ndarray:
        """(n,) of the rates of the states."""
        return self.states / self.time


@dataclass(frozen=True, eq=False)
class SemiExplicit:
    """``ẋ = F(t, x, z, p)``, ``0 = G(t, x, z, p)``.

    Attributes
    ----------
    t, x, z, p : SX symbols: time, differential and algebraic variables, parameters
    rate : SX, ``F``
    algebraic : SX, ``G``, as many equations as ``z``
    depth : per equation of ``G``, the number of differentiations until accelerations appear:
        0 for dynamic equations, 1 for velocity and 2 for position constraints; with a step size
        h they are scaled by ``h^-depth``
    lag : per entry of ``z``, the same for the variable: 0 for accelerations and forces, 1 for the
        ``μ`` that shifts speeds; it is scaled by ``h^lag``
    index : differentiation index
    start : ``(t, x, p) → z``, consistent algebraic variables
    sizes : natural sizes; one by default
    """

    t: ca.SX
    x: ca.SX
    z: ca.SX
    p: ca.SX
    rate: ca.SX
    algebraic: ca.SX
    depth: tuple[int, ...]
    lag: tuple[int, ...]
    index: int
    start: ImplicitFunction
    sizes: Sizes = field(default=None)  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if self.sizes is None:
            ones = (np.ones(n.numel()) for n in (self.x, self.z, self.algebraic))
            object.__setattr__(self, "sizes", Sizes(1.0, *ones))
