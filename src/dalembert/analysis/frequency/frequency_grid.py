"""Frequencies that resolve resonances, and exact maxima between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.frequency.undamped import undamped_poles

PER_DECADE = 60
"""Frequencies of the uniform grid."""
ACROSS = 44
"""Frequencies on each side of a resonance."""
WIDEST = 300.0
"""Half width of a resonance grid in half-power half widths [-]."""
NARROWEST = 1e-6
"""Smallest damping ratio that the grid resolves [-]."""
GAP = 1e-8
"""Distance of default frequencies from an undamped resonance, relative to its frequency [-]."""
MARGIN = 3.0
"""Ratio of the ends of the default span to the lowest and the highest frequency [-]."""
MANY = 25
"""Upper limit of the resonances of the default span."""
CLOSE = 1e-4
"""Step of the search by values that is small enough, relative to the first bracket [-]."""
REACH = 100.0
"""Largest error of the search by values, in steps that are small enough [-]."""
ROUNDS = 3
"""Steps of the secant method for the root of the slope."""
MOST_STEPS = 25
"""Upper limit of its steps."""


def default_frequencies(poles: np.ndarray, span: tuple[float, float] | None) -> np.ndarray:
    """Frequencies [Hz], logarithmic and denser at resonances; undamped ones are left out.

    Parameters
    ----------
    poles : eigenvalues [1/s]
    span : first and last frequency [Hz]; by default around the lowest 25 resonances
    """
    natural = np.sort(np.abs(poles[poles.imag > 0]))
    natural = natural if natural.size else np.sort(np.abs(poles[np.abs(poles) > 0]))
    if span is None:
        lowest = natural[0] if natural.size else 1.0
        highest = natural[min(natural.size, MANY) - 1] if natural.size else 1.0
        span = lowest / MARGIN / (2 * np.pi), highest * MARGIN / (2 * np.pi)
    low, high = span
    first = low if low > 0 else high * 1e-3
    count = max(2, int(np.ceil(PER_DECADE * np.log10(high / first))) + 1)
    grid = [np.geomspace(first, high, count), np.array([low, high])]
    oscillating = poles.imag > 0
    for pole, undamped in zip(poles[oscillating], undamped_poles(poles)[oscillating], strict=True):
        centre, size = pole.imag / (2 * np.pi), np.abs(pole) / (2 * np.pi)
        half = max(abs(pole.real) / (2 * np.pi), NARROWEST * size)
        reach = min(WIDEST, max(1.0, size / (3 * half)))
        if half < size / 3:
            offsets = half * np.sinh(np.linspace(0, np.arcsinh(reach), ACROSS + 1))
            grid.append(centre + np.concatenate([-offsets[1:], offsets[int(undamped) :]]))
    frequencies = np.unique(np.concatenate(grid))
    for centre in poles[undamped_poles(poles)].imag / (2 * np.pi):
        frequencies = frequencies[np.abs(frequencies - centre) > GAP * centre]
    inside = frequencies[(frequencies >= low) & (frequencies <= high)]
    return inside[np.diff(inside, prepend=-1.0) > 1e-12 * high]


def local_maxima(values: np.ndarray) -> np.ndarray:
    """Numbers of the samples that are local maxima, without the ends."""
    inner = values[1:-1]
    return np.flatnonzero((inner > values[:-2]) & (inner >= values[2:])) + 1


def refined_maxima(
    frequencies: np.ndarray,
    values: np.ndarray,
    tops: np.ndarray,
    evaluate: Callable[[np.ndarray], np.ndarray],
    slope: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Frequencies of local maxima of a function.

    Parameters
    ----------
    frequencies, values : (K,) samples, by increasing frequency
    tops : numbers of samples that are local maxima
    evaluate, slope : frequencies → values, and their derivatives
    """
    if not tops.size:
        return np.zeros(0)
    x = np.array([frequencies[tops - 1], frequencies[tops], frequencies[tops + 1]])
    y = np.array([values[tops - 1], values[tops], values[tops + 1]])
    width = x[2] - x[0]
    for _ in range(MOST_STEPS):
        trial = _vertex(x, y)
        step = np.abs(trial - x[1])
        if np.all(step <= CLOSE * width):
            return _stationary(trial, CLOSE * width, slope)
        x, y = _narrowed(x, y, trial, evaluate(trial))
    return _stationary(x[1], CLOSE * width, slope)


def _stationary(
    x: np.ndarray, near: np.ndarray, slope: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """Roots of the slope, which round-off does not blur like the maximum, by the secant method."""
    other, last = x + near / 10, slope(x + near / 10)
    start = x
    for _ in range(ROUNDS):
        rise = slope(x)
        change = last - rise
        step = np.divide(-rise * (other - x), change, out=np.zeros_like(x), where=change != 0)
        other, last = x, rise
        x = x + np.clip(step, start - REACH * near - x, start + REACH * near - x)
    return x


def _vertex(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Vertices of the parabolas through ``1/y²`` of three points each (3, k), within the bracket.

    Near a resonance the inverse square of an amplitude is a parabola.
    """
    positive = np.all(y > 0, axis=0)
    inverse = np.where(positive, 1 / np.where(positive, y, 1.0) ** 2, -y)
    left, right = x[1] - x[0], x[2] - x[1]
    rise, fall = inverse[0] - inverse[1], inverse[2] - inverse[1]
    bend = rise * right + fall * left
    shift = np.divide(
        rise * right**2 - fall * left**2, 2 * bend, out=np.zeros_like(bend), where=bend > 0
    )
    inside = np.clip(shift, -0.9 * left, 0.9 * right)
    return x[1] + inside


def _narrowed(
    x: np.ndarray, y: np.ndarray, trial: np.ndarray, value: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Brackets of three points (3, k) with the trial point in place of an end."""
    points = np.sort(np.array([*x, trial]), axis=0)
    order = np.argsort(np.array([*x, trial]), axis=0)
    values = np.take_along_axis(np.array([*y, value]), order, axis=0)
    top = np.clip(np.argmax(values, axis=0), 1, 2)
    rows = top + np.arange(-1, 2)[:, None]
    return np.take_along_axis(points, rows, axis=0), np.take_along_axis(values, rows, axis=0)
