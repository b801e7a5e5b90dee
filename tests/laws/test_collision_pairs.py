"""Laws of the gaps of all pairs of shapes: distance, rate, formula, symmetry, frame."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import PARALLEL
from tests.registry.collision_shapes import PAIRS, SHAPES, WALLS
from tests.registry.gap_derivatives import GapDerivatives

SEEDS = range(6)
DEEP = 0.01
"""Overlap of a cylinder, by a tenth of its diameter, beyond which the gap is a bound [m]."""
pairs = pytest.mark.parametrize(("dimension", "i", "j"), PAIRS)


class Meeting:
    """Two bodies with one shape each, in random positions at random distances."""

    def __init__(self, dimension: int, i: str, j: str):
        space = {2: planar, 3: spatial}[dimension]
        system = da.System("meeting")
        extra = {"angle": 0.0} if dimension == 2 else {}
        inertia = 1.0 if dimension == 2 else (1.0, 1.0, 1.0)
        bodies = [system.add(space.Body(name, mass=1.0, inertia=inertia, **extra)) for name in "ab"]
        self.dimension, self.forms = dimension, [SHAPES[dimension][name] for name in (i, j)]
        shapes = [form.build(body) for form, body in zip(self.forms, bodies, strict=True)]
        system.add(space.Collisions("touch", shapes, friction=0.2))
        self.model = system.build()
        self.source = gap_sources(self.model)[0]

    def poses(self, seed: int, apart: float) -> list[tuple[np.ndarray, np.ndarray]]:
        """Positions and rotation matrices; the bodies are ``apart`` from touching deepest."""
        rng, d = np.random.default_rng(seed), self.dimension
        turns = [_rotation(rng, d) for _ in range(2)]
        direction = rng.normal(size=d)
        direction /= np.linalg.norm(direction)
        if max(len(form.corners) for form in self.forms) and any(
            np.abs(form.corners).max() > 50 for form in self.forms
        ):  # beside the surface of a wall, not beside the cube that stands for it
            k = int(np.abs(self.forms[1].corners).max() > 50)
            direction = turns[k][:, d - 1] * (1 - 2 * k)
        return [(np.zeros(d), turns[0]), (apart * direction, turns[1])]

    def state(self, poses: list) -> np.ndarray:
        """Coordinates of both bodies."""
        parts = []
        for position, turn in poses:
            if self.dimension == 2:
                parts.append([*position, np.arctan2(turn[1, 0], turn[0, 0])])
            else:
                quaternion = Rotation.from_matrix(turn).as_quat(scalar_first=True)
                parts.append([*position, *quaternion])
        return np.concatenate(parts)

    def gaps(self, y: np.ndarray, travel: float = 10.0):
        """All gaps of the pair."""
        count = self.model.equations.speed_count
        travels = np.full((count, 1), travel)
        return self.source.near(Configuration(0.0, y, self.model.nominal), travels)


def _rotation(rng: np.random.Generator, dimension: int) -> np.ndarray:
    if dimension == 3:
        return Rotation.random(random_state=rng.integers(1 << 30)).as_matrix()
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def separation(meeting: Meeting, poses: list) -> float:
    """Largest distance of the hulls along a direction, by brute force: the signed distance."""
    rng = np.random.default_rng(0)
    if meeting.dimension == 2:
        angles = np.linspace(0, 2 * np.pi, 40_000)
        directions = np.column_stack([np.cos(angles), np.sin(angles)])
    else:
        directions = rng.normal(size=(200_000, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]

    def along(n: np.ndarray) -> np.ndarray:
        farthest = [
            sign * position @ n.T + form.farthest(sign * n @ turn)
            for sign, form, (position, turn) in zip((1, -1), meeting.forms, poses, strict=True)
        ]
        return -farthest[0] - farthest[1]

    best, spread = directions[np.argmax(along(directions))], 0.02
    for _ in range(60):  # refine
        around = best + spread * rng.normal(size=(400, meeting.dimension))
        around = np.vstack([best, around / np.linalg.norm(around, axis=1)[:, None]])
        best, spread = around[np.argmax(along(around))], spread * 0.75
    return float(along(best[None])[0] - sum(form.radius for form in meeting.forms))


@pytest.fixture(scope="module")
def meetings() -> dict:
    return {}


def meeting_of(meetings: dict, *pair) -> Meeting:
    if pair not in meetings:
        meetings[pair] = Meeting(*pair)
    return meetings[pair]


@pytest.mark.few(1)
@pairs
def test_smallest_gap_is_the_signed_distance(meetings, dimension, i, j):
    """Sharp corners beside sharp corners: a lower bound; overlapping edges: along their normal;
    deeply overlapping cylinders: negative."""
    meeting = meeting_of(meetings, dimension, i, j)
    sharp = all(form.radius == 0 for form in meeting.forms)
    exact = 0
    for seed in SEEDS:
        for apart in (0.6, 0.25, 0.12):
            poses = meeting.poses(seed, apart)
            expected = separation(meeting, poses)
            gaps = meeting.gaps(meeting.state(poses))
            gap = gaps.distance.min()
            if "Cylinder" in (i, j) and not {i, j} & WALLS and expected < -DEEP:
                assert gap < 0
            elif sharp and not {i, j} & WALLS and gap > 1e-9:
                assert gap <= expected + 1e-5
                exact += abs(gap - expected) < 1e-5
            elif sharp and dimension == 3 and gap < 0:
                assert expected / PARALLEL - 1e-5 <= gap <= expected + 1e-5
                exact += 1
            else:
                assert gap == pytest.approx(expected, abs=1e-5)
                exact += 1
    assert exact >= 3


@pytest.mark.product
@pairs
def test_velocities_of_gaps_are_rates_of_distances(meetings, dimension, i, j):
    meeting = meeting_of(meetings, dimension, i, j)
    go, rng = meeting.model.equations.manifold.go, np.random.default_rng(3)
    for seed in SEEDS:
        y = meeting.state(meeting.poses(seed, 0.3))
        v = rng.normal(size=meeting.model.equations.speed_count)
        gaps = meeting.gaps(y)
        rates = dict(zip(gaps.key, gaps.speeds(v)[:, 0], strict=True))
        ends = []
        for step in (1e-6, -1e-6):
            moved = meeting.gaps(go(y, step * v))
            ends.append(dict(zip(moved.key, moved.distance, strict=True)))
        common = rates.keys() & ends[0].keys() & ends[1].keys()
        assert common
        for key in common:
            assert (ends[0][key] - ends[1][key]) / 2e-6 == pytest.approx(rates[key], abs=1e-6)


@pytest.mark.few(1)
@pairs
def test_derivatives_of_gaps_are_those_of_the_numbers(meetings, dimension, i, j):
    """Distances, velocities and momenta change by the position as the numbers do."""
    meeting = meeting_of(meetings, dimension, i, j)
    rng = np.random.default_rng(4)
    v, way = rng.normal(size=(2, meeting.model.equations.speed_count))
    formulas = GapDerivatives(meeting.source, meeting.model, v, way)
    for seed in SEEDS:
        y = meeting.state(meeting.poses(seed, 0.3))
        gaps = meeting.gaps(y)
        formulas.check_values(y, gaps)
        formulas.check_slopes(y, gaps, rng)


@pytest.mark.few(5)
@pairs
def test_order_of_shapes_does_not_matter(meetings, dimension, i, j):
    meeting, turned = Meeting(dimension, i, j), Meeting(dimension, j, i)
    for seed in SEEDS:
        poses = meeting.poses(seed, 0.3)
        gaps, same = meeting.gaps(meeting.state(poses)), turned.gaps(turned.state(poses[::-1]))
        assert gaps.distance.min() == pytest.approx(same.distance.min(), abs=1e-12)


@pytest.mark.product
@pairs
def test_gaps_do_not_depend_on_the_frame(meetings, dimension, i, j):
    meeting = meeting_of(meetings, dimension, i, j)
    for seed in SEEDS:
        rng = np.random.default_rng(100 + seed)
        turn, shift = _rotation(rng, dimension), rng.normal(size=dimension)
        poses = meeting.poses(seed, 0.3)
        moved = [(turn @ position + shift, turn @ own) for position, own in poses]
        gaps, same = (meeting.gaps(meeting.state(at)) for at in (poses, moved))
        assert np.sort(gaps.distance) == pytest.approx(np.sort(same.distance), abs=1e-12)
