"""Laws of the gaps of smooth profiles and polygons with dents, with all other planar shapes."""

import itertools
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import pytest
from scipy.spatial import cKDTree

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from tests.registry.collision_shapes import PLANAR
from tests.registry.gap_derivatives import GapDerivatives

u = da.curves.u
flat = planar.contact
DENSE = 20_000
"""Points of a shape in the search by brute force."""


def turned(angle: float, vectors: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def line_points(corners: np.ndarray, count: int = DENSE) -> np.ndarray:
    """Points on a closed polygon."""
    ends = np.vstack([corners, corners[:1]])
    at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ends, axis=0), axis=1))])
    s = np.unique(np.concatenate([np.linspace(0, at[-1], count), at]))
    return np.column_stack([np.interp(s, at, ends[:, k]) for k in range(2)])


def curve_points(curve: da.FormulaCurve) -> np.ndarray:
    symbol = ca.SX.sym("u")
    function = ca.Function("c", [symbol], [curve.position(symbol)]).map(DENSE)
    return function(np.linspace(*curve.interval(), DENSE)).full().T


def polar(radius) -> da.FormulaCurve:
    return da.FormulaCurve(radius * da.cos(u), radius * da.sin(u))


STAR = np.array(
    [
        (
            (0.2 if k % 2 else 0.09) * np.cos(k * np.pi / 5),
            (0.2 if k % 2 else 0.09) * np.sin(k * np.pi / 5),
        )
        for k in range(10)
    ]
)
ANGLE = np.array([(0, 0), (0.3, 0), (0.3, 0.1), (0.1, 0.1), (0.1, 0.25), (0, 0.25)])
CURVES = {
    "ellipse": da.FormulaCurve(0.2 * da.cos(u), 0.1 * da.sin(u)),
    "bean": polar(0.12 * (1 + 0.5 * da.cos(2 * u) + 0.1 * da.sin(u))),
    "clover": polar(0.12 * (1 + 0.4 * da.cos(3 * u))),
    "bowl": da.FormulaCurve(-u, 2 * u**2, -0.25, 0.25, closed=False),
    "spline": da.SplineCurve([(0.2, 0), (0.1, 0.12), (-0.05, 0.06), (-0.15, 0.1), (-0.1, -0.12)]),
}


@dataclass(frozen=True)
class Form:
    """A shape on a body, points of its boundary on the body, and its radius about these."""

    build: object
    points: np.ndarray
    radius: float = 0.0
    sharp: bool = False


FORMS = {
    name: Form(lambda body, c=curve: flat.Profile(body, c), curve_points(curve))
    for name, curve in CURVES.items()
}
FORMS |= {
    name: Form(
        lambda body, c=corners: flat.Outline(body, c.tolist()), line_points(corners), 0.0, True
    )
    for name, corners in (("star", STAR), ("angle", ANGLE))
}
OTHERS = {
    name: Form(
        shape.build,
        line_points(shape.corners) if len(shape.corners) > 1 else shape.corners,
        shape.radius,
        shape.radius == 0 and name != "HalfPlane",
    )
    for name, shape in PLANAR.items()
}
ALL = FORMS | OTHERS
PAIRS = [(i, j) for i, j in itertools.combinations_with_replacement(ALL, 2) if i in FORMS]
POSES = 6
pairs = pytest.mark.parametrize(("i", "j"), PAIRS)


