"""Modes of a linearised mechanism and their measures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.graph.model import Model
from dalembert.results.files.contents import Contents
from dalembert.results.modes import Modes
from dalembert.symbolic.formulas.expression import Expression, free_symbols
from dalembert.symbolic.formulas.parser import Names
from dalembert.text.wording import counted, listed

if TYPE_CHECKING:
    from dalembert.results.live import PageResponse

REAL, IMAG = ca.SX.sym("eigenvalue_real"), ca.SX.sym("eigenvalue_imag")
MAGNITUDE = ca.sqrt(REAL**2 + IMAG**2)
MEASURES = {
    "frequency": Expression(MAGNITUDE / (2 * np.pi), "frequency", "Hz"),
    "angular_frequency": Expression(MAGNITUDE, "angular_frequency", "rad/s"),
    "damping_ratio": Expression(
        ca.if_else(MAGNITUDE > 0, -REAL / ca.if_else(MAGNITUDE > 0, MAGNITUDE, 1), 0),
        "damping_ratio",
        "1",
    ),
    "eigenvalue_real": Expression(REAL, "eigenvalue_real", "1/s"),
    "eigenvalue_imag": Expression(IMAG, "eigenvalue_imag", "rad/s"),
}
"""Measures of a mode with eigenvalue ``s``."""


class MechanismModes(Modes):
    """Eigenvalues and modes of the linearised mechanism, numbered by increasing ``|s|``.

    Attributes
    ----------
    eigenvalues : (k,) complex [1/s]; one of each conjugate pair
    shapes : (n, k) complex displacements, maximum entry one
    status : Status, with the residual of the equilibrium
    """

    model: Model
    named = MEASURES
    exported = ("frequency", "damping_ratio")

    @property
    def matrix(self) -> np.ndarray:
        """Reduced state matrix."""
        return self.record.matrix  # type: ignore[no-any-return]

    @staticmethod
    def formula(model: Model, measure: str | Expression) -> Expression:
        """A measure of modes by its name, or a formula of such measures and of parameters.

        Raises
        ------
        AnalysisError
            It depends on a quantity that a mode does not have; ``ExpressionError`` if a text
            names it.
        """
        symbols = model.parameters | model.derived_parameters | MEASURES
        expression = Names(symbols.get, lambda: list(symbols)).expression(measure)
        foreign = free_symbols(expression.sx) - {REAL.name(), IMAG.name(), *model.parameters}
        if foreign:
            raise AnalysisError(
                f"a mode has no {', '.join(sorted(foreign))}; it has {', '.join(MEASURES)}"
            )
        return expression

    def values(self, measure: str | Expression) -> np.ndarray:
        """(k,) values of a measure or formula."""
        expression = self.expression(measure)
        function = ca.Function("measure", [REAL, IMAG, self.model.equations.p], [expression.sx])
        return self._evaluate(function)[0]

    def slopes(self, measure: Expression) -> tuple[np.ndarray, np.ndarray]:
        """``(k,) ∂m/∂Re s − i ∂m/∂Im s``, so that ``dm = Re(slope ds)``, and (np, k) ``∂m/∂p``."""
        inputs = [REAL, IMAG, self.model.equations.p]
        gradient = ca.gradient(measure.sx, ca.vertcat(*inputs))
        values = self._evaluate(ca.Function("slopes", inputs, [ca.densify(gradient)]))
        return values[0] - 1j * values[1], values[2:]

    def _evaluate(self, function: ca.Function) -> np.ndarray:
        s, p = self.eigenvalues, self.parameters
        if not s.size:
            return np.zeros((function.size1_out(0), 0))
        return function.map(s.size)(s.real, s.imag, np.tile(p[:, None], s.size)).full()

    # output --------------------------------------------------------------------------------
    def report(  # type: ignore[override]
        self,
        path: str | Path,
        units: Sequence[str] = (),
        views: Sequence[Mapping[str, Any]] = (),
        live: bool | None = None,
        responses: Sequence[PageResponse] = (),
    ) -> Path:
        """Write the interactive report, one self-contained HTML file.

        The mechanism moves in the selected mode; a table and the complex plane contain all
        eigenvalues. In a live page every parameter is a slider, and the page linearises the
        mechanism again while it moves.

        Parameters
        ----------
        units : units of the page, such as ``["mm", "kHz"]``; each applies to its dimension
        views : further cards, from functions of ``dalembert.report.views``
        live : whether the page is live; by default if the model has parameters with bounds and the
            compiled functions have at most 300 kB. A page that is not live states the reason
        responses : responses that a live page lists with their slopes, such as
            ``[da.at(1, "damping_ratio")]``; by default the frequencies

        Raises
        ------
        UnsupportedError
            A page does not compute one of the responses.
        """
        from dalembert.report.page import write_page

        page = self.page(units, views)
        return write_page(self.live_page(page, live, responses, units=units), path)

    def page(
        self,
        units: Sequence[str] = (),
        views: Sequence[Mapping[str, Any]] = (),
        **initial_view: Any,
    ) -> dict[str, Any]:
        """Payload of the report; ``initial_view`` (plots, traces) applies to motions only."""
        from dalembert.results.files.modes_payload import modes_payload

        return modes_payload(self, units) | {"views": list(views)}

    @cached_property
    def contents(self) -> Contents:
        along, names = ("coordinate", "mode"), self.record.kernel.view.speed_names
        shapes = {"shape_real": (along, self.shapes.real), "shape_imag": (along, self.shapes.imag)}
        return super().contents.plus(shapes, {"coordinate": list(names)})

    def __repr__(self) -> str:
        pairs = zip(self.frequencies, self.damping_ratios, strict=True)
        count = counted(len(self.frequencies), "mode")
        rows = listed(f"{f:.6g} Hz (ζ {z:+.3g})" for f, z in pairs)
        return f"<{type(self).__name__} of {self.model.name!r}: {count}, {rows}>"
