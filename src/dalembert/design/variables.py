"""What varies: parameters within bounds, whole numbers, sizes out of catalogues."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.spelling import Spelled
from dalembert.text.wording import nearest
from dalembert.units.measured import check_measured, measured


@dataclass(frozen=True)
class Integer(Spelled):
    """A parameter that takes whole numbers within its bounds, as a number of teeth.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("gears")
    >>> z1 = model.parameter("z1", 20, bounds=(20, 22))
    >>> z2 = model.parameter("z2", 60, bounds=(60, 70))
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> off = da.final("(z2/z1 - 3.14159265)**2")
    >>> teeth = [da.Integer("z1"), da.Integer("z2")]
    >>> best = da.optimize(model.build(), off, analysis=da.Statics(), vary=teeth)
    >>> round(best.x["z2"]), round(best.x["z1"])  # Archimedes' fraction
    (66, 21)
    """

    name: str

    def sizes(self, parameters: Mapping[str, Parameter]) -> dict[str, np.ndarray]:
        """Parameter → its values, in rising order."""
        lower, upper = parameters[self.name].bounds
        if not (math.isfinite(lower) and math.isfinite(upper)):
            raise AnalysisError(f"{self.name} takes whole numbers: give it two finite bounds")
        whole = np.arange(math.ceil(lower), math.floor(upper) + 1, dtype=float)
        if not whole.size:
            raise AnalysisError(f"{self.name}: no whole number lies in [{lower}, {upper}]")
        return {self.name: whole}


@dataclass(frozen=True)
class Catalogue(Spelled):
    """Sizes that can be bought: one parameter, or several that come together.

    Between two sizes the relaxed problem takes the others from the first parameter by a monotone
    cubic (Fritsch & Carlson 1980).

    Parameters
    ----------
    columns : parameter → its values, row by row, or texts such as ``"12 mm"``; the first has no
        value twice

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("sold springs")
    >>> k, price = model.parameter("k", 10.0), model.parameter("price", 1.0)
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> model.load(end, fx=100.0)
    >>> sold = da.Catalogue({"k": [10.0, 30.0, 60.0], "price": [1.0, 4.0, 3.0]})
    >>> soft = da.Limit(da.final("end.ux"), upper=5.0)
    >>> task = dict(minimize=da.final("price"), subject_to=[soft], analysis=da.Statics())
    >>> best = da.optimize(model.build(), **task, vary=[sold], method="enumeration")
    >>> best.x
    {'k': 60.0, 'price': 3.0}
    """

    columns: Mapping[str, Sequence[float | str]]

    @property
    def name(self) -> str:
        """The parameter that tells the sizes apart."""
        return next(iter(self.columns))

    def sizes(self, parameters: Mapping[str, Parameter]) -> dict[str, np.ndarray]:
        """Parameter → its values, in rising order of the first, within its bounds."""
        made, parameter = dict[str, np.ndarray](), parameters[self.name]
        for name, values in self.columns.items():
            read = [measured(value) for value in values]
            check_measured(read, parameters[name].unit, f"catalogue of {self.name}: {name}")
            made[name] = np.asarray(read, dtype=float)
        lead = made[self.name]
        if any(values.shape != lead.shape or values.ndim != 1 for values in made.values()):
            raise AnalysisError(f"catalogue of {self.name}: give columns of the same length")
        if len(set(lead)) < lead.size or not np.all(np.isfinite(lead)):
            raise AnalysisError(f"catalogue of {self.name}: each size once, finite")
        lower, upper = parameter.bounds
        order = [k for k in np.argsort(lead) if lower <= lead[k] <= upper]
        if not order:
            raise AnalysisError(f"catalogue of {self.name}: no size lies in [{lower}, {upper}]")
        return {name: values[order] for name, values in made.items()}


@dataclass
class Variables:
    """The variables ``x`` of a design and the parameters that they set.

    Attributes
    ----------
    names : of the variables
    lower, upper, start : (n,)
    units, given_units : SI units, and those in which the parameters were declared
    sizes : number of a variable → its discrete values
    followers : (parameter, number of its variable, interpolant)
    """

    names: list[str]
    lower: np.ndarray
    upper: np.ndarray
    start: np.ndarray
    units: list[str]
    given_units: list[str]
    sizes: dict[int, np.ndarray] = field(default_factory=dict)
    followers: list[tuple[str, int, Any]] = field(default_factory=list)

    @property
    def parameter_names(self) -> list[str]:
        """All parameters that vary."""
        return [*self.names, *(name for name, _, _ in self.followers)]

    @property
    def width(self) -> np.ndarray:
        """(n,) what each is scaled by: its range, or its size where that is open."""
        width = self.upper - self.lower
        usable = np.isfinite(width) & (width > 0)
        return np.where(usable, width, np.maximum(abs(self.start), 1.0))

    def parameters(self, x: np.ndarray) -> dict[str, float]:
        """Values of all parameters that vary."""
        made = dict(zip(self.names, map(float, x), strict=True))
        return made | {name: float(curve(x[k])) for name, k, curve in self.followers}

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """(parameters, n) derivatives of these parameters by the variables."""
        made = np.zeros((len(self.parameter_names), len(self.names)))
        made[: len(self.names)] = np.eye(len(self.names))
        for row, (_, k, curve) in enumerate(self.followers, len(self.names)):
            made[row, k] = curve(x[k], 1)
        return made

    def snapped(self, x: np.ndarray) -> np.ndarray:
        """The design with each discrete variable at its nearest size."""
        made = np.array(x, dtype=float)
        for k, sizes in self.sizes.items():
            made[k] = sizes[np.argmin(abs(sizes - made[k]))]
        return made


def make_variables(
    parameters: Mapping[str, Parameter], vary: Iterable[Any] | None, start: Mapping[str, float]
) -> Variables:
    """Variables out of names, ``Integer`` and ``Catalogue``.

    Raises
    ------
    ModelError
        A name that is unknown or varied twice.
    AnalysisError
        Nothing to vary, or sizes that cannot be.
    """
    listed = _listed(parameters, vary)
    if not listed:
        raise AnalysisError("nothing to vary: name parameters, or give some of them bounds")
    _refuse_names(parameters, [n for one in listed for n in _names(one)])
    names = [_names(one)[0] for one in listed]
    bounds = np.array([parameters[n].bounds for n in names], dtype=float)
    begin = [start.get(n, parameters[n].value) for n in names]
    units = [parameters[n].unit for n in names]
    own = [parameters[n].given_unit for n in names]
    sides = bounds[:, 0].copy(), bounds[:, 1].copy()
    made = Variables(names, *sides, np.array(begin, float), units, own)
    for k, one in enumerate(listed):
        if not isinstance(one, str):
            _add_sizes(made, k, one.sizes(parameters))
    _refuse_start(made, {n: v for n, v in start.items() if n in names})
    made.start = np.clip(made.start, made.lower, made.upper)
    return made


def _refuse_start(made: Variables, start: Mapping[str, float]) -> None:
    """Refuse a start that is asked for where it may not be."""
    for name, lower, upper in zip(made.names, made.lower, made.upper, strict=True):
        if name in start and not lower <= start[name] <= upper:
            raise ModelError(
                f"{name} starts at {start[name]:g}, outside of its bounds [{lower:g}, {upper:g}]"
            )


def _add_sizes(made: Variables, k: int, columns: dict[str, np.ndarray]) -> None:
    lead, *others = columns.items()
    made.sizes[k] = lead[1]
    made.lower[k], made.upper[k] = lead[1][0], lead[1][-1]
    for name, values in others:
        made.followers.append((name, k, _curve(lead[1], values)))


def _curve(x: np.ndarray, y: np.ndarray) -> Any:
    """Monotone cubic through the points; a constant through one."""
    from scipy.interpolate import PchipInterpolator

    if x.size == 1:
        return lambda at, order=0: float(y[0]) if order == 0 else 0.0
    return PchipInterpolator(x, y)


def _listed(parameters: Mapping[str, Parameter], vary: Any) -> list[Any]:
    """What varies, by default all with two bounds."""
    if vary is None:
        return [n for n, p in parameters.items() if np.all(np.isfinite(p.bounds))]
    return [vary] if isinstance(vary, (str, Integer, Catalogue)) else list(vary)


def varied_names(parameters: Mapping[str, Parameter], vary: Any) -> list[str]:
    """All parameters that ``vary`` of ``optimize`` names."""
    return [name for one in _listed(parameters, vary) for name in _names(one)]


def _names(one: Any) -> list[str]:
    if isinstance(one, Catalogue):
        if not one.columns:
            raise AnalysisError("a catalogue has no columns; give {parameter: sizes}")
        return list(one.columns)
    if isinstance(one, (str, Integer)):
        return [one if isinstance(one, str) else one.name]
    raise AnalysisError(f"vary: give names, da.Integer or da.Catalogue, got {one!r:.60}")


def _refuse_names(parameters: Mapping[str, Parameter], names: list[str]) -> None:
    for k, name in enumerate(names):
        if name not in parameters:
            known = ", ".join(parameters) or "none"
            raise ModelError(
                f"unknown parameter {name!r} to vary{nearest(name, parameters)} (known: {known})"
            )
        if name in names[:k]:
            raise ModelError(f"the parameter {name!r} is to vary twice; name it once")
