"""Why a mechanism cannot be assembled: which joint stays open, and by how much at best."""

from __future__ import annotations

import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.assembly import Assembler
from dalembert.model.description import Description


def failure(
    assembler: Assembler, d: Description, t: float, y: np.ndarray, p: np.ndarray
) -> AssemblyError:
    """The error of the best position found."""
    found = assembler.closeness(t, y, p)
    names = [c.name for c in d.constraints for _ in c.units()]
    names += ["initial condition"] * (found.value.size - len(names))
    relative = np.nan_to_num(np.abs(found.value) / found.scale, nan=np.inf)
    k = int(np.argmax(relative))
    largest = float(abs(found.value[k]))
    return AssemblyError(
        f"the mechanism cannot be assembled at t = {t:g} s: {names[k]} stays open by "
        f"{largest:.3g} at best; check the lengths, or give poses nearer to the closed "
        "mechanism",
        largest,
    )
