"""Gradients of transients: exact derivatives of the steps that were taken.

The adjoint goes backward through the steps, the direct method forward with all parameters at once;
both with the factors of the run, or of the tangent at each state.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.structural.transient_equation import Motions, Slopes, moved
from dalembert.analysis.structural.transient_step import TransientStep
from dalembert.integrators.newmark_rule import Moving
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.transient_outputs import Look, Looks, Seen
from dalembert.sensitivity.structural.transient_parameters import ParameterChanges, ParameterWeights

NUMBERS = 30_000_000
"""Entries of element matrices, times responses, that one march keeps."""


class TransientPass:
    """What both directions share.

    Parameters
    ----------
    samples : of the same run
    """

    def __init__(self, samples: Sequence[Sample]):
        self.looks = Looks(samples)
        self.march = self.looks.record.march
        self.steps, self.start = self.march.steps, self.march.start
        self.equation = e = self.march.equation
        self.size, self.rows = e.assembly.size, len(samples)

    def inner_step(self, length: float) -> TransientStep:
        """A step to an output between the ends of steps."""
        return TransientStep(self.equation, self.march.analysis.integrator, length)

    def arriving(self, node: int) -> TransientStep:
        """The step that ends at a node."""
        return self.march.step(float(self.steps.h[node - 1]))

    def time(self, node: int) -> float:
        """Instant of a node."""
        return float(self.steps.t[node]) if node < self.steps.count else self.steps.end

    def seen(self, looks: Sequence[Look]) -> Seen:
        """What the responses weigh at an instant."""
        return self.looks.seen(looks, self.size, self.equation.p.size)

    def motion_at(self, look: Look) -> Motions:
        """The motion at an output."""
        motion, k = self.looks.motion(look), look[1]
        return Motions(
            motion.displacements[:, k], motion.velocities[:, k], motion.accelerations[:, k]
        )

    def solved(self, factor, where: np.ndarray, rhs: np.ndarray, way: str = "T") -> np.ndarray:
        """(n, columns) solution on some displacements, of the transpose as a rule."""
        found = np.zeros_like(rhs)
        if factor is not None:
            found[where] = factor.solve(np.ascontiguousarray(rhs[where]), way)
        return found


class TransientAdjoint(TransientPass):
    """Gradients of all responses by one march backward.

    With multipliers ``λ`` of the equations of motion at the end of a step,
    ``(M + κ(h γ C + h² β K)) λ`` is the weight of the accelerations there.
    """

    def gradient(self) -> np.ndarray:
        """(rows, np) derivatives."""
        self.parameters = ParameterWeights(self.equation, self.rows)
        bar = self._none()
        for node in range(self.steps.count, -1, -1):
            bar = self._inside(node, bar)
            seen, motion = self.seen(self.looks.ends.get(node, [])), moved(self.march.node(node))
            if node == 0:
                break
            if node in self.march.shortened:
                bar, seen = self._lengthened(node, motion, bar, seen), self.seen([])
                motion = moved(self.march.arrived(node))
            bar = self._through(self.arriving(node), motion, self.time(node), bar, seen)
        self._begin(motion, bar, seen)
        return self.parameters.total.T

    def _none(self) -> Moving:
        return Moving(*np.zeros((4, self.size, self.rows)))

    def _inside(self, node: int, bar: Moving) -> Moving:
        """Add what outputs inside the following step weigh."""
        for length, looks in self.looks.inside.get(node, {}).items():
            motion, time = self.motion_at(looks[0]), self.time(node) + length
            step, nothing = self.inner_step(length), self._none()
            back = self._through(step, motion, time, nothing, self.seen(looks))
            bar = Moving(*(a + b for a, b in zip(bar, back, strict=True)))
        return bar

    def _lengthened(self, node: int, motion: Motions, bar: Moving, seen: Seen) -> Moving:
        """Weights of what the step left, from those of the motion with shorter rotation vectors."""
        bar, reactions = self._with_reactions(self.equation.slopes(motion), bar, seen)
        self._weigh(motion, self.time(node), np.zeros_like(bar.u), reactions, seen)
        march = self.march
        return march.charts.pull(march.arrived(node), march.shortened[node], bar)

    def _through(
        self, step: TransientStep, motion: Motions, time: float, bar: Moving, seen: Seen
    ) -> Moving:
        """Weights of what a step begins with, from those of its end."""
        slopes = self.equation.slopes(motion)
        bar, reactions = self._with_reactions(slopes, bar, seen)
        weight = step.rule.weigh_acceleration(bar)
        multiplier = self.solved(step.factor(slopes), self.equation.free, weight)
        self._weigh(motion, time, multiplier, reactions, seen)
        return step.rule.weigh_start(self._balanced(slopes, time, bar, multiplier))

    def _with_reactions(self, slopes: Slopes, bar: Moving, seen: Seen) -> tuple[Moving, np.ndarray]:
        """Add what is seen; weights of reactions are such of the motion that needs them."""
        e = self.equation
        reactions = np.zeros_like(seen.forces)
        reactions[e.held] = seen.forces[e.held]
        u, v, a = bar.u + seen.u, bar.v + seen.v, bar.a + seen.a
        if reactions.any():
            more = slopes.weigh(reactions)
            u, v, a = u + more.u, v + more.v, a + more.a
        return Moving(u, v, a, bar.s), reactions

    def _weigh(self, motion: Motions, time: float, multiplier, reactions, seen: Seen) -> None:
        """Take multipliers of the equations of motion, and what is seen, to the parameters."""
        applied = multiplier + seen.forces
        held = self.equation.held
        applied[held] = -reactions[held]  # reactions do not see what acts on supports
        self.parameters.own(seen.p)
        self.parameters.equations(motion, reactions - multiplier)
        self.parameters.loads(applied, time)
        loading = multiplier.copy()
        loading[held] = -reactions[held]
        self.parameters.expansion(loading, time)

    def _balanced(self, slopes: Slopes, time: float, bar: Moving, multiplier) -> Moving:
        """Take multipliers of the equations of motion to supports and the motion."""
        held, back = self.equation.held, slopes.weigh(multiplier)
        left = Motions(bar.u - back.u, bar.v - back.v, bar.a - back.a)
        self.parameters.supports(Motions(*(weight[held] for weight in left)), time)
        found = Moving(*left, bar.s.copy())
        for weight in found:
            weight[held] = 0.0
        return found

    def _begin(self, motion: Motions, bar: Moving, seen: Seen) -> None:
        """Take the weights of the beginning to what it is made of."""
        e, start = self.equation, self.start
        slopes = e.slopes(motion)
        bar, reactions = self._with_reactions(slopes, bar, seen)
        multiplier = self.solved(start.mass_factor(slopes), e.massive, bar.a)
        self._weigh(motion, self.time(0), multiplier, reactions, seen)
        bar = self._balanced(slopes, self.time(0), bar, multiplier)
        self.parameters.own(self._pulled(start.initial.velocities, bar.v))
        if not start.static:
            self.parameters.own(self._pulled(start.initial.displacements, bar.u))
            return
        multiplier = self.solved(start.static_factor(motion.u), e.free, bar.u)
        self.parameters.equilibrium(motion.u, -multiplier)
        self.parameters.loads(multiplier, self.time(0))
        self.parameters.expansion(multiplier, self.time(0))
        rest = np.zeros((e.held.size, self.rows))
        held = Motions(-(e.tangent(motion.u).T @ multiplier)[e.held], rest, rest)
        self.parameters.supports(held, self.time(0))

    def _pulled(self, source, weights: np.ndarray) -> np.ndarray:
        return np.stack([source.pull(self.equation.p, w) for w in weights.T], axis=1)


class TransientDirect(TransientPass):
    """Derivatives of the whole motion by some parameters, all at once.

    Parameters
    ----------
    samples : of the same run
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        super().__init__(samples)
        self.columns = list(columns)
        directions = np.eye(self.equation.p.size)[:, self.columns]
        self.changes = ParameterChanges(self.equation, directions)
        self.found = np.zeros((self.rows, len(self.columns)))

    def gradient(self) -> np.ndarray:
        """(rows, columns) derivatives."""
        change = self._begin()
        for node in range(self.steps.count + 1):
            if node:
                change = self._at_end(node, change)
            for length, looks in self.looks.inside.get(node, {}).items():
                motion, time = self.motion_at(looks[0]), self.time(node) + length
                self._after(self.inner_step(length), motion, time, change, looks)
        return self.found

    def _at_end(self, node: int, change: Moving) -> Moving:
        """Changes at the end of a whole step, with the rotation vectors it goes on with."""
        march, looks, time = self.march, self.looks.ends.get(node, []), self.time(node)
        left, where = march.arrived(node), march.shortened.get(node)
        if where is None:
            return self._after(self.arriving(node), moved(left), time, change, looks)
        change = self._after(self.arriving(node), moved(left), time, change, [])
        change = march.charts.push(left, where, change)
        motion, loads = moved(march.node(node)), self.changes.loads(time)
        inner = self.changes.equations(motion) + self.equation.slopes(motion).along(moved(change))
        self._look(looks, change, loads, inner)
        return change

    def _after(
        self, step: TransientStep, motion: Motions, time: float, change: Moving, looks: list[Look]
    ) -> Moving:
        """Changes at the end of a step; the responses there take their part."""
        e = self.equation
        ahead, held = step.predicted(change), self.changes.supports(time)
        slopes, own = e.slopes(motion), self.changes.equations(motion)
        own = own - self.changes.expansion(time)
        loads = self.changes.loads(time)
        rest = np.zeros_like(ahead.u)
        rest = loads - own - slopes.along(moved(step.placed(ahead, held, rest)))
        a = self.solved(step.factor(slopes), e.free, rest, "N")
        after = step.placed(ahead, held, a)
        self._look(looks, after, loads, own + slopes.along(moved(after)) if looks else own)
        return after

    def _begin(self) -> Moving:
        """Changes at the beginning."""
        e, start, time = self.equation, self.start, self.time(0)
        motion, held = moved(self.march.node(0)), self.changes.supports(time)
        loads, slopes = self.changes.loads(time), e.slopes(motion)
        u = np.zeros((self.size, len(self.columns)))
        if not start.static:
            u = self.changes.each(start.initial.displacements)
        u[e.held] = held.u
        if start.static:
            rest = loads - self.changes.equilibrium(motion.u) - e.tangent(motion.u) @ u
            rest = rest + self.changes.expansion(time)
            u += self.solved(start.static_factor(motion.u), e.free, rest)
        v, a = self.changes.each(start.initial.velocities), np.zeros_like(u)
        v[e.held], a[e.held] = held.v, held.a
        own = self.changes.equations(motion) - self.changes.expansion(time)
        rest = loads - own - slopes.along(Motions(u, v, a))
        a += self.solved(start.mass_factor(slopes), e.massive, rest, "N")
        begin = Moving(u, v, a, np.zeros_like(a))
        self._look(self.looks.ends.get(0, []), begin, loads, own + slopes.along(moved(begin)))
        return begin

    def _look(self, looks: list[Look], x: Moving, loads: np.ndarray, inner: np.ndarray) -> None:
        """Add the changes of what the responses see."""
        if not looks:
            return
        seen, forces = self.seen(looks), loads.copy()
        held = self.equation.held
        forces[held] = (inner - loads)[held]
        self.found += seen.p[self.columns].T
        pairs = ((seen.u, x.u), (seen.v, x.v), (seen.a, x.a), (seen.forces, forces))
        for weight, change in pairs:
            self.found += weight.T @ change


class TransientEngine(Engine):
    """Transients of structures, linear or not."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return TransientDirect(self.samples, columns).gradient()

    def adjoint(self) -> np.ndarray:
        blocks = self.samples[0].motion.record.march.equation.assembly.blocks
        size = sum(b.count * b.kind.displacement_count**2 for b in blocks)
        most = max(1, NUMBERS // max(size, 1))
        groups = range(0, len(self.samples), most)
        return np.concatenate(
            [TransientAdjoint(self.samples[k : k + most]).gradient() for k in groups]
        )
