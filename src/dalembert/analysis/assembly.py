"""Assembly as an analysis: where the mechanism stands and how far its guesses were moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dalembert.model.model import Model


@dataclass(frozen=True, eq=False)
class Assembly:
    """Assembled state at one time.

    Attributes
    ----------
    y, v : (n,) coordinates and speeds
    residual : largest violation left
    corrections : coordinate → change made to a given guess
    velocity_corrections : speed → change made to inconsistent initial speeds
    """

    model: Model
    time: float
    y: np.ndarray
    v: np.ndarray
    residual: float
    corrections: dict[str, float]
    velocity_corrections: dict[str, float]

    def pose(self, body: str) -> dict[str, float]:
        """Coordinates of one body by name: x, y, angle."""
        found = {
            name.rpartition(".")[2]: float(value)
            for name, value, owner in zip(
                self.model.guesses.names, self.y, self.model.guesses.pose_owners, strict=True
            )
            if owner == body
        }
        if not found:
            raise KeyError(f"no body {body!r}; known: {', '.join(self.model.diagnosis.bodies)}")
        return found


def solve_assembly(
    model: Model, parameters: Mapping[str, float] | None = None, time: float = 0.0
) -> Assembly:
    """Consistent positions and speeds at one time, ``Φ(y, t) = 0`` and ``C v = −Φ_t``.

    Parameters
    ----------
    model : Model
    parameters : new values of parameters, without rebuilding
    time : [s]

    Raises
    ------
    AssemblyError
        It cannot be assembled; names the worst joint and its residual.
    """
    state = model.assemble(model.values(parameters), time)
    return Assembly(
        model, time, state.y, state.v, state.residual, state.corrections, state.velocity_corrections
    )
