"""Searches before an assembly is refused, branch ends, undefined angles and idle rotations."""

from __future__ import annotations

import numpy as np
import pytest
from test_all_assemblies import three_legs

import dalembert as da
from dalembert import planar, spatial

SOLID = {"mass": 1.0, "inertia": (1.0, 1.0, 1.0)}


def loop_of_hinges(seed: int) -> da.System:
    """Six hinges that close where all bodies lie as the ground does; poses given at random."""
    rng = np.random.default_rng(seed)
    axes, places = rng.normal(size=(6, 3)), rng.uniform(-1, 1, (6, 3))
    system = da.System("loop")
    solids = [system.ground]
    for k in range(5):
        turn = da.rotation.axis_angle(tuple(rng.normal(size=3)), rng.uniform(-3, 3))
        place = tuple(rng.uniform(-3, 3, 3))
        solids.append(system.add(spatial.Body(f"b{k}", position=place, rotation=turn, **SOLID)))
    for k in range(6):
        frames = (solids[j % 6].frame(tuple(places[k]), axis=tuple(axes[k])) for j in (k, k + 1))
        system.add(spatial.Revolute(f"J{k}", *frames))
    return system


@pytest.mark.parametrize("seeds", [(2,), pytest.param((5, 9), marks=pytest.mark.thorough)])
def test_loops_are_assembled_from_poor_guesses(seeds):
    """All of them close somewhere; where it took a search, the diagnosis says so."""
    models = [loop_of_hinges(seed).build() for seed in seeds]
    assert all(model.start.residual < 1e-10 for model in models)
    messages = [
        text for model in models for level, text in model.diagnosis.messages if "far" in text
    ]
    assert messages and all("random starts" in text and "moved" in text for text in messages)


@pytest.mark.thorough
def test_the_end_of_a_branch_is_distinguished_from_lengths_that_fit_nowhere():
    ground, triangle = np.array([(0, 0), (5, 0), (2, 6)]), np.array([(0, 0), (3, 0), (1, 2.5)])
    model = three_legs((3.09512671, 0.81252118), 1.08392049, ground, triangle)
    with pytest.raises(da.AssemblyError) as ended:
        da.solve_assembly(model, {"l0": 5.0})
    assert "the branch of the nominal assembly ends at l0 = " in str(ended.value)
    assert "before l0 = 5 m" in str(ended.value) and ended.value.others == 2
    assemblies = da.solve_assembly(model, {"l0": 5.0}, all=True)
    assert len(assemblies) == 2 and "none is on the branch" in assemblies.note
    for call in (da.solve_assembly, lambda *a: da.solve_assembly(*a, all=True)):
        with pytest.raises(da.AssemblyError) as refused:
            call(model, {"l0": 12.0})
        assert "cannot be assembled" in str(refused.value) and refused.value.others == 0
        assert "no start of 300 random ones" in str(refused.value)
        assert "leg0 (ground, plate) requires 12 m, at most" in str(refused.value)


def test_a_held_guess_that_cannot_be_kept_is_named():
    """A crank at 2 rad is out of reach of a coupler of 0.3 m, other angles are not."""
    system = da.System("four-bar")
    length = system.parameter("coupler_length", 1.0, "m")
    bars = [
        system.add(planar.Bar("crank", length=1.0, mass=1, angle=2.0)),
        system.add(planar.Bar("coupler", length=length, mass=1)),
        system.add(planar.Bar("rocker", length=1.2, mass=1)),
    ]
    system.add(planar.Revolute("O", system.ground.center, bars[0].start))
    system.add(planar.Revolute("A", bars[0].end, bars[1].start))
    system.add(planar.Revolute("B", bars[1].end, bars[2].end))
    system.add(planar.Revolute("C", system.ground.point(1, 0), bars[2].start))
    with pytest.raises(da.AssemblyError, match=r"not with crank\.angle as given"):
        da.solve_assembly(system.build(), {"coupler_length": 0.3})


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (1, 2, -2)])
@pytest.mark.parametrize("base", [(1, 0, 0), (0, 0, 1)])
def test_a_driven_hinge_starts_from_any_guess(base, axis):
    """The axes become parallel, and the angle is that of the law."""
    system = da.System("rotor")
    rotor = system.add(spatial.Body("rotor", rotation=da.rotation.identity(), **SOLID))
    frames = system.ground.frame((0, 0, 0), axis=base), rotor.frame((0, 0, 0), axis=axis)
    hinge = system.add(spatial.Revolute("hinge", *frames))
    system.add(spatial.RotationalDriver("motor", hinge, 0.3 + 0 * da.t))
    model = system.build()
    assert model.start.residual < 1e-12
    e0, e = model.start.y[3], model.start.y[4:7]
    unit = np.array(axis) / np.linalg.norm(axis)
    turned = unit + 2 * np.cross(e, np.cross(e, unit) + e0 * unit)
    assert abs(turned @ base) == pytest.approx(1.0, abs=1e-12)
    motion = da.solve_kinematics(model, 1e-3, outputs=2)
    assert motion["hinge.angle"].values == pytest.approx([0.3, 0.3], abs=1e-9)


