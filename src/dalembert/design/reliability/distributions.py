"""Distributions ``x(u)`` of a standard normal variable, accurate far into both tails."""

from __future__ import annotations

import math

import numpy as np

from dalembert.design.reliability.distribution import Distribution, Values, density
from dalembert.options import options


@options
class Normal(Distribution):
    """Normal distribution.

    Parameters
    ----------
    mean, std : mean and standard deviation

    Examples
    --------
    >>> import dalembert as da
    >>> strength, load = da.Normal(mean=10.0, std=2.0), da.Normal(mean=4.0, std=1.5)
    >>> safe = da.reliability(None, "r - s", random={"r": strength, "s": load})
    >>> round(safe.beta, 6)  # 6/√(2² + 1.5²)
    2.4
    """

    mean: float
    std: float

    def __post_init__(self) -> None:
        self._require(self.std > 0, "std must be above zero")

    def from_normal(self, u: Values) -> Values:
        return self.mean + self.std * u

    def to_normal(self, x: Values) -> Values:
        return (x - self.mean) / self.std

    def slope(self, u: Values) -> Values:
        return self.std + 0.0 * u

    @property
    def moments(self) -> tuple[float, float]:
        return self.mean, self.std


@options
class Lognormal(Distribution):
    """Lognormal distribution, ``ln x`` is normal.

    Parameters
    ----------
    mean, std : mean and standard deviation of ``x``

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> yield_stress = da.Lognormal(mean=235e6, std=23.5e6)
    >>> round(float(yield_stress.from_normal(0.0)) * math.sqrt(1.01) / 1e6, 6)  # from the median
    235.0
    """

    mean: float
    std: float

    def __post_init__(self) -> None:
        self._require(self.mean > 0 and self.std > 0, "mean and std must be above zero")

    @property
    def logarithm(self) -> tuple[float, float]:
        """Mean and standard deviation of ``ln x``."""
        spread = math.sqrt(math.log1p((self.std / self.mean) ** 2))
        return math.log(self.mean) - spread**2 / 2, spread

    def from_normal(self, u: Values) -> Values:
        middle, spread = self.logarithm
        return np.exp(middle + spread * u)

    def to_normal(self, x: Values) -> Values:
        middle, spread = self.logarithm
        return (np.log(x) - middle) / spread

    def slope(self, u: Values) -> Values:
        return self.logarithm[1] * self.from_normal(u)

    @property
    def moments(self) -> tuple[float, float]:
        return self.mean, self.std


@options
class Uniform(Distribution):
    """Uniform distribution between two bounds.

    Parameters
    ----------
    lower, upper : bounds

    Examples
    --------
    >>> import dalembert as da
    >>> clearance = da.Uniform(lower=0.01, upper=0.05)
    >>> round(float(clearance.from_normal(0.0)), 6), round(clearance.moments[1]**2 * 12, 6)
    (0.03, 0.0016)
    """

    lower: float
    upper: float

    def __post_init__(self) -> None:
        self._require(self.lower < self.upper, "lower must be below upper")

    def from_normal(self, u: Values) -> Values:
        from scipy.special import ndtr

        return self.lower + (self.upper - self.lower) * ndtr(u)

    def to_normal(self, x: Values) -> Values:
        from scipy.special import ndtri

        low, high = x - self.lower, self.upper - x
        width = self.upper - self.lower
        return np.where(low < high, ndtri(low / width), -ndtri(high / width))

    def slope(self, u: Values) -> Values:
        return (self.upper - self.lower) * density(u)

    @property
    def moments(self) -> tuple[float, float]:
        return (self.lower + self.upper) / 2, (self.upper - self.lower) / math.sqrt(12)


@options
class Weibull(Distribution):
    """Weibull distribution of minima, ``F = 1 − exp(−((x − location)/scale)^shape)``.

    Parameters
    ----------
    scale, shape : positive
    location : lower bound

    Examples
    --------
    >>> import dalembert as da
    >>> life = da.Weibull(scale=1000.0, shape=1.0)  # shape one: exponential
    >>> [round(number, 3) for number in life.moments]
    [1000.0, 1000.0]
    """

    scale: float
    shape: float
    location: float = 0.0

    def __post_init__(self) -> None:
        self._require(self.scale > 0 and self.shape > 0, "scale and shape must be above zero")

    def from_normal(self, u: Values) -> Values:
        from scipy.special import log_ndtr

        return self.location + self.scale * (-log_ndtr(-np.asarray(u))) ** (1 / self.shape)

    def to_normal(self, x: Values) -> Values:
        from scipy.special import ndtri, ndtri_exp

        power = ((x - self.location) / self.scale) ** self.shape
        return np.where(power < 0.5, ndtri(-np.expm1(-power)), -ndtri_exp(-power))

    def slope(self, u: Values) -> Values:
        from scipy.special import log_ndtr

        log = log_ndtr(-np.asarray(u))
        rate = density(u) * np.exp(-log)  # of −ln Φ(−u)
        return self.scale / self.shape * (-log) ** (1 / self.shape - 1) * rate

    @property
    def moments(self) -> tuple[float, float]:
        first, second = (math.gamma(1 + k / self.shape) for k in (1, 2))
        return self.location + self.scale * first, self.scale * math.sqrt(second - first**2)


