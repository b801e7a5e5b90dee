"""Law of runs with separated impacts: motion and gradient are those of the sequence of impacts.

The reference locates every impact: flights in closed form, instants by Newton's method, and
derivatives by complex steps. Impacts of different bodies within one step need no separation.
"""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth import nonsmooth_run

G, TINY = 9.81, 1e-30


def root(gap: Callable, rate: Callable, begin: complex, end: float, samples: int = 400) -> complex:
    """First instant at which a gap closes, by its samples and Newton's method; inf without."""
    t = np.linspace(np.real(begin), end, samples)[1:]
    closed = [s for s in t if np.real(gap(s)) < 0 and np.real(rate(s)) < 0]
    if not closed:
        return np.inf
    s: complex = closed[0]
    for _ in range(30):
        s = s - gap(s) / rate(s)
    return s


def derivatives(function: Callable, p: np.ndarray) -> np.ndarray:
    """Derivatives of a vector by complex steps."""
    columns = []
    for k in range(p.size):
        moved = p.astype(complex)
        moved[k] += 1j * TINY
        columns.append(np.imag(function(moved)) / TINY)
    return np.array(columns).T


def both(motion: da.Motion, *responses) -> np.ndarray:
    """Direct derivatives, which are the adjoint ones."""
    assert motion.status.success
    direct = da.sensitivity(motion, list(responses), method="direct").values
    adjoint = da.sensitivity(motion, list(responses), method="adjoint").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8, atol=1e-10 * abs(direct).max())
    return direct


def compare(
    model: da.Model,
    names: list[str],
    run: Callable,
    p: list[float],
    end: float,
    divided: bool = True,
) -> None:
    """The motion, and its gradient relative to the largest influence, against a reference; steps
    that are not divided have no gradient."""
    exact, slopes = np.real(run(np.array(p))), derivatives(run, np.array(p))
    scales = np.maximum(abs(slopes).max(axis=1, keepdims=True), 1e-12)
    responses = [da.final(name) for name in names]
    motion = da.solve_nonsmooth(model, end, step=1e-3, separate_impacts=True)
    assert (motion.statistics["divisions of steps"] > 0) == divided
    values = [float(motion[name][-1]) for name in names]
    np.testing.assert_allclose(values, exact, atol=5e-3)
    np.testing.assert_allclose(both(motion, *responses) / scales, slopes / scales, atol=0.012)
    if divided:
        plain = da.solve_nonsmooth(model, end, step=1e-3)
        with pytest.raises(da.SingularityError, match="separate_impacts"):
            da.sensitivity(plain, responses)


def bar_of(height: float, tilt: float, bounce: float) -> da.Model:
    system = da.System("bar", gravity=(0.0, -G))
    start = (0.0, system.parameter("height", height)), system.parameter("tilt", tilt)
    bar = planar.Body("bar", mass=1.0, inertia=0.05, position=start[0], angle=start[1])
    system.add(bar)
    ends = [planar.contact.Circle(bar.point(x, 0.0), 0.02) for x in (-0.5, 0.5)]
    floor = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))
    e = system.parameter("bounce", bounce)
    system.add(planar.Collisions("floor", [*ends, floor], restitution=e))
    return system.build()


def bar(p: np.ndarray, end: float) -> np.ndarray:
    """Height and angle of a bar of two balls without friction on a floor."""
    y, angle, e = p
    t, vy, turn = 0.0, 0.0, 0.0
    for _ in range(20):
        own = t, y, angle, vy, turn

        def flight(s, own=own):
            t, y, angle, vy, turn = own
            return y + vy * (s - t) - G * (s - t) ** 2 / 2, angle + turn * (s - t), vy - G * (s - t)

        hits = []
        for x in (-0.5, 0.5):

            def gap(s, x=x):
                y, angle, _ = flight(s)
                return y + x * np.sin(angle) - 0.02

            def rate(s, x=x, turn=turn):
                _, angle, vy = flight(s)
                return vy + x * np.cos(angle) * turn

            hits.append((root(gap, rate, t + 1e-9, end, 4000), x))
        hit, x = min(hits, key=lambda of: np.real(of[0]))
        if not np.isfinite(hit):
            break
        y, angle, vy = flight(hit)
        t, lever = hit, x * np.cos(angle)
        push = -(1 + e) * (vy + lever * turn) / (1.0 + lever**2 / 0.05)
        vy, turn = vy + push, turn + push * lever / 0.05
    y, angle, _ = flight(end)
    return np.array([y, angle])


@pytest.mark.few(1)
@pytest.mark.parametrize("tilt", [1e-3, -4e-4])
def test_bar_that_lands_on_one_end_after_the_other(tilt):
    p, end = [0.3, tilt, 0.5], 0.29
    compare(bar_of(*p), ["bar.y", "bar.angle"], lambda q: bar(q, end), p, end)


