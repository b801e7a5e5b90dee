"""Gradient methods as strategy objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.checks.finite_difference import FiniteDifference
from dalembert.sensitivity.moving_times import of_moving_times
from dalembert.sensitivity.registry import engine_of


@dataclass(frozen=True)
class Direct:
    """Direct differentiation, whose cost grows with the number of parameters.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 10.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=5.0)
    >>> result = da.solve_statics(spring.build())
    >>> many = [da.final("end.ux"), da.final("end.ux**3")]
    >>> slopes = da.sensitivity(result, many, method=da.Direct())
    >>> slopes.values.ravel().round(6)  # -F/k², -3 F³/k⁴
    array([-0.05  , -0.0375])
    """

    def gradient(
        self, motion: Result, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) derivatives."""
        gradient = engine_of(motion, responses).direct(columns)
        return gradient + of_moving_times(motion, responses, columns)


@dataclass(frozen=True)
class Adjoint:
    """Adjoint method, whose cost grows with the number of responses.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> chain = da.Structure("springs in a row")
    >>> nodes = [chain.node(f"n{k}", k) for k in range(4)]
    >>> for k in range(3):
    ...     stiffness = chain.parameter(f"k{k}", 10.0)
    ...     ends = nodes[k], nodes[k + 1]
    ...     part = chain.add(structures.AxialSpring(f"s{k}", *ends, stiffness=stiffness))
    >>> chain.support(nodes[0])
    >>> chain.load(nodes[3], fx=5.0)
    >>> result = da.solve_statics(chain.build())
    >>> tip = da.final("n3.ux")
    >>> da.sensitivity(result, tip, method=da.Adjoint()).values.round(6)  # -F/k² of each
    array([[-0.05, -0.05, -0.05]])
    """

    def gradient(
        self, motion: Result, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) derivatives."""
        gradient = engine_of(motion, responses).adjoint()[:, list(columns)]
        return gradient + of_moving_times(motion, responses, columns)


@dataclass(frozen=True)
class Automatic:
    """Adjoint method, or the direct method for fewer parameters than responses."""

    def choose(self, responses: int, parameters: int) -> Direct | Adjoint:
        """The cheaper method for these numbers."""
        return Direct() if parameters < responses else Adjoint()


Strategy = Direct | Adjoint | Automatic | FiniteDifference
Method = str | Strategy

METHODS: dict[str, Strategy] = {
    "auto": Automatic(),
    "adjoint": Adjoint(),
    "direct": Direct(),
    "finite-difference": FiniteDifference(),
}
