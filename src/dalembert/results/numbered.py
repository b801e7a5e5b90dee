"""What results share whose states are numbered, as modes are, and have no instants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.files.contents import Contents
from dalembert.results.result import Analysis, Instants, Result
from dalembert.results.status import Status
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False, repr=False)
class Numbered(Result):
    """Modes by their numbers; responses see the numbers as they see the instants of a motion.

    Attributes
    ----------
    model : what was analysed
    analysis : the analysis that made it
    parameters : (n,) values used, then numbers computed from them
    numbers : (k,) of the modes, from 1
    eigenvalues : (k,)
    shapes : (n, k) displacements
    status : Status, with a residual
    positions : (k,) of the modes in the spectrum of the record
    record : what a gradient needs
    statistics : name → number or text, for people
    warnings : what speaks against reading too much from them
    """

    model: Any
    analysis: Analysis
    parameters: np.ndarray
    numbers: np.ndarray
    eigenvalues: np.ndarray
    shapes: np.ndarray
    status: Status
    positions: np.ndarray
    record: Any = None
    statistics: dict[str, Any] = field(default_factory=dict)
    warnings: Sequence[str] = ()

    in_sequence: ClassVar[bool] = False

    continuous = False
    """There is nothing between two numbers: integrals over them are sums."""
    named: ClassVar[dict[str, Expression]] = {}
    """Measures of the eigenvalue alone."""

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
        return replace(
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

    def keys(self) -> list[str]:
        return [*self.told, *self.model.parameters]

    @property
    def told(self) -> list[str]:
        """Measures that are kept."""
        return list(self.named)

    @cached_property
    def contents(self) -> Contents:
        """Measures of the modes, and their shapes."""
        found: dict[str, Any] = {}
        for name in self.told:
            unit = self.expression(name).unit
            found[name] = ("mode", self.values(name), {"units": unit, "long_name": name})
        return Contents.given(found, {"mode": self.numbers}, self.about)

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over the modes."""
        return self.labelled(measure, {"mode": self.numbers})
