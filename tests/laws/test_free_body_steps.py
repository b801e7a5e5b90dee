"""Steps of balls, hulls and walls in one call of machine code: the same as the general steps."""

import numpy as np
import pytest
from free_body_scenes import (
    both_ways,
    falling_boxes,
    planar_hulls,
    planar_scene,
    spatial_hulls,
    spatial_scene,
    turning_wall,
    two_boxes,
)
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth import nonsmooth_run
from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.free_bodies import free_body_march, free_body_steps
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.analysis.nonsmooth.free_bodies.path_repeats import PathRepeats
from dalembert.analysis.nonsmooth.step_state import LastImpulses, StepResult
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.solution_settings import SOLUTION_COUNTS
from dalembert.integrators.contact.step_calls import StepOutcome
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps

SEEDS = sampled(range(6), 3)  # on a push one without and one with friction of rolling
EDGES = 3
"""Kind of the gap of two edges that cross, in descriptions of gaps."""
AGREEMENT = {"y": 2e-8, "v": 2e-6}
"""Differences relative to the largest value: tolerances of impulses accumulate, and differences of
gaps count as speeds by the length of a step."""


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("scene", [planar_scene, spatial_scene])
def test_steps_in_machine_code_are_the_general_steps(scene, seed, monkeypatch):
    model = scene(seed)
    compiled, general = both_ways(model, monkeypatch, duration=0.4, step=1e-3)
    compare(compiled, general)
    own, other = compiled.record, general.record
    first, second = (np.lexsort((record.key, record.step)) for record in (own, other))
    assert np.array_equal(own.step, other.step)
    assert np.array_equal(own.key[first], other.key[second])
    allowed = 4e-6 * np.abs(other.impulse).max()
    assert own.impulse[first] == pytest.approx(other.impulse[second], abs=allowed)


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("scene", [planar_hulls, spatial_hulls])
def test_steps_of_hulls_are_the_general_steps(scene, seed, monkeypatch):
    """Impulses at several points of a face are not unique, but the speeds they cause are, until
    differences of impulses select other offsets, here after 0.1 s. Closed gaps take no general
    steps."""
    model, calls, original = scene(seed), [], nonsmooth_run.advance

    def counted(*arguments):
        calls.append(arguments[1])
        return original(*arguments)

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    compiled = da.solve_nonsmooth(model, 0.1, step=1e-3)
    assert len(calls) < 5
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    compare(compiled, da.solve_nonsmooth(model, 0.1, step=1e-3), unique=scene is planar_hulls)


@pytest.mark.few(1)
@pytest.mark.parametrize(("seed", "steps"), [(1588, 45), (2421, 45)])
def test_edges_that_were_closed_before_need_no_general_step(seed, steps, monkeypatch):
    """Edges of boxes that cross within a step may be closed at its start, where faces separate the
    boxes: gaps of these take part in its repetition."""
    model, calls, original = two_boxes(seed), [], nonsmooth_run.advance
    closed, separating = [], PathRepeats._separating
    unsolved, attempt = [], FreeBodyMarch._attempt

    def counted(*arguments):
        calls.append(arguments[1])
        return original(*arguments)

    def seen(self, place, displacement, described):
        found = separating(self, place, displacement, described)
        closed.append((described[:, 0].tolist(), bool(found.size)))
        return found

    def attempted(self):
        outcome = attempt(self)
        unsolved.extend([float(self._t[0])] * (outcome is StepOutcome.UNSOLVED))
        return outcome

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    monkeypatch.setattr(PathRepeats, "_separating", seen)
    monkeypatch.setattr(FreeBodyMarch, "_attempt", attempted)
    compiled = da.solve_nonsmooth(model, 4e-3 * steps, step=4e-3)
    assert closed == [([EDGES], True)]
    # the first step, perhaps the last one, and those with impulses out of reach, by rounding
    assert set(calls) <= {0.0, compiled.record.t[-2], *unsolved} and len(unsolved) <= 1
    assert compiled.statistics["maximum penetration [m]"] <= 1e-9 * 0.1
    assert compiled.record.loss.min() >= -1e-10 * 10.0  # their energy is some joules
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    compare(compiled, da.solve_nonsmooth(model, 4e-3 * steps, step=4e-3), pressing=2)


def compare(
    compiled: NonsmoothMotion, general: NonsmoothMotion, pressing: int = 3, unique: bool = True
) -> None:
    """Compare states and dissipated energies of runs in which some contacts press at a time; the
    part of friction, which depends on the impulses, only where these are unique."""
    assert compiled.status.success and general.status.success
    for name, tolerance in AGREEMENT.items():
        ours, theirs = (getattr(run.record.ends, name) for run in (compiled, general))
        assert ours == pytest.approx(theirs, abs=tolerance * np.abs(theirs).max())
    own, other = compiled.record, general.record
    assert other.pressing.max() >= pressing
    assert own.loss == pytest.approx(other.loss, abs=2e-6 * np.abs(other.loss).max())
    name = "energy dissipated by friction of contacts [J]"
    if unique:
        assert compiled.statistics[name] == pytest.approx(general.statistics[name], rel=4e-6)


