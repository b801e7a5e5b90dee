"""Operating points of mechanisms: a state at which they are linearised, and its derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import ignored_contacts
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.equilibrium.equilibrium import Equilibrium
from dalembert.analysis.frequency.descriptor import DescriptorKernel, descriptor_kernel
from dalembert.errors import AnalysisError
from dalembert.formulations.base import memory_symbols
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory

RESTING = 1e-7
"""Speeds and accelerations of a state at rest, in natural sizes [-]."""
MOVES = (
    "the operating point moves: the linear system is that of this instant, and its responses hold "
    "as far as its coefficients do not change; they are exact about equilibria"
)


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """State at which a mechanism is linearised.

    Attributes
    ----------
    kernel : DescriptorKernel
    time : [s]
    y, v, a, multiplier, p : the state, (n_y,), (n,), (n,), (m,), and the parameters
    origin : dependence of the state on the parameters; None for instants of motions
    residual : residual of the state
    notes : warnings about the state
    """

    kernel: DescriptorKernel
    time: float
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    multiplier: np.ndarray
    p: np.ndarray
    origin: Origin | None = None
    residual: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def model(self) -> Model:
        return self.kernel.model

    @property
    def arguments(self) -> tuple[Any, ...]:
        """Arguments of the functions of the kernel."""
        return self.time, self.y, self.v, self.a, self.multiplier, self.p

    @property
    def moves(self) -> bool:
        """Whether the state moves or accelerates."""
        s = self.kernel.e.scales
        speeds = np.abs(self.v) / s.speeds, np.abs(self.a) / s.speeds * s.time
        return bool(max(part.max(initial=0.0) for part in speeds) > RESTING)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the state, and contacts that small motions open or close."""
        full = self.model.all_multipliers(self.multiplier[:, None])
        y, v, a = (column[:, None] for column in (self.y, self.v, self.a))
        instant = Trajectory(np.array([self.time]), y, v, a, full, np.zeros((2, 1)))
        moving = (MOVES,) if self.moves else ()
        contacts = ignored_contacts(self.model, instant, self.p, forces=True)
        return (*self.notes, *moving, *contacts, *elastic_warnings(self.model, instant, self.p))


class Origin:
    """Dependence of an operating point on the parameters."""

    def push(self, point: OperatingPoint, dp: np.ndarray) -> np.ndarray:
        """Change of ``[y; v; a; λ]`` along a direction of the parameters."""
        raise NotImplementedError

    def pull(self, point: OperatingPoint, weights: Sequence[np.ndarray]) -> np.ndarray:
        """(np,) weights of the parameters from those of y, v, a, λ."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class AtRest(Origin):
    """Equilibrium near ``[y; λ]``.

    Attributes
    ----------
    configuration : ``(t, near, p) → [y; λ]``
    near : (n_y + m,)
    """

    configuration: Any
    near: np.ndarray

    def push(self, point: OperatingPoint, dp: np.ndarray) -> np.ndarray:
        fixed = point.time, self.near, point.p, 0, np.zeros(self.near.size)
        change = self.configuration.tangent(*fixed, dp).full().ravel()
        count = point.y.size
        still = np.zeros(point.v.size + point.a.size)
        return np.concatenate([change[:count], still, change[count:]])

    def pull(self, point: OperatingPoint, weights: Sequence[np.ndarray]) -> np.ndarray:
        y_bar, _, _, forces_bar = weights
        stacked = np.concatenate([y_bar, forces_bar])
        back = self.configuration.adjoint(point.time, self.near, point.p, stacked)
        return back[2].full().ravel()  # type: ignore[no-any-return]


@dataclass(frozen=True, eq=False)
class Assembled(Origin):
    """Assembled state with its accelerations.

    Attributes
    ----------
    near : (n_y,) position near which it is assembled
    """

    near: np.ndarray

    def push(self, point: OperatingPoint, dp: np.ndarray) -> np.ndarray:
        kernel, still = point.kernel, np.zeros(self.near.size)
        start = point.model.initial_state.tangent
        state = start(point.time, self.near, point.p, 0, still, dp)
        dy, dv = (part.full().ravel() for part in state)
        rest = np.zeros(memory_symbols(kernel.e).numel())
        moving, change = self._state(point), np.concatenate([dy, dv, rest])
        rates = kernel.accelerations.tangent(point.time, moving, point.p, 0, change, dp)
        return np.concatenate([dy, dv, *(part.full().ravel() for part in rates)])

    def pull(self, point: OperatingPoint, weights: Sequence[np.ndarray]) -> np.ndarray:
        y_bar, v_bar, a_bar, forces_bar = weights
        back = point.kernel.accelerations.adjoint(
            point.time, self._state(point), point.p, a_bar, forces_bar
        )
        state, by_parameters = (part.full().ravel() for part in back[1:3])
        count = point.y.size
        seeds = y_bar + state[:count], v_bar + state[count : count + point.v.size]
        start = point.model.initial_state.adjoint(point.time, self.near, point.p, *seeds)
        return by_parameters + start[2].full().ravel()  # type: ignore[no-any-return]

    def _state(self, point: OperatingPoint) -> np.ndarray:
        return moving_state(point.kernel, point.y, point.v)


def moving_state(kernel: DescriptorKernel, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """``[y; v; …]`` with zero memory."""
    return np.concatenate([y, v, np.zeros(memory_symbols(kernel.e).numel())])


def operating_point(
    analysis: Any,
    model: Model,
    p: np.ndarray,
    about: Motion | None,
    near: np.ndarray | None = None,
) -> OperatingPoint:
    """The equilibrium, an assembled state, or the last instant of a motion.

    Parameters
    ----------
    analysis : strategy object with ``time`` and ``equilibrium``
    model : Model
    p : (n,) parameters
    about : equilibrium, or motion whose last instant is the state
    near : pose near which an equilibrium is searched

    Raises
    ------
    AnalysisError
        No equilibrium was found.
    """
    kernel = descriptor_kernel(model)
    if about is None and analysis.equilibrium:
        about = Equilibrium(analysis.time).run(model, p, start=near)
    if about is not None and about.analysis.at_rest:
        return _at_rest(kernel, about)
    if about is not None:
        return _last_instant(kernel, about)
    state = model.assemble(p, analysis.time)
    moving = moving_state(kernel, state.y, state.v)
    rates = kernel.accelerations.function(analysis.time, moving, p)
    a, forces = (part.full().ravel() for part in rates)
    origin = Assembled(state.y)
    columns = state.y, state.v, a, forces
    return OperatingPoint(kernel, analysis.time, *columns, p, origin, state.residual)


def _at_rest(kernel: DescriptorKernel, motion: Motion) -> OperatingPoint:
    status, s = motion.status, motion.trajectory
    if not status.success:
        raise AnalysisError(f"no equilibrium, {status}", status.residual)
    near, n = motion.record.kernel.near(s)[:, 0], kernel.e.speed_count
    forces = s.multiplier[kernel.model.closure.rows, 0]
    return OperatingPoint(
        kernel,
        float(s.t[0]),
        s.y[:, 0],
        np.zeros(n),
        np.zeros(n),
        forces,
        motion.parameters,
        AtRest(motion.record.kernel.configuration, near),
        status.residual,
        tuple(w for w in motion.warnings if "stable" in w),
    )


def _last_instant(kernel: DescriptorKernel, motion: Motion) -> OperatingPoint:
    s = motion.trajectory
    forces = s.multiplier[kernel.model.closure.rows, -1]
    columns = s.y[:, -1], s.v[:, -1], s.a[:, -1], forces
    return OperatingPoint(kernel, float(s.t[-1]), *columns, motion.parameters)
