"""Models with rigid contacts and parameters of all kinds, for laws of gradients."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import dalembert as da
from dalembert import planar, spatial


@dataclass(frozen=True)
class ContactModel:
    """A model and a run in which contacts open, close, stick and slip.

    Attributes
    ----------
    build : returns the model
    duration, step : of the run [s]
    """

    build: Callable[[], da.Model]
    duration: float
    step: float


def bouncing_ball() -> da.Model:
    """Restitution, friction, mass, radius, gravity, start and position of the floor."""
    system = da.System("ball", gravity=(0.3, -9.81))
    height, speed = system.parameter("height", 0.2, "m"), system.parameter("speed", 0.4, "m/s")
    size, mass = system.parameter("radius", 0.1, "m"), system.parameter("mass", 1.2, "kg")
    friction, bounce = system.parameter("friction", 0.3), system.parameter("bounce", 0.5)
    floor = system.parameter("floor", 0.01, "m")
    start = {"position": (0.0, height), "velocity": (speed, 0.0), "angle": 0.1}
    ball = system.add(planar.Body("ball", mass=mass, inertia=0.4 * mass * size**2, **start))
    shapes = [planar.contact.Circle(ball, size)]
    shapes.append(planar.contact.HalfPlane(system.ground.point(0.0, floor)))
    system.add(planar.Collisions("floor_contact", shapes, restitution=bounce, friction=friction))
    return system.build()


def rocking_block() -> da.Model:
    """Corners that turn about the floor."""
    system = da.System("block", gravity=(0.0, -9.81))
    width, angle = system.parameter("width", 0.2, "m"), system.parameter("angle", 0.1, "rad")
    friction = system.parameter("friction", 0.5)
    block = planar.Body("block", mass=1.0, inertia=0.02, position=(0.0, 0.33), angle=angle)
    shapes = [planar.contact.Rectangle(system.add(block), (width, 0.6))]
    shapes.append(planar.contact.HalfPlane(system.ground))
    system.add(planar.Collisions("floor_contact", shapes, friction=friction))
    return system.build()


def pendulum_at_a_moving_wall() -> da.Model:
    """Joints, and a gap stated by a formula of time."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length, pace = system.parameter("length", 0.5, "m"), system.parameter("pace", 3.0, "rad/s")
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=-0.6))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    gap = bar.end.x - 0.05 * da.cos(pace * da.t)
    system.add(planar.UnilateralConstraint("wall", gap, restitution=0.6))
    return system.build()


def driven_rod_and_disc() -> da.Model:
    """A driven rod that pushes a disc over the floor, by friction at both."""
    system = da.System("pusher", gravity=(0.0, -9.81))
    rate, size = system.parameter("rate", 2.0, "rad/s"), system.parameter("size", 0.1, "m")
    friction, length = system.parameter("friction", 0.2), system.parameter("length", 0.3, "m")
    rod = system.add(planar.Bar("rod", length=length, mass=0.5, angle=-np.pi / 2))
    system.add(planar.Revolute("O", system.ground.point(0.0, 0.35), rod.start))
    law = rate * da.t - np.pi / 2
    system.add(planar.RotationalDriver("motor", system.ground, rod, law))
    disc = planar.Body("disc", mass=1.0, inertia=0.005, position=(0.15, size), angle=0.0)
    shapes = [planar.contact.Circle(system.add(disc), size)]
    shapes.append(planar.contact.Capsule(rod.start, rod.end, 0.02))
    shapes.append(planar.contact.HalfPlane(system.ground))
    system.add(planar.Collisions("touch", shapes, friction=friction))
    return system.build()


def discs_in_a_box() -> da.Model:
    """Many contacts at once, one of them of a light disc that approaches slowly."""
    system = da.System("discs", gravity=(0.0, -9.81))
    size, friction = system.parameter("size", 0.1, "m"), system.parameter("friction", 0.3)
    mass, width = system.parameter("mass", 2.0, "kg"), system.parameter("width", 0.66, "m")
    shapes: list[planar.contact.Shape] = []
    for k in range(6):
        row, column = divmod(k, 3)
        place = 0.2 * column - 0.19 + 0.013 * row, 0.105 + 0.203 * row
        disc = planar.Body(
            f"disc{k}", mass=mass * (1 + k), inertia=0.01, position=place, velocity=(0.1 * k, -0.3)
        )
        shapes.append(planar.contact.Circle(system.add(disc), size))
    shapes.append(planar.contact.HalfPlane(system.ground))
    for side in (-0.5, 0.5):
        wall = system.ground.point(side * width, 0.0)
        shapes.append(planar.contact.HalfPlane(wall, normal=(-2 * side, 0.0)))
    system.add(planar.Collisions("box", shapes, friction=friction))
    return system.build()


