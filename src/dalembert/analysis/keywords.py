"""Typed keywords of the solve functions, for editors and type checkers.

They are the fields of the analyses, which document them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypedDict

if TYPE_CHECKING:
    from dalembert.analysis.events import Events
    from dalembert.analysis.rayleigh import Rayleigh
    from dalembert.analysis.times import Time, Times
    from dalembert.formulations.base import Formulation
    from dalembert.formulations.stabilization import Stabilization
    from dalembert.integrators.base import Integrator
    from dalembert.integrators.contact.contact_solver import ContactSolver
    from dalembert.integrators.contact.schemes import ContactScheme
    from dalembert.model.graph.coordinates import Coordinates
    from dalembert.results.structural.load_path import LoadPathResult


class OverTimeKeywords(TypedDict, total=False):
    """Keywords of ``Kinematics`` and ``InverseDynamics``."""

    step: Time | None
    outputs: Times | None
    t_span: tuple[Time, Time] | None


class DynamicsKeywords(OverTimeKeywords, total=False):
    """Keywords of ``Dynamics``."""

    coordinates: Coordinates
    formulation: Formulation
    stabilization: Stabilization
    integrator: Integrator
    events: Events | None
    strict: bool
    backend: str
    balance: float
    memory: float
    nonlinear: bool
    lumped: bool
    damping: Rayleigh
    case: str
    start: str


class NonsmoothKeywords(OverTimeKeywords, total=False):
    """Keywords of ``Nonsmooth``."""

    integrator: ContactScheme
    solver: ContactSolver
    balance: float
    separate_impacts: bool
    sleep_after: float | None
    sleep_speed: float


class EquilibriumKeywords(TypedDict, total=False):
    """Keywords of ``Equilibrium``."""

    time: Time
    tolerance: float
    max_iterations: int | None
    steps: int


class StaticsKeywords(EquilibriumKeywords, total=False):
    """Keywords of ``Statics``, and of ``Equilibrium`` with ``nonlinear=True``."""

    solver: str


class ModalKeywords(TypedDict, total=False):
    """Keywords of ``Modal``."""

    time: Time
    equilibrium: bool
    coordinates: Coordinates
    lumped: bool
    shift: float


class BucklingKeywords(TypedDict, total=False):
    """Keywords of ``Buckling``."""

    constant: str | None
    negative: bool


class ArcLengthKeywords(TypedDict, total=False):
    """Keywords of ``ArcLength``."""

    case: str
    first: float
    longest: float
    until: float
    stop: Callable[[LoadPathResult], bool] | None
    max_points: int
    tolerance: float
    max_iterations: int


class FrequencyResponseKeywords(TypedDict, total=False):
    """Keywords of ``FrequencyResponse``."""

    inputs: Any
    outputs: Any
    excitation: Any
    span: tuple[float, float] | None
    method: str
    count: int | None
    about: Any
    time: Time
    equilibrium: bool
    damping: Rayleigh
    loss_factor: float
    damping_ratio: float
    lumped: bool
