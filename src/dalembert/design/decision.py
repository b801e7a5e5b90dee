"""Base class of the results of design tasks: summary, data, page and files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from dalembert.text.wording import nearest

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.pages.live import LiveTask


def axis_label(name: str, unit: str) -> str:
    """Name with its unit in brackets, if it has one."""
    return f"{name} [{unit}]" if unit else name


def plot_axes(ax: Axes | None, figsize: tuple[float, float]) -> Axes:
    """Matplotlib axes with a light grid: ``ax``, or new ones if it is None."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=figsize, layout="constrained")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


class Decision(ABC):
    """Result of a design task.

    Attributes
    ----------
    success : whether the task reached its goal
    message : how it ended
    interrupted : ended by Ctrl-C, with the results so far
    name : of the model
    warnings : reservations about the result, each with the number that shows it
    """

    file_suffix: ClassVar[str]
    """Part of file names, such as ``pump.pareto.nc``."""
    page_functions: ClassVar[str]
    """``module:prefix`` in ``design.pages``: its ``prefix_page`` and ``prefix_views``."""
    success: bool
    message: str
    name: str
    interrupted: bool = False
    warnings: Sequence[str] = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            known = [own for own in dir(type(self)) if not own.startswith("_")]
            close = "" if name.startswith("_") else nearest(name, known)
            raise AttributeError(f"{type(self).__name__} has no {name!r}{close}")

    @property
    def ok(self) -> bool:
        """Whether there is a usable result; of a study, at least one design."""
        return bool(np.any(self.success))

    def interrupt(self) -> None:
        """Mark the result as interrupted by Ctrl-C."""
        self.interrupted = True

    @property
    def sentence(self) -> str:
        """Result in one line."""
        return self.message

    def summary(self) -> dict[str, Any]:
        """All results as plain data."""
        ending = {"ok": self.ok, "message": self.message, "interrupted": self.interrupted}
        return ending | {"warnings": list(self.warnings)} | self.findings()

    @abstractmethod
    def findings(self) -> dict[str, Any]:
        """Entries of ``summary`` beyond how the task ended."""

    @property
    @abstractmethod
    def data(self) -> xr.Dataset:
        """All results with names and units."""

    def views(self) -> list[dict[str, Any]]:
        """Views of the page in addition to the mechanism or structure."""
        views: list[dict[str, Any]] = self._page_function("views")(self)
        return views

    def table_of_designs(self) -> dict[str, Any] | None:
        """Table of the designs that can be selected on its page; None without any."""
        return None

    def page(self, **first_view: Any) -> dict[str, Any]:
        """Payload of its page as plain data, with the mechanism or structure if there is one."""
        page: dict[str, Any] = self._page_function("page")(self, **first_view)
        return page

    def live_task(self) -> LiveTask | None:
        """Result, designs and responses of its live page; None if its designs do not run there.

        Raises
        ------
        UnsupportedError
            These designs cannot; states the reason.
        """
        return None

    def live_page(self, live: bool | None = None, **first_view: Any) -> dict[str, Any]:
        """Payload of its live page, in which selected designs run, or its page with the reason why
        it is not live."""
        from dalembert.design.pages.live import live_page

        return live_page(self, live, first_view)

    def _page_function(self, kind: str) -> Callable[..., Any]:
        return resolve_name(f"dalembert.design.pages.{self.page_functions}_{kind}")  # type: ignore[no-any-return]

    # files ---------------------------------------------------------------------------------
    def to_dataframe(self) -> pd.DataFrame:
        """``data`` as a table."""
        return self.data.to_dataframe()

    def save(self, path: str | Path, **first_view: Any) -> Path:
        """Write to a file, atomically.

        ``.nc`` holds ``data`` and the page and is read by ``load_results``; ``.json`` holds the
        ``summary``, ``.csv`` and ``.parquet`` the table.
        """
        from dalembert.files import atomic_path
        from dalembert.report.page import as_json
        from dalembert.results.files.store import save_dataset
        from dalembert.text.wording import as_document

        path = Path(path)
        if path.suffix == ".json":
            with atomic_path(path) as temporary:
                temporary.write_text(as_document(self.summary()) + "\n", encoding="utf-8")
            return path
        if path.suffix in (".csv", ".parquet"):
            table = self.to_dataframe()
            with atomic_path(path) as temporary:
                table.to_csv(temporary) if path.suffix == ".csv" else table.to_parquet(temporary)
            return path
        page = as_json(self.page(**first_view))
        return save_dataset(self.data.assign(report=((), page)), path)

    def report(self, path: str | Path, live: bool | None = None, **first_view: Any) -> Path:
        """Write its page as one self-contained HTML file.

        In a live page every parameter is a slider, and a design that is selected sets the sliders:
        the page computes its result and the responses of the task, without a server.

        Parameters
        ----------
        path : of the file
        live : whether the page is live; by default as for motions, see ``Motion.report``
        **first_view : options of the page of its result
        """
        from dalembert.report.page import write_page

        return write_page(self.live_page(live, **first_view), path)

    def write(self, base: Path, live: bool | None = None, **first_view: Any) -> list[Path]:
        """Write data and page (.nc), summary (.json) and page (.report.html) side by side."""
        from dalembert.report.page import as_json
        from dalembert.results.files.store import save_dataset

        page = self.page(**first_view)
        stem = f"{base.name}.{self.file_suffix}"
        data = self.data.assign(report=((), as_json(page)))
        return [
            save_dataset(data, base.with_name(f"{stem}.nc")),
            self.save(base.with_name(f"{stem}.json")),
            self.report(base.with_name(f"{stem}.report.html"), live, **first_view),
        ]

    # for notebooks ---------------------------------------------------------------------------
    def table_html(self) -> str:
        """Short HTML for notebooks that cannot show pages."""
        from html import escape

        return f"<p>{escape(repr(self))}</p>{self.warnings_html()}"

    def warnings_html(self) -> str:
        """HTML of the warnings."""
        from dalembert.text.wording import messages

        return messages(("warning", text) for text in self.warnings)

    def _repr_html_(self) -> str:
        from dalembert.design.pages.decision import page_frame

        return self.table_html() + page_frame(self)
