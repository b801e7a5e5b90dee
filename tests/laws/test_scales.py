"""Natural units of a mechanism: covariant under any change of units, and told by every kind."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.model.graph.absolute import absolute_equations
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.description import Description
from dalembert.model.graph.natural_units import scales_of

SIZES = [1.0, 1e-9, 2.0**-40, 1e9, 3.7]


def scales(system):
    """Scales before anything is assembled."""
    parts = Description(system)
    return scales_of(parts, absolute_equations(parts), Guesses.collect(parts), np.zeros(0))


def crank_on_springs(length=1.0, mass=1.0, time=1.0):
    """Every kind of quantity, written in other units: a sprung slider crank."""
    g = length / time**2
    system = da.System("engine", gravity=(0.3 * g, -9.81 * g))
    speed = 2.0 / time
    crank = system.add(
        planar.Bar("crank", length=0.3 * length, mass=1.5 * mass, angle=1.0, angular_velocity=speed)
    )
    rod = system.add(planar.Bar("rod", length=1.0 * length, mass=5.0 * mass, angle=-0.25))
    place = (1.1 * length, 0.0)
    piston = system.add(planar.Body("piston", mass=mass, inertia=mass * length**2, position=place))
    origin = system.ground.point(0, 0)
    system.add(planar.Revolute("O", origin, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, piston.center))
    system.add(planar.Prismatic("guide", origin, piston.center))
    stiffness = 40.0 * mass / time**2
    system.add(
        planar.Spring("s", origin, piston.center, stiffness=stiffness, free_length=0.4 * length)
    )
    return system


@pytest.mark.parametrize("factor", SIZES)
@pytest.mark.parametrize("unit", ["length", "mass", "time"])
def test_scales_change_with_the_units_only(unit, factor):
    one, other = scales(crank_on_springs()), scales(crank_on_springs(**{unit: factor}))
    units = {"length": 1.0, "mass": 1.0, "time": 1.0} | {unit: factor}
    length, mass, time = units.values()
    expected = {"length": length, "mass": mass, "time": time, "force": mass * length / time**2}
    for name, size in expected.items():
        np.testing.assert_allclose(getattr(other, name), size * getattr(one, name), rtol=1e-13)
    sizes = np.where(one.coordinates == one.length, length, 1.0)
    np.testing.assert_allclose(other.coordinates, sizes * one.coordinates, rtol=1e-13)


def test_rows_and_coordinates_follow_their_units():
    scales = crank_on_springs().build().scales
    arm = scales.length
    assert arm == pytest.approx(0.5, rel=1e-12)  # of the rod, from its middle to its end
    assert scales.rows.tolist() == [arm] * 7 + [1.0]
    assert scales.coordinates.tolist() == [arm, arm, 1.0] * 3
    np.testing.assert_allclose(scales.speeds * scales.time, scales.coordinates)
    np.testing.assert_allclose(scales.efforts * scales.coordinates, scales.energy)


def test_a_point_that_falls_has_the_scale_of_its_position():
    system = da.System("fall", gravity=(0.0, -9.81))
    system.add(planar.Particle("p", mass=2.0, position=(3.0, -4.0)))
    scales = system.build().scales
    assert (scales.length, scales.mass, scales.force) == (4.0, 2.0, pytest.approx(19.62))


def disc_on_a_floor(place: tuple[float, float], height: float = 0.1) -> da.System:
    """A disc of radius 0.1 at a height over a floor through a place."""
    system, kit = da.System("disc", gravity=(0.0, -9.81)), planar.contact
    start = {"position": (place[0], place[1] + height), "velocity": (1.0, 0.0)}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.005, **start))
    shapes = [kit.Circle(disc, 0.1), kit.HalfPlane(system.ground.point(*place))]
    system.add(planar.Collisions("floor", shapes, friction=0.3))
    return system


def test_a_position_near_the_origin_is_no_size():
    """The rounding of a position such as ``cos(π/2)`` would be the unit of all thresholds."""
    model = disc_on_a_floor((0.0, -0.1), 0.1 + 1e-14).build()
    assert model.scales.length == 0.1
    assert da.solve_nonsmooth(model, 0.3, step=2e-3).status.success


def test_nothing_that_tells_gives_one():
    system = da.System("nothing")
    system.add(planar.Particle("p"))
    scales = system.build().scales
    assert (scales.length, scales.mass, scales.time, scales.force) == (1.0, 1.0, 1.0, 1.0)