@pytest.mark.parametrize(
    "limits",
    [
        {"CHUNK": 7, "RECORDS": 12},
        {"NEWTON_STEPS": 2, "MANY_PROXIMAL": 0},
    ],
    ids=["short records", "failing solutions"],
)
def test_steps_go_on_beyond_the_limits_of_machine_code(limits, monkeypatch):
    """Full records are transferred; where the impulses do not converge the general step follows."""
    model = planar_scene(0)
    general = da.solve_nonsmooth(model, duration=0.3, step=1e-3)
    for name, value in limits.items():
        owners = [owner for owner in (free_body_steps, free_body_march) if hasattr(owner, name)]
        assert owners
        for owner in owners:
            monkeypatch.setattr(owner, name, value)
    if "NEWTON_STEPS" in limits:
        monkeypatch.setitem(SOLUTION_COUNTS, Counts.MAX_INTERIOR, 0)
    limited = da.solve_nonsmooth(model, duration=0.3, step=1e-3)
    assert limited.status.success
    for name, tolerance in AGREEMENT.items():
        ours, theirs = (getattr(run.record.ends, name) for run in (limited, general))
        assert ours == pytest.approx(theirs, abs=tolerance * np.abs(theirs).max())
    assert np.array_equal(limited.record.key, general.record.key)


@pytest.mark.few(1)
@pytest.mark.parametrize("scene", [planar_scene, spatial_scene])
def test_interior_points_solve_what_newtons_method_does_not(scene, monkeypatch):
    """One step of Newton's method solves few problems; interior points solve the others."""
    model, calls, original = scene(0), [], nonsmooth_run.advance
    usual = da.solve_nonsmooth(model, 0.3, step=1e-3)

    def counted(*arguments):
        calls.append(arguments[1])
        return original(*arguments)

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    for name, value in {"NEWTON_STEPS": 1, "MANY_PROXIMAL": 0}.items():
        monkeypatch.setattr(free_body_steps, name, value)
    central = da.solve_nonsmooth(model, 0.3, step=1e-3)
    few = len(calls)
    monkeypatch.setitem(SOLUTION_COUNTS, Counts.MAX_INTERIOR, 0)
    da.solve_nonsmooth(model, 0.3, step=1e-3)
    assert few < 5 < len(calls) - few
    for name, tolerance in AGREEMENT.items():
        ours, theirs = (getattr(run.record.ends, name) for run in (central, usual))
        assert ours == pytest.approx(theirs, abs=tolerance * np.abs(theirs).max())


@pytest.mark.parametrize("step", [1e-2, 2e-3])
def test_a_capsule_rolls_without_slip_though_steps_are_repeated(step):
    """Its two contacts close within rounding, at turns of up to 0.2 rad per step."""
    angle, radius, duration = np.radians(20), 0.05, 0.6
    gravity = (9.81 * np.sin(angle), 0.0, -9.81 * np.cos(angle))
    system = da.System("incline", gravity=gravity)
    inertia = (0.01, radius**2 / 2, 0.01)
    body = spatial.Body("b", mass=1.0, inertia=inertia, position=(0, 0, radius))
    system.add(body)
    ends = body.point(0, -0.15, 0), body.point(0, 0.15, 0)
    floor = spatial.contact.HalfSpace(system.ground.frame())
    shapes = [spatial.contact.Capsule(*ends, radius), floor]
    system.add(spatial.Collisions("floor", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), duration, step=step)
    speed = motion.values("b.vx")
    assert speed == pytest.approx(gravity[0] / 1.5 * motion.time, abs=1e-9)
    assert motion.values("b.angular_velocity")[:, 1] * radius == pytest.approx(speed, abs=1e-9)


def test_steps_that_close_gaps_are_repeated_by_the_general_step(monkeypatch):
    model, calls = turning_wall(), []
    original = nonsmooth_run.advance

    def counted(*arguments):
        calls.append(arguments[1])
        return original(*arguments)

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    compiled = da.solve_nonsmooth(model, 0.3, step=1e-3)
    repeated = len(calls)
    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    general = da.solve_nonsmooth(model, 0.3, step=1e-3)
    assert 1 < repeated < 300 and len(calls) == repeated + 300
    for name, tolerance in AGREEMENT.items():
        ours, theirs = (getattr(run.record.ends, name) for run in (compiled, general))
        assert ours == pytest.approx(theirs, abs=tolerance * np.abs(theirs).max())
    assert np.array_equal(compiled.record.curved, general.record.curved)
    assert general.record.curved.any()


