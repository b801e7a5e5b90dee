"""Law of runs with contacts: steps linearised together have the derivatives of single steps."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert.sensitivity.nonsmooth import free_steps
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.moving_impacts import single_tangent, step_tangent
from dalembert.sensitivity.nonsmooth.near_impacts import UNRESOLVED
from tests.registry.contact_models import CONTACT_MODELS

STACKED = {
    "bouncing ball": 0.1,
    "rocking block": 0.05,
    "discs in a box": 0.02,
    "discs of many sizes": 0.03,
    "spheres that roll": 0.06,
    "ball and box in space": 0.1,
}
"""Models, and durations of their runs [s]."""


@pytest.mark.few(2)
@pytest.mark.parametrize("name", STACKED)
def test_steps_together_are_those_one_by_one(name):
    case = CONTACT_MODELS[name]
    motion = da.solve_nonsmooth(case.build(), STACKED[name], step=case.step)
    steps, rng, stacked = ContactSteps(motion), np.random.default_rng(3), 0
    columns = steps.x.shape[0], steps.p.size
    dx, dp = (rng.normal(size=(n, 2)) for n in columns)
    weights = rng.normal(size=(columns[0], 2))
    for k in range(steps.count):
        if steps.stacks.at(k) is None:
            continue
        stacked += 1
        single = steps.maps.step(
            steps.x[:, k], steps.x[steps.size :, k + 1], *steps.span(k), steps.active(k)
        )
        pushed, pulled = single.push(dx, 0.7, dp), np.vstack(single.pull(weights))
        for whole in {False, steps.stacked_impacts(k) is not None}:
            (own,) = steps.at(k, whole)
            for values, exact in (
                (own.push(dx, 0.7, dp), pushed),
                (np.vstack(own.pull(weights)), pulled),
            ):
                scale = np.abs(exact).max()
                np.testing.assert_allclose(values, exact, rtol=0, atol=1e-9 * scale)
            assert own.consistent == single.consistent
    assert stacked > steps.count // 2


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "solved"),
    [
        ("bouncing ball", True),
        ("discs of many sizes", True),
        ("discs of many sizes", False),
        ("ball and box in space", True),
    ],
)
def test_impacts_together_are_those_one_by_one(name, solved, monkeypatch):
    if not solved:  # impulses together, so that those of each step follow
        monkeypatch.setattr(free_steps, "separate_solutions", lambda *_: None)
        monkeypatch.setattr(free_steps, "semismooth_newton", lambda _, guess, *limits: 0 * guess)
    case = CONTACT_MODELS[name]
    motion = da.solve_nonsmooth(case.build(), 2 * STACKED[name], step=case.step)
    steps, rng, moving = ContactSteps(motion), np.random.default_rng(4), 0
    columns = steps.x.shape[0], steps.p.size
    dx, dp = (rng.normal(size=(n, 2)) for n in columns)
    weights = rng.normal(size=(columns[0], 2))
    for k in range(steps.count):
        if steps.stacked_impacts(k) is None or steps.times_between[k] < UNRESOLVED:
            continue
        own, changes = step_tangent(steps, k), steps.changes[k]
        single = single_tangent(steps, k)
        assert changes == steps.changes[k]
        assert len(own.shifts) == len(single.shifts)
        moving += changes.impacts
        for values, exact in (
            (own.push(dx, dp), single.push(dx, dp)),
            (np.vstack(own.pull(weights)), np.vstack(single.pull(weights))),
        ):
            scale = np.abs(exact).max()
            np.testing.assert_allclose(values, exact, rtol=0, atol=1e-8 * scale)
    assert moving
