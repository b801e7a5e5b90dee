"""What responses, gradients and designs see: results, and the analyses that made them."""

from __future__ import annotations

import difflib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, Self, TypeVar

import numpy as np

from dalembert.errors import AnalysisError, ExpressionError, UnsupportedError
from dalembert.results.files.contents import Contents
from dalembert.results.status import Status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import card, messages, table

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dalembert.report.inline import InlinePage


Instants = float | Sequence[float] | np.ndarray
"""An instant or several; of load cases and modes a number or several."""


class Result(Protocol):
    """States at instants, or by number, and any measure of them.

    Attributes
    ----------
    model : what was analysed
    analysis : the analysis that made it
    parameters : (n,) values used, then numbers computed from them
    time : (K,) instants [s]; of load cases, modes and points of a path their numbers
    status : how it ended
    statistics : name → number or text, for people
    record : what a gradient needs
    warnings : doubts about the choices made
    events : what happened
    continuous : whether there is something between the instants; integrals are sums where not
    in_sequence : whether the states follow one another; load cases and modes do not
    has_page : whether there is a report of it
    """

    model: Any
    analysis: Analysis
    parameters: np.ndarray
    status: Status
    statistics: dict[str, Any]
    record: Any
    warnings: Sequence[str] = ()
    events: Sequence[Any] = ()
    continuous: ClassVar[bool] = True
    in_sequence: ClassVar[bool] = True
    has_page: ClassVar[bool] = True

    if TYPE_CHECKING:  # results have it as a property or as a field

        @property
        def time(self) -> np.ndarray: ...

    def at(self, times: Instants) -> Self:
        """The same at other instants, or some of the numbers."""
        ...

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, a formula or an expression."""
        ...

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) values of a scalar measure."""
        ...

    @property
    def over_steps(self) -> Self:
        """The same where integrals look at it."""
        return self

    def __contains__(self, measure: object) -> bool:
        """Whether ``result[measure]`` exists: the name of a measure, or a formula of names."""
        if not isinstance(measure, (str, Expression)):
            return False
        try:
            self.expression(measure)
        except (ExpressionError, AnalysisError):  # the latter: known, and no measure of this result
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> list[str]:
        """Names of the measures and parameters; vectors have components ``.x``, ``.y``, ``.z``."""
        return self.model.keys()  # type: ignore[no-any-return]

    def labelled(self, measure: str | Expression, coords: Mapping[str, Any]) -> xr.DataArray:
        """Values of a measure or formula along named coordinates, in their order.

        Raises
        ------
        KeyError
            Unknown name, with the nearest known ones.
        """
        import xarray as xr

        expression = self.expression(measure)
        name = expression.name or (measure if isinstance(measure, str) else "measure")
        about = {"units": expression.unit, "long_name": name}
        return xr.DataArray(self.values(expression), coords, list(coords), name, about)

    # for people ----------------------------------------------------------------------------
    @property
    def about(self) -> dict[str, str]:
        """What is said of all that is kept."""
        return {"model": self.model.name, "status": str(self.status)}

    @cached_property
    def contents(self) -> Contents:
        """All that is kept of it, with names, as files and pages take it."""
        ...

    @cached_property
    def data(self) -> xr.Dataset:
        """The same, labelled."""
        return self.contents.dataset()

    def summary(self) -> dict[str, Any]:
        """``status`` and the numbers to tell."""
        ...

    def page(self) -> dict[str, Any]:
        """What its report shows, as plain data, where ``has_page``."""
        raise UnsupportedError(f"there is no report of {type(self).__name__}; save or draw it")

    def save(self, path: str | Path, **first_view: Any) -> Path:
        """Write all results, its page too, to a NetCDF file; ``load_results`` reads it back."""
        return self._save(path, self.page(**first_view) if self.has_page else None)

    def _save(self, path: str | Path, page: dict[str, Any] | None) -> Path:
        from dalembert.report.packing import packed
        from dalembert.report.page import as_json
        from dalembert.results.files.store import save_dataset

        kept = {} if page is None else {"report": ((), as_json(packed(page)))}
        return save_dataset(self.contents.plus(kept), path)

    def to_dataframe(self) -> pd.DataFrame:
        """A table of ``data``."""
        return self.data.to_dataframe()

    def to_csv(self, path: str | Path, units: Sequence[str] = ()) -> Path:
        """Write ``to_dataframe`` as CSV; headings tell the units.

        Parameters
        ----------
        units : wanted, such as ``["mm", "deg"]``; each serves what has its dimension
        """
        from dalembert.results.files.headings import headed
        from dalembert.results.files.store import save_table

        table = self.to_dataframe()
        known = {
            name: told.get("units", "") for name, (*_, told) in self.contents.variables.items()
        }
        return save_table(headed(table, known | table.attrs.get("units", {}), units), path)

    def report(self, path: str | Path, **first_view: Any) -> Path:
        """Write the interactive report, one self-contained HTML file, where ``has_page``."""
        from dalembert.report.page import write_page

        return write_page(self.page(**first_view), path)

    def show(self, height: int = 680, **first_view: Any) -> InlinePage:
        """Its report in a notebook, with player and plots, where ``has_page``."""
        from dalembert.report.inline import InlinePage

        return InlinePage(self.page(**first_view), height)

    def _repr_html_(self) -> str:
        told = {k: v for k, v in self.summary().items() if isinstance(v, str | int | float)}
        rows = [(name.replace("_", " "), value) for name, value in told.items()]
        rows += [(name.replace("_", " "), value) for name, value in self.statistics.items()]
        name = getattr(self.model, "name", "")
        doubts = messages(("warning", text) for text in self.warnings)
        seen = "show() draws it here" if self.has_page else ""
        kind = type(self).__name__
        return card(f"{kind} of {name}", seen, doubts, table(rows))

    def write(self, base: Path, report: bool, csv: bool, **first_view: Any) -> list[Path]:
        """Results (.nc), and if asked for a table (.csv) and a report (.report.html)."""
        from dalembert.report.page import write_page

        page = self.page(**first_view) if self.has_page else None
        files = self.write_data(base, csv, page, first_view.get("units", ()))
        if report and page is not None:
            files.append(write_page(page, base.with_name(f"{base.name}.report.html")))
        return files

    def write_data(
        self, base: Path, csv: bool, page: dict[str, Any] | None, units: Sequence[str] = ()
    ) -> list[Path]:
        """Results with their page (.nc), and if asked for a table (.csv)."""
        files = [self._save(base.with_name(f"{base.name}.nc"), page)]
        if csv:
            files.append(self.to_csv(base.with_name(f"{base.name}.csv"), units))
        return files


