"""Frequency response of mechanisms and structures about an operating point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from dalembert.analysis.frequency.frequency_grid import local_maxima, refined_maxima
from dalembert.analysis.frequency.linear_analysis import (
    LinearAnalysis,
    checked_span,
    frequency_array,
    input_names,
    output_measures,
)
from dalembert.analysis.frequency.modal_motions import superposed
from dalembert.analysis.frequency.requested import requested
from dalembert.analysis.frequency.structure_inputs import structural_inputs
from dalembert.analysis.frequency.undamped import grows, undamped_frequencies, undamped_warnings
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.errors import AnalysisError, SingularityError, UnsupportedError
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import only_for, options
from dalembert.results.analysis import ParameterValues
from dalembert.results.harmonic import HarmonicResponse
from dalembert.results.harmonic_measures import measures_of
from dalembert.results.live import LiveFunctions
from dalembert.results.sources import Row
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown
from dalembert.timing import Timing

UNDAMPED = Rayleigh()
METHODS = "direct", "modal"
EXCITATION = "excitation"


@options
class FrequencyResponse(LinearAnalysis[HarmonicResponse]):
    """Frequency response ``y(ω) = H(iω) u`` as a strategy object.

    A mechanism is linear about its static equilibrium, or about ``about``. Constraints are kept, so
    that inputs in driver laws, such as a road under a wheel, are exact with their derivatives:

        ⎡ iω A₁₁ + …   Cᵀ ⎤
        ⎣ C            0  ⎦  [δ; v; λ] = −b û

    Parameters
    ----------
    frequencies : [Hz]; by default a grid that resolves all resonances
    inputs : names of inputs or parameters; of a structure also load cases. By default all inputs
    outputs : measures; by default all outputs of the model
    excitation : input → amplitude, a number, a complex number, or ``[amplitude, phase in rad]``;
        the response is the sum. By default each input has a unit amplitude of its own
    span : first and last frequency [Hz] of the default grid
    method : ``"direct"``, or ``"modal"`` superposition with static correction
    count : number of modes of ``"modal"``; by default all of a mechanism and 30 of a structure
    about : equilibrium or motion whose last instant is the operating point
    time : instant at which laws and forces of a mechanism are evaluated [s]
    equilibrium : about the static equilibrium of a mechanism; otherwise its assembled state
    damping : Rayleigh damping of a structure
    loss_factor : structural (hysteretic) damping of a structure, ``K (1 + i η)`` [-]
    damping_ratio : modal damping of a structure with ``method="modal"`` [-]
    lumped : lumped instead of consistent mass matrix of a structure

    Raises
    ------
    AnalysisError
        Unknown inputs, wrong frequencies; ``SingularityError`` for undamped resonances.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.parameter("push", 0.0, "N")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> sweep = da.FrequencyResponse(inputs=["push"], outputs=["body.x"])
    >>> response = sweep.run(system.build())
    >>> top = da.maximum("body.x.amplitude")  # F/(2 D k √(1 − D²)) with D = 0.1
    >>> round(da.evaluate(response, top) * 100 * 2 * 0.1 * math.sqrt(0.99), 9)
    1.0
    """

    display_name = "frequency response"
    random: ClassVar[bool] = False
    different_samples = (
        "the designs have different default frequencies; give the batch frequencies=[..] in Hz"
    )

    frequencies: Annotated[Any, Sequence[float]] = None
    inputs: Annotated[Any, tuple[str, ...]] = None
    outputs: Annotated[Any, tuple[str, ...]] = None
    excitation: Annotated[Any, dict[str, complex]] = None
    span: Annotated[Any, tuple[float, float]] = None
    method: str = "direct"
    count: int | None = None
    about: Annotated[Any, StructuralResult] = None
    time: float = only_for("mechanism", default=0.0)
    equilibrium: bool = only_for("mechanism", default=True)
    damping: Rayleigh = only_for("structure", default=UNDAMPED)
    loss_factor: float = only_for("structure", default=0.0)
    damping_ratio: float = only_for("structure", default=0.0)
    lumped: bool = only_for("structure", default=False)

    def __post_init__(self) -> None:
        self.checked_about()
        kind = type(self).__name__
        for option in ("inputs", "outputs"):
            if (items := getattr(self, option)) is not None:
                requested(items, option, kind)
        if self.method not in METHODS:
            raise UnsupportedError(unknown("method", self.method, METHODS))
        if self.frequencies is not None:
            frequency_array(self.frequencies, "FrequencyResponse")
        if self.excitation is not None:
            complex_amplitudes(self.excitation)
        if self.span is not None:
            checked_span(self.span)
        if self.count is not None and self.method != "modal":
            raise AnalysisError("FrequencyResponse: count is an option of method='modal'")
        if self.damping_ratio and self.method != "modal":
            raise AnalysisError(
                "FrequencyResponse: damping_ratio is an option of method='modal'; use damping= "
                "or loss_factor="
            )

    @classmethod
    def expression(cls, model: Any, measure: str | Expression) -> Expression:
        return measures_of(model).expression(measure)

    def run(
        self, model: Any, parameters: ParameterValues = None, progress: Any = False
    ) -> HarmonicResponse:
        """The response at parameter values, by default those of ``about``.

        Raises
        ------
        AnalysisError
            No equilibrium was found, unknown inputs or outputs.
        SingularityError
            An undamped resonance at one of the frequencies.
        """
        self.for_model(model)
        if self.about is not None:
            if getattr(self.about.model, "structure", self.about.model) is not getattr(
                model, "structure", model
            ):
                raise AnalysisError(
                    f"about is a result of {self.about.model.name}, not of this model"
                )
            parameters = self.about.parameters if parameters is None else parameters
        timing, p = Timing(), model.values(parameters)
        system = self.system(model, p)
        if self.frequencies is not None:
            frequencies = frequency_array(self.frequencies, type(self).__name__)
        else:
            frequencies = self.grid(system, None if self.span is None else checked_span(self.span))
        response = self.response(system, frequencies)
        timing.lap("computation")
        build = {"build time [s]": round(model.build_time, 6)}
        response.statistics.update(build, **timing.statistics)
        return response

    def response(self, system: Any, frequencies: np.ndarray) -> HarmonicResponse:
        """The response of a linear system."""
        model, kind = system.model, type(self).__name__
        names = self.input_names(model)
        outputs = output_measures(model, self.outputs, kind)
        if self.excitation is not None:
            amplitudes = complex_amplitudes(self.excitation)
            column = np.array([amplitudes.get(name, 0.0) for name in names])
            system, names = system.combined(column), [EXCITATION]
        if self.method == "modal":
            system = superposed(system, self.count)
        for measure in outputs.values():
            system.row(measure)
        motions = system.motions(2 * np.pi * frequencies)
        text = f"{self.display_name} at {frequencies.size} frequencies"
        response = HarmonicResponse(
            model,
            self,
            system.p,
            frequencies,
            names,
            outputs,
            motions,
            Status(Outcome.COMPLETED, text, system.time, system.residual),
            system,
            dict(system.statistics),
            (*system.warnings, *self.stability_warnings(system)),
        )
        return replace(response, warnings=(*response.warnings, *undamped_warnings(response)))

    def input_names(self, model: Any) -> list[str]:
        """Names of the inputs of a model."""
        inputs, kind = self.inputs, type(self).__name__
        if self.excitation is not None and inputs is None:
            inputs = list(complex_amplitudes(self.excitation))
        if isinstance(model, StructuralModel):
            names = structural_inputs(model, inputs, kind)
        else:
            names = input_names(model, inputs, kind)
        for name in complex_amplitudes(self.excitation or {}):
            if name not in names:
                raise AnalysisError(f"{kind}: excitation: {unknown('input', name, names)}")
        return names

    def system(self, model: Any, p: np.ndarray, near: np.ndarray | None = None) -> Any:
        names = self.input_names(model)
        return super(FrequencyResponse, replace(self, inputs=names)).system(model, p, near)

    def replay(self, result: HarmonicResponse, p: np.ndarray) -> HarmonicResponse:
        """The response at other parameter values, at the same frequencies."""
        return self.response(self.again(result, p), result.frequencies)

    def live_obstacle(self, result: HarmonicResponse) -> str:
        from dalembert.analysis.live.frequency_module import obstacle

        return obstacle(result)

    def live_functions(
        self, result: HarmonicResponse, rows: Sequence[Row], times: np.ndarray
    ) -> LiveFunctions:
        from dalembert.analysis.live.frequency_module import frequency_functions

        return frequency_functions(result, rows, times)

    def resample(self, result: HarmonicResponse, times: np.ndarray) -> HarmonicResponse:
        return result.at(times)

    def maxima(
        self, result: HarmonicResponse, measure: str | Expression, sign: float = 1.0
    ) -> HarmonicResponse:
        """The response at the local maxima of ``sign`` times a measure.

        Raises
        ------
        SingularityError
            A maximum is infinite, at an undamped resonance.
        """
        finite, infinite = self.resonances(result, measure, sign)
        if infinite.size:
            raise SingularityError(
                f"{measure} is infinite at {infinite[0]:.9g} Hz, because no damping acts on this "
                "resonance; add damping, or frequencies on one side of it"
            )
        return result.at(finite)

    def resonances(
        self, result: HarmonicResponse, measure: str | Expression, sign: float = 1.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies of the local maxima of ``sign`` times a measure, finite and infinite [Hz]."""
        f = result.frequencies
        if f.size < 3:
            return np.zeros(0), np.zeros(0)
        values = sign * result.values(measure)
        tops, infinite = local_maxima(values), []
        for place in undamped_frequencies(result.record, f[0], f[-1]):
            around = (f[tops - 1] < place) & (place < f[tops + 1])
            if around.any() and grows(lambda x: sign * result.at(x).values(measure), place):
                infinite.append(place)
                tops = tops[~around]
        finite = refined_maxima(
            f,
            values,
            tops,
            lambda x: sign * result.at(x).values(measure),
            lambda x: sign * result.at(x).frequency_slope(measure),
        )
        return finite, np.array(infinite)

    def peaks(
        self, result: HarmonicResponse, measure: str | Expression, sign: float
    ) -> HarmonicResponse:
        """The response at the local maxima and at the ends of the frequencies."""
        top = self.maxima(result, measure, sign)
        return result.at(np.unique(np.concatenate([top.frequencies, result.frequencies[[0, -1]]])))


def complex_amplitudes(excitation: Any) -> dict[str, complex]:
    """Input → complex amplitude.

    Raises
    ------
    AnalysisError
        Not a number, nor ``[amplitude, phase]``.
    """
    if not isinstance(excitation, Mapping):
        raise AnalysisError(
            f"FrequencyResponse: excitation is {excitation!r:.60}; give input → amplitude"
        )
    amplitudes = {}
    for name, value in excitation.items():
        pair = isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2
        try:
            amplitude = value[0] * np.exp(1j * value[1]) if pair else complex(value)
        except (TypeError, ValueError):
            raise AnalysisError(
                f"FrequencyResponse: excitation.{name} is {value!r:.60}; give a number or "
                "[amplitude, phase in rad]"
            ) from None
        amplitudes[str(name)] = complex(amplitude)
    return amplitudes