def general_step(steps: ContactSteps, number: int) -> StepResult:
    """A recorded step by the general function."""
    active = steps.active(number - 1)
    last = LastImpulses((active.keys, active.impulses), active.keys[:0])
    return advance(steps.step, *steps.span(number), *steps.split(number), last)


@pytest.mark.thorough
def test_repetitions_end_where_they_open_no_gaps():
    """Edges of two boxes cross at the end of a step, and beyond their ends at its start: no contact
    separates them there. The same contacts with another path would open the gap no further: the
    correction of positions opens it."""
    motion = da.solve_nonsmooth(falling_boxes(12, 29), 0.06, step=1e-3)
    assert len(motion.record.paths[51].solutions) == 3
    assert motion.record.penetration.max() <= 1e-10
    steps = ContactSteps(motion)
    general, end = general_step(steps, 51), steps.x[: steps.size, 52]
    gap = steps.step.deepest(steps.step.at(0.052, general.y))
    assert gap < -1e-5 and np.abs(end - general.y).max() > -gap


@pytest.mark.thorough
@pytest.mark.parametrize(("seed", "instant"), [(1, 49), (4, 98), (6, 101)])
def test_positions_are_corrected_without_general_steps(seed, instant, monkeypatch):
    """Repetitions with the same contacts do not open an edge between boxes: its position is
    corrected as after the general step, and the speeds are those of the repeated step."""
    calls, original = [], nonsmooth_run.advance
    corrected, correction = [], FreeBodyMarch._corrected

    def counted(*arguments):
        calls.append(round(arguments[1] / 1e-3))
        return original(*arguments)

    def seen(self, grid, k, *others):
        accepted = correction(self, grid, k, *others)
        corrected.append((k, accepted))
        return accepted

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    monkeypatch.setattr(FreeBodyMarch, "_corrected", seen)
    solver = da.ContactSolver(tolerance=1e-11)
    motion = da.solve_nonsmooth(
        falling_boxes(64, seed), 1e-3 * (instant + 1), step=1e-3, solver=solver
    )
    assert corrected == [(instant, True)] and instant - 1 not in calls
    assert motion.record.penetration.max() <= 1e-10
    steps, number = ContactSteps(motion), instant - 1
    end = steps.x[: steps.size, instant]
    uncorrected = steps.step.model.equations.manifold.go(
        steps.x[: steps.size, number], 1e-3 * steps.x[steps.size :, instant]
    )
    assert steps.step.deepest(steps.step.at(1e-3 * instant, uncorrected)) < -1e-9
    assert end != pytest.approx(uncorrected, abs=1e-9)
    direct, adjoint = (
        da.sensitivity(motion, da.final("box3.x"), method=method).values
        for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(adjoint, direct, rtol=1e-6, atol=1e-9)


def test_an_interrupted_run_keeps_its_steps():
    def stop(fraction: float) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    motion = da.solve_nonsmooth(planar_scene(0), 0.4, step=1e-3, progress=stop)
    assert not motion.status.success
    assert 0.2 <= motion.record.t[-1] <= 0.22
    assert motion.record.loss.size == motion.record.t.size - 1


@pytest.mark.few(2)
@pytest.mark.parametrize(("seed", "number"), [(7, 88), (10, 79), (14, 109), (16, 159), (24, 117)])
def test_repeated_steps_of_passing_bodies_are_the_general_steps(seed, number):
    """Discs that pass each other in a step that is repeated with means over its path."""
    system, kit = da.System("discs", gravity=(0.0, -9.81)), planar.contact
    rng, shapes = np.random.default_rng(seed), []
    for k in range(24):
        place = (0.12 + 0.23 * (k % 4) + 0.02 * rng.random(), 0.15 + 0.25 * (k // 4))
        start = {"position": place, "velocity": tuple(1.5 * rng.normal(size=2))}
        body = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.005, **start))
        shapes.append(kit.Circle(body.center, 0.1))
    right = system.ground.point(0.96, 0.0)
    walls = (system.ground.center, (0, 1)), (system.ground.center, (1, 0)), (right, (-1, 0))
    shapes += [kit.HalfPlane(point, normal) for point, normal in walls]
    system.add(planar.Collisions("hits", shapes, friction=0.3))
    solver = da.ContactSolver(tolerance=1e-10)
    steps = ContactSteps(da.solve_nonsmooth(system.build(), 0.4, step=2e-3, solver=solver))
    general = general_step(steps, number)
    assert general.v == pytest.approx(steps.x[steps.size :, number + 1], abs=1e-7)
