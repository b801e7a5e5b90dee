"""Combinations of strategies, steps and tolerances for ``compare``."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.formulations.base import Formulation
from dalembert.formulations.registry import FORMULATIONS, STABILIZATIONS
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.registry import INTEGRATORS
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.registry import COORDINATES
from dalembert.text.wording import nearest


@dataclass(frozen=True)
class Choice:
    """Strategies of one kind, and the names compared by default."""

    kind: str
    base: type
    registry: Mapping[str, type]
    default: tuple[str, ...]

    @property
    def usual(self) -> type:
        """The first default strategy."""
        return self.registry[self.default[0]]

    def read(self, choice: Any) -> list[Any]:
        """Strategy objects from names, classes or objects, one or several; None for the default.

        Raises
        ------
        UnsupportedError
            An unknown name, or nothing to compare.
        """
        if choice is None:
            return [self.registry[name]() for name in self.default]
        several = isinstance(choice, Iterable) and not isinstance(choice, str)
        strategies = list(
            dict.fromkeys(self._strategy(item) for item in (choice if several else [choice]))
        )
        if not strategies:
            raise UnsupportedError(f"{self.kind}: name at least one of {', '.join(self.registry)}")
        return strategies

    def _strategy(self, item: Any) -> Any:
        if isinstance(item, str) and item in self.registry:
            return self.registry[item]()
        if isinstance(item, type) and issubclass(item, self.base):
            return item()
        if isinstance(item, self.base):
            return item
        hint = nearest(item, self.registry)
        if isinstance(item, str) and "(" in item:
            hint = "; for options give an object, or in a model file a table with its type"
        raise UnsupportedError(
            f"{self.kind}: {item!r} is unknown{hint}; known: {', '.join(self.registry)}"
        )


CHOICES = {
    "coordinates": Choice(
        "coordinates", Coordinates, COORDINATES, ("AbsoluteCoordinates", "JointCoordinates")
    ),
    "formulation": Choice(
        "formulations",
        Formulation,
        FORMULATIONS,
        ("RangeSpace", "KKT", "NullSpace", "AugmentedLagrangian", "DAE"),
    ),
    "stabilization": Choice("stabilizations", Stabilization, STABILIZATIONS, ("Projection",)),
    "integrator": Choice("integrators", Integrator, INTEGRATORS, ("RK4", "DormandPrince", "Radau")),
}
"""Field of ``Dynamics`` → admissible strategies."""

TOLERANCES = (1e-4, 1e-6, 1e-8)


@dataclass(frozen=True)
class Combination:
    """One run of a comparison; ``step`` or ``tolerance`` is None where it does not apply."""

    coordinates: Any
    formulation: Any
    stabilization: Any
    integrator: Integrator
    step: float | None = None
    tolerance: float | None = None

    @property
    def strategies(self) -> dict[str, Any]:
        """Fields of ``Dynamics``."""
        return {kind: getattr(self, kind) for kind in (*CHOICES, "step")}

    @property
    def labels(self) -> dict[str, str]:
        """Kind → name of the strategy, with the options that differ from the default."""
        swept = {"rtol", "atol"} if self.tolerance else set()
        return {kind: label(getattr(self, kind), swept) for kind in CHOICES}


def label(strategy: Any, hidden: Iterable[str] = ()) -> str:
    """``Baumgarte(alpha=5)``: the name, and the options that differ from the default."""
    name = type(strategy).__name__
    changed = [
        f"{field.name}={value:g}" if isinstance(value, float) else f"{field.name}={value}"
        for field in dataclasses.fields(strategy)
        if field.name not in hidden and (value := getattr(strategy, field.name)) != field.default
    ]
    return f"{name}({', '.join(changed)})" if changed else name


def combinations(
    coordinates: Any,
    formulations: Any,
    stabilizations: Any,
    integrators: Any,
    steps: Sequence[float],
    tolerances: Sequence[float],
) -> list[Combination]:
    """All combinations of the choices; fixed methods with steps, adaptive ones with tolerances.

    Default choices are combined where this is informative: see ``_needless``.
    """
    marches = [
        march
        for integrator in CHOICES["integrator"].read(integrators)
        for march in _settings(integrator, steps, tolerances)
    ]
    products = itertools.product(
        CHOICES["coordinates"].read(coordinates),
        CHOICES["formulation"].read(formulations),
        CHOICES["stabilization"].read(stabilizations),
        marches,
    )
    candidates = [Combination(c, f, s, *march) for c, f, s, march in products]
    choices = {"coordinates": coordinates, "formulation": formulations, "integrator": integrators}
    defaults = {kind for kind, value in choices.items() if value is None}
    return [c for c in candidates if not _needless(c, defaults)]


def _needless(c: Combination, defaults: set[str]) -> bool:
    """Whether a combination contains a default choice and is uninformative.

    Default implicit integrators are combined with the formulations that need them, default
    formulations of this kind with implicit integrators, and default joint coordinates with the
    first formulation.
    """
    needs_implicit, implicit = not c.formulation.gives_accelerations, c.integrator.implicit
    if "integrator" in defaults and needs_implicit != implicit:
        return True
    if "formulation" in defaults and needs_implicit and not implicit:
        return True
    usual, first = CHOICES["coordinates"].usual, CHOICES["formulation"].usual
    if "coordinates" not in defaults or type(c.coordinates) is usual:
        return False
    return "formulation" not in defaults or type(c.formulation) is not first


def _settings(
    integrator: Any, steps: Sequence[float], tolerances: Sequence[float]
) -> Iterator[tuple[Any, float | None, float | None]]:
    names = {field.name for field in dataclasses.fields(integrator)}
    controlled = {"rtol", "atol"} <= names and not getattr(integrator, "fixed", False)
    if controlled:  # some divide prescribed steps into their own
        step = None if integrator.adaptive else steps[0]
        for value in tolerances:
            yield dataclasses.replace(integrator, rtol=value, atol=value), step, value
    elif integrator.adaptive:
        yield integrator, None, None
    else:
        yield from ((integrator, step, None) for step in steps)


def checked_values(values: Any, entity: str) -> tuple[float, ...]:
    """Positive numbers, one or several, the largest first.

    Raises
    ------
    AnalysisError
        A value is not a positive number, or there is none.
    """
    several = isinstance(values, Iterable) and not isinstance(values, str)
    numbers = []
    for value in values if several else [values]:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not (math.isfinite(number) and number > 0):
            raise AnalysisError(f"{entity}: {value!r} is not a positive number")
        numbers.append(number)
    if not numbers:
        raise AnalysisError(f"{entity}: give at least one")
    return tuple(sorted(set(numbers), reverse=True))


def usual_steps(length: float) -> tuple[float, ...]:
    """Steps near a typical ``length`` [s], successively halved from a round number."""
    power = 10.0 ** math.floor(math.log10(4 * length))
    first = min((1, 2, 4, 5, 8, 10), key=lambda k: abs(math.log(k * power / (4 * length)))) * power
    return tuple(float(f"{first / 2**k:.6g}") for k in range(4))