class Meeting:
    """Two bodies with one shape each."""

    def __init__(self, i: str, j: str):
        system = da.System("meeting")
        bodies = [system.add(planar.Body(n, mass=1.0, inertia=1.0, angle=0.0)) for n in "ab"]
        self.forms = ALL[i], ALL[j]
        shapes = [form.build(body) for form, body in zip(self.forms, bodies, strict=True)]
        system.add(planar.Collisions("touch", shapes, friction=0.2))
        self.model = system.build()
        self.source = gap_sources(self.model)[0]

    def gaps(self, y: np.ndarray, travel: float = 10.0):
        travels = np.full((6, 1), travel)
        return self.source.near(Configuration(0.0, y, self.model.nominal), travels)

    def distance(self, y: np.ndarray, every: int = 1) -> float:
        """The distance of the points of both shapes."""
        one, two = (
            y[3 * k : 3 * k + 2]
            + turned(y[3 * k + 2], form.points[:: every if len(form.points) > 9 else 1])
            for k, form in enumerate(self.forms)
        )
        walls = [form is OTHERS["HalfPlane"] for form in self.forms]
        if any(walls):
            k = walls.index(True)
            above = (two, one)[k] - y[3 * k : 3 * k + 2]
            return turned(-y[3 * k + 2], above)[:, 1].min() - self.forms[1 - k].radius
        tree = cKDTree(one)
        near = tree.query(two[::100])[0].min()
        apart = tree.query(two, distance_upper_bound=near + 1e-12)[0].min()
        return apart - sum(form.radius for form in self.forms)

    def in_front(self, y: np.ndarray) -> bool:
        """Whether the bodies are on the open sides of bowls."""
        bowls = [form is FORMS["bowl"] for form in self.forms]
        places = [
            turned(-y[3 * k + 2], y[3 - 3 * k : 5 - 3 * k] - y[3 * k : 3 * k + 2]) for k in (0, 1)
        ]
        return all(not bowl or r[1] > 2 * r[0] ** 2 for bowl, r in zip(bowls, places, strict=True))

    @cached_property
    def poses(self) -> list[np.ndarray]:
        """Random positions of shapes that do not overlap, moved together until they nearly do."""
        rng, poses, clear = np.random.default_rng(5), [], 0.01
        for _ in range(12 * POSES):
            direction = rng.uniform(0, 2 * np.pi)
            way = np.array([np.cos(direction), np.sin(direction)])
            angles = rng.uniform(0, 2 * np.pi, 2)
            if OTHERS["HalfPlane"] is self.forms[1]:
                angles[1] = direction + np.pi / 2
            if OTHERS["HalfPlane"] is self.forms[0]:
                angles[0] = direction - np.pi / 2
            far = 0.8
            y = np.array([0, 0, angles[0], *(far * way), angles[1]])
            for _ in range(20):  # conservative advancement
                step = self.distance(y, 40) - clear * rng.uniform(0.1, 1.0)
                if step < 1e-3:
                    break
                y[3:5] -= step * way
            if self.distance(y, 10) > 1e-4 and y[3:5] @ way > 0 and self.in_front(y):
                poses.append(y)
            if len(poses) == POSES:
                break
        assert len(poses) > 2
        return poses


@pytest.fixture(scope="module")
def meetings() -> dict:
    return {}


def meeting_of(meetings: dict, i: str, j: str) -> Meeting:
    if (i, j) not in meetings:
        meetings[i, j] = Meeting(i, j)
    return meetings[i, j]


@pytest.mark.few(3)
@pairs
def test_smallest_gap_is_the_distance(meetings, i, j):
    """Between two sharp corners, a lower bound."""
    meeting = meeting_of(meetings, i, j)
    corners = all(form.sharp or i == "bowl" for i, form in zip((i, j), meeting.forms, strict=True))
    exact = 0
    for y in meeting.poses:
        gaps, expected = meeting.gaps(y, 0.05), meeting.distance(y)
        smallest = gaps.distance.min(initial=np.inf)
        if corners:
            assert smallest == np.inf or smallest <= expected + 1e-6 or smallest > 5e-3
        else:
            assert smallest == pytest.approx(expected, abs=2e-6)
        exact += abs(smallest - expected) < 2e-6
    assert exact >= 3 or corners


