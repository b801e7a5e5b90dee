"""Case of a design: a model and the analysis that is run of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from dalembert.design.quantity import AnalysisCase, CaseResponse, Quantity
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import unknown


@dataclass(frozen=True, eq=False)
class Case(CheckedArguments):
    """A model and an analysis: ``case[response]`` is an objective or a limit of a design.

    Parameters of the same name in several cases are one variable.

    Parameters
    ----------
    model : mechanism or structure
    analysis : a strategy object, as ``Dynamics(...)`` or ``Statics()``
    inputs : parameter of this model → quantity of another case that sets it, such as the load of
        a member from the force of a joint; gradients follow the chain rule

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> def spring(name):
    ...     model = da.Structure(name)
    ...     k, load = model.parameter("k", 50.0, bounds=(1, 1e3)), model.parameter("load", 1.0)
    ...     end = model.node("end", 0)
    ...     part = model.add(structures.GroundSpring("spring", end, stiffness_x=k))
    ...     model.load(end, fx=load)
    ...     return model.build()
    >>> first = da.Case(spring("first"), da.Statics())
    >>> bend = first[da.final("end.ux")]
    >>> second = da.Case(spring("second"), da.Statics(), inputs={"load": bend})
    >>> cost = da.combined("k + 4e6*u", k=first[da.final("k")], u=second[da.final("end.ux")])
    >>> round(da.optimize(minimize=cost).x["k"], 1)  # of k + 4e6/k²: (8e6)^(1/3)
    200.0
    """

    model: ParametricModel
    analysis: Analysis
    inputs: Mapping[str, Quantity] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.analysis, Analysis):
            raise AnalysisError(
                f"analysis is {self.analysis!r}; give a strategy object such as da.Kinematics(1.0)"
            )
        for name, quantity in self.inputs.items():
            if name not in self.model.parameters:
                raise AnalysisError(
                    f"{self.model.name}: {unknown('parameter', name, self.model.parameters)}"
                )
            if not isinstance(quantity, Quantity):
                raise AnalysisError(f"{name}: give case[response], got {quantity!r:.60}")

    def __getitem__(self, response: Response, /) -> CaseResponse:
        if not isinstance(response, Response):
            raise AnalysisError(
                f"{response!r} is not a response; give one such as da.final(measure)"
            )
        return CaseResponse(self, response)

    @property
    def needs(self) -> list[AnalysisCase]:
        """Cases whose quantities set parameters of this one."""
        return [term.case for quantity in self.inputs.values() for term in quantity.terms]


def evaluation_order(cases: Sequence[AnalysisCase]) -> list[AnalysisCase]:
    """Cases and the cases they depend on, each once, in order of evaluation."""
    ordered: list[AnalysisCase] = []
    for case in cases:
        for required in (*evaluation_order(case.needs), case):
            if required not in ordered:
                ordered.append(required)
    return ordered
