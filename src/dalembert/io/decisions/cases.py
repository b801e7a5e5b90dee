"""Responses of several load cases and their combinations, for the design tasks of a file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from dalembert.design.case import Case
from dalembert.design.quantity import Combined, Objective, with_case
from dalembert.design.robust import Robust
from dalembert.errors import ModelError
from dalembert.io.analyses import make_analysis, make_table
from dalembert.io.decisions.reliability import correlations, random_parameters
from dalembert.io.decisions.responses import make_response, measure_reader
from dalembert.io.model_file import ModelFile, load_model_file
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown

OWN_RUN = ""
"""Name of the run of the file itself."""


class Quantities:
    """Quantities of a design: responses of all cases and their combinations.

    Parameters
    ----------
    file, model : of the run of responses without a case
    """

    def __init__(self, file: ModelFile, model: ParametricModel):
        self.file, self.model = file, model
        self.document: Any = file.document
        self._cases: dict[str, Case] = {}
        self._files: dict[Path, tuple[ModelFile, ParametricModel]] = {}
        self._quantities: dict[str, Objective] = {}
        self._in_progress: list[str] = []

    @property
    def names(self) -> list[str]:
        """Names of all responses, combinations and robust responses."""
        return [*self.document.responses, *self.document.combined, *self.document.robust]

    @property
    def models(self) -> list[ParametricModel]:
        """Models of all cases in use; the model of the file comes first."""
        return [self.model, *(case.model for case in self._cases.values())]

    def __getitem__(self, name: str) -> Objective:
        """A response, a response of a case, or a combination.

        Raises
        ------
        ModelError
            Invalid constituents; states the location.
        """
        if name not in self._quantities:
            if name in self._in_progress:
                chain = " → ".join([*self._in_progress[self._in_progress.index(name) :], name])
                raise self.file.located.error(f"depends on itself: {chain}", *self._place(name))
            self._in_progress.append(name)
            self._quantities[name] = self._make(name)
            self._in_progress.pop()
        return self._quantities[name]

    def _place(self, name: str) -> tuple[str, str]:
        sections = ("combined", "robust")
        return next((s for s in sections if name in getattr(self.document, s)), "responses"), name

    def _make(self, name: str) -> Objective:
        if name in self.document.combined:
            return self._combined(name)
        if name in self.document.robust:
            return self._robust(name)
        table = self.document.responses[name]
        owner = getattr(table, "case", None)
        if owner is None:
            read, analysis = measure_reader(self.document), self.document.analysis
            return make_response(self.file, self.model, name, table, read, analysis)
        case, document = self._case(owner, "responses", name, "case"), self._file_of(owner).document
        analysis = self.document.cases[owner].analysis or document.analysis
        return case[
            make_response(self.file, case.model, name, table, measure_reader(document), analysis)
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
        response: Any = self.require(table.response, "robust", name, "response")
        with self.file.located("robust", name):
            correlation = correlations(self.file, random)
            return Robust(response, random, table.deviations, correlation, name)

    # cases ---------------------------------------------------------------------------------
    def _case(self, name: str, *where: str) -> Case:
        if name in self._cases:
            return self._cases[name]
        tables: Any = getattr(self.document, "cases", {})
        if name == OWN_RUN:
            self._cases[OWN_RUN] = Case(self.model, make_analysis(self.file, self.model))
            return self._cases[OWN_RUN]
        if name not in tables:
            raise self.file.located.error(unknown("case", name, tables), *where)
        table, location = tables[name], ("cases", name)
        if (table.model is None) == (table.analysis is None):
            raise self.file.located.error(
                "give model, another file, or analysis, of this", *location
            )
        bindings = {}
        for parameter, response in table.inputs.items():
            if response not in self.names:
                text = unknown("response", response, self.names)
                raise self.file.located.error(text, *location, "inputs", parameter)
            bindings[parameter] = with_case(self[response], self._case(OWN_RUN))
        if table.analysis is not None:
            model = self.model
            analysis = make_table(self.file, model, table.analysis, *location, "analysis")
        else:
            file = self._file_of(name)
            model = self._files[file.path][1]
            analysis = make_analysis(file, model)
        with self.file.located(*location, "inputs"):
            self._cases[name] = Case(model, analysis, bindings)
        return self._cases[name]

    def _file_of(self, name: str) -> ModelFile:
        """File of the model of a case."""
        table = getattr(self.document, "cases", {}).get(name) if name else None
        if table is None or table.model is None:
            return self.file
        path = self.file.path.parent / table.model
        if path not in self._files:
            with self.file.located("cases", name, "model"):
                file = load_model_file(path)
                self._files[path] = file, file.model()
        return self._files[path][0]

    def bind(self, quantity: Objective) -> Objective:
        """The quantity, bound to the run of the file if other cases depend on that."""
        return with_case(quantity, self._cases[OWN_RUN]) if OWN_RUN in self._cases else quantity

    def require(self, name: str, *where: str | int) -> Objective:
        """The quantity of this name.

        Raises
        ------
        ModelError
            Unknown name, or invalid constituents.
        """
        if not self.names:
            text = 'has none; add e.g. [responses.peak] with type = "Maximum" and a measure'
            raise self.file.located.error(text, "responses")
        if name not in self.names:
            raise self.file.located.error(unknown("response", name, self.names), *where)
        return self[name]


def _names(formula: str, name: str) -> bool:
    """Whether a formula contains this name."""
    return re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", formula) is not None
