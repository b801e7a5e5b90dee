"""An elastic connecting rod as a body with few shapes, against a geometrically exact beam.

Data of Simeon (Modelling a flexible slider crank mechanism by a mixed system of DAEs and PDEs,
Mathematical Modelling of Systems 2, 1996): a steel rod, driven at 150 rad/s, which bends by more
than half a per cent of its length and carries the force of the piston while it does.
"""

import itertools

import numpy as np
import pytest
from scipy.linalg import null_space

import dalembert as da
from dalembert import planar
from dalembert.structures import Frame

CRANK, ROD, WIDTH, SPEED, PISTON = 0.15, 0.3, 0.008, 150.0, 0.0755
MODULUS, DENSITY = 2e11, 7870.0
AREA, SECOND = WIDTH**2, WIDTH**4 / 12


def with_rod(make) -> tuple[da.System, object]:
    """The mechanism; ``make`` adds the rod and returns its ends."""
    system = da.System("elastic slider-crank")
    crank = system.add(planar.Bar("crank", length=CRANK, mass=0.36, angle=0.0))
    start, end = make(system)
    piston = system.add(planar.Particle("piston", mass=PISTON, position=(CRANK + ROD, 0.0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, start))
    system.add(planar.Revolute("B", end, piston.center))
    system.add(planar.PinInSlot("guide", system.ground.center, piston.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, SPEED * da.t))
    return system


def by_shapes(system: da.System):
    structure = da.Structure("rod")
    section = {"area": AREA, "second_moment": SECOND, "modulus": MODULUS, "density": DENSITY}
    nodes = [structure.node(f"n{k}", ROD * k / 8, 0.0) for k in range(9)]
    for k, ends in enumerate(itertools.pairwise(nodes)):
        structure.add(Frame(f"e{k}", *ends, **section))
    rod = planar.FlexibleBody(
        "rod",
        structure.build(),
        interface={"start": "n0", "middle": "n4", "end": "n8"},
        modes=1,
        reference="start",
        stiffening=True,
        angle=0.0,
    )
    system.add(rod)
    return rod.point("start"), rod.point("end")


def exact(system: da.System):
    rod = planar.Beam(
        "rod",
        length=ROD,
        axial_rigidity=MODULUS * AREA,
        shear_rigidity=100 * MODULUS * AREA,  # slender: the shapes know no shear
        bending_rigidity=MODULUS * SECOND,
        mass_per_length=DENSITY * AREA,
        elements=2,
        position=(CRANK, 0.0),
        angle=0.0,
    )
    system.add(rod)
    return rod.start, rod.end


def bend(motion: da.Motion, middle: str) -> np.ndarray:
    """Distance of the middle from the line between the ends, to its left."""
    places = [
        np.c_[motion[f"rod.{at}.x"].values, motion[f"rod.{at}.y"].values]
        for at in ("start", "end", middle)
    ]
    along, off = places[1] - places[0], places[2] - places[0]
    return (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.linalg.norm(along, axis=1)


@pytest.fixture(scope="module")
def shapes() -> da.Motion:
    model = with_rod(by_shapes).build()
    return da.solve_dynamics(model, 0.05, step=1e-4, integrator=da.HHT())


@pytest.mark.thorough
def test_bend(shapes):
    assert shapes.status.success
    beam = da.solve_dynamics(with_rod(exact).build(), 0.05, step=1e-4, integrator=da.HHT())
    assert beam.status.success
    expected, computed = bend(beam, "node3"), bend(shapes, "middle")
    np.testing.assert_allclose(computed, expected, atol=0.05 * abs(expected).max())
    assert abs(computed).max() == pytest.approx(abs(expected).max(), rel=0.01)


@pytest.mark.thorough
def test_other_steps_find_the_same(shapes):
    """The first bend, which a mass matrix that is not positive definite breaks at any step."""
    run = da.solve_dynamics(shapes.model, 0.05, step=2e-4, integrator=da.HHT())
    assert run.status.success
    assert abs(bend(run, "middle")).max() == pytest.approx(
        abs(bend(shapes, "middle")).max(), rel=0.01
    )


def test_inertia_stays_positive(shapes):
    """In all that the joints leave free, at several times the bend of the run."""
    import casadi as ca

    e, p = shapes.model.equations, shapes.parameters
    mass = ca.Function("mass", [e.y, e.p], [e.mass])
    joints = ca.Function("joints", [e.t, e.y, e.p], [e.jacobian])
    rest = shapes.data["coordinates"].values[0]
    worst = int(np.argmax(abs(bend(shapes, "middle"))))
    bent = shapes.data["coordinates"].values[worst]
    first = [str(c).split(".")[-1] == "q1" for c in shapes.data["coordinate"].values]
    moved = [str(c).startswith("rod.q") for c in shapes.data["coordinate"].values]
    assert sum(first) == 1

    def least(y: np.ndarray) -> float:
        free = null_space(joints(float(shapes.time[worst]), y, p).full())
        return np.linalg.eigvalsh(free.T @ mass(y, p).full() @ free)[0]

    for times in (1, 3, 10):
        y = np.where(moved, rest + times * (bent - rest), bent)
        assert least(y) > 0
