"""Task of a study: evaluation of designs, and the identity of the study."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property, partial
from types import SimpleNamespace

import casadi as ca
import numpy as np

from dalembert.analysis.batch.solve import solve_batch
from dalembert.analysis.times import follow_parameters
from dalembert.design.optimize.optimization import design_problem
from dalembert.design.optimize.problem import NOT_FINITE
from dalembert.design.studies.design_table import DesignTable
from dalembert.errors import AnalysisError, DalembertError
from dalembert.interrupts import check_ctrl_c
from dalembert.model.graph.model import Model
from dalembert.responses.base import Response
from dalembert.responses.evaluation import batch_responses
from dalembert.results.analysis import Analysis
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parameter import parameter_vector
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.units.measured import check_measured


@dataclass(frozen=True)
class Answer:
    """Responses of a design.

    Attributes
    ----------
    number : of the design
    values : of the responses; NaN if the design failed
    reason : reason of failure; empty if it succeeded
    """

    number: int
    values: tuple[float, ...]
    reason: str = ""


@dataclass(frozen=True, eq=False)
class StudyTask:
    """Model, analysis and responses, as needed by a worker."""

    model: ParametricModel
    analysis: Analysis
    responses: Sequence[Response]
    together: bool = True
    """Whether to use the batch engine for analyses that it supports."""

    @property
    def units(self) -> dict[str, str]:
        """Unit of every parameter and response."""
        units = {name: p.unit for name, p in self.model.parameters.items()}
        measures = SimpleNamespace(expression=partial(self.analysis.expression, self.model))
        for response in self.responses:
            units[response.label] = response.unit_of(measures)
        return units

    def failed(self, number: int, reason: str) -> Answer:
        """Answer of a failed design."""
        return Answer(number, (float("nan"),) * len(self.responses), reason)

    @cached_property
    def batched(self) -> bool:
        """Whether designs are run as a batch."""
        engine = getattr(self.analysis, "batched", None)
        if engine is None or not self.together or follow_parameters(self.analysis):
            return False
        try:
            return bool(engine.serves(self.analysis, self.model))
        except DalembertError:  # the nominal design fails, others may succeed
            return False

    def answers(
        self, numbers: np.ndarray, names: Sequence[str], values: np.ndarray
    ) -> list[Answer]:
        """Run designs, as a batch if the analysis supports it; an interrupted batch returns the
        answers of the finished designs."""
        if self.batched:  # even a single design, so that results do not depend on the chunk size
            try:
                return self._run_batch(numbers, names, values)
            except DalembertError:  # a common failure, or too little memory for the batch
                pass
        pairs = zip(numbers, values, strict=True)
        return [self.answer(int(number), names, row) for number, row in pairs]

    def _run_batch(
        self, numbers: np.ndarray, names: Sequence[str], values: np.ndarray
    ) -> list[Answer]:
        columns = dict(zip(names, values.T, strict=True))
        designs = Designs.of(self.model, columns)
        batch = solve_batch(self.analysis, self.model, designs, False, 1)
        if all(status.outcome is Outcome.INTERRUPTED for status in batch.statuses):
            raise KeyboardInterrupt
        responses = batch_responses(batch, self.responses)
        table = np.column_stack([responses[response.label].values for response in self.responses])
        answers = []
        for number, status, row in zip(numbers, batch.statuses, table, strict=True):
            if status.outcome is Outcome.INTERRUPTED:
                continue
            reason = _failure_reason(status)
            if not reason and not np.all(np.isfinite(row)):
                reason = NOT_FINITE
            response_values = tuple(map(float, row))
            answers.append(
                self.failed(int(number), reason) if reason else Answer(int(number), response_values)
            )
        return answers

    def answer(self, number: int, names: Sequence[str], values: np.ndarray) -> Answer:
        """Run one design; failures are returned, not raised."""
        problem = design_problem(self.model, self.analysis, self.responses, names)
        try:
            evaluation = problem.evaluate(values, gradient=False)
        except DalembertError as error:  # invalid parameter values of an element
            check_ctrl_c()  # compiled code may convert an interrupt to an error
            return self.failed(number, str(error))
        except Exception as error:  # one design must not abort the study
            check_ctrl_c()
            return self.failed(number, f"{type(error).__name__}: {error}")
        check_ctrl_c()
        if evaluation is None:
            return self.failed(number, problem.failures[-1])
        return Answer(number, tuple(float(v) for v in evaluation.values))

    def warnings(self, design: DesignTable, numbers: Iterable[int]) -> list[str]:
        """Warnings of some designs, each run on its own."""
        texts: list[str] = []
        for number in numbers:
            parameters = dict(zip(design.names, design.values[number], strict=True))
            with suppress(DalembertError):  # the batch ran it in another way
                result = self.analysis.run(self.model, parameters)
                texts += [f"design {number}: {text}" for text in result.warnings]
        return texts

    def check(self, design: DesignTable) -> None:
        """Refuse names that the model does not have.

        Raises
        ------
        ModelError
            Unknown parameter; the message lists similar names.
        AnalysisError
            A response has the name of another column, or ``design`` is no ``DesignTable``.
        """
        if not isinstance(design, DesignTable):
            raise AnalysisError(
                f"design is {design!r:.60}; give a da.DesignTable, such as "
                "da.DesignTable.grid({'length': [1.0, 2.0]})"
            )
        reserved = {"design", "reason", *design.names}
        for response in self.responses:
            if response.label in reserved:
                raise AnalysisError(
                    f"response {response.label!r} has the name of another column of the table; "
                    "give it another name"
                )
        first_design = dict(zip(design.names, design.values[0], strict=True))
        parameter_vector(self.model.parameters, first_design, self.model.name)
        for name, values in design.specified.items():
            measured_values = [] if isinstance(values, np.ndarray) else values
            check_measured(measured_values, self.model.parameters[name].unit, name)

    def identity(self, design: DesignTable) -> str:
        """Hash of everything that determines the results of the study."""
        digest = hashlib.sha256()
        model = [self.model.name, self.model.nominal, list(self.model.parameters)]
        content = [model, self.analysis, list(self.responses), design.names, design.values]
        for text in (*map(canonical_text, content), model_text(self.model)):
            digest.update(text.encode() + b"\0")
        return digest.hexdigest()


def _failure_reason(status: Status) -> str:
    """Reason of failure of a design of a batch, as of a single run."""
    if status.success:
        return ""
    has_started = status.outcome not in (Outcome.NOT_ASSEMBLED, Outcome.REFUSED)
    return str(status) if has_started else status.message


def model_text(model: ParametricModel) -> str:
    """Text of the equations of a mechanism, or of the description of a structure."""
    if isinstance(model, Model):
        e = model.all_equations
        terms = [e.pose_rate, e.inertia.matrix, e.bias, e.force, e.constraints, e.nonholonomic]
        graphs = [ca.SX(graph) for graph in terms if isinstance(graph, (ca.SX, ca.DM))]
        free = ca.symvar(ca.vertcat(*(ca.vec(graph) for graph in graphs)))
        start = canonical_text([model.guesses])
        return ca.Function("equations", free, graphs).serialize() + start
    return canonical_text(vars(getattr(model, "structure", model)))


def canonical_text(content: object, depth: int = 14) -> str:
    """Text of options, tables and formulas that is reproducible across processes."""
    if isinstance(content, np.ndarray):
        return f"{content.shape}{content.dtype}{hashlib.sha256(content.tobytes()).hexdigest()}"
    if content is None or isinstance(content, (str, bytes, bool, int, float, complex, np.generic)):
        return repr(content)
    if isinstance(content, (Expression, ca.SX, ca.DM)):
        return str(content if not isinstance(content, Expression) else (content.sx, content.unit))
    type_name = type(content).__name__
    if depth == 0:
        return type_name
    if isinstance(content, Mapping):
        parts: Iterable[object] = ((str(key), value) for key, value in content.items())
    elif isinstance(content, (list, tuple)):
        parts = content
    elif is_dataclass(content):
        parts = [(f.name, getattr(content, f.name, None)) for f in fields(content)]
    else:
        return getattr(content, "__qualname__", type_name)
    return f"{type_name}({','.join(canonical_text(part, depth - 1) for part in parts)})"
