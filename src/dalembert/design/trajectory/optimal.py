"""What a search for a trajectory ends with."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.errors import AnalysisError
from dalembert.results.motion import Motion
from dalembert.results.status import Status
from dalembert.text.wording import unknown


@dataclass(eq=False)
class OptimalTrajectory:
    """Result of ``optimize_trajectory``.

    Attributes
    ----------
    status : how the search ended, with the largest residual of its equations
    fun : the objective
    duration : of the motion [s]
    x : what was varied beside the motion, parameter → value
    controls : name → Control, a function of time
    planned : the motion at the knots, as collocation sees it
    motion : the motion under these controls, run forward from where the plan begins; None where
        the search failed
    defect : largest distance from the plan after an interval run forward from its knot, in
        natural sizes (lengths of the mechanism, radians): how fine the intervals are
    deviation : largest distance of ``planned`` and ``motion`` at a knot, likewise; large where the
        mechanism is unstable and needs feedback
    iterations : of the solver
    """

    status: Status
    fun: float
    duration: float
    x: dict[str, float]
    controls: dict[str, Control]
    planned: Motion = field(repr=False)
    motion: Motion | None = field(default=None, repr=False)
    defect: float = float("nan")
    deviation: float = float("nan")
    iterations: int = 0
    label: str = "objective"

    @property
    def success(self) -> bool:
        return self.status.success

    def control(self, name: str) -> Control:
        """A control by the name of its parameter."""
        if name not in self.controls:
            raise AnalysisError(unknown("control", name, self.controls))
        return self.controls[name]

    def plot(self, *measures: str) -> Any:
        """Controls and measures over time: dots planned, lines run forward; returns the figure."""
        import matplotlib.pyplot as plt

        count = len(self.controls) + len(measures)
        figure, axes = plt.subplots(
            1, count, figsize=(4 * count, 3.2), layout="constrained", squeeze=False
        )
        for ax, (name, control) in zip(axes[0], self.controls.items(), strict=False):
            times = np.linspace(0, self.duration, 400)
            ax.plot(times, control(times))
            ax.set(title=f"{name} [{control.unit}]" if control.unit else name)
        for ax, name in zip(axes[0][len(self.controls) :], measures, strict=True):
            if self.motion is not None:
                ax.plot(self.motion.time, self.motion.values(name))
            ax.plot(self.planned.time, self.planned.values(name), ".", ms=5)
            unit = self.planned.expression(name).unit
            ax.set(title=f"{name} [{unit}]" if unit else name)
        for ax in axes[0]:
            ax.set_xlabel("time [s]")
            ax.grid(alpha=0.25)
            ax.spines[["top", "right"]].set_visible(False)
        return figure

    def report(self, path: str | Path, **first_view: Any) -> Path:
        """The page of the motion that was run forward."""
        shown = self.motion if self.motion is not None else self.planned
        return shown.report(path, **first_view)

    def __repr__(self) -> str:
        return (
            f"<OptimalTrajectory: {self.label} = {self.fun:.6g} in {self.duration:.4g} s, "
            f"{self.status}, defect {self.defect:.2g}, {self.deviation:.2g} from its forward run>"
        )
