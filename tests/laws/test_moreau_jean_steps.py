"""Steps of ``MoreauJean`` for free bodies in machine code: the same as the general steps."""

import numpy as np
import pytest
from free_body_scenes import (
    both_ways,
    planar_hulls,
    planar_scene,
    spatial_hulls,
    spatial_scene,
    turning_wall,
)
from thorough import crossed

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth import nonsmooth_run
from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.free_bodies import (
    free_body_loop,
    free_body_steps,
    moreau_jean_march as march,
)
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.analysis.nonsmooth.step_state import LastImpulses
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.solution_settings import SOLUTION_COUNTS
from dalembert.results.nonsmooth_motion import NonsmoothMotion

EXACT = da.ContactSolver(tolerance=1e-12)
SCHEMES = [
    da.MoreauJean(),
    da.MoreauJean(theta=1.0),
    da.MoreauJean(theta=0.7, gamma=1.0),
    da.MoreauJean(projection=False),
    da.MoreauJean(gamma=0.0),
    da.MoreauJean(theta=0.0),
]
SAME = 1e-9
"""Difference relative to the largest value."""


@pytest.fixture
def general(monkeypatch) -> list[float]:
    """Times at which general steps began."""
    times, original = [], nonsmooth_run.advance

    def counted(*arguments):
        times.append(arguments[1])
        return original(*arguments)

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    return times


def assert_same(compiled: NonsmoothMotion, other: NonsmoothMotion) -> None:
    """States, energies, penetrations and work of corrections agree."""
    assert compiled.status.success and other.status.success
    for name in ("y", "v"):
        ours, theirs = (getattr(run.record.ends, name) for run in (compiled, other))
        assert ours == pytest.approx(theirs, abs=SAME * np.abs(theirs).max())
    own, record = compiled.record, other.record
    assert own.loss == pytest.approx(record.loss, abs=SAME * np.abs(record.loss).max())
    assert own.penetration == pytest.approx(record.penetration, abs=SAME * 0.1)
    work, theirs = own.ends.work, record.ends.work
    assert work == pytest.approx(theirs, abs=SAME * np.abs(theirs).max())
    name = "work of corrections of positions [J]"
    assert compiled.statistics[name] == pytest.approx(other.statistics[name], abs=1e-9)


def same_contacts(*runs: NonsmoothMotion) -> list[np.ndarray]:
    """Orders of the contacts of two runs by steps and keys, which are the same."""
    orders = [np.lexsort((run.record.key, run.record.step)) for run in runs]
    for name in ("step", "key"):
        first, second = (getattr(r.record, name)[o] for r, o in zip(runs, orders, strict=True))
        assert np.array_equal(first, second)
    return orders


SCENES = [(scene, seed) for scene in (planar_scene, spatial_scene) for seed in range(2)]


@pytest.mark.few(2)
@pytest.mark.parametrize(("scene", "seed", "scheme"), crossed(SCENES, SCHEMES))
def test_steps_in_machine_code_are_the_general_steps(scene, seed, scheme, general, monkeypatch):
    """Their impulses are unique, and their contacts the same; few steps are general ones."""
    options = {"integrator": scheme, "solver": EXACT, "duration": 0.4, "step": 1e-3}
    compiled, other = both_ways(scene(seed), monkeypatch, **options)
    assert len(general) < 400 + 20
    assert_same(compiled, other)
    own, theirs = compiled.record, other.record
    first, second = same_contacts(compiled, other)
    assert np.array_equal(own.kept[first], theirs.kept[second])
    for name in ("impulse", "offset"):
        ours, others = getattr(own, name)[first], getattr(theirs, name)[second]
        assert ours == pytest.approx(others, abs=1e-8 * np.abs(others).max())
    assert list(compiled.warnings) == list(other.warnings)


HULLS = [(scene, seed) for scene in (planar_hulls, spatial_hulls) for seed in range(2)]


