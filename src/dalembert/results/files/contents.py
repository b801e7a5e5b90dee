"""Labelled arrays as plain data, for files and pages without ``xarray``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


COMPONENTS = {
    2: ("axis", ("x", "y")),
    3: ("axis", ("x", "y", "z")),
    4: ("component", ("e0", "e1", "e2", "e3")),
    9: ("entry", tuple(f"{row}{column}" for row in "xyz" for column in "xyz")),
}
"""Number of components → dimension and labels: vectors, Euler parameters, matrices by rows."""


Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]
"""Dimensions, values and attributes."""


@dataclass(frozen=True)
class Contents:
    """Labelled arrays with the structure of an ``xarray.Dataset``.

    Attributes
    ----------
    variables, coordinates : name → dimensions, values, attributes
    attributes : attributes of the whole
    """

    variables: dict[str, Labelled]
    coordinates: dict[str, Labelled]
    attributes: dict[str, Any]

    @classmethod
    def from_arrays(
        cls,
        variables: Mapping[str, Any],
        coordinates: Mapping[str, Any],
        attributes: dict[str, Any],
    ) -> Contents:
        """Contents from the arguments of ``xarray.Dataset``; a list of labels is a coordinate."""
        return cls(
            {name: _labelled(name, entry) for name, entry in variables.items()},
            {name: _labelled(name, entry) for name, entry in coordinates.items()},
            attributes,
        )

    @classmethod
    def of(cls, data: xr.Dataset) -> Contents:
        """Contents of a dataset."""
        variables, coordinates = (
            {str(n): (tuple(map(str, v.dims)), v.values, dict(v.attrs)) for n, v in part.items()}
            for part in (data.data_vars, data.coords)
        )
        return cls(variables, coordinates, dict(data.attrs))

    def dataset(self) -> xr.Dataset:
        """The contents as an ``xarray.Dataset``."""
        import xarray as xr

        return xr.Dataset(self.variables, self.coordinates, self.attributes)

    def plus(
        self, variables: Mapping[str, Any], coordinates: Mapping[str, Any] | None = None
    ) -> Contents:
        """The contents with further variables and coordinates."""
        added = Contents.from_arrays(variables, coordinates or {}, {})
        return replace(
            self,
            variables=self.variables | added.variables,
            coordinates=self.coordinates | added.coordinates,
        )

    def __contains__(self, name: str) -> bool:
        return name in self.variables

    def __getitem__(self, name: str) -> np.ndarray:
        """Values of a variable."""
        return self.variables[name][1]

    def attributes_of(self, name: str) -> dict[str, Any]:
        """Unit and long name of a variable."""
        return self.variables[name][2]

    def dimensions(self, name: str) -> tuple[str, ...]:
        """Dimensions of a variable."""
        return self.variables[name][0]

    def labels(self, dimension: str) -> list[str]:
        """Labels along a dimension; empty if there is no such dimension."""
        return list(self.coordinates[dimension][1]) if dimension in self.coordinates else []

    def at(self, name: str, **labels: str) -> np.ndarray:
        """Values of a variable at labels of some of its dimensions."""
        index = [
            self._places[dimension][labels[dimension]] if dimension in labels else slice(None)
            for dimension in self.dimensions(name)
        ]
        return self[name][tuple(index)]

    @cached_property
    def _places(self) -> dict[str, dict[str, int]]:
        """Dimension → label → its first place along the dimension."""
        return {
            dimension: {str(label): k for k, label in reversed([*enumerate(labels)])}
            for dimension, (_, labels, _) in self.coordinates.items()
        }


def _labelled(name: str, entry: Any) -> Labelled:
    if isinstance(entry, list):
        entry = ((name,), np.array(entry, dtype=str))
    elif isinstance(entry, np.ndarray):
        entry = ((name,), entry)
    dimensions, values, *attributes = entry
    dimensions = (dimensions,) if isinstance(dimensions, str) else tuple(dimensions)
    return dimensions, np.asarray(values), dict(attributes[0]) if attributes else {}
