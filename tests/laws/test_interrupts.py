"""Law of Ctrl-C: a task ends with what it has, says so, and loses nothing that is finished."""

from __future__ import annotations

import contextlib
import os
import signal

import numpy as np
import pytest
from interrupted_commands import COMMANDS, interrupted_after

import dalembert as da
from dalembert import structures
from dalembert.design.optimize import optimization
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

    synthesis = da.synthesize(da.Target.path(POINTS), starts=4, progress=pressed)
    assert synthesis.interrupted and not synthesis.success and synthesis.starts < 4
    assert "interrupted" in synthesis.message and len(synthesis.solutions) == 1
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


@pytest.mark.few(2)
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


@pytest.mark.few(1)
@pytest.mark.skipif(os.name == "nt", reason="needs an interrupt signal")
@pytest.mark.parametrize("name", ["synthesize", "optimize slsqp"])
def test_commands_at_a_random_moment(name, tmp_path):
    """A sample of ``python -m tests.interrupted_commands``."""
    wait = float(np.random.default_rng().uniform(0.6, 3.0))
    assert not list(interrupted_after(wait, COMMANDS[name], tmp_path))
