"""A recording with everything that can be measured on it under its name."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from dalembert.results.components import COMPONENTS
from dalembert.results.files.contents import Contents
from dalembert.results.recording import Recording
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import xarray as xr

DATA_ONLY = {
    "energy",
    "dissipated_energy",
    "input_energy",
    "balance_error",
    "position_violation",
    "velocity_violation",
}


@dataclass(eq=False, repr=False)
class LabelledRecording(Recording):
    """Recording whose quantities are labelled arrays."""

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over time.

        Raises
        ------
        KeyError
            Unknown name, with the nearest known ones.
        """
        if isinstance(measure, str) and measure in DATA_ONLY:
            return self.data[measure]
        expression = self.expression(measure)
        coords: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
        if len(expression) > 1:
            dimension, names = COMPONENTS[len(expression)]
            coords[dimension] = list(names)
        return self.labelled(measure, coords)

    def __contains__(self, measure: object) -> bool:
        return (isinstance(measure, str) and measure in DATA_ONLY) or super().__contains__(measure)

    def keys(self) -> list[str]:
        return list(dict.fromkeys([*super().keys(), *sorted(DATA_ONLY)]))

    @cached_property
    def contents(self) -> Contents:
        """Everything: poses, speeds, reactions, efforts, energies, violations."""
        from dalembert.results.dataset import motion_contents

        return motion_contents(self)
