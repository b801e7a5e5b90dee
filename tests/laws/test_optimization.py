"""What an optimisation tells of its way."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.design.optimize import problem


def test_every_iteration_is_recorded_whether_or_not_it_improves():
    """Along a circle of equal speed every step leaves the limit that the start keeps."""
    system = da.System("thrown", gravity=(0.0, -10.0))
    speed = [system.parameter(name, 1.0, bounds=(0.1, 9.0)) for name in ("vx", "vy")]
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=speed))
    messages: list[tuple[int, float]] = []
    best = da.optimize(
        system.build(),
        maximize=da.final(ball.x + ball.y, name="reach"),
        subject_to=[da.Limit(da.at(0.0, ball.vx**2 + ball.vy**2, name="speed²"), 25.0, 25.0)],
        analysis=da.Dynamics(0.5, step=0.05),
        start={"vx": 3.0, "vy": 4.0},
        progress=lambda number, objective: messages.append((number, objective)),
    )
    assert best.success
    np.testing.assert_allclose(list(best.x.values()), 5 / math.sqrt(2), rtol=1e-6)
    designs = [tuple(i.parameters.values()) for i in best.history]
    assert designs[0] == (3.0, 4.0) and designs[-1] == tuple(best.x.values())
    assert len(designs) > 4 and len(set(designs)) == len(designs)
    assert messages == [(k, i.objective) for k, i in enumerate(best.history)][1:]
    for (vx, vy), evaluation in zip(designs, best.history, strict=True):
        assert evaluation.objective == pytest.approx((vx + vy) / 2 - 1.25)
        assert evaluation.violation == pytest.approx(abs(vx**2 + vy**2 - 25) / 25, abs=1e-12)


@pytest.mark.parametrize("at", ["run", "gradient"])
def test_an_interrupt_keeps_the_design_reached(monkeypatch, at):
    """Ctrl-C in a later run or gradient; in the first one there is nothing to keep."""
    name = {"run": "_run", "gradient": "gradient_values"}[at]
    owner = problem.DesignProblem if at == "run" else problem
    honest, calls, messages = getattr(owner, name), [0], []

    def stopped(*arguments):
        calls[0] += 1
        if calls[0] == last:
            raise KeyboardInterrupt
        return honest(*arguments)

    system = da.System("thrown", gravity=(0.0, -10.0))
    speed = [system.parameter(name, 1.0, bounds=(0.1, 9.0)) for name in ("vx", "vy")]
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=speed))
    model, goal = system.build(), da.final((ball.x - 1.2) ** 2 + (ball.y - 0.3) ** 4, name="miss")
    monkeypatch.setattr(owner, name, stopped)

    def optimum() -> da.OptimizationResult:
        calls[0] = 0
        analysis = da.Dynamics(0.5, step=0.05)
        follow = {"progress": lambda number, objective: messages.append(objective)}
        return da.optimize(model, minimize=goal, analysis=analysis, **follow)

    last = 4
    best = optimum()
    assert not best.success and best.interrupted and best.message.startswith("interrupted after")
    assert len(best.history) > 1 and best.history[-1].parameters == best.x
    assert best.fun == messages[-1] < best.history[0].objective
    motion = da.solve_dynamics(model, 0.5, step=0.05, parameters=best.x)
    assert best.fun == pytest.approx(da.evaluate(motion, goal), rel=1e-12)
    last = 1
    with pytest.raises(KeyboardInterrupt):
        optimum()
