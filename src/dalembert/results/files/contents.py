"""Labelled arrays as plain data: what is written to files and pages without ``xarray``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]
"""Dimensions, values, and what is said about them."""


@dataclass(frozen=True)
class Contents:
    """What an ``xarray.Dataset`` holds.

    Attributes
    ----------
    variables, coordinates : name → dimensions, values, what is said about them
    attributes : what is said about all
    """

    variables: dict[str, Labelled]
    coordinates: dict[str, Labelled]
    attributes: dict[str, Any]

    @classmethod
    def given(
        cls, variables: Mapping[str, Any], coordinates: Mapping[str, Any], about: dict[str, Any]
    ) -> Contents:
        """As ``xarray.Dataset`` takes them: lists of labels are coordinates of their own."""
        return cls(
            {name: _labelled(name, given) for name, given in variables.items()},
            {name: _labelled(name, given) for name, given in coordinates.items()},
            about,
        )

    @classmethod
    def of(cls, data: xr.Dataset) -> Contents:
        """What a dataset holds."""
        variables, coordinates = (
            {str(n): (tuple(map(str, v.dims)), v.values, dict(v.attrs)) for n, v in part.items()}
            for part in (data.data_vars, data.coords)
        )
        return cls(variables, coordinates, dict(data.attrs))

    def dataset(self) -> xr.Dataset:
        """The same with all that ``xarray`` can do."""
        import xarray as xr

        return xr.Dataset(self.variables, self.coordinates, self.attributes)

    def plus(
        self, variables: Mapping[str, Any], coordinates: Mapping[str, Any] | None = None
    ) -> Contents:
        """The same with more in it."""
        more = Contents.given(variables, coordinates or {}, {})
        return replace(
            self,
            variables=self.variables | more.variables,
            coordinates=self.coordinates | more.coordinates,
        )

    def __contains__(self, name: str) -> bool:
        return name in self.variables

    def __getitem__(self, name: str) -> np.ndarray:
        """Values of a variable."""
        return self.variables[name][1]

    def about(self, name: str) -> dict[str, Any]:
        """Unit and long name of a variable."""
        return self.variables[name][2]

    def dimensions(self, name: str) -> tuple[str, ...]:
        """Dimensions of a variable."""
        return self.variables[name][0]

    def labels(self, dimension: str) -> list[str]:
        """Names along a dimension; none where there is no such dimension."""
        return list(self.coordinates[dimension][1]) if dimension in self.coordinates else []

    def at(self, name: str, **labels: str) -> np.ndarray:
        """Values of a variable at labels of some of its dimensions."""
        places = [
            self.labels(dimension).index(labels[dimension]) if dimension in labels else slice(None)
            for dimension in self.dimensions(name)
        ]
        return self[name][tuple(places)]


def _labelled(name: str, given: Any) -> Labelled:
    if isinstance(given, list):
        given = ((name,), np.array(given, dtype=str))
    elif isinstance(given, np.ndarray):
        given = ((name,), given)
    dimensions, values, *about = given
    dimensions = (dimensions,) if isinstance(dimensions, str) else tuple(dimensions)
    return dimensions, np.asarray(values), dict(about[0]) if about else {}
