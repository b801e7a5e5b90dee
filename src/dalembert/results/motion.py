"""Motion: the result of an analysis over time, as users hold it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.results.labelled import LabelledRecording
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.spelling import spelled
from dalembert.text.wording import card, folded, messages, table

if TYPE_CHECKING:
    import pandas as pd

    from dalembert.report.inline import InlinePage
    from dalembert.results.structural.recovered import RecoveredStates


Names = Sequence[str] | None
Groups = Sequence[Sequence[str]] | None
Units = Sequence[str]

FINAL = ("kinetic_energy", "potential_energy", "energy", "balance_error")
LARGEST = ("position_violation", "velocity_violation")


@dataclass(eq=False, repr=False)
class Motion(LabelledRecording):
    """Motion of a mechanism: its data, files, pictures and report.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=0.5, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> isinstance(motion, da.Motion), motion.status.outcome.name
    (True, 'COMPLETED')
    >>> motion["stone.y"].sel(time=1.0, method="nearest").item(), motion["stone.y"].attrs["units"]
    (5.0, 'm')
    >>> round(motion["0.5*hypot(stone.vx, stone.vy)**2"][0].item(), 6)  # a formula of measures
    54.5
    """

    def summary(self) -> dict[str, Any]:
        """Status, statistics, events, final energies and largest violations."""
        data, some = self.contents, bool(self.time.size)
        told: dict[str, Any] = {
            "status": str(self.status),
            "time": self.status.time,
            "residual": self.status.residual,
            "statistics": self.statistics,
            "warnings": list(self.warnings),
            "events": [event.row for event in self.events],
            "final": {name: float(data[name][-1]) for name in FINAL if some},
            "largest": {name: float(data[name].max()) for name in LARGEST if some},
        }
        if (estimate := self.error_estimate) is not None:
            told["largest"]["estimated_error"] = estimate.share
        if self.impacts:
            told["impacts"] = [impact.row for impact in self.impacts]
        return told

    @spelled
    def continued(
        self,
        duration: float | str,
        *,
        step: float | str | None = None,
        outputs: int | Sequence[float] | None = None,
        events: Mapping[str, Any] | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> Motion:
        """The motion gone on with from its end; of dynamics.

        Positions, speeds, sides of switches, phases of contacts and the memory of the integrator
        are those at its end. The result is the whole motion, so energies, integrals, responses and
        their gradients count from the first start; ``at`` takes a part of it.

        Parameters
        ----------
        duration : of what follows [s]
        step : of what follows [s], by default as before
        outputs : number or times of what follows; by default as far apart as before
        events : of the whole, by default as before; ``{}`` for none, such as after one that ended
            the run
        progress : True for a bar, or a function of the fraction done

        Raises
        ------
        AnalysisError
            The run broke down, was ended by an event that is still asked for, or its times follow
            parameters.
        UnsupportedError
            Of another analysis.

        Examples
        --------
        >>> import dalembert as da
        >>> from dalembert import planar
        >>> system = da.System("throw", gravity=(0, -10))
        >>> stone = system.add(planar.Particle("stone", mass=0.5, velocity=(3, 10)))
        >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1).continued("1 s")
        >>> motion.time.size, motion["stone.x"].values[[0, -1]].round(9).tolist()
        (21, [0.0, 6.0])
        """
        given = {"step": step, "outputs": outputs, "events": events}
        options = {name: value for name, value in given.items() if value is not None}
        return self.analysis.continued(self, duration, options, progress)  # type: ignore[no-any-return]

    def structure(self, body: str) -> RecoveredStates:
        """The structure of a flexible body over the motion: displacements, stresses, pictures.

        Raises
        ------
        AnalysisError
            There is no flexible body of this name.
        """
        from dalembert.results.structural.recovered import recovered

        return recovered(self, body)

    # files and pictures ------------------------------------------------------------
    def save(  # type: ignore[override]
        self, path: str | Path, plots: Groups = None, trace: Names = None, units: Units = ()
    ) -> Path:
        """Write all results to a NetCDF file; ``load_results`` reads it back.

        ``plots``, ``trace`` and ``units`` are kept for its report, as in ``report``.
        """
        return super().save(path, plots=plots, trace=trace, units=units)

    def to_dataframe(self, *measures: str | Expression) -> pd.DataFrame:
        """One row per time, one column per measure, by name; their units are in ``attrs``.

        Without ``measures`` all scalar ones are there.
        """
        from dalembert.results.series import series_table

        return series_table(self, measures)

    def plot(self, *measures: str | Expression, ax: Any = None) -> Any:
        """Draw measures over time with Matplotlib; returns the axes."""
        from dalembert.results.pictures.plot import plot_measures

        return plot_measures(self, measures, ax)

    def draw(self, time: float = 0.0, ax: Any = None) -> Any:
        """The mechanism at the output nearest to a time [s] (Matplotlib); returns the axes."""
        from dalembert.results.pictures.animation import still

        return still(self, time, ax)

    def animate(self, **options: Any) -> Any:
        """Animation of the mechanism (Matplotlib); shown by notebooks."""
        from dalembert.results.pictures.animation import animate

        return animate(self, **options)

    def report(  # type: ignore[override]
        self, path: str | Path, plots: Groups = None, trace: Names = None, units: Units = ()
    ) -> Path:
        """Write the interactive report, one self-contained HTML file.

        Parameters
        ----------
        plots : groups of measures, one plot each
        trace : points whose paths are drawn
        units : that plots show, such as ``["mm", "deg"]``; each serves what has its dimension
        """
        return super().report(path, plots=plots, trace=trace, units=units)

    def page(self, plots: Groups = None, trace: Names = None, units: Units = ()) -> dict[str, Any]:
        from dalembert.results.files.payload import report_payload

        return report_payload(self, plots, trace, units)

    def show(  # type: ignore[override]
        self, height: int = 680, plots: Groups = None, trace: Names = None
    ) -> InlinePage:
        """Its report in a notebook, with player and plots; ``plots`` and ``trace`` as there."""
        return super().show(height, plots=plots, trace=trace)

    def _repr_html_(self) -> str:
        told, some = self.summary(), bool(self.time.size)
        span = f"{self.time[0]:g} … {self.time[-1]:g} s" if some else "none"
        rows: list[tuple[str, Any]] = [("status", told["status"])]
        rows += [("instants", f"{self.time.size}, {span}"), *self.statistics.items()]
        rows += [(f"final {n.replace('_', ' ')} [J]", v) for n, v in told["final"].items()]
        rows += [(f"largest {n.replace('_', ' ')}", v) for n, v in told["largest"].items()]
        rows += [(event["name"], f"t = {event['time']:.6g} s") for event in told["events"][:12]]
        doubts = messages(("warning", text) for text in self.warnings)
        data = folded("all data", self.data._repr_html_())
        named = [(str(name).replace("_", " "), value) for name, value in rows]
        title = f"Motion of {self.model.name}"
        return card(title, "show() plays it here", doubts, table(named), data)
