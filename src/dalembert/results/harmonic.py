"""Harmonic responses: complex amplitudes over the frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.results.analysis import Analysis
from dalembert.results.files.contents import Contents
from dalembert.results.frequency_page import FrequencyPage
from dalembert.results.harmonic_function import measure_function
from dalembert.results.harmonic_measures import (
    FREQUENCY,
    PARTS,
    Transfer,
    consists_of,
    measures_of,
    part_name,
)
from dalembert.results.result import Instants
from dalembert.results.status import Status
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.formulas.parser import Names
from dalembert.text.wording import counted, listed, unknown

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class HarmonicResponse(FrequencyPage):
    """Complex amplitudes of a linear system under harmonic inputs ``Re û exp(iωt)``.

    Measures are ``X.amplitude``, ``X.phase`` [rad], ``X.real`` and ``X.imag`` of any scalar measure
    ``X`` of the model, with several inputs ``X.input.amplitude``, and formulas of them;
    ``frequency`` is in Hz. ``response["X"]`` is complex.

    Attributes
    ----------
    model : analysed model
    analysis : analysis that computed it
    parameters : (n,) values used
    frequencies : (K,) [Hz]
    inputs : names of the inputs, or ``["excitation"]``
    outputs : name → measure, of tables and pages
    motions : (K, N, inputs) complex amplitudes of the unknowns of the record
    record : linear system

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.input("push", unit="N")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> response = da.frequency_response(system.build(), [0.0, 5.0], outputs=["body.x"])
    >>> isinstance(response, da.HarmonicResponse), round(response["body.x.amplitude"][0].item(), 9)
    (True, 0.01)
    """

    model: Any
    analysis: Analysis
    parameters: np.ndarray
    frequencies: np.ndarray
    inputs: list[str]
    outputs: Mapping[str, Expression]
    motions: np.ndarray
    status: Status
    record: Any = None
    statistics: dict[str, Any] = field(default_factory=dict)
    warnings: Sequence[str] = ()

    continuous = False
    in_sequence = False
    needs_record = True
    sample_dimension = "frequency"

    @property
    def time(self) -> np.ndarray:
        """(K,) frequencies [Hz], in the role of the instants of a motion."""
        return self.frequencies

    @property
    def omega(self) -> np.ndarray:
        """(K,) angular frequencies [rad/s]."""
        return 2 * np.pi * self.frequencies

    def at(self, frequencies: Instants) -> HarmonicResponse:
        """The response at other frequencies [Hz]."""
        requested = np.atleast_1d(np.asarray(frequencies, dtype=float))
        motions = self.record.motions(2 * np.pi * requested)
        return replace(self, frequencies=requested, motions=motions)

    # measures ------------------------------------------------------------------------------
    @cached_property
    def names(self) -> Names:
        return measures_of(self.model, self.outputs)

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures and parameters."""
        expression = self.names.expression(measure)
        for _, transfer in self.transfers(expression):
            self.column(transfer)
        if not self._is_real(expression):
            name = expression.name or "the formula"
            raise AnalysisError(
                f"{name} is a measure of the model, whose amplitudes are complex: take "
                "response[measure], or its parts by name, as in 'body.x.amplitude'"
            )
        return expression

    def _is_real(self, expression: Expression) -> bool:
        """Whether it consists of parts of amplitudes, spectra, the frequency and parameters."""
        own = [q.sx for q in self.model.parameters.values()]
        return consists_of(expression, [*own, *(symbol for symbol, _ in self.spectra)])

    def keys(self) -> list[str]:
        names = [part_name(o, p, s) for o in self.outputs for s in self.sources for p in PARTS]
        return [*names, "frequency", *self.model.parameters]

    @staticmethod
    def transfers(measure: Expression) -> list[tuple[ca.SX, Transfer]]:
        """Symbols and transfers of a formula; different symbols may have the same transfer."""
        pairs = ((s, Transfer.of(s.name())) for s in ca.symvar(measure.sx))
        return [(symbol, transfer) for symbol, transfer in pairs if transfer is not None]

    def column(self, transfer: Transfer) -> int:
        """Number of the input of a transfer.

        Raises
        ------
        AnalysisError
            Unknown input, or none of several.
        """
        if transfer.input in self.inputs:
            return self.inputs.index(transfer.input)
        if transfer.input:
            raise AnalysisError(unknown("input", transfer.input, self.inputs))
        if len(self.inputs) > 1:
            raise AnalysisError(
                f"{transfer.output}: the response has {len(self.inputs)} inputs, "
                f"{', '.join(self.inputs)}; name one, as in "
                f"{part_name(transfer.output, 'amplitude', self.inputs[0])}"
            )
        return 0

    def complex_values(self, output: str | Expression) -> np.ndarray:
        """(K, inputs) complex amplitudes of a measure of the model."""
        row = self.record.row(self.output(output))
        return row.at(self.omega, self.motions)  # type: ignore[no-any-return]

    def output(self, name: str | Expression) -> Expression:
        """An output, or another measure of the model."""
        if isinstance(name, str) and name in self.outputs:
            return self.outputs[name]
        return self.model.expression(name)  # type: ignore[no-any-return]

    def unit_by(self, output: str, source: str) -> str:
        """Unit of a complex amplitude, per unit of its input."""
        unit, parameter = self.output(output).unit, self.model.parameters.get(source)
        if parameter is None or parameter.unit in ("", "1"):
            return unit
        return f"{unit or '1'} per {parameter.unit}"

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) values of a scalar measure or formula."""
        expression = self.expression(measure)
        if not self.time.size:
            return np.zeros(0)
        function, columns = measure_function(self, [expression.sx], expression)
        return function.map(self.time.size)(*columns).full().ravel()  # type: ignore[no-any-return]

    def slopes(self, measure: Expression) -> tuple[dict[Transfer, np.ndarray], np.ndarray]:
        """Transfer → (K,) derivatives by its part, and (np, K) derivatives by the parameters."""
        transfers = self.transfers(measure)
        by = ca.vertcat(*(symbol for symbol, _ in transfers))
        sources = [ca.densify(ca.gradient(measure.sx, by))] if transfers else []
        direct = ca.densify(ca.gradient(measure.sx, self.parameter_symbols))
        function, columns = measure_function(self, [*sources, direct], measure)
        results = function.map(self.time.size)(*columns)
        tables = [part.full() for part in (results if isinstance(results, tuple) else [results])]
        rows: dict[Transfer, np.ndarray] = {}
        for k, (_, transfer) in enumerate(transfers):
            rows[transfer] = rows.get(transfer, 0) + tables[0][k]
        return rows, tables[-1]

    def frequency_slope(self, measure: str | Expression) -> np.ndarray:
        """(K,) derivative of a measure by the frequency [1/Hz]."""
        expression = self.expression(measure)
        slopes, _ = self.slopes(expression)
        function, columns = measure_function(
            self, [ca.gradient(expression.sx, FREQUENCY.sx)], expression
        )
        total = function.map(self.time.size)(*columns).full().ravel()
        motions = self.record.rates(self.omega, self.motions)
        for transfer, slope in slopes.items():
            row = self.record.row(self.output(transfer.output))
            change = row.rate(self.omega, self.motions, motions)[:, self.column(transfer)]
            part = change.real if transfer.part == "real" else change.imag
            total = total + 2 * np.pi * slope * part
        return total  # type: ignore[no-any-return]

    @property
    def parameter_symbols(self) -> ca.SX:
        """Symbols of the parameters."""
        return stack(q.sx for q in self.model.parameters.values())

    @property
    def density_curves(self) -> list[dict[str, Any]]:
        """Curves of spectral densities for a page; none of harmonic inputs."""
        return []

    @property
    def spectra(self) -> list[tuple[ca.SX, np.ndarray]]:
        """Further symbols of measures, and their values (K,)."""
        return []

    def is_complex(self, measure: str | Expression) -> bool:
        """Whether it is an output or a measure of the model, without a part."""
        if isinstance(measure, str) and (measure in self.outputs or measure in self):
            return measure in self.outputs
        try:
            expression = self.output(measure)
        except ExpressionError:
            return False
        return len(expression) == 1 and not self._is_real(expression)

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure over the frequency; of an output without part, the complex amplitudes."""
        import xarray as xr

        if self.is_complex(measure):
            unit = self.output(measure).unit
            coords = {"frequency": self.frequencies, "input": self.inputs}
            amplitudes = self.complex_values(measure)
            name = measure if isinstance(measure, str) else measure.name
            data = xr.DataArray(amplitudes, coords, list(coords), name, {"units": unit})
            return data.isel(input=0, drop=True) if len(self.inputs) == 1 else data
        return self.labelled(measure, {"frequency": self.frequencies})

    # output --------------------------------------------------------------------------------
    @cached_property
    def table(self) -> np.ndarray:
        """(K, outputs, inputs) complex amplitudes of the outputs."""
        columns = [self.complex_values(name) for name in self.outputs]
        shape = self.frequencies.size, len(self.outputs), len(self.inputs)
        return np.array(columns).transpose(1, 0, 2).reshape(shape)

    @cached_property
    def contents(self) -> Contents:
        """Amplitude, phase and parts of the outputs."""
        from dalembert.results.files.harmonic_tables import harmonic_contents

        return harmonic_contents(self)

    def to_dataframe(self) -> pd.DataFrame:
        """Amplitude and phase of each output for each input, over the frequency."""
        from dalembert.results.files.harmonic_tables import harmonic_frame

        return harmonic_frame(self)

    def peaks(self, output: str, source: str = "") -> list[tuple[float, float]]:
        """Frequency [Hz] and amplitude of each local maximum of an output; may be infinite."""
        name = part_name(output, "amplitude", source)
        finite, infinite = self.analysis.resonances(self, name)  # type: ignore[attr-defined]
        heights = self.at(finite).values(name).tolist()
        pairs = [*zip(finite.tolist(), heights, strict=True)]
        return sorted([*pairs, *((f, float("inf")) for f in infinite.tolist())])

    def summary(self) -> dict[str, Any]:
        """Status, and the highest peak of each output."""
        from dalembert.results.files.harmonic_tables import harmonic_summary

        return harmonic_summary(self)

    def plot(self, *outputs: str, kind: str = "bode", **options: Any) -> Figure:
        """Bode or Nyquist plot with Matplotlib.

        Parameters
        ----------
        *outputs : names, by default all
        kind : ``"bode"`` or ``"nyquist"``
        """
        from dalembert.results.pictures.frequency_plot import plot_response

        return plot_response(self, outputs or tuple(self.outputs), kind, **options)

    def __repr__(self) -> str:
        f = self.frequencies
        span = f"{f.min():g} to {f.max():g} Hz" if f.size else "no frequencies"
        pairs = f"{listed(self.outputs)} by {listed(self.inputs)}"
        counts = counted(f.size, "frequency").replace("frequencys", "frequencies")
        return f"<{type(self).__name__} of {self.model.name!r}: {pairs}, {counts}, {span}>"