def row_of(gap: float, speed: float, bounce: float) -> da.Model:
    system = da.System("row", gravity=(0.0, 0.0))
    start = [0.1, 0.33, system.parameter("gap", gap) + 0.53, 0.9]
    shapes = []
    for k, x in enumerate(start[:3]):
        like = {"mass": 1.0 + k, "inertia": 0.01, "position": (x, 0.0)}
        like["velocity"] = (system.parameter("speed", speed) if k == 0 else 0.0, 0.0)
        disc = system.add(planar.Body(f"disc{k}", **like))
        shapes.append(planar.contact.Circle(disc, 0.1))
    e = system.parameter("bounce", bounce)
    system.add(planar.Collisions("row", shapes, restitution=e))
    return system.build()


def row(p: np.ndarray, end: float) -> np.ndarray:
    """Positions of three discs in a row."""
    gap, speed, e = p
    x, v, m, t = [0.1, 0.33, 0.53 + gap], [speed, 0.0, 0.0], [1.0, 2.0, 3.0], 0.0
    while True:
        hits = []
        for k in range(2):
            rate = v[k] - v[k + 1]
            if np.real(rate) > 0:
                hits.append(((x[k + 1] - x[k] - 0.2) / rate, k))
        hits = [hit for hit in hits if np.real(hit[0]) > -1e-9 and np.real(t + hit[0]) < end]
        if not hits:
            return np.array([own + (end - t) * rate for own, rate in zip(x, v, strict=True)])
        span, k = min(hits, key=lambda of: np.real(of[0]))
        x = [own + span * rate for own, rate in zip(x, v, strict=True)]
        push = (1 + e) * (v[k] - v[k + 1]) / (1 / m[k] + 1 / m[k + 1])
        v[k], v[k + 1], t = v[k] - push / m[k], v[k + 1] + push / m[k + 1], t + span


@pytest.mark.few(1)
@pytest.mark.parametrize("gap", [4e-4, 1.5e-4])
def test_discs_in_a_row_with_small_gaps(gap):
    p, end = [gap, 1.0, 0.9], 0.1
    names = [f"disc{k}.x" for k in range(3)]
    compare(row_of(*p), names, lambda q: row(q, end), p, end)


@pytest.mark.few(2)
@pytest.mark.parametrize("gap", [8e-5, 1e-4, 1.5e-4, 4e-4])
@pytest.mark.parametrize("speed", [1.0, 1.013, 1.03, 1.04])
def test_corrections_of_positions_do_not_join_impacts(gap, speed):
    """Speeds are those of the sequence, though a disc that closes its gap in the second half of a
    step is moved back, and pushes the next disc over a smaller gap."""
    p, end, options = [gap, speed, 0.9], 0.08, {"step": 1e-3, "integrator": da.MoreauJean()}
    motion = da.solve_nonsmooth(row_of(*p), end, separate_impacts=True, **options)
    exact = (row(np.array(p), end) - row(np.array(p), end - 0.01)) / 0.01
    speeds = [motion[f"disc{k}.vx"][-1].item() for k in range(3)]
    np.testing.assert_allclose(speeds, exact, atol=1e-9)


def test_gradient_of_divided_steps_with_corrections_of_positions():
    p, end = [1e-4, 1.013, 0.9], 0.08
    responses = [da.final(f"disc{k}.x") for k in range(3)]
    options = {"step": 1e-3, "integrator": da.MoreauJean(), "separate_impacts": True}
    gradient = both(da.solve_nonsmooth(row_of(*p), end, **options), *responses)
    exact = derivatives(lambda q: row(q, end), np.array(p))
    scales = abs(exact).max(axis=1, keepdims=True)
    np.testing.assert_allclose(gradient / scales, exact / scales, atol=0.012)


def test_impacts_joined_by_a_correction_of_positions_are_warned_about():
    """Three discs leave with the speeds of touching ones; shorter steps separate the impacts."""
    motion = da.solve_nonsmooth(
        row_of(1e-4, 1.013, 0.9), 0.08, step=1e-3, integrator=da.MoreauJean()
    )
    (warning,) = (text for text in motion.warnings if "both count as one" in text)
    assert warning.startswith("an impact closes the gap of 0.0001 m of disc1 and disc2 of row")
    shorter = float(re.search("use step=([^ ]*) or shorter", warning).group(1))
    short = {"step": shorter, "integrator": da.MoreauJean()}
    separate = da.solve_nonsmooth(row_of(1e-4, 1.013, 0.9), 0.08, **short)
    assert not any("both count as one" in text for text in separate.warnings)


