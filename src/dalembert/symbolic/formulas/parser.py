"""Parser of formulas in text, and resolution of their names.

The grammar is that of :mod:`dalembert.units.grammar`, with the functions of
:mod:`dalembert.symbolic.formulas.functions`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.expression import Dimensioned, Expression
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS
from dalembert.symbolic.formulas.interpolation import Interpolation, interp
from dalembert.text.wording import listed, suggestions
from dalembert.units.amounts import Amount
from dalembert.units.grammar import Grammar
from dalembert.units.unit import MOST_POWER, si_unit

FUNCTIONS = {**FORMULA_FUNCTIONS, "interp": (interp, 2)}
"""Functions of formulas."""


def parse_formula(
    text: str, lookup: Callable[[str], Expression | None], known: Callable[[], list[str]] = list
) -> Expression:
    """Turn the text of a formula into an expression.

    Parameters
    ----------
    text : str
        The formula; its unit follows from its dimension, if that is known.
    lookup : callable
        Returns the expression of a (dotted) name, or None.
    known : callable, optional
        Returns all names, for suggestions.

    Raises
    ------
    ExpressionError
        With the text, the location and a fix; ``UnknownNameError`` for an unknown name.
    """
    grammar = Grammar(text, lookup, known, FUNCTIONS)
    value = grammar.run()
    if isinstance(value, Amount):
        return Expression(value.value, "", value.si)
    if isinstance(value, Interpolation):
        raise ExpressionError(
            f"in formula {text[:60]!r}: a table is not a number; write interp(x, {value.name})"
        )
    formula = value if isinstance(value, Expression) else Expression(value)
    dimension = grammar.dimension
    if dimension is None or formula.unit or any(abs(n) > MOST_POWER for n in dimension.values()):
        return formula
    if not grammar.amounts:  # such as -body.vx, which may mean a force of 1 N s/m, too
        return Expression(formula.sx, formula.name, si_unit(dimension))
    return Dimensioned(formula.sx, text.strip()[:60], si_unit(dimension))


@dataclass(frozen=True)
class Names:
    """Names that texts may use; a text is a name if one matches, and otherwise a formula.

    Parameters
    ----------
    find : returns the expression of a name, or None
    known : returns all names, for suggestions
    """

    find: Callable[[str], Expression | None]
    known: Callable[[], list[str]]

    def named(self, name: str) -> Expression:
        """The expression of this name.

        Raises
        ------
        UnknownNameError
            No such name; the message lists the nearest ones.
        """
        expression = self.find(name)
        if expression is None:
            known = self.known()
            own = [candidate for candidate in known if candidate.startswith(f"{name}.")]
            if own:
                raise UnknownNameError(
                    f"{name!r} has several measures; name one of them: {listed(own)}", name
                )
            raise UnknownNameError(f"no measure {name!r}{suggestions(name, known)}", name)
        return expression

    def expression(self, measure: str | Expression) -> Expression:
        """A name, a formula of names, or an expression, which is returned as is.

        Raises
        ------
        ExpressionError
            Neither, or a formula outside the grammar; ``UnknownNameError`` for an unknown name.
        """
        if isinstance(measure, Expression):
            return measure
        if not isinstance(measure, str):
            several = isinstance(measure, (list, tuple))
            cure = "; give several one after the other, each by itself" if several else ""
            raise ExpressionError(
                f"a measure is a name, a formula or an expression, got {measure!r}{cure}"
            )
        text = measure.strip()
        expression = self.find(text)
        if expression is not None:
            return expression
        try:
            formula = parse_formula(text, self.find, self.known)
            return formula.named(text, formula.unit)
        except UnknownNameError as error:
            if error.name != text:
                raise
        return self.named(text)
