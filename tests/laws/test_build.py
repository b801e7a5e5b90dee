"""What ``build`` does: guesses go along the joints, sparse factors, any unit."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from scipy.sparse import linalg

import dalembert as da
from dalembert import planar

BODIES = 300


def chain(bodies: int) -> tuple[da.System, np.ndarray]:
    """Bars of 1 m guessed by their angles alone, and the positions that follow."""
    system = da.System("chain")
    last, corner, places = system.ground.center, np.zeros(2), []
    for k, angle in enumerate(np.linspace(-0.5, -2.0, bodies)):
        rod = system.add(planar.Bar(f"b{k}", length=1.0, mass=1.0, angle=float(angle)))
        system.add(planar.Revolute(f"R{k}", last, rod.start))
        along = np.array([math.cos(angle), math.sin(angle)])
        places.append([*(corner + along / 2), angle])
        last, corner = rod.end, corner + along
    return system, np.array(places)


@pytest.mark.thorough
def test_guesses_go_along_the_joints(monkeypatch):
    """A long chain stands where its angles put it: nothing is left for Newton's method to move."""
    factored = []
    splu = linalg.splu
    monkeypatch.setattr(linalg, "splu", lambda a, *rest: factored.append(a.shape) or splu(a, *rest))
    system, places = chain(BODIES)
    model = system.build()
    np.testing.assert_allclose(model.start.y.reshape(-1, 3), places, atol=1e-10)
    assert max(map(abs, model.start.corrections.values())) < 1e-12
    assert len(factored) <= 8  # of speeds, and a step or two of rounding


@pytest.mark.thorough
def test_no_dense_matrix_is_made():
    """A dense matrix of all coordinates alone would take more than everything made at the most."""
    system, _ = chain(BODIES)
    tracemalloc.start()
    system.build()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    coordinates = 3 * BODIES
    assert peak < 8 * coordinates**2


def test_positions_go_through_welds_and_from_bodies_that_are_given():
    """Angles through welds, against the direction of joints, and from the middle of a chain."""
    system = da.System("train")
    cars = [system.add(planar.Bar(f"c{k}", length=2.0, mass=1.0)) for k in range(4)]
    anchor = system.add(planar.Bar("anchor", length=2.0, mass=1.0, position=(5.0, 1.0), angle=0.3))
    before = anchor
    for car in cars:
        system.add(planar.Weld(f"w{car.name}", car.start, before.end, angle=-0.1))
        before = car
    model = system.build()
    angles = 0.3 + 0.1 * np.arange(5)
    steps = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    places = np.array([5.0, 1.0]) + np.vstack([np.zeros(2), np.cumsum(steps[:-1] + steps[1:], 0)])
    computed = model.start.y.reshape(-1, 3)[[4, 0, 1, 2, 3]]
    np.testing.assert_allclose(computed, np.column_stack([places, angles]), atol=1e-12)


@pytest.mark.parametrize("bodies", [3, 41])
def test_guesses_that_do_not_close_are_corrected(bodies):
    """Cranks 0.1 rad off their parallel: some give way, the first is held as written."""
    system = da.System("four-bars")
    last = None
    for i in range((bodies + 1) // 2):
        off = 0.0 if i == 0 else 0.1 * (-1) ** i
        crank = system.add(planar.Bar(f"c{i}", length=1.0, mass=1.0, angle=1.2 + off))
        system.add(planar.Revolute(f"O{i}", system.ground.point(i, 0.0), crank.start))
        if last is not None:
            coupler = system.add(planar.Bar(f"b{i}", length=1.0, mass=1.0, angle=0.0))
            system.add(planar.Revolute(f"A{i}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{i}", coupler.end, crank.end))
        last = crank
    model = system.build()
    angles = model.start.y[2::3]
    cranks = [body.name.startswith("c") for body in model.bodies]
    np.testing.assert_allclose(angles, np.where(cranks, 1.2, 0.0), atol=1e-9)


def test_what_stands_at_the_end_of_its_way_is_not_held():
    """Of a crank along the x axis, x says nothing of its turn: y is held, and the start follows
    the parameters to the last digits."""
    system = da.System("crank along x")
    r = system.parameter("r", 0.1, "m")
    crank = system.add(planar.Body("crank", mass=1.0, inertia=0.1, position=(r / 2, 0.0)))
    rod = system.add(planar.Bar("rod", length=0.4, mass=1.0, position=(0.1, 0.17), angle=1.2))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=0.1, position=(0.0, 0.35)))
    system.add(planar.Revolute("O", system.ground.center, crank.point(-r / 2, 0.0)))
    system.add(planar.Revolute("A", crank.point(r / 2, 0.0), rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("rail", system.ground.center, slider.center, axis=(0.0, 1.0)))
    model = system.build()
    y = math.sqrt(0.4**2 - 0.1**2)
    assert abs(model.start.y[1]) < 1e-15
    assert abs(model.start.y[7] - y) < 1e-15
    motion = da.solve_dynamics(model, 1e-3, step=1e-3)
    slope = da.sensitivity(motion, da.at(0.0, "slider.y")).item()
    assert abs(slope + 0.1 / y) < 1e-13


def test_what_a_formula_holds_is_connected():
    """A constraint and a stop that are formulas act on the bodies they speak of."""
    system = da.System("formulas")
    held, caught, loose = (system.add(planar.Particle(n, mass=1.0)) for n in ("a", "b", "c"))
    system.add(planar.UserConstraint("wire", held.x - 2 * held.y))
    system.add(planar.Stop("floor", caught.y, lower=0.0, stiffness=1e3))
    messages = [text for _, text in system.build().diagnosis.messages]
    assert messages == [f"body {loose.name} is not connected to anything"]


def test_runs_and_compiled_adjoints_build_only_what_they_use():
    """A run counts the work of a step without building it; an adjoint in stages needs no map."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bar = system.add(da.planar.Bar("bar", length=system.parameter("length", 0.5), mass=1.0))
    system.add(da.planar.Revolute("O", system.ground.center, bar.start))
    model = system.build()
    motion = da.solve_dynamics(model, 0.1, step=0.01)
    assert motion.status.success and not motion.warnings
    (variant,) = motion.analysis.kernel(model).variants
    assert "function" not in vars(variant.step)
    assert variant.step.work == pytest.approx(variant.step.function.n_instructions(), rel=0.2)
    assert variant.step.prepared.compiled_adjoint.numel_out(0) == variant.step.size
    assert "prepared" not in vars(variant.step.rhs)
