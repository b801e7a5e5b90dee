"""Result of trajectory optimisation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.trajectory.control import Control
from dalembert.errors import AnalysisError
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome, Status
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(eq=False)
class TrajectoryResult(Decision):
    """Result of ``optimize_trajectory``.

    Attributes
    ----------
    status : status of the optimisation, with the largest residual of its equations
    fun : value of the objective
    duration : of the motion [s]
    x : varied parameters, parameter → value
    start : initial values of these parameters
    controls : name → Control, a function of time
    planned : the motion at the knots of the transcription
    motion : the motion under these controls, run forward from the start of the plan; None if the
        optimisation failed
    defect : largest distance from the plan after an interval run forward from its knot, in
        natural sizes (lengths of the mechanism, radians): how fine the intervals are
    deviation : largest distance of ``planned`` and ``motion`` at a knot, likewise; large if the
        mechanism is unstable and needs feedback
    step_error : largest distance of ``motion`` and a run with half of its steps, likewise
    intervals : of the plan, after refinement
    iterations : of the solver, in all refinements
    warnings : chattering controls, and the resulting modifications
    label, unit : of the objective

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-20, 20))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> best = da.optimize_trajectory(system.build(), da.integral("push**2"), controls=["push"],
    ...     duration=1.0, end={"cart.x": 1, "cart.vx": 0}, method=da.DirectCollocation(intervals=4))
    >>> isinstance(best, da.TrajectoryResult), best.deviation < 1e-4
    (True, True)
    >>> round(best.motion["cart.x"][-1].item(), 4)  # forward run under the optimal control
    1.0
    """

    file_suffix = "trajectory"
    page_functions = "trajectory:trajectory"
    status: Status
    fun: float
    duration: float
    x: dict[str, float]
    controls: dict[str, Control]
    planned: Motion = field(repr=False)
    motion: Motion | None = field(default=None, repr=False)
    defect: float = float("nan")
    deviation: float = float("nan")
    step_error: float = float("nan")
    intervals: int = 0
    iterations: int = 0
    warnings: list[str] = field(default_factory=list)
    label: str = "objective"
    unit: str = ""
    start: dict[str, float] = field(default_factory=dict)

    @property
    def success(self) -> bool:  # type: ignore[override]
        return self.status.success

    @property
    def message(self) -> str:  # type: ignore[override]
        return self.status.message

    @property
    def interrupted(self) -> bool:  # type: ignore[override]
        return self.status.outcome is Outcome.INTERRUPTED

    def interrupt(self) -> None:
        if not self.interrupted:
            message = f"interrupted after the search; {self.status.message}"
            self.status = replace(self.status, outcome=Outcome.INTERRUPTED, message=message)

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the model."""
        return str(self.planned.model.name)

    @property
    def final_motion(self) -> Motion:
        """The forward motion, or the plan if there is none."""
        return self.planned if self.motion is None else self.motion

    @property
    def sentence(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        state = "optimal" if self.success else str(self.status)
        return f"{self.label} = {self.fun:.4g}{unit} in {self.duration:.4g} s, {state}"

    def control(self, name: str) -> Control:
        """A control by the name of its parameter."""
        if name not in self.controls:
            raise AnalysisError(unknown("control", name, self.controls))
        return self.controls[name]

    def plot(self, *measures: str) -> Figure:
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

    def findings(self) -> dict[str, Any]:
        return {
            "objective": self.label,
            "unit": self.unit,
            "fun": self.fun,
            "duration": self.duration,
            "x": self.x,
            "start": self.start,
            "controls": {
                name: {
                    "unit": control.unit,
                    "times": control.times.tolist(),
                    "values": control.values.tolist(),
                }
                for name, control in self.controls.items()
            },
            "residual": self.status.residual,
            "defect": self.defect,
            "deviation": self.deviation,
            "step_error": self.step_error,
            "intervals": self.intervals,
            "iterations": self.iterations,
        }

    @property
    def data(self) -> xr.Dataset:
        """The motion, and the controls at the ends and middles of the intervals."""
        dataset = self.final_motion.data
        for name, control in self.controls.items():
            about = {"units": control.unit}
            dataset = dataset.assign({f"control_{name}": ("control_time", control.values, about)})
        times = next((c.times for c in self.controls.values()), np.zeros(0))
        return dataset.assign_coords(control_time=("control_time", times, {"units": "s"}))

    def to_dataframe(self) -> pd.DataFrame:
        """A row per instant of the motion, with its controls among the measures."""
        return self.final_motion.to_dataframe()

    def __repr__(self) -> str:
        return (
            f"<TrajectoryResult: {self.label} = {self.fun:.6g} in {self.duration:.4g} s, "
            f"{self.status}, defect {self.defect:.2g}, {self.deviation:.2g} from its forward run>"
        )
