"""Record of the steps of a run with contacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dalembert.analysis.dynamics.residual_check import energy_errors
from dalembert.analysis.model_residuals import ModelResiduals
from dalembert.analysis.nonsmooth.active_contacts import StepPath
from dalembert.analysis.nonsmooth.between_steps import between
from dalembert.analysis.nonsmooth.checks.missing_impacts import (
    MissingImpact,
    find_missing_impact,
    largest,
)
from dalembert.analysis.nonsmooth.checks.passages import MOST, Passage, find_passage
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import ConsistentSpeeds
from dalembert.analysis.nonsmooth.correction_work import CorrectionWork
from dalembert.analysis.nonsmooth.impact_stage import ImpactStage
from dalembert.analysis.nonsmooth.step_entries import StepEntries
from dalembert.analysis.nonsmooth.step_state import StepResult
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.recording import Trajectory
from dalembert.symbolic.evaluation.kernel import Kernel


class StepLog:
    """Accumulator of steps; ``record`` converts them to arrays.

    Attributes
    ----------
    t, y, v : the last state
    passages : shapes that moved through each other
    missing_impacts : impacts that steps missed, by descending energy
    compiled : numbers of the steps in machine code, which are not searched for such impacts
    scheme_losses : (K+1,) energy dissipated by the scheme, once recorded [J]
    corrections : work of the corrections of positions, once recorded
    """

    def __init__(self, step: ContactStep, t: float, y: np.ndarray, v: np.ndarray):
        self.step = step
        self.times, self.positions, self.speeds = [t], [y], [v]
        self.uncorrected: list[np.ndarray] = []
        self.lengths: list[float] = []
        self.parts: list[StepEntries] = []
        self.paths: list[StepPath] = []
        self.impacts: list[ImpactStage | None] = []
        self.speed_losses: list[float] = []
        self.speed_inputs: list[float] = []
        self.passages: list[Passage] = []
        self.missing_impacts: list[MissingImpact] = []
        self.compiled: list[int] = []
        self.depths, self.compression = [self._depth(t, y)], [self._compression(t, y)]
        self.scheme_losses, self.corrections = np.zeros(1), CorrectionWork.none(step)

    @property
    def t(self) -> float:
        return self.times[-1]

    @property
    def y(self) -> np.ndarray:
        return self.positions[-1]

    @property
    def v(self) -> np.ndarray:
        return self.speeds[-1]

    @property
    def friction(self) -> float:
        """Energy dissipated by friction of contacts [J]."""
        return float(sum(part.friction.sum() for part in self.parts))

    @property
    def open_by(self) -> float:
        """The deepest penetration [m]."""
        return max(self.depths)

    def add(
        self, t: float, h: float, y: np.ndarray, speeds: ConsistentSpeeds, result: StepResult
    ) -> None:
        """Append a step, and the corrected position and consistent speeds at its end."""
        if result.closing is not None and len(self.passages) < MOST:
            passage = find_passage(self.step, self.t, h, self.y, result)
            self.passages += [] if passage is None else [passage]
        missing = find_missing_impact(self.step, self.t, h, self.y, self.v, result)
        if missing is not None:
            self.missing_impacts = largest([*self.missing_impacts, missing])
        self.times.append(t)
        self.lengths.append(h)
        self.uncorrected.append(result.y)
        self.parts.append(StepEntries.of(result, self.v))
        self.paths.append(StepPath.of(result))
        self.impacts.append(result.impact)
        self.positions.append(y)
        self.speeds.append(speeds.v)
        self.speed_losses.append(speeds.lost)
        self.speed_inputs.append(speeds.input)
        self.depths.append(self._depth(t, y))
        self.compression.append(self._compression(t, y))

    def extend(
        self,
        t: np.ndarray,
        states: Sequence[np.ndarray],
        depths: np.ndarray,
        part: StepEntries,
        paths: Sequence[StepPath],
    ) -> None:
        """Append K steps without joints or force laws: times, positions by rows, those before
        corrections, speeds, penetrations at their ends, and paths."""
        y, uncorrected, v = states
        self.compiled += range(len(self.lengths), len(self.lengths) + t.size)
        self.lengths += list(np.diff(t, prepend=self.t))
        self.times += list(t)
        self.uncorrected += list(uncorrected)
        self.positions += list(y)
        self.speeds += list(v)
        self.depths += list(depths)
        for zeros in (self.speed_losses, self.speed_inputs):
            zeros.extend([0.0] * t.size)
        self.compression += [(0.0, 0.0)] * t.size
        self.parts.append(part)
        self.paths += paths
        self.impacts += [None] * t.size

    def sizes(self) -> dict[str, int]:
        """Numbers of entries, for ``cut``."""
        lists = {name: value for name, value in vars(self).items() if isinstance(value, list)}
        return {name: len(value) for name, value in lists.items()}

    def cut(self, sizes: Mapping[str, int]) -> None:
        """Remove the steps that were appended by ``extend`` since the entries had these numbers."""
        for name, size in sizes.items():
            del getattr(self, name)[size:]

    def _depth(self, t: float, y: np.ndarray) -> float:
        return abs(self.step.deepest(self.step.at(t, y)))

    @property
    def stored(self) -> np.ndarray:
        """(K+1,) elastic energy of compliant contacts [J]."""
        return np.array(self.compression)[:, 0]

    def _compression(self, t: float, y: np.ndarray) -> tuple[float, float]:
        laws = self.step.force_laws
        if not laws.elements:
            return 0.0, 0.0
        return laws.compression(self.step.touching(self.step.at(t, y)))

    def record(self) -> ContactRecord:
        """The steps as arrays."""
        y, v, h = np.stack(self.positions, 1), np.stack(self.speeds, 1), np.array(self.lengths)
        model, entries = self.step.model, self.entries
        a, multiplier, loss = np.diff(v, axis=1) / h, entries.multiplier / h, entries.loss
        ends = Trajectory(
            np.array(self.times),
            y,
            v,
            _with_start(a),
            _with_start(np.vstack([model.all_multipliers(multiplier), self._forces(entries, h)])),
            self._work(y, v, a, multiplier, h, loss),
        )
        if h.size:
            self.scheme_losses = self._scheme_losses(ends)
            ends.work[0] += self.scheme_losses
        return ContactRecord(
            ends=ends,
            names=tuple(self.step.names),
            step=np.repeat(np.arange(h.size), entries.count),
            owner=entries.owner,
            key=entries.key,
            impulse=entries.impulse,
            offset=entries.offset,
            curved=entries.curved,
            kept=entries.kept,
            paths=self.paths,
            impacts=self.impacts,
            longest=entries.longest,
            linear=1 + sum(self.step.groups[:1]),
            loss=loss,
            work=entries.work,
            fraction=entries.fraction,
            stored=self.stored,
            compression=np.array(self.compression)[:, 1],
            penetration=np.array(self.depths),
            residual=entries.residual,
            rounds=entries.rounds,
            converged=entries.converged,
        )

    @property
    def entries(self) -> StepEntries:
        """Entries of all steps."""
        joints, components = self.step.model.equations.constraint_count, 1 + sum(self.step.groups)
        return StepEntries.joined(self.parts, joints, components)

    def _forces(self, entries: StepEntries, h: np.ndarray) -> np.ndarray:
        """(n, K) means over the steps of the normal and tangential forces of formula gaps."""
        step, keys = np.repeat(np.arange(h.size), entries.count), entries.key
        impulses = entries.impulse
        parts = [np.zeros((0, h.size))]
        for key, gap in enumerate(self.step.model.all_equations.contacts):
            forces, own = np.zeros((1 + gap.slip.numel(), h.size)), keys == key
            forces[:, step[own]] = impulses[own, : forces.shape[0]].T / h[step[own]]
            parts.append(forces)
        return np.vstack(parts)

    def _work(self, y, v, a, multiplier, h: np.ndarray, loss: np.ndarray) -> np.ndarray:
        """Dissipated energy and input at the ends of the steps, by the rule of their forces."""
        work = np.zeros((2, h.size + 1))
        if not h.size:
            return work
        work[:, 1:] = np.cumsum(np.vstack([loss, self.speed_inputs]), axis=1)
        smooth, theta = self.step.smooth, self.step.scheme.theta
        if not smooth.exchanges_energy:
            return work
        t, manifold = np.array(self.times)[:-1], self.step.model.equations.manifold
        powers = Kernel(smooth.powers.function.map(h.size))
        speeds, p = (v[:, 1:] + v[:, :-1]) / 2, np.tile(self.step.p[:, None], h.size)
        if smooth.takes_means(theta):  # speeds before they are made consistent
            speeds = manifold.lead(y[:, :-1], np.stack(self.uncorrected, 1)) / h
        rates = np.zeros((2, h.size))
        for s, weight in smooth.path_nodes(theta):
            at = between(self.step.model, y[:, :-1], y[:, 1:], s)
            shares = manifold.path_shares(h * speeds, s)
            rates += weight * powers(t + s * h, at, shares * speeds, a, multiplier, p)[0]
        work[:, 1:] += np.cumsum(h * rates, axis=1)
        return work

    def _scheme_losses(self, ends: Trajectory) -> np.ndarray:
        """(K+1,) energy dissipated by the scheme since the start [J].

        With ``θ = ½`` it is exchanged where positions are corrected, and where speeds are made
        consistent with the joints; gains are left as errors of the balance. The work of the first
        correction that removes a rounded overlap of the start is put in. Other ``θ`` exchange all
        that is missing in the balance. As they shift positions by ``h (θ − ½)(v⁺ − v)``, an
        impact returns what the fall before it lost: only the net loss since the start counts, and a
        net gain is an error.
        """
        model, p = self.step.model, self.step.p
        uncorrected = np.stack(self.uncorrected, 1)
        self.corrections = CorrectionWork.of(self.step, ends.t[1:], ends.y[:, 1:], uncorrected)
        work = self.corrections.work
        if 0 < self.depths[0] <= self.step.rounded_overlap:  # of rounded input, no error
            ends.work[1, 1:] += max(work[0], 0.0)
            work[0] = min(work[0], 0.0)
        if self.step.scheme.theta != 0.5:
            energies = ModelResiduals(model, ends, p).energies
            energies[1] += self.stored
            losses = -energy_errors(energies, ends.work)[1:]
            net = -np.diff(losses, prepend=0.0)
            self.corrections = replace(self.corrections, net=net)
            return np.append(0.0, np.maximum(losses, 0.0))
        losses = np.cumsum(np.array(self.speed_losses) - work)
        return np.append(0.0, np.maximum.accumulate(np.maximum(losses, 0.0)))


def _with_start(means: np.ndarray) -> np.ndarray:
    """Means over steps, preceded by those of the first step; zero without steps."""
    first = means[:, :1] if means.shape[1] else np.zeros((means.shape[0], 1))
    return np.hstack([first, means])
