"""Law of all models with contacts: the derivative of each step is that of its differences.

States and parameters change in random directions. Steps in which a contact changes its state near
by have no derivative; the second difference identifies them. Where contacts change in a solution on
whose path means of concave gaps are taken, the second difference is small, and the derivative is
that of one side: it differs from the central difference by half of the second one.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.moving_impacts import push_maps
from tests.registry.contact_models import CONTACT_MODELS

SCHEMES = {
    "anticipated": da.AnticipatedImpacts(),
    "Moreau": da.MoreauJean(projection=False),
    "implicit": da.MoreauJean(theta=0.8, projection=False),
}
EPSILON, KINK = 1e-6, 1e-3
"""Step of the differences; largest ratio of second to first differences of a smooth step."""


class Repeated:
    """Steps of a run from nearby states, with nearby parameters.

    Parameters
    ----------
    motion : NonsmoothMotion
    """

    def __init__(self, motion):
        self.motion, self.steps = motion, ContactSteps(motion)
        self.size, self.before = self.steps.size, None
        self.manifold = motion.model.equations.manifold

    def run(self, p: np.ndarray) -> NonsmoothRun:
        return NonsmoothRun(self.motion.analysis, self.motion.model, p)

    def end(self, k: int, x: np.ndarray, p: np.ndarray, last: bool = False) -> np.ndarray:
        """State after step ``k``; the ``last`` call starts the next step."""
        (t, h), run = self.steps.span(k), self.run(p)
        result = advance(run.step, t, h, x[: self.size], x[self.size :], self.before)
        position = run.corrected(t + h, h, result)
        speeds = run.speeds(t, h, position.x, result)[0].v
        if last:
            self.before = result
        return np.concatenate([position.x, speeds])

    def direction(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Random changes of positions, speeds and parameters."""
        p = self.steps.p
        way, speeds = rng.normal(size=(2, self.steps.x.shape[0] - self.size))
        return way, speeds, rng.normal(size=p.size) * np.maximum(np.abs(p), 0.1)

    def errors(
        self,
        k: int,
        way: np.ndarray,
        speeds: np.ndarray,
        change: np.ndarray,
        epsilon: float = EPSILON,
    ) -> tuple[float, float]:
        """Relative error of the derivative of a step in a direction, and second difference."""
        x, p = self.steps.x[:, k], self.steps.p
        ends = []
        for s in (epsilon, 0.0, -epsilon):
            moved = self.manifold.go(x[: self.size], s * way)
            state = np.concatenate([moved, x[self.size :] + s * speeds])
            ends.append(self.end(k, state, p + s * change))
        first = (ends[0] - ends[2]) / (2 * epsilon)
        second = (ends[0] - 2 * ends[1] + ends[2]) / epsilon
        rate = self.steps.maps.equations.rates(0.0, x[: self.size], way, p)[0].ravel()
        dx = np.concatenate([rate, speeds])[:, None]
        exact = push_maps(self.steps.at(k), dx, 0.0, change[:, None]).ravel()
        scale = 1 + np.abs(first).max()
        return np.abs(exact - first).max() / scale, np.abs(second).max() / scale


def check_steps(name: str, scheme: str, each: int) -> None:
    """Differences of one in ``each`` steps, and of all in which contacts close or open."""
    case = CONTACT_MODELS[name]
    solver = da.ContactSolver(tolerance=1e-13)
    options = {"step": case.step, "integrator": SCHEMES[scheme], "solver": solver}
    motion = da.solve_nonsmooth(case.build(), case.duration, **options)
    assert motion.status.success
    repeated, rng, smooth, before = Repeated(motion), np.random.default_rng(5), 0, 0
    for k in range(repeated.steps.count):
        pressing = repeated.steps.active(k).keys.size
        direction = repeated.direction(rng) if pressing else ()
        if pressing and (k % each == 0 or pressing != before):
            error, kink = repeated.errors(k, *direction)
            if kink < KINK and error > 1e-6:  # of second order in the step of the differences
                error, kink = repeated.errors(k, *direction, EPSILON / 4)
            smooth += kink < KINK
            one_sided = abs(error - kink / 2) < 1e-3 * kink
            assert error < 1e-6 or kink > KINK or one_sided, f"step {k}"
        before = pressing
        repeated.end(k, repeated.steps.x[:, k], repeated.steps.p, last=True)
    assert smooth >= 1


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_derivative_of_a_step_is_that_of_its_differences(name, scheme):
    check_steps(name, scheme, 4)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", CONTACT_MODELS)
def test_derivative_of_every_step_is_that_of_its_differences(name, scheme):
    check_steps(name, scheme, 1)
