"""Modes of buckling: load factors and shapes."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from dalembert.results.structural.eigenmodes import EIGENVALUE, EigenModes
from dalembert.symbolic.formulas.expression import Expression


class BucklingModes(EigenModes):
    """Modes of ``(K + λ K_g) φ = 0`` by the size of the load factor ``λ``.

    They are found as ``−K_g φ = μ K φ``, scaled to ``φᵀ K φ = 1 J``: ``eigenvalues`` are
    ``μ = 1/λ``.
    """

    named: ClassVar[dict[str, Expression]] = {
        "load_factor": Expression(1 / EIGENVALUE, "load_factor", ""),
    }
    main = "load_factor"

    @property
    def load_factors(self) -> np.ndarray:
        """(k,) ``λ``."""
        return self.values("load_factor")
