"""Frozen branches of formulas with comparisons, ``abs``, ``sign``, ``min`` and ``max``.

A formula with frozen branches evaluates a given *side* of each switch, for any sign of the
switching function: it is smooth, also slightly beyond the switch. A step across the switch can
therefore be computed, the switch located within it, and the step shortened. Powers and roots of
numbers that become negative only beyond a switch, as in ``where(x > 0, x**1.5, 0)``, are continued
as odd functions.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

COMPARISONS = (ca.OP_LT, ca.OP_LE)
SIGNED = (ca.OP_FABS, ca.OP_SIGN)
CHOOSING = (ca.OP_FMIN, ca.OP_FMAX)
POWERS = (ca.OP_POW, ca.OP_CONSTPOW, ca.OP_SQRT)


def _empty() -> ca.SX:
    return ca.SX(0, 1)


@dataclass(frozen=True, eq=False)
class Switches:
    """Switches of formulas.

    Attributes
    ----------
    functions : SX (s,), switching functions ``g``
    sides : SX symbols (s,), 1 for the branch of ``g > 0``, 0 for the branch of ``g < 0``
    actual : SX (s,), the sides that follow from the signs of ``g``
    """

    functions: ca.SX = field(default_factory=_empty)
    sides: ca.SX = field(default_factory=_empty)
    actual: ca.SX = field(default_factory=_empty)

    @property
    def count(self) -> int:
        return self.sides.numel()


def freeze_branches(
    expressions: list[ca.SX], moving: ca.SX, extended: bool = True
) -> tuple[list[ca.SX], Switches]:
    """The expressions with frozen branches, and their switches.

    Parameters
    ----------
    moving : symbols that change during a run; a comparison of other symbols is not a switch
    extended : whether powers are continued beyond switches, which makes them depend on all sides
    """
    symbols = ca.vertcat(*ca.symvar(ca.veccat(*expressions, moving)))
    function = ca.Function("held", [symbols], expressions, {"cse": True})
    operations = [function.instruction_id(k) for k in range(function.n_instructions())]
    if not {*COMPARISONS, *SIGNED, *CHOOSING} & {*operations}:
        return expressions, Switches()
    return _Replay(function, moving, extended).run(operations, expressions)


class _Replay:
    """Symbolic replay of the instructions of a function with frozen branches.

    Every value has a label, equal for equal values, so that equal comparisons are one switch.
    """

    def __init__(self, function: ca.Function, moving: ca.SX, extended: bool):
        self.function, (self.symbols,) = function, function.sx_in()
        self.extended = extended
        names = {symbol.element_hash() for symbol in ca.vertsplit(moving)}
        self.moving = [s.element_hash() in names for s in ca.vertsplit(self.symbols)]
        self.functions: list[ca.SX] = []
        self.sides: list[ca.SX] = []
        self.conditions: dict[tuple, ca.SX] = {}
        self.beyond = ca.SX.sym("beyond")

    def run(self, operations: list[int], expressions: list[ca.SX]) -> tuple[list[ca.SX], Switches]:
        function, frozen = self.function, [ca.SX(e) for e in expressions]
        values_at: dict[int, tuple[ca.SX, object, bool]] = {}  # value, label, whether it changes
        for k, operation in enumerate(operations):
            sources, targets = function.instruction_input(k), function.instruction_output(k)
            if operation == ca.OP_OUTPUT:
                frozen[targets[0]].nz[targets[1]] = values_at[sources[0]][0]
            elif operation == ca.OP_INPUT:
                values_at[targets[0]] = self.symbols[sources[1]], k, self.moving[sources[1]]
            elif operation == ca.OP_CALL:
                moves = any(values_at[i][2] for i in sources)
                results = self._call(k, [values_at[i][0] for i in sources])
                for position, i in enumerate(targets):
                    values_at[i] = results[position], (k, position), moves
            elif operation == ca.OP_CONST:
                number = function.instruction_constant(k)
                values_at[targets[0]] = ca.SX(number), ("constant", number), False
            else:
                values, labels, moving = zip(*(values_at[i] for i in sources), strict=True)
                value = self._apply(operation, values, labels, any(moving))
                values_at[targets[0]] = value, k, any(moving)
        if not self.functions:
            return expressions, Switches()
        return self._result(frozen)

    def _call(self, k: int, arguments: list[ca.SX]) -> ca.SX:
        """Stacked results of the function called by an instruction."""
        called = self.function.instructions_sx().nz[k].which_function()
        ends = np.cumsum([0, *(called.nnz_in(i) for i in range(called.n_in()))])
        results = called.call(ca.vertsplit(ca.vertcat(*arguments), ends.tolist()))
        return ca.vertcat(*(ca.vec(result) for result in results))

    def _result(self, frozen: list[ca.SX]) -> tuple[list[ca.SX], Switches]:
        sides, g = ca.vertcat(*self.sides), ca.vertcat(*self.functions)
        plain = ca.substitute(g, self.beyond, 0)  # a switch may have roots itself
        beyond = ca.mmax((sides > 0.5) != (plain > 0))
        *frozen, g = ca.substitute([*frozen, g], [self.beyond], [beyond])
        actual = plain > 0
        for k in range(len(self.sides)):  # a switch may depend on the sides of those before it
            actual = ca.substitute(actual, sides[k], actual[k])
        return frozen, Switches(g, sides, ca.densify(actual))

    def _apply(self, operation: int, values: tuple, labels: tuple, moving: bool) -> ca.SX:
        if not moving:
            return _plain(operation, values)
        if operation in SIGNED:
            (x,), (label,) = values, labels
            side = self._side(ca.SX(0), x, ("constant", 0.0), label)
            return ca.if_else(side, x, -x) if operation == ca.OP_FABS else ca.if_else(side, 1, -1)
        if operation in COMPARISONS:
            return self._side(*values, *labels)
        if operation in CHOOSING:
            a, b = values if operation == ca.OP_FMIN else values[::-1]
            side = self._side(*values, *labels)
            return ca.if_else(side, a, b)
        if operation in POWERS and self.extended:
            return self._extended(operation, values)
        return _plain(operation, values)

    def _side(self, a: ca.SX, b: ca.SX, label_a: object, label_b: object) -> ca.SX:
        """Whether ``a < b``, as a function of the side of their switch."""
        if (label_b, label_a) in self.conditions:
            return ca.logic_not(self.conditions[label_b, label_a])
        if (label_a, label_b) not in self.conditions:
            side = ca.SX.sym(f"side{len(self.sides)}")
            self.conditions[label_a, label_b] = side > 0.5  # a state is 1 to rounding only
            self.sides.append(side)
            self.functions.append(b - a)
        return self.conditions[label_a, label_b]

    def _extended(self, operation: int, values: tuple) -> ca.SX:
        """A power, continued as an odd function if its base is negative beyond a switch only."""
        base, *exponent = values
        if exponent and exponent[0].is_constant() and float(exponent[0]).is_integer():
            return _plain(operation, values)
        # a factor: in a sum of branches, derivatives of an inactive power would be 0·NaN
        sense = 1 - 2 * ca.logic_and(self.beyond, base < 0)
        return sense * _plain(operation, (sense * base, *exponent))


def _plain(operation: int, values: tuple) -> ca.SX:
    if len(values) == 1:
        return ca.SX.unary(operation, values[0])
    return ca.SX.binary(operation, *values)
