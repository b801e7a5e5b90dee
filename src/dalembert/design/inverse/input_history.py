"""Unknown histories: cubic splines in time whose values at knots are parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dalembert.elements.laws.table import Table
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.declared import Declared
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True, eq=False)
class InputHistory:
    """A spline in time with unknown values at its knots.

    Attributes
    ----------
    name : name of the history
    knots : (n,) times [s]
    parameters : parameter of each knot
    law : the spline, for drivers; ``law.ends`` holds its end conditions

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> system = da.System("robot axis")
    >>> turn = da.input_history(system, "turn", np.linspace(0, 1, 5), unit="rad")
    >>> isinstance(turn, da.InputHistory), turn.names, len(turn.parameters)
    (True, ['turn_0', 'turn_1', 'turn_2', 'turn_3', 'turn_4'], 5)
    >>> type(turn.law).__name__  # for drivers; turn.value is for forces
    'Table'
    """

    name: str
    knots: np.ndarray
    parameters: tuple[Parameter, ...]
    law: Table

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [p.name for p in self.parameters]

    @property
    def value(self) -> Expression:
        """The history as a formula of time, for forces and moments."""
        return Expression(self.law.value(t.sx), self.name)

    def at(self, values: np.ndarray, times: ArrayLike) -> np.ndarray:
        """The history at times, for given values at its knots."""
        from scipy.interpolate import CubicSpline

        return np.asarray(CubicSpline(self.knots, values, bc_type=self.law.ends)(times))

    def roughness(self, order: int = 2) -> np.ndarray:
        """(n − order, n) rows with squared norm ``∫ (dᵏf/dtᵏ)² dt``, by divided differences."""
        x, rows = self.knots, np.eye(self.knots.size)
        for k in range(1, order + 1):
            rows = k * np.diff(rows, axis=0) / (x[k:] - x[:-k])[:, None]
        return rows * np.sqrt((x[order:] - x[:-order]) / order)[:, None]


@check_arguments
def input_history(
    system: Declared,
    name: str,
    knots: Sequence[float] | np.ndarray,
    value: float | str = 0.0,
    unit: str = "",
    ends: str = "not-a-knot",
) -> InputHistory:
    """Add an unknown history to a system: parameters ``name_0``, ``name_1`` … at its knots.

    Parameters
    ----------
    system : System or Structure to which the parameters are added
    knots : times, increasing; the spline is C² between them [s]
    value : initial value at all knots, in ``unit``, or a text such as ``"5 kN"``
    unit : of the value; SI units by default
    ends : end conditions of the spline, as in ``Table``

    Raises
    ------
    ModelError
        Fewer than four knots, or knots not increasing.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pushed mass")
    >>> mass = system.add(planar.Particle("mass", mass=2.0))
    >>> push = da.input_history(system, "push", [0, 0.5, 1.0, 1.5], value=3.0, unit="N")
    >>> force = system.add(planar.Force("push", mass.center, (push.value, 0)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> list(system.parameters), round(motion["mass.vx"][-1].item(), 6)  # F t/m
    (['push_0', 'push_1', 'push_2', 'push_3'], 1.5)
    """
    times = np.asarray(knots, dtype=float)
    if times.ndim != 1 or times.size < 4 or not np.all(np.diff(times) > 0):
        raise ModelError("give at least four knots, increasing in time", name)
    parameters = tuple(system.parameter(f"{name}_{k}", value, unit) for k in range(times.size))
    return InputHistory(name, times, parameters, Table(times.tolist(), list(parameters), ends=ends))
