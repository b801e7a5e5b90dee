"""What ``compare`` combines: strategies by name or instance, with steps and tolerances."""

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
from dalembert.model.coordinates import Coordinates
from dalembert.model.registry import COORDINATES
from dalembert.text.wording import nearest


@dataclass(frozen=True)
class Choice:
    """Strategies of one kind, and the names of those compared by default."""

    kind: str
    base: type
    known: Mapping[str, type]
    default: tuple[str, ...]

    @property
    def usual(self) -> type:
        """The first of them."""
        return self.known[self.default[0]]

    def read(self, given: Any) -> list[Any]:
        """Strategy objects from names, classes or objects, one or several; None for the default.

        Raises
        ------
        UnsupportedError
            A name that is not known, or nothing to compare.
        """
        if given is None:
            return [self.known[name]() for name in self.default]
        several = isinstance(given, Iterable) and not isinstance(given, str)
        made = list(dict.fromkeys(self._one(item) for item in (given if several else [given])))
        if not made:
            raise UnsupportedError(f"{self.kind}: name at least one of {', '.join(self.known)}")
        return made

    def _one(self, item: Any) -> Any:
        if isinstance(item, str) and item in self.known:
            return self.known[item]()
        if isinstance(item, type) and issubclass(item, self.base):
            return item()
        if isinstance(item, self.base):
            return item
        hint = nearest(item, self.known)
        if isinstance(item, str) and "(" in item:
            hint = "; for options give an object, or in a model file a table with its type"
        raise UnsupportedError(
            f"{self.kind}: {item!r} is unknown{hint}; known: {', '.join(self.known)}"
        )


CHOICES = {
    "coordinates": Choice(
        "coordinates", Coordinates, COORDINATES, ("AbsoluteCoordinates", "JointCoordinates")
    ),
    "formulation": Choice(
        "formulations",
        Formulation,
        FORMULATIONS,
        ("RangeSpace", "Kkt", "NullSpace", "AugmentedLagrangian", "Dae"),
    ),
    "stabilization": Choice("stabilizations", Stabilization, STABILIZATIONS, ("Projection",)),
    "integrator": Choice("integrators", Integrator, INTEGRATORS, ("RK4", "DormandPrince", "Radau")),
}
"""Field of ``Dynamics`` → what may stand there."""

TOLERANCES = (1e-4, 1e-6, 1e-8)


@dataclass(frozen=True)
class Combination:
    """One run of a comparison; ``step`` or ``tolerance`` is None where it has no meaning."""

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
        """Kind → name of the strategy, with the options that are not the default."""
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
    """Every combination of the choices; fixed methods by steps, adaptive ones by tolerances.

    Choices that nobody made are combined where this tells something: see ``_needless``.
    """
    marches = [
        march
        for integrator in CHOICES["integrator"].read(integrators)
        for march in _settings(integrator, steps, tolerances)
    ]
    made = itertools.product(
        CHOICES["coordinates"].read(coordinates),
        CHOICES["formulation"].read(formulations),
        CHOICES["stabilization"].read(stabilizations),
        marches,
    )
    found = [Combination(c, f, s, *march) for c, f, s, march in made]
    given = {"coordinates": coordinates, "formulation": formulations, "integrator": integrators}
    open_choices = {kind for kind, value in given.items() if value is None}
    return [c for c in found if not _needless(c, open_choices)]


def _needless(c: Combination, open_choices: set[str]) -> bool:
    """Whether a combination would only take time, and holds a choice that nobody made.

    Implicit integrators that nobody asked for are tried with the formulations that need them, these
    formulations with implicit integrators, and joint coordinates with the first formulation.
    """
    needed, taken = not c.formulation.gives_accelerations, c.integrator.implicit
    if "integrator" in open_choices and needed != taken:
        return True
    if "formulation" in open_choices and needed and not taken:
        return True
    usual, first = CHOICES["coordinates"].usual, CHOICES["formulation"].usual
    if "coordinates" not in open_choices or type(c.coordinates) is usual:
        return False
    return "formulation" not in open_choices or type(c.formulation) is not first


def _settings(
    integrator: Any, steps: Sequence[float], tolerances: Sequence[float]
) -> Iterator[tuple[Any, float | None, float | None]]:
    names = {field.name for field in dataclasses.fields(integrator)}
    controlled = {"rtol", "atol"} <= names and not getattr(integrator, "fixed", False)
    if controlled:  # some of them take steps of their own inside of given ones
        step = None if integrator.adaptive else steps[0]
        for value in tolerances:
            yield dataclasses.replace(integrator, rtol=value, atol=value), step, value
    elif integrator.adaptive:
        yield integrator, None, None
    else:
        yield from ((integrator, step, None) for step in steps)


def checked_values(values: Any, what: str) -> tuple[float, ...]:
    """Positive numbers, one or several, the largest first.

    Raises
    ------
    AnalysisError
        One that is not a positive number, or none.
    """
    several = isinstance(values, Iterable) and not isinstance(values, str)
    made = []
    for value in values if several else [values]:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not (math.isfinite(number) and number > 0):
            raise AnalysisError(f"{what}: {value!r} is not a positive number")
        made.append(number)
    if not made:
        raise AnalysisError(f"{what}: give at least one")
    return tuple(sorted(set(made), reverse=True))


def usual_steps(length: float) -> tuple[float, ...]:
    """Steps about a typical ``length`` [s], each half of the one before, the first one round."""
    power = 10.0 ** math.floor(math.log10(4 * length))
    first = min((1, 2, 4, 5, 8, 10), key=lambda k: abs(math.log(k * power / (4 * length)))) * power
    return tuple(float(f"{first / 2**k:.6g}") for k in range(4))
