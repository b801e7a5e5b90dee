"""Functional mock-up units of mechanisms and of their motions."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dalembert.fmu.export import export_fmu
from dalembert.io.exports.exported import Files
from dalembert.io.omission import Omission
from dalembert.model.graph.model import Model
from dalembert.symbolic.formulas.expression import Expression

STABILITY = "stability of the steps of co-simulation"


def fmu_file(
    source: Any,
    name: str,
    kind: str = "cosimulation",
    fmi: int = 3,
    step: float | None = None,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str | Expression] | None = None,
    states: Iterable[str] | None = None,
    platforms: Iterable[str] = ("native",),
) -> Files:
    """A functional mock-up unit of a mechanism; of a motion with the strategies of its analysis.

    Parameters
    ----------
    kind, fmi, step, inputs, outputs, states, platforms : as of ``export_fmu``
    """
    model, analysis = (
        (source, None) if isinstance(source, Model) else (source.model, source.analysis)
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.fmu"
        unit = export_fmu(
            model,
            path,
            analysis,
            kind=kind,
            fmi=fmi,
            step=step,
            inputs=inputs,
            outputs=outputs,
            states=states,
            platforms=platforms,
        )
        warnings = [Omission(model.name, STABILITY, text) for text in unit.warnings]
        return Files({path.name: path.read_bytes()}, warnings)
