"""A mechanism or a structure as an implicit component of OpenMDAO, an extra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.structural.statics import Statics
from dalembert.design.ecosystem.mechanism_states import MechanismStates
from dalembert.design.ecosystem.openmdao_component import openmdao_api, openmdao_names
from dalembert.design.ecosystem.states import Measures, StateEquations, StateTangent, inputs_of
from dalembert.design.ecosystem.structure_states import StructureStates
from dalembert.errors import AnalysisError, ModelError
from dalembert.model.model import Model
from dalembert.results.result import Analysis
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

STEP = 1e-6
"""Of differences by which OpenMDAO checks partials, of natural sizes."""


@spelled
def openmdao_implicit_component(
    model: ParametricModel,
    measures: Measures = (),
    *,
    analysis: Analysis | None = None,
    vary: Sequence[str] | None = None,
    start: Mapping[str, float] | None = None,
    time: float = 0.0,
) -> Any:
    """An ``openmdao.api.ImplicitComponent``: parameters in, the state out, with its residual.

    OpenMDAO may solve the equations of the state together with those of other components, by its
    own solvers or by the ones here: residuals stand in natural sizes, their derivatives are exact
    and never stored as a whole, linear systems are solved with our factors. Outputs are
    ``coordinates`` (and ``multipliers`` in equilibrium) of a mechanism, ``displacements`` (all of
    them, by load cases) of a structure, and each measure. ``pip install dalembert[mdo]``.

    Parameters
    ----------
    model : mechanism or structure
    measures : names or formulas of the state, or label → measure; of a structure each has as many
        numbers as there are load cases
    analysis : ``Equilibrium()`` of a mechanism, the assembled position where it is not given;
        ``Statics()``, which is the default, or ``NonlinearStatics()`` of a structure
    vary : names of the parameters that are inputs; default all
    start : initial values of the inputs; default the nominal ones
    time : instant of an assembled position [s]

    Raises
    ------
    UnsupportedError
        OpenMDAO is not there, or the mechanism rolls.
    AnalysisError
        Another analysis; a measure of what is no part of the state.

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
    om = openmdao_api()
    equations = _equations(model, measures, analysis, time)
    names = inputs_of(model, vary)
    origin = model.values(start)
    inputs, outputs = openmdao_names(names), openmdao_names(list(equations.measured))
    states = [one.name for one in equations.variables]
    if twice := {n for n in (*inputs, *states) if (*inputs, *states, *outputs).count(n) > 1}:
        raise AnalysisError(
            f"inputs and outputs need names of their own: {', '.join(sorted(twice))}; give "
            "measures={name: …}, or rename the parameter"
        )
    columns = [list(model.parameters).index(name) for name in names]
    ends = np.cumsum([one.size for one in equations.variables])[:-1]

    class Component(om.ImplicitComponent):  # type: ignore[name-defined, misc]
        """States of a model for OpenMDAO."""

        def setup(self) -> None:
            x = equations.solve(origin)
            seen = _by_label(equations.measures(x, origin))
            for name, column in zip(inputs, columns, strict=True):
                self.add_input(name, float(origin[column]))
                step = STEP * (abs(float(origin[column])) or 1.0)
                self.set_check_partial_options(wrt=name, step=step, form="central")
            for one, part, reach in zip(
                equations.variables, np.split(x, ends), np.split(equations.reach, ends), strict=True
            ):
                told = ", ".join(one.members[:8]) + (", …" if len(one.members) > 8 else "")
                self.add_output(one.name, part.reshape(one.shape), desc=told)
                step = STEP * float(reach.min())
                self.set_check_partial_options(wrt=one.name, step=step, form="central")
            for output, value in zip(outputs, seen, strict=True):
                self.add_output(output, value)

        def solve_nonlinear(self, inputs_: Any, outputs_: Any) -> None:
            p = self._parameters(inputs_)
            try:
                x = equations.solve(p, self._state(outputs_))
            except (AnalysisError, ModelError) as error:
                raise om.AnalysisError(str(error)) from None
            self._spread(outputs_, x, equations.measures(x, p))

        def apply_nonlinear(self, inputs_: Any, outputs_: Any, residuals: Any) -> None:
            p, x = self._parameters(inputs_), self._state(outputs_)
            seen = equations.measures(x, p)
            left = np.concatenate([np.zeros(0), *(np.ravel(outputs_[name]) for name in outputs)])
            self._spread(residuals, equations.residual(x, p) / equations.sizes, left - seen)

        def linearize(self, inputs_: Any, outputs_: Any, partials: Any) -> None:
            self._at(self._parameters(inputs_), self._state(outputs_))

        def _at(self, p: np.ndarray, x: np.ndarray) -> None:
            """Derivatives at a state, those of before where it has not moved."""
            key = p.tobytes(), x.tobytes()
            if key != getattr(self, "place", None):
                try:
                    self.tangent: StateTangent = equations.tangent(x, p)
                except AnalysisError as error:
                    raise om.AnalysisError(str(error)) from None
                self.place, self.turned = key, model.tangents(p, columns)

        def apply_linear(
            self, inputs_: Any, outputs_: Any, d_inputs: Any, d_outputs: Any, d_res: Any, mode: str
        ) -> None:
            self._at(self._parameters(inputs_), self._state(outputs_))
            given = np.array([_scalar(d_inputs, name) for name in inputs])
            if mode == "fwd":
                x, seen = self._state(d_outputs), self._measured(d_outputs)
                change = self.tangent.push(x, self.turned @ given)
                self._spread(d_res, change.state / equations.sizes, seen - change.other, add=True)
                return
            weights, seen = self._state(d_res) / equations.sizes, self._measured(d_res)
            back = self.tangent.pull(weights, -seen)
            self._spread(d_outputs, back.state, seen, add=True)
            for name, slope in zip(inputs, self.turned.T @ back.other, strict=True):
                if name in d_inputs:
                    d_inputs[name] += slope

        def solve_linear(self, d_outputs: Any, d_residuals: Any, mode: str) -> None:
            still = np.zeros(origin.size)
            if mode == "fwd":
                rest, seen = self._state(d_residuals), self._measured(d_residuals)
                x = self._solved(equations.sizes * rest, "N")
                self._spread(d_outputs, x, seen + self.tangent.push(x, still).other)
                return
            weights, seen = self._state(d_outputs), self._measured(d_outputs)
            back = self.tangent.pull(np.zeros_like(weights), seen).state
            self._spread(d_residuals, equations.sizes * self._solved(weights + back, "T"), seen)

        def _solved(self, rhs: np.ndarray, trans: str) -> np.ndarray:
            try:
                return self.tangent.solve(rhs, trans)
            except AnalysisError as error:
                raise om.AnalysisError(str(error)) from None

        def _parameters(self, given: Any) -> np.ndarray:
            """All of the model, checked where they are new."""
            own = [_scalar(given, name) for name in inputs]
            if own != getattr(self, "given", None):
                try:
                    named = dict(zip(names, own, strict=True))
                    self.p = model.values({**(start or {}), **named})
                except ModelError as error:
                    raise om.AnalysisError(str(error)) from None
                self.given = own
            return self.p

        def _state(self, vector: Any) -> np.ndarray:
            """(n,) of outputs or residuals; zero where they are not asked for."""
            parts = [
                np.ravel(vector[one.name]) if one.name in vector else np.zeros(one.size)
                for one in equations.variables
            ]
            return np.concatenate(parts)

        def _measured(self, vector: Any) -> np.ndarray:
            none = np.zeros(equations.samples)
            parts = [np.ravel(vector[name]) if name in vector else none for name in outputs]
            return np.concatenate([np.zeros(0), *parts])

        def _spread(self, vector: Any, x: np.ndarray, seen: np.ndarray, add: bool = False) -> None:
            """Write, or add, state and measures where they belong."""
            parts = [(one.name, one.shape) for one in equations.variables]
            pairs = zip(parts, np.split(x, ends), strict=True)
            named = [(name, part.reshape(shape)) for (name, shape), part in pairs]
            for name, value in (*named, *zip(outputs, _by_label(seen), strict=True)):
                if name in vector:
                    vector[name] = vector[name] + value if add else value

    def _by_label(seen: np.ndarray) -> np.ndarray:
        return seen.reshape(len(outputs), equations.samples)

    return Component()


def _scalar(vector: Any, name: str) -> float:
    return float(np.ravel(vector[name])[0]) if name in vector else 0.0


def _equations(
    model: Any, measures: Measures, analysis: Analysis | None, time: float
) -> StateEquations:
    """The state that an analysis finds.

    Raises
    ------
    AnalysisError
        It is none of those that have one.
    """
    if isinstance(model, Model) and (analysis is None or isinstance(analysis, Equilibrium)):
        return MechanismStates(model, analysis, measures, time)
    if isinstance(model, StructuralModel):
        chosen = Statics() if analysis is None else analysis
        if isinstance(chosen, (Statics, NonlinearStatics)):
            return StructureStates(model, chosen, measures)
    raise AnalysisError(
        f"{analysis!r:.60} has no state of equations: mechanisms take Equilibrium() or none, for "
        "the assembled position, structures Statics() or NonlinearStatics(); others are explicit, "
        "openmdao_component"
    )
