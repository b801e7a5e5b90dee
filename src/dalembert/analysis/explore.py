"""Live pages as widgets of notebooks, whose sliders and Python parameters stay in step."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from numbers import Real
from typing import TYPE_CHECKING, Any

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.equilibrium.statics import Statics
from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.analysis.nonsmooth.nonsmooth import Nonsmooth
from dalembert.elements.contact.collisions import Collisions
from dalembert.errors import ModelError
from dalembert.integrators.contact.schemes import MoreauJean
from dalembert.packages import optional_package
from dalembert.report.page import render_page
from dalembert.report.scripts import asset
from dalembert.results.analysis import Analysis
from dalembert.results.result import Result
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    from dalembert.model.assembled.model import StructuralModel
    from dalembert.model.graph.model import Model

DURATION = 3.0
"""Duration of a motion without an analysis [s]."""
OUTPUTS = 151
"""Instants of this motion."""
STEP = 1e-2
"""Step of this motion with contacts among many shapes [s]; two between outputs."""
ROUND_OFF = 1e-8
"""Relative round-off of the numbers of a page, which has ten digits."""


def usual_analysis(model: ParametricModel) -> Analysis[Any, Any]:
    """Analysis of a model for which none is stated: a motion of 3 s, or statics of a structure."""
    if model.kind == "structure":
        return Statics()
    mechanism: Any = model
    if any(isinstance(e, Collisions) for e in mechanism.closure.description.elements.values()):
        integrator = MoreauJean()  # its contact forces at rest do not alternate
        return Nonsmooth(duration=DURATION, step=STEP, outputs=OUTPUTS, integrator=integrator)
    kind: Any = Dynamics if mechanism.diagnosis.free > 0 else Kinematics
    analysis: Analysis[Any, Any] = kind(duration=DURATION, outputs=OUTPUTS)
    return analysis


@check_arguments
def explore(
    model: Model | StructuralModel,
    analysis: Analysis[Any, Any] | None = None,
    *,
    height: int = 720,
    **first_view: Any,
) -> Any:
    """The live page of an analysis as a widget of a notebook.

    Sliders of the page set ``parameters`` of the widget, and parameters set in Python move the
    sliders; ``on_change`` reports both. ``result`` is the result at these parameters, computed in
    Python when it is read.

    Parameters
    ----------
    model : with parameters that have bounds
    analysis : of the page; by default a motion of 3 s, driven or dynamic, or statics
    height : of the widget [px]
    **first_view : as of ``report``: plots, trace, units

    Returns
    -------
    Explorer
        A widget of anywidget: ``parameters`` (name → value in SI units), ``result``, ``on_change``.

    Raises
    ------
    UnsupportedError
        anywidget is missing (``pip install 'dalembert[notebook]'``).
    ModelError
        Parameters that are set are unknown, no numbers, or outside their bounds.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> length = system.parameter("l", 0.5, "m", bounds=(0.3, 0.8))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(length, 0)))
    >>> try:  # in a notebook: widget = da.explore(system.build())
    ...     widget = da.explore(system.build())
    ...     widget.parameters = {"l": 0.4}
    ...     text = widget.parameters
    ... except da.UnsupportedError as error:
    ...     text = "pip install 'dalembert[notebook]'" in str(error)
    >>> text in ({"l": 0.4}, True)
    True
    """
    kind = _widget_class()
    chosen = usual_analysis(model) if analysis is None else analysis
    return kind(model, chosen, chosen.run(model), height, first_view)


def _within_bounds(name: str, value: float, bounds: tuple[float, float]) -> float:
    """The value, which a slider between the bounds can show; bounds of pages are rounded.

    Raises
    ------
    ModelError
        It is beyond them.
    """
    lower, upper = bounds
    nearest = min(max(value, lower), upper)
    if abs(value - nearest) > ROUND_OFF * abs(nearest):
        raise ModelError(
            f"{value:g} is outside the bounds {lower:g} to {upper:g} of the slider; "
            "choose another value, or wider bounds of the parameter",
            name,
        )
    return nearest


@cache
def _widget_class() -> Any:
    """Class of the widget, which exists only where anywidget is installed."""
    alternative = "display the page by result.show()"
    anywidget = optional_package("anywidget", "a widget", alternative)
    import traitlets

    class Explorer(anywidget.AnyWidget):  # type: ignore[misc, name-defined]
        """A live page; see ``explore``."""

        _esm = asset("notebook/widget.js")
        page = traitlets.Unicode().tag(sync=True)
        height = traitlets.Int(720).tag(sync=True)
        parameters = traitlets.Dict().tag(sync=True)

        def __init__(
            self,
            model: ParametricModel,
            analysis: Analysis[Any, Any],
            first: Result,
            height: int,
            first_view: Mapping[str, Any],
        ):
            self.model, self.analysis = model, analysis
            nominal = {name: float(p.value) for name, p in model.parameters.items()}
            self._results: dict[tuple[float, ...], Result] = {tuple(nominal.values()): first}
            payload = first.live_page(first.page(**first_view), units=first_view.get("units", ()))
            super().__init__(page=render_page(payload), height=height, parameters=nominal)

        @traitlets.validate("parameters")
        def _check(self, proposal: Any) -> dict[str, float]:
            """All parameters, with the new values; values are in SI units or texts with a unit."""
            declared = self.model.parameters
            values = {name: float(p.value) for name, p in declared.items()} | dict(self.parameters)
            for name, value in dict(proposal["value"]).items():
                if name not in declared:
                    raise ModelError(unknown("parameter", name, declared))
                number = declared[name].in_si(value) if isinstance(value, str) else value
                if isinstance(number, bool) or not isinstance(number, Real):
                    raise ModelError(f"expected a number, got {value!r:.60}", name)
                if not math.isfinite(number):
                    raise ModelError(f"expected a finite number, got {value!r:.60}", name)
                values[name] = _within_bounds(name, float(number), declared[name].bounds)
            return values

        @property
        def result(self) -> Result:
            """Result at the present parameters."""
            key = tuple(self.parameters.values())
            if key not in self._results:
                result = self.analysis.run(self.model, dict(self.parameters))
                self._results = {key: result}
            return self._results[key]

        @property
        def motion(self) -> Result:
            """The result, which is a motion of a mechanism."""
            return self.result

        def on_change(self, act: Callable[[dict[str, float]], Any]) -> None:
            """Call a function with the parameters whenever they change."""
            self.observe(lambda change: act(dict(change["new"])), "parameters")

    return Explorer
