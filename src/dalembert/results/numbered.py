"""What results share whose states are numbered, as modes are, and have no instants."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.result import Instants, Result
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import xarray as xr


class Numbered(Result):
    """Modes by their numbers; responses see the numbers as they see the instants of a motion.

    Attributes
    ----------
    numbers : (k,) from 1
    eigenvalues : (k,)
    shapes : (n, k)
    positions : (k,) places in the whole spectrum
    """

    continuous = False
    """There is nothing between two numbers: integrals over them are sums."""
    model: Any
    numbers: np.ndarray
    eigenvalues: np.ndarray
    shapes: np.ndarray
    positions: np.ndarray

    @property
    def time(self) -> np.ndarray:
        """(k,) numbers of the modes: what instants are to a motion."""
        return self.numbers.astype(float)

    def places(self, numbers: np.ndarray) -> list[int]:
        """Where modes stand, by number.

        Raises
        ------
        AnalysisError
            There is no mode of a number.
        """
        wanted = np.asarray(numbers, dtype=float)
        for number in wanted:
            if number not in self.numbers:
                known = ", ".join(map(str, self.numbers)) or "none"
                raise AnalysisError(f"there is no mode {number:g} (known: {known})")
        return [int(np.flatnonzero(self.numbers == number)[0]) for number in wanted]

    def at(self, numbers: Instants) -> Self:
        """Some of the modes, by number."""
        index = self.places(np.atleast_1d(np.asarray(numbers)))
        return replace(  # type: ignore[type-var]
            self,
            numbers=self.numbers[index],
            eigenvalues=self.eigenvalues[index],
            shapes=self.shapes[:, index],
            positions=self.positions[index],
        )

    @classmethod
    def formula(cls, model: Any, measure: str | Expression) -> Expression:
        """A measure of modes by its name, or a formula of such measures and of parameters."""
        raise NotImplementedError

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures and parameters."""
        return self.formula(self.model, measure)

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over the modes."""
        return self.labelled(measure, {"mode": self.numbers})