@options
class Gumbel(Distribution):
    """Gumbel distribution of maxima, ``F = exp(−exp(−(x − mode)/scale))``.

    Parameters
    ----------
    mean, std : mean and standard deviation

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> wind = da.Gumbel(mean=20.0, std=3.0)  # annual maximum
    >>> scale = 3.0 * math.sqrt(6) / math.pi
    >>> mode = 20.0 - 0.5772156649 * scale
    >>> median = float(wind.from_normal(0.0))
    >>> round(math.exp(-math.exp(-(median - mode) / scale)), 6)  # F at the median
    0.5
    """

    mean: float
    std: float

    def __post_init__(self) -> None:
        self._require(self.std > 0, "std must be above zero")

    @property
    def _mode_scale(self) -> tuple[float, float]:
        scale = self.std * math.sqrt(6) / math.pi
        return self.mean - np.euler_gamma * scale, scale

    def from_normal(self, u: Values) -> Values:
        from scipy.special import log_ndtr

        mode, scale = self._mode_scale
        u = np.asarray(u, dtype=float)
        # −ln Φ(u) equals Φ(−u) to rounding above 9, and underflows above 37
        power = log_ndtr(np.minimum(u, 9.0))
        return mode - scale * np.where(u > 9.0, log_ndtr(-u), np.log(-power))

    def to_normal(self, x: Values) -> Values:
        from scipy.special import ndtri, ndtri_exp

        mode, scale = self._mode_scale
        power = np.exp(-(x - mode) / scale)
        return np.where(power < 0.5, -ndtri(-np.expm1(-power)), ndtri_exp(-power))

    def slope(self, u: Values) -> Values:
        from scipy.special import log_ndtr

        u = np.asarray(u, dtype=float)
        log = log_ndtr(np.minimum(u, 9.0))
        moderate = density(u) * np.exp(-log) / -log
        tail = np.exp(-(u**2) / 2 - log_ndtr(-u)) / math.sqrt(2 * math.pi)
        return self._mode_scale[1] * np.where(u > 9.0, tail, moderate)

    @property
    def moments(self) -> tuple[float, float]:
        return self.mean, self.std


@options
class Truncated(Distribution):
    """Truncation of another distribution.

    Parameters
    ----------
    of : distribution that is truncated
    lower, upper : bounds; infinity or None for an open side

    Examples
    --------
    >>> import dalembert as da
    >>> sorted_out = da.Truncated(da.Normal(0.0, 1.0), lower=-1.0, upper=1.0)
    >>> [round(float(sorted_out.from_normal(u)), 3) + 0.0 for u in (-8.0, 0.0, 8.0)]
    [-1.0, 0.0, 1.0]
    """

    of: Distribution
    lower: float | None = None
    upper: float | None = None

    def __post_init__(self) -> None:
        low, high = self._normal_bounds
        self._require(low < high, "lower must be below upper")
        self._require(self._share > 1e-12, "the probability between lower and upper is zero")

    @property
    def _normal_bounds(self) -> tuple[float, float]:
        """The bounds as values of the standard normal variable."""
        with np.errstate(invalid="ignore", divide="ignore"):
            low = -np.inf if self.lower is None else float(self.of.to_normal(self.lower))
            high = np.inf if self.upper is None else float(self.of.to_normal(self.upper))
        return (-np.inf if np.isnan(low) else low), (np.inf if np.isnan(high) else high)

    @property
    def _share(self) -> float:
        """Probability between the bounds."""
        from scipy.special import ndtr

        low, high = self._normal_bounds
        return float(ndtr(-low) - ndtr(-high) if low > 0 else ndtr(high) - ndtr(low))

    def _inner(self, u: Values) -> Values:
        from scipy.special import ndtr, ndtri

        (low, high), share = self._normal_bounds, self._share
        below, above = ndtr(low) + ndtr(u) * share, ndtr(-high) + ndtr(-np.asarray(u)) * share
        return np.where(below < above, ndtri(below), -ndtri(above))

    def from_normal(self, u: Values) -> Values:
        return self.of.from_normal(self._inner(u))

    def to_normal(self, x: Values) -> Values:
        from scipy.special import ndtr, ndtri

        (low, high), share, z = self._normal_bounds, self._share, self.of.to_normal(x)
        below, above = (ndtr(z) - ndtr(low)) / share, (ndtr(-z) - ndtr(-high)) / share
        return np.where(below < above, ndtri(below), -ndtri(above))

    def slope(self, u: Values) -> Values:
        z = self._inner(u)
        return self.of.slope(z) * density(u) * self._share / density(z)
