"""Files of a text for other programs: pages, pictures, films, tables, scripts and models."""

from __future__ import annotations

import re
import warnings
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dalembert.errors import UnsupportedError
from dalembert.files import atomic_path
from dalembert.io.exports.export import write_files
from dalembert.io.exports.registry import FORMATS
from dalembert.io.model_file import ModelFile, check_model_data
from dalembert.io.reading import parse_document
from dalembert.io.report import exported_measures, live_responses, report_choices
from dalembert.report.exports import FORMATS as MODULES
from dalembert.results.result import Result
from dalembert.studio.pictures import result_of

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Choice:
    """A kind of file.

    Attributes
    ----------
    title : for people
    group : heading under which it is listed
    suffix : of the file
    """

    title: str
    group: str
    suffix: str


_TITLES = {
    "mjcf": "MuJoCo (MJCF)",
    "urdf": "URDF",
    "fmu": "FMU",
    "dxf": "DXF drawing",
    "gltf": "glTF animation",
    "vtk": "VTK for ParaView",
    "latex": "LaTeX equations",
    "python": "Python script",
    "mat": "MATLAB table",
    "parquet": "Parquet table",
    "js": "JavaScript module",
}
_GROUPS = {"mat": "Results", "parquet": "Results", "python": "Model", "latex": "Model"}
CHOICES: dict[str, Choice] = {
    "toml": Choice("Model file", "Model", ".toml"),
    "page": Choice("Page (HTML)", "Pictures", ".html"),
    **{name: Choice(name.upper(), "Pictures", f".{name}") for name in ("svg", "png", "pdf")},
    "gif": Choice("Film (GIF)", "Pictures", ".gif"),
    "mp4": Choice("Film (MP4)", "Pictures", ".mp4"),
    "csv": Choice("CSV table", "Results", ".csv"),
    **{
        name: Choice(_TITLES.get(name, name), _GROUPS.get(name, "Other programs"), entry.suffix)
        for name, entry in FORMATS.items()
    },
    **{name: Choice(_TITLES.get(name, name), "Other programs", ".js") for name in MODULES},
}
"""Name of a kind of file → its description, in the order of the page."""


@dataclass(frozen=True)
class ExportRequest:
    """A text and the kind of file to make of it.

    Attributes
    ----------
    to : key of ``CHOICES``
    text, path : of the model file
    share : instant of a picture as a fraction of the motion
    folder : for the file
    """

    to: str
    text: str
    path: Path
    share: float
    folder: Path


def write_export(request: ExportRequest, progress: Progress) -> tuple[Path, list[str]]:
    """Write the file of a request, several as an archive; returns it, and what is left out.

    Raises
    ------
    DalembertError
        The model or its analysis is invalid, or the format cannot express it.
    """
    name = re.sub(r"[^\w.-]+", "_", request.path.stem)[:80] or "model"
    target = request.folder / f"{name}{CHOICES[request.to].suffix}"
    if request.to == "toml":
        with atomic_path(target) as temporary:
            temporary.write_text(request.text, encoding="utf-8", newline="")
        return target, []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = check_model_data(parse_document(request.path, request.text), request.path)
        files, omissions = _write(request, file, target, progress)
    if len(files) == 1:
        return files[0], omissions
    archive = target.with_suffix(".zip")
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in files:
            packed.write(path, path.name)
    return archive, omissions


def _write(
    request: ExportRequest, file: ModelFile, target: Path, progress: Progress
) -> tuple[list[Path], list[str]]:
    """Write the files of a request."""
    to = request.to
    if to in FORMATS and FORMATS[to].of_file:
        return _files(to, file, target)
    model = file.model()
    progress(0.1)
    if to in FORMATS and FORMATS[to].of_model and model.kind == "mechanism":
        return _files(to, model, target)
    result = result_of(file, model)
    progress(0.4)
    if to in FORMATS:
        return _files(to, result, target)
    if to in MODULES:
        from dalembert.io.decisions.responses import make_responses
        from dalembert.results.module import build_module

        measures = exported_measures(file, model, result)
        module = build_module(result, measures, list(make_responses(file, model).values()))
        return module.export(target.parent, to, target.stem), []
    choices = report_choices(file, model)
    if to == "csv":
        return [result.to_csv(target, choices.get("units", ()))], []
    return [_shown(request, file, model, result, choices, target, progress)], []


def _files(to: str, source: Any, target: Path) -> tuple[list[Path], list[str]]:
    """Files of a format of ``da.export``."""
    contents = FORMATS[to].create(source, target.stem, {})
    return write_files(contents, target), [str(omission) for omission in contents.omissions]


def _shown(
    request: ExportRequest,
    file: ModelFile,
    model: Any,
    result: Result,
    choices: Mapping[str, Any],
    target: Path,
    progress: Progress,
) -> Path:
    """Page, picture or film of a result."""
    page = result.page(**choices)
    if request.to == "page":
        from dalembert.report.page import write_page

        units = choices.get("units", ())
        responses = live_responses(file, model, page, result)
        live = result.live_page(page, file.document.report.live, responses, units=units)
        return write_page(live, target)
    import matplotlib as mpl

    mpl.use("Agg")
    from dalembert.results.pictures.animation import STILLS, WRITERS, write_film, write_still

    if target.suffix in STILLS:
        return write_still(page, target, request.share)
    if target.suffix in WRITERS:
        return write_film(page, target, progress=lambda share: progress(0.4 + 0.6 * share))
    raise UnsupportedError(f"{request.to!r} is no kind of file")
