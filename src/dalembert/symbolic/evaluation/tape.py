"""Replay of the instructions of a tangent as sums of multiples of its directions."""

from __future__ import annotations

import casadi as ca

SHORT = 3
"""Upper limit of terms of a sum that is merged into its only user if multiplied by an entry."""


class Factor:
    """``number · entry``, with None for an entry of one; a model has hundreds of thousands."""

    __slots__ = ("entry", "number")

    def __init__(self, number: float = 1.0, entry: ca.SX | None = None):
        self.number, self.entry = number, entry

    def __mul__(self, other: Factor) -> Factor:
        if other is ONE:
            return self
        if self is ONE:
            return other
        if self.entry is None or other.entry is None:
            entry = self.entry if other.entry is None else other.entry
        else:
            entry = self.entry * other.entry
        return Factor(self.number * other.number, entry)

    def __add__(self, other: Factor) -> Factor:
        if self.entry is None and other.entry is None:
            return Factor(self.number + other.number)
        return Factor(1.0, self.expression + other.expression)

    @property
    def expression(self) -> ca.SX:
        return ca.SX(self.number) if self.entry is None else self.number * self.entry


ONE, MINUS = Factor(), Factor(-1.0)


class Multiple:
    """A multiple of a sum or direction."""

    __slots__ = ("factor", "source")

    def __init__(self, source: int, factor: Factor = ONE):
        self.source, self.factor = source, factor

    def scaled(self, factor: Factor) -> Multiple:
        return Multiple(self.source, self.factor * factor)


Terms = dict[int, Factor]


class Tape:
    """A function that is linear in its last inputs, as sums of their multiples.

    Parameters
    ----------
    function : SX function of ``fixed`` inputs and then of directions

    Attributes
    ----------
    point : symbols of the fixed inputs
    sums : an empty entry per direction, then the terms of every sum, the outputs last; terms refer
        to earlier entries
    input_count, output_count : stacked lengths of directions and outputs
    """

    def __init__(self, function: ca.Function, fixed: int):
        inputs = function.sx_in()
        self.point, directions = inputs[:fixed], ca.vertcat(*inputs[fixed:])
        outputs, symbols, self._entries = ca.extract_parametric(
            ca.vertcat(*function.call(inputs)), self.point, {"extract_trivial": True}
        )
        self.function = ca.Function("tape", [directions, ca.vertcat(*symbols)], [outputs])
        self.input_count, self.output_count = directions.numel(), outputs.numel()
        self._instructions = _instructions(self.function)
        self._users = self._count_users()
        self.sums = self._renumbered(*self._replay())

    def _count_users(self) -> list[int]:
        """Number of sums and outputs that use each direction or sum, in order of appearance."""
        users, source_at = [0] * self.input_count, dict[int, int | None]()
        for operation, inputs, targets in self._instructions:
            if operation == ca.OP_INPUT:
                source_at[targets[0]] = inputs[1] if inputs[0] == 0 else None
            elif operation == ca.OP_CONST:
                source_at[targets[0]] = None
            else:
                sources = [s for s in (source_at[i] for i in inputs) if s is not None]
                if operation == ca.OP_OUTPUT or operation in (ca.OP_ADD, ca.OP_SUB):
                    for source in sources:
                        users[source] += 1
                if operation == ca.OP_OUTPUT:
                    continue
                source_at[targets[0]] = sources[0] if sources else None
                if sources and operation in (ca.OP_ADD, ca.OP_SUB):
                    source_at[targets[0]] = len(users)
                    users.append(0)
        return users

    def _replay(self) -> tuple[list[Terms | None], list[Terms]]:
        """Terms of directions and sums, None for merged sums; terms of the outputs."""
        sums: list[Terms | None] = [{} for _ in range(self.input_count)]
        outputs: list[Terms] = [{} for _ in range(self.output_count)]
        values_at: dict[int, Factor | Multiple] = {}
        for k, (operation, inputs, targets) in enumerate(self._instructions):
            if operation == ca.OP_INPUT:
                i, j = inputs
                values_at[targets[0]] = Multiple(j) if i == 0 else Factor(1.0, self._entries[j])
            elif operation == ca.OP_CONST:
                values_at[targets[0]] = Factor(self.function.instruction_constant(k))
            elif operation == ca.OP_OUTPUT:
                value = values_at[inputs[0]]
                if isinstance(value, Multiple):
                    self._include(outputs[targets[1]], value, sums)
            else:
                values = [values_at[i] for i in inputs]
                if operation in (ca.OP_ADD, ca.OP_SUB):
                    values_at[targets[0]] = self._sum(operation, values, sums)
                else:
                    values_at[targets[0]] = _scaled(operation, values)
        return sums, outputs

    def _sum(self, operation: int, values: list, sums: list[Terms | None]) -> Multiple:
        terms: Terms = {}
        first, second = values
        if isinstance(first, Multiple):
            self._include(terms, first, sums)
        if isinstance(second, Multiple):
            negative = operation == ca.OP_SUB
            self._include(terms, second.scaled(MINUS) if negative else second, sums)
        sums.append(terms)
        return Multiple(len(sums) - 1)

    def _include(self, terms: Terms, value: Multiple, sums: list[Terms | None]) -> None:
        """Add a multiple to terms; a sum without other users is merged by its own terms."""
        inner = sums[value.source] if value.source >= self.input_count else None
        cheap = value.factor.entry is None or (inner is not None and len(inner) <= SHORT)
        if inner is not None and self._users[value.source] == 1 and cheap:
            sums[value.source] = None
            parts = {source: factor * value.factor for source, factor in inner.items()}
        else:
            parts = {value.source: value.factor}
        if not terms:
            terms.update(parts)
            return
        for source, factor in parts.items():
            terms[source] = terms[source] + factor if source in terms else factor

    def _renumbered(self, sums: list[Terms | None], outputs: list[Terms]) -> list[Terms]:
        """Remaining sums and then the outputs, with terms that refer to the new positions."""
        position: dict[int, int] = {}
        remaining: list[Terms] = []
        for k, terms in enumerate(sums):
            if terms is not None:
                position[k] = len(remaining)
                remaining.append(terms)
        return [
            {position[k]: factor for k, factor in terms.items()} for terms in [*remaining, *outputs]
        ]


def _instructions(function: ca.Function) -> list[tuple[int, tuple[int, ...], tuple[int, ...]]]:
    """Operation, locations of its inputs and locations of its outputs.

    Tuples, unlike lists, are not visited by every round of the garbage collector.
    """
    count = range(function.n_instructions())
    operation, inputs, outputs = (
        function.instruction_id,
        function.instruction_input,
        function.instruction_output,
    )
    return [(operation(k), tuple(inputs(k)), tuple(outputs(k))) for k in count]


def _scaled(operation: int, values: list) -> Multiple:
    """Result of an operation other than a sum on one multiple."""
    if operation == ca.OP_MUL:
        value, factor = values if isinstance(values[0], Multiple) else values[::-1]
        return value.scaled(factor)
    if operation == ca.OP_DIV:
        return values[0].scaled(Factor(1.0, 1 / values[1].expression))
    if operation == ca.OP_NEG:
        return values[0].scaled(MINUS)
    if operation == ca.OP_TWICE:
        return values[0].scaled(Factor(2.0))
    if operation == ca.OP_IF_ELSE_ZERO:
        return values[1].scaled(Factor(1.0, ca.if_else(values[0].expression, 1.0, 0.0)))
    raise NotImplementedError(f"operation {operation} on a direction")
