"""Design variables: parameters within bounds, integers, catalogue sizes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import misspelt
from dalembert.units.measured import check_measured, measured


@dataclass(frozen=True)
class Integer(CheckedArguments):
    """Integer parameter within its bounds, such as a number of teeth.

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
        """Parameter → its values in ascending order."""
        lower, upper = parameters[self.name].bounds
        if not (math.isfinite(lower) and math.isfinite(upper)):
            raise AnalysisError(f"{self.name} takes whole numbers: give it two finite bounds")
        integers = np.arange(math.ceil(lower), math.floor(upper) + 1, dtype=float)
        if not integers.size:
            raise AnalysisError(f"{self.name}: no whole number lies in [{lower}, {upper}]")
        return {self.name: integers}


@dataclass(frozen=True)
class Catalogue(CheckedArguments):
    """Catalogue of standard sizes: values of one parameter, or of several that belong together.

    Between two sizes the relaxed problem interpolates the other parameters over the first by a
    monotone cubic (Fritsch & Carlson 1980).

    Parameters
    ----------
    columns : parameter → its values, row by row, or texts such as ``"12 mm"``; values of the
        first are unique

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
        """First parameter, which identifies the size."""
        return next(iter(self.columns))

    def sizes(self, parameters: Mapping[str, Parameter]) -> dict[str, np.ndarray]:
        """Parameter → its values, sorted by the first and within its bounds."""
        columns, lead_parameter = dict[str, np.ndarray](), parameters[self.name]
        for name, values in self.columns.items():
            numbers = [measured(value) for value in values]
            check_measured(numbers, parameters[name].unit, f"catalogue of {self.name}: {name}")
            columns[name] = np.asarray(numbers, dtype=float)
        lead = columns[self.name]
        if any(values.shape != lead.shape or values.ndim != 1 for values in columns.values()):
            raise AnalysisError(f"catalogue of {self.name}: give columns of the same length")
        if len(set(lead)) < lead.size or not np.all(np.isfinite(lead)):
            raise AnalysisError(f"catalogue of {self.name}: sizes must be finite and unique")
        lower, upper = lead_parameter.bounds
        order = [k for k in np.argsort(lead) if lower <= lead[k] <= upper]
        if not order:
            raise AnalysisError(f"catalogue of {self.name}: no size lies in [{lower}, {upper}]")
        return {name: values[order] for name, values in columns.items()}


Variable = str | Integer | Catalogue
"""Entry of ``vary``: the name of a parameter, an integer or a catalogue."""
Vary = Variable | Sequence[Variable] | None
"""Argument ``vary`` of design tasks; None for all parameters with two finite bounds."""
Curve = Callable[..., float]
"""Value of a parameter at a size, or its derivative of an order."""


@dataclass
class Variables:
    """The variables ``x`` of a design and the parameters that they set.

    Attributes
    ----------
    names : of the variables
    lower, upper, start : (n,)
    units, declared_units : SI units, and units in which the parameters were declared
    sizes : index of a variable → its discrete values
    followers : (parameter, index of its variable, interpolant)
    """

    names: list[str]
    lower: np.ndarray
    upper: np.ndarray
    start: np.ndarray
    units: list[str]
    declared_units: list[str]
    sizes: dict[int, np.ndarray] = field(default_factory=dict)
    followers: list[tuple[str, int, Curve]] = field(default_factory=list)

    @property
    def parameter_names(self) -> list[str]:
        """Names of all parameters that vary."""
        return [*self.names, *(name for name, _, _ in self.followers)]

    @property
    def width(self) -> np.ndarray:
        """(n,) scale of each variable: its range, or its magnitude if it is unbounded."""
        width = self.upper - self.lower
        usable = np.isfinite(width) & (width > 0)
        return np.where(usable, width, np.maximum(abs(self.start), 1.0))

    def parameters(self, x: np.ndarray) -> dict[str, float]:
        """Values of all parameters that vary."""
        values = dict(zip(self.names, map(float, x), strict=True))
        return values | {name: float(curve(x[k])) for name, k, curve in self.followers}

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """(parameters, n) derivatives of these parameters by the variables."""
        jacobian = np.zeros((len(self.parameter_names), len(self.names)))
        jacobian[: len(self.names)] = np.eye(len(self.names))
        for row, (_, k, curve) in enumerate(self.followers, len(self.names)):
            jacobian[row, k] = curve(x[k], 1)
        return jacobian

    def snapped(self, x: np.ndarray) -> np.ndarray:
        """Design with each discrete variable rounded to its nearest size."""
        rounded = np.array(x, dtype=float)
        for k, sizes in self.sizes.items():
            rounded[k] = sizes[np.argmin(abs(sizes - rounded[k]))]
        return rounded


def make_variables(
    parameters: Mapping[str, Parameter], vary: Vary, start: Mapping[str, float]
) -> Variables:
    """Variables of names, ``Integer`` and ``Catalogue`` entries.

    Raises
    ------
    ModelError
        A name that is unknown or listed twice.
    AnalysisError
        Nothing to vary, or invalid sizes.
    """
    entries = _entries(parameters, vary)
    if not entries:
        raise AnalysisError("nothing to vary: name parameters, or give some of them bounds")
    _refuse_names(parameters, [n for entry in entries for n in _names(entry)])
    names = [_names(entry)[0] for entry in entries]
    bounds = np.array([parameters[n].bounds for n in names], dtype=float)
    values = [start.get(n, parameters[n].value) for n in names]
    units = [parameters[n].unit for n in names]
    declared = [parameters[n].declared_unit for n in names]
    columns = bounds[:, 0].copy(), bounds[:, 1].copy()
    variables = Variables(names, *columns, np.array(values, float), units, declared)
    for k, entry in enumerate(entries):
        if not isinstance(entry, str):
            _add_sizes(variables, k, entry.sizes(parameters))
    _refuse_start(variables, {n: v for n, v in start.items() if n in names})
    variables.start = np.clip(variables.start, variables.lower, variables.upper)
    return variables


def _refuse_start(variables: Variables, start: Mapping[str, float]) -> None:
    """Refuse start values outside of their bounds."""
    for name, lower, upper in zip(variables.names, variables.lower, variables.upper, strict=True):
        if name in start and not lower <= start[name] <= upper:
            raise ModelError(
                f"{name} starts at {start[name]:g}, outside of its bounds [{lower:g}, {upper:g}]"
            )


def _add_sizes(variables: Variables, k: int, columns: dict[str, np.ndarray]) -> None:
    lead, *followers = columns.items()
    variables.sizes[k] = lead[1]
    variables.lower[k], variables.upper[k] = lead[1][0], lead[1][-1]
    for name, values in followers:
        variables.followers.append((name, k, _curve(lead[1], values)))


def _curve(x: np.ndarray, y: np.ndarray) -> Curve:
    """Monotone cubic through the points; a constant through one."""
    from scipy.interpolate import PchipInterpolator

    if x.size == 1:
        return lambda at, order=0: float(y[0]) if order == 0 else 0.0
    return PchipInterpolator(x, y)


def _entries(parameters: Mapping[str, Parameter], vary: Vary) -> list[Variable]:
    """Entries of ``vary``; by default all parameters with two bounds."""
    if vary is None:
        return [n for n, p in parameters.items() if np.all(np.isfinite(p.bounds))]
    return [vary] if isinstance(vary, (str, Integer, Catalogue)) else list(vary)


def varied_names(parameters: Mapping[str, Parameter], vary: Vary) -> list[str]:
    """Names of all parameters in the argument ``vary`` of ``optimize``."""
    return [name for entry in _entries(parameters, vary) for name in _names(entry)]


def _names(entry: Variable) -> list[str]:
    if isinstance(entry, Catalogue):
        if not entry.columns:
            raise AnalysisError("a catalogue has no columns; give {parameter: sizes}")
        return list(entry.columns)
    if isinstance(entry, (str, Integer)):
        return [entry if isinstance(entry, str) else entry.name]
    raise AnalysisError(f"vary: give names, da.Integer or da.Catalogue, got {entry!r:.60}")


def _refuse_names(parameters: Mapping[str, Parameter], names: list[str]) -> None:
    for k, name in enumerate(names):
        if name not in parameters:
            listed = ", ".join(parameters) or "none"
            before = f"unknown parameter {name!r} to vary"
            raise ModelError(misspelt(before, name, parameters, f" (known: {listed})"))
        if name in names[:k]:
            raise ModelError(f"parameter {name!r} is listed twice in vary; name it once")
