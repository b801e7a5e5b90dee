"""Default runs: error control, explicit or implicit steps by stiffness, estimated errors.

References are closed forms and runs of another method to a much smaller tolerance.
"""

from __future__ import annotations

import numpy as np
import pytest
from registry import CASES, model_of

import dalembert as da
from dalembert import planar, spatial

RTOL = da.AutomaticIntegrator().rtol
SAMPLE = sorted(CASES)[::8]
TIGHT = da.DormandPrince853(rtol=1e-12, atol=1e-14)


def share(motion, reference) -> float:
    """Largest error, by the ranges of the coordinates and the largest speeds."""
    y, v, y_true, v_true = (
        x for m in (motion, reference) for x in (m.trajectory.y, m.trajectory.v)
    )
    way, fast = np.ptp(y_true, axis=1), np.abs(v_true).max(axis=1)
    sizes = np.concatenate([np.maximum(s, 0.01 * s.max()) for s in (way, fast)])
    error = np.abs(np.vstack([y - y_true, v - v_true])).max(axis=1)
    moving = sizes > 0
    return float(np.max(error[moving] / sizes[moving], initial=0.0))


def methods(motion) -> dict[str, int]:
    """Steps by method."""
    kernel, steps = motion.record.kernel, motion.record.steps
    taken = [type(kernel.variants[m].integrator).__name__ for m in steps.mode[steps.lasting]]
    return {name: taken.count(name) for name in set(taken)}


@pytest.mark.few(2)
@pytest.mark.parametrize("name", SAMPLE)
def test_default_runs_keep_ten_times_the_stated_tolerance(name):
    model = model_of(name)
    motion = da.solve_dynamics(model, 1.0)
    reference = da.solve_dynamics(model, 1.0, outputs=motion.time, integrator=TIGHT)
    error, estimate = share(motion, reference), motion.error_estimate
    assert motion.status.success and error < 10 * RTOL
    assert estimate is None or error < 1e-10 or error / 3 < estimate.share < 3 * error


HARDEST = {
    "bristles in revolute",
    "point on plane",
    "spatial cylindrical",
    "spatial prismatic from the start",
}
"""Of all cases those whose estimates are farthest from the errors: factors of .32 to 4.6."""


@pytest.mark.few(5)
@pytest.mark.parametrize("name", sorted({*SAMPLE[::2], *HARDEST}))
def test_estimated_errors_of_fixed_steps_are_right_within_a_factor_of_five(name):
    model = model_of(name)
    motion = da.solve_dynamics(model, 1.0, step=0.05)
    reference = da.solve_dynamics(model, 1.0, outputs=motion.time, integrator=TIGHT)
    error, estimate = share(motion, reference), motion.error_estimate
    assert type(motion.analysis.integrator) is da.RK4
    assert estimate is None or error < 1e-10 or error / 5 < estimate.share < 5 * error


def hung_plate():
    system = da.System("plate", gravity=(0, 0, -9.81))
    body = {"mass": 1.0, "inertia": (0.1, 0.04, 0.1), "position": (2, 2, 0)}
    plate = system.add(spatial.Body("plate", **body))
    ends = system.ground.frame(axis=(0, 0, 1)), plate.point(0, -2, 0)
    system.add(spatial.RevoluteSphericalLink("link", *ends, length=2.0))
    return system.build()


def test_steps_that_are_too_long_at_a_few_places_only_raise_a_warning():
    """The plate turns fast for short times; elsewhere the same steps are short enough."""
    model = hung_plate()
    coarse = da.solve_dynamics(model, 5.0, step=5e-3)
    fine = da.solve_dynamics(model, 5.0, outputs=coarse.time)
    error = share(coarse, fine)
    assert error > 0.1 and error / 3 < coarse.error_estimate.share < 3 * error
    (text,) = coarse.warnings
    assert "long for this motion" in text and "error control" in text
    assert not fine.warnings


