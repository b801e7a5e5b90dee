"""Saved state of a stepper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class StepperState:
    """State of a stepper, by which it continues exactly.

    Attributes
    ----------
    count : number of steps since the reset
    start : time of the reset [s]
    x : (n,) state of the integrator
    parameters : (np,) values, those of the inputs included
    mode : variant of the equations

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sled")
    >>> sled = system.add(planar.Particle("sled", mass=2.0, velocity=(1.0, 0)))
    >>> plant = da.Stepper(system.build(), step=0.1, outputs=["sled.x"])
    >>> state = plant.save()
    >>> first = plant.step()
    >>> plant.restore(state)
    >>> isinstance(state, da.StepperState), plant.time, (plant.step() == first).item()
    (True, 0.0, True)
    """

    count: int
    start: float
    x: np.ndarray
    parameters: np.ndarray
    mode: int
