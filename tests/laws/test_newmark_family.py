"""One rule of a step: a mass on a spring moves alike, be it a mechanism or a structure."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.integrators.newmark.rule import Moving, StepRule

FAMILY = [da.Newmark(), da.Newmark(beta=1 / 6), da.HHT(alpha=0.2), da.GeneralizedAlpha(rho_inf=0.6)]
IDS = ["average", "linear", "HHT", "generalised-alpha"]
FORCE = 1.5 * da.cos(2 * da.t)


def mechanism(integrator):
    """A particle on a spring to the ground, 1.3 kg and 9 N/m."""
    system = da.System("mass on a spring")
    k = system.parameter("k", 9.0)
    mass = system.add(planar.Particle("mass", mass=1.3, position=(1.0, 0.0)))
    wall = system.ground.point(-4, 0)
    system.add(planar.Spring("spring", wall, mass.center, stiffness=k, free_length=5))
    system.add(planar.Force("force", mass.center, (FORCE, 0.0)))
    motion = da.solve_dynamics(system.build(), 2.0, step=0.02, integrator=integrator)
    return motion, ("mass.x", "mass.vx", "mass.ax"), 1.0


def structure(integrator):
    """A bar whose lumped mass at the end is 1.3 kg, and whose stiffness is 9 N/m."""
    s = da.Structure("mass on a spring")
    k = s.parameter("k", 9.0)
    a, b = s.node("a", 0.0), s.node("b", 1.0)
    s.add(structures.Truss("bar", a, b, area=1.0, modulus=k, density=2.6))
    s.support(a)
    s.load(b, fx=FORCE)
    motion = da.solve_transient(s.build(), 2.0, step=0.02, integrator=integrator, lumped=True)
    return motion, ("b.ux", "b.vx", "b.ax"), 0.0


@pytest.mark.few(2)
@pytest.mark.parametrize("integrator", FAMILY, ids=IDS)
def test_mechanisms_and_structures_take_the_same_steps(integrator):
    """The force begins level, so that methods with memory begin alike as well."""
    results = []
    for solve in (mechanism, structure):
        motion, names, offset = solve(integrator)
        values = np.array([motion.values(motion.model.expression(name)) for name in names])
        values[0] -= offset
        slope = da.sensitivity(motion, [da.final(name) for name in names], method="adjoint").values
        results.append((values, slope))
    (values, slopes), (others, other_slopes) = results
    np.testing.assert_allclose(values, others, atol=1e-11)
    np.testing.assert_allclose(slopes, other_slopes, atol=1e-10)


@pytest.mark.parametrize("integrator", FAMILY, ids=IDS)
def test_the_transpose_of_the_rule_is_its_transpose(integrator):
    """``⟨w, x⁺⟩`` is what the weights of start and acceleration say, for any numbers."""
    rule, rng = StepRule.of(integrator.coefficients, 0.3), np.random.default_rng(0)
    x, w, a = Moving(*rng.normal(size=(4, 5))), Moving(*rng.normal(size=(4, 5))), rng.normal(size=5)
    course = rule.corrected(rule.predicted(x.v, x.a, x.s), a)
    after = Moving(x.u + rule.h * course.mean, course.end, a, rule.memory(course, a))
    before = sum(p @ q for p, q in zip(rule.weigh_start(w), x, strict=True))
    whole = sum(p @ q for p, q in zip(w, after, strict=True))
    assert before + rule.weigh_acceleration(w) @ a == pytest.approx(whole, rel=1e-12)
