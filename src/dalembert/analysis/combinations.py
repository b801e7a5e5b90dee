"""What ``compare`` combines: strategies by name or instance, with steps and tolerances."""

from __future__ import annotations

import dataclasses
import difflib
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.formulations.augmented_lagrangian import AugmentedLagrangian
from dalembert.formulations.base import Formulation
from dalembert.formulations.dae import Dae
from dalembert.formulations.energy_projection import EnergyProjection
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.null_space import NullSpace
from dalembert.formulations.penalty import Penalty
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Baumgarte, Projection, Stabilization
from dalembert.formulations.velocity_partitioning import VelocityPartitioning
from dalembert.integrators.backward_euler import BackwardEuler, Trapezoidal
from dalembert.integrators.base import Integrator
from dalembert.integrators.bdf import Bdf
from dalembert.integrators.generalized_alpha import HHT, GeneralizedAlpha
from dalembert.integrators.newmark import Newmark
from dalembert.integrators.radau import Radau
from dalembert.integrators.runge_kutta import (
    RK4,
    DormandPrince,
    DormandPrince853,
    Euler,
    Heun,
    RKGill,
)
from dalembert.integrators.sundials import Cvodes, Ida
from dalembert.model.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.joint_coordinates import JointCoordinates

Classes = tuple[type, ...]


@dataclass(frozen=True)
class Choice:
    """Strategies of one kind: those compared by default, and others known by name."""

    kind: str
    base: type
    default: Classes
    others: Classes = ()

    @property
    def known(self) -> dict[str, type]:
        return {cls.__name__: cls for cls in (*self.default, *self.others)}

    def read(self, given: Any) -> list[Any]:
        """Strategy objects from names, classes or objects, one or several; None for the default.

        Raises
        ------
        UnsupportedError
            A name that is not known, or nothing to compare.
        """
        if given is None:
            return [cls() for cls in self.default]
        several = isinstance(given, Iterable) and not isinstance(given, str)
        made = list(dict.fromkeys(self._one(item) for item in (given if several else [given])))
        if not made:
            raise UnsupportedError(f"{self.kind}: name at least one of {', '.join(self.known)}")
        return made

    def _one(self, item: Any) -> Any:
        if isinstance(item, str) and item in self.known:
            item = self.known[item]
        if isinstance(item, type) and issubclass(item, self.base):
            return item()
        if isinstance(item, self.base):
            return item
        close = difflib.get_close_matches(str(item), self.known, 1, 0.5)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        raise UnsupportedError(
            f"{self.kind}: {item!r} is unknown{hint}; known: {', '.join(self.known)}"
        )


FORMULATIONS = Choice(
    "formulations",
    Formulation,
    (RangeSpace, Kkt, NullSpace, VelocityPartitioning, Penalty, AugmentedLagrangian),
    (Dae,),
)
COORDINATES = Choice("coordinates", Coordinates, (AbsoluteCoordinates,), (JointCoordinates,))
STABILIZATIONS = Choice(
    "stabilizations", Stabilization, (Projection,), (Stabilization, Baumgarte, EnergyProjection)
)
INTEGRATORS = Choice(
    "integrators",
    Integrator,
    (RK4, DormandPrince, DormandPrince853, Radau),
    (
        Euler,
        Heun,
        RKGill,
        BackwardEuler,
        Trapezoidal,
        Newmark,
        HHT,
        GeneralizedAlpha,
        Bdf,
        Cvodes,
        Ida,
    ),
)

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)


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
        kinds = ("coordinates", "formulation", "stabilization", "integrator", "step")
        return {kind: getattr(self, kind) for kind in kinds}

    @property
    def labels(self) -> dict[str, str]:
        """Kind → name of the strategy, with the options that are not the default."""
        swept = {"rtol", "atol"} if self.tolerance else set()
        kinds = ("coordinates", "formulation", "stabilization", "integrator")
        return {kind: label(getattr(self, kind), swept) for kind in kinds}


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
    """Every combination of the choices; fixed methods by steps, adaptive ones by tolerances."""
    marches = [
        march
        for integrator in INTEGRATORS.read(integrators)
        for march in _settings(integrator, steps, tolerances)
    ]
    made = itertools.product(
        COORDINATES.read(coordinates),
        FORMULATIONS.read(formulations),
        STABILIZATIONS.read(stabilizations),
        marches,
    )
    return [Combination(c, f, s, *march) for c, f, s, march in made]


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
