"""Base class of analyses, the interface of responses, gradients and designs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, fields
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Self, TypeVar

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import is_stated
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    from dalembert.results.live import LiveFunctions
    from dalembert.results.module import Module
    from dalembert.results.sources import Row

ParameterValues = Mapping[str, float] | np.ndarray | None
"""Parameter values: some by name, all in order, or None for those of the model."""
M = TypeVar("M")
R = TypeVar("R")


class Analysis(ABC, Generic[M, R]):
    """Computation of a result, with replay at other parameters and sampling at other instants.

    A new analysis is a frozen dataclass of options with ``run`` and ``replay``; an analysis over
    time implements ``resample``, one with events ``at_event``.
    """

    display_name: ClassVar[str] = ""
    """Name of the analysis in texts."""
    kinds: ClassVar[tuple[str, ...]] = ("mechanism", "structure")
    """Kinds of models that it applies to."""
    instead: ClassVar[str] = ""
    """Remedy for a model of the other kind."""
    events: Mapping[str, Any] | None = None
    """Name → event, for analyses with events."""
    different_samples: ClassVar[str] = (
        "the designs have outputs at different times, as steps with error control do; give the "
        "batch outputs, e.g. outputs=101"
    )
    """Error and remedy where the results of designs have no common samples."""
    at_rest: ClassVar[bool] = False
    """Whether its results are independent equilibria."""
    integrates: ClassVar[bool] = False
    """Whether its results come from time integration, checked by energy balances."""

    batched: ClassVar[Any] = None
    """Class that runs many designs at once; its ``serves`` returns whether it can."""

    @property
    def gradient_error(self) -> float:
        """Relative error of its gradients, in addition to round-off of the solved equations."""
        return 0.0

    @abstractmethod
    def run(self, model: M, parameters: ParameterValues = None) -> R:
        """Run the analysis of a model, with some or all parameters replaced."""

    def for_model(self, model: M) -> Self:
        """The analysis as run for a model, with defaults for its kind.

        Raises
        ------
        AnalysisError
            It does not apply to this kind of model; ``UnsupportedError`` where an option does not.
        """
        kind, name = model.kind, model.name  # type: ignore[attr-defined]
        if kind not in self.kinds:
            own = type(self).__name__
            raise AnalysisError(
                f"{own} is for {self.kinds[0]}s, {name!r} is a {kind}; {self.instead}"
            )
        for check in Analysis.checks(self, model).values():
            check()
        return self

    def for_designs(self) -> Self:
        """The analysis as run for many designs."""
        return self

    def checks(self, model: M) -> Mapping[str, Callable[[], object]]:
        """Option → check that raises if the option is invalid, before a run and without compiling.

        Checks that concern no single option have an empty name.
        """
        return {
            option.name: partial(_refuse_option, self, option, model)
            for option in fields(self)  # type: ignore[arg-type]
            if option.metadata.get("model", model.kind) != model.kind  # type: ignore[attr-defined]
        }

    @classmethod
    def expression(cls, model: Any, measure: str | Expression) -> Expression:
        """A measure of its results by name, a formula or an expression."""
        return model.expression(measure)  # type: ignore[no-any-return]

    def replay(self, result: R, p: np.ndarray) -> R:
        """The result at other parameter values, with the same steps and branches."""
        return self.run(result.model, p)  # type: ignore[attr-defined]

    def resample(self, result: R, times: np.ndarray) -> R:
        """The result at other instants."""
        raise UnsupportedError(f"a result of {type(self).__name__} has no other instants")

    def continued(
        self, result: R, duration: Any, options: Mapping[str, Any], progress: Any = False
    ) -> R:
        """Continue a result from its end."""
        kind = type(self).__name__
        raise UnsupportedError(f"a result of {kind} cannot be continued; request a longer run")

    def at_event(self, result: R, occurrence: Any) -> R:
        """The result at the instant of an event."""
        kind = type(self).__name__
        raise UnsupportedError(f"{kind} has no events; use solve_dynamics or solve_kinematics")

    def over_steps(self, result: R) -> R:
        """The result at the sampling points of integrals."""
        return result

    def peaks(self, result: R, measure: str | Expression, sign: float) -> R:
        """The result at the maxima of ``sign`` times a measure, if it is defined between its
        instants; else the result."""
        return result

    def over_peaks(self, result: R, measure: str | Expression, sharpness: float, sign: float) -> R:
        """The result at the sampling points of integrals of ``exp(± sharpness m)``, if defined."""
        return result

    def live_obstacle(self, result: R) -> str:
        """Reason why a page cannot compute the result for other parameters; empty if it can."""
        return f"{type(self).__name__} does not run in a page"

    def live_functions(self, result: R, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
        """Functions with which a page computes the rows at the times for other parameters."""
        raise UnsupportedError(self.live_obstacle(result))

    def module(
        self,
        model: M,
        measures: Sequence[str | Expression] = (),
        responses: Sequence[Any] = (),
        parameters: ParameterValues = None,
    ) -> Module:
        """The analysis as a WebAssembly module; see ``Model.module``."""
        from dalembert.results.module import build_module

        return build_module(self.run(model, parameters), measures, responses)

    @classmethod
    def of(cls, verb: str, **options: Any) -> Self:
        """The analysis from the options of a function.

        Raises
        ------
        AnalysisError
            It has no such option; suggests the nearest.
        """
        names = [field.name for field in fields(cls)]  # type: ignore[arg-type]
        for name in options:
            if name not in names:
                raise AnalysisError(f"{verb}: {unknown('option', name, names)}")
        return cls(**options)


def _refuse_option(analysis: Any, option: Field[Any], model: Any) -> None:
    """Raise if an option for the other kind of model is stated, even with its default."""
    if is_stated(analysis, option.name):
        value = getattr(analysis, option.name)
        raise UnsupportedError(
            f"{type(analysis).__name__}({option.name}={value!r:.60}): {option.name} is an option "
            f"for {option.metadata['model']}s, and {model.name!r} is a {model.kind}"
        )
