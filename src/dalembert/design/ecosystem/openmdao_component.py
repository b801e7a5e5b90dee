"""Explicit component of OpenMDAO, an optional package."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.quantity import Objective
from dalembert.errors import AnalysisError
from dalembert.packages import optional_package
from dalembert.results.analysis import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments


@check_arguments
def openmdao_component(
    model: ParametricModel | None,
    responses: Objective | Sequence[Objective],
    *,
    analysis: Analysis | None = None,
    vary: Sequence[str] | None = None,
    gradient: Method = "auto",
) -> Any:
    """``openmdao.api.ExplicitComponent`` from parameters to responses, with exact partials.

    Inputs have the names of the parameters, outputs the labels of the responses, with ``_`` for
    characters that OpenMDAO does not allow. A failing run raises OpenMDAO's ``AnalysisError``, upon
    which drivers backtrack. ``pip install dalembert[mdo]``.

    Parameters
    ----------
    model, analysis : model and analysis
    responses : one or several
    vary : names of the inputs; default all with bounds
    gradient : ``"direct"``, ``"adjoint"`` or ``"auto"`` for the cheaper of them

    Raises
    ------
    UnsupportedError
        OpenMDAO is not installed.

    Examples
    --------
    >>> import dalembert as da
    >>> import openmdao.api as om
    >>> from dalembert import structures
    >>> rod = da.Structure("spring")
    >>> k = rod.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = rod.node("end", 0)
    >>> part = rod.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> rod.load(end, fx=100.0)
    >>> response = da.final("end.ux", name="u")
    >>> problem = om.Problem(reports=None)
    >>> component = da.openmdao_component(rod.build(), response, analysis=da.Statics())
    >>> part = problem.model.add_subsystem("spring", component)
    >>> ready = problem.setup()
    >>> problem.run_model()
    >>> float(problem["spring.u"][0])  # F/k
    2.0
    """
    om = optional_package("openmdao.api", "an OpenMDAO component")
    functions = DesignFunctions(model, responses, analysis=analysis, vary=vary, gradient=gradient)
    inputs_, outputs = openmdao_names(functions.names), openmdao_names(functions.labels)

    class Component(om.ExplicitComponent):  # type: ignore[name-defined, misc]
        """Responses of a design for OpenMDAO."""

        def setup(self) -> None:
            for name, value in zip(inputs_, functions.x0, strict=True):
                self.add_input(name, float(value))
            for output in outputs:
                self.add_output(output)
            self.declare_partials("*", "*")

        def compute(self, inputs: Any, outputs_: Any, *ignored: Any) -> None:
            values = functions.values(_vector(inputs))
            if not np.all(np.isfinite(values)):
                raise om.AnalysisError(functions.problem.failures[-1])
            for output, value in zip(outputs, values, strict=True):
                outputs_[output] = value

        def compute_partials(self, inputs: Any, partials: Any, *ignored: Any) -> None:
            slopes = functions.jacobian(_vector(inputs))
            for output, row in zip(outputs, slopes, strict=True):
                for name, slope in zip(inputs_, row, strict=True):
                    partials[output, name] = slope

    def _vector(inputs: Any) -> np.ndarray:
        return np.array([float(np.ravel(inputs[name])[0]) for name in inputs_])

    return Component()


def openmdao_names(labels: Sequence[str]) -> list[str]:
    """Labels with ``_`` for characters that OpenMDAO does not allow.

    Raises
    ------
    AnalysisError
        Two labels become equal.
    """
    names = [re.sub(r"\W", "_", label) for label in labels]
    if len(set(names)) < len(names):
        raise AnalysisError(f"OpenMDAO names must differ in letters or digits: {list(labels)}")
    return names
