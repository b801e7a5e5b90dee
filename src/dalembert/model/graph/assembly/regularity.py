"""Checks of a position: over-driving, redundancy, singularity, defined values, ranges of tables."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.coordinates import rate_of
from dalembert.elements.driver import Driver
from dalembert.errors import ModelError
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.assembly import Assembler
from dalembert.model.graph.assembly.guesses import AssembledState
from dalembert.model.graph.assembly.independence import Echelon, columns_of, independent_rows
from dalembert.model.graph.assembly.recipe import INCONSISTENT
from dalembert.model.graph.description import Description
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.formulas.expression import free_symbols, stack, t

Owners = list[tuple[Constraint, int]]
"""Constraint and component of each row."""
NEARBY = (1e-2, 1e-3)
"""Displacements away from a singular position, in natural units."""
CLEARLY_INDEPENDENT = 1e-7
SHARED = 1e-9
"""Threshold for a dependence between equations of unit length."""


def check_over_driving(owners: Owners, rows: list[int]) -> None:
    """Check that every driver is among the independent rows.

    Raises
    ------
    ModelError
        Names a driver that is not.
    """
    independent = set(rows)
    for k, (constraint, _) in enumerate(owners):
        if isinstance(constraint, Driver) and k not in independent:
            raise ModelError(
                "drives a coordinate that the joints and other drivers already determine "
                "(over-driven mechanism); remove this driver or another one",
                constraint.name,
            )


def shared_constraints(owners: Owners, independence: Echelon, row: int) -> tuple[str, ...]:
    """Names of the other constraints whose equations a redundant row depends on."""
    weights, constraint = independence.kernel({row: -1.0}), owners[row][0]
    shared = (owners[k][0] for k in independence.pivots if abs(weights[k]) > SHARED)
    return tuple(dict.fromkeys(c.name for c in shared if c is not constraint))


def check_contradiction(
    e: Equations,
    owners: Owners,
    independence: Echelon,
    rows: list[int],
    start: AssembledState,
    p: np.ndarray,
) -> None:
    """Check that the speeds of redundant rows agree with the rows they depend on.

    Raises
    ------
    ModelError
        Names a contradictory constraint and the constraints it depends on.
    """
    psi = ca.Function("speeds", [e.t, e.y, e.v, e.p], [e.velocity_constraints[rows]])
    open_by = np.abs(psi(0.0, start.y, start.v, p).full().ravel())
    shares = open_by * e.scales.time / e.scales.rows[rows]
    worst = int(np.argmax(shares))
    if shares[worst] <= INCONSISTENT:
        return
    constraint, component = owners[rows[worst]]
    names = ", ".join(shared_constraints(owners, independence, rows[worst]))
    raise ModelError(
        f"prescribes another speed than {names}, which determine the same coordinate "
        f"(by {open_by[worst]:.3g} {constraint.units()[component]}/s at the start): over-driven "
        "mechanism; remove one of them, or make their speeds equal",
        constraint.name,
    )


def generic_rows(
    assembler: Assembler, owners: Owners, rows: list[int], y: np.ndarray, p: np.ndarray
) -> list[int]:
    """Rows that are independent almost everywhere, though some may not be so at a position.

    Distinguishes redundancy from a singular position, which a small motion leaves.

    Parameters
    ----------
    rows : independent at the position
    y, p : position and parameter values
    """
    joints = [k for k, (c, _) in enumerate(owners) if not isinstance(c, Driver)]
    motions = columns_of(assembler.scaled_jacobian(0.0, y, p)[joints])
    rng = np.random.default_rng(1)
    for size in NEARBY if motions.free else ():
        motion = size * assembler.scales.displacements * motions.any_kernel(rng)
        solution = assembler.close(0.0, assembler.displaced(y, motion), p, joints)
        if not solution.accepted:
            continue
        jacobian = assembler.scaled_jacobian(0.0, solution.x, p)[: len(owners)]
        generic = independent_rows(jacobian, CLEARLY_INDEPENDENT)
        if len(generic) > len(rows):
            return generic
    return rows


class Definedness:
    """Check that every element has finite values and directions at a position.

    Parameters
    ----------
    d : Description
    equations : Equations
    y, p : the position and the parameter values
    """

    def __init__(self, d: Description, equations: Equations, y: np.ndarray, p: np.ndarray):
        self.d, self.e, self.y, self.p = d, equations, y, p

    def check(self) -> None:
        """Check all elements.

        Raises
        ------
        ModelError
            Names an element with undefined values.
        """
        if self._is_finite(stack([ca.vec(self.e.jacobian.nz[:]), self.e.force])):
            return
        for element in (*self.d.constraints, *self.d.forces):
            if not self._is_finite(self._definition(element)):
                state = (0.0, self.y, np.zeros(self.e.speed_count))
                if left := left_table(self.d, self.e, [state], self.p):
                    raise ModelError(f"at the start {left}", element.name)
                raise ModelError(
                    "has no defined direction or value at the assembled position (two points that "
                    "coincide, a root or a division by zero?); move its points or correct its "
                    "formula",
                    element.name,
                )

    def _definition(self, element: Element) -> ca.SX:
        """Directions and values of an element."""

        def fixed(expression: ca.SX) -> ca.SX:
            return at_ground(self.d.ground, expression)

        y = self.e.y
        if isinstance(element, Constraint):
            by_pose = ca.vec(ca.jacobian(fixed(element.equations), y))
            return stack([by_pose, ca.vec(ca.jacobian(fixed(element.slip), self.e.v))])
        assert isinstance(element, ForceElement)
        owners = element.parts() or self.d.coordinates
        powers = element.powers(lambda s: rate_of(s, owners, t.sx))
        parts = [ca.vec(ca.jacobian(fixed(velocity), self.e.v)) for velocity, _ in powers]
        return stack(parts + [fixed(effort) for _, effort in powers])

    def _is_finite(self, column: ca.SX) -> bool:
        inputs = [self.e.t, self.e.y, self.e.v, self.e.p]
        if free_symbols(column) - free_symbols(ca.vertcat(*inputs)):
            return True  # depends on accelerations or multipliers, unknown before a run
        at_rest = np.zeros(self.e.speed_count)
        values = ca.Function("defined", inputs, [column])(0.0, self.y, at_rest, self.p)
        return bool(np.all(np.isfinite(values.full())))


AHEAD = 3.0
"""Extrapolation of a motion, in lengths of the last step."""


def left_table(
    d: Description, e: Equations, states: list[tuple[float, np.ndarray, np.ndarray]], p: np.ndarray
) -> str:
    """Message about a table that ends at the last state or just ahead of it; else empty.

    Parameters
    ----------
    d : with its tables
    e : equations of all bodies
    states : (time, coordinates, speeds), one or several; all are finite
    """
    for name, table in d.tables.items():
        for use in table.uses:
            function = ca.Function("use", [e.t, e.y, e.v, e.p], [use], {"allow_free": True})
            if function.has_free():  # a law or curve evaluates it at its own variable
                continue
            values = [float(function(*state, p)) for state in states]
            change = values[-1] - values[-2] if len(values) > 1 else 0.0
            for value in (values[-1], values[-1] + AHEAD * change):
                if table.is_left_at(value):
                    first, last = table.range
                    return (
                        f"the table {name!r} goes from {first:g} to {last:g} and is evaluated at "
                        f"{values[-1]:.6g} and beyond; give it more rows, or outside = "
                        "'extrapolate' or 'clamp'"
                    )
    return ""


def left_ahead(
    d: Description,
    e: Equations,
    now: float,
    state: tuple[np.ndarray, np.ndarray],
    back: float,
    p: np.ndarray,
) -> str:
    """Message about a table that ends where a motion does, extrapolated over the time ``back``."""
    y, v = state
    earlier = (now - back, e.manifold.go(y, -back * v), v)
    left = left_table(d, e, [earlier, (now, y, v)], p)
    return f"after t = {now:.9g} s {left}" if left else ""
