"""Compiled functions of a dynamic run, and where its outputs lie among its steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.formulations.base import Formulation, state_rate
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.march import AdaptiveMarch, FixedMarch, Steps
from dalembert.integrators.runge_kutta import DormandPrince, ExplicitRungeKutta
from dalembert.integrators.step import ExplicitStep
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.kernel import Kernel


@dataclass(frozen=True)
class Branches:
    """Where the outputs lie: ``length`` seconds after the beginning of step ``index``."""

    index: np.ndarray
    length: np.ndarray


@dataclass(frozen=True)
class DynamicsRecord:
    """What a gradient needs of a run: the steps taken and the branches to the outputs."""

    kernel: DynamicsKernel
    steps: Steps
    branches: Branches


class DynamicsKernel:
    """Compiled functions of one model under one choice of strategies."""

    def __init__(
        self,
        model: Model,
        formulation: Formulation,
        stabilization: Stabilization,
        integrator: ExplicitRungeKutta,
    ):
        e = model.equations
        self.model, self.formulation, self.stabilization = model, formulation, stabilization
        self.xi = stabilization.constraint_acceleration(e)
        rhs = formulation.acceleration(e, self.xi, [state_rate(e)], "state_rate")
        correction = stabilization.correction(e, formulation)
        self.step = ExplicitStep(integrator.tableau, rhs, correction)
        self.acceleration = formulation.acceleration(e, self.xi).function
        self.fixed = FixedMarch(self.step, stabilization.period)
        self.adaptive: AdaptiveMarch | None = None
        if isinstance(integrator, DormandPrince):
            controlled = e.coordinate_count + e.speed_count
            self.adaptive = AdaptiveMarch(self.step, integrator.rtol, integrator.atol, controlled)

    def branch_states(self, steps: Steps, branches: Branches, p: np.ndarray) -> np.ndarray:
        """States at the outputs: ends of steps as they are, others by a partial step."""
        k, length = branches.index, branches.length
        states = steps.x[:, k].copy()
        inside = np.flatnonzero(length > 0)
        if inside.size:
            full = np.isclose(length[inside], steps.h[k[inside]], rtol=1e-12, atol=0)
            states[:, inside[full]] = steps.x[:, k[inside[full]] + 1]
            part = inside[~full]
            if part.size:
                (states[:, part],) = Kernel(self.step.function.map(part.size))(
                    steps.t[k[part]],
                    length[part],
                    steps.x[:, k[part]],
                    np.tile(p[:, None], part.size),
                )
        return states

    def trajectory(self, times: np.ndarray, states: np.ndarray, p: np.ndarray) -> Trajectory:
        """Accelerations and multipliers at the given states."""
        e = self.model.equations
        n, count = e.coordinate_count, times.size
        a, multiplier = Kernel(self.acceleration.map(count))(
            times, states, np.tile(p[:, None], count)
        )
        speeds = slice(n, n + e.speed_count)
        return Trajectory(
            times,
            states[:n],
            states[speeds],
            a,
            multiplier,
            states[-2:],
        )


def place_outputs(steps: Steps, times: np.ndarray) -> Branches:
    """Where times lie among the steps taken."""
    count = steps.count
    slack = 1e-12 * max(1.0, abs(steps.end))
    if times[0] < steps.t[0] - slack or times[-1] > steps.end + slack:
        raise AnalysisError(
            f"times {times[0]:g}…{times[-1]:g} s leave the run {steps.t[0]:g}…{steps.end:g} s"
        )
    index = np.clip(np.searchsorted(steps.t[:count], times, side="right") - 1, 0, count - 1)
    length = np.clip(times - steps.t[index], 0.0, steps.h[index])
    small = 1e-12 * np.maximum(1.0, np.abs(times))
    length[length < small] = 0.0
    near = np.abs(length - steps.h[index]) < small
    length[near] = steps.h[index[near]]
    return Branches(index, length)
