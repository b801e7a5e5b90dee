"""Motion of a mechanism: the result of an analysis over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.results.labelled import LabelledRecording
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import card, folded, messages, table

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from dalembert.report.page import InlinePage
    from dalembert.results.live import PageResponse
    from dalembert.results.pictures.animation import Film
    from dalembert.results.structural.motion import RecoveredStates


Names = Sequence[str] | None
Groups = Sequence[Sequence[str]] | None
Units = Sequence[str]
Views = Sequence[Mapping[str, Any]]

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
        """Status, statistics, events, final energies and maximum violations."""
        data, has_outputs = self.contents, bool(self.time.size)
        summary: dict[str, Any] = {
            "status": str(self.status),
            "time": self.status.time,
            "residual": self.status.residual,
            "statistics": self.statistics,
            "warnings": list(self.warnings),
            "events": [event.row for event in self.events],
            "final": {name: float(data[name][-1]) for name in FINAL if has_outputs},
            "maxima": {name: float(data[name].max()) for name in LARGEST if has_outputs},
        }
        if (estimate := self.error_estimate) is not None:
            summary["maxima"]["estimated_error"] = estimate.share
        if self.impacts:
            summary["impacts"] = [impact.row for impact in self.impacts]
        return summary

    @check_arguments
    def continued(
        self,
        duration: float | str,
        *,
        step: float | str | None = None,
        outputs: int | Sequence[float] | None = None,
        events: Mapping[str, Any] | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> Motion:
        """Continue a run of dynamics from its end.

        Positions, speeds, branches of switches, phases of contacts and the memory of the integrator
        start from their values at the end. The result is the whole motion, so energies, integrals,
        responses and their gradients count from the first start; ``at`` samples a part of it.

        Parameters
        ----------
        duration : of the continuation [s]
        step : of the continuation [s], by default as before
        outputs : number or times of outputs of the continuation; by default with the same spacing
        events : of the whole run, by default as before; ``{}`` for none, e.g. after one that ended
            the run
        progress : True for a bar, or a function of the fraction done

        Raises
        ------
        AnalysisError
            The run failed, was ended by an event that is still active, or its times follow
            parameters.
        UnsupportedError
            The motion comes from another analysis.

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
        changes = {"step": step, "outputs": outputs, "events": events}
        options = {name: value for name, value in changes.items() if value is not None}
        return self.analysis.continued(self, duration, options, progress)  # type: ignore[no-any-return]

    def structure(self, body: str) -> RecoveredStates:
        """The structure of a flexible body over the motion: displacements, stresses, pictures.

        Raises
        ------
        AnalysisError
            There is no flexible body of this name.
        """
        from dalembert.results.structural.motion import recover_structure

        return recover_structure(self, body)

    # files and pictures ------------------------------------------------------------
    def save(  # type: ignore[override]
        self, path: str | Path, plots: Groups = None, trace: Names = None, units: Units = ()
    ) -> Path:
        """Write all results to a NetCDF file; ``load_results`` reads it back.

        ``plots``, ``trace`` and ``units`` apply to its report, as in ``report``.
        """
        return super().save(path, plots=plots, trace=trace, units=units)

    def to_dataframe(self, *measures: str | Expression) -> pd.DataFrame:
        """One row per time, one column per measure, by name; their units are in ``attrs``.

        Without ``measures`` the table contains all scalar ones.
        """
        from dalembert.results.labelled import series_table

        return series_table(self, measures)

    def plot(self, *measures: str | Expression, ax: Axes | None = None) -> Axes:
        """Draw measures over time with Matplotlib; returns the axes."""
        from dalembert.results.pictures.plot import plot_measures

        return plot_measures(self, measures, ax)

    def draw(self, time: float = 0.0, ax: Axes | None = None) -> Axes:
        """Draw the mechanism at the output nearest to a time [s] (Matplotlib); returns the axes."""
        from dalembert.results.pictures.animation import still

        return still(self, time, ax)

    def animate(self, **options: Any) -> Film:
        """Animation of the mechanism (Matplotlib); shown by notebooks."""
        from dalembert.results.pictures.animation import animate

        return animate(self, **options)

    def report(  # type: ignore[override]
        self,
        path: str | Path,
        plots: Groups = None,
        trace: Names = None,
        units: Units = (),
        views: Views = (),
        live: bool | None = None,
        responses: Sequence[PageResponse] = (),
    ) -> Path:
        """Write the interactive report, one self-contained HTML file.

        In a live page every parameter is a slider, and the page computes the motion, responses and
        their gradients again while it moves, without a server.

        Parameters
        ----------
        plots : groups of measures, one plot each
        trace : points whose paths are drawn
        units : units of plots, such as ``["mm", "deg"]``; each applies to its dimension
        views : further cards, from functions of ``dalembert.report.views``
        live : whether the page is live; by default if the model has parameters with bounds and the
            compiled functions have at most 300 kB. A page that is not live states the reason
        responses : responses that a live page lists with their slopes, such as
            ``[da.maximum("A.force_norm")]``, reduced over the instants of the page; by default the
            maxima of the plotted measures

        Raises
        ------
        UnsupportedError
            A page does not compute one of the responses.
        """
        from dalembert.report.page import write_page

        page = self.page(plots=plots, trace=trace, units=units, views=views)
        return write_page(self.live_page(page, live, responses, units=units), path)

    def page(
        self, plots: Groups = None, trace: Names = None, units: Units = (), views: Views = ()
    ) -> dict[str, Any]:
        from dalembert.results.files.payload import report_payload

        return report_payload(self, plots, trace, units) | {"views": list(views)}

    def show(  # type: ignore[override]
        self, height: int = 680, plots: Groups = None, trace: Names = None, views: Views = ()
    ) -> InlinePage:
        """Report in a notebook, with player and plots; options as in ``report``."""
        return super().show(height, plots=plots, trace=trace, views=views)

    def _repr_html_(self) -> str:
        summary, has_outputs = self.summary(), bool(self.time.size)
        span = f"{self.time[0]:g} … {self.time[-1]:g} s" if has_outputs else "none"
        rows: list[tuple[str, Any]] = [("status", summary["status"])]
        rows += [("instants", f"{self.time.size}, {span}"), *self.statistics.items()]
        rows += [(f"final {n.replace('_', ' ')} [J]", v) for n, v in summary["final"].items()]
        rows += [(f"largest {n.replace('_', ' ')}", v) for n, v in summary["maxima"].items()]
        rows += [(event["name"], f"t = {event['time']:.6g} s") for event in summary["events"][:12]]
        warnings = messages(("warning", text) for text in self.warnings)
        data = folded("all data", self.data._repr_html_())
        labelled_rows = [(str(name).replace("_", " "), value) for name, value in rows]
        title = f"Motion of {self.model.name}"
        return card(title, "show() plays it here", warnings, table(labelled_rows), data)