def discs_of_many_sizes() -> da.Model:
    """Radius, mass and velocity of each disc in a box are parameters of their own."""
    system = da.System("sizes", gravity=(0.0, -9.81))
    friction, bounce = system.parameter("friction", 0.3), system.parameter("bounce", 0.2)
    shapes: list[planar.contact.Shape] = []
    for k in range(12):
        row, column = divmod(k, 4)
        size = system.parameter(f"size{k}", 0.1 - 0.002 * (k % 3), "m")
        mass = system.parameter(f"mass{k}", 1.0 + 0.1 * k, "kg")
        across = system.parameter(f"across{k}", 0.05 * (k % 5) - 0.1, "m/s")
        fall = system.parameter(f"fall{k}", -0.4 - 0.02 * k, "m/s")
        place = 0.21 * column - 0.315 + 0.017 * row, 0.104 + 0.204 * row
        start = {"position": place, "velocity": (across, fall), "inertia": mass * size**2 / 2}
        disc = system.add(planar.Body(f"disc{k}", mass=mass, **start))
        shapes.append(planar.contact.Circle(disc, size))
    shapes.append(planar.contact.HalfPlane(system.ground))
    for side in (-0.5, 0.5):
        wall = system.ground.point(0.9 * side, 0.0)
        shapes.append(planar.contact.HalfPlane(wall, normal=(-2 * side, 0.0)))
    system.add(planar.Collisions("box", shapes, friction=friction, restitution=bounce))
    return system.build()


def spheres_that_roll() -> da.Model:
    """Size and velocity of each sphere, sliding, rolling and spinning friction."""
    system = da.System("spheres", gravity=(0.3, 0.0, -9.81))
    friction, rolling = system.parameter("friction", 0.25), system.parameter("rolling", 0.003, "m")
    spinning, bounce = system.parameter("spinning", 0.002, "m"), system.parameter("bounce", 0.3)
    shapes: list[spatial.contact.Shape] = []
    for k in range(3):
        size = system.parameter(f"size{k}", 0.1 + 0.01 * k, "m")
        speed = system.parameter(f"speed{k}", 0.5 - 0.4 * k, "m/s")
        start = {"position": (0.24 * k, 0.02 * k, 0.115 + 0.01 * k), "rotation": np.eye(3)}
        start |= {"velocity": (speed, 0.1, -0.2), "angular_velocity": (0.2, 1.0 + k, 0.7)}
        body = spatial.Body(f"sphere{k}", mass=1.0 + k, inertia=(0.006,) * 3, **start)
        shapes.append(spatial.contact.Sphere(system.add(body), size))
    shapes.append(spatial.contact.HalfSpace(system.ground.frame()))
    law = {"friction": friction, "rolling": rolling, "spinning": spinning, "restitution": bounce}
    system.add(spatial.Collisions("touch", shapes, **law))
    return system.build()


def ball_and_box_in_space() -> da.Model:
    """Friction in two directions, rotations, and features of a box."""
    system = da.System("spatial", gravity=(0.5, 0.0, -9.81))
    size, friction = system.parameter("size", 0.1, "m"), system.parameter("friction", 0.2)
    edge, rolling = system.parameter("edge", 0.2, "m"), system.parameter("rolling", 0.004, "m")
    inertia = (0.01, 0.012, 0.02)
    start = {"velocity": (0.4, 0.2, 0.0), "angular_velocity": (0.3, 2.0, 0.5)}
    ball = spatial.Body(
        "ball", mass=2.0, inertia=inertia, rotation=np.eye(3), position=(0.0, 0.0, 0.13), **start
    )
    box = spatial.Body(
        "box", mass=1.0, inertia=inertia, rotation=np.eye(3), position=(0.02, 0.01, 0.35)
    )
    shapes = [spatial.contact.Sphere(system.add(ball), size)]
    shapes.append(spatial.contact.Box(system.add(box).center, (edge, edge, edge)))
    shapes.append(spatial.contact.HalfSpace(system.ground.frame()))
    law = {"friction": friction, "restitution": 0.3, "rolling": rolling}
    system.add(spatial.Collisions("touch", shapes, **law))
    return system.build()


