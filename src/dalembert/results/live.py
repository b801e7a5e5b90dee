"""Functions of an analysis that a live page evaluates for other parameters.

Their WebAssembly module contains all mechanics: assembly, steps, outputs and their adjoints. The
loops over steps and iterations are those of the script ``report/assets/live_run.js``.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca

from dalembert.errors import AnalysisError
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    from dalembert.symbolic.native.webassembly import WebModule


WORK_ROWS = {
    "dissipated_energy": ((1.0, 0.0), False),
    "input_energy": ((0.0, 1.0), False),
    "balance_error": ((1.0, -1.0), True),
}
"""Energy of a result → factors of the dissipated energy and the energy input, and whether the
kinetic and potential energy are added."""


@dataclass(frozen=True)
class Row:
    """Scalar output over time.

    Attributes
    ----------
    expression : SX of coordinates, speeds, accelerations, multipliers, time and parameters
    work : factors of the dissipated energy and of the energy input, which are added
    relative : whether the value at the first output is subtracted
    """

    expression: ca.SX
    work: tuple[float, float] = (0.0, 0.0)
    relative: bool = False


def measure_row(model: Any, name: str | Expression) -> Row:
    """Row of a measure or formula, or of an energy of the result.

    Raises
    ------
    AnalysisError
        The measure is a vector.
    """
    if isinstance(name, str) and name in WORK_ROWS:
        work, of_energy = WORK_ROWS[name]
        total = model.expression("energy").sx if of_energy else ca.SX(0)
        return Row(total, work, relative=True)
    expression = model.expression(name)
    if len(expression) > 1:
        text = name if isinstance(name, str) else name.name
        raise AnalysisError(f"measure {text!r} has {len(expression)} components; take one")
    return Row(expression.sx)


@dataclass(frozen=True, eq=False)
class LiveFunctions:
    """Functions of an analysis and the constants of its script.

    Attributes
    ----------
    functions : name → function
    data : kind of the analysis, times, tolerances; plain data
    """

    functions: Mapping[str, ca.Function]
    data: Mapping[str, Any]

    @cached_property
    def module(self) -> WebModule:
        """The compiled functions."""
        from dalembert.symbolic.native.webassembly import web_module

        return web_module(self.functions)

    def page_data(self, **more: Any) -> dict[str, Any]:
        """Module, constants and more data of the script as plain data."""
        module = self.module
        sizes = {
            name: {"inputs": f.inputs, "outputs": f.outputs, "work": f.work}
            for name, f in module.functions.items()
        }
        code = base64.b64encode(zlib.compress(module.code, 9)).decode("ascii")
        exact = json.dumps({**self.data, **more}, default=lambda array: array.tolist())
        return {"functions": sizes, "memory": module.data_end, "code": code, "exact": exact}
