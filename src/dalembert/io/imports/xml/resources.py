"""Files that an imported file refers to, only inside permitted folders.

A reference such as ``package://robot/meshes/arm.stl`` or ``../arm.stl`` is resolved to a file in
the folder of the imported file, in the root or in a package folder; nothing else is read.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from dalembert.errors import FileError

SCHEME = re.compile(r"([a-zA-Z][a-zA-Z0-9+.-]+)://(.*)", re.DOTALL)
LEVELS = 4
"""Number of folders above the imported file that may be the folder of a package."""


class Resources:
    """Lookup of referenced files.

    Parameters
    ----------
    path : imported file
    root : folder inside which all files are; that of the imported file by default
    packages : name of a package or model → its folder
    """

    def __init__(self, path: Path, root: str | Path | None, packages: Mapping[str, str | Path]):
        self.path = path
        self.folder = path.resolve().parent
        self.root = self.folder if root is None else Path(root).resolve()
        if not self.root.is_dir():
            raise FileError(f"{root}: is no folder; give the folder that contains the model")
        self.packages = {name: Path(folder).resolve() for name, folder in packages.items()}
        for name, folder in self.packages.items():
            if not folder.is_dir():
                raise FileError(f"{folder}: is no folder; give the folder of the package {name}")

    def find(self, reference: str, beside: Path | None = None) -> Path:
        """The file of a reference.

        Parameters
        ----------
        beside : folder to which a relative path refers; that of the imported file by default

        Raises
        ------
        FileError
            Missing, or outside the permitted folders; states the option that permits it.
        """
        if "\0" in reference or not reference.strip():
            raise FileError(f"{reference!r} is no name of a file")
        scheme = SCHEME.fullmatch(reference)
        candidates = (
            self._in_packages(*scheme.groups())
            if scheme
            else [(beside or self.folder) / reference.replace("\\", "/")]
        )
        outside = False
        for candidate in candidates:
            try:
                resolved = candidate.resolve()
                inside = self._is_permitted(resolved)
                outside = outside or not inside
                if inside and resolved.is_file():
                    return resolved
            except OSError:
                continue
        if outside and not scheme:
            raise FileError(
                f"{reference}: is outside the folder of the model; permit it with --root FOLDER, "
                "in Python root=folder, if the model is trusted"
            )
        cure = "permit its folder with --root FOLDER" if scheme else "check the name and the folder"
        if scheme and scheme[1] in ("package", "model"):
            name = scheme[2].partition("/")[0]
            cure = f"give its folder with --package {name}=FOLDER, or --root FOLDER"
        raise FileError(f"{reference}: no such file inside the folder of the model; {cure}")

    def _is_permitted(self, resolved: Path) -> bool:
        return any(resolved.is_relative_to(f) for f in (self.root, *self.packages.values()))

    def _in_packages(self, scheme: str, rest: str) -> list[Path]:
        """Candidates of ``package://name/path``, ``model://name/path`` and ``file://path``."""
        if scheme == "file":
            return [Path(rest)]
        if scheme not in ("package", "model"):
            return []
        parts = PurePosixPath(rest).parts
        if not parts:
            return []
        name, inner = parts[0], Path(*parts[1:]) if len(parts) > 1 else Path()
        if name in self.packages:
            return [self.packages[name] / inner]
        above = [self.folder, *self.folder.parents[:LEVELS]]
        named = [folder / inner for folder in above if folder.name == name]
        return [*named, self.root / name / inner, *(folder / name / inner for folder in above)]
