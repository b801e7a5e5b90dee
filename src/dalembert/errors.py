"""Exceptions: every message names the entity, the value and a cure."""

from __future__ import annotations

from copy import copy
from typing import Any, Self


class DalembertError(Exception):
    """Base of all errors raised on purpose."""


class ModelError(DalembertError):
    """The description of a mechanism is wrong.

    Parameters
    ----------
    message : str
        What is wrong and how to mend it.
    entity : str, optional
        Element, parameter or field at fault, e.g. ``"crank.mass"``.
    """

    def __init__(self, message: str, entity: str | None = None):
        self.entity = entity
        self.message = message
        super().__init__(f"{entity}: {message}" if entity else message)


class ExpressionError(ModelError):
    """A formula is not in the allowed grammar or names something unknown."""


class KeywordError(ModelError, TypeError):
    """Nothing takes this keyword; tells the nearest one."""


class UnknownNameError(ExpressionError, KeyError):
    """Nothing has this name; tells the nearest names that there are."""

    def __init__(self, message: str, name: str):
        self.name = name
        super().__init__(message)

    def __str__(self) -> str:  # a KeyError would show its message in quotes
        return str(self.args[0])


class FileError(DalembertError):
    """A model file cannot be read or a result cannot be written."""


class AnalysisError(DalembertError):
    """A numerical task failed; carries the residual that proves it."""

    def __init__(self, message: str, residual: float | None = None):
        self.residual = residual
        super().__init__(message)

    def retold(self, message: str) -> Self:
        """The same error in other words."""
        made = copy(self)
        made.args = (message,)
        return made


class AssemblyError(AnalysisError):
    """The mechanism cannot be assembled from the given guesses and lengths.

    ``position`` is the best position found, for ``assembly_report``; None where there is none.
    """

    def __init__(self, message: str, residual: float | None = None, position: Any = None):
        self.position = position
        super().__init__(message, residual)


class SolverFailure(AnalysisError):
    """A solver inside a compiled function gave up; ``reason`` is its own word for it."""

    def __init__(self, reason: str):
        self.reason = reason
        super().__init__(
            f"a solver inside a step failed: {reason}; use shorter steps or another integrator"
        )


class SingularityError(AnalysisError):
    """The equations have no unique solution at this position."""


class BudgetError(DalembertError):
    """A number asks for more memory or work than a task is given; tells what it would cost."""


class UnsupportedError(DalembertError):
    """A combination of choices that cannot work; names one that does."""