@pytest.mark.few(2)
@pytest.mark.parametrize(("scene", "seed", "scheme"), crossed(HULLS, SCHEMES))
def test_steps_of_hulls_are_the_general_steps(scene, seed, scheme, general, monkeypatch):
    """Impulses at several points of a face are not unique, but the speeds they cause are."""
    options = {"integrator": scheme, "solver": EXACT, "duration": 0.12, "step": 1e-3}
    compiled, other = both_ways(scene(seed), monkeypatch, **options)
    assert len(general) < 120 + 20
    assert_same(compiled, other)


def heap() -> da.Model:
    """Discs that fall into a box with a tilted floor."""
    system, kit = da.System("discs", gravity=(0.0, -9.81)), planar.contact
    rng, shapes = np.random.default_rng(7), []
    for k in range(24):
        place = (0.12 + 0.23 * (k % 4) + 0.02 * rng.random(), 0.2 + 0.25 * (k // 4))
        start = {"position": place, "velocity": tuple(1.5 * rng.normal(size=2))}
        body = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.005, **start))
        shapes.append(kit.Circle(body.center, 0.1))
    for x, normal in ((0.0, (0.1, 1.0)), (0.0, (1.0, 0.0)), (0.96, (-1.0, 0.0))):
        shapes.append(kit.HalfPlane(system.ground.point(x, 0.0), normal))
    laws = {"friction": 0.3, "restitution": 0.2, "tangential": 0.1}
    system.add(planar.Collisions("hits", shapes, **laws))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES[:1])
def test_every_step_of_a_heap_is_the_general_step_from_its_start(scheme, general):
    """Whatever the motion amplifies: contacts that a correction would open act one after the other,
    and those that supply energy do not."""
    motion = da.solve_nonsmooth(heap(), 0.6, step=2e-3, integrator=scheme, solver=EXACT)
    assert len(general) < 20
    run, record = NonsmoothRun(motion.analysis, motion.model, None), motion.record
    y, v, size = record.ends.y, record.ends.v, np.abs(record.ends.v).max()
    moved = 0
    for k in range(1, record.loss.size, 3):
        own = np.flatnonzero(record.step == k - 1)
        own = own[np.argsort(record.key[own])]
        before = LastImpulses((record.key[own], record.impulse[own]), record.key[:0])
        t, h = float(record.t[k]), float(record.t[k + 1] - record.t[k])
        result = advance(run.step, t, h, y[:, k], v[:, k], before)
        corrected = run.corrected(t + h, h, result)
        moved += np.abs(corrected.x - result.y).max() > 1e-9
        assert v[:, k + 1] == pytest.approx(result.v, abs=SAME * size)
        assert y[:, k + 1] == pytest.approx(corrected.x, abs=SAME)
        assert record.loss[k] == pytest.approx(result.loss, abs=SAME * size**2)
    assert moved > 20


@pytest.mark.thorough
def test_contacts_that_supply_energy_are_left_out_in_machine_code(general, monkeypatch):
    """With any energy beyond that of rounding and inexact impulses."""
    rejected, original = [], march.MoreauJeanSteps.parted
    for module in ("advance", "free_bodies.moreau_jean_steps"):
        monkeypatch.setattr(f"dalembert.analysis.nonsmooth.{module}.SUPPLIED", 0.0)

    def parted(self):
        rejected.append(self)
        return original(self)

    monkeypatch.setattr(march.MoreauJeanSteps, "parted", parted)
    options = {"integrator": da.MoreauJean(), "solver": EXACT, "duration": 0.4, "step": 1e-3}
    compiled, other = both_ways(planar_scene(4), monkeypatch, **options)
    assert len(rejected) > 10 and len(general) < 400 + 10
    assert_same(compiled, other)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES[:2])
def test_walls_may_move(scheme, general, monkeypatch):
    options = {"integrator": scheme, "solver": EXACT, "duration": 0.3, "step": 1e-3}
    compiled, other = both_ways(turning_wall(), monkeypatch, **options)
    assert len(general) < 300 + 10
    assert_same(compiled, other)


