"""``export_fmu``: a model as a functional mock-up unit."""

from __future__ import annotations

import hashlib
import math
import re
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dalembert import __version__
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.dynamics.step_length_checks import unstable_step_warnings
from dalembert.errors import UnsupportedError
from dalembert.files import atomic_path
from dalembert.fmu.archive import archive_of
from dalembert.fmu.c_source import c_source
from dalembert.fmu.compiler import check_platforms
from dalembert.fmu.model_description import Description
from dalembert.fmu.unit_functions import EXCHANGE, STEPS, UnitFunctions
from dalembert.fmu.variables import Variables, variables_of
from dalembert.model.graph.model import Model
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import counted, unknown

KINDS: Mapping[str, tuple[str, ...]] = {
    "cosimulation": (STEPS,),
    "model_exchange": (EXCHANGE,),
    "both": (EXCHANGE, STEPS),
}
"""Name of the interface type → functions that it needs."""
VERSIONS = (2, 3)
LONGEST_IDENTIFIER = 64
"""Upper limit of the length of names of libraries, which are names of files."""
STEPS_OF_A_RUN = 1000
"""Number of steps of the duration without a step."""


@dataclass(frozen=True, repr=False)
class FMU:
    """An exported functional mock-up unit; created by ``export_fmu``.

    Attributes
    ----------
    path : of its archive
    name : of the model
    fmi : version of the standard
    kind : interface type
    variables : Variables with their value references
    platforms : of its libraries
    warnings : about steps of co-simulation that are unstable at the start

    Examples
    --------
    >>> import tempfile
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("stone", gravity=(0, -10))
    >>> height = system.parameter("height", 2.0, "m")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, position=(0, height)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     unit = da.export_fmu(system.build(), f"{folder}/stone.fmu", kind="model_exchange")
    >>> isinstance(unit, da.FMU), unit.parameters, unit.outputs
    (True, ('height',), ('stone.x', 'stone.y'))
    >>> unit.states
    ('state.stone.x', 'state.stone.y', 'rate of stone.x', 'rate of stone.y')
    """

    path: Path
    name: str
    fmi: int
    kind: str
    variables: Variables
    platforms: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters that are not inputs."""
        return tuple(v.name for v in self.variables.parameters if v.causality == "parameter")

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(v.name for v in self.variables.parameters if v.causality == "input")

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(v.name for v in self.variables.outputs)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states of model exchange."""
        return tuple(v.name for v in self.variables.states)

    def __repr__(self) -> str:
        counts = [counted(len(self.inputs), "input"), counted(len(self.outputs), "output")]
        types = {"both": "model exchange and co-simulation", "cosimulation": "co-simulation"}
        text = types.get(self.kind, "model exchange")
        return f"<FMU {self.path.name}: FMI {self.fmi}.0, {text}, {', '.join(counts)}>"