Given = Mapping[str, float] | np.ndarray | None
"""Values of parameters: some by name, all in their order, or none but the model's own."""
M = TypeVar("M")
R = TypeVar("R")


class Analysis(ABC, Generic[M, R]):
    """How a result is made, made again at other parameters, and looked at elsewhere.

    A new analysis is a frozen dataclass of options with ``run`` and ``replay``; one over time
    gives ``resample``, one with events ``at_event``.
    """

    spoken: ClassVar[str] = ""
    """What people call it."""
    events: Mapping[str, Any] | None = None
    """Name → event, where there can be some."""
    at_rest: ClassVar[bool] = False
    """Its results are equilibria, each on its own."""
    integrates: ClassVar[bool] = False
    """Its results come of integration, which energies judge."""

    batched: ClassVar[Any] = None
    """What runs many designs at once, and tells by ``serves`` whether it can."""

    @property
    def gradient_error(self) -> float:
        """Relative error of its gradients, beside that of equations solved to round-off."""
        return 0.0

    @abstractmethod
    def run(self, model: M, parameters: Given = None) -> R:
        """The result for a model, with some parameters replaced or all given."""

    def for_designs(self) -> Self:
        """The same as many designs run it."""
        return self

    def checks(self, model: M) -> Mapping[str, Callable[[], object]]:
        """Option → what tells, before a run and without compiling it, that it cannot work.

        What is no fault of one option stands under an empty name.
        """
        return {}

    def replay(self, result: R, p: np.ndarray) -> R:
        """The same at other parameter values: same steps, same branch."""
        return self.run(result.model, p)  # type: ignore[attr-defined]

    def resample(self, result: R, times: np.ndarray) -> R:
        """The same at other instants."""
        raise UnsupportedError(f"a result of {type(self).__name__} has no other instants")

    def continued(
        self, result: R, duration: Any, options: Mapping[str, Any], progress: Any = False
    ) -> R:
        """The result, gone on with from its end."""
        kind = type(self).__name__
        raise UnsupportedError(f"a result of {kind} cannot be continued; ask for a longer run")

    def at_event(self, result: R, occurrence: Any) -> R:
        """The result at the instant of an event."""
        kind = type(self).__name__
        raise UnsupportedError(f"{kind} has no events; use solve_dynamics or solve_kinematics")

    def over_steps(self, result: R) -> R:
        """The result where integrals look at it."""
        return result

    def peaks(self, result: R, measure: str | Expression, sign: float) -> R:
        """The result where ``sign`` times a measure is largest, where it is known between its
        instants; else the result."""
        return result

    def over_peaks(self, result: R, measure: str | Expression, sharpness: float, sign: float) -> R:
        """The result where integrals of ``exp(± sharpness m)`` look at it, where that is known."""
        return result

    @classmethod
    def of(cls, verb: str, **options: Any) -> Self:
        """The analysis with the options that a verb was given.

        Raises
        ------
        AnalysisError
            It has no such option; tells the nearest.
        """
        known = [field.name for field in fields(cls)]  # type: ignore[arg-type]
        for name in options:
            if name not in known:
                close = difflib.get_close_matches(name, known, 1)
                nearest = f" (did you mean {close[0]!r}?)" if close else ""
                listed = ", ".join(known) or "none"
                raise AnalysisError(f"{verb}: unknown option {name!r}{nearest}; known: {listed}")
        return cls(**options)
