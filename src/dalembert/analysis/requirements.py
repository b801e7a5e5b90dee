"""Requirements of analyses on their model and their options."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model

LISTED = 6
"""Upper limit of the states that are named."""


def need_model(model: Any, verb: str) -> None:
    """Raise unless the argument is a model.

    Raises
    ------
    AnalysisError
        Another type.
    """
    if not isinstance(model, (Model, StructuralModel)):
        cure = "; build() it first" if hasattr(model, "build") else ""
        raise AnalysisError(f"{verb} takes a model; got {model!r}{cure}")


def need_mechanism(model: Any, verb: str, instead: str) -> None:
    """Raise unless the model is a mechanism.

    Raises
    ------
    AnalysisError
        Another type, or a structure.
    """
    need_model(model, verb)
    if isinstance(model, StructuralModel):
        raise AnalysisError(f"{verb} is for mechanisms, {model.name!r} is a structure; {instead}")


def constant_states(model: Model) -> list[str]:
    """Warning about states of first order that an analysis leaves at their initial values."""
    if not model.equations.states:
        return []
    return [
        f"{listed_states(model, model.equations.states)} keep their values at the start; "
        "solve_dynamics and solve_inverse_dynamics integrate them"
    ]


def refuse_moving_states(model: Model) -> None:
    """Raise if positions follow states of first order, which kinematics does not integrate.

    Raises
    ------
    AnalysisError
        Names a constraint and its states.
    """
    e = model.all_equations
    if not e.states:
        return
    rows = ca.jacobian_sparsity(ca.densify(e.constraints), e.y)
    for row, column in zip(rows.row(), rows.get_col(), strict=True):
        if column in e.states:
            name = model.closure.owners[row][0].name
            raise AnalysisError(
                f"the position of {name} follows {listed_states(model, [column])}, a state that "
                "kinematics does not integrate; use solve_inverse_dynamics or solve_dynamics"
            )


def listed_states(model: Model, states: Sequence[int]) -> str:
    """Names of states of first order, shortened."""
    names = [model.guesses.names[k] for k in states]
    more = [f"{len(names) - LISTED} more"] if len(names) > LISTED else []
    return ", ".join([*names[:LISTED], *more])


def need_count(strategy: Any) -> None:
    """Raise unless the number of modes is positive.

    Raises
    ------
    UnsupportedError
        The count is zero or less.
    """
    if strategy.count is not None and not strategy.count > 0:
        kind = type(strategy).__name__
        raise UnsupportedError(f"{kind}: count is {strategy.count}; it must be positive")


def need_positive(strategy: Any, names: tuple[str, ...], whole: tuple[str, ...] = ()) -> None:
    """Raise unless options are positive, some of them whole numbers.

    Raises
    ------
    UnsupportedError
        Names the option and its value.
    """
    kind = type(strategy).__name__
    for name in (*names, *whole):
        value = getattr(strategy, name)
        if not value > 0:
            raise UnsupportedError(f"{kind}: {name} must be positive, it is {value}")
        if name in whole and value != int(value):
            raise UnsupportedError(f"{kind}: {name} must be a whole number, it is {value}")