def corner_of(low: float, speed: float, bounce: float, friction: float = 0.0) -> da.Model:
    system = da.System("corner", gravity=(0.0, -G))
    low, speed = system.parameter("low", low), system.parameter("speed", speed)
    like = {"position": (0.25, low), "velocity": (-speed, 0.0), "angular_velocity": 0.0}
    disc = system.add(planar.Body("disc", mass=2.0, inertia=0.01, **like))
    shapes = [planar.contact.Circle(disc, 0.1)]
    for normal in ((0.0, 1.0), (1.0, 0.0)):
        shapes.append(planar.contact.HalfPlane(system.ground.point(0.0, 0.0), normal))
    law = {"restitution": system.parameter("bounce", bounce)}
    law |= {"friction": system.parameter("friction", friction)} if friction else {}
    system.add(planar.Collisions("corner", shapes, **law))
    return system.build()


def corner(p: np.ndarray, end: float) -> np.ndarray:
    """Position and speed of rotation of a disc that hits a floor and a wall, with friction."""
    low, speed, e, *mu = p
    mu = mu[0] if mu else 0.0
    m, inertia, r, t = 2.0, 0.01, 0.1, 0.0
    x, y, vx, vy, turn = 0.25, low, -speed, 0.0 * speed, 0.0 * speed
    for _ in range(10):
        fall = (vy + np.sqrt(vy**2 + 2 * G * (y - r))) / G
        wall = (x - r) / -vx if np.real(vx) < 0 else np.inf
        span = min(fall, wall, key=np.real)
        if np.real(t + span) > end:
            break
        x, y, vy, t = x + vx * span, y + vy * span - G * span**2 / 2, vy - G * span, t + span
        floor = span is fall
        slip = vx + r * turn if floor else vy - r * turn
        push = -(1 + e) * m * (vy if floor else vx)
        stick = -slip / (1 / m + r**2 / inertia)
        side = (
            stick
            if abs(np.real(stick)) < np.real(mu * push)
            else -mu * push * np.sign(np.real(slip))
        )
        vx, vy = vx + (side if floor else push) / m, vy + (push if floor else side) / m
        turn = turn + (r * side if floor else -r * side) / inertia
    span = end - t
    return np.array([x + vx * span, y + vy * span - G * span**2 / 2, turn])


@pytest.mark.few(3)
@pytest.mark.parametrize("delay", [-2e-4, -5e-4])
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.6])
def test_disc_in_a_corner(delay, friction):
    fall = 0.15 / 1.2
    p, end = [0.1 + G * (fall + delay) ** 2 / 2, 1.2, 0.6], 0.2
    p += [friction] if friction else []
    names = ["disc.x", "disc.y", "disc.angular_velocity"]
    compare(corner_of(*p), names, lambda q: corner(q, end), p, end, friction > 0)


def test_impacts_of_different_bodies_in_one_step_with_friction():
    """The instants of impacts move the speeds that friction changes, too: each ball has the
    derivative by its height that it has alone, of ``x = v T − μ (1 + e) g t* (T − t*)`` and of its
    rotation, with ``dt*/dH = 1/(g t*)``."""
    system = da.System("balls", gravity=(0.0, -10.0))
    heights = [system.parameter(name, 1.0, "m") for name in ("left", "right")]
    shapes = [planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))]
    for k, height in enumerate(heights):
        start = {"position": (float(k), height), "velocity": (5.0, 0.0)}
        ball = planar.Body(f"ball{k}", mass=1.0, inertia=0.005, **start)
        shapes.append(planar.contact.Circle(system.add(ball), 0.1))
    system.add(planar.Collisions("floor", shapes, restitution=0.5, friction=0.2))
    motion = da.solve_nonsmooth(system.build(), 0.6, step=1e-3)
    gradient = both(motion, *(da.final(f"ball{k}.{q}") for k in (0, 1) for q in ("x", "angle")))
    slip = 0.2 * 1.5 * (2 - 0.6 / np.sqrt(2 * 0.9 / 10))
    turn = slip * 0.1 / 0.005
    np.testing.assert_allclose(gradient[[0, 2]], slip * np.eye(2), atol=3e-3)
    np.testing.assert_allclose(gradient[[1, 3]], turn * np.eye(2), atol=3e-2 * turn)


@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_parts_of_divided_steps_run_in_machine_code(scheme, monkeypatch):
    """General steps are the first one and those whose impulses machine code does not determine."""
    general, original = [], nonsmooth_run.advance

    def counted(*arguments):
        general.append(arguments[1])
        return original(*arguments)

    monkeypatch.setattr(nonsmooth_run, "advance", counted)
    options = {"step": 1e-3, "integrator": scheme, "separate_impacts": True}
    motion = da.solve_nonsmooth(row_of(1e-4, 1.013, 0.9), 0.08, **options)
    assert motion.statistics["divisions of steps"] > 10
    assert motion.record.loss.size > 90 and len(general) <= 3
