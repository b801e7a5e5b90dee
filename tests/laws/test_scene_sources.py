"""Every number and column of a page that follows from parameters states its formula."""

from __future__ import annotations

import copy

import casadi as ca
import numpy as np
import pytest
from flexible_bodies import beam, flexible, tapered
from registry import CASES
from spatial_registry import SPATIAL_CASES, any_model_of

import dalembert as da
from dalembert import planar, spatial
from dalembert.report.packing import pack
from dalembert.report.page import as_json
from dalembert.results.files.payload import report_payload
from dalembert.results.pictures.collector import SceneCollector
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.sources import InitialPicture, Row, Sources, payload_sources

TOLERANCE = 1e-9
"""Of numbers and columns, relative to the largest of a column."""
STEP = 1e-4
CHANGE = 0.01
"""Relative change of the parameters."""
MOTION_SIZES = (
    (MechanismScene, "extent"),
    (SceneCollector, "limits"),
    (SceneCollector, "distance"),
)
"""Sizes of symbols that follow from the motion as a whole; a page keeps the initial ones."""


def plates() -> da.System:
    """Bodies drawn by their points, and a slider."""
    system = da.System("plates", gravity=(0, -9.81))
    a, b, m = (system.parameter(n, v) for n, v in (("a", 0.4), ("b", 0.7), ("m", 1.3)))
    corners = {"P": (-a, 0), "Q": (b, 0.1), "R": (0.1, a * b)}
    plate = system.add(planar.Body("plate", mass=m, inertia=a * b, points=corners))
    ends = {"E": (2 * a, 0), "F": (-b, 0)}
    link = system.add(planar.Body("link", mass=1, inertia=1, points=ends))
    slider = system.add(planar.Body("slider", mass=m, inertia=1, position=(2, 0)))
    system.add(planar.Revolute("O", system.ground.point(-a, 0), plate.point("P")))
    system.add(planar.Revolute("A", plate.point("Q"), link.point("F")))
    system.add(planar.Prismatic("S", system.ground.point(0, 0), slider.center, axis=(b, a)))
    system.add(planar.Stop("stop", slider.x, upper=4 * b, stiffness=10.0))
    return system


def solids() -> da.System:
    """Bodies with shapes of their own, plates and ellipsoids."""
    system = da.System("solids", gravity=(0, 0, -9.81))
    a, b, m = (system.parameter(n, v) for n, v in (("a", 0.4), ("b", 0.7), ("m", 1.3)))
    system.add(spatial.Box("box", size=(a, b, 1), density=m))
    system.add(spatial.Cylinder("cylinder", radius=a, length=b, density=m))
    system.add(spatial.Sphere("sphere", radius=b, mass=m))
    system.add(spatial.Capsule("capsule", radius=a, length=b, density=1))
    system.add(spatial.Bar("bar", length=a, mass=m, radius=0.1))
    system.add(spatial.Body("ellipsoid", mass=m, inertia=(a, b, 0.9 * b), center_of_mass=(a, 0, b)))
    system.add(spatial.Body("tilted", mass=m, inertia=(1.0, 1.2, 0.7, 0.1 * a, -0.2 * b, 0.15)))
    corners = {"P": (-a, 0, 0), "Q": (b, 0.1, 0), "R": (0.1, a * b, 0)}
    system.add(spatial.Body("plate", mass=1, inertia=(1, 1, 1), points=corners))
    ends = {"P": (-a, 0, 0), "Q": (b, 0, 0)}
    system.add(spatial.Body("rod", mass=m, inertia=(0.01 * a, b, b), points=ends))
    return system


def flexibles(dimension: int, follows: bool) -> da.System:
    """A flexible body; its shapes may follow from parameters."""
    system = da.System("flexibles")
    height, damping = system.parameter("height", 0.02), system.parameter("damping", 0.1)
    options = {"parameters": {"h": height}} if follows else {"structure": beam(dimension)}
    options = {"structure": tapered(dimension), "damping_ratio": damping} | options
    body = system.add(flexible(dimension, **options))
    system.initial(body.q1, 0.2)
    return system


OWN = {
    "plates": plates,
    "solids": solids,
    "flexible body in the plane": lambda: flexibles(2, False),
    "flexible body in space": lambda: flexibles(3, False),
    "flexible body of variable height": lambda: flexibles(2, True),
}
"""What the registries lack."""