def rssr(spring: bool = False, ball: bool = True) -> da.Model:
    system, still = da.System("RSSR"), da.rotation.identity()
    places = {"crank": (0, 0, 0), "coupler": (1, 0.2, 0.3), "rocker": (2, 0, 0)}
    crank, coupler, rocker = (
        system.add(spatial.Body(name, position=place, rotation=still, **SOLID))
        for name, place in places.items()
    )
    up, side = (0, 0, 1), (0, 1, 0)
    ground = system.ground
    first = ground.frame((0, 0, 0), axis=up), crank.frame((0, 0, 0), axis=up)
    motor = system.add(spatial.Revolute("A", *first))
    last = ground.frame((2, 0, 0), axis=side), rocker.frame((0, 0, 0), axis=side)
    system.add(spatial.Revolute("D", *last))
    pin = crank.point(0.5, 0, 0), coupler.point(-0.5, -0.2, -0.3)
    if ball:
        system.add(spatial.Spherical("B", *pin))
    else:
        frames = crank.frame((0.5, 0, 0), axis=up), coupler.frame((-0.5, -0.2, -0.3), axis=side)
        system.add(spatial.Universal("B", *frames))
    system.add(spatial.Spherical("C", coupler.point(1, 0.1, 0.5), rocker.point(0, 0.3, 0.8)))
    system.add(spatial.RotationalDriver("motor", motor, 1.0 * da.t))
    if spring:
        ends = ground.point(0, 0, 3), coupler.point(0, 1, 0)
        system.add(planar.Spring("spring", *ends, stiffness=10.0, free_length=1.0))
    return system.build()


def telescopic_leg(closed: bool = True) -> da.Model:
    """A leg that carries a plate, which a hinge may hold, too."""
    system, still, up = da.System("leg"), da.rotation.identity(), (0, 0, 1)
    heights = {"plate": 2.0, "cylinder": 0.5, "piston": 1.5}
    plate, cylinder, piston = (
        system.add(spatial.Body(name, position=(0, 0, z), rotation=still, **SOLID))
        for name, z in heights.items()
    )
    system.add(spatial.Spherical("low", system.ground.point(0, 0, 0), cylinder.point(0, 0, -0.5)))
    system.add(spatial.Spherical("high", piston.point(0, 0, 0.5), plate.point(0, 0, 0)))
    slide = cylinder.frame((0, 0, 0), axis=up), piston.frame((0, 0, -1), axis=up)
    system.add(spatial.Prismatic("slide", *slide))
    if closed:
        ends = (
            system.ground.frame((1, 0, 2), axis=(0, 1, 0)),
            plate.frame((1, 0, 0), axis=(0, 1, 0)),
        )
        system.add(spatial.Revolute("side", *ends))
    return system.build()


def gate() -> da.Model:
    """A body on two balls of the ground has a motion of its own, no idle one."""
    system = da.System("gate")
    leaf = system.add(
        spatial.Body("leaf", position=(1, 0, 0), rotation=da.rotation.identity(), **SOLID)
    )
    for name, z in (("B", 0.0), ("C", 1.0)):
        ends = system.ground.point(0, 0, z), leaf.point(-1, 0, z)
        system.add(spatial.Spherical(name, *ends))
    return system.build()


def test_idle_rotations_are_named_and_nothing_else():
    (text,) = rssr().diagnosis.idle
    assert "coupler turns freely about the line through joints B and C: idle" in text
    assert ("info", text) in rssr().diagnosis.messages
    (text,) = telescopic_leg().diagnosis.idle
    assert "cylinder and piston together turn freely" in text and "low and high" in text
    others = rssr(spring=True), rssr(ball=False), gate(), telescopic_leg(closed=False)
    for model in others:
        assert not model.diagnosis.idle, model.name
