"""Validated Butcher tableaux of explicit Runge–Kutta methods."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import fsum, sqrt

import numpy as np

from dalembert.errors import UnsupportedError

ROUNDING = 1e-13
"""Tolerance for rounding of published coefficients [-]."""


@dataclass(frozen=True)
class ButcherTableau:
    """Explicit Runge–Kutta method.

    ``k_i = F(t + c_i h, x + h Σ a_ij k_j)``, ``x⁺ = x + h Σ b_i k_i``; the error estimate is
    ``e = h Σ b_error_i k_i``. With a second estimate ``e_low`` of lower order, the two combine in
    the norm and not component by component (Hairer, Nørsett and Wanner 1993, II.10):
    ``err = ‖e‖² / √(‖e‖² + 0.01 ‖e_low‖²)`` with ``‖e‖² = (1/n) Σ (e_i / s_i)²``,
    ``s_i = atol + rtol max(|x_i|, |x⁺_i|)``, and 0 where both norms are 0.

    Parameters
    ----------
    a : rows of the strictly lower triangle
    b, c : weights and nodes
    order : of the advanced solution
    b_error : weights of the error estimate (solution minus embedded solution), if any
    b_error_low : weights of the second estimate, by an embedded solution of lower order, if any
    error_order : ``q`` if the estimate by all error weights is of order ``h^(q+1)``, so that step
        lengths follow ``err^(−1/(q+1))``

    Raises
    ------
    UnsupportedError
        Wrong numbers of coefficients, row sums other than the nodes, weights that do not sum to 1,
        error weights that do not sum to 0 or lack ``error_order``.
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    order: int
    b_error: tuple[float, ...] | None = None
    b_error_low: tuple[float, ...] | None = None
    error_order: int | None = None

    def __post_init__(self) -> None:
        lengths = [len(row) for row in self.a]
        if lengths != list(range(1, self.stages)) or len(self.c) != self.stages:
            raise UnsupportedError(
                f"tableau: {self.stages} weights need rows of lengths 1…{self.stages - 1} and as "
                f"many nodes, not rows of lengths {lengths} and {len(self.c)} nodes"
            )
        rows = [fsum(row) for row in ((), *self.a)]
        if not np.allclose(rows, self.c, rtol=0, atol=ROUNDING):
            raise UnsupportedError(f"tableau: row sums {rows} differ from nodes {self.c}")
        if abs(fsum(self.b) - 1) > ROUNDING:
            raise UnsupportedError(f"tableau: weights sum to {fsum(self.b)}, not 1")
        self._check_estimates()

    def _check_estimates(self) -> None:
        for name in ("b_error", "b_error_low"):
            weights = getattr(self, name)
            if weights is None:
                continue
            if len(weights) != self.stages:
                raise UnsupportedError(
                    f"tableau: {name} has {len(weights)} weights for {self.stages} stages"
                )
            if abs(fsum(weights)) > ROUNDING:
                raise UnsupportedError(f"tableau: {name} sums to {fsum(weights)}, not 0")
        if self.b_error is None and self.b_error_low is not None:
            raise UnsupportedError("tableau: b_error_low needs b_error")
        if (self.b_error is None) != (self.error_order is None):
            raise UnsupportedError("tableau: give b_error and error_order, or neither")

    @property
    def stages(self) -> int:
        return len(self.b)

    @cached_property
    def _stability_coefficients(self) -> np.ndarray:
        """``1, bᵀ1, bᵀA1, bᵀA²1, …``: powers of z beyond the number of stages vanish."""
        a = np.zeros((self.stages, self.stages))
        for i, row in enumerate(self.a, start=1):
            a[i, :i] = row
        power, coefficients = np.ones(self.stages), [1.0]
        for _ in range(self.stages):
            coefficients.append(float(np.dot(self.b, power)))
            power = a @ power
        return np.array(coefficients)

    def stability(self, z: complex | np.ndarray) -> np.ndarray:
        """Stability function ``R(z) = 1 + z bᵀ(I − zA)⁻¹1``, a polynomial for explicit methods.

        A step of ``ẋ = λx`` multiplies by ``R(hλ)``: solutions grow where ``|R(hλ)| > 1``.

        Parameters
        ----------
        z : step length times eigenvalue, any shape [-]

        Returns
        -------
        array of complex numbers of the shape of ``z``
        """
        z = np.asarray(z, dtype=complex)
        return np.polynomial.polynomial.polyval(z, self._stability_coefficients)


