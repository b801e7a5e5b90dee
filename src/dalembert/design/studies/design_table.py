"""Tables of designs: grids, space-filling samples, Monte Carlo samples, custom tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.options import RandomSource, random_generator
from dalembert.text.arguments import CheckedArguments
from dalembert.units.measured import measured

if TYPE_CHECKING:
    import pandas as pd

Ranges = Mapping[str, Sequence[float]]
"""Parameter → lower and upper bound."""
MAX_DESIGNS = 10_000_000
"""Upper limit of the designs in a table."""


@dataclass(frozen=True, eq=False)
class DesignTable(CheckedArguments):
    """Table of parameter values, one row per design.

    Attributes
    ----------
    names : of the k parameters
    values : (n, k)
    specified : parameter → its values as specified, with units

    Examples
    --------
    >>> import dalembert as da
    >>> grid = da.DesignTable.grid({"length": [0.5, 1.0], "mass": [1.0, 2.0, 3.0]})
    >>> len(grid), grid.values[1].tolist()
    (6, [0.5, 2.0])
    >>> spread = da.DesignTable.latin_hypercube({"length": (0, 1)}, count=4, rng=1)
    >>> sorted(int(4 * x) for x in spread.values[:, 0])  # one in every quarter
    [0, 1, 2, 3]
    """

    names: tuple[str, ...]
    values: np.ndarray
    specified: Mapping[str, Sequence[float] | np.ndarray] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        if not self.names:
            raise AnalysisError("a design needs at least one parameter")
        if len(set(self.names)) < len(self.names):
            raise AnalysisError(f"a parameter is named twice: {', '.join(self.names)}")
        values = np.asarray(self.values, dtype=float)
        if values.ndim != 2 or values.shape[1] != len(self.names) or not len(values):
            raise AnalysisError(
                f"a table of designs has one row per design and one column for each of "
                f"{', '.join(self.names)}; got the shape {values.shape}"
            )
        if not np.all(np.isfinite(values)):
            row, column = np.argwhere(~np.isfinite(values))[0]
            raise AnalysisError(f"design {row}: {self.names[column]} is {values[row, column]}")
        object.__setattr__(self, "values", values)

    def __len__(self) -> int:
        return len(self.values)

    @classmethod
    def grid(cls, axes: Mapping[str, Sequence[float]]) -> DesignTable:
        """All combinations of the values of each parameter; the last varies fastest."""
        count = int(np.prod([float(np.size(v)) for v in axes.values()])) if axes else 0
        if count > MAX_DESIGNS:
            raise AnalysisError(f"the grid has {count} designs, more than {MAX_DESIGNS}; use fewer")
        values_by_name = _parse_units(axes)
        mesh = np.meshgrid(
            *(np.asarray(v, dtype=float) for v in values_by_name.values()), indexing="ij"
        )
        values: Any = np.stack([m.ravel() for m in mesh], axis=1) if axes else mesh
        return cls(tuple(axes), values, values_by_name)

    @classmethod
    def latin_hypercube(cls, ranges: Ranges, count: int, rng: RandomSource = None) -> DesignTable:
        """One design in each of ``count`` slices of every range (McKay, Beckman, Conover 1979)."""
        from scipy.stats import qmc

        sampler = qmc.LatinHypercube(len(ranges), rng=random_generator(rng))
        return cls._from_unit_cube(ranges, sampler.random(_checked_count(count)))

    @classmethod
    def sobol(cls, ranges: Ranges, count: int, rng: RandomSource = None) -> DesignTable:
        """Scrambled Sobol' points; best where ``count`` is a power of two."""
        from scipy.stats import qmc

        sampler = qmc.Sobol(len(ranges), rng=random_generator(rng))
        power_of_two = 2 ** int(np.ceil(np.log2(_checked_count(count))))
        return cls._from_unit_cube(ranges, sampler.random(power_of_two)[:count])

    @classmethod
    def monte_carlo(
        cls, distributions: Mapping[str, Any], count: int, rng: RandomSource = None
    ) -> DesignTable:
        """Independent random values, each of a frozen ``scipy.stats`` distribution or a range."""
        generator = random_generator(rng)
        columns = []
        for name, distribution in distributions.items():
            if hasattr(distribution, "rvs"):
                columns.append(distribution.rvs(size=_checked_count(count), random_state=generator))
            else:
                lower, upper = _checked_range(name, _parse_units({name: distribution})[name])
                columns.append(generator.uniform(lower, upper, _checked_count(count)))
        ranges = {name: v for name, v in distributions.items() if not hasattr(v, "rvs")}
        table = cls.table(dict(zip(distributions, columns, strict=True)))
        return cls(table.names, table.values, _parse_units(ranges))

    @classmethod
    def table(cls, columns: Mapping[str, ArrayLike] | pd.DataFrame) -> DesignTable:
        """Custom designs: parameter → its values, or a DataFrame."""
        numbers = _parse_units({str(name): columns[name] for name in columns})
        arrays = {name: np.asarray(values, dtype=float) for name, values in numbers.items()}
        if len({column.size for column in arrays.values()}) > 1:
            sizes = ", ".join(f"{name} {column.size}" for name, column in arrays.items())
            raise AnalysisError(f"columns of a table must have the same length, got {sizes}")
        values = np.stack(list(arrays.values()), axis=1) if arrays else np.zeros((0, 0))
        return cls(tuple(arrays), values, numbers)

    @classmethod
    def _from_unit_cube(cls, ranges: Ranges, unit: np.ndarray) -> DesignTable:
        numbers = _parse_units(ranges)
        ends = np.array([_checked_range(name, bounds) for name, bounds in numbers.items()])
        return cls(tuple(ranges), ends[:, 0] + unit * (ends[:, 1] - ends[:, 0]), numbers)


def _parse_units(columns: Mapping[str, ArrayLike]) -> dict[str, Sequence[float] | np.ndarray]:
    """Columns as numbers; texts such as ``"10 mm"`` are converted."""
    numbers: dict[str, Sequence[float] | np.ndarray] = {}
    for name, values in columns.items():
        if getattr(getattr(values, "dtype", None), "kind", "O") in "fiu":
            numbers[name] = np.asarray(values).ravel()
            continue
        try:
            numbers[name] = [measured(value) for value in np.asarray(values, dtype=object).ravel()]
        except ExpressionError as error:
            raise AnalysisError(f"{name}: {error.message}") from None
    return numbers


def _checked_range(name: str, bounds: ArrayLike) -> tuple[float, float]:
    ends = np.asarray(bounds, dtype=float).ravel()
    if ends.size != 2 or not ends[0] < ends[1]:
        raise AnalysisError(f"{name}: a range is (lower, upper), got {bounds!r:.60}")
    return float(ends[0]), float(ends[1])


def _checked_count(count: int) -> int:
    if not isinstance(count, (int, np.integer)) or not 0 < count <= MAX_DESIGNS:
        raise AnalysisError(f"the number of designs is 1 to {MAX_DESIGNS}, got {count!r:.30}")
    return int(count)
