"""Deflection shapes of a structure at frequencies."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.modes import VibrationModes


class DeflectionShapes(VibrationModes):
    """Displacements at the phase of their largest amplitude, numbered by frequency."""

    kind_of_state = "frequency"

    @property
    def state_names(self) -> list[str]:
        return [f"{f:.5g} Hz" for f in self.frequencies]


def deflection_shapes(response: Any, states: np.ndarray) -> DeflectionShapes:
    """Shapes of a response of a structure to its first input, at some of its frequencies."""
    motions = response.motions[states, :, 0].T
    squares = np.sum(motions**2, axis=0)
    turned = motions * np.exp(-0.5j * np.angle(squares))
    return DeflectionShapes(
        response.model,
        response.analysis,
        response.parameters,
        np.arange(1, states.size + 1),
        response.omega[states] ** 2,
        turned.real,
        response.status,
        states,
        response.record,
        response.statistics,
        response.warnings,
    )