EXPLICIT_EULER = ButcherTableau(a=(), b=(1,), c=(0,), order=1)
"""Euler (1768)."""

HEUN = ButcherTableau(a=((1,),), b=(1 / 2, 1 / 2), c=(0, 1), order=2)
"""Heun (1900), the explicit trapezoidal rule."""

CLASSICAL = ButcherTableau(
    a=((1 / 2,), (0, 1 / 2), (0, 0, 1)),
    b=(1 / 6, 1 / 3, 1 / 3, 1 / 6),
    c=(0, 1 / 2, 1 / 2, 1),
    order=4,
)
"""Kutta (1901)."""

_R = sqrt(2)
GILL = ButcherTableau(
    a=((1 / 2,), ((_R - 1) / 2, (2 - _R) / 2), (0, -_R / 2, (2 + _R) / 2)),
    b=(1 / 6, (2 - _R) / 6, (2 + _R) / 6, 1 / 6),
    c=(0, 1 / 2, 1 / 2, 1),
    order=4,
)
"""Gill (1951)."""

_B5 = (35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0)
_B4 = (5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40)
DORMAND_PRINCE = ButcherTableau(
    a=(
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        _B5[:6],
    ),
    b=_B5,
    c=(0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1),
    order=5,
    b_error=tuple(x - y for x, y in zip(_B5, _B4, strict=True)),
    error_order=4,
)
"""Dormand and Prince (1980), 5(4)."""


_A = (
    (0.05260015195876773,),
    (0.0197250569845379, 0.0591751709536137),
    (0.02958758547680685, 0, 0.08876275643042054),
    (0.2413651341592667, 0, -0.8845494793282861, 0.924834003261792),
    (0.037037037037037035, 0, 0, 0.17082860872947386, 0.12546768756682242),
    (0.037109375, 0, 0, 0.17025221101954405, 0.06021653898045596, -0.017578125),
    (
        0.03709200011850479,
        0,
        0,
        0.17038392571223998,
        0.10726203044637328,
        -0.015319437748624402,
        0.008273789163814023,
    ),
    (
        0.6241109587160757,
        0,
        0,
        -3.3608926294469414,
        -0.868219346841726,
        27.59209969944671,
        20.154067550477894,
        -43.48988418106996,
    ),
    (
        0.47766253643826434,
        0,
        0,
        -2.4881146199716677,
        -0.590290826836843,
        21.230051448181193,
        15.279233632882423,
        -33.28821096898486,
        -0.020331201708508627,
    ),
    (
        -0.9371424300859873,
        0,
        0,
        5.186372428844064,
        1.0914373489967295,
        -8.149787010746927,
        -18.52006565999696,
        22.739487099350505,
        2.4936055526796523,
        -3.0467644718982196,
    ),
    (
        2.273310147516538,
        0,
        0,
        -10.53449546673725,
        -2.0008720582248625,
        -17.9589318631188,
        27.94888452941996,
        -2.8589982771350235,
        -8.87285693353063,
        12.360567175794303,
        0.6433927460157636,
    ),
)
_C = (
    0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1,
)
_B = (
    0.054293734116568765,
    0,
    0,
    0,
    0,
    4.450312892752409,
    1.8915178993145003,
    -5.801203960010585,
    0.3111643669578199,
    -0.1521609496625161,
    0.20136540080403034,
    0.04471061572777259,
)
_B_ERROR = (
    0.01312004499419488,
    0,
    0,
    0,
    0,
    -1.2251564463762044,
    -0.4957589496572502,
    1.6643771824549864,
    -0.35032884874997366,
    0.3341791187130175,
    0.08192320648511571,
    -0.022355307863886294,
)
_B3 = (0.2440944881889764, 0, 0, 0, 0, 0, 0, 0, 0.7338466882816119, 0, 0, 0.022058823529411766)
"""Embedded solution of order 3."""

DORMAND_PRINCE_853 = ButcherTableau(
    a=_A,
    b=_B,
    c=_C,
    order=8,
    b_error=_B_ERROR,
    b_error_low=tuple(x - y for x, y in zip(_B, _B3, strict=True)),
    error_order=7,
)
"""Hairer, Nørsett and Wanner (1993), II.10, after Dormand and Prince: 12 stages, order 8 with
estimates of orders 5 and 3, which together fall as ``(h⁶)² / h⁴ = h⁸``."""
