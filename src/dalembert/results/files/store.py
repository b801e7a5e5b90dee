"""Result files: NetCDF and CSV."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dalembert.errors import DalembertError, FileError
from dalembert.files import atomic_path, readable
from dalembert.results.files.contents import Contents, Labelled
from dalembert.results.files.inspection import check_seal, inspect, seal
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import h5netcdf
    import pandas as pd
    import xarray as xr


OTHER_SUFFIXES = {".csv": "to_csv", ".html": "report"} | dict.fromkeys(
    (".txt", ".json", ".toml", ".xlsx", ".parquet", ".mat", ".pkl", ".png", ".pdf"), ""
)
"""Suffixes of other file types → method that writes them."""
MAX_MESSAGE = 300
"""Upper limit of the characters quoted from a library's message."""
NO_CHECKSUM_WARNING = (
    "has no checksum, because an earlier version or another program wrote it; damaged numbers "
    "cannot be detected"
)
"""Warning for a file without a checksum."""


def save_dataset(data: xr.Dataset | Contents, path: str | Path) -> Path:
    """Write labelled arrays as NetCDF-4, atomically.

    Raises
    ------
    FileError
        The file cannot be written, or its suffix belongs to another type.
    """
    ending = Path(path).suffix.lower()
    if ending in OTHER_SUFFIXES:
        writer = f"; {OTHER_SUFFIXES[ending]} writes {ending}" if OTHER_SUFFIXES[ending] else ""
        raise FileError(f"{path}: results are saved as NetCDF, in a file such as x.nc{writer}")
    with atomic_path(path) as temporary:
        write_netcdf(data if isinstance(data, Contents) else Contents.of(data), temporary)
        seal(temporary)
    return Path(path)


@check_arguments
def load_results(path: str | Path) -> xr.Dataset:
    """Read a result file written by ``save`` as an ``xarray.Dataset``.

    The checksum of the file is verified, and files that refer to other files are refused. A file
    without a checksum is read with a ``UserWarning``.

    Parameters
    ----------
    path : of the file

    Raises
    ------
    FileError
        Missing file, a damaged one, or not a result of this program.
    BudgetError
        Its contents exceed the memory budget.

    Examples
    --------
    >>> import tempfile
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("fall", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = motion.save(f"{folder}/fall.nc")
    ...     data = da.load_results(path)
    >>> data["position"].sel(body="stone", axis="y")[-1].item()
    -5.0
    """
    import xarray as xr

    readable(path, 1.0)
    try:
        sealed = check_seal(path)
        inspect(path)
        with xr.open_dataset(path, engine="h5netcdf", phony_dims="sort") as opened:
            data = opened.load()
    except DalembertError:
        raise
    except Exception as error:  # HDF5 and its readers have errors of many kinds
        raise FileError(f"{path}: cannot be read as a result file ({_brief(error)})") from None
    if not sealed:
        warnings.warn(f"{path}: {NO_CHECKSUM_WARNING}", stacklevel=3)
    return data


def _brief(error: Exception) -> str:
    """Truncated message of a library error."""
    message = str(error) or type(error).__name__
    return message if len(message) <= MAX_MESSAGE else message[:MAX_MESSAGE] + " …"


def report_of(data: xr.Dataset) -> dict:
    """Payload of the report of a saved result.

    Raises
    ------
    FileError
        The dataset contains no report.
    """
    try:
        payload = json.loads(str(data["report"].values))
    except (KeyError, ValueError, RecursionError):
        payload = None
    if not isinstance(payload, dict):
        raise FileError("this result file contains no report; run the model again")
    return payload


def save_table(table: pd.DataFrame, path: str | Path) -> Path:
    """Write a table as CSV, atomically."""
    with atomic_path(path) as temporary:
        table.to_csv(temporary)
    return Path(path)


TEXTS, BOOLEANS, NUMBERS = "UO", "b", "f"
"""Array kinds that need a conversion."""


def write_netcdf(contents: Contents, path: str | Path) -> None:
    """Write labelled arrays of numbers, booleans and texts as NetCDF-4."""
    import h5netcdf

    coordinates = contents.coordinates
    arrays = contents.variables | coordinates
    auxiliary = [name for name, (dims, *_) in coordinates.items() if dims != (name,)]
    with h5netcdf.File(path, "w") as file:
        for dims, values, _ in arrays.values():
            for dimension, size in zip(dims, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.dimensions[dimension] = size
        for name, array in arrays.items():
            _write(file, name, array)
        for name, value in contents.attributes.items():
            file.attrs[name] = value
        if auxiliary:
            file.attrs["coordinates"] = " ".join(auxiliary)


def _write(file: h5netcdf.File, name: str, array: Labelled) -> None:
    dims, values, attributes = array
    kind, dtype, fill_value = values.dtype.kind, values.dtype, None
    if kind in TEXTS:
        import h5py

        dtype, values = h5py.string_dtype(), values.astype(object)
    elif kind in BOOLEANS:
        dtype, values, attributes = (
            np.dtype("i1"),
            values.astype("i1"),
            attributes | {"dtype": "bool"},
        )
    elif kind in NUMBERS:
        fill_value = np.nan
    variable = file.create_variable(name, dims, dtype=dtype, fillvalue=fill_value)
    for key, value in attributes.items():
        variable.attrs[key] = value
    if values.size:
        variable[...] = values
