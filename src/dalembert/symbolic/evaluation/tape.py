"""The instructions of a tangent, replayed: what is done with directions, written as sums."""

from __future__ import annotations

import casadi as ca

SHORT = 3
"""Terms of a sum that is written into its only user even where that multiplies it by an entry."""


class Factor:
    """``number · entry``, an entry of None being one; hundreds of thousands are made of a model."""

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
        return Factor(1.0, self.written + other.written)

    @property
    def written(self) -> ca.SX:
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
    """What a function that is linear in its last inputs does with them.

    Parameters
    ----------
    function : SX function of ``fixed`` inputs and then of directions

    Attributes
    ----------
    point : symbols of the fixed inputs
    sums : per direction nothing, then the terms of every sum, those of the outputs last; a term
        refers to a place further up
    input_count, output_count : stacked lengths of directions and outputs
    """

    def __init__(self, function: ca.Function, fixed: int):
        inputs = function.sx_in()
        self.point, directions = inputs[:fixed], ca.vertcat(*inputs[fixed:])
        given, symbols, self._entries = ca.extract_parametric(
            ca.vertcat(*function.call(inputs)), self.point, {"extract_trivial": True}
        )
        self.function = ca.Function("tape", [directions, ca.vertcat(*symbols)], [given])
        self.input_count, self.output_count = directions.numel(), given.numel()
        self._instructions = _instructions(self.function)
        self._users = self._count_users()
        self.sums = self._ordered(*self._replay())

    def _count_users(self) -> list[int]:
        """How many sums and outputs refer to each direction or sum, in the order they appear."""
        users, at = [0] * self.input_count, dict[int, int | None]()
        for operation, given, made in self._instructions:
            if operation == ca.OP_INPUT:
                at[made[0]] = given[1] if given[0] == 0 else None
            elif operation == ca.OP_CONST:
                at[made[0]] = None
            else:
                sources = [s for s in (at[i] for i in given) if s is not None]
                if operation == ca.OP_OUTPUT or operation in (ca.OP_ADD, ca.OP_SUB):
                    for source in sources:
                        users[source] += 1
                if operation == ca.OP_OUTPUT:
                    continue
                at[made[0]] = sources[0] if sources else None
                if sources and operation in (ca.OP_ADD, ca.OP_SUB):
                    at[made[0]] = len(users)
                    users.append(0)
        return users

    def _replay(self) -> tuple[list[Terms | None], list[Terms]]:
        """Terms of directions and sums, None where they were written into their user; outputs."""
        made_sums: list[Terms | None] = [{} for _ in range(self.input_count)]
        outputs: list[Terms] = [{} for _ in range(self.output_count)]
        at: dict[int, Factor | Multiple] = {}
        for k, (operation, given, made) in enumerate(self._instructions):
            if operation == ca.OP_INPUT:
                i, j = given
                at[made[0]] = Multiple(j) if i == 0 else Factor(1.0, self._entries[j])
            elif operation == ca.OP_CONST:
                at[made[0]] = Factor(self.function.instruction_constant(k))
            elif operation == ca.OP_OUTPUT:
                value = at[given[0]]
                if isinstance(value, Multiple):
                    self._include(outputs[made[1]], value, made_sums)
            else:
                values = [at[i] for i in given]
                if operation in (ca.OP_ADD, ca.OP_SUB):
                    at[made[0]] = self._sum(operation, values, made_sums)
                else:
                    at[made[0]] = _scaled(operation, values)
        return made_sums, outputs

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
        """Add a multiple to terms; a sum that nobody else needs by its own terms."""
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

    def _ordered(self, sums: list[Terms | None], outputs: list[Terms]) -> list[Terms]:
        """Sums that are left, with terms that refer to their new places, then the outputs."""
        place: dict[int, int] = {}
        kept: list[Terms] = []
        for k, terms in enumerate(sums):
            if terms is not None:
                place[k] = len(kept)
                kept.append(terms)
        return [{place[k]: factor for k, factor in terms.items()} for terms in [*kept, *outputs]]


def _instructions(function: ca.Function) -> list[tuple[int, tuple[int, ...], tuple[int, ...]]]:
    """Operation, where it finds what it is given, and where it leaves what it makes.

    As tuples, which unlike lists are not looked at by every round of the garbage collector.
    """
    count = range(function.n_instructions())
    which, given, made = (
        function.instruction_id,
        function.instruction_input,
        function.instruction_output,
    )
    return [(which(k), tuple(given(k)), tuple(made(k))) for k in count]


def _scaled(operation: int, values: list) -> Multiple:
    """What an operation other than a sum does with one multiple."""
    if operation == ca.OP_MUL:
        value, other = values if isinstance(values[0], Multiple) else values[::-1]
        return value.scaled(other)
    if operation == ca.OP_DIV:
        return values[0].scaled(Factor(1.0, 1 / values[1].written))
    if operation == ca.OP_NEG:
        return values[0].scaled(MINUS)
    if operation == ca.OP_TWICE:
        return values[0].scaled(Factor(2.0))
    if operation == ca.OP_IF_ELSE_ZERO:
        return values[1].scaled(Factor(1.0, ca.if_else(values[0].written, 1.0, 0.0)))
    raise NotImplementedError(f"operation {operation} on a direction")
