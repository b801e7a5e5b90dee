"""Files beside a model file that its text names, such as measurements and meshes."""

from __future__ import annotations

import filecmp
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

from dalembert.errors import FileError
from dalembert.files import atomic_path


@dataclass
class Companions:
    """Files that a model names, when it is saved in another folder.

    Attributes
    ----------
    copied : their names
    refused : those that were not copied, each with the reason
    """

    copied: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)


def copy_companions(data: dict[str, Any] | None, source: Path, target: Path) -> Companions:
    """Copy the files that a model names to the folder in which it is saved.

    Files of that folder are never replaced.

    Parameters
    ----------
    data : contents of the model file; None if it is no TOML
    source : folder of the model before
    target : folder in which it was saved
    """
    companions = Companions()
    if source.resolve() == target.resolve():
        return companions
    for name in sorted(set(_named_files(data or {}, source))):
        try:
            if _copy(source / name, target / name):
                companions.copied.append(name)
        except (OSError, FileError) as error:
            reason = getattr(error, "strerror", None) or error
            companions.refused.append(f"{name} was not copied: {reason}")
    return companions


def _named_files(data: object, folder: Path) -> Iterator[str]:
    """Strings of a model that are relative paths of files in its folder."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        for each in data:
            yield from _named_files(each, folder)
    elif isinstance(data, str) and data.isprintable() and len(data) < 200:
        path = PurePath(data)
        inside = path.suffix and not path.is_absolute() and ".." not in path.parts
        if inside and (folder / path).is_file():
            yield data


def _copy(source: Path, target: Path) -> bool:
    """Copy a file; whether it was not there already."""
    if target.exists():
        if target.is_file() and filecmp.cmp(source, target, shallow=False):
            return False
        raise FileError("another file has this name there, which the model reads now")
    target.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(target) as temporary:
        shutil.copyfile(source, temporary)
    return True
