"""Rows of a frequency response in a page: formulas of complex amplitudes, and their grid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.frequency import frequency_grid as grid, undamped
from dalembert.analysis.frequency.linear_analysis import UNSTABLE
from dalembert.analysis.frequency.linear_mechanism import RESONANT
from dalembert.results.harmonic_measures import FREQUENCY, Transfer
from dalembert.results.sources import Row
from dalembert.symbolic.formulas.expression import Expression, stack


class Transfers:
    """Complex amplitudes on which rows depend.

    Parameters
    ----------
    response : harmonic response
    rows : formulas of parts of amplitudes, the frequency and parameters

    Attributes
    ----------
    measures : measures of the model, one for each output
    """

    def __init__(self, response: Any, rows: Sequence[Row]):
        self.response, self.column = response, ca.densify(stack(row.sx for row in rows))
        symbols = ca.symvar(self.column)
        self.parts = [(s, part) for s in symbols if (part := Transfer.of(s.name())) is not None]
        self.names = list(dict.fromkeys(part.output for _, part in self.parts))
        self.measures: list[Expression] = [response.output(name) for name in self.names]

    def functions(self, p: ca.SX) -> dict[str, ca.Function]:
        """``outputs(f, h, p)``, and its derivatives by ``h``, ``p`` and ``f``, by rows.

        ``h`` has the real and the imaginary part of each measure for each input.
        """
        count = len(self.response.inputs)
        h = ca.SX.sym("h", 2 * count * max(1, len(self.names)))
        places = [
            h[
                2 * (self.names.index(t.output) * count + self.response.column(t))
                + int(t.part == "imag")
            ]
            for _, t in self.parts
        ]
        symbols = stack(symbol for symbol, _ in self.parts)
        (column,) = ca.substitute([self.column], [symbols], [stack(places)])
        inputs = [FREQUENCY.sx, h, p]
        slopes = [ca.densify(ca.jacobian(column, by)).T for by in (h, p, FREQUENCY.sx)]
        return {
            "outputs": ca.Function("outputs", inputs, [column], {"cse": True}),
            "slopes": ca.Function("slopes", inputs, slopes, {"cse": True}),
        }


def frequency_data(response: Any, times: np.ndarray, transfers: Transfers) -> dict[str, Any]:
    """Constants of the frequencies of a response, which follow its resonances by default."""
    analysis = response.analysis
    default = analysis.frequencies is None
    span = None if analysis.span is None else [float(end) for end in analysis.span]
    return {
        "kind": "frequency",
        "times": response.frequencies,
        "requested": np.setdiff1d(times, response.frequencies),
        "relative": [],
        "roots": [],
        "inputs": len(response.inputs),
        "measures": len(transfers.measures),
        "name": analysis.display_name,
        "grid": {
            "default": default,
            "span": span,
            "decade": grid.PER_DECADE,
            "across": grid.ACROSS,
            "widest": grid.WIDEST,
            "narrowest": grid.NARROWEST,
            "gap": grid.GAP,
            "margin": grid.MARGIN,
            "many": grid.MANY,
            "close": grid.CLOSE,
            "reach": grid.REACH,
            "rounds": grid.ROUNDS,
            "steps": grid.MOST_STEPS,
            "undamped": undamped.UNDAMPED,
            "rounding": undamped.ROUNDING,
            "near": undamped.NEAR,
            "far": undamped.FAR,
            "growth": undamped.GROWTH,
            "unstable": UNSTABLE,
            "resonant": RESONANT,
        },
    }
