"""Law of Ctrl-C: a task ends with what it has, says so, and loses nothing that is finished."""

from __future__ import annotations

import contextlib
import os
import signal

import numpy as np
import pytest
from interrupted_commands import COMMANDS, interrupted_after

import dalembert as da
from dalembert import planar, structures
from dalembert.design.optimize import optimization
from dalembert.integrators.marching.checkpoints import Recorder
from dalembert.interrupts import check_ctrl_c, ctrl_c, defer_ctrl_c, searching

POINTS = [(20, 20 + 5 * k) for k in range(6)]


def rod() -> dict:
    """The area of a rod under tension."""
    structure = da.Structure("rod")
    area = structure.parameter("area", 1e-3, "m^2", bounds=(1e-5, 1e-2))
    top, end = structure.node("top", 0), structure.node("end", 2)
    structure.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    structure.support(top)
    structure.load(end, fx=5e4)
    strong = da.Limit(da.final("rod.stress"), upper=1e8)
    task = {"minimize": da.final("mass"), "subject_to": [strong], "analysis": da.Statics()}
    return {"model": structure.build()} | task


def test_a_search_that_swallows_the_exception_is_ended():
    """Compiled code loses ``KeyboardInterrupt``; the signal is counted all the same."""

    def pressed(fraction: float) -> None:
        with contextlib.suppress(KeyboardInterrupt):  # as Ipopt does
            signal.raise_signal(signal.SIGINT)

    turn = np.linspace(0.0, 1.0, 6)
    synthesis = da.synthesize(da.Target.function(turn, turn**2), starts=4, progress=pressed)
    assert synthesis.interrupted and not synthesis.success and synthesis.starts < 4
    assert len(synthesis.solutions) == 1
    assert synthesis.message.endswith(f"; interrupted after {synthesis.starts} of 4 starts")


def test_a_signal_while_starts_are_selected_ends_the_search():
    """There is no result yet; the exception that the callback swallows is raised again."""
    fractions = []

    def pressed(fraction: float) -> None:
        fractions.append(fraction)
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        da.synthesize(da.Target.path(POINTS), starts=4, progress=pressed)
    assert max(fractions) < 1.0
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_another_exception_in_its_place_is_an_interrupt():
    def converted() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise NotImplementedError("Wrong number or type of arguments") from None

    with ctrl_c(), pytest.raises(KeyboardInterrupt), searching():
        converted()
    with ctrl_c(), pytest.raises(NotImplementedError), searching():
        raise NotImplementedError  # nothing was pressed


@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["slsqp", "ipopt", "mma", "multistart"])
def test_after_the_last_iteration_the_optimum_is_kept(method, monkeypatch):
    original = optimization.verified_optimum

    def pressed(*arguments):
        signal.raise_signal(signal.SIGINT)
        return original(*arguments)

    monkeypatch.setattr(optimization, "verified_optimum", pressed)
    best = da.optimize(**rod(), method=method)
    assert best.interrupted and best.success and best.fun == pytest.approx(7.85, rel=1e-6)


@pytest.mark.parametrize("method", ["slsqp", "ipopt", "mma", "trust-constr", "multistart"])
def test_in_the_second_iteration_the_design_reached_is_kept(method):
    def pressed(number: int, value: float) -> None:
        if number == 2:
            signal.raise_signal(signal.SIGINT)

    best = da.optimize(**rod(), method=method, progress=pressed)
    assert best.interrupted and not best.success and "interrupted after 2" in best.message


def test_a_signal_between_the_records_of_a_step_keeps_all_steps(monkeypatch):
    """Times and states are appended one after the other; a signal ends the run after both."""
    original = Recorder.add

    def add(self, ends, columns):
        if self.count:
            os.kill(os.getpid(), signal.SIGINT)
        original(self, ends, columns)

    system = da.System("pendulum", gravity=(0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    model = system.build()
    for integrator in (da.DormandPrince(), da.RK4()):
        options = {"integrator": integrator} | ({} if integrator.adaptive else {"step": 1e-3})
        with monkeypatch.context() as patch, ctrl_c():
            patch.setattr(Recorder, "add", add)
            motion = da.solve_dynamics(model, 1000.0, **options)
        assert motion.status.outcome is da.Outcome.INTERRUPTED
        assert 0 < motion.time[-1] < 1000.0


def test_a_second_signal_ends_at_once():
    with ctrl_c() as signals:
        defer_ctrl_c()
        signal.raise_signal(signal.SIGINT)
        assert signals.pressed
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_nested_tasks_count_for_themselves():
    with ctrl_c() as outer:
        with ctrl_c() as inner:
            defer_ctrl_c()
            signal.raise_signal(signal.SIGINT)
            assert inner.pressed and outer.pressed
        with pytest.raises(KeyboardInterrupt):
            check_ctrl_c()
    check_ctrl_c()  # no task, nothing to raise


@pytest.mark.thorough
@pytest.mark.skipif(os.name == "nt", reason="needs an interrupt signal")
@pytest.mark.parametrize("name", ["synthesize", "optimize slsqp"])
def test_commands_at_a_random_moment(name, tmp_path):
    """A sample of ``python -m tests.interrupted_commands``."""
    wait = float(np.random.default_rng().uniform(0.6, 3.0))
    assert not list(interrupted_after(wait, COMMANDS[name], tmp_path))


def pressed_at(count: int):
    """Progress that presses Ctrl-C at a call."""
    calls = []

    def report(*numbers: float) -> None:
        calls.append(numbers)
        if len(calls) == count:
            signal.raise_signal(signal.SIGINT)

    return report


def test_an_interrupted_optimum_claims_no_optimum():
    best = da.optimize(**rod(), progress=pressed_at(2))
    assert best.sentence.endswith("interrupted before the optimum")
    labels = best.live_task().page()["designs"]["labels"]
    assert labels[0] == "start" and "optimum" not in labels


def test_the_first_design_of_an_interrupted_front_is_not_best_in_all_aims():
    find = rod()
    aims = [find["minimize"], da.final("rod.stress")]
    front = da.pareto(find["model"], aims, analysis=da.Statics(), progress=pressed_at(1))
    assert len(front) == 1 and front.interrupted
    assert front.sentence == "one design so far (normal-constraint; interrupted after 1 search)"


def test_an_interrupted_reliability_names_the_limits_searched():
    random = {"r": da.Normal(10.0, 2.0), "s": da.Normal(4.0, 1.5)}
    result = da.reliability(None, ["r - s", "9 - s"], random, progress=pressed_at(1))
    assert result.message == "interrupted; only 1 of 2 limits searched"
    both = da.reliability(None, ["r - s", "9 - s"], random, progress=pressed_at(2), samples=1000)
    assert both.message == "interrupted after the search of the design points"
    assert both.beta < result.beta


def test_an_interrupted_identification_shows_no_intervals():
    """The speed is 3 m/s; the first iteration is at the start."""
    system = da.System("throw")
    v = system.parameter("v", 1.0, "m/s", bounds=(0, 10))
    system.add(planar.Particle("stone", mass=2.0, velocity=(v, 0)))
    data = {"time": np.linspace(0, 2, 21), "stone.x": 3.0 * np.linspace(0, 2, 21)}
    result = da.identify(system.build(), data, vary=["v"], progress=pressed_at(1))
    assert result.message == "interrupted after 1 iteration"
    assert "not meaningful away from the minimum" in result.notes[0]
    table = next(view for view in result.page()["views"] if view.get("title") == "Unknowns")
    assert table["heads"] == ["Start", "Reached"]
    assert [len(row["cells"]) for row in table["rows"]] == [2]
