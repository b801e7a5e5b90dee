"""Evaluation of formulas of complex amplitudes over the frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.results.harmonic_measures import FREQUENCY
from dalembert.symbolic.formulas.expression import Expression, stack


def measure_function(
    response: Any, outputs: Sequence[ca.SX], measure: Expression
) -> tuple[ca.Function, list[np.ndarray]]:
    """A function of transfers, frequency, spectra and parameters, and its arguments (…, K).

    Parameters
    ----------
    response : HarmonicResponse
    outputs : expressions of the symbols of the measure
    measure : formula with the transfers
    """
    transfers, count = response.transfers(measure), response.time.size
    amplitudes: dict[str, np.ndarray] = {}
    rows = []
    for _, transfer in transfers:
        if transfer.output not in amplitudes:
            amplitudes[transfer.output] = response.complex_values(transfer.output)
        column = amplitudes[transfer.output][:, response.column(transfer)]
        rows.append(column.real if transfer.part == "real" else column.imag)
    p, spectra = response.parameter_symbols, response.spectra
    further = [FREQUENCY.sx, *(symbol for symbol, _ in spectra)]
    symbols = [stack(symbol for symbol, _ in transfers), stack(further), p]
    function = ca.Function("measure", symbols, [ca.densify(o) for o in outputs])
    numbers = np.array(rows).reshape(len(rows), count)
    along = np.array([response.frequencies, *(column for _, column in spectra)])
    values = np.tile(response.parameters[: p.numel(), None], count)
    return function, [numbers, along, values]
