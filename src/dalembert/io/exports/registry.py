"""Registry of export formats: name → suffix, sources and writer.

A new format is one module with a function ``(source, name, **options) → Files``, and one row.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from dalembert.errors import UnsupportedError
from dalembert.io.exports.option_values import check_values
from dalembert.io.model_file import ModelFile
from dalembert.model.graph.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.labelled import LabelledRecording
from dalembert.results.modes import Numbered
from dalembert.results.structural.states import StructuralStates
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_keywords

if TYPE_CHECKING:
    from dalembert.io.exports.exported import Files

SOURCES = {
    "model file": "a model file",
    "mechanism": "a mechanism",
    "structure model": "a model of a structure",
    "motion": "a motion of a mechanism",
    "mechanism modes": "modes of a mechanism",
    "structure": "a result of a structure",
    "structure modes": "modes of a structure",
    "batch": "results of many designs",
}
"""Kind of a source → its name in messages."""
RESULTS = ("motion", "mechanism modes", "structure", "structure modes", "batch")


@dataclass(frozen=True)
class Format:
    """A format of exported files.

    Attributes
    ----------
    suffix : of the main file
    writer : ``module:function`` of the function that creates the contents
    takes : kinds of sources; from the command line, the first that the model file has
    contents : description for tables
    """

    suffix: str
    writer: str
    takes: tuple[str, ...]
    contents: str

    @property
    def of_model(self) -> bool:
        """Whether the command line exports the model without running the analysis."""
        return self.takes[0] == "mechanism"

    @property
    def of_file(self) -> bool:
        """Whether the source is the model file itself."""
        return self.takes[0] == "model file"

    def create(self, source: Any, name: str, options: Mapping[str, Any]) -> Files:
        """Contents of the files.

        Raises
        ------
        UnsupportedError
            The format has no such source, or cannot express a part of it.
        KeywordError
            Unknown option.
        """
        kind = kind_of(source)
        if kind not in self.takes:
            accepted = ", ".join(SOURCES[k] for k in self.takes)
            results = {"mechanism": "motion", "structure model": "structure"}
            remedy = "; analyse it first" if results.get(kind) in self.takes else ""
            raise UnsupportedError(
                f"{self.suffix} files contain {accepted}, not {SOURCES[kind]}{remedy}"
            )
        self.check_options(options)
        contents: Files = self._writer()(source, name, **options)
        return contents

    def check_options(self, options: Mapping[str, Any]) -> None:
        """Refuse unknown options and values that they do not accept.

        Raises
        ------
        KeywordError
            Unknown option; ``UnsupportedError`` for a value.
        """
        known, owner = list(inspect.signature(self._writer()).parameters)[2:], self.suffix
        check_keywords(f"export to {owner}", options, known)
        check_values(f"export to {owner}", options)

    def _writer(self) -> Callable[..., Files]:
        module, _, function = self.writer.partition(":")
        writer: Callable[..., Files] = getattr(import_module(module), function)
        return writer


def _row(suffix: str, writer: str, takes: tuple[str, ...], contents: str) -> Format:
    return Format(suffix, f"dalembert.io.exports.{writer}", takes, contents)


FORMATS: dict[str, Format] = {
    "mjcf": _row(".xml", "mjcf.mjcf:mjcf_file", ("mechanism",), "the mechanism, for MuJoCo"),
    "urdf": _row(
        ".urdf", "urdf.urdf:urdf_file", ("mechanism",), "the mechanism, for programs of robotics"
    ),
    "fmu": _row(
        ".fmu",
        "fmu:fmu_file",
        ("mechanism", "motion"),
        "a functional mock-up unit, which runs in other programs",
    ),
    "dxf": _row(
        ".dxf",
        "dxf:dxf_file",
        ("mechanism", "motion"),
        "a position of a planar mechanism, as a drawing",
    ),
    "gltf": _row(
        ".glb",
        "gltf:gltf_file",
        ("motion", "mechanism modes", "structure", "structure modes", "mechanism"),
        "animation in three dimensions, for viewers and web pages",
    ),
    "vtk": _row(
        ".pvd",
        "vtk.series:vtk_series",
        ("motion", "mechanism modes", "structure", "structure modes"),
        "series of grids with fields, for ParaView",
    ),
    "latex": _row(
        ".tex", "latex.equations:latex_file", ("mechanism",), "equations of a small mechanism"
    ),
    "python": _row(
        ".py", "python.script:python_file", ("model file",), "the model file as a Python script"
    ),
    "mat": _row(".mat", "mat:mat_file", RESULTS, "measures over time, for MATLAB and Octave"),
    "parquet": _row(".parquet", "parquet:parquet_file", RESULTS, "measures over time, as a table"),
}
"""Name → format."""


def kind_of(source: Any) -> str:
    """Kind of a source, a key of ``SOURCES``.

    Raises
    ------
    UnsupportedError
        It is neither a model nor a result.
    """
    if isinstance(source, ModelFile):
        return "model file"
    if isinstance(source, Model):
        return "mechanism"
    if isinstance(source, ParametricModel):
        return "structure model"
    if isinstance(source, Batch):
        return "batch"
    if isinstance(source, Numbered):
        return "structure modes" if isinstance(source, StructuralStates) else "mechanism modes"
    if isinstance(source, StructuralStates):
        return "structure"
    if isinstance(source, LabelledRecording):
        return "motion"
    raise UnsupportedError(
        "export writes models, model files and results of analyses; got "
        f"{type(source).__name__} {source!r:.60}"
    )
