"""What people see of parts in a notebook is one short line; parts offer what they take."""

import inspect

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures
from dalembert.symbolic.formulas.expression import Expression


def parts() -> list:
    """Elements, points and models of each kind."""
    system = da.System("mechanism", gravity=(0, -9.81))
    length = system.parameter("length", 0.3, "m")
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=0.1))
    pin = system.add(planar.Revolute("pin", system.ground.center, bar.start))
    ball = planar.Particle("ball", mass=1.0, position=(1, 0))
    spring = planar.Spring("spring", bar.end, ball.center, stiffness=10.0)
    model = system.build()
    structure = da.Structure("portal")
    nodes = structure.add_nodes("n", [[0.0, 0.0], [1.0, 0.0]])
    numbers = {"area": 1e-4, "second_moment": 1e-9, "modulus": 2e11, "density": 7800.0}
    frames = structure.add_elements("f", structures.Frame, nodes, [(0, 1)], **numbers)
    built = structure.build()
    flexible = planar.FlexibleBody("arm", built, interface={"a": nodes[0]})
    spatial_body = spatial.Body("plate", mass=1.0, inertia=(1, 1, 1))
    frame = spatial_body.frame((0, 0, 1), axis=(0, 1, 0))
    of_structures = [structure, nodes, nodes[0], frames, built]
    of_space = [spatial_body, frame]
    mechanism = [system, length, bar, bar.end, pin, ball, ball.center, spring, flexible]
    return [*mechanism, model, model.diagnosis, *of_structures, *of_space]


def test_representations_are_short():
    for part in parts():
        text = repr(part)
        assert len(text) < 160 and " object at 0x" not in text and "\n" not in text, text
    bar, pin = parts()[2], parts()[4]
    assert repr(bar).startswith("<Bar 'bar': mass=1 kg") and "length=length m" in repr(bar)
    assert "point_j=bar.start" in repr(pin)


@pytest.mark.parametrize("kinds", [planar, spatial])
def test_particles_take_what_they_use(kinds):
    taken = list(inspect.signature(kinds.Particle).parameters)
    assert taken == ["name", "mass", "position", "velocity", "points"]
    with pytest.raises(da.ModelError, match="p: a particle has no frame"):
        kinds.Particle("p", mass=1.0).frame()


def test_moments_at_both_ends_of_links():
    """That on body i is what its generalised force says of its hinge."""
    system = da.System("links", gravity=(0, 0, -9.81))
    inertia = (0.1, 0.04, 0.1)
    first = system.add(spatial.Body("first", mass=1.0, inertia=inertia, position=(2, 2, 0)))
    second = system.add(spatial.Body("second", mass=1.0, inertia=inertia, position=(3, -1, 0.4)))
    hinge, across = system.ground.frame(axis=(0, 0, 1)), {"axis": (0, 1, 0.3)}
    ball = first.point(-2.0, -4.0, 0.0)
    system.add(spatial.RevoluteSphericalLink("ball", hinge, ball, length=2.0))
    ends = first.frame((0.3, 0.1, 0), **across), second.frame(**across)
    link = system.add(spatial.RevoluteRevoluteLink("link", *ends, length=1.0))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.01)
    force, moment = link._action_on(first)
    arm = link.place() - link.frame_i.position.sx
    own = Expression(ca.densify(moment + ca.cross(arm, force)), "own")
    values = motion["link.moment_i"].values
    np.testing.assert_allclose(motion[own].values, values, atol=1e-12 * np.abs(values).max())
    assert np.abs(motion["ball.moment"].values).max() < 1e-10
    turned = np.abs((motion["ball.moment_i"].values * motion["ball.force"].values).sum(axis=1))
    assert turned.max() < 1e-8  # the moment of a force at a distance is across that force