@pytest.mark.parametrize(("i", "j"), [("star", "Circle"), ("angle", "Vertex")])
def test_compliant_contact_has_the_same_distance(meetings, i, j):
    """Signed distance of ``Contact``, also inside, beside the smallest gap of ``Collisions``; of a
    vertex a lower bound outside, at corners."""
    meeting = meeting_of(meetings, i, j)
    element = meeting.model.parts.elements["touch"]
    outline, ball = element.members
    (point,) = outline.contact_points(ball, "touch")
    e = meeting.model.equations
    function = ca.Function("gap", [e.t, e.y, e.p], [point.distance])
    rng, lower = np.random.default_rng(1), 0
    for k, y in enumerate((*meeting.poses, *rng.uniform(-0.1, 0.1, (10, 6)))):
        gap, expected = float(function(0.0, y, meeting.model.nominal)), meeting.distance(y)
        radius = meeting.forms[1].radius
        if radius == 0 and gap > 0:
            assert gap <= expected + 2e-6
            lower += gap < expected - 2e-6
            continue
        assert abs(gap + radius) == pytest.approx(expected + radius, abs=2e-6)
        if k < len(meeting.poses):
            assert gap == pytest.approx(expected, abs=2e-6)
    assert lower < 5


@pytest.mark.few(1)
@pairs
def test_formulas_are_the_numbers_and_have_their_derivatives(meetings, i, j):
    meeting = meeting_of(meetings, i, j)
    rng = np.random.default_rng(4)
    v, way = rng.normal(size=(2, meeting.model.equations.speed_count))
    formulas = GapDerivatives(meeting.source, meeting.model, v, way)
    for y in meeting.poses[:2]:
        gaps = meeting.gaps(y, 0.02)
        formulas.check_values(y, gaps, 1e-10)
        formulas.check_slopes(y, gaps, rng)


@pytest.mark.few(2)
@pairs
def test_selected_gaps_are_those_of_the_search(meetings, i, j):
    meeting, nominal = meeting_of(meetings, i, j), meeting_of(meetings, i, j).model.nominal
    v = np.random.default_rng(5).normal(size=6)
    for y in meeting.poses[:2]:
        gaps = meeting.gaps(y, 0.02)
        keys = gaps.key[::-1]
        selected = meeting.source.selected(Configuration(0.0, y, nominal), keys)
        assert (selected.key == keys).all()
        assert selected.distance == pytest.approx(gaps.distance[::-1], abs=1e-10)
        assert selected.speeds(v) == pytest.approx(gaps.speeds(v)[::-1], abs=1e-9)


@pytest.mark.product
@pairs
def test_velocities_of_gaps_are_rates_of_distances(meetings, i, j):
    meeting = meeting_of(meetings, i, j)
    rng = np.random.default_rng(3)
    for y in meeting.poses[:2]:
        v = rng.normal(size=6)
        gaps = meeting.gaps(y, 0.02)
        rates = dict(zip(gaps.key, gaps.speeds(v)[:, 0], strict=True))
        ends = []
        for step in (1e-6, -1e-6):
            moved = meeting.gaps(y + step * v, 0.03)
            ends.append(dict(zip(moved.key, moved.distance, strict=True)))
        for key in rates.keys() & ends[0].keys() & ends[1].keys():
            assert (ends[0][key] - ends[1][key]) / 2e-6 == pytest.approx(rates[key], abs=1e-6)


@pytest.mark.product
@pairs
def test_gaps_do_not_depend_on_the_frame(meetings, i, j):
    meeting = meeting_of(meetings, i, j)
    for y in meeting.poses[:2]:
        moved = y.copy()
        for k in (0, 3):
            moved[k : k + 2] = turned(0.7, y[k : k + 2]) + np.array([0.3, -0.2])
            moved[k + 2] = y[k + 2] + 0.7
        gaps, same = meeting.gaps(y, 0.02), meeting.gaps(moved, 0.02)
        assert np.sort(gaps.distance) == pytest.approx(np.sort(same.distance), abs=1e-12)
        assert (np.sort(gaps.key) == np.sort(same.key)).all()
