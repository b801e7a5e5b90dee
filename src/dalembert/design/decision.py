"""What tasks of design end with: numbers for people and programs, a page, and files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class Decision(ABC):
    """The end of a task of design.

    Attributes
    ----------
    success : whether it came to what was asked for
    message : how it ended
    interrupted : by Ctrl-C; what there was by then is kept
    name : of what was decided on
    warnings : doubts about the result, each with the number that shows it
    """

    word: ClassVar[str]
    """In names of files, such as ``pump.pareto.nc``."""
    drawn: ClassVar[str]
    """Of ``design.pages``: module and function of its page and views, without these words."""
    success: bool
    message: str
    name: str
    interrupted: bool = False
    warnings: Sequence[str] = ()

    @property
    def ok(self) -> bool:
        """Whether there is something to decide by; of a study, any design."""
        return bool(np.any(self.success))

    def interrupt(self) -> None:
        """Record that Ctrl-C ended the task."""
        self.interrupted = True

    @property
    def sentence(self) -> str:
        """What was found, in a line."""
        return self.message

    def summary(self) -> dict[str, Any]:
        """Everything found, as plain data."""
        ended = {"ok": self.ok, "message": self.message, "interrupted": self.interrupted}
        return ended | {"warnings": list(self.warnings)} | self.findings()

    @abstractmethod
    def findings(self) -> dict[str, Any]:
        """What ``summary`` tells beside how it ended."""

    @property
    @abstractmethod
    def data(self) -> xr.Dataset:
        """Everything found, with names and units."""

    def views(self) -> list[dict[str, Any]]:
        """What its page shows beside a mechanism or structure."""
        made: list[dict[str, Any]] = self._drawn_by("views")(self)
        return made

    def table_of_designs(self) -> dict[str, Any] | None:
        """Designs that its page lets choose from, where there are some."""
        return None

    def page(self, **first_view: Any) -> dict[str, Any]:
        """What its page shows, as plain data: the mechanism or structure where there is one."""
        made: dict[str, Any] = self._drawn_by("page")(self, **first_view)
        return made

    def _drawn_by(self, what: str) -> Callable[..., Any]:
        return resolve_name(f"dalembert.design.pages.{self.drawn}_{what}")  # type: ignore[no-any-return]

    # files ---------------------------------------------------------------------------------
    def to_dataframe(self) -> pd.DataFrame:
        """A table of ``data``."""
        return self.data.to_dataframe()

    def save(self, path: str | Path, **first_view: Any) -> Path:
        """Write it to a file, whole or not at all.

        ``.nc`` has ``data`` and the page, ``load_results`` reads it back; ``.json`` has the
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

    def report(self, path: str | Path, **first_view: Any) -> Path:
        """Write its page, one self-contained HTML file."""
        from dalembert.report.page import write_page

        return write_page(self.page(**first_view), path)

    def write(self, base: Path, **first_view: Any) -> list[Path]:
        """Data and page (.nc), numbers (.json), and the page (.report.html) beside each other."""
        from dalembert.report.page import as_json, write_page
        from dalembert.results.files.store import save_dataset

        page = self.page(**first_view)
        stem = f"{base.name}.{self.word}"
        data = self.data.assign(report=((), as_json(page)))
        return [
            save_dataset(data, base.with_name(f"{stem}.nc")),
            self.save(base.with_name(f"{stem}.json")),
            write_page(page, base.with_name(f"{stem}.report.html")),
        ]

    # for notebooks ---------------------------------------------------------------------------
    def table_html(self) -> str:
        """A few lines of HTML where pages cannot be shown."""
        from html import escape

        return f"<p>{escape(repr(self))}</p>{self.warnings_html()}"

    def warnings_html(self) -> str:
        """The warnings, one below the other."""
        from dalembert.text.wording import messages

        return messages(("warning", text) for text in self.warnings)

    def _repr_html_(self) -> str:
        from dalembert.design.pages.plain import framed

        return self.table_html() + framed(self)