def model_of(name: str) -> da.Model:
    return OWN[name]().build() if name in OWN else any_model_of(name)


class MotionSizes:
    """Records sizes that follow from a motion; a second picture is drawn with the same."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch):
        self.sizes, self.drawn = [], None
        for owner, name in MOTION_SIZES:
            monkeypatch.setattr(owner, name, self.recording(getattr(owner, name)))

    def recording(self, size):
        def recorded(*arguments):
            if self.drawn is not None:
                return next(self.drawn)
            self.sizes.append(size(*arguments))
            return self.sizes[-1]

        return recorded

    def repeat(self) -> None:
        self.drawn = iter(self.sizes)


def changed_values(model: da.Model) -> dict[str, float]:
    rng = np.random.default_rng(0)
    factors = 1 + CHANGE * rng.uniform(-1, 1, len(model.parameters))
    values = [float(p.value) for p in model.parameters.values()]
    return dict(zip(model.parameters, (values * factors).tolist(), strict=True))


def at(payload, place):
    for key in place:
        payload = payload[key]
    return payload


def differing(one, other, place=()):
    """Places where two payloads differ, but not within pictures that remain."""
    if isinstance(one, InitialPicture):
        return
    if isinstance(one, dict):
        assert isinstance(other, dict) and list(one) == list(other), place
        for key in one:
            yield from differing(one[key], other[key], (*place, key))
    elif isinstance(one, list | np.ndarray):
        assert len(one) == len(other), place
        for k in range(len(one)):
            yield from differing(one[k], other[k], (*place, k))
    elif one != other and not (isinstance(one, float) and close(one, other)):
        yield place


def close(one, other, scale: float = 1.0) -> bool:
    one, other = np.asarray(one, float), np.asarray(other, float)
    size = max(scale, np.abs(other[np.isfinite(other)]).max(initial=0.0))
    return np.allclose(one, other, rtol=0, atol=TOLERANCE * size, equal_nan=True)


def columns(sources: Sources, motion) -> list[np.ndarray]:
    """The columns of a page for another motion."""
    forms = [source for _, source in sources.columns]
    graphs = [f.sx if isinstance(f, Row) else f for f in forms]
    table = motion.table([da.Expression(sx) for sx in graphs])
    for row, form in zip(table, forms, strict=True):
        if isinstance(form, Row):
            row += form.work @ motion.trajectory.work
            row -= row[0] if form.relative else 0.0
    return list(table)


@pytest.mark.few(5)
@pytest.mark.parametrize("name", [*CASES, *SPATIAL_CASES, *OWN])
def test_pages_state_what_follows_from_parameters(name, monkeypatch):
    model, sizes = model_of(name), MotionSizes(monkeypatch)
    start, other = (
        da.solve_dynamics(model, STEP * 2, step=STEP, parameters=values)
        for values in (None, changed_values(model))
    )
    page = report_payload(start, None, None)
    sizes.repeat()
    expected = report_payload(other, None, None)
    sources = payload_sources(page)
    graph = ca.vertcat(*(sx for _, sx in sources.numbers))
    numbers = ca.Function("numbers", [model.equations.p], [ca.densify(graph)])(other.parameters)
    values = np.concatenate([numbers.full().ravel(), np.zeros(0)])
    for (place, _), value in zip(sources.numbers, values, strict=True):
        assert close(value, at(expected, place)), place
    forces = [joint.get("force_x", [0.0]) for joint in page["scene"]["joints"]]
    largest = max([1.0, *(np.abs(column).max() for column in forces)])
    for (place, _), column in zip(sources.columns, columns(sources, other), strict=True):
        assert close(column, at(expected, place), largest), place
    stated = {place for place, _ in [*sources.numbers, *sources.columns]}
    for part in ("scene", "series"):
        differences = set(differing(page[part], expected[part], (part,)))
        assert {p for p in differences if not {p, p[:-1]} & stated} == set()


def test_formulas_do_not_change_the_page():
    motion = da.solve_dynamics(plates().build(), 0.3, step=STEP * 10)
    page = report_payload(motion, None, None)
    assert payload_sources(page).numbers
    plain = copy.deepcopy(page)
    assert not payload_sources(plain).numbers
    assert as_json(page) == as_json(plain)
    assert as_json(pack(page)) == as_json(pack(plain))
