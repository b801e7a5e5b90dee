"""Steps that do not converge are divided: laws of impact, gradients and error estimates hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth import nonsmooth_run
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.results.status import Outcome, Status

STEP, FALL, RESTITUTION = 4e-3, 0.1, 0.5
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


@pytest.fixture(params=[1, 2])
def failing(request, monkeypatch):
    """Every third step fails, down to steps of half or of a quarter of the length."""
    original, shortest = NonsmoothRun.failure, STEP / 2**request.param

    def failure(self, t, h, result, log):
        if round(t // STEP) % 3 == 1 and h > 1.5 * shortest:
            return Status(Outcome.NOT_CONVERGED, "for the test", t, 1.0)
        return original(self, t, h, result, log)

    monkeypatch.setattr(NonsmoothRun, "failure", failure)
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    return request.param


def bouncing(fall: float = FALL, restitution: float = RESTITUTION) -> da.Model:
    """A disc that falls on a floor, with a spin and friction."""
    system = da.System("bouncing", gravity=(0.0, -9.81))
    fall = system.parameter("fall", fall, "m")
    restitution = system.parameter("restitution", restitution)
    kit = planar.contact
    start = {"position": (0.0, 0.1 + fall), "velocity": (0.3, 0.0), "angular_velocity": 2.0}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.005, **start))
    shapes = [kit.Circle(disc.center, 0.1), kit.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hits", shapes, restitution=restitution, friction=0.3))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("fall", [0.1, 0.1003, 0.1011, 0.1024, 0.104])
def test_newtons_law_holds_beside_divided_steps(scheme, fall, failing):
    motion = da.solve_nonsmooth(bouncing(fall), 0.448, step=STEP, integrator=scheme)
    assert motion.status.success
    lengths = np.diff(motion.record.t)
    assert lengths.min() == pytest.approx(STEP / 2**failing)
    assert motion.statistics["divisions of steps"] == lengths.size - round(0.448 / STEP)
    speed, hits = motion.record.ends.v[1], np.unique(motion.record.step)
    first = hits[0]
    before, after = speed[first], speed[first + 1]
    assert before < -1.0
    assert after == pytest.approx(-RESTITUTION * before, rel=1e-7)
    assert motion.record.penetration.max() < 1e-10


@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["direct", "adjoint"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradients_of_an_impact_beside_divided_steps(scheme, method, failing):
    """``y = r + e v (T − t₁) − g/2 (T − t₁)²`` after the first impact, ``v = g t₁``."""
    g, time = 9.81, 0.24
    motion = da.solve_nonsmooth(bouncing(), time, step=STEP, integrator=scheme)
    gradient = da.sensitivity(motion, da.final("disc.y"), method=method).values.ravel()
    fall = np.sqrt(2 * FALL / g)
    rest, by_fall = time - fall, fall / (2 * FALL)
    slope = RESTITUTION * g * (rest - fall) + g * rest
    expected = slope * by_fall, g * fall * rest
    assert gradient == pytest.approx(expected, rel=0.03)


@pytest.mark.thorough
@pytest.mark.parametrize("method", ["direct", "adjoint"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradients_of_lasting_contacts_beside_divided_steps(scheme, method, failing):
    """A disc slides on a floor, and begins to roll."""
    system, kit = da.System("sliding", gravity=(0.0, -9.81)), planar.contact
    speed, friction = system.parameter("speed", 1.0, "m/s"), system.parameter("friction", 0.2)
    start = {"position": (0.0, 0.1), "velocity": (speed, 0.0)}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.005, **start))
    shapes = [kit.Circle(disc.center, 0.1), kit.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("floor", shapes, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=STEP, integrator=scheme)
    assert motion.statistics["divisions of steps"] > 0
    responses = [da.final("disc.x"), da.final("disc.angle"), da.final("disc.vx")]
    gradient = da.sensitivity(motion, responses, method=method).values
    expected = da.sensitivity(motion, responses, method=da.FiniteDifference("richardson")).values
    np.testing.assert_allclose(gradient, expected, rtol=1e-5, atol=1e-6 * abs(expected).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("fall", [0.01, 0.03, 0.05])
@pytest.mark.parametrize("restitution", [0.2, 0.4])
def test_gradients_of_a_disc_that_comes_to_rest_in_divided_steps(fall, restitution, failing):
    """Gaps leave room for a next step whose length differs from step to step."""
    motion = da.solve_nonsmooth(bouncing(fall, restitution), 0.4, step=STEP)
    assert motion.statistics["divisions of steps"] > 0
    assert np.unique(motion.record.longest.round(9)).size > 1
    responses = [da.final("disc.x"), da.final("disc.angle")]
    direct, adjoint = (
        da.sensitivity(motion, responses, method=method).values for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(adjoint, direct, rtol=1e-9, atol=1e-9 * abs(direct).max())


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_estimate_is_that_of_the_times_of_the_run(scheme, failing):
    motion = da.solve_nonsmooth(bouncing(), 0.1, step=STEP, integrator=scheme)  # in flight
    assert motion.status.success and not motion.record.key.size
    assert motion.error_estimate.share < 1e-9


@pytest.mark.parametrize("scheme", SCHEMES)
def test_positions_of_steps_that_are_divided_are_not_corrected(scheme, monkeypatch):
    """Steps whose means over their paths do not converge are divided at once."""
    corrected, advance, correction = [], nonsmooth_run.advance, NonsmoothRun.corrected

    def inexact(step, t, h, *state):
        result = advance(step, t, h, *state)
        return replace(result, path_change=1.0 if h > 0.75 * STEP else 0.0)

    def counted(self, t, h, result):
        corrected.append(h)
        return correction(self, t, h, result)

    monkeypatch.setattr(nonsmooth_run, "advance", inexact)
    monkeypatch.setattr(NonsmoothRun, "corrected", counted)
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    motion = da.solve_nonsmooth(bouncing(), 10 * STEP, step=STEP, integrator=scheme)
    assert motion.statistics["divisions of steps"] == 10
    assert corrected == pytest.approx([STEP / 2] * 20)


def test_the_least_step_that_fails_is_named(monkeypatch):
    original = NonsmoothRun.failure

    def failure(self, t, h, result, log):
        result = original(self, t, h, result, log)
        text = f"none in steps of {h:.3g} s"
        return Status(Outcome.NOT_CONVERGED, text, t, 1.0) if t > 2 * STEP else result

    monkeypatch.setattr(NonsmoothRun, "failure", failure)
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    motion = da.solve_nonsmooth(bouncing(), 0.1, step=STEP)
    assert motion.status.outcome is Outcome.NOT_CONVERGED
    assert f"{STEP / 64:.3g} s" in str(motion.status)
    assert motion.record.t[-1] == pytest.approx(3 * STEP, abs=STEP)
