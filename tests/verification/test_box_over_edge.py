"""A box slides over the edge of a table, beside own equations.

The box tips about the edge once the resultant of the pressure reaches it, and slides on with its
bottom over the edge until the pressure ends. Its rear corner then clears the edge by 53 µm: it
would come to the plane of the table after it has left the table.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial

G, MU, MASS, INERTIA, LENGTH, HEIGHT = 9.81, 0.2, 1.0, 0.01, 0.3, 0.2
START, SPEED, END = -0.3, 1.5, 0.6
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
SIDES = [(-2.0, -0.5), (0.0, -0.5), (0.0, 0.0), (-2.0, 0.0)]


def reference():
    """Horizontal and vertical position, and angle, at the end."""
    low = HEIGHT / 2
    tips = -MU * low
    speed = np.sqrt(SPEED**2 - 2 * MU * G * (tips - START))
    begin = (SPEED - speed) / (MU * G)

    def across(z):
        """Along and normal to the bottom, and the place of the edge from the centre along it."""
        along, normal = (
            np.array([np.cos(z[2]), np.sin(z[2])]),
            np.array([-np.sin(z[2]), np.cos(z[2])]),
        )
        return along, normal, -z[:2] @ along

    def pressed(z):
        """Force of the edge with sliding friction, by which ``n·(edge − centre)`` stays, and its
        direction and lever."""
        along, normal, place = across(z)
        velocity, spin = z[3:5], z[5]
        arm = place * along - low * normal
        force = normal - MU * np.sign(velocity @ along + spin * low) * along
        lever = arm[0] * force[1] - arm[1] * force[0]
        right = G * normal[1] + 2 * spin * (velocity @ along) + low * spin**2
        return right / (1 / MASS + place * lever / INERTIA), force, lever

    def rates(t, z):
        push, force, lever = pressed(z)
        return [*z[3:], *(np.array([0, -G]) + push * force / MASS), push * lever / INERTIA]

    def lifts(t, z):
        return pressed(z)[0]

    lifts.terminal, lifts.direction = True, -1
    first = np.array([tips, low, 0.0, speed, 0.0, 0.0])
    options = {"events": lifts, "rtol": 1e-10, "atol": 1e-12, "max_step": 1e-3}
    solution = solve_ivp(rates, (begin, END), first, **options)
    assert solution.t_events[0].size == 1
    (x, y, angle, vx, vy, spin), left = solution.y[:, -1], END - solution.t[-1]
    return np.array([x + vx * left, y + vy * left - G * left**2 / 2, angle + spin * left])


def add_planar(system, box_kind, table_kind):
    """A box and a table as a rectangle, a polygon or an outline."""
    start = {"position": (START, HEIGHT / 2), "velocity": (SPEED, 0)}
    box = system.add(planar.Body("box", mass=MASS, inertia=INERTIA, **start))
    x, y = LENGTH / 2, HEIGHT / 2
    corners = (LENGTH, HEIGHT)
    if box_kind is not planar.contact.Rectangle:
        corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    shapes = [box_kind(box, corners), table_kind(system.ground, SIDES)]
    system.add(planar.Collisions("touch", shapes, friction=MU))


def planar_box(system):
    add_planar(system, planar.contact.Rectangle, planar.contact.Polygon)


def outlined_box(system):
    """The corners of the table pass the ends of the sides of the box, not over these."""
    add_planar(system, planar.contact.Outline, planar.contact.Outline)


def box_on_outline(system):
    add_planar(system, planar.contact.Rectangle, planar.contact.Outline)


def spatial_box(system):
    start = {"position": (START, 0, HEIGHT / 2), "velocity": (SPEED, 0, 0), "rotation": np.eye(3)}
    start["points"] = {"tip": (1, 0, 0)}
    box = system.add(spatial.Body("box", mass=MASS, inertia=(INERTIA,) * 3, **start))
    contact, table = spatial.contact, system.ground.point(-1, 0, -0.25)
    shapes = [contact.Box(box.center, (LENGTH, 0.2, HEIGHT)), contact.Box(table, (2, 2, 0.5))]
    system.add(spatial.Collisions("touch", shapes, friction=MU))


def hinged(system):
    """A pendulum far away, with which all steps are general ones."""
    if system.dimension == 2:
        bob = system.add(planar.Body("bob", mass=1, inertia=0.01, position=(9, 9)))
        system.add(planar.Revolute("pivot", system.ground.point(9, 9.1), bob.point(0, 0.1)))
    else:
        bob = system.add(spatial.Body("bob", mass=1, inertia=(0.01,) * 3, position=(9, 9, 9)))
        system.add(spatial.Spherical("pivot", system.ground.point(9, 9, 9.1), bob.point(0, 0, 0.1)))


@pytest.mark.few(2)
@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
@pytest.mark.parametrize("add", [planar_box, outlined_box, box_on_outline, spatial_box])
def test_a_box_slides_over_an_edge(add, scheme, general):
    """Positions and the angle after the flight; a false impact changes them by 20 mm and 0.36."""
    gravity = (0, 0, -G) if add is spatial_box else (0, -G)
    system = da.System("table", gravity=gravity)
    add(system)
    if general:
        hinged(system)
    motion = da.solve_nonsmooth(system.build(), END, step=2e-3, integrator=scheme)
    assert motion.status.success
    place = motion["box.position"].values[-1]
    if add is not spatial_box:
        end = [*place, motion["box.angle"].values[-1]]
    else:
        tip = motion["box.tip.position"].values[-1] - place
        end = [place[0], place[2], np.arctan2(tip[2], tip[0])]
    np.testing.assert_allclose(end, reference(), atol=1e-4)


@pytest.mark.parametrize("options", [{"step": 5e-4}, {"integrator": da.DormandPrince()}], ids=str)
def test_located_contacts_slide_over_an_edge(options):
    """The front corner leaves the table where the edge begins to touch the bottom."""
    system = da.System("table", gravity=(0, -G))
    planar_box(system)
    motion = da.solve_dynamics(system.build(), END, **options)
    assert motion.status.success
    end = [*motion["box.position"].values[-1], motion["box.angle"].values[-1]]
    np.testing.assert_allclose(end, reference(), atol=1e-6)
