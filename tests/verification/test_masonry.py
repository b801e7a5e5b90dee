"""Structures of rigid blocks and rolls at the limits of their stability, by limit analysis.

A semicircular arch under its own weight stands from a thickness of 0.1075 of its mean radius
(M. Milankovitch, Theorie der Druckkurven, 1907; H. Cocchetti, G. Colasante, E. Rizzi, Appl. Mech.
Rev. 64, 2011); with few voussoirs the limit is that of a linear programme, the statical theorem of
limit analysis for joints that do not pull (J. Heyman, 1966). Books overhang a table by a half, a
quarter, a sixth … of their length; three rolls in a pile need friction of ``tan 15°`` among them
and of a third of it on the floor.
"""

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

import dalembert as da
from dalembert import planar

contact = planar.contact
G, DENSITY = 9.81, 1000.0


def voussoirs(count: int, thickness: float) -> np.ndarray:
    """(count, 4, 2) corners of the voussoirs of an arch of the mean radius 1, from the left."""
    inner, outer = 1 - thickness / 2, 1 + thickness / 2
    angles = np.pi * (1 - np.arange(count + 1) / count)
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    corners = inner * rim[:-1], inner * rim[1:], outer * rim[1:], outer * rim[:-1]
    return np.stack(corners, axis=1)


def section(corners: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Area, centroid and second moment of area of a polygon about its centroid."""
    after = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]
    area, squares = cross.sum() / 2, corners**2 + corners * after + after**2
    centroid = cross @ (corners + after) / (6 * area)
    return area, centroid, float(cross @ squares.sum(axis=1) / 12 - area * centroid @ centroid)


def margin(count: int, thickness: float) -> float:
    """Largest factor by which loads that press all joints together may be negative: zero at the
    limit. Unknowns are the forces at both corners of all joints."""
    balance, weight = np.zeros((3 * count, 4 * count + 5)), np.zeros(3 * count)
    for k, corners in enumerate(voussoirs(count, thickness)):
        area, centroid, _ = section(corners)
        weight[3 * k + 1] = area
        for joint, sign, pair in ((k, 1, (0, 3)), (k + 1, -1, (1, 2))):
            angle = np.pi * (1 - joint / count)
            along = np.array([np.sin(angle), -np.cos(angle)])
            for side, corner in enumerate(pair):
                arm = corners[corner] - centroid
                for part, force in enumerate((along, -np.array([-along[1], along[0]]))):
                    column = 4 * joint + 2 * side + part
                    torque = arm[0] * force[1] - arm[1] * force[0]
                    balance[3 * k : 3 * k + 3, column] += sign * np.append(force, torque)
    pressed = np.zeros((2 * count + 2, balance.shape[1]))
    rows = np.arange(2 * count + 2)
    pressed[rows, 2 * rows], pressed[:, -1] = -1.0, 1.0  # N ≥ margin
    cost = -np.eye(balance.shape[1])[-1]
    free = [(None, None)] * balance.shape[1]
    zero = np.zeros(rows.size)
    return -linprog(cost, pressed, zero, balance, weight, bounds=free).fun


def limit(count: int) -> float:
    """Smallest thickness over the radius at which the arch stands."""
    return brentq(lambda thickness: margin(count, thickness), 0.05, 0.2, xtol=1e-7)


def arch(count: int, thickness: float) -> da.Model:
    system, shapes = da.System("arch", gravity=(0.0, -G)), []
    for k, corners in enumerate(voussoirs(count, thickness)):
        area, centroid, second = section(corners)
        place = {"position": tuple(centroid), "angle": 0.0}
        stone = planar.Body(f"stone{k}", mass=DENSITY * area, inertia=DENSITY * second, **place)
        shapes.append(contact.Polygon(system.add(stone), (corners - centroid).tolist()))
    for left in (-1.5, 0.5):
        base = [(left, -0.2), (left + 1, -0.2), (left + 1, 0.0), (left, 0.0)]
        shapes.append(contact.Polygon(system.ground, base))
    system.add(planar.Collisions("joints", shapes, friction=0.9))
    return system.build()


def test_the_limit_of_arches_is_the_published_one():
    assert limit(61) == pytest.approx(0.1075, abs=2e-4)


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("count", [7, 12])
def test_an_arch_stands_above_its_limit_and_falls_below_it(count, integrator):
    least, settings = limit(count), {"step": 4e-3, "integrator": integrator}
    stands, falls = (
        da.solve_nonsmooth(arch(count, share * least), 0.4, **settings) for share in (1.005, 0.98)
    )
    sinking = [motion[f"stone{count // 2}.y"].values for motion in (stands, falls)]
    assert stands.status.success and falls.status.success
    assert abs(np.ptp(sinking[0])) < 1e-8
    assert sinking[1][0] - sinking[1][-1] > 5e-3


@pytest.mark.few(1)
@pytest.mark.parametrize(("share", "stands"), [(0.999, True), (1.001, False)])
def test_books_overhang_by_the_harmonic_series(share, stands):
    length, height, count = 0.3, 0.02, 6
    system, place = da.System("books", gravity=(0.0, -G)), -length / 2
    shapes = [contact.Rectangle(system.ground.point(-0.5, -0.05), (1.0, 0.1))]
    heights = height * (0.5 + np.arange(count))
    for k, above in enumerate(heights):
        place += share * length / (2 * (count - k))
        inertia = (length**2 + height**2) / 12
        pose = {"position": (place, above), "angle": 0.0}
        book = system.add(planar.Body(f"book{k}", mass=1.0, inertia=inertia, **pose))
        shapes.append(contact.Rectangle(book, (length, height)))
    system.add(planar.Collisions("pages", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=2e-3)
    ends = np.array([motion[f"book{k}.y"].values[-1] for k in range(count)])
    assert motion.status.success
    assert (abs(ends - heights).max() < 1e-8) == stands
    assert stands or (ends - heights).min() < -1e-4


@pytest.mark.few(2)
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize(
    ("floor", "rolls", "stands"), [(1.002, 1.002, True), (0.99, 1.1, False), (1.1, 0.99, False)]
)
def test_three_rolls_in_a_pile(floor, rolls, stands, integrator):
    system, radius, among = da.System("pile", gravity=(0.0, -G)), 0.1, np.tan(np.pi / 12)
    top = radius * (1 + np.sqrt(3))
    discs = []
    for k, place in enumerate(((-radius, radius), (radius, radius), (0.0, top))):
        roll = planar.Body(f"roll{k}", mass=1.0, inertia=radius**2 / 2, position=place, angle=0.0)
        discs.append(contact.Circle(system.add(roll), radius))
    shapes = {"rolls": discs, "floor": [contact.HalfPlane(system.ground)]}
    pair = contact.Pair(("rolls", "floor"), friction=floor * among / 3)
    system.add(planar.Collisions("pile", shapes, friction=rolls * among, pairs=[pair]))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=4e-3, integrator=integrator)
    sinking = top - motion["roll2.y"].values[-1]
    assert motion.status.success
    assert sinking == pytest.approx(0.0, abs=1e-9) if stands else sinking > 5e-4