def thrown_rods(law: str) -> da.Model:
    """Rough impacts of two jointed rods and a ball, with compression and expansion."""
    system = da.System("rods", gravity=(0.0, -9.81))
    bounce, friction = system.parameter("bounce", 0.6), system.parameter("friction", 0.3)
    length, mass = system.parameter("length", 0.5, "m"), system.parameter("mass", 1.0, "kg")
    height, size = system.parameter("height", 0.02, "m"), system.parameter("size", 0.06, "m")
    start = {"position": (0.25, 0.25), "angle": 0.9, "velocity": (0.4, -1.0)}
    rod = system.add(planar.Bar("rod", length=length, mass=mass, **start))
    start = {"position": (0.62, 0.3), "angle": -0.6, "velocity": (0.5, -1.2)}
    other = system.add(planar.Bar("other", length=length, mass=2.0, **start))
    system.add(planar.Revolute("knee", rod.end, other.start))
    start = {"position": (0.95, 0.05 + height), "velocity": (-1.0, -0.8)}
    ball = planar.Body("ball", mass=mass, inertia=0.001, **start)
    floor = planar.contact.HalfPlane(system.ground.point(0.0, -height))
    shapes = [planar.contact.Vertex(rod.start), planar.contact.Vertex(other.end), floor]
    shapes.append(planar.contact.Circle(system.add(ball), size))
    coefficients = {"restitution": bounce, "friction": friction, "impact_law": law}
    system.add(planar.Collisions("hits", shapes, **coefficients))
    return system.build()


def thrown_box(law: str) -> da.Model:
    """A box in space hits a floor with two of its edges, one after the other, and slips."""
    system = da.System("box", gravity=(0.0, 0.0, -9.81))
    bounce, friction = system.parameter("bounce", 0.5), system.parameter("friction", 0.25)
    edge, mass = system.parameter("edge", 0.2, "m"), system.parameter("mass", 1.0, "kg")
    start = {"velocity": (1.2, 0.8, -1.0), "angular_velocity": (1.0, -2.0, 0.5)}
    start["inertia"] = (0.006 * mass, 0.008 * mass, 0.007 * mass)
    start["rotation"] = [[0.96, 0.0, 0.28], [0.0, 1.0, 0.0], [-0.28, 0.0, 0.96]]
    box = spatial.Body("box", mass=mass, position=(0, 0, 0.14), **start)
    shapes = [spatial.contact.Box(system.add(box).center, (edge, edge, edge))]
    shapes.append(spatial.contact.HalfSpace(system.ground.frame()))
    coefficients = {"restitution": bounce, "friction": friction, "impact_law": law}
    system.add(spatial.Collisions("floor_contact", shapes, **coefficients))
    return system.build()


def compliant_box_and_disc() -> da.Model:
    """Force laws, one of which begins and ends; corners that turn, and friction that stops."""
    system = da.System("soft", gravity=(0.0, -10.0))
    stiffness, damping = system.parameter("stiffness", 1e5, "N/m"), system.parameter("d", 5.0)
    width, friction = system.parameter("width", 0.2, "m"), system.parameter("friction", 0.2)
    hertz, exponent = system.parameter("hertz", 3e5), system.parameter("exponent", 1.5)
    size, mass = system.parameter("size", 0.1, "m"), system.parameter("mass", 1.0, "kg")
    start = {"position": (0.0, 0.1), "angle": 0.5, "velocity": (1.0, -0.5)}
    box = system.add(planar.Body("box", mass=mass, inertia=0.004, **start))
    start = {"position": (0.5, 0.11), "velocity": (0.5, -1.0)}
    disc = system.add(planar.Body("disc", mass=2.0, inertia=0.004 * mass, **start))
    shapes = {
        "box": [planar.contact.Rectangle(box.center, (width, 0.1))],
        "disc": [planar.contact.Circle(disc, size)],
        "floor": [planar.contact.HalfPlane(system.ground)],
    }
    law = planar.contact.KelvinVoigt(stiffness=stiffness, damping=damping)
    other = planar.contact.HuntCrossley(stiffness=hertz, damping=0.3, exponent=exponent)
    pair = planar.contact.Pair(("disc", "floor"), law=other)
    system.add(planar.Collisions("touch", shapes, law=law, friction=friction, pairs=[pair]))
    return system.build()


