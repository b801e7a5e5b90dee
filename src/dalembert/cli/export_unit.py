"""``dalembert export --to fmu``: a model file as a functional mock-up unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    print_files,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import refuse_replacing
from dalembert.errors import UnsupportedError

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile

FMU = "fmu"
"""Name of the format."""


Kind = Annotated[str, Parameter(help="With fmu: cosimulation, model_exchange or both.")]
Version = Annotated[int, Parameter(help="With fmu: version of the standard, 3 or 2.")]
PLATFORM_HELP = "With fmu: platform to compile for, e.g. x86_64-windows; repeatable."
Platforms = Annotated[tuple[str, ...], Parameter(negative=(), help=PLATFORM_HELP)]


@Parameter(name="*")
@dataclass(frozen=True)
class UnitOptions:
    """Options of functional mock-up units.

    Attributes
    ----------
    kind : of a functional mock-up unit: cosimulation, model_exchange or both
    fmi : version of the standard, 3 or 2
    platform : for which it is compiled, e.g. x86_64-windows; this machine by default; repeatable
    """

    kind: Kind = "cosimulation"
    fmi: Version = 3
    platform: Platforms = ("native",)


def export_unit(
    file: ModelFile,
    model: Any,
    folder: Path,
    measures: Sequence[str] | None,
    analysis: str | None,
    options: UnitOptions,
    as_json: bool,
) -> int:
    """Write the unit of a model file; returns the exit code."""
    from dalembert.analysis.dynamics.dynamics import Dynamics
    from dalembert.fmu.export import export_fmu
    from dalembert.io.analyses import make_analysis

    path = folder / f"{file.path.stem}.fmu"
    with wrong_input():
        refuse_replacing(file.path, [path])
        task = make_analysis(file, model, analysis)
        if not isinstance(task, Dynamics):
            raise UnsupportedError(
                f"a functional mock-up unit runs Dynamics, not {type(task).__name__}; give "
                "--analysis Dynamics"
            )
        unit = export_fmu(
            model,
            path,
            task,
            kind=options.kind,
            fmi=options.fmi,
            outputs=measures,
            platforms=options.platform,
        )
    if as_json:
        summary = {"ok": True, "name": file.name, "to": FMU, "bytes": path.stat().st_size}
        names = {"parameters": unit.parameters, "inputs": unit.inputs, "measures": unit.outputs}
        lists = {key: list(values) for key, values in names.items()}
        print_json(summary | lists | {"files": [str(path)], "warnings": list(unit.warnings)})
    else:
        print_heading(file.name, repr(unit).strip("<>"))
        for text in unit.warnings:
            print_line(f"  warning: {text}", "yellow")
        print_files([path])
    return DONE
