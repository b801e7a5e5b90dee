"""What is done for every design of a study, and what it is known by."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.solve import solve_batch
from dalembert.analysis.times import follow_parameters
from dalembert.design.optimize.optimization import design_problem
from dalembert.design.optimize.problem import NOT_FINITE
from dalembert.design.studies.design import Design
from dalembert.errors import AnalysisError, DalembertError
from dalembert.model.model import Model
from dalembert.responses.base import Response
from dalembert.responses.batch import batch_responses
from dalembert.results.batch.designs import Designs
from dalembert.results.result import Analysis
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parameter import parameter_vector
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.units.measured import check_measured


@dataclass(frozen=True)
class Answer:
    """What a design gave.

    Attributes
    ----------
    number : of the design
    values : of the responses; not a number where it failed
    reason : why it failed; empty where it did not
    """

    number: int
    values: tuple[float, ...]
    reason: str = ""


@dataclass(frozen=True, eq=False)
class StudyTask:
    """A model, an analysis of it, and responses: all that a worker needs."""

    model: ParametricModel
    analysis: Analysis
    responses: Sequence[Response]
    together: bool = True
    """Designs go through the batch engine where that serves the analysis."""

    @property
    def units(self) -> dict[str, str]:
        """Unit of every parameter and response."""
        made = {name: p.unit for name, p in self.model.parameters.items()}
        for response in self.responses:
            made[response.label] = response.unit_of(self.model)
        return made

    def failed(self, number: int, reason: str) -> Answer:
        """The answer of a design that has none."""
        return Answer(number, (float("nan"),) * len(self.responses), reason)

    @cached_property
    def batched(self) -> bool:
        """Whether designs are run side by side."""
        engine = getattr(self.analysis, "batched", None)
        if engine is None or not self.together or follow_parameters(self.analysis):
            return False
        try:
            return bool(engine.serves(self.analysis, self.model))
        except DalembertError:  # the nominal design fails; others need not
            return False

    def answers(
        self, numbers: np.ndarray, names: Sequence[str], values: np.ndarray
    ) -> list[Answer]:
        """Run some designs, side by side where the analysis allows it."""
        if self.batched:  # even one, so that chunks of any size find the same numbers
            try:
                return self._side_by_side(numbers, names, values)
            except DalembertError:  # all fail for one reason, or there is no room for so many
                pass
        pairs = zip(numbers, values, strict=True)
        return [self.answer(int(number), names, row) for number, row in pairs]

    def _side_by_side(
        self, numbers: np.ndarray, names: Sequence[str], values: np.ndarray
    ) -> list[Answer]:
        columns = dict(zip(names, values.T, strict=True))
        designs = Designs.of(self.model, columns)
        batch = solve_batch(self.analysis, self.model, designs, False, 1)
        if Outcome.INTERRUPTED in batch.counts:
            raise KeyboardInterrupt
        found = batch_responses(batch, self.responses)
        table = np.column_stack([found[r.label].values for r in self.responses])
        made = []
        for number, status, row in zip(numbers, batch.statuses, table, strict=True):
            reason = _reason(status)
            if not reason and not np.all(np.isfinite(row)):
                reason = NOT_FINITE
            kept = tuple(map(float, row))
            made.append(self.failed(int(number), reason) if reason else Answer(int(number), kept))
        return made

    def answer(self, number: int, names: Sequence[str], values: np.ndarray) -> Answer:
        """Run one design; what fails is told, not raised."""
        problem = design_problem(self.model, self.analysis, self.responses, names)
        try:
            found = problem.evaluate(values, gradient=False)
        except DalembertError as error:  # values with which an element cannot be
            return self.failed(number, str(error))
        except Exception as error:  # one design must not end a study of thousands
            return self.failed(number, f"{type(error).__name__}: {error}")
        if found is None:
            return self.failed(number, problem.failures[-1])
        return Answer(number, tuple(float(v) for v in found.values))

    def warnings(self, design: Design, numbers: Iterable[int]) -> list[str]:
        """Warnings of some designs, each run on its own."""
        texts: list[str] = []
        for number in numbers:
            parameters = dict(zip(design.names, design.values[number], strict=True))
            with suppress(DalembertError):  # the batch ran it in another way
                result = self.analysis.run(self.model, parameters)
                texts += [f"design {number}: {text}" for text in result.warnings]
        return texts

    def check(self, design: Design) -> None:
        """Refuse names that the model does not have.

        Raises
        ------
        ModelError
            Names the nearest parameters.
        AnalysisError
            A response is called like a column of the table, or the design is no ``Design``.
        """
        if not isinstance(design, Design):
            raise AnalysisError(
                f"design is {design!r:.60}; give a da.Design, such as "
                "da.Design.grid({'length': [1.0, 2.0]})"
            )
        taken = {"design", "reason", *design.names}
        for response in self.responses:
            if response.label in taken:
                raise AnalysisError(
                    f"a response is called {response.label!r}, as a column of the table is; "
                    "give it another name"
                )
        one = dict(zip(design.names, design.values[0], strict=True))
        parameter_vector(self.model.parameters, one, self.model.name)
        for name, values in design.given.items():
            given = [] if isinstance(values, np.ndarray) else values
            check_measured(given, self.model.parameters[name].unit, name)

    def identity(self, design: Design) -> str:
        """Hash of everything that decides what the study finds."""
        digest = hashlib.sha256()
        model = [self.model.name, self.model.nominal, list(self.model.parameters)]
        about = [model, self.analysis, list(self.responses), design.names, design.values]
        for text in (*map(described, about), model_text(self.model)):
            digest.update(text.encode() + b"\0")
        return digest.hexdigest()


def _reason(status: Status) -> str:
    """Why a design of a batch failed, in the words of a run of its own."""
    if status.success:
        return ""
    begun = status.outcome not in (Outcome.NOT_ASSEMBLED, Outcome.REFUSED)
    return str(status) if begun else status.message


def model_text(model: ParametricModel) -> str:
    """The equations of a mechanism, or the description of a structure, as text."""
    if isinstance(model, Model):
        e = model.all_equations
        stated = [e.pose_rate, e.inertia.matrix, e.bias, e.force, e.constraints, e.nonholonomic]
        graphs = [ca.SX(g) for g in stated if isinstance(g, (ca.SX, ca.DM))]
        free = ca.symvar(ca.vertcat(*(ca.vec(g) for g in graphs)))
        start = described([model.guesses])
        return ca.Function("equations", free, graphs).serialize() + start
    return described(vars(getattr(model, "structure", model)))


def described(thing: Any, depth: int = 14) -> str:
    """Options, tables and formulas as text that is the same in every process."""
    if isinstance(thing, np.ndarray):
        return f"{thing.shape}{thing.dtype}{hashlib.sha256(thing.tobytes()).hexdigest()}"
    if thing is None or isinstance(thing, (str, bytes, bool, int, float, complex, np.generic)):
        return repr(thing)
    if isinstance(thing, (Expression, ca.SX, ca.DM)):
        return str(thing if not isinstance(thing, Expression) else (thing.sx, thing.unit))
    kind = type(thing).__name__
    if depth == 0:
        return kind
    if isinstance(thing, Mapping):
        inner: Iterable[Any] = ((str(key), value) for key, value in thing.items())
    elif isinstance(thing, (list, tuple)):
        inner = thing
    elif is_dataclass(thing):
        inner = [(f.name, getattr(thing, f.name, None)) for f in fields(thing)]
    else:
        return getattr(thing, "__qualname__", kind)
    return f"{kind}({','.join(described(part, depth - 1) for part in inner)})"
