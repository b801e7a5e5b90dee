"""Beams that are joined at their ends, in ``Collisions``: their neighbouring parts do not touch."""

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

contact = planar.contact
DATA = {"axial_rigidity": 1e4, "shear_rigidity": 1e4, "mass_per_length": 0.3, "order": 1}
BENDING = {2: {"bending_rigidity": 1e-2}, 3: {"torsional_rigidity": 1e-2}}
BENDING[3] |= {"bending_rigidity_y": 1e-2, "bending_rigidity_z": 1e-2}


def closed_gaps(model: da.Model) -> int:
    source = gap_sources(model)[0]
    still = np.zeros((model.equations.speed_count, 1))
    gaps = source.near(Configuration(0.0, model.start.y, model.nominal), still)
    return int((gaps.distance < 0).sum())


@pytest.mark.few(1)
@pytest.mark.parametrize("dimension", [2, 3])
def test_neighbouring_parts_of_joined_beams_do_not_touch(dimension):
    """Short elements of a thick rope overlap over the joint; the hook at its end is a node's."""
    kit = {2: planar, 3: spatial}[dimension]
    system, origin = da.System("row"), (0.0,) * dimension
    data = DATA | BENDING[dimension] | {"elements": 5}
    first = system.add(kit.Beam("first", length=0.1, position=origin, **data))
    end = first.end if dimension == 2 else first.end.frame()
    short = system.add(kit.Beam("short", end, length=0.01, **(data | {"elements": 1})))
    end = short.end if dimension == 2 else short.end.frame()
    last = system.add(kit.Beam("last", end, length=0.1, **data))
    ball = {2: "Circle", 3: "Sphere"}[dimension]
    shapes = [kit.contact.BeamLine(beam, 0.008) for beam in (first, short, last)]
    shapes.append(getattr(kit.contact, ball)(last.end.center, 0.01))
    system.add(kit.Collisions("touch", shapes))
    assert closed_gaps(system.build()) == 0


def test_distant_parts_of_joined_beams_touch():
    """Two halves of a loop that overlap where they are far apart along the rope."""
    system = da.System("loop")
    data = DATA | BENDING[2] | {"length": 0.3, "curvature": 2 * math.pi / 0.6, "elements": 12}
    first = system.add(planar.Beam("first", position=(0, 0), **data))
    second = system.add(planar.Beam("second", first.end, **data))
    system.add(planar.Collisions("touch", [contact.BeamLine(b, 0.005) for b in (first, second)]))
    assert closed_gaps(system.build()) > 0  # the ends of an open ring are at one place


def test_the_full_turn_of_a_closed_belt_is_reported():
    """Planar angles are not periodic: the last clamp of a ring is a full turn after the first."""
    system, half = da.System("ring"), DATA | BENDING[2] | {"length": 0.3, "elements": 6}
    half |= {"curvature": 2 * math.pi / 0.6}
    first = system.add(planar.Beam("first", position=(0, 0), angle=0.0, **half))
    turned = system.parameter("turned", 0.0)
    system.add(planar.Beam("second", first.end, first.start, angle_j=turned, **half))
    model, cure = system.build(), "add 1 times 2 pi to angle_j"
    options = {"step": 1e-3, "integrator": da.BackwardEuler()}
    assert any(cure in text for text in da.solve_dynamics(model, 1e-3, **options).warnings)
    closed = da.solve_dynamics(model, 1e-3, parameters={"turned": 2 * math.pi}, **options)
    assert not closed.warnings
    assert closed["second.strain_energy"].values[-1] < 1e-9
