"""Functions of an analysis that a live page evaluates for other parameters.

Their WebAssembly module contains all mechanics: assembly, steps, outputs and their adjoints. The
loops over steps and iterations are those of the script ``report/assets/live_run.js``.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import casadi as ca
import numpy as np

if TYPE_CHECKING:
    from dalembert.model.value_limits import ValueLimit
    from dalembert.symbolic.formulas.expression import Expression
    from dalembert.symbolic.native.webassembly import WebModule, WebSource


class PageResponse(Protocol):
    """The part of a response that a page needs."""

    @property
    def label(self) -> str: ...
    @property
    def measure(self) -> str | Expression: ...
    @property
    def constant(self) -> float: ...
    @property
    def terms(self) -> tuple[tuple[float, Any], ...]: ...
    def unit_of(self, source: Any) -> str: ...
    def reduction(self, times: np.ndarray) -> dict[str, Any]: ...


@dataclass(frozen=True, eq=False)
class PageDesigns:
    """Designs of the table of a page, as parameters of its model.

    Attributes
    ----------
    names : parameters that differ
    values : (designs, names) [SI units]
    initial : number of the design with which the page compares others; the result of the page if
        None
    ranges : parameter → ends of its slider [SI units]; by default its bounds. They are widened for
        the designs
    """

    names: Sequence[str]
    values: np.ndarray
    initial: int | None = None
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def rows(self, names: Sequence[str], base: np.ndarray) -> np.ndarray:
        """(designs, names) all parameters, those that do not differ from ``base``."""
        rows = np.tile(base[: len(names)], (len(self.values), 1))
        rows[:, [list(names).index(name) for name in self.names]] = self.values
        return rows


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

    def with_numbers(self, numbers: Sequence[ca.SX], p: ca.SX) -> LiveFunctions:
        """The same with a function ``numbers(p)`` of parameters, for pictures."""
        graph = ca.densify(ca.vertcat(*numbers)) if numbers else ca.SX.zeros(1)
        function = ca.Function("numbers", [p], [graph], {"cse": True})
        return replace(self, functions={**self.functions, "numbers": function})

    def with_limits(self, p: ca.SX, limits: Sequence[ValueLimit]) -> LiveFunctions:
        """The same with a function ``quantities(p)`` of the numbers that have limits."""
        if not limits:
            return self
        graph = ca.densify(ca.vertcat(*(limit.graph for limit in limits)))
        functions = {"quantities": ca.Function("quantities", [p], [graph], {"cse": True})}
        data = {"quantities": [limit.data() for limit in limits]}
        return LiveFunctions({**self.functions, **functions}, {**self.data, **data})

    @cached_property
    def source(self) -> WebSource:
        """C text of the functions."""
        from dalembert.symbolic.native.webassembly import WebSource

        return WebSource.of(self.functions)

    @cached_property
    def module(self) -> WebModule:
        """The compiled functions."""
        return self.source.module()

    def page_data(self, **more: Any) -> dict[str, Any]:
        """Module, constants and more data of the script as plain data."""
        module = self.module
        sizes = {
            name: {"inputs": f.inputs, "outputs": f.outputs, "work": f.work}
            for name, f in module.functions.items()
        }
        code = base64.b64encode(zlib.compress(module.code, 9)).decode("ascii")
        exact = json.dumps({**self.data, **more}, default=lambda array: array.tolist())
        constants = {"kind": self.data["kind"], "memory": module.data_end, "functions": sizes}
        return constants | {"code": code, "exact": exact}
