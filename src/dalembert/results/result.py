"""Base class of results, the interface of responses, gradients and designs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self

import numpy as np

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.results.files.contents import Contents
from dalembert.results.status import Status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner
from dalembert.text.wording import card, messages, nearest, table

if TYPE_CHECKING:
    import casadi as ca
    import pandas as pd
    import xarray as xr

    from dalembert.report.page import InlinePage
    from dalembert.results.analysis import Analysis
    from dalembert.results.files.live_responses import FirstResponse
    from dalembert.results.live import PageDesigns, PageResponse


Instants = float | Sequence[float] | np.ndarray
"""One or several instants; of load cases and modes, one or several numbers."""
REMEDIES = {
    "continued": "a run of dynamics of a mechanism can be continued; repeat this one over the "
    "whole duration",
    "animate": "it is for motions of mechanisms; report() writes a page with moving pictures",
}
"""Name that some results have → remedy for others."""
OTHER_NAMES = "result['measure'] returns the values of a measure"


def missing_name(owner: Any, name: str, remedy: str, other: str) -> AttributeError:
    """Error about a name that a result does not have.

    Parameters
    ----------
    remedy : for this name, which other results have; empty if there is none
    other : remedy for unknown names
    """
    kind = type(owner)
    if name.startswith("_"):  # looked up by copy, pickle and notebooks
        return AttributeError(f"{kind.__name__} has no {name!r}")
    close = "" if remedy else nearest(name, [own for own in dir(kind) if not own.startswith("_")])
    model = getattr(vars(owner).get("model"), "name", "")
    return AttributeError(f"{kind.__name__} of {model!r} has no {name!r}{close}; {remedy or other}")


class Result(CacheOwner, Protocol):
    """States at instants, or by number, and their measures.

    Attributes
    ----------
    model : analysed model
    analysis : analysis that computed it
    parameters : (n,) values used, followed by derived values
    time : (K,) instants [s]; numbers of load cases, modes or points of a path
    status : outcome of the run
    statistics : name → number or text
    record : data for gradients
    warnings : reservations about the chosen methods
    events : occurred events
    impacts : jumps of the speeds at rigid contacts
    continuous : whether states exist between the instants; if not, integrals are sums
    in_sequence : whether the states are consecutive; load cases and modes are not
    needs_record : whether measures need the record, so that batches keep it
    """

    model: Any
    analysis: Analysis
    parameters: np.ndarray
    status: Status
    statistics: dict[str, Any]
    record: Any
    warnings: Sequence[str] = ()
    events: Sequence[Any] = ()
    impacts: Sequence[Any] = ()
    continuous: ClassVar[bool] = True
    in_sequence: ClassVar[bool] = True
    needs_record: ClassVar[bool] = False

    if TYPE_CHECKING:  # a property or a field of the results

        @property
        def time(self) -> np.ndarray: ...

    def at(self, times: Instants) -> Self:
        """The result at other instants, or for some of the numbers."""
        ...

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, a formula or an expression."""
        ...

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) values of a scalar measure."""
        ...

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            raise missing_name(self, name, REMEDIES.get(name, ""), OTHER_NAMES)

    @property
    def over_steps(self) -> Self:
        """The result at the sampling points of integrals."""
        return self

    def __contains__(self, measure: object) -> bool:
        """Whether ``result[measure]`` exists: the name of a measure, or a formula of names."""
        if not isinstance(measure, (str, Expression)):
            return False
        try:
            self.expression(measure)
        except (ExpressionError, AnalysisError):  # AnalysisError: not a measure of this result
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
            Unknown name; suggests the nearest ones.
        """
        import xarray as xr

        expression = self.expression(measure)
        name = expression.name or (measure if isinstance(measure, str) else "measure")
        attributes = {"units": expression.unit, "long_name": name}
        return xr.DataArray(self.values(expression), coords, list(coords), name, attributes)

    # output --------------------------------------------------------------------------------
    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of the dataset."""
        return {"model": self.model.name, "status": str(self.status)}

    @cached_property
    def contents(self) -> Contents:
        """Labelled arrays of the result, for files and pages."""
        ...

    @cached_property
    def _dataset(self) -> xr.Dataset:
        return self.contents.dataset()

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset of the result."""
        return self._dataset

    def summary(self) -> dict[str, Any]:
        """``status`` and the main numbers."""
        ...

    def page(self) -> dict[str, Any]:
        """Payload of the report as plain data."""
        ...

    def live_page(
        self,
        page: dict[str, Any],
        live: bool | None = None,
        responses: Sequence[PageResponse] = (),
        designs: PageDesigns | None = None,
        units: Sequence[str] = (),
        max_bytes: int | None = None,
    ) -> dict[str, Any]:
        """Payload of a live page, or the page with the reason why it is not live.

        Parameters
        ----------
        page : payload of the report
        live : whether the page is live; by default where that is possible and the page stays small
        responses : that it lists, by default the maxima of the plotted measures
        designs : designs of its table
        units : preferred units of the responses; each applies to its dimension
        max_bytes : upper limit of the size of its module if ``live`` is not given; by default that
            of pages that are sent to others
        """
        from dalembert.results.files.live_page import live_page

        return live_page(self, page, live, responses, designs, units, max_bytes)

    def page_times(self, page: dict[str, Any], responses: Sequence[PageResponse]) -> np.ndarray:
        """Instants, or numbers of states, that a live page with these responses computes."""
        return np.array(page["states"]["numbers"] if "states" in page else page.get("time", ()))

    def page_reduction(self, term: Any, times: np.ndarray) -> dict[str, Any]:
        """Reduction of a response in a page, as plain data.

        Raises
        ------
        UnsupportedError
            Pages do not compute it.
        """
        return term.reduction(times)  # type: ignore[no-any-return]

    def page_extras(
        self, row_of: Callable[[ca.SX], int], responses: Sequence[dict[str, Any]]
    ) -> dict[str, Any]:
        """Further constants of a live page with these responses."""
        return {}

    def first_responses(self) -> Sequence[FirstResponse]:
        """Responses that a live page lists by default; if empty, maxima of the plotted measures."""
        return ()

    def save(self, path: str | Path, **first_view: Any) -> Path:
        """Write all results and the page to a NetCDF file; ``load_results`` reads it back."""
        return self._save(path, self.page(**first_view))

    def _save(self, path: str | Path, page: dict[str, Any]) -> Path:
        from dalembert.report.packing import pack
        from dalembert.report.page import as_json
        from dalembert.results.files.store import save_dataset

        page_variable = {"report": ((), as_json(pack(page)))}
        return save_dataset(self.saved_contents().plus(page_variable), path)

    def saved_contents(self) -> Contents:
        """``contents`` with all that a file states."""
        return self.contents

    def to_dataframe(self) -> pd.DataFrame:
        """A table of ``data``."""
        return self.data.to_dataframe()

    def to_csv(self, path: str | Path, units: Sequence[str] = ()) -> Path:
        """Write ``to_dataframe`` as CSV, with units in the headings.

        Parameters
        ----------
        units : preferred units, such as ``["mm", "deg"]``; each applies to its dimension
        """
        from dalembert.results.files.store import save_table
        from dalembert.results.files.tables import with_unit_headings

        table = self.to_dataframe()
        declared = {
            name: attributes.get("units", "")
            for name, (*_, attributes) in self.contents.variables.items()
        }
        return save_table(
            with_unit_headings(table, declared | table.attrs.get("units", {}), units), path
        )

    def report(
        self,
        path: str | Path,
        *,
        live: bool | None = None,
        responses: Sequence[PageResponse] = (),
        **first_view: Any,
    ) -> Path:
        """Write the interactive report, one self-contained HTML file.

        ``live`` and ``responses`` as in ``live_page``.
        """
        from dalembert.report.page import write_page

        page, units = self.page(**first_view), first_view.get("units", ())
        return write_page(self.live_page(page, live, responses, units=units), path)

    def show(self, height: int = 680, **first_view: Any) -> InlinePage:
        """Report in a notebook, with player and plots."""
        from dalembert.report.page import InlinePage

        return InlinePage(self.page(**first_view), height)

    def _repr_html_(self) -> str:
        scalars = {k: v for k, v in self.summary().items() if isinstance(v, str | int | float)}
        rows = [(name.replace("_", " "), value) for name, value in scalars.items()]
        rows += [(name.replace("_", " "), value) for name, value in self.statistics.items()]
        name = getattr(self.model, "name", "")
        warnings = messages(("warning", text) for text in self.warnings)
        kind = type(self).__name__
        return card(f"{kind} of {name}", "show() draws it here", warnings, table(rows))

    def write(self, base: Path, report: bool, csv: bool, **first_view: Any) -> list[Path]:
        """Write results (.nc) and, if requested, a table (.csv) and a report (.report.html)."""
        from dalembert.report.page import write_page

        page = self.page(**first_view)
        files = self.write_data(base, csv, page, first_view.get("units", ()))
        if report:
            files.append(write_page(page, base.with_name(f"{base.name}.report.html")))
        return files

    def write_data(
        self, base: Path, csv: bool, page: dict[str, Any], units: Sequence[str] = ()
    ) -> list[Path]:
        """Write results with their page (.nc) and, if requested, a table (.csv)."""
        files = [self._save(base.with_name(f"{base.name}.nc"), page)]
        if csv:
            files.append(self.to_csv(base.with_name(f"{base.name}.csv"), units))
        return files
