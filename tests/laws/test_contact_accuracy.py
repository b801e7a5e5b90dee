"""Error estimates of runs with contacts, beside true errors."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial
from dalembert.results.recording import NOT_CHECKED

G = 9.81
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


def toppling() -> da.Model:
    """A box on one of its corners, which does not slip."""
    system = da.System("toppling", gravity=(0, -G))
    angle, (width, height) = 0.7, (0.2, 0.4)
    corner = np.array([-width / 2, -height / 2]) @ [
        [np.cos(angle), np.sin(angle)],
        [-np.sin(angle), np.cos(angle)],
    ]
    box = planar.Body("box", mass=1.0, inertia=0.02, position=tuple(-corner), angle=angle)
    shape = planar.contact.Rectangle(system.add(box), (width, height))
    floor = planar.contact.HalfPlane(system.ground.center)
    system.add(planar.Collisions("corner", [shape, floor], friction=2.0))
    return system.build()


def true_angle(times: np.ndarray) -> np.ndarray:
    """Angle of the same box as a pendulum about its corner."""
    radius, inertia = np.hypot(0.1, 0.2), 0.02 + 0.05
    lean = np.arctan2(0.2, 0.1)  # of the line from the corner to the mass centre

    def rates(t: float, x: np.ndarray) -> list[float]:
        return [x[1], -G * radius * np.cos(lean + x[0]) / inertia]

    motion = solve_ivp(rates, (0, times[-1]), [0.7, 0.0], t_eval=times, rtol=1e-10, atol=1e-12)
    return np.asarray(motion.y[0])


def swinging(law: planar.contact.Hertz | None, speed: float = 1.0) -> da.Model:
    """A ball between two walls, which it reaches again and again."""
    system = da.System("walls", gravity=(0, 0))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=(speed, 0)))
    kit = planar.contact
    walls = [
        kit.HalfPlane(system.ground.point(side * 0.5, 0), normal=(-side, 0)) for side in (-1, 1)
    ]
    shapes = [kit.Circle(ball.center, 0.1), *walls]
    options = {"law": law} if law else {"restitution": 0.5}
    system.add(planar.Collisions("walls", shapes, **options))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_estimate_is_that_of_a_toppling_box(scheme: da.AnticipatedImpacts):
    """The error at the end, where it is largest, of the coordinate with the largest one."""
    model, shares = toppling(), []
    for step in (4e-3, 1e-3):
        motion = da.solve_nonsmooth(model, 0.25, step=step, integrator=scheme)
        exact = true_angle(motion.time)
        c, s = np.cos(exact), np.sin(exact)
        true = {"x": 0.1 * c - 0.2 * s, "y": 0.1 * s + 0.2 * c, "angle": exact}
        errors = [np.abs(motion.values(f"box.{q}") - true[q]).max() / np.ptp(true[q]) for q in true]
        error = max(errors)
        estimate = motion.error_estimate
        assert error / 2 < estimate.share < 5 * error
        shares.append(estimate.share)
    assert shares[1] < shares[0]


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_estimate_is_that_of_a_ball_between_walls(scheme: da.AnticipatedImpacts):
    """Each impact is applied up to a step early or late."""
    motion = da.solve_nonsmooth(swinging(None), 4.0, step=7e-3, integrator=scheme)
    instants, place, speed = [0.4], [0.4], 1.0
    while instants[-1] < 4:
        speed *= -0.5
        place.append(-place[-1])
        instants.append(instants[-1] + 0.8 / abs(speed))
    exact = np.interp(motion.time, [0.0, *instants], [0.0, *place])
    x = motion.values("ball.x")
    error = np.abs(x - exact).max() / np.ptp(x)
    assert error > 1e-3 and error / 5 < motion.error_estimate.share < 5 * error


@pytest.mark.thorough
def test_force_laws_alone_have_errors_of_second_order():
    """A ball between two compliant walls."""
    model = swinging(planar.contact.Hertz(stiffness=1e4))
    motion = da.solve_nonsmooth(model, 2.0, step=2e-3)

    def rates(t: float, x: np.ndarray) -> list[float]:
        push = 1e4 * (max(-x[0] - 0.4, 0) ** 1.5 - max(x[0] - 0.4, 0) ** 1.5)
        return [x[1], push]

    solved = solve_ivp(
        rates, (0, 2), [0.0, 1.0], t_eval=motion.time, rtol=1e-10, atol=1e-12, max_step=1e-3
    )
    x = motion.values("ball.x")
    error = np.abs(x - solved.y[0]).max() / np.ptp(x)
    assert error / 3 < motion.error_estimate.share < 3 * error


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_long_steps_are_warned_about_with_shorter_ones(scheme: da.AnticipatedImpacts):
    model = swinging(None)
    motion = da.solve_nonsmooth(model, 4.0, step=0.1, integrator=scheme)
    before = motion.data.attrs["warnings"]
    (warning,) = motion.warnings
    assert motion.status.success and "ball.x" in warning
    assert before == NOT_CHECKED and motion.data.attrs["warnings"] == warning
    shorter = float(re.search(r"use steps below ([0-9.e-]+) s", warning)[1])  # type: ignore[index]
    finer = da.solve_nonsmooth(model, 4.0, step=shorter, integrator=scheme)
    assert not finer.warnings and finer.error_estimate.share < 0.05


def test_runs_at_rest_have_no_estimate():
    assert da.solve_nonsmooth(swinging(None), 0.1, step=0.1).error_estimate.share == 0.0  # flies
    still = da.solve_nonsmooth(swinging(None, 0.0), 0.3, step=0.1)
    assert still.error_estimate is None and not still.warnings


def test_the_estimate_is_not_computed_before_it_is_read(monkeypatch: pytest.MonkeyPatch):
    from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun

    runs: list[int] = []
    march = NonsmoothRun.march

    def counted(self, grid, log, report):
        runs.append(grid.size - 1)
        return march(self, grid, log, report)

    monkeypatch.setattr(NonsmoothRun, "march", counted)
    motion = da.solve_nonsmooth(swinging(None), 0.5, step=0.1)
    assert repr(motion).endswith("warnings incomplete>")  # and is not computed for it
    assert motion.data.attrs["warnings"] == NOT_CHECKED
    assert runs == [5]
    assert not motion.warnings or motion.error_estimate is not None
    assert runs == [5, 80]
    assert "incomplete" not in repr(motion)


def test_longer_steps_that_fail_give_no_number(monkeypatch: pytest.MonkeyPatch):
    from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun

    motion = da.solve_nonsmooth(swinging(None), 4.0, step=0.05)
    failed = da.Status(da.Outcome.NOT_CONVERGED, "", 1.5, 1.0)
    monkeypatch.setattr(NonsmoothRun, "march", lambda *arguments: failed)
    estimate = motion.error_estimate
    assert estimate.share == np.inf
    unknown = "not known, because steps 1.6 times as long fail at t = 1.5 s"
    assert estimate.text == unknown
    (warning,) = motion.warnings
    assert (
        warning
        == f"the error of steps of 0.05 s is {unknown}; compare with a run with shorter steps"
    )


@pytest.mark.parametrize("steps", [1, 2, 3, 6])
@pytest.mark.parametrize("duration", [0.2, 0.3])
def test_few_steps_have_the_error_of_a_fall(duration, steps):
    """A box falls from 0.2 m onto a floor, in few long steps; its error is known exactly."""
    system = da.System("fall", gravity=(0, 0, -G))
    place = {"position": (0, 0, 0.3), "inertia": (0.01,) * 3}
    body = system.add(spatial.Body("box", mass=1.0, **place))
    shapes = [spatial.contact.Box(body.center, (0.2,) * 3)]
    shapes.append(spatial.contact.HalfSpace(system.ground.frame()))
    system.add(spatial.Collisions("floor", shapes))
    motion = da.solve_nonsmooth(system.build(), duration, step=duration / steps)
    z = motion["box.z"].values
    error = np.abs(z - np.maximum(0.1, 0.3 - G / 2 * motion.time**2)).max() / np.ptp(z)
    assert 0.7 * error <= motion.error_estimate.share <= 1.6 * error
    assert error > 0.05 and len(motion.warnings) == 1


def test_repetitions_that_diverge_end(monkeypatch: pytest.MonkeyPatch):
    """A repetition whose speeds exceed those of the run by far ends there."""
    from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
    from dalembert.analysis.nonsmooth.step_log import StepLog

    monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    motion, times, add = da.solve_nonsmooth(swinging(None), 4.0, step=0.05), [], StepLog.add

    def faster(self, t, h, y, speeds, result):
        times.append(t)
        add(self, t, h, y, replace(speeds, v=speeds.v * (1e4 if t > 1.0 else 1.0)), result)

    monkeypatch.setattr(StepLog, "add", faster)
    (warning,) = motion.warnings
    assert "steps 1.6 times as long fail at t = 1.04 s" in warning
    assert times[-1] == pytest.approx(1.04)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("scheme", "step"), [(da.AnticipatedImpacts(), 1e-3), (da.MoreauJean(), 1e-3)]
)
def test_the_estimate_is_that_of_a_periodic_motion(scheme: da.AnticipatedImpacts, step: float):
    """A part slips in every period of a trough, at the same part of a step again and again."""
    period, slope, friction = 0.04, np.radians(25), 0.3
    omega, times = 2 * np.pi / period, np.linspace(0, 10 * period, 4001)
    size = 0.8 * G / (omega**2 * np.sin(slope))
    system = da.System("feeder", gravity=(0, -G))
    trough = system.add(planar.Body("trough", mass=5.0, inertia=0.1, position=(0, 0)))
    shake = size * da.sin(omega * da.t)
    system.add(planar.UserConstraint("along", trough.x - np.cos(slope) * shake))
    system.add(planar.UserConstraint("up", trough.y - np.sin(slope) * shake))
    system.add(planar.UserConstraint("level", trough.angle))
    speed = size * omega * np.array([np.cos(slope), np.sin(slope)])
    start = {"position": (0, 0.01), "velocity": tuple(speed)}
    part = system.add(planar.Body("part", mass=0.01, inertia=1e-6, **start))
    system.add(planar.UserConstraint("upright", part.angle))
    kit = planar.contact
    shapes = [kit.Circle(part.center, 0.01), kit.HalfPlane(trough.center)]
    system.add(planar.Collisions("surface", shapes, friction=friction))
    motion = da.solve_nonsmooth(system.build(), 10 * period, step=step, integrator=scheme)

    def exact() -> np.ndarray:
        """Slip with Coulomb friction, ``|a| ≤ μ (g + ÿ)``, in short steps."""
        n, x, v, places = 200, 0.0, speed[0], [0.0]
        h = (times[1] - times[0]) / n
        for t in times[:-1]:
            for k in range(n):
                phase = omega * (t + (k + 0.5) * h)
                limit = friction * (G - size * omega**2 * np.sin(slope) * np.sin(phase)) * h
                wanted = size * omega * np.cos(slope) * np.cos(phase + omega * h / 2) - v
                v += min(max(wanted, -limit), limit)
                x += h * v
            places.append(x)
        return np.array(places)

    x = motion.values("part.x")
    error = np.abs(x - np.interp(motion.time, times, exact())).max() / np.ptp(x)
    assert error > 0.04 and error / 4 < motion.error_estimate.share < 4 * error


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("degrees", "step", "duration"), [(34, 1.1e-3, 0.2), (34, 7.3e-4, 0.2), (40, 7.3e-4, 0.4)]
)
def test_errors_of_many_impacts_are_not_underestimated_by_chance(degrees, step, duration):
    """A part hops on a trough that vibrates along a line: one repetition estimates a quarter and a
    half of the error, which located impacts confirm, and all of them estimate half of it at 40°."""
    omega, size, slope, line = 50 * np.pi, 1e-3, np.radians(4), np.radians(degrees)
    along = np.array([np.cos(line), np.sin(line)])
    system = da.System("feeder", gravity=(0, -G))
    trough = system.add(planar.Body("trough", mass=5.0, inertia=0.05, angle=slope))
    start = {"position": (0, 0), "velocity": tuple(size * omega * along)}
    part = system.add(planar.Particle("part", mass=0.01, **start))
    shake = size * da.sin(omega * da.t)
    system.add(planar.UserConstraint("along", trough.x - along[0] * shake))
    system.add(planar.UserConstraint("up", trough.y - along[1] * shake))
    system.add(planar.UserConstraint("level", trough.angle - slope))
    c, s = np.cos(slope), np.sin(slope)
    gap = (part.y - trough.y) * c - (part.x - trough.x) * s
    slip = (part.vx - trough.vx) * c + (part.vy - trough.vy) * s
    law = {"restitution": 0.0, "friction": 0.4}
    system.add(planar.UnilateralConstraint("surface", gap, slip, **law))
    model = system.build()
    times = np.linspace(0, duration, 4001)
    precise = da.DormandPrince(rtol=1e-9, atol=1e-12)
    exact = da.solve_dynamics(model, duration, integrator=precise, outputs=times)
    motion = da.solve_nonsmooth(model, duration, step=step, integrator=da.MoreauJean())
    x = motion.values("part.x")
    error = np.abs(x - np.interp(motion.time, times, exact.values("part.x"))).max() / np.ptp(x)
    assert error > 0.05 and error / 2 < motion.error_estimate.share < 2 * error
    assert any("their estimated error is" in text for text in motion.warnings)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_coin_that_reels_about_its_mass_centre_has_small_errors(scheme: da.AnticipatedImpacts):
    """Its rim rolls in a circle about the mass centre, which the exact motion keeps at rest. That
    the computed one moves by micrometres is a small error of the motion, not all of it."""
    radius, thick, mass, tilt = 0.0375, 0.006, 0.1, np.radians(30)
    across, along = mass * (3 * radius**2 + thick**2) / 12, mass * radius**2 / 2
    share, (s, c) = thick / (2 * radius), (np.sin(tilt), np.cos(tilt))
    arm = radius * c - thick / 2 * s
    rate = np.sqrt(mass * G * arm / (s * (across * c - along * s * share)))  # of the precession
    low, axis = np.array([c, 0, -s]), np.array([s, 0, c])
    height = float(thick / 2 * c + radius * s)
    system = da.System("Euler's disk", gravity=(0, 0, -G))
    start = {
        "position": (0, 0, height),
        "rotation": da.rotation.axis_angle((0, 1, 0), float(tilt)),
        "angular_velocity": tuple((rate * s * (share * axis - low)).tolist()),
    }
    size = {"radius": radius, "length": thick, "mass": mass}
    coin = system.add(spatial.Cylinder("coin", **size, **start))
    ends = [coin.point(0, 0, side * thick / 2) for side in (-1, 1)]
    shapes = [
        spatial.contact.Cylinder(*ends, radius),
        spatial.contact.HalfSpace(system.ground.frame()),
    ]
    system.add(spatial.Collisions("table", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=1e-3, integrator=scheme)
    moved = motion.values("coin.position") - (0, 0, height)
    assert np.abs(moved).max() < 1e-3 * radius
    assert motion.error_estimate.share < 0.05 and not motion.warnings


def links(touching: bool) -> da.Model:
    """A chain of flat links of capsules that overlap at their joints."""
    system, groups, chain = da.System("chain", gravity=(0.0, -G)), {}, []
    for k in range(4):
        placed = {"position": (0.1 + 0.2 * k, 0.5), "angle": 0.0}
        link = system.add(planar.Bar(f"link{k}", length=0.2, mass=0.5, **placed))
        groups[f"part{k}"] = [planar.contact.Capsule(link.start, link.end, 0.02)]
        chain.append(link)
        if k:
            system.add(planar.Revolute(f"joint{k}", chain[k - 1].end, link.start))
    groups["floor"] = [planar.contact.HalfPlane(system.ground)]
    pairs = [planar.contact.Pair((f"part{k}", f"part{k + 1}"), touching=touching) for k in range(3)]
    system.add(planar.Collisions("hits", groups, friction=0.3, pairs=pairs))
    return system.build()


@pytest.mark.thorough
def test_a_chain_that_falls_flat_has_small_errors():
    """Its links turn by 1e-5 rad in the step of the impact, which are a large part of their
    rotations, but not of their motion."""
    motion = da.solve_nonsmooth(links(touching=False), 0.6, step=1e-3)
    assert abs(motion["link1.angle"]).max() < 2e-5
    assert motion.error_estimate.share < 0.05 and not motion.warnings


def test_overlaps_at_joints_name_the_joint():
    with pytest.raises(da.AnalysisError, match=r"overlap by 0.04 m at the start; the joint joint"):
        da.solve_nonsmooth(links(touching=True), 0.6, step=1e-3)
