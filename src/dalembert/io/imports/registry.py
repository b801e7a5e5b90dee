"""Registry of the formats that can be imported, and their common entry."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dalembert.errors import FileError
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.mjcf.reading import read_mjcf
from dalembert.io.imports.robots.sdf.reading import read_sdf
from dalembert.io.imports.robots.urdf import read_urdf
from dalembert.io.imports.sketches.sketch import read_dxf, read_svg
from dalembert.io.imports.solids.meshes import SUFFIXES as MESHES, read_mesh
from dalembert.io.imports.solids.step import read_step
from dalembert.text.wording import unknown


@dataclass(frozen=True)
class Format:
    """A kind of file of another program.

    Attributes
    ----------
    name : such as ``"URDF"``
    suffixes : endings of file names, in lower case, with their dots
    contents : description for help texts
    read : reader of a path; its keywords are the options of the format
    """

    name: str
    suffixes: tuple[str, ...]
    contents: str
    read: Callable[..., Imported]

    @property
    def options(self) -> list[str]:
        """Names of the keywords of the reader."""
        return list(inspect.signature(self.read).parameters)[1:]


FORMATS: tuple[Format, ...] = (
    Format("URDF", (".urdf",), "links and joints of a robot", read_urdf),
    Format("SDF", (".sdf", ".world"), "models and worlds of Gazebo", read_sdf),
    Format("MJCF", (".mjcf", ".xml"), "bodies and joints of MuJoCo", read_mjcf),
    Format("DXF", (".dxf",), "planar mechanism in a drawing", read_dxf),
    Format("SVG", (".svg",), "planar mechanism in a drawing", read_svg),
    Format("STEP", (".step", ".stp"), "bodies of the solids of a CAD model", read_step),
    Format("mesh", MESHES, "bodies of closed surfaces", read_mesh),
)


def import_model(path: str | Path, **options: Any) -> Imported:
    """Read the model in a file of another program.

    Parameters
    ----------
    path : of the file; its suffix selects the format
    **options : keywords of the reader of the format

    Returns
    -------
    Imported
        Its ``document`` has the sections of a model file, its ``omissions`` list what could not
        be converted; ``build()`` returns the model, ``write(path)`` writes the model file.

    Raises
    ------
    FileError, ModelError
        Names file, line, element, value and a fix.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import dalembert as da
    >>> text = '''
    ... <mujoco><worldbody><body name="rod" pos="0 0 2">
    ...   <joint name="pin" axis="0 1 0"/>
    ...   <geom type="capsule" fromto="0 0 0 1 0 0" size="0.02" mass="3"/>
    ... </body></worldbody></mujoco>
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "pendulum.xml")
    ...     written = path.write_text(text)
    ...     imported = da.import_model(path)
    >>> imported.document["joints"]
    {'pin': {'type': 'Revolute', 'connect': ['ground.pin', 'rod.pin']}}
    >>> imported.build().diagnosis.degrees_of_freedom
    1
    """
    path = Path(path)
    chosen = format_of(path)
    for option in options:
        if option not in chosen.options:
            raise FileError(f"{path}: {chosen.name}: {unknown('option', option, chosen.options)}")
    return chosen.read(path, **options)


def format_of(path: Path) -> Format:
    """The format of a file, by its suffix.

    Raises
    ------
    FileError
        Unknown suffix; lists the formats.
    """
    suffixes = {suffix: entry for entry in FORMATS for suffix in entry.suffixes}
    suffix = path.suffix.lower()
    if suffix in (".toml", ".json"):
        raise FileError(f"{path}: is a model file; use it directly, without import")
    if suffix not in suffixes:
        raise FileError(f"{path}: {unknown('format', suffix or path.name, suffixes)}")
    return suffixes[suffix]
