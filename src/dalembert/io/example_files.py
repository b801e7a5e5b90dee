"""The example models that are installed with the package."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from dalembert.errors import FileError


def example_folder() -> Path:
    """Folder of the examples: in the installed package, or next to ``src`` in a checkout.

    Raises
    ------
    FileError
        The examples are not installed.
    """
    package = Path(str(resources.files("dalembert")))
    for folder in (package / "examples", package.parents[1] / "examples"):
        if folder.is_dir():
            return folder
    raise FileError("the example files are missing from this installation; reinstall dalembert")