def buffered(stiffness: float, damping: float, fades: float = 0.0, push: float = 0.0):
    """A mass on a spring and a damper, whose rates may decay exponentially, and a soft spring."""
    system = da.System("buffer")
    k = system.parameter("k", stiffness, unit="N/m")
    mass = system.add(planar.Particle("mass", mass=1.0, velocity=(1, 0)))
    force = -(k * mass.x + damping * mass.vx) * da.exp(-fades * da.t) - 100.0 * mass.x + push
    system.add(planar.Force("force", mass.center, (force, 0)))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("backend", ["vm", "jit"])
def test_stiff_problems_take_implicit_steps(backend):
    model = buffered(1e6, 1e6)
    motion = da.solve_dynamics(model, 1.0, backend=backend)
    roots = np.roots([1.0, 1e6, 1e6 + 100.0])
    weights = np.linalg.solve([[1, 1], roots], [0, 1])
    exact = weights @ np.exp(np.outer(roots, motion.time))
    assert np.abs(motion["mass.x"].values - exact).max() < 10 * RTOL * np.ptp(exact)
    assert methods(motion)["Radau"] == motion.statistics["implicit steps"] > 0
    assert motion.statistics["steps"] < 1000  # explicit steps would stay below 4 µs


def test_the_explicit_method_returns_when_the_problem_is_no_longer_stiff():
    model = buffered(1e6, 1e6, fades=10.0, push=100.0)
    motion = da.solve_dynamics(model, 5.0)
    integrators = [type(v.integrator).__name__ for v in motion.record.kernel.variants]
    kinds = [integrators[mode] for mode in motion.record.steps.mode]
    assert kinds[0] == kinds[-1] == "DormandPrince" and "Radau" in kinds
    reference = da.solve_dynamics(model, 5.0, outputs=motion.time, integrator=da.Radau(rtol=1e-11))
    assert share(motion, reference) < 10 * RTOL


def test_problems_that_are_not_stiff_never_prepare_the_implicit_method():
    motion = da.solve_dynamics(hung_plate(), 1.0)
    assert methods(motion).keys() == {"DormandPrince"}
    assert len(motion.record.kernel.variants) == 1


def test_gradients_hold_across_changes_of_the_method():
    model = buffered(1e6, 1e5, fades=5.0)
    motion = da.solve_dynamics(model, 2.0)
    assert set(methods(motion)) == {"DormandPrince", "Radau"}
    response = da.final("mass.x")
    direct, adjoint = (
        float(da.sensitivity(motion, response, method=m).sel(parameter="k").item())
        for m in ("direct", "adjoint")
    )
    assert direct == pytest.approx(adjoint, rel=1e-9)
    careful = da.Dynamics(2.0, integrator=da.Radau(rtol=1e-11, atol=1e-15))
    ends = [float(careful.run(model, {"k": 1e6 * f})["mass.x"][-1]) for f in (0.99, 1.01)]
    assert direct == pytest.approx((ends[1] - ends[0]) / 2e4, rel=1e-3)


def test_formulations_choose_among_the_methods_that_suit_them():
    implicit = da.solve_dynamics(buffered(1e4, 1e3), 0.1, formulation=da.DAE())
    explicit = da.solve_dynamics(buffered(1e4, 1e3), 0.1, formulation=da.AugmentedLagrangian())
    assert methods(implicit).keys() == {"Radau"}
    assert methods(explicit).keys() == {"DormandPrince"}


def test_a_step_selects_fixed_steps_unless_an_integrator_is_chosen():
    chosen = da.AutomaticIntegrator()
    assert type(da.Dynamics(1.0).integrator) is da.AutomaticIntegrator
    assert type(da.Dynamics(1.0, step=0.1).integrator) is da.RK4
    assert da.Dynamics(1.0, step=0.1, integrator=chosen).integrator is chosen


