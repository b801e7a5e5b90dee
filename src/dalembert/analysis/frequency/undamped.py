"""Resonances without damping, at which amplitudes are infinite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

UNDAMPED = 1e-9
"""Damping ratio that counts as none [-]."""
ROUNDING = 1e-13
"""Real part of an undamped eigenvalue, relative to the largest eigenvalue [-]."""
NEAR, FAR = 1e-7, 1e-5
"""Distances from a resonance, relative to its frequency, that show the growth towards it [-]."""
GROWTH = 10.0
"""Ratio of the values at these distances from which a resonance is infinite [-]."""


def undamped_poles(poles: np.ndarray) -> np.ndarray:
    """Whether each eigenvalue is that of an oscillation without damping."""
    limit = UNDAMPED * np.abs(poles) + ROUNDING * np.abs(poles).max(initial=0.0)
    return (poles.imag > 0) & (np.abs(poles.real) <= limit)  # type: ignore[no-any-return]


def undamped_frequencies(system: Any, low: float, high: float) -> np.ndarray:
    """Undamped resonances [Hz] of a linear system in a span [Hz]."""
    if not getattr(system, "is_undamped", True):
        return np.zeros(0)
    poles = system.poles_up_to(high) if hasattr(system, "poles_up_to") else system.poles
    frequencies = np.unique(poles[undamped_poles(poles)].imag) / (2 * np.pi)
    return frequencies[(frequencies >= low) & (frequencies <= high)]


def grows(values: Callable[[np.ndarray], np.ndarray], frequency: float) -> bool:
    """Whether positive values of the frequency grow without limit towards a resonance."""
    near, far = np.abs(values(frequency * (1 + np.array([NEAR, FAR]))))
    return bool(near > GROWTH * far)


def undamped_warnings(response: Any) -> tuple[str, ...]:
    """Warning about local maxima of outputs that are infinite."""
    f = response.frequencies
    if f.size < 3 or not (places := undamped_frequencies(response.record, f[0], f[-1])).size:
        return ()
    sizes = np.abs(response.table)
    tops = (sizes[1:-1] > sizes[:-2]) & (sizes[1:-1] >= sizes[2:])
    infinite = []
    for place in places:
        k = int(np.clip(np.searchsorted(f, place), 1, f.size - 1))
        around = tops[max(k - 2, 0) : k].any(axis=0)
        if around.any():
            infinite.append(f"{place:.6g} Hz")
    if not infinite:
        return ()
    more = f" and {len(infinite) - 5} more" if len(infinite) > 5 else ""
    return (
        f"no damping acts on the resonance at {', '.join(infinite[:5])}{more}: amplitudes are "
        "infinite there, and values nearby depend on the frequencies",
    )
