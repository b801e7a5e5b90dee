"""Export of models and results to files for other programs."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any

from dalembert.errors import FileError, UnsupportedError
from dalembert.files import atomic_path
from dalembert.io.exports.exported import Exported, Files
from dalembert.io.exports.registry import FORMATS, Format
from dalembert.io.model_file import load_model_file
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown


@check_arguments
def export(source: Any, path: str | Path, to: str = "", **options: Any) -> Exported:
    """Write a model or a result to a file for another program.

    The suffix of the file selects the format. Nothing is written before the contents are complete.

    Parameters
    ----------
    source : a model, a motion, modes, a result of a structure or of many designs; for a Python
        script the path of a model file
    path : of the file; files of series are beside it
    to : name of the format, by default that of the suffix
    options : of the format, see the documentation of exports

    Returns
    -------
    Exported
        Paths, and the parts that the format cannot express.

    Raises
    ------
    UnsupportedError
        Unknown format, a source that it does not have, an element that it cannot express, or a
        missing package.
    FileError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=0.5, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = da.export(motion, f"{folder}/throw.mat")
    >>> written.files[0].name, written.omissions
    ('throw.mat', [])
    """
    target = Path(path)
    file_format = _format(target, to)
    if isinstance(source, (str, Path)):
        source = load_model_file(source)
    if not target.suffix:
        target = target.with_name(target.name + file_format.suffix)
    contents = file_format.create(source, target.stem, options)
    return Exported(write_files(contents, target), list(contents.omissions))


def _format(path: Path, to: str) -> Format:
    """The format of a name, or of a suffix."""
    if to:
        if to not in FORMATS:
            raise UnsupportedError(unknown("format", to, FORMATS))
        return FORMATS[to]
    for file_format in FORMATS.values():
        if path.suffix.lower() == file_format.suffix:
            return file_format
    suffixes = ", ".join(f"{f.suffix} ({name})" for name, f in FORMATS.items())
    ending = f"unknown suffix {path.suffix!r}" if path.suffix else "no suffix"
    raise FileError(f"{path}: {ending}; give to=…, or one of {suffixes}")


def write_files(contents: Files, target: Path) -> list[Path]:
    """Write all files, or none of them if one cannot be written."""
    names = list(contents.files)
    paths = [target, *(target.with_name(name) for name in names[1:])]
    with ExitStack() as stack:
        for path, data in zip(paths, contents.files.values(), strict=True):
            stack.enter_context(atomic_path(path)).write_bytes(data)
    return paths
