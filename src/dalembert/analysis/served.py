"""Which analyses serve mechanisms, and which structures.

Small problems of few different elements and large ones of many alike are evaluated in different
ways, so that each has analyses of its own; those with one meaning have one name for both.
"""

from __future__ import annotations

from typing import Any

from dalembert.errors import AnalysisError
from dalembert.model.model import Model
from dalembert.structures.model import StructuralModel


def need_model(model: Any, verb: str) -> None:
    """Refuse what is no model.

    Raises
    ------
    AnalysisError
        It is no model at all.
    """
    if not isinstance(model, (Model, StructuralModel)):
        cure = "; build() it first" if hasattr(model, "build") else ""
        raise AnalysisError(f"{verb} takes a model; got {model!r}{cure}")


def need_mechanism(model: Any, verb: str, instead: str) -> None:
    """Refuse structures.

    Raises
    ------
    AnalysisError
        Something else was given.
    """
    need_model(model, verb)
    if isinstance(model, StructuralModel):
        raise AnalysisError(f"{verb} is of mechanisms, {model.name!r} is a structure; {instead}")


def need_structure(model: Any, verb: str, instead: str) -> None:
    """Refuse mechanisms.

    Raises
    ------
    AnalysisError
        Something else was given.
    """
    need_model(model, verb)
    if isinstance(model, Model):
        raise AnalysisError(f"{verb} is of structures, {model.name!r} is a mechanism; {instead}")
