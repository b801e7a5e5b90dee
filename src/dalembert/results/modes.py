"""Modes of small motions of mechanisms and structures about a state."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.numbered import Numbered


class Modes(Numbered):
    """Modes ``exp(s t)`` of small motions, numbered by increasing magnitude of ``s``.

    Measures: ``frequency`` and ``angular_frequency``, undamped, ``damping_ratio``, and
    ``eigenvalue_real`` and ``eigenvalue_imag``, the parts of ``s``.
    """

    @property
    def frequencies(self) -> np.ndarray:
        """(k,) undamped frequencies [Hz]."""
        return self.values("frequency")

    @property
    def damping_ratios(self) -> np.ndarray:
        """(k,) ``−Re s/|s|``."""
        return self.values("damping_ratio")

    @property
    def stable(self) -> bool:
        """Whether no motion grows."""
        size = np.abs(self.values("angular_frequency")).max(initial=0.0)
        return bool(np.all(self.values("eigenvalue_real") <= 1e-9 * size))

    def summary(self) -> dict[str, Any]:
        """Status with stability, and measures of each mode."""
        stability = "stable" if self.stable else "not stable"
        verdict = f", {stability}" if self.status.success else ""
        return super().summary() | {"status": f"{self.status}{verdict}"}
