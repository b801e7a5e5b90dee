"""Formats of exported modules, by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dalembert.errors import FileError, UnsupportedError
from dalembert.files import atomic_path
from dalembert.report.javascript import javascript_files
from dalembert.text.wording import unknown

FORMATS: Mapping[str, Callable[[Mapping[str, Any], str], Mapping[str, str]]] = {
    "js": javascript_files,
}
"""Name → function of the data of a module and the name of its files, which returns their texts."""


def write_export(to: str, data: Mapping[str, Any], folder: Path, name: str) -> list[Path]:
    """Write a module in a format; returns the paths.

    Parameters
    ----------
    to : name of the format
    data : the module as plain data
    folder : of the files, created if missing
    name : of the files, without suffix; characters other than letters and digits become ``_``

    Raises
    ------
    UnsupportedError
        Unknown format.
    FileError
        The folder cannot be written to.
    """
    if to not in FORMATS:
        raise UnsupportedError(unknown("format", to, FORMATS))
    name = re.sub(r"[^\w-]+", "_", name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{folder}: cannot be created ({error.strerror})") from None
    paths = []
    for file, text in FORMATS[to](data, name).items():
        with atomic_path(folder / file) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
        paths.append(folder / file)
    return paths
