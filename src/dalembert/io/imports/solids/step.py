"""Bodies of the solids in STEP files, read with Open CASCADE.

Volumes and moments are integrals over the exact surfaces.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import FileError, ModelError
from dalembert.files import atomic_path, readable
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.solids.solid import Solid, imported_solids
from dalembert.io.omission import Omission
from dalembert.packages import optional_package

WEIGHT = 300
"""Memory per byte of a file while it is read [bytes]."""
MILLIMETRE = 1e-3
"""Unit of length of Open CASCADE [m]."""
MOST = 1000
"""Upper limit of the number of solids."""
DEPTH = 40
"""Upper limit of the depth of assemblies in assemblies."""
DEFLECTION = 0.01
"""Deviation of the triangles of a picture over the size of the solid."""


def read_step(
    path: Path,
    *,
    density: float | str | None = None,
    mass: float | str | None = None,
    surfaces: str | Path | None = None,
) -> Imported:
    """Bodies of the solids in a STEP file, with names and places of the assembly.

    Parameters
    ----------
    path : of the file
    density : of all solids; that of steel by default [kg/m³]
    mass : of all solids together, in place of the density [kg]
    surfaces : folder for STL files of the solids, for pictures; without it there are none

    Raises
    ------
    FileError, ModelError
        The file is unreadable, or has no solids.
    UnsupportedError
        Open CASCADE is not installed.
    """
    path = Path(path)
    optional_package("OCP", f"reading {path}", "export an STL file for each body")
    if readable(path, WEIGHT) == 0:
        raise FileError(f"{path}: the file is empty; export the solid again")
    with path.open("rb") as stream:
        if b"ISO-10303-21" not in stream.read(4096):
            raise FileError(f"{path}: is no STEP file, which begins with ISO-10303-21; export it")
    folder = None if surfaces is None else Path(surfaces)
    if folder is not None and not folder.is_dir():
        raise FileError(f"{folder}: is no folder; create it, or give another")
    try:
        reader = _Assembly(path, folder)
        solids = list(reader.solids())
    except (FileError, ModelError):
        raise
    except Exception as error:  # exceptions of Open CASCADE have many types
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise FileError(f"{path}: cannot be read as STEP ({reason}); export it again") from None
    return imported_solids(path, solids, density, mass, reader.omissions)


@dataclass
class _Assembly:
    """Document of Open CASCADE.

    Parameters
    ----------
    path : of the file
    folder : for surfaces
    """

    path: Path
    folder: Path | None
    omissions: list[Omission] = field(default_factory=list)
    count: int = 0

    def __post_init__(self) -> None:
        from OCP.IFSelect import IFSelect_RetDone
        from OCP.Message import Message
        from OCP.STEPCAFControl import STEPCAFControl_Reader
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDocStd import TDocStd_Document
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        messenger = Message.DefaultMessenger_s()
        for printer in list(messenger.Printers()):
            messenger.RemovePrinter(printer)
        self.document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        if reader.ReadFile(str(self.path)) != IFSelect_RetDone:
            raise FileError(f"{self.path}: cannot be read as STEP; export it again")
        if not reader.Transfer(self.document):
            raise FileError(f"{self.path}: has no shapes that can be read; export solids")
        self.tool = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())

    def solids(self) -> Iterator[Solid]:
        """Solids of all parts, in the order of the file."""
        from OCP.collections import Sequence_TDF_Label

        labels = Sequence_TDF_Label()
        self.tool.GetFreeShapes(labels)
        for label in _entries(labels):
            yield from self._part(label, _name(label), np.eye(4), 0)

    def _part(self, label: Any, name: str, pose: np.ndarray, depth: int) -> Iterator[Solid]:
        from OCP.collections import Sequence_TDF_Label
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        if depth > DEPTH:
            raise ModelError(f"assemblies are nested more than {DEPTH} deep", str(self.path))
        if not XCAFDoc_ShapeTool.IsAssembly_s(label):
            yield from self._bodies(XCAFDoc_ShapeTool.GetShape_s(label), name, pose)
            return
        components = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetComponents_s(label, components)
        for component in _entries(components):
            part = TDF_Label()
            XCAFDoc_ShapeTool.GetReferredShape_s(component, part)
            location = XCAFDoc_ShapeTool.GetLocation_s(component).Transformation()
            own, shared = _name(component), _name(part)
            chosen = shared if not own or own.startswith(("NAUO", "=>")) else own
            yield from self._part(part, chosen or shared, pose @ _matrix(location), depth + 1)

    def _bodies(self, shape: Any, name: str, pose: np.ndarray) -> Iterator[Solid]:
        from OCP.TopAbs import TopAbs_SOLID
        from OCP.TopExp import TopExp_Explorer

        explorer, empty = TopExp_Explorer(shape, TopAbs_SOLID), True
        while explorer.More():
            empty = False
            self.count += 1
            if self.count > MOST:
                message = f"has more than {MOST} solids; import a part of it"
                raise ModelError(message, str(self.path))
            yield self._solid(explorer.Current(), name, pose)
            explorer.Next()
        if empty:
            reason = "has surfaces or lines only, and no mass; export it as a solid"
            self.omissions.append(Omission(f"{self.path}: {name or 'part'}", "part", reason))

    def _solid(self, shape: Any, name: str, pose: np.ndarray) -> Solid:
        from OCP.BRepGProp import BRepGProp
        from OCP.GProp import GProp_GProps

        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(shape, properties)
        center, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
        moments = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
        name = name or f"{self.path.stem}_{self.count}"
        return Solid(
            name,
            f"{self.path}: solid {name!r}",
            properties.Mass() * MILLIMETRE**3,
            np.array([center.X(), center.Y(), center.Z()]) * MILLIMETRE,
            moments * MILLIMETRE**5,
            pose[:3, 3] * MILLIMETRE,
            pose[:3, :3],
            self._surface(shape, name),
        )

    def _surface(self, shape: Any, name: str) -> tuple[Path, float] | None:
        """An STL file of a solid."""
        if self.folder is None:
            return None
        from OCP.BRepMesh import BRepMesh_IncrementalMesh
        from OCP.StlAPI import StlAPI_Writer

        BRepMesh_IncrementalMesh(shape, DEFLECTION, True, 0.3).Perform()
        stem = "".join(c if c.isalnum() else "_" for c in name)[:60]
        target = (self.folder / f"{stem}_{self.count}.stl").absolute()
        with atomic_path(target) as temporary:
            StlAPI_Writer().Write(shape, str(temporary))
        return target, MILLIMETRE


def _entries(sequence: Any) -> list[Any]:
    return [sequence.Value(k) for k in range(1, sequence.Length() + 1)]


def _name(label: Any) -> str:
    """Name of a part; empty for none."""
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), name):
        return ""
    return str(name.Get().ToExtString())


def _matrix(transformation: Any) -> np.ndarray:
    rows = [[transformation.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
    return np.array([*rows, [0.0, 0.0, 0.0, 1.0]])
