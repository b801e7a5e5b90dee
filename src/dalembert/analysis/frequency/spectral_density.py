"""Spectral densities of inputs, and quadrature over lightly damped resonances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula

PANELS = 4
"""Panels of a decade away from resonances."""
GRADED = 9
"""Panels on each side of a resonance."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)
BEYOND = 30.0
"""Ratio of the first frequency of the tail to the highest resonance [-]."""


@dataclass(frozen=True)
class Density:
    """One-sided spectral density of an input.

    Attributes
    ----------
    values : frequencies (K,) [Hz] → (K,)
    breaks : frequencies at which it is not smooth [Hz]
    limits : band outside of which it is zero [Hz]
    """

    values: Callable[[np.ndarray], np.ndarray]
    breaks: tuple[float, ...] = ()
    limits: tuple[float, float] = (0.0, np.inf)

    def __call__(self, frequencies: np.ndarray) -> np.ndarray:
        low, high = self.limits
        inside = (frequencies >= low) & (frequencies <= high)
        values = np.zeros(frequencies.size)
        values[inside] = self.values(frequencies[inside])
        if np.any(values < 0) or not np.all(np.isfinite(values)):
            raise AnalysisError("a spectral density is negative or not finite")
        return values


def density_of(name: str, entry: Any) -> Density:
    """Spectral density from a number, a formula of ``f``, a table or a function.

    A table has frequencies and densities, ``{"frequency": [..], "density": [..]}`` or two rows;
    between its points logarithms are interpolated linearly, outside it is zero.

    Raises
    ------
    AnalysisError
        Another type, or numbers that are negative or not increasing.
    """
    if isinstance(entry, bool) or entry is None:
        raise AnalysisError(_wrong(name, entry))
    if isinstance(entry, (int, float, np.number)):
        level = float(entry)
        if not (level >= 0 and np.isfinite(level)):
            raise AnalysisError(_wrong(name, entry))
        return Density(lambda f: np.full(f.size, level))
    if isinstance(entry, str):
        return Density(frequency_function(name, entry))
    if callable(entry):
        return Density(lambda f: np.asarray(entry(f), dtype=float) * np.ones(f.size))
    return _table(name, entry)


def _wrong(name: str, entry: Any) -> str:
    return (
        f"psd.{name} is {entry!r:.60}; give a number ≥ 0, a formula of the frequency f such as "
        "'1e-3/(1 + (f/10)**2)', or {'frequency': [..], 'density': [..]}"
    )


def frequency_function(name: str, text: str) -> Callable[[np.ndarray], np.ndarray]:
    """frequencies (K,) → values (K,) of a formula of ``f``.

    Raises
    ------
    AnalysisError
        The formula is wrong.
    """
    f = Expression(ca.SX.sym("f"), "f", "Hz")
    try:
        formula = parse_formula(text, {"f": f}.get, lambda: ["f"])
    except ExpressionError as error:
        raise AnalysisError(f"psd.{name}: {error}") from None
    function = ca.Function("density", [f.sx], [formula.sx])

    def values(frequencies: np.ndarray) -> np.ndarray:
        if not frequencies.size:
            return frequencies
        return function.map(frequencies.size)(frequencies).full().ravel()  # type: ignore[no-any-return]

    return values


def _table(name: str, entry: Any) -> Density:
    try:
        columns = (entry["frequency"], entry["density"]) if isinstance(entry, Mapping) else entry
        f, s = (np.asarray(column, dtype=float).ravel() for column in columns)
    except (KeyError, TypeError, ValueError):
        raise AnalysisError(_wrong(name, entry)) from None
    if f.size < 2 or f.size != s.size or not np.all(np.diff(f) > 0) or f[0] <= 0 or np.any(s <= 0):
        raise AnalysisError(
            f"psd.{name}: a table has increasing frequencies above 0 and as many densities above 0"
        )

    def values(frequencies: np.ndarray) -> np.ndarray:
        return np.exp(np.interp(np.log(frequencies), np.log(f), np.log(s)))

    return Density(values, tuple(f), (float(f[0]), float(f[-1])))


def quadrature(
    poles: np.ndarray,
    band: tuple[float, float],
    breaks: Sequence[float] = (),
    widest: float = np.inf,
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights [Hz] of Gauss–Legendre panels that are graded towards resonances.

    An unbounded band ends with the panel ``f = F/x`` of the tail.

    Parameters
    ----------
    poles : eigenvalues [1/s]
    band : first and last frequency [Hz], the last may be infinite
    breaks : further ends of panels [Hz]
    widest : upper limit of the width of a panel [Hz]
    """
    low, high = band
    sizes = np.abs(poles)[np.abs(poles) > 0] / (2 * np.pi)
    top = high if np.isfinite(high) else BEYOND * max([*sizes, *breaks, 1e-300])
    first = min([*sizes, *(b for b in breaks if b > 0), top]) / BEYOND
    first = low if low > 0 else first
    count = max(1, int(np.ceil(PANELS * np.log10(top / first))))
    edges = [np.array([low, top]), np.geomspace(first, top, count + 1), np.array(breaks)]
    for pole in poles[poles.imag > 0]:
        centre, half = pole.imag / (2 * np.pi), max(-pole.real, 1e-9 * abs(pole)) / (2 * np.pi)
        reach = np.arcsinh(max(1.0, abs(pole) / (2 * np.pi) / half))
        levels = max(GRADED, int(np.ceil(1.2 * reach)))
        offsets = half * np.sinh(np.linspace(0, reach, levels + 1))
        edges.append(centre + np.concatenate([-offsets[1:], offsets]))
    ends = np.unique(np.concatenate(edges))
    ends = ends[(ends >= low) & (ends <= top)]
    if np.isfinite(widest):
        parts = np.maximum(1, np.ceil(np.diff(ends) / widest)).astype(int)
        starts = [
            np.linspace(a, b, n, False) for a, b, n in zip(ends[:-1], ends[1:], parts, strict=True)
        ]
        ends = np.concatenate([*starts, ends[-1:]])
    width = np.diff(ends)
    nodes = (ends[:-1, None] + width[:, None] * (NODES + 1) / 2).ravel()
    weights = (width[:, None] * WEIGHTS / 2).ravel()
    if np.isfinite(high):
        return nodes, weights
    x, dx = (NODES[::-1] + 1) / 2, WEIGHTS[::-1] / 2  # f = top/x
    return np.concatenate([nodes, top / x]), np.concatenate([weights, dx * top / x**2])
