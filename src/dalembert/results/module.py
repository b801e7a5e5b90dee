"""An analysis as a WebAssembly module for other programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.files import atomic_path
from dalembert.results.files.live_responses import page_responses
from dalembert.results.live import LiveFunctions, PageResponse
from dalembert.results.row_table import RowTable
from dalembert.results.variables import energy_sources
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    from dalembert.symbolic.native.webassembly import WebFunction


@dataclass(frozen=True, eq=False, repr=False)
class Module:
    """An analysis of a model as WebAssembly; created by ``Model.module``.

    The module contains all mechanics: assembly, steps, measures and their adjoints, each a function
    of the parameters. The loops over steps and iterations are those of a script, which
    ``Module.export`` writes with the module.

    Attributes
    ----------
    name : of the model
    live : LiveFunctions and the constants of its script
    parameters : rows with name, value, lower, upper, unit and description, in SI units
    outputs : name, unit and row of each measure
    responses : rows with label, unit and terms

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 10.0, "m/s", bounds=(5, 20))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, speed)))
    >>> throw = da.Dynamics(duration=2.0, step=0.1)
    >>> module = system.build().module(throw, ["stone.x", "stone.y"], [da.maximum("stone.y")])
    >>> isinstance(module, da.Module), module.code[:4], module.measures
    (True, b'\\x00asm', {'stone.x': 'm', 'stone.y': 'm'})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in module.export(folder)]
    ['throw.js', 'throw.d.ts', 'throw.html']
    """

    name: str
    live: LiveFunctions
    parameters: Sequence[Mapping[str, Any]]
    outputs: Sequence[tuple[str, str, int]]
    responses: Sequence[Mapping[str, Any]]

    @property
    def code(self) -> bytes:
        """The module."""
        return self.live.module.code

    @property
    def measures(self) -> dict[str, str]:
        """Name of an output over time → its unit."""
        return {name: unit for name, unit, _ in self.outputs}

    @property
    def functions(self) -> Mapping[str, WebFunction]:
        """Name of a function → sizes of its arguments, results and work vectors."""
        return self.live.module.functions

    def save(self, path: str | Path) -> Path:
        """Write the module alone, a ``.wasm`` file; returns its path."""
        with atomic_path(path) as temporary:
            temporary.write_bytes(self.code)
        return Path(path)

    def export(self, folder: str | Path = ".", to: str = "js", name: str = "") -> list[Path]:
        """Write the module with its scripts for a language; returns the paths.

        Parameters
        ----------
        folder : of the files
        to : ``"js"``, an ES module with types and an example page
        name : of the files, by default that of the model

        Raises
        ------
        UnsupportedError
            Unknown language.
        """
        from dalembert.report.exports import write_export

        return write_export(to, self.data(), Path(folder), name or self.name)

    def data(self) -> dict[str, Any]:
        """The module with its parameters, measures and responses as plain data."""
        rows = {"parameters": self.parameters, "responses": self.responses}
        names = {"name": self.name, "measures": self.outputs}
        return names | rows | {"live": self.live.page_data(**rows)}

    def __repr__(self) -> str:
        sizes = f"{len(self.measures)} measures, {len(self.responses)} responses"
        return f"<Module {self.name!r}: {len(self.code) / 1e3:.0f} kB, {sizes}>"


def build_module(
    result: Any, measures: Iterable[str | Expression], responses: Iterable[PageResponse]
) -> Module:
    """Module of the analysis that computed a result.

    Raises
    ------
    UnsupportedError
        The analysis or a response cannot run outside of Python, with the reason.
    """
    model = result.model
    reason = result.analysis.live_obstacle(result)
    if model.kind != "mechanism":
        reason = "only analyses of mechanisms are exported, and it is a structure"
    if reason:
        raise UnsupportedError(f"{model.name!r} cannot be a module: {reason}")
    table, responses = RowTable(model.ground), tuple(responses)
    outputs = [_output(result, table, measure) for measure in measures]
    times = result.page_times({"time": result.time}, responses)
    reductions = page_responses(result, responses, times, table.number)
    extras = result.page_extras(table.number, reductions)
    if not table.rows:
        raise AnalysisError(f"the module of {model.name!r} has no outputs; give measures=[...]")
    live = result.analysis.live_functions(result, table.rows, times)
    live = replace(live, data={**live.data, **extras}).with_limits(*model.value_limits())
    return Module(model.name, live, _parameters(result), outputs, reductions)


def _output(result: Any, table: RowTable, measure: str | Expression) -> tuple[str, str, int]:
    """Name, unit and row of a measure."""
    energies = energy_sources(result.model) if result.analysis.integrates else {}
    if isinstance(measure, str) and measure in energies:
        return measure, "J", table.number(energies[measure])
    expression = result.expression(measure)
    name = measure if isinstance(measure, str) else measure.name
    if not name:
        raise AnalysisError("a measure of a module has no name; give the formula as a text")
    if len(expression) > 1:
        raise AnalysisError(
            f"measure {name!r} has {len(expression)} components; take .x, .y or a norm"
        )
    return name, expression.unit, table.number(ca.SX(expression.sx))


def _parameters(result: Any) -> list[dict[str, Any]]:
    """Parameters in SI units; bounds that are not finite are null."""
    rows = []
    for parameter, value in zip(result.model.parameters.values(), result.parameters, strict=False):
        lower, upper = (float(b) if np.isfinite(b) else None for b in parameter.bounds)
        row = {"name": parameter.name, "value": float(value), "lower": lower, "upper": upper}
        rows.append(row | {"unit": parameter.unit, "description": parameter.description})
    return rows
