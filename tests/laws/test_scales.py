"""Natural units of a mechanism: covariant under any change of units, and told by every kind."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.model.graph.absolute import absolute_equations
from dalembert.model.graph.assembly.guesses import Guesses
from dalembert.model.graph.description import Description
from dalembert.model.graph.natural_units import body_sizes, scales_of

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


@pytest.mark.parametrize("solve", [da.solve_nonsmooth, da.solve_dynamics])
@pytest.mark.parametrize("distance", [0.0, 1e3, 1e5])
def test_bodies_far_from_the_origin_do_not_overlap(solve, distance):
    """Rounded numbers do not explain an overlap of a thousandth of the radius, wherever it is."""
    with pytest.raises(da.AnalysisError, match=r"0\.0001 m"):
        solve(disc_on_a_floor((distance, -distance), 0.0999).build(), 0.1, step=1e-3)


def test_a_large_body_does_not_hide_the_overlap_of_a_small_one():
    system = disc_on_a_floor((0.0, 0.0))
    rock = system.add(planar.Body("rock", mass=1.0, inertia=10.0, position=(30.0, 5.0)))
    pebble = system.add(planar.Body("pebble", mass=1e-3, inertia=1e-9, position=(3.0, 0.0009)))
    shapes = [(rock, 5.0), (pebble, 1e-3), (system.ground.point(3.0, -1.0), 1.0)]
    shapes = [planar.contact.Circle(at, radius) for at, radius in shapes]
    system.add(planar.Collisions("stones", shapes))
    with pytest.raises(da.AnalysisError, match=r"pebble and a fixed shape overlap by 0\.0001 m"):
        da.solve_nonsmooth(system.build(), 0.01, step=1e-3)


def tumbling_box(shift: float, other: float | None = None) -> da.System:
    """A box that falls, at a distance from the origin, and perhaps a disc at rest elsewhere."""
    system, kit = da.System("box", gravity=(0.0, -9.81)), planar.contact
    start = {"angle": 0.4, "velocity": (0.3, -0.25), "angular_velocity": 3.0}
    box = system.add(
        planar.Body("a", mass=1.0, inertia=0.005, position=(shift, shift + 0.2), **start)
    )
    shapes = [kit.Rectangle(box, (0.2, 0.2)), kit.HalfPlane(system.ground.point(shift, shift))]
    if other is not None:
        disc = system.add(planar.Body("b", mass=1.0, inertia=0.005, position=(other, shift + 0.1)))
        shapes.append(kit.Circle(disc, 0.1))
    system.add(planar.Collisions("c", shapes, friction=0.3, restitution=0.6))
    return system


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_places_do_not_change_motions(scheme):
    """Neither a body kilometres away nor the distance of the origin changes rebounds, but for the
    rounding of coordinates."""
    options = {"step": 1e-3, "integrator": scheme}
    names = {"a.x": 1.0, "a.y": 1.0, "a.angle": 0.0}

    def motion(system: da.System, shift: float) -> np.ndarray:
        run = da.solve_nonsmooth(system.build(), 0.4, **options)
        assert run.status.success
        return np.array([run[name].values - share * shift for name, share in names.items()])

    alone = motion(tumbling_box(0.0), 0.0)
    np.testing.assert_allclose(motion(tumbling_box(1e3), 1e3), alone, rtol=0, atol=1e-8)
    np.testing.assert_allclose(motion(tumbling_box(0.0, 1e3), 0.0), alone, rtol=0, atol=1e-8)


@pytest.mark.few(2)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("radius", [1e-6, 1e-12])
def test_a_ball_like_a_point_bounces_as_a_point(scheme, radius):
    """A fall from 1 m, a bounce with half the speed to 0.25 m at 0.4515 s + 0.2258 s."""
    system = da.System("point", gravity=(0.0, -9.81))
    place = {"position": (0.0, 1.0 + radius), "velocity": (0.3, 0.0)}
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.5 * radius**2, **place))
    shapes = [planar.contact.Circle(ball, radius), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, restitution=0.5))
    run = da.solve_nonsmooth(system.build(), 1.0, step=1e-3, integrator=scheme)
    assert run.status.success
    t, height = np.asarray(run.time), run["ball.y"].values
    highest = int(np.argmax(np.where(t > 0.46, height, 0.0)))
    assert t[highest] == pytest.approx(1.5 * np.sqrt(2 / 9.81), abs=2e-3)
    assert height[highest] == pytest.approx(0.25, rel=1e-2)


def test_nothing_that_tells_gives_one():
    system = da.System("nothing")
    system.add(planar.Particle("p"))
    scales = system.build().scales
    assert (scales.length, scales.mass, scales.time, scales.force) == (1.0, 1.0, 1.0, 1.0)


@pytest.mark.parametrize("factor", [1e-9, 1.0, 1e9])
def test_size_of_a_beam_is_that_of_its_chords(factor):
    """It has the unit of length of the model."""
    system = da.System("strip on the floor")
    properties = {"axial_rigidity": 1e3, "shear_rigidity": 1e3, "bending_rigidity": 1.0}
    properties |= {"mass_per_length": 1.0, "elements": 4}
    strip = planar.Beam("strip", length=2 * factor, position=(0, factor), angle=0, **properties)
    line = planar.contact.BeamLine(system.add(strip), radius=0.01 * factor)
    shapes = [line, planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes))
    parts = Description(system)
    sizes = body_sizes(parts, absolute_equations(parts), np.zeros(0))
    np.testing.assert_allclose(np.array(list(sizes.values())) / factor, np.full(13, 1 / 6))
