"""Names that texts may use, and how one is told from a formula."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.text.wording import listed


@dataclass(frozen=True)
class Names:
    """What a text may name.

    Parameters
    ----------
    find : gives the expression behind a name, or None
    known : gives all names, to suggest from
    """

    find: Callable[[str], Expression | None]
    known: Callable[[], list[str]]

    def named(self, name: str) -> Expression:
        """The expression of this name.

        Raises
        ------
        UnknownNameError
            There is none; tells the nearest ones.
        """
        found = self.find(name)
        if found is None:
            known = self.known()
            own = [each for each in known if each.startswith(f"{name}.")]
            if own:
                raise UnknownNameError(
                    f"{name!r} has several measures; name one of them: {listed(own)}", name
                )
            close = difflib.get_close_matches(name, known, 3, 0.4)
            nearest = ", ".join(close) or "none"
            raise UnknownNameError(f"no measure {name!r}; nearest: {nearest}", name)
        return found

    def expression(self, given: str | Expression) -> Expression:
        """A name, a formula of names, or an expression as it is.

        A text is a name if something has it, and otherwise a formula.

        Raises
        ------
        ExpressionError
            Neither, or a formula outside the grammar; ``UnknownNameError`` where nothing has a
            name that is used.
        """
        if isinstance(given, Expression):
            return given
        if not isinstance(given, str):
            several = isinstance(given, (list, tuple))
            cure = "; give several one after the other, each by itself" if several else ""
            raise ExpressionError(
                f"a measure is a name, a formula or an expression, got {given!r}{cure}"
            )
        text = given.strip()
        found = self.find(text)
        if found is not None:
            return found
        try:
            made = parse_formula(text, self.find, self.known)
            return made.named(text, made.unit)
        except UnknownNameError as error:
            if error.name != text:
                raise
        return self.named(text)
