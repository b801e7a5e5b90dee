"""Comparison of the formulas of gaps, and of their derivatives, with the numbers of the search."""

from __future__ import annotations

import numpy as np
import pytest

from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps
from dalembert.sensitivity.nonsmooth.source_slopes import SourceSlopes, StepState
from dalembert.sensitivity.nonsmooth.step_equations import step_equations
from dalembert.symbolic.evaluation.kernel import dense_array

EXACT = 1e-12
"""Difference of formulas and numbers."""


class GapDerivatives:
    """Formulas of the gaps of a source, at speeds ``v`` and in the direction ``way``."""

    def __init__(self, source: GapSource, model: Model, v: np.ndarray, way: np.ndarray):
        self.model, self.v, self.way = model, v, way
        self.slopes = SourceSlopes(source, model.equations)

    def at(self, y: np.ndarray, gaps: Contacts, impulses: np.ndarray) -> Gaps:
        state = StepState(0.0, y, self.model.nominal, self.v, self.v)
        rows, laws = np.arange(gaps.count), FIRST + max(len(gaps.groups), 1)
        return Gaps.of([self.slopes.at(state, rows, gaps.key, impulses, laws)])

    def check_values(self, y: np.ndarray, gaps: Contacts, exact: float = EXACT) -> None:
        """Distances, velocities and directions are the numbers."""
        here = self.at(y, gaps, np.zeros(gaps.drift.shape))
        np.testing.assert_allclose(here.values.distance, gaps.distance, atol=EXACT)
        np.testing.assert_allclose(here.values.before, gaps.speeds(self.v), atol=exact)
        directions = dense_array(here.directions), dense_array(gaps.directions)
        np.testing.assert_allclose(*directions, atol=exact)

    def check_slopes(self, y: np.ndarray, gaps: Contacts, rng: np.random.Generator) -> None:
        """Distances, velocities and momenta change by the position as the values do."""
        model, v = self.model, self.v
        go, impulses = model.equations.manifold.go, rng.normal(size=gaps.drift.shape)
        here = self.at(y, gaps, impulses)
        dq = np.zeros((y.size + v.size + 1 + model.nominal.size, 1))
        rates = step_equations(model, 0.5).rates(0.0, y, self.way, model.nominal)[0]
        dq[: y.size, 0] = rates.ravel()
        change, momentum = here.push(dq)
        ends = [self.at(go(y, step * self.way), gaps, impulses) for step in (1e-6, -1e-6)]
        distances, speeds, momenta = (
            [pick(end) for end in ends]
            for pick in (
                lambda end: end.values.distance,
                lambda end: end.values.before,
                lambda end: end.directions.T @ impulses.ravel(),
            )
        )
        for exact, values in (
            (change.distance, distances),
            (change.before, speeds),
            (change.after, speeds),
            (momentum, momenta),
        ):
            difference = (values[0] - values[1]) / 2e-6
            scale = 1 + np.abs(difference).max(initial=0.0)
            np.testing.assert_allclose(exact[..., 0], difference, atol=1e-6 * scale)
        weights = GapChanges(*(rng.normal(size=part.shape) for part in vars(change).values()))
        back = rng.normal(size=momentum.shape)
        forward = sum((getattr(weights, name) * part).sum() for name, part in vars(change).items())
        assert here.pull(weights, back).T @ dq == pytest.approx(forward + (back * momentum).sum())
