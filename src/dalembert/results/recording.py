"""Recorded states of an analysis over time: trajectory, events, impacts and measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from dalembert.model.graph.model import Model
from dalembert.results.analysis import Analysis
from dalembert.results.result import Instants, Result
from dalembert.results.sampling import checked_instants
from dalembert.results.status import Status, Warnings
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import Expression

NOT_CHECKED = "not all checks have been made: read the warnings of the motion"
"""Line of the warnings of a dataset whose motion has checks that take further runs."""


@dataclass(frozen=True)
class Trajectory:
    """States at the output times, columns by time.

    Attributes
    ----------
    t : (K,) ; y, v, a : (n, K) of the bodies; multiplier : (M, K) of all equations, zero for
    equations removed as redundant, followed by the forces of rigid contacts, if any ;
    work : (2, K) dissipated energy and input
    """

    t: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    multiplier: np.ndarray
    work: np.ndarray

    def forces(self, count: int) -> np.ndarray:
        """(count, K) multipliers and contact forces, padded with zeros."""
        padded = np.zeros((count, self.multiplier.shape[1]))
        padded[: len(self.multiplier)] = self.multiplier
        return padded

    def some(self, index: np.ndarray) -> Trajectory:
        """The trajectory at some of the instants."""
        columns = (self.y, self.v, self.a, self.multiplier, self.work)
        return Trajectory(self.t[index], *(c[:, index] for c in columns))


@dataclass(frozen=True, eq=False)
class EventRecord:
    """An event that occurred.

    Attributes
    ----------
    name : declared name
    time : instant [s]
    direction : +1 if its measure rises through zero, −1 if it falls, 0 if it has none
    y, v : (n,) coordinates and speeds of the bodies at this instant; NaN if undetermined
    """

    name: str
    time: float
    direction: int
    y: np.ndarray = field(repr=False)
    v: np.ndarray = field(repr=False)

    @property
    def row(self) -> dict[str, Any]:
        """The event in pages and JSON."""
        return {"name": self.name, "time": self.time, "direction": self.direction}


@dataclass(frozen=True, eq=False)
class ImpactRecord:
    """An impact at a rigid contact, with a jump of the speeds.

    Attributes
    ----------
    name : of the element
    time : instant [s]
    normal : impulse along the gap [N s]
    tangential : (k,) impulse along the slip [N s]
    """

    name: str
    time: float
    normal: float
    tangential: np.ndarray

    @property
    def row(self) -> dict[str, Any]:
        """The impact in JSON."""
        return {"name": self.name, "time": self.time, "impulse": self.normal}


@dataclass(eq=False, repr=False)
class Recording(Result):
    """States of a mechanism over time and their measures.

    Attributes
    ----------
    model : Model the motion belongs to
    analysis : analysis that computed it, e.g. ``Dynamics(...)``
    parameters : (n,) parameter values used, followed by derived values
    trajectory : Trajectory
    status : Status
    statistics : name → number or text
    events : occurred events, by time; ``data`` lists them along the dimension ``event``
    warnings : reservations about the chosen methods, each with the number that shows it
    impacts : jumps of the speeds at rigid contacts, by time
    record : data of the run for gradients (steps, places of the outputs among them)
    """

    model: Model
    analysis: Analysis
    parameters: np.ndarray
    trajectory: Trajectory
    status: Status
    statistics: dict[str, Any] = field(default_factory=dict)
    events: list[EventRecord] = field(default_factory=list)
    warnings: Sequence[str] = field(default_factory=list)
    impacts: list[ImpactRecord] = field(default_factory=list)
    record: Any = None

    @property
    def error_estimate(self) -> Any:
        """Estimated error of a run by one-step methods, or with contacts in fixed steps, else None.

        Its ``share`` is relative to the range of the coordinate, or to the maximum magnitude of the
        speed, of that ``name``, at that ``time``. The first access costs about two more runs, with
        contacts five eighths of a run.
        """
        accuracy = getattr(self.record, "accuracy", None)
        return None if accuracy is None else accuracy.estimate

    @property
    def time(self) -> np.ndarray:
        """(K,) output times [s]."""
        return self.trajectory.t

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) or (K, size) values of a measure, a formula or an expression."""
        return self.columns([measure])[0]

    def columns(self, measures: Sequence[str | Expression]) -> list[np.ndarray]:
        """``values`` of several measures, in one pass over the states."""
        expressions = [self.expression(measure) for measure in measures]
        parts = np.split(self.table(expressions), np.cumsum([len(m) for m in expressions])[:-1])
        return [part[0] if part.shape[0] == 1 else part.T for part in parts]

    def table(self, measures: Sequence[str | Expression]) -> np.ndarray:
        """(rows, K) all components of measures, one above the other."""
        expressions = [self.expression(measure) for measure in measures]
        function, s = self.model.function(*expressions), self.trajectory
        if not s.t.size:
            return np.zeros((function.size1_out(0), 0))
        p = np.tile(self.parameters[:, None], s.t.size)
        forces = s.forces(function.size1_in(4))
        return Kernel(function.map(s.t.size))(s.t, s.y, s.v, s.a, forces, p)[0]

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, a formula or an expression; see ``Model.expression``."""
        return self.model.expression(measure)

    def at(self, times: Instants) -> Self:
        """The motion sampled at other times, from the steps of the run."""
        return self.analysis.resample(self, checked_instants(times))

    @cached_property
    def over_steps(self) -> Self:
        """The motion at the sampling points of integrals: its outputs, or points of its steps."""
        return self.analysis.over_steps(self)

    @property
    def _noted_warnings(self) -> Sequence[str]:
        """Warnings of the checks made so far: the others take further runs."""
        return self.warnings.noted if isinstance(self.warnings, Warnings) else self.warnings

    @property
    def _missing_warnings(self) -> list[str]:
        """Note about checks that have not been made."""
        late = isinstance(self.warnings, Warnings) and not self.warnings.is_complete
        return [NOT_CHECKED] if late else []

    def __repr__(self) -> str:
        span = f"{self.time[0]:g}…{self.time[-1]:g} s" if self.time.size else "no times"
        kind = type(self).__name__
        count, size = len(self._noted_warnings), self.time.size
        notes = f", {count} warning(s)" if count else ""
        notes += ", warnings incomplete" if self._missing_warnings else ""
        return f"<{kind} of {self.model.name!r}: {size} times, {span}, {self.status}{notes}>"
