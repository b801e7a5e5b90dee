"""``dalembert import``: model files from files of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    AsJson,
    print_files,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import refuse_replacing
from dalembert.errors import FileError

if TYPE_CHECKING:
    from dalembert.io.imports.imported import Imported
    from dalembert.io.omission import Omission

Packages = Annotated[list[str], Parameter(negative=())]
Switch = Annotated[bool, Parameter(negative=())]
SECTIONS = {
    "bodies": "body",
    "joints": "joint",
    "drivers": "driver",
    "forces": "force",
    "inputs": "input",
}
"""Sections that the summary counts → one of their entries."""
MOST_PLACES = 6
"""Upper limit of the places listed for one reason."""


def import_file(
    file: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    root: Path | None = None,
    package: Packages | None = None,
    base: Annotated[Literal["fixed", "free"] | None, Parameter(show_default=False)] = None,
    keyframe: str | None = None,
    stops: float | None = None,
    repair_inertia: Switch = False,
    unit: str | None = None,
    tolerance: str | None = None,
    mass_per_length: str | None = None,
    speed: str | None = None,
    density: str | None = None,
    mass: str | None = None,
    surfaces: Path | None = None,
    force: Switch = False,
    as_json: AsJson = False,
) -> int:
    """Write the model in a file of another program as a model file.

    Everything that the model does not contain is listed.

    Parameters
    ----------
    file
        File to import; its suffix selects the format.
    output
        Model file to write (TOML); in the current folder, with the name of the file, by default.
    root
        Folder inside which all files are that it refers to; its own folder by default.
    package
        Folder of a package or model that it refers to: NAME=FOLDER; repeatable.
    base
        URDF: the root link is fixed to the ground (default), or free.
    keyframe
        MJCF: name of the keyframe that is the initial position.
    stops
        Stiffness of elastic stops at the limits of joints, in N m/rad or N/m; none by default.
    repair_inertia
        Raise moments of inertia that no body has, instead of refusing them.
    unit
        DXF, SVG, meshes: unit of length of the file, such as in.
    tolerance
        DXF, SVG: distance below which places coincide, in the unit of the drawing or with a unit.
    mass_per_length
        DXF, SVG: mass per length of all lines, in kg/m; 1 by default.
    speed
        DXF, SVG: speed of motors that state none; 60 rpm by default.
    density
        STEP, meshes: density of all solids, in kg/m^3; that of steel by default.
    mass
        STEP, meshes: mass of all solids together, in kg, in place of the density.
    surfaces
        STEP: folder for STL files of the solids, for pictures.
    force
        Replace an existing file.
    """
    from dalembert.io.imports.registry import import_model

    with wrong_input():
        target = output or Path(f"{file.stem}.toml")
        if target.suffix.lower() != ".toml":
            raise FileError(f"{target}: model files are written as TOML; end the name with .toml")
        options = {
            "root": root,
            "packages": _packages(package or []) or None,
            "base": base,
            "keyframe": keyframe,
            "stops": stops,
            "repair_inertia": repair_inertia or None,
            "unit": unit,
            "tolerance": tolerance,
            "mass_per_length": mass_per_length,
            "speed": speed,
            "density": density,
            "mass": mass,
            "surfaces": surfaces,
        }
        chosen = {name: value for name, value in options.items() if value is not None}
        imported = import_model(file, **chosen)
        model: Any = imported.build()
        if target.exists():
            refuse_replacing(file, [target])
            if not force:
                raise FileError(f"{target}: exists already; use --force to replace it")
        imported.write(target)
    omissions = _grouped(imported.omissions)
    if as_json:
        print_json(_summary(imported, model) | {"files": [str(target)]})
        return DONE
    print_heading(model.name, _description(imported))
    for (content, reason), places in omissions.items():
        shown = ", ".join(dict.fromkeys(places[:MOST_PLACES]))
        more = f" and {len(places) - MOST_PLACES} more" if len(places) > MOST_PLACES else ""
        print_line(f"  not converted: {content}: {reason} ({shown}{more})")
    print_files([target])
    print_line(f"now try: dalembert check {target}")
    return DONE


def _packages(texts: list[str]) -> dict[str, Path]:
    """Name → folder, from ``--package`` options."""
    packages = {}
    for text in texts:
        name, equals, folder = text.partition("=")
        if not (name and equals and folder):
            raise FileError(f"--package {text[:60]}: write --package NAME=FOLDER")
        packages[name] = Path(folder)
    return packages


def _grouped(omissions: list[Omission]) -> dict[tuple[str, str], list[str]]:
    """Content and reason → places."""
    groups: dict[tuple[str, str], list[str]] = {}
    for omission in omissions:
        groups.setdefault((omission.content, omission.reason), []).append(omission.place)
    return groups


def _description(imported: Imported) -> str:
    """Number of entries of each section with elements."""
    counts = {section: len(imported.document.get(section, ())) for section in SECTIONS}
    texts = [
        f"{count} {section if count > 1 else SECTIONS[section]}"
        for section, count in counts.items()
        if count
    ]
    return ", ".join(texts) or "empty"


def _summary(imported: Imported, model: Any) -> dict[str, Any]:
    omissions = [vars(omission) for omission in imported.omissions]
    counts = {
        section: len(entries)
        for section, entries in imported.document.items()
        if isinstance(entries, dict)
    }
    return {
        "ok": True,
        "name": model.name,
        "source": str(imported.source),
        "sections": counts,
        "omissions": omissions,
    }
