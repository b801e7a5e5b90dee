"""Base of analyses of linear systems: operating point, inputs and outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from dalembert.analysis.frequency.frequency_grid import MARGIN, default_frequencies
from dalembert.analysis.frequency.linear_mechanism import LinearMechanism
from dalembert.analysis.frequency.linear_structure import linear_structure
from dalembert.analysis.frequency.moving_points import refuse_moving_points
from dalembert.analysis.frequency.operating_point import operating_point
from dalembert.analysis.frequency.requested import requested, requested_names
from dalembert.errors import AnalysisError
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.analysis import Analysis
from dalembert.results.harmonic_measures import PARTS
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

R = TypeVar("R", bound=Result)
ABOVE = 1.1
"""Ratio of the last default frequency of a structure to its highest resonance [-]."""
UNSTABLE = 1e-9
"""Growth relative to the largest eigenvalue from which an operating point is unstable [-]."""


def input_names(model: Any, inputs: Any, verb: str) -> list[str]:
    """Names of inputs, by default all inputs of the model.

    Raises
    ------
    AnalysisError
        No inputs, or a name that is neither an input nor a parameter.
    """
    declared = list(model.inputs)
    names = declared if inputs is None else requested_names(inputs, verb)
    if not names:
        raise AnalysisError(
            f"{verb}: no inputs; declare them by system.input(name, unit=…), or name parameters: "
            "inputs=['push']"
        )
    for name in names:
        if name not in model.parameters:
            raise AnalysisError(f"{verb}: {unknown('input', name, model.parameters)}")
    return names


def output_measures(model: Any, outputs: Any, verb: str) -> dict[str, Expression]:
    """Name → scalar measure of outputs, by default all outputs of the model.

    Raises
    ------
    AnalysisError
        No outputs, or a measure with several components; ``UnknownNameError`` for unknown names.
    """
    declared: Mapping[str, Expression] = model.outputs
    if outputs is None:
        measures = dict(declared)
    else:
        measures = {}
        for item in requested(outputs, "outputs", verb):
            own = isinstance(item, str) and item in declared
            name = item if isinstance(item, str) else item.name or f"output{len(measures) + 1}"
            base, _, part = name.rpartition(".")
            if isinstance(item, str) and part in PARTS and item not in model:
                raise AnalysisError(
                    f"{verb}: output {name} is a part of a complex amplitude; name the measure, "
                    f"outputs=[{base!r}], and take result[{name!r}]"
                )
            measures[name] = declared[name] if own else model.expression(item)
    if not measures:
        raise AnalysisError(
            f"{verb}: no outputs; declare them by system.output(name, formula), or name measures: "
            "outputs=['body.x']"
        )
    for name, measure in measures.items():
        if len(measure) != 1:
            raise AnalysisError(
                f"{verb}: output {name} has {len(measure)} components; take .x, .y or a norm"
            )
    return measures


class LinearAnalysis(Analysis[Any, R]):
    """Analysis of small motions about an operating point, driven by inputs."""

    about: Any
    inputs: Any
    outputs: Any

    def system(self, model: Any, p: np.ndarray, near: np.ndarray | None = None) -> Any:
        """Linear system of a model at parameter values."""
        verb, about = type(self).__name__, self._about(p)
        if isinstance(model, StructuralModel):
            return linear_structure(self, model, p, about)
        names = input_names(model, self.inputs, verb)
        refuse_moving_points(model, names)
        columns = [list(model.parameters).index(name) for name in names]
        point = operating_point(self, model, p, about, near)
        return LinearMechanism(point, model.tangents(p, columns))

    def again(self, result: R, p: np.ndarray) -> Any:
        """The system of the model of a result at other parameter values."""
        point = getattr(result.record, "point", None)
        near = None if point is None or self.about is not None else point.y
        return self.system(result.model, p, near)

    def _about(self, p: np.ndarray) -> Any:
        """The state about which motions are small, at parameter values."""
        about = self.about
        if about is not None and not np.array_equal(p, about.parameters):
            cases = getattr(about, "cases", None)
            about = about.analysis.replay(about, p)
            about = about if cases is None else about.at([about.case(cases[0])])
        return about

    def checked_about(self) -> None:
        """Raise unless ``about`` is a result without a time of its own."""
        kind, about = type(self).__name__, self.about
        if about is None:
            return
        if not hasattr(about, "model"):
            raise AnalysisError(f"{kind}: about is {about!r:.60}; give an equilibrium or a motion")
        if len(getattr(about, "cases", "1")) != 1:
            raise AnalysisError(
                f"{kind}: about has the load cases {', '.join(map(repr, about.cases))}; select one "
                "with about=result.at([number])"
            )
        if name := "time" if self.time else "" if self.equilibrium else "equilibrium":  # type: ignore[attr-defined]
            raise AnalysisError(f"{kind}: {name} cannot be given with about=, which has its own")

    def grid(self, system: Any, span: tuple[float, float] | None) -> np.ndarray:
        """Default frequencies of a system [Hz].

        Raises
        ------
        AnalysisError
            Its resonances are not available.
        """
        poles = system.poles
        if hasattr(system, "poles_up_to") and poles.size:  # of a structure, the lowest ones
            sizes = np.abs(poles) / (2 * np.pi)
            span = (sizes.min() / MARGIN, sizes.max() * ABOVE) if span is None else span
            poles = system.poles_up_to(span[1])
        if not poles.size and span is None:
            raise AnalysisError(
                f"{type(self).__name__}: the system has no resonances; give frequencies=, or span="
            )
        return default_frequencies(poles, span)

    @staticmethod
    def stability_warnings(system: Any) -> tuple[str, ...]:
        """Warning about motions that grow."""
        poles = system.poles
        growth = poles.real.max(initial=0.0)
        if growth <= UNSTABLE * np.abs(poles).max(initial=0.0):
            return ()
        return (
            f"the operating point is unstable, motions grow with up to {growth:.3g} 1/s: harmonic "
            "responses exist, but disturbances leave them; see linearize",
        )


def frequency_array(values: Sequence[float] | np.ndarray, kind: str) -> np.ndarray:
    """Frequencies [Hz], sorted.

    Raises
    ------
    AnalysisError
        Not numbers, negative ones, or none.
    """
    try:
        array = np.unique(np.atleast_1d(np.asarray(values, dtype=float)).ravel())
    except (TypeError, ValueError):
        raise AnalysisError(f"{kind}: frequencies is {values!r:.60}; give numbers [Hz]") from None
    if not array.size or not np.all(np.isfinite(array)) or array[0] < 0:
        raise AnalysisError(f"{kind}: frequencies is {values!r:.60}; give numbers ≥ 0 [Hz]")
    return array


def checked_span(span: Any) -> tuple[float, float]:
    """First and last frequency [Hz].

    Raises
    ------
    AnalysisError
        Not two increasing numbers.
    """
    try:
        low, high = (float(value) for value in span)
    except (TypeError, ValueError):
        low, high = 1.0, 0.0
    if not 0 <= low < high:
        raise AnalysisError(f"FrequencyResponse: span is {span!r:.60}; give (first, last) in Hz")
    return low, high
