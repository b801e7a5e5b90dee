"""Beams in contact along their length, compared with closed forms.

- A heavy beam with a force in the middle on a flat elastic base, which is Winkler's foundation:
  deflections and moment of Hetényi (1946), *Beams on Elastic Foundation*, section 22.
- A heavy rope over a drum without friction: the tension is the weight per length times the height
  above the free end, so that a spring at the other end determines the lengths on both sides.
"""

from __future__ import annotations

import functools
import math

import pytest

import dalembert as da
from dalembert import planar

kit = planar.contact
G = 9.81


def winkler(elements: int) -> tuple[dict[str, float], dict[str, float]]:
    """Computed and published depths at the middle and the end, and moment in the middle."""
    length, bending, k, force, mass = 2.0, 50.0, 4e3, 1.0, 3.0
    system = da.System("beam on a base", gravity=(0, -G))
    rigid = {"axial_rigidity": 1e6, "shear_rigidity": 1e7, "bending_rigidity": bending}
    place = {"position": (-length / 2, -mass * G / k), "angle": 0.0}
    half = {"length": length / 2, "mass_per_length": mass, "elements": elements, **rigid}
    left = system.add(planar.Beam("left", **half, **place))
    right = system.add(planar.Beam("right", left.end, **half))
    floor, law = kit.HalfPlane(system.ground.center), kit.KelvinVoigt(stiffness=k * length / 2)
    for beam in (left, right):
        system.add(planar.Contact(f"under_{beam.name}", floor, kit.BeamLine(beam), law=law))
    system.add(planar.PinInSlot("guide", system.ground.center, left.end.center, axis=(0, 1)))
    system.add(planar.Force("push", left.end, (0, -force)))
    rest = da.solve_equilibrium(system.build())
    assert rest.status.success
    computed = {
        "middle": -rest["left.end.y"].item() - mass * G / k,
        "end": -rest["right.end.y"].item() - mass * G / k,
        "moment": rest["left.end_bending_moment"].item(),
        "force": rest["under_left.force"].item() + rest["under_right.force"].item(),
    }
    number = (k / (4 * bending)) ** 0.25
    x, total = number * length, math.sinh(number * length) + math.sin(number * length)
    published = {
        "middle": force * number / (2 * k) * (math.cosh(x) + math.cos(x) + 2) / total,
        "end": 2 * force * number / k * math.cosh(x / 2) * math.cos(x / 2) / total,
        "moment": force / (4 * number) * (math.cosh(x) - math.cos(x)) / total,
        "force": force + mass * G * length,
    }
    return computed, published


def test_heavy_beam_on_an_elastic_base():
    (coarse, published), (fine, _) = winkler(2), winkler(4)
    for computed in (coarse, fine):
        assert computed["force"] == pytest.approx(published["force"], rel=1e-9)
    for name, accuracy in (("middle", 1e-4), ("end", 1e-4), ("moment", 2e-3)):
        assert fine[name] == pytest.approx(published[name], rel=accuracy)
    off, off_coarse = (abs(c["moment"] - published["moment"]) for c in (fine, coarse))
    assert off < off_coarse / 8


SPAN, WEIGHT, STIFFNESS = 0.3, 0.5 * G, 60.0
"""Length on each side of the drum, weight per length, and stiffness of the spring."""


@functools.cache
def rope() -> da.Model:
    """A rope over a drum, drawn by a spring."""
    radius, span = 0.1, SPAN
    system = da.System("rope", gravity=(0, -G))
    numbers = {
        "axial_rigidity": 1e4,
        "shear_rigidity": 1e4,
        "bending_rigidity": 1e-5,
        "mass_per_length": 0.5,
    }
    place = {"position": (-radius, -span), "angle": math.pi / 2}
    left = system.add(planar.Beam("left", length=span, **place, **numbers, elements=6))
    arc = {"length": math.pi * radius, "curvature": -1 / radius, "elements": 12}
    wrap = system.add(planar.Beam("wrap", left.end, **arc, **numbers))
    right = system.add(planar.Beam("right", wrap.end, length=span, **numbers, elements=6))
    ground, law = system.ground, kit.KelvinVoigt(stiffness=3e5)
    for beam in (left, wrap, right):
        shapes = kit.Circle(ground.center, radius), kit.BeamLine(beam)
        system.add(planar.Contact(f"on_{beam.name}", *shapes, law=law))
    rail = planar.PinInSlot("rail", ground.point(-radius, 0), left.start.center, axis=(0, 1))
    system.add(rail)
    below = ground.point(-radius, -span - 0.2)
    spring = {"stiffness": STIFFNESS, "free_length": 0.2 + system.parameter("slack", 0.02)}
    system.add(planar.Spring("spring", below, left.start.center, **spring))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("slack", [pytest.param(0.02, marks=pytest.mark.thorough), 0.05])
def test_a_rope_over_a_drum_hangs_in_equilibrium(slack):
    """``w (h_start − h_end) = F``: the spring force is the weight of the difference in heights."""
    span, weight, stiffness = SPAN, WEIGHT, STIFFNESS
    options = {"step": 0.05, "integrator": da.BackwardEuler(), "parameters": {"slack": slack}}
    motion = da.solve_dynamics(rope(), 3.0, **options)
    high, low, force = (
        motion[name].values[-1] for name in ("left.start.y", "right.end.y", "spring.force")
    )
    shift = stiffness * slack / (stiffness - 2 * weight)  # of a rope that does not stretch
    assert high + span == pytest.approx(shift, abs=4e-4)
    assert low + span == pytest.approx(-shift, abs=4e-4)
    assert force == pytest.approx(weight * (high - low), abs=5e-3 * weight * span)
