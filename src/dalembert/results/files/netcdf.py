"""NetCDF-4 files of labelled arrays, as ``xarray`` writes and reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dalembert.results.files.contents import Contents, Labelled

TEXTS, TRUTHS, NUMBERS = "UO", "b", "f"
"""Kinds of arrays that are not written as they are."""


def write_netcdf(contents: Contents, path: str | Path) -> None:
    """Write labelled arrays of numbers, truths and texts."""
    import h5netcdf

    coordinates = contents.coordinates
    arrays = contents.variables | coordinates
    apart = [name for name, (along, *_) in coordinates.items() if along != (name,)]
    with h5netcdf.File(path, "w") as file:
        for along, values, _ in arrays.values():
            for dimension, size in zip(along, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.dimensions[dimension] = size
        for name, labelled in arrays.items():
            _write(file, name, labelled)
        for name, value in contents.attributes.items():
            file.attrs[name] = value
        if apart:
            file.attrs["coordinates"] = " ".join(apart)


def _write(file: Any, name: str, labelled: Labelled) -> None:
    along, values, about = labelled
    kind, dtype, missing = values.dtype.kind, values.dtype, None
    if kind in TEXTS:
        import h5py

        dtype, values = h5py.string_dtype(), values.astype(object)
    elif kind in TRUTHS:
        dtype, values, about = np.dtype("i1"), values.astype("i1"), about | {"dtype": "bool"}
    elif kind in NUMBERS:
        missing = np.nan
    variable = file.create_variable(name, along, dtype=dtype, fillvalue=missing)
    for key, value in about.items():
        variable.attrs[key] = value
    if values.size:
        variable[...] = values