def crossing(place: tuple[float, float], speed: float) -> da.Model:
    """A disc that passes another one within the second step of 5 ms, beside one that falls."""
    system, kit, shapes = da.System("crossing", gravity=(0.0, -9.81)), planar.contact, []
    starts = [(place[0], 0.5 + place[1], speed), (0.0, 0.5, 0.0), (9.0, 0.105, 0.0)]
    for k, (x, y, start) in enumerate(starts):
        motion = {"position": (x, y), "velocity": (start, 0.0)}
        body = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.005, **motion))
        shapes.append(kit.Circle(body.center, 0.1))
    shapes.append(kit.HalfPlane(system.ground.center))
    system.add(planar.Collisions("hits", shapes, friction=0.3))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("place", "speed", "text"),
    [
        ((-1.75, -0.02), 200.0, "move through each other within the step"),
        ((-0.88, -0.19), 96.0, "their impact at"),
    ],
)
def test_impacts_within_a_step_are_warned_about(place, speed, text, general, monkeypatch):
    """A step that misses an impact is a general one, which searches for it: of a body that moves
    through another one, and of one that grazes it."""
    options = {"integrator": da.MoreauJean(), "duration": 0.05, "step": 5e-3}
    compiled, other = both_ways(crossing(place, speed), monkeypatch, **options)
    assert len(general) == 2 + 10
    assert list(compiled.warnings) == list(other.warnings)
    assert [warning for warning in other.warnings if text in warning]
    assert_same(compiled, other)


@pytest.mark.few(1)
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
    options = {"integrator": da.MoreauJean(), "solver": EXACT, "duration": 0.3, "step": 1e-3}
    usual = da.solve_nonsmooth(planar_scene(0), **options)
    for name, value in limits.items():
        owners = [o for o in (free_body_steps, free_body_loop, march) if hasattr(o, name)]
        assert owners
        for owner in owners:
            monkeypatch.setattr(owner, name, value)
    if "NEWTON_STEPS" in limits:
        monkeypatch.setitem(SOLUTION_COUNTS, Counts.MAX_INTERIOR, 0)
    limited = da.solve_nonsmooth(planar_scene(0), **options)
    assert_same(limited, usual)
    same_contacts(limited, usual)


def test_positions_that_are_not_corrected_are_left_to_the_general_step(general, monkeypatch):
    options = {"integrator": da.MoreauJean(), "solver": EXACT, "duration": 0.2, "step": 2e-3}
    usual = da.solve_nonsmooth(heap(), **options)
    few = len(general)
    monkeypatch.setattr(march, "exceeds", lambda shift, travel: True)
    limited = da.solve_nonsmooth(heap(), **options)
    assert few < 10 < len(general) - few
    assert_same(limited, usual)


def test_gradients_of_both_runs_are_the_same(monkeypatch):
    system, kit = da.System("throw", gravity=(0.0, -9.81)), planar.contact
    speed, friction = system.parameter("speed", 1.2), system.parameter("friction", 0.2)
    shapes = [kit.HalfPlane(system.ground.center)]
    for k in range(3):
        start = {"position": (0.4 * k, 0.12 + 0.05 * k), "velocity": (speed / (k + 1), 0.0)}
        body = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.005, **start))
        shapes.append(kit.Circle(body.center, 0.1))
    system.add(planar.Collisions("hits", shapes, friction=friction, restitution=0.3))
    options = {"integrator": da.MoreauJean(), "solver": EXACT, "duration": 0.3, "step": 2e-3}
    runs = both_ways(system.build(), monkeypatch, **options)
    responses = [da.final(f"b{k}.x") for k in range(3)]
    ours, theirs = (da.sensitivity(run, responses, method="adjoint").values for run in runs)
    assert np.abs(theirs).max() > 0.01
    assert ours == pytest.approx(theirs, rel=1e-6, abs=1e-8)


