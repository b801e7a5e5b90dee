"""Cross spectral densities of correlated inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.frequency.spectral_density import Density, frequency_function
from dalembert.errors import AnalysisError
from dalembert.results.coherence import Pair

COHERENCE = frozenset({"coherence", "delay"})
PARTS = frozenset({"real", "imag"})
REMEDY = (
    "give a number, a complex number, a formula of f, {'real': .., 'imag': ..} or "
    "{'coherence': .., 'delay': .. in s}"
)


@dataclass(frozen=True)
class CrossDensity:
    """One-sided cross spectral density ``S_ab``, the density of ``A* B``.

    Attributes
    ----------
    values : frequencies (K,) [Hz] → complex (K,)
    delay : time by which the second input follows the first [s]
    """

    values: Callable[[np.ndarray], np.ndarray]
    delay: float = 0.0

    def __call__(self, frequencies: np.ndarray) -> np.ndarray:
        values = np.asarray(self.values(frequencies), dtype=complex) * np.ones(frequencies.size)
        if not np.all(np.isfinite(values)):
            raise AnalysisError("a cross spectral density is not finite")
        return values


def pair_of(key: Any) -> Pair | None:
    """The inputs of a key ``("a", "b")`` or ``"a, b"``; None for the key of a single input.

    Raises
    ------
    AnalysisError
        Not two different names.
    """
    if isinstance(key, str) and "," not in key:
        return None
    names = tuple(part.strip() for part in key.split(",")) if isinstance(key, str) else key
    whole = isinstance(names, tuple) and len(names) == 2 and all(isinstance(n, str) for n in names)
    if not whole or names[0] == names[1]:
        raise AnalysisError(
            f"RandomResponse: psd has the key {key!r:.60}; give the name of an input, or of two "
            "inputs for their cross density, ('a', 'b')"
        )
    return names  # type: ignore[return-value]


def cross_density_of(pair: Pair, entry: Any, own: Mapping[str, Density]) -> CrossDensity:
    """Cross density from a number, a formula of ``f``, a function, or a table.

    ``{"coherence": γ², "delay": T}`` is ``S_ab = γ √(S_a S_b) exp(−i 2π f T)``, so that the second
    input follows the first, such as the rear wheel the front wheel.

    Raises
    ------
    AnalysisError
        Another type.
    """
    name = ", ".join(pair)
    if isinstance(entry, Mapping):
        keys = set(entry)
        if keys and keys <= COHERENCE:
            return _coherent(name, entry, [own[one] for one in pair])
        if keys and keys <= PARTS:
            parts = [_function(name, entry.get(part, 0.0)) for part in ("real", "imag")]
            return CrossDensity(lambda f: parts[0](f) + 1j * parts[1](f))
        raise AnalysisError(_wrong(name, entry))
    return CrossDensity(_function(name, entry))


def _coherent(name: str, entry: Mapping[str, Any], own: list[Density]) -> CrossDensity:
    """Density of a coherence and a delay."""
    squared, delay = _function(name, entry.get("coherence", 1.0)), entry.get("delay", 0.0)
    if isinstance(delay, bool) or not isinstance(delay, (int, float)) or not np.isfinite(delay):
        raise AnalysisError(f"RandomResponse: psd[{name}].delay is {delay!r:.60}; give seconds")

    def values(f: np.ndarray) -> np.ndarray:
        share = squared(f)
        if np.any(np.imag(share) != 0) or np.any(share.real < 0) or np.any(share.real > 1):
            raise AnalysisError(f"psd[{name}].coherence is not between 0 and 1")
        size = np.sqrt(share.real * own[0](f) * own[1](f))
        return np.asarray(size * np.exp(-2j * np.pi * f * delay))

    return CrossDensity(values, float(delay))


def _function(name: str, entry: Any) -> Callable[[np.ndarray], np.ndarray]:
    """frequencies → complex values of a number, a formula or a function."""
    if isinstance(entry, str):
        formula = frequency_function(name, entry)
        return lambda f: formula(f).astype(complex)
    if callable(entry):
        return lambda f: np.asarray(entry(f), dtype=complex) * np.ones(f.size)
    number = isinstance(entry, (int, float, complex, np.number)) and not isinstance(entry, bool)
    if not (number and np.isfinite(entry)):
        raise AnalysisError(_wrong(name, entry))
    return lambda f: np.full(f.size, complex(entry))


def _wrong(name: str, entry: Any) -> str:
    return f"RandomResponse: psd[{name}] is {entry!r:.60}; {REMEDY}"
