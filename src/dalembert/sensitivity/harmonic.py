"""Gradients of harmonic responses of mechanisms.

The motion solves ``(K₀ + iω K₁) w = −b û``, the output is ``H = (c₀ + iω c₁) w + d û``. All
matrices depend on the operating point ``z(p)`` and on the parameters, so that, with the change
``δ·`` of the linearised equations for the motion ``w``,

    dH = δh + (c₀ + iω c₁) dw,   (K₀ + iω K₁) dw = −δr,   adjoint  (K₀ + iω K₁)ᵀ μ = −(c₀ + iω c₁)ᵀ.

Amplitudes at resonance peaks have the same derivatives at fixed and at moving frequency.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dalembert.analysis.frequency.linear_mechanism import LinearMechanism
from dalembert.analysis.frequency.modal_motions import ModalMechanism
from dalembert.errors import SingularityError, UnsupportedError
from dalembert.results.harmonic import HarmonicResponse
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.formulas.expression import Expression


def complex_seeds(sample: Sample) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Output → (K, inputs) ``s`` with ``dR = Re Σ s dH``, and (np,) derivative by the parameters.

    Raises
    ------
    SingularityError
        The measure has a kink, such as an amplitude or a phase of zero amplitude.
    """
    result: HarmonicResponse = sample.motion
    slopes, own = result.slopes(sample.measure)
    active = sample.weights != 0
    seeds: dict[str, np.ndarray] = {}
    for transfer, slope in slopes.items():
        if not np.all(np.isfinite(slope[active])):
            raise SingularityError(
                f"{sample.response.label}: the amplitude of {transfer.output} is zero, where it "
                "has a kink; use its real and imaginary parts"
            )
        shape = result.time.size, len(result.inputs)
        table = seeds.setdefault(transfer.output, np.zeros(shape, complex))
        unit = 1.0 if transfer.part == "real" else -1j
        table[active, result.column(transfer)] += unit * sample.weights[active] * slope[active]
    return seeds, own[:, active] @ sample.weights[active]


class HarmonicGradient:
    """Row of the gradient for one sampled response of a mechanism.

    Raises
    ------
    UnsupportedError
        The operating point is an instant of a motion, or modes are left out.
    """

    def __init__(self, sample: Sample, shared: dict | None = None):
        self.sample, self.result = sample, sample.motion
        self.system: LinearMechanism = self.result.record
        if isinstance(self.system, ModalMechanism) and self.system.count is not None:
            raise UnsupportedError(
                "gradients of a truncated modal superposition are not available; use "
                "method='direct'"
            )
        if self.system.point.origin is None:
            raise UnsupportedError(
                "gradients about the end of a motion are not available; use "
                "method='finite-difference'"
            )
        self.origin = self.system.point.origin
        self.seeds, self.own = complex_seeds(sample)

    def _changes(self) -> Iterator[tuple[Expression, np.ndarray, np.ndarray, np.ndarray]]:
        """Output, seeds (k,), angular frequencies (k,) and changes (k, d), for each input."""
        kernel, system = self.system.point.kernel, self.system
        moving = kernel.rates.stop - kernel.rates.start
        for name, table in self.seeds.items():
            for column in range(table.shape[1]):
                active = np.flatnonzero(table[:, column])
                if not active.size:
                    continue
                omega = self.result.omega[active]
                motions = self.result.motions[active, :, column]
                rates = 1j * omega[:, None] * motions[:, :moving]
                inputs = np.tile(system.directions[:, column], (active.size, 1))
                change = np.concatenate([motions, rates, inputs], axis=1)
                yield self.result.output(name), table[active, column], omega, change

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one transposed solution per frequency, output and input."""
        point, system = self.system.point, self.system
        p_bar = np.zeros(system.p.size)
        p_bar[: self.own.size] = self.own
        state = [np.zeros(part.size) for part in (point.y, point.v, point.a, point.multiplier)]
        for output, seeds, omega, change in self._changes():
            weights = seeds[:, None] * system.row(output).weights(omega)
            rows = system.adjoints(omega, weights[:, :, None])[:, :, 0]
            stacked = np.concatenate([seeds[:, None], rows], axis=1)
            directions = np.concatenate([change.real, change.imag]).T
            scalars = np.concatenate([stacked.real, -stacked.imag]).T
            mapped = point.kernel.pull(output).map(directions.shape[1])
            parts = [
                part.full().sum(axis=1) for part in mapped(*point.arguments, directions, scalars)
            ]
            p_bar += parts.pop()
            state = [total + part for total, part in zip(state, parts, strict=True)]
        return self._finite(p_bar + self.origin.pull(point, state))

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one tangent and one solution for each parameter."""
        point, system, model = self.system.point, self.system, self.result.model
        tangents = model.tangents(system.p, columns)
        gradient = self.own @ tangents[: self.own.size]
        moving = [np.concatenate([self.origin.push(point, dp), dp]) for dp in tangents.T]
        for output, seeds, omega, change in self._changes():
            mapped = point.kernel.push(output).map(2 * omega.size)
            weights = system.row(output).weights(omega)
            directions = np.concatenate([change.real, change.imag]).T
            for i, along in enumerate(moving):
                parts = mapped(*point.arguments, along, directions).full()
                moved = parts[:, : omega.size] + 1j * parts[:, omega.size :]
                equations = moved[1:].T[:, :, None]
                motions = system.changes(omega, equations)[:, :, 0]
                output_change = moved[0] + np.einsum("kn,kn->k", weights, motions)
                gradient[i] += float((seeds * output_change).sum().real)
        return self._finite(gradient)

    def _finite(self, gradient: np.ndarray) -> np.ndarray:
        if not np.all(np.isfinite(gradient)):
            raise SingularityError(
                "the operating point is no function of the parameters: the equilibrium is not "
                "isolated; use equilibrium=False, or constrain the free motion"
            )
        return gradient


class HarmonicEngine(RowEngine):
    """Engine for harmonic responses of mechanisms, row by row."""

    row = HarmonicGradient