@pytest.mark.thorough
def test_separate_impacts_are_divided_alike(general, monkeypatch):
    """Impacts that follow each other, in a row of discs."""
    system, kit = da.System("row", gravity=(0.0, -9.81)), planar.contact
    shapes = [kit.HalfPlane(system.ground.center)]
    for k, x in enumerate((0.0, 0.3, 0.502, 0.9)):
        start = {"position": (x, 0.1), "velocity": (0.0 if k else 2.0, 0.0)}
        body = system.add(planar.Body(f"b{k}", mass=1.0, inertia=0.005, **start))
        shapes.append(kit.Circle(body.center, 0.1))
    system.add(planar.Collisions("hits", shapes, restitution=0.8))
    options = {"integrator": da.MoreauJean(), "solver": EXACT, "separate_impacts": True}
    compiled, other = both_ways(system.build(), monkeypatch, duration=0.5, step=2e-3, **options)
    assert np.array_equal(compiled.record.t, other.record.t)
    assert compiled.statistics["divisions of steps"] > 0
    assert_same(compiled, other)


def test_an_interrupted_run_keeps_its_steps():
    def stop(fraction: float) -> None:
        if fraction > 0.5:
            raise KeyboardInterrupt

    options = {"integrator": da.MoreauJean(), "step": 1e-3, "progress": stop}
    motion = da.solve_nonsmooth(planar_scene(0), 0.4, **options)
    assert not motion.status.success
    assert 0.2 <= motion.record.t[-1] <= 0.22
    assert motion.record.loss.size == motion.record.t.size - 1


def test_other_laws_of_impact_take_general_steps(general):
    """Laws of impact at the start of a step have no machine code."""
    system, kit = da.System("hit", gravity=(0.0, -9.81)), planar.contact
    body = system.add(planar.Body("b", mass=1.0, inertia=0.005, position=(0.0, 0.2)))
    shapes = [kit.Circle(body.center, 0.1), kit.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hits", shapes, restitution=0.5, impact_law="energetic"))
    model = system.build()
    da.solve_nonsmooth(model, 0.02, step=1e-3, integrator=da.MoreauJean())
    assert len(general) == 20


def test_steps_with_more_contacts_at_their_ends_than_memory_complete() -> None:
    """Contacts of features that are not near at the start need more memory than the others."""
    system, contact = da.System("crowd", gravity=(0, -9.81)), planar.contact
    starts = [
        ((0.376, 1.013), 0.806, (1.744, 0.117), 3.54, 0.757, 0.012),
        ((-0.259, 0.44), -2.629, (-0.627, -0.608), -5.777, 2.44, 0.008),
        ((-0.052, 0.626), 2.321, (-1.585, -0.919), 1.841, 0.885, 0.007),
        ((0.567, 0.68), 0.643, (-4.298, 0.262), 9.339, 1.297, 0.019),
    ]
    bodies = []
    for k, (position, angle, velocity, turn, mass, inertia) in enumerate(starts):
        start = {"position": position, "angle": angle, "velocity": velocity}
        properties = {"mass": mass, "inertia": inertia, "angular_velocity": turn}
        bodies.append(system.add(planar.Body(f"body{k}", **start, **properties)))
    shapes: list[planar.contact.Shape] = [contact.Rectangle(bodies[0].center, (0.074, 0.3))]
    for body, half, radius in zip(
        bodies[1:], (0.084, 0.032, 0.047), (0.072, 0.072, 0.087), strict=True
    ):
        shapes.append(contact.Capsule(body.point(-half, 0), body.point(half, 0), radius))
    shapes.append(contact.HalfPlane(system.ground.point(1, 0), (-1, 0)))
    system.add(planar.Collisions("contacts", shapes, friction=0.5))
    scheme = da.MoreauJean()
    motion = da.solve_nonsmooth(system.build(), 0.5, step=3.2e-3, integrator=scheme)
    assert motion.status.success, motion.status
