"""Modes of small motions of mechanisms and structures, and results whose states are numbered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.analysis import Analysis
from dalembert.results.files.contents import Contents
from dalembert.results.result import Instants, Result
from dalembert.results.status import Status
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dalembert.results.files.live_responses import FirstResponse
    from dalembert.results.state_space import StateSpace

MOST_RESPONSES = 6
"""Upper limit of the responses that a live page lists by default."""


@dataclass(frozen=True, eq=False, repr=False)
class Numbered(Result):
    """Modes by number; responses treat the numbers like the instants of a motion.

    Attributes
    ----------
    model : analysed model
    analysis : analysis that computed it
    parameters : (n,) values used, followed by derived values
    numbers : (k,) of the modes, from 1
    eigenvalues : (k,)
    shapes : (n, k) displacements
    status : Status, with a residual
    positions : (k,) indices of the modes in the spectrum of the record
    record : data for gradients
    statistics : name → number or text
    warnings : reservations about the accuracy or validity of the modes
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
    """Modes are discrete: integrals over them are sums."""
    named: ClassVar[dict[str, Expression]] = {}
    """Reported measures of the eigenvalue alone."""
    main: ClassVar[str] = "frequency"
    """Main measure in texts."""
    exported: ClassVar[tuple[str, ...]] = ("frequency",)
    """Measures of exported modules by default."""

    @property
    def time(self) -> np.ndarray:
        """(k,) numbers of the modes, in the role of the instants of a motion."""
        return self.numbers.astype(float)

    def places(self, numbers: np.ndarray) -> list[int]:
        """Indices of modes, by number.

        Raises
        ------
        AnalysisError
            A mode of this number does not exist.
        """
        requested = np.asarray(numbers, dtype=float)
        for number in requested:
            if number not in self.numbers:
                listed = ", ".join(map(str, self.numbers)) or "none"
                raise AnalysisError(f"there is no mode {number:g} (known: {listed})")
        return [int(np.flatnonzero(self.numbers == number)[0]) for number in requested]

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
        return [*self.reported_measures, *self.model.parameters]

    @property
    def reported_measures(self) -> list[str]:
        """Measures that ``contents`` includes."""
        return list(self.named)

    @cached_property
    def contents(self) -> Contents:
        """Measures of the modes, and their shapes."""
        variables: dict[str, Any] = {}
        for name in self.reported_measures:
            unit = self.expression(name).unit
            variables[name] = ("mode", self.values(name), {"units": unit, "long_name": name})
        return Contents.from_arrays(variables, {"mode": self.numbers}, self.attributes)

    def to_dataframe(self) -> pd.DataFrame:
        """A table of the measures of the modes."""
        return self.data[self.reported_measures].to_dataframe()

    @property
    def state_names(self) -> list[str]:
        """Number and main measure of each mode."""
        unit = f" {self.named[self.main].unit}".rstrip()
        values = zip(self.numbers, self.values(self.main), strict=True)
        return [f"mode {number}: {value:.5g}{unit}" for number, value in values]

    def summary(self) -> dict[str, Any]:
        """Status and measures of each mode."""
        values = {name: self.values(name) for name in self.named}
        return {
            "status": str(self.status),
            "residual": self.status.residual,
            "statistics": self.statistics,
            "warnings": list(self.warnings),
            "states": [
                {"mode": label} | {name: float(column[k]) for name, column in values.items()}
                for k, label in enumerate(self.state_names)
            ],
        }

    def first_responses(self) -> list[FirstResponse]:
        """The main measure of each mode."""
        from dalembert.results.files.live_responses import FirstResponse

        main = self.expression(self.main)
        return [
            FirstResponse(
                f"{main.name} of mode {number}",
                main.unit,
                main.sx,
                {"kind": "at", "instant": k},
            )
            for k, number in enumerate(self.numbers[:MOST_RESPONSES])
        ]

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over the modes."""
        return self.labelled(measure, {"mode": self.numbers})


class Modes(Numbered):
    """Modes ``exp(s t)`` of small motions, numbered by increasing magnitude of ``s``.

    Measures: ``frequency`` and ``angular_frequency``, undamped, ``damping_ratio``, and
    ``eigenvalue_real`` and ``eigenvalue_imag``, the parts of ``s``.
    """

    @property
    def frequencies(self) -> np.ndarray:
        """(k,) undamped frequencies [Hz]."""
        return self.values("frequency")

    @property
    def damping_ratios(self) -> np.ndarray:
        """(k,) ``−Re s/|s|``."""
        return self.values("damping_ratio")

    @property
    def stable(self) -> bool:
        """Whether no motion grows."""
        size = np.abs(self.values("angular_frequency")).max(initial=0.0)
        return bool(np.all(self.values("eigenvalue_real") <= 1e-9 * size))

    def state_space(
        self,
        inputs: Any = None,
        outputs: Any = None,
        *,
        damping: Any = None,
        damping_ratio: float = 0.0,
    ) -> StateSpace:
        """State-space model ``ẋ = A x + B u``, ``y = C x + D u`` in minimal coordinates.

        The states of a mechanism are some of its displacements, their rates and the states of
        blocks; those of a structure are the modal coordinates of these modes.

        Parameters
        ----------
        inputs : names of inputs or parameters, of a structure also load cases; by default all
            inputs of the model
        outputs : measures; by default all outputs of the model
        damping, damping_ratio : Rayleigh damping and modal damping ratio of a structure

        Raises
        ------
        UnsupportedError
            Outputs depend on derivatives of an input that moves constraints.
        """
        analysis: Any = self.analysis
        model: StateSpace = analysis.state_space(self, inputs, outputs, damping, damping_ratio)
        return model

    def summary(self) -> dict[str, Any]:
        """Status with stability, and measures of each mode."""
        stability = "stable" if self.stable else "not stable"
        verdict = f", {stability}" if self.status.success else ""
        return super().summary() | {"status": f"{self.status}{verdict}"}
