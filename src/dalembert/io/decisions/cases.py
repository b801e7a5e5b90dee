"""Responses of several runs, and formulas of them, as a file asks of a design."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from dalembert.design.case import Case
from dalembert.design.quantity import Combined, with_case
from dalembert.design.robust import Robust
from dalembert.errors import ModelError
from dalembert.io.analyses import make_analysis, make_table
from dalembert.io.decisions.random import correlations, random_parameters
from dalembert.io.decisions.responses import make_response
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile, load_model_file
from dalembert.text.wording import unknown

OWN = ""
"""Name of the run that the file itself asks for."""


class Quantities:
    """What a design is judged by: responses of all cases, and combinations of them.

    Parameters
    ----------
    file, model : of the run that responses without a case belong to
    """

    def __init__(self, file: ModelFile, model: Any):
        self.file, self.model = file, model
        self.document: Any = file.document
        self._cases: dict[str, Case] = {}
        self._files: dict[Path, tuple[ModelFile, Any]] = {}
        self._made: dict[str, Any] = {}
        self._making: list[str] = []

    @property
    def names(self) -> list[str]:
        """Of all responses, combinations, and responses with their scatter."""
        return [*self.document.responses, *self.document.combined, *self.document.robust]

    @property
    def models(self) -> list[Any]:
        """Those of all cases that were asked for, the file's own first."""
        return [self.model, *(case.model for case in self._cases.values())]

    def __getitem__(self, name: str) -> Any:
        """A response, a response of a case, or a combination.

        Raises
        ------
        ModelError
            What it is made of cannot be, with the place.
        """
        if name not in self._made:
            if name in self._making:
                chain = " → ".join([*self._making[self._making.index(name) :], name])
                raise self.file.located.error(f"needs itself: {chain}", *self._place(name))
            self._making.append(name)
            self._made[name] = self._make(name)
            self._making.pop()
        return self._made[name]

    def _place(self, name: str) -> tuple[str, str]:
        sections = ("combined", "robust")
        return next((s for s in sections if name in getattr(self.document, s)), "responses"), name

    def _make(self, name: str) -> Any:
        if name in self.document.combined:
            return self._combined(name)
        if name in self.document.robust:
            return self._robust(name)
        table = self.document.responses[name]
        owner = getattr(table, "case", None)
        if owner is None:
            read, run = measure_reader(self.document), self.document.analysis
            return make_response(self.file, self.model, name, table, read, run)
        case, document = self._case(owner, "responses", name, "case"), self._file_of(owner).document
        run = self.document.cases[owner].analysis or document.analysis
        return case[
            make_response(self.file, case.model, name, table, measure_reader(document), run)
        ]

    def _combined(self, name: str) -> Combined:
        table = self.document.combined[name]
        with self.file.located("combined", name):
            if name in self.document.responses:
                raise ModelError("a response has this name; choose another")
            parts = {n: self[n] for n in self.names if n != name and _names(table.formula, n)}
            if not parts:
                raise ModelError(f"{table.formula!r} names no response; known: {self.names}")
            return Combined(table.formula, parts, name, table.unit)

    def _robust(self, name: str) -> Robust:
        table, random = self.document.robust[name], random_parameters(self.file, self.model)
        if name in self.document.responses:
            raise self.file.located.error(
                "a response has this name; choose another", "robust", name
            )
        response = self.checked(table.response, "robust", name, "response")
        with self.file.located("robust", name):
            correlation = correlations(self.file, random)
            return Robust(response, random, table.deviations, correlation, name)

    # cases ---------------------------------------------------------------------------------
    def _case(self, name: str, *where: str) -> Case:
        if name in self._cases:
            return self._cases[name]
        known: Any = getattr(self.document, "cases", {})
        if name == OWN:
            self._cases[OWN] = Case(self.model, make_analysis(self.file, self.model))
            return self._cases[OWN]
        if name not in known:
            raise self.file.located.error(unknown("case", name, known), *where)
        table, here = known[name], ("cases", name)
        if (table.model is None) == (table.analysis is None):
            raise self.file.located.error("give model, another file, or analysis, of this", *here)
        given = {}
        for parameter, response in table.given.items():
            if response not in self.names:
                text = unknown("response", response, self.names)
                raise self.file.located.error(text, *here, "given", parameter)
            given[parameter] = with_case(self[response], self._case(OWN))
        if table.analysis is not None:
            model = self.model
            analysis = make_table(self.file, model, table.analysis, *here, "analysis")
        else:
            file = self._file_of(name)
            model = self._files[file.path][1]
            analysis = make_analysis(file, model)
        with self.file.located(*here, "given"):
            self._cases[name] = Case(model, analysis, given)
        return self._cases[name]

    def _file_of(self, name: str) -> ModelFile:
        """The file whose model a case runs."""
        table = getattr(self.document, "cases", {}).get(name) if name else None
        if table is None or table.model is None:
            return self.file
        path = self.file.path.parent / table.model
        if path not in self._files:
            with self.file.located("cases", name, "model"):
                file = load_model_file(path)
                self._files[path] = file, file.model()
        return self._files[path][0]

    def finished(self, quantity: Any) -> Any:
        """The same, bound to the file's own run where other cases lean on that."""
        return with_case(quantity, self._cases[OWN]) if OWN in self._cases else quantity

    def checked(self, name: str, *where: str | int) -> Any:
        """The one of this name.

        Raises
        ------
        ModelError
            There is none, or it cannot be made.
        """
        if not self.names:
            text = 'has none; add e.g. [responses.peak] with type = "Maximum" and a measure'
            raise self.file.located.error(text, "responses")
        if name not in self.names:
            raise self.file.located.error(unknown("response", name, self.names), *where)
        return self[name]


def _names(formula: str, name: str) -> bool:
    """Whether a formula has this name in it."""
    return re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", formula) is not None