@check_arguments
def export_fmu(
    model: Model,
    path: str | Path,
    analysis: Dynamics | None = None,
    *,
    kind: str = "cosimulation",
    fmi: int = 3,
    step: float | None = None,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str | Expression] | None = None,
    states: Iterable[str] | None = None,
    platforms: Iterable[str] = ("native",),
) -> FMU:
    """Write a model as a functional mock-up unit (FMU) for other simulation programs.

    The unit contains the model as C, compiled, with exact directional and adjoint derivatives.
    Co-simulation takes the steps of ``solve_dynamics``; in model exchange the importer integrates
    independent coordinates, and closed loops are solved inside.

    Parameters
    ----------
    model : Model
    path : of the file, ``.fmu``
    analysis : its steps, strategies and duration; by default RK4 for one second
    kind : ``"cosimulation"``, ``"model_exchange"`` or ``"both"``
    fmi : version of the standard, 3 or 2; 2 has no adjoint derivatives
    step : longest internal step of co-simulation [s]; by default that of the analysis, or a
        thousandth of the duration
    inputs : names of inputs; by default those of the model. Any parameter can be one that is not in
        the equations of joints
    outputs : names or formulas of measures; by default those of the model, or the coordinates of
        all bodies
    states : names of the independent coordinates of model exchange, such as the angle of a crank
        that turns fully; chosen automatically by default
    platforms : ``"native"``, or e.g. ``"x86_64-windows"``, which needs the package ziglang

    Raises
    ------
    UnsupportedError
        The model cannot run outside of Python, with the reason; no compiler.
    SingularityError
        The start is a singular position.

    Examples
    --------
    >>> import tempfile
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> torque = system.input("torque", unit="N m")
    >>> motor = system.add(planar.Torque("motor", bar, torque))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = f"{folder}/pendulum.fmu"
    ...     da.export_fmu(system.build(), path, step=0.01, outputs=["bar.angle"])
    <FMU pendulum.fmu: FMI 3.0, co-simulation, 1 input, 1 output>
    """
    if kind not in KINDS:
        raise UnsupportedError(unknown("kind", kind, KINDS))
    if fmi not in VERSIONS:
        raise UnsupportedError(f"fmi={fmi}: versions 3 and 2 are supported")
    if not isinstance(model, Model):
        text = f"{model.name!r} cannot be exported: it is a structure; only mechanisms are"
        if isinstance(model, System):
            text = f"export_fmu takes a model; got {model!r}; build() it first"
        raise UnsupportedError(text)
    targets = check_platforms(_listed(platforms), fmi)
    run = _with_step(analysis, step)
    named = _named_outputs(model, None if outputs is None else _listed(outputs))
    chosen = None if states is None else _listed(states)
    functions = UnitFunctions(model, run, named, KINDS[kind], chosen)
    motion = functions.motion
    variables = variables_of(
        model,
        list(model.inputs) if inputs is None else _listed(inputs),
        named,
        motion.names if motion else [],
        motion.e.switches.count if motion else 0,
    )
    description = Description(
        model.name,
        model.description,
        _identifier(model.name),
        "",
        f"dalembert {__version__}",
        KINDS[kind],
        variables,
        functions.dependencies,
        functions.state_sizes,
        _begin(run),
        _duration(run),
        float(run.step or 0.0),
    )
    whole = description.text(fmi) + c_source(functions, variables, "", __version__)
    token = str(uuid.UUID(hashlib.sha256(whole.encode()).hexdigest()[:32]))
    text = c_source(functions, variables, token, __version__)
    content = archive_of(replace(description, token=token), text, fmi, targets)
    with atomic_path(path) as temporary:
        temporary.write_bytes(content)
    warnings = _unstable_steps(model, run) if STEPS in KINDS[kind] else ()
    return FMU(Path(path), model.name, fmi, kind, variables, tuple(targets), warnings)


def _unstable_steps(model: Model, run: Dynamics) -> tuple[str, ...]:
    """Warnings about an explicit step that is too long for a spring or contact of the model."""
    p, begin = model.values(None), _begin(run)
    state, step = model.assemble(p, begin), float(run.step or 0.0)
    return tuple(unstable_step_warnings(model, state, p, run.integrator, step, _duration(run)))


def _identifier(name: str) -> str:
    """Name of a model as an identifier of C."""
    text = re.sub(r"\W", "_", name, flags=re.ASCII)[:LONGEST_IDENTIFIER] or "model"
    return text if text[0].isalpha() else f"m_{text}"


def _with_step(analysis: Dynamics | None, step: float | None) -> Dynamics:
    """The analysis with a step of fixed length."""
    if step is not None and not (math.isfinite(step) and step > 0.0):
        raise UnsupportedError(f"step={step:g}: the longest internal step is a positive number")
    if analysis is None:
        return Dynamics(duration=1.0, step=step or 1.0 / STEPS_OF_A_RUN)
    if step is None and analysis.step is None:
        step = _duration(analysis) / STEPS_OF_A_RUN
    return analysis if step is None else replace(analysis, step=step)


def _listed(names: Iterable[Any]) -> list[Any]:
    """Names as a list; a text is one name."""
    return [names] if isinstance(names, str) else list(names)


def _begin(analysis: Any) -> float:
    return float((analysis.t_span or (0.0,))[0])


def _duration(analysis: Any) -> float:
    begin, end = analysis.t_span or (0.0, analysis.duration)
    return float(end) - float(begin)


def _named_outputs(
    model: Model, chosen: Iterable[str | Expression] | None
) -> dict[str, Expression]:
    """Name → scalar expression of each output."""
    if chosen is None and model.outputs:
        return _scalars(model.outputs)
    if chosen is None:
        measures = set(model.measure_names)
        return {n: model.expression(n) for n in model.guesses.names if n in measures}
    named = {}
    for measure in chosen:
        expression = model.expression(measure)
        name = measure if isinstance(measure, str) else expression.name
        if not name:
            raise UnsupportedError("an output has no name; give the formula as a text")
        named[name] = expression
    return _scalars(named)


def _scalars(outputs: Mapping[str, Expression]) -> dict[str, Expression]:
    """Outputs with one variable for each component."""
    scalars = {}
    for name, expression in outputs.items():
        count = len(expression)
        for k in range(count):
            label = name if count == 1 else f"{name}.{'xyz'[k]}" if count <= 3 else f"{name}[{k}]"
            part = (
                expression if count == 1 else Expression(expression.sx[k], label, expression.unit)
            )
            scalars[label] = part
    return scalars
