"""Exceptions. Every message names the entity, the value and a fix."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, Self

from dalembert.remedies import Remedy, remedies_in

LONGEST, BEGIN, END = 2000, 1400, 400
"""Upper limit of the length of a message; characters kept at both ends of a longer one."""


def brief(message: str) -> str:
    """A message shortened to a readable length."""
    if len(message) <= LONGEST:
        return message
    return f"{message[:BEGIN]} … ({len(message)} characters) … {message[-END:]}"


class DalembertError(Exception):
    """Base of all errors raised on purpose.

    Attributes
    ----------
    remedies : tuple
        Changes of the input that the message proposes, for programs that offer them.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("slip")
    >>> body = system.add(planar.Body("plate", mass=-1.0, inertia=1.0))
    >>> try:
    ...     model = system.build()
    ... except da.DalembertError as error:  # any error of dalembert
    ...     print(type(error).__name__)
    ModelError
    """

    remedies: tuple[Remedy, ...] = ()

    def __init__(self, message: str = "", *more: Any):
        self.remedies = self.remedies or remedies_in(message)
        super().__init__(brief(str(message)), *more)


class ModelError(DalembertError):
    """The description of a mechanism is wrong.

    Parameters
    ----------
    message : str
        Description of the problem, and a remedy.
    entity : str, optional
        Element, parameter or field at fault, e.g. ``"crank.mass"``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> try:
    ...     body = planar.Body("plate", mass=1.0)
    ... except da.ModelError as error:
    ...     print(error.entity, "-", error.message.partition(";")[0])
    plate - mass is given but inertia is missing
    """

    def __init__(self, message: str, entity: str | None = None):
        self.entity = entity
        self.remedies = remedies_in(message)
        self.message = message = brief(message)
        super().__init__(f"{entity}: {message}" if entity else message)


class ExpressionError(ModelError):
    """A formula is not in the allowed grammar or names something unknown.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> try:
    ...     length = planar.Bar("bar", length="2 kg")
    ... except da.ExpressionError as error:
    ...     print(error)
    bar.length: 2 kg does not fit, expected m; write it with a unit of that kind, such as 'mm'
    """


class KeywordError(ModelError, TypeError):
    """Unknown keyword or missing argument; names the nearest keyword, or all required ones."""


class UnknownNameError(ExpressionError, KeyError):
    """Unknown name; lists the nearest known names.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw")
    >>> stone = system.add(planar.Particle("stone", mass=1.0))
    >>> model = system.build()
    >>> try:
    ...     measure = model["stone.positon"]
    ... except da.UnknownNameError as error:
    ...     print(error)
    no measure 'stone.positon'; nearest: stone.position, stone.velocity, stone.y
    """

    def __init__(self, message: str, name: str):
        self.name = name
        super().__init__(message)

    def __str__(self) -> str:  # KeyError would quote the message
        return str(self.args[0])


class FileError(DalembertError):
    """A model file cannot be read or a result cannot be written.

    Examples
    --------
    >>> import dalembert as da
    >>> try:
    ...     system = da.load_model("nowhere.toml")
    ... except da.FileError as error:
    ...     print(error)
    nowhere.toml: no such file; check the name and the folder
    """


class AnalysisError(DalembertError):
    """A numerical task failed; ``residual`` is the evidence.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("free")
    >>> stone = system.add(planar.Particle("stone", mass=1.0))
    >>> try:
    ...     motion = da.solve_kinematics(system.build(), 1.0)
    ... except da.AnalysisError as error:
    ...     print(error)
    the drivers leave 2 degrees of freedom undetermined; add 2 driver(s), or use solve_dynamics
    """

    def __init__(self, message: str, residual: float | None = None):
        self.residual = residual
        super().__init__(message)

    def with_message(self, message: str) -> Self:
        """A copy of the error with another message."""
        error = copy(self)
        error.args = (message,)
        return error


class AssemblyError(AnalysisError):
    """The mechanism cannot be assembled from the given guesses and lengths.

    ``position`` is the best position reached, for ``assembly_report``, or None. ``others`` is the
    number of other assembly configurations that exist at these parameter values when the branch of
    the nominal assembly ends before them; 0 if a search detects none.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("too short")
    >>> bar = system.add(planar.Bar("bar", length=1.0))
    >>> a = system.add(planar.Revolute("A", system.ground.center, bar.start))
    >>> b = system.add(planar.Revolute("B", system.ground.point(2, 0), bar.end))
    >>> try:
    ...     model = system.build()
    ... except da.AssemblyError as error:
    ...     print(round(error.residual, 3), error.position is not None)
    1.0 True
    """

    def __init__(
        self,
        message: str,
        residual: float | None = None,
        position: Any = None,
        others: int = 0,
    ):
        self.position, self.others = position, others
        super().__init__(message, residual)


class SolverFailure(AnalysisError):
    """A solver inside a compiled function failed; ``reason`` is the solver's own message."""

    def __init__(self, reason: str):
        self.reason = reason
        super().__init__(
            f"a solver inside a step failed: {reason}; use shorter steps or another integrator"
        )


class StepFailure(SolverFailure):
    """A step of a ``Stepper`` has no valid result; the state before it remains.

    Parameters
    ----------
    time : start of the step [s]
    reason, remedy : parts of the message
    """

    def __init__(self, time: float, reason: str, remedy: str):
        self.time, self.reason = time, reason
        AnalysisError.__init__(self, f"the step from t = {time:.6g} s failed: {reason}; {remedy}")


class UnsolvedPart(SolverFailure):
    """A partial step, taken while locating an event, did not converge.

    Parameters
    ----------
    number : index of the step among those examined
    time : start of the step [s]
    """

    def __init__(self, number: int, time: float):
        self.number = number
        super().__init__(f"no motion up to a contact after t = {time:.9g} s")


class SingularityError(AnalysisError):
    """The equations have no unique solution at this position.

    Parameters
    ----------
    message : str
    nodes : names of the nodes of a structure that move without strain
    motion : (n,) displacements of this motion, of any size; empty if it is not known

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> loose = da.Structure("loose")
    >>> a, b = loose.node("a", 0, 0), loose.node("b", 1, 0)
    >>> bar = loose.add(structures.Truss("bar", a, b, area=1e-4, modulus=1e9))
    >>> loose.support(a)
    >>> loose.load(b, fy=1.0)
    >>> try:
    ...     result = da.solve_statics(loose.build())
    ... except da.SingularityError as error:
    ...     print(str(error).partition(" without")[0])
    ...     print(error.nodes)
    the structure is a mechanism: b can move
    ('b',)
    """

    def __init__(self, message: str, nodes: Sequence[str] = (), motion: Any = ()):
        super().__init__(message)
        self.nodes, self.motion = tuple(nodes), motion


class BudgetError(DalembertError):
    """A task exceeds the limit of memory or work; states the estimated cost.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("falling ball")
    >>> ball = system.add(planar.Particle("ball", mass=1.0))
    >>> try:
    ...     motion = da.solve_dynamics(system.build(), 1.0, step=1e-13)
    ... except da.BudgetError as error:
    ...     print(str(error).partition(", and")[0])
    1e+13 steps of 1e-13 s would take about 480 TB of memory
    """


class UnsupportedError(DalembertError):
    """An unsupported combination of options; names one that works.

    Examples
    --------
    >>> import dalembert as da
    >>> try:
    ...     integrator = da.GeneralizedAlpha(rho_inf=2.0)
    ... except da.UnsupportedError as error:
    ...     print(error)
    GeneralizedAlpha(rho_inf=2.0): the spectral radius at infinite frequency is between 0 and 1
    """
