"""Archive of a unit: description, C files and libraries."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Mapping
from importlib.resources import files
from io import BytesIO
from pathlib import Path

from dalembert.fmu.compiler import compile_unit, library_path
from dalembert.fmu.model_description import Description, build_description

EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of the files in an archive, so that equal models give equal files."""
SHARED = ("instance.h", "closing.h", "evaluation.h", "running.h")
"""C files that all units have in common."""


def archive_of(description: Description, model: str, version: int, platforms: list[str]) -> bytes:
    """Compile a unit and pack it.

    Parameters
    ----------
    description : Description
    model : text of ``model.h``
    version : of FMI
    platforms : names of the platforms

    Raises
    ------
    UnsupportedError
        There is no compiler for a platform, or no folder in this version of FMI.
    """
    main, identifier = f"fmi{version}.c", description.identifier
    sources = shared_sources(version) | {"model.h": model.encode()}
    entries = {"modelDescription.xml": description.text(version).encode()}
    with tempfile.TemporaryDirectory() as folder:
        write_sources(Path(folder), sources)
        for name in platforms:
            target = library_path(name, identifier, version)
            entries[target] = compile_unit(Path(folder), main, name, identifier)
    if version == 3:
        sources["buildDescription.xml"] = build_description(identifier, main).encode()
    entries |= {f"sources/{name}": data for name, data in sorted(sources.items())}
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, data in entries.items():
            info = zipfile.ZipInfo(name, EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            archive.writestr(info, data)
    return packed.getvalue()


def shared_sources(version: int) -> dict[str, bytes]:
    """Names and contents of the C files of all units, with the headers of FMI."""
    folder = files("dalembert.fmu") / "sources"
    sources = {name: (folder / name).read_bytes() for name in (*SHARED, f"fmi{version}.c")}
    for header in (folder / "headers").iterdir():
        if header.name.startswith(f"fmi{version}") or header.name == "LICENSE.txt":
            sources[f"headers/{header.name}"] = header.read_bytes()
    return sources


def write_sources(folder: Path, sources: Mapping[str, bytes]) -> None:
    """Write files of a unit into a folder."""
    for name, data in sources.items():
        place = folder / name
        place.parent.mkdir(exist_ok=True)
        place.write_bytes(data)
