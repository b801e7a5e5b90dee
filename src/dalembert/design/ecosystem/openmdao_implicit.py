"""Implicit component of OpenMDAO, an optional package."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.equilibrium.statics import Statics
from dalembert.design.ecosystem.mechanism_states import MechanismStates
from dalembert.design.ecosystem.openmdao_component import openmdao_names
from dalembert.design.ecosystem.states import Measures, StateEquations, StateTangent, input_names
from dalembert.design.ecosystem.structure_states import StructureStates
from dalembert.errors import AnalysisError, ModelError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.packages import optional_package
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments

STEP = 1e-6
"""Step of the differences by which OpenMDAO checks partials, relative to the scales [-]."""


@check_arguments
def openmdao_implicit_component(
    model: ParametricModel,
    measures: Measures = (),
    *,
    analysis: Analysis | None = None,
    vary: Sequence[str] | None = None,
    start: Mapping[str, float] | None = None,
    time: float = 0.0,
) -> Any:
    """``openmdao.api.ImplicitComponent`` from parameters to the state, with its residual.

    OpenMDAO solves the state equations together with those of other components, by its own solvers
    or by those of dalembert: residuals are scaled, derivatives are exact and matrix-free, linear
    systems are solved with sparse factors. Outputs are ``coordinates`` (and ``multipliers`` in
    equilibrium) of a mechanism, ``displacements`` (of all load cases) of a structure, and each
    measure. ``pip install dalembert[mdo]``.

    Parameters
    ----------
    model : mechanism or structure
    measures : names or formulas of the state, or label → measure; of a structure each has one
        value per load case
    analysis : ``Equilibrium()`` of a mechanism, by default the assembled position; ``Statics()``
        (default) or ``Equilibrium()`` of a structure
    vary : names of the parameters that are inputs; default all
    start : initial values of the inputs; default nominal
    time : instant of an assembled position [s]

    Raises
    ------
    UnsupportedError
        OpenMDAO is not installed, or the mechanism has rolling constraints.
    AnalysisError
        An unsupported analysis, or a measure that depends on more than the state.

    Examples
    --------
    >>> import dalembert as da
    >>> import openmdao.api as om
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> weight = system.parameter("weight", 2.0, "kg")
    >>> pan = system.add(planar.Particle("pan", mass=weight, position=(0, -0.1)))
    >>> spring = planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0)
    >>> hung = system.add(spring)
    >>> scale = da.openmdao_implicit_component(
    ...     system.build(), {"low": "pan.y"}, analysis=da.Equilibrium()
    ... )
    >>> problem = om.Problem(reports=None)
    >>> part = problem.model.add_subsystem("scale", scale)
    >>> ready = problem.setup()
    >>> problem.run_model()
    >>> problem["scale.low"].round(6), problem["scale.coordinates"][1].round(6)  # -m g/k
    (array([-0.2]), np.float64(-0.2))
    >>> problem.compute_totals(of="scale.low", wrt="scale.weight", return_format="array").round(6)
    array([[-0.1]])
    """
    om = optional_package("openmdao.api", "an OpenMDAO component")
    equations = _equations(model, measures, analysis, time)
    names = input_names(model, vary)
    origin = model.values(start)
    inputs, outputs = openmdao_names(names), openmdao_names(list(equations.measured))
    states = [variable.name for variable in equations.variables]
    if repeated := {n for n in (*inputs, *states) if (*inputs, *states, *outputs).count(n) > 1}:
        raise AnalysisError(
            f"inputs and outputs need distinct names: {', '.join(sorted(repeated))}; give "
            "measures={name: …}, or rename the parameter"
        )
    columns = [list(model.parameters).index(name) for name in names]
    ends = np.cumsum([variable.size for variable in equations.variables])[:-1]

    class Component(om.ImplicitComponent):  # type: ignore[name-defined, misc]
        """States of a model for OpenMDAO."""

        def setup(self) -> None:
            x = equations.solve(origin)
            measure_values = _by_label(equations.measures(x, origin))
            for name, column in zip(inputs, columns, strict=True):
                self.add_input(name, float(origin[column]))
                step = STEP * (abs(float(origin[column])) or 1.0)
                self.set_check_partial_options(wrt=name, step=step, form="central")
            for variable, part, scales in zip(
                equations.variables,
                np.split(x, ends),
                np.split(equations.scales, ends),
                strict=True,
            ):
                description = ", ".join(variable.members[:8]) + (
                    ", …" if len(variable.members) > 8 else ""
                )
                self.add_output(variable.name, part.reshape(variable.shape), desc=description)
                step = STEP * float(scales.min())
                self.set_check_partial_options(wrt=variable.name, step=step, form="central")
            for output, value in zip(outputs, measure_values, strict=True):
                self.add_output(output, value)

        def solve_nonlinear(self, inputs_: Any, outputs_: Any) -> None:
            p = self._parameters(inputs_)
            try:
                x = equations.solve(p, self._state(outputs_))
            except (AnalysisError, ModelError) as error:
                raise om.AnalysisError(str(error)) from None
            self._write(outputs_, x, equations.measures(x, p))

        def apply_nonlinear(self, inputs_: Any, outputs_: Any, residuals: Any) -> None:
            p, x = self._parameters(inputs_), self._state(outputs_)
            measure_values = equations.measures(x, p)
            output_values = np.concatenate(
                [np.zeros(0), *(np.ravel(outputs_[name]) for name in outputs)]
            )
            self._write(
                residuals,
                equations.residual(x, p) / equations.sizes,
                output_values - measure_values,
            )

        def linearize(self, inputs_: Any, outputs_: Any, partials: Any) -> None:
            self._linearize_at(self._parameters(inputs_), self._state(outputs_))

        def _linearize_at(self, p: np.ndarray, x: np.ndarray) -> None:
            """Compute the derivatives at a state, unless it is unchanged."""
            key = p.tobytes(), x.tobytes()
            if key != getattr(self, "point_key", None):
                try:
                    self.tangent: StateTangent = equations.tangent(x, p)
                except AnalysisError as error:
                    raise om.AnalysisError(str(error)) from None
                self.point_key, self.p_jacobian = key, model.tangents(p, columns)

        def apply_linear(
            self, inputs_: Any, outputs_: Any, d_inputs: Any, d_outputs: Any, d_res: Any, mode: str
        ) -> None:
            self._linearize_at(self._parameters(inputs_), self._state(outputs_))
            p_change = np.array([_scalar(d_inputs, name) for name in inputs])
            if mode == "fwd":
                x, measure_part = self._state(d_outputs), self._measure_part(d_outputs)
                change = self.tangent.push(x, self.p_jacobian @ p_change)
                self._write(
                    d_res, change.state / equations.sizes, measure_part - change.other, add=True
                )
                return
            weights, measure_part = self._state(d_res) / equations.sizes, self._measure_part(d_res)
            pulled = self.tangent.pull(weights, -measure_part)
            self._write(d_outputs, pulled.state, measure_part, add=True)
            for name, slope in zip(inputs, self.p_jacobian.T @ pulled.other, strict=True):
                if name in d_inputs:
                    d_inputs[name] += slope

        def solve_linear(self, d_outputs: Any, d_residuals: Any, mode: str) -> None:
            no_change = np.zeros(origin.size)
            if mode == "fwd":
                residual, measure_part = self._state(d_residuals), self._measure_part(d_residuals)
                x = self._solve(equations.sizes * residual, "N")
                self._write(d_outputs, x, measure_part + self.tangent.push(x, no_change).other)
                return
            weights, measure_part = self._state(d_outputs), self._measure_part(d_outputs)
            pulled = self.tangent.pull(np.zeros_like(weights), measure_part).state
            self._write(
                d_residuals, equations.sizes * self._solve(weights + pulled, "T"), measure_part
            )

        def _solve(self, rhs: np.ndarray, trans: str) -> np.ndarray:
            try:
                return self.tangent.solve(rhs, trans)
            except AnalysisError as error:
                raise om.AnalysisError(str(error)) from None

        def _parameters(self, vector: Any) -> np.ndarray:
            """(np,) parameter values of the model, checked when they change."""
            input_values = [_scalar(vector, name) for name in inputs]
            if input_values != getattr(self, "input_values", None):
                try:
                    changed = dict(zip(names, input_values, strict=True))
                    self.p = model.values({**(start or {}), **changed})
                except ModelError as error:
                    raise om.AnalysisError(str(error)) from None
                self.input_values = input_values
            return self.p

        def _state(self, vector: Any) -> np.ndarray:
            """(n,) state part of a vector; zero where a name is missing."""
            parts = [
                np.ravel(vector[variable.name])
                if variable.name in vector
                else np.zeros(variable.size)
                for variable in equations.variables
            ]
            return np.concatenate(parts)

        def _measure_part(self, vector: Any) -> np.ndarray:
            zeros = np.zeros(equations.samples)
            parts = [np.ravel(vector[name]) if name in vector else zeros for name in outputs]
            return np.concatenate([np.zeros(0), *parts])

        def _write(
            self, vector: Any, x: np.ndarray, measure_values: np.ndarray, add: bool = False
        ) -> None:
            """Write, or add, state and measures to a vector."""
            parts = [(variable.name, variable.shape) for variable in equations.variables]
            pairs = zip(parts, np.split(x, ends), strict=True)
            entries = [(name, part.reshape(shape)) for (name, shape), part in pairs]
            for name, value in (*entries, *zip(outputs, _by_label(measure_values), strict=True)):
                if name in vector:
                    vector[name] = vector[name] + value if add else value

    def _by_label(measure_values: np.ndarray) -> np.ndarray:
        return measure_values.reshape(len(outputs), equations.samples)

    return Component()


def _scalar(vector: Any, name: str) -> float:
    return float(np.ravel(vector[name])[0]) if name in vector else 0.0


def _equations(
    model: Any, measures: Measures, analysis: Analysis | None, time: float
) -> StateEquations:
    """State equations of an analysis.

    Raises
    ------
    AnalysisError
        The analysis has none.
    """
    if isinstance(model, Model) and (analysis is None or isinstance(analysis, Equilibrium)):
        return MechanismStates(model, analysis, measures, time)
    if isinstance(model, StructuralModel):
        chosen = Statics() if analysis is None else analysis
        if isinstance(chosen, (Statics, Equilibrium)):
            return StructureStates(model, chosen, measures)
    raise AnalysisError(
        f"{analysis!r:.60} has no state equations: mechanisms take Equilibrium() or none, for "
        "the assembled position, structures Statics() or Equilibrium(); use "
        "openmdao_component for other analyses"
    )