def test_an_estimated_error_above_the_tolerance_is_reported():
    """An undamped spring turns over 1,600 times; errors of its phase accumulate."""
    motion = da.solve_dynamics(buffered(1e8, 0.0), 1.0)
    rate = np.sqrt(1e8 + 100.0)
    error = np.abs(motion["mass.vx"].values - np.cos(rate * motion.time)).max()
    estimate = motion.error_estimate
    assert error / 3 < estimate.share < 3 * error and estimate.name == "speed of mass.x"
    (text,) = motion.warnings
    assert f"{estimate.share:.2g}" in text and "rtol" in text


def test_a_run_goes_on_with_the_method_it_ended_with():
    model = buffered(1e6, 1e6)
    whole = da.solve_dynamics(model, 0.5).continued(0.5)
    rate = np.roots([1.0, 1e6, 1e6 + 100.0])[1]
    ratio = whole["mass.x"].values[-1] / np.interp(0.5, whole.time, whole["mass.x"].values)
    assert ratio == pytest.approx(np.exp(0.5 * rate), rel=1e-4)


def test_batches_of_default_runs_are_the_single_runs():
    """Side by side where the problem is not stiff; stiff designs run on their own."""
    model = buffered(1e3, 10.0, push=100.0)
    stiffness = [1e2, 1e3, 1e6]
    damped = da.solve_dynamics(model, 1.0, parameters={"k": stiffness})
    alone = [da.solve_dynamics(model, 1.0, parameters={"k": k}, outputs=201) for k in stiffness]
    assert damped.succeeded.all()
    for k, single in enumerate(alone):
        error = np.abs(damped["mass.x"][k].values - single["mass.x"].values).max()
        assert error < 1e-12 * np.abs(single["mass.x"].values).max()
    stiff = buffered(1e6, 1e6, push=100.0)
    batch = da.solve_dynamics(stiff, 1.0, parameters={"k": [1e6, 2e6]})
    assert batch.succeeded.all() and batch.statistics["designs run on their own"] == 2


def test_what_acts_for_a_short_time_is_not_stepped_over():
    """A mass in uniform motion crosses a narrow barrier and many marks; another one is faster."""
    system = da.System("barrier")
    mass = system.add(planar.Particle("mass", mass=1.0, velocity=(1, 0)))
    system.add(planar.Particle("other", mass=1.0, velocity=(10, 0)))
    push = 10 * da.exp(-(((mass.x - 7.3) / 0.02) ** 2))
    system.add(planar.Force("barrier", mass.center, (push, 0)))
    marks = da.Event("sin(20*mass.x)", direction=1)
    motion = da.solve_dynamics(system.build(), 10.0, events={"marks": marks})
    work = 10 * 0.02 * np.sqrt(np.pi)
    assert motion.values("mass.vx")[-1] == pytest.approx(np.sqrt(1 + 2 * work), rel=10 * RTOL)
    assert len(motion.events) == int(20 * motion.values("mass.x")[-1] / (2 * np.pi))


@pytest.mark.thorough
def test_a_small_motion_below_the_absolute_tolerance_is_reported_with_a_remedy():
    def vibration(**options):
        system = da.System("small")
        mass = system.add(planar.Particle("mass", mass=1.0, velocity=(1e-4, 0)))
        system.add(planar.Particle("other", mass=1.0, velocity=(0, 1e-4)))
        system.add(planar.Force("spring", mass.center, (-1e4 * mass.x, 0)))
        motion = da.solve_dynamics(system.build(), 10.0, **options)
        return motion, np.abs(motion.values("mass.vx") / 1e-4 - np.cos(100 * motion.time)).max()

    motion, error = vibration()
    (text,) = motion.warnings or [""]
    assert error < 10 * RTOL or "smaller rtol and atol" in text
    fine, error = vibration(integrator=da.AutomaticIntegrator(1e-8, 1e-16))
    assert error < 10 * RTOL and not fine.warnings
