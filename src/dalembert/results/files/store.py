"""Results to files and back: NetCDF, data frames, CSV."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from dalembert.errors import DalembertError, FileError
from dalembert.files import atomic_path, readable
from dalembert.results.files.contents import Contents
from dalembert.results.files.inspection import check_seal, inspect, seal
from dalembert.results.files.netcdf import write_netcdf
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


OTHERS = {".csv": "to_csv", ".html": "report"} | dict.fromkeys(
    (".txt", ".json", ".toml", ".xlsx", ".parquet", ".mat", ".pkl", ".png", ".pdf"), ""
)
"""Endings of files that hold something else, and who writes it."""
LONGEST = 300
"""Characters of a message of a library that are shown."""
UNSEALED = (
    "has no checksum, as an earlier version or another program wrote it; damage of its numbers "
    "would not be noticed"
)
"""What is said of a file that cannot be compared with a checksum."""


def save_dataset(data: xr.Dataset | Contents, path: str | Path) -> Path:
    """Write labelled arrays as NetCDF-4, whole or not at all.

    Raises
    ------
    FileError
        The file cannot be written, or its name says that it is of another kind.
    """
    ending = Path(path).suffix.lower()
    if ending in OTHERS:
        writer = f"; {OTHERS[ending]} writes {ending}" if OTHERS[ending] else ""
        raise FileError(f"{path}: results are saved as NetCDF, in a file such as x.nc{writer}")
    with atomic_path(path) as temporary:
        write_netcdf(data if isinstance(data, Contents) else Contents.of(data), temporary)
        seal(temporary)
    return Path(path)


@spelled
def load_results(path: str | Path) -> xr.Dataset:
    """Read a result file written by ``save`` as an ``xarray.Dataset``.

    The file is compared with its checksum, and refused where it refers to other files. A file
    without a checksum is read, with a ``UserWarning``.

    Parameters
    ----------
    path : of the file

    Raises
    ------
    FileError
        Missing file, a damaged one, or not a result of this program.
    BudgetError
        It unpacks to more than a task may take.

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
        warnings.warn(f"{path}: {UNSEALED}", stacklevel=3)
    return data


def _brief(error: Exception) -> str:
    """The beginning of a message of a library."""
    told = str(error) or type(error).__name__
    return told if len(told) <= LONGEST else told[:LONGEST] + " …"


def report_of(data: xr.Dataset) -> dict:
    """What the report of a saved result is drawn from.

    Raises
    ------
    FileError
        The dataset holds none.
    """
    try:
        payload = json.loads(str(data["report"].values))
    except (KeyError, ValueError, RecursionError):
        payload = None
    if not isinstance(payload, dict):
        raise FileError("this result file holds no report; run the model again")
    return payload


def save_table(table: pd.DataFrame, path: str | Path) -> Path:
    """Write a table as CSV, whole or not at all."""
    with atomic_path(path) as temporary:
        table.to_csv(temporary)
    return Path(path)