def disc_on_a_soft_disc() -> da.Model:
    """A compliant contact of two discs on a rigid floor."""
    system = da.System("mixed", gravity=(0.0, -10.0))
    stiffness, height = system.parameter("stiffness", 1e4, "N/m"), system.parameter("height", 0.32)
    mass, friction = system.parameter("mass", 2.0, "kg"), system.parameter("friction", 0.3)
    low = planar.Body("low", mass=1.0, inertia=0.005, position=(0.0, 0.101))
    high = planar.Body("high", mass=mass, inertia=0.01, position=(0.01, height))
    shapes = {
        "discs": [planar.contact.Circle(system.add(disc), 0.1) for disc in (low, high)],
        "floor": [planar.contact.HalfPlane(system.ground)],
    }
    law = planar.contact.KelvinVoigt(stiffness=stiffness, damping=200.0)
    pair = planar.contact.Pair(("discs", "discs"), law=law)
    system.add(planar.Collisions("all", shapes, friction=friction, pairs=[pair]))
    return system.build()


def spatial_links() -> da.Model:
    """A double pendulum in space with a spring and a damper, which hits a floor."""
    system = da.System("links", gravity=(0.0, 0.3, -9.81))
    length, mass = system.parameter("length", 0.5, "m"), system.parameter("mass", 1.0, "kg")
    stiffness, damping = system.parameter("stiffness", 60.0, "N/m"), system.parameter("d", 0.5)
    friction, height = system.parameter("friction", 0.3), system.parameter("height", 0.4, "m")
    last, links = system.ground.point(0.0, 0.0, height), []
    for k in range(2):
        start = {"position": (length * (k + 0.5), 0.0, height), "rotation": np.eye(3)}
        spin = {"angular_velocity": (0.5, 2.0, 1.0), "inertia": (0.01 * mass, 0.03, 0.035)}
        links.append(system.add(spatial.Body(f"link{k}", mass=mass, **start, **spin)))
        system.add(spatial.Spherical(f"joint{k}", last, links[k].point(-length / 2, 0, 0)))
        last = links[k].point(length / 2, 0, 0)
    ends = system.ground.point(0.3, 0.4, 0.6), links[0].center
    law = {"stiffness": stiffness, "damping": damping, "free_length": 0.2}
    system.add(spatial.Spring("spring", *ends, **law))
    shapes = [spatial.contact.Sphere(last, 0.05), spatial.contact.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("hits", shapes, restitution=0.5, friction=friction))
    return system.build()


CONTACT_MODELS = {
    "bouncing ball": ContactModel(bouncing_ball, 0.3, 5e-3),
    "rocking block": ContactModel(rocking_block, 0.3, 5e-3),
    "pendulum at a moving wall": ContactModel(pendulum_at_a_moving_wall, 0.4, 5e-3),
    "driven rod and disc": ContactModel(driven_rod_and_disc, 0.2, 5e-3),
    "discs in a box": ContactModel(discs_in_a_box, 0.05, 1e-3),
    "discs of many sizes": ContactModel(discs_of_many_sizes, 0.04, 2e-3),
    "spheres that roll": ContactModel(spheres_that_roll, 0.12, 4e-3),
    "ball and box in space": ContactModel(ball_and_box_in_space, 0.2, 5e-3),
    "rods, Poisson": ContactModel(lambda: thrown_rods("poisson"), 0.2, 2e-3),
    "rods, energetic": ContactModel(lambda: thrown_rods("energetic"), 0.2, 2e-3),
    "box in space, Poisson": ContactModel(lambda: thrown_box("poisson"), 0.15, 2e-3),
    "box in space, energetic": ContactModel(lambda: thrown_box("energetic"), 0.15, 2e-3),
    "compliant box and disc": ContactModel(compliant_box_and_disc, 0.06, 1e-3),
    "spatial links": ContactModel(spatial_links, 0.35, 5e-3),
    "disc on a soft disc": ContactModel(disc_on_a_soft_disc, 0.1, 1e-3),
}
