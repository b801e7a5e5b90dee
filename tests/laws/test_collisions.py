"""Many discs and balls: nothing passes through anything, and contacts create no energy."""

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.errors import AnalysisError, ModelError

RADIUS = 0.05


def box_of_discs(count: int = 12, friction: float = 0.3, restitution: float = 0.4) -> da.System:
    """Discs of different sizes that fall into a box with moving discs among them."""
    rng = np.random.default_rng(1)
    system = da.System("box", gravity=(0.0, -9.81))
    friction_of = system.parameter("friction", friction)
    balls = []
    for k in range(count):
        radius = RADIUS * rng.uniform(0.8, 1.0)
        place = (-0.2 + 0.13 * (k % 4) + 0.005 * rng.random(), 0.06 + 0.11 * (k // 4))
        disc = planar.Body(
            f"disc_{k}",
            mass=1.0,
            inertia=radius**2 / 2,
            position=place,
            angle=0.0,
            velocity=tuple(0.3 * rng.normal(size=2)),
        )
        balls.append(planar.contact.Circle(system.add(disc), radius))
    corner = system.ground.point(-0.3, 0.0), system.ground.point(0.3, 0.0)
    walls = [
        planar.contact.HalfPlane(corner[0], (0.0, 1.0)),
        planar.contact.HalfPlane(corner[0], (1.0, 0.0)),
        planar.contact.HalfPlane(corner[1], (-1.0, 0.0)),
    ]
    system.add(
        planar.Collisions(
            "collisions", [*balls, *walls], restitution=restitution, friction=friction_of
        )
    )
    return system


@pytest.fixture(scope="module")
def settled():
    return da.solve_nonsmooth(box_of_discs().build(), 0.8, step=2e-3)


def test_nothing_passes_through_anything(settled):
    """From the positions alone: centres and walls keep their distance."""
    assert settled.status.success
    assert settled.data["penetration"].max() <= 1e-6 * RADIUS
    element = settled.model.parts.elements["collisions"]
    radii = np.array([float(ball.radius.sx) for ball in element.balls])
    place = settled.data["position"].values
    first, second = np.triu_indices(radii.size, 1)
    apart = np.linalg.norm(place[:, first] - place[:, second], axis=2)
    limit = 1e-6 * RADIUS
    assert (apart - radii[first] - radii[second]).min() >= -limit
    assert (place[:, :, 1] - radii).min() >= -limit
    assert (0.3 - np.abs(place[:, :, 0]) - radii).min() >= -limit


def test_energy_is_never_created(settled):
    """At no step; what is lost is what contacts took, to round-off."""
    energy = settled.data["energy"].values
    assert np.diff(energy).max() <= 1e-12 * energy[0]
    assert np.abs(settled.data["balance_error"]).max() <= 1e-12 * energy[0]
    assert settled.statistics["energy dissipated in contacts [J]"] > 0


def test_impulses_carry_the_weight():
    """A heap at rest: what the walls give upwards is the weight."""
    motion = da.solve_nonsmooth(box_of_discs(friction=0.5, restitution=0.0).build(), 1.4, step=4e-3)
    assert motion.status.success
    total = motion.data["velocity"].values[:, :, 1].sum(axis=1)
    assert abs(total[-1] - total[-60]) < 0.02  # momentum has settled
    assert motion.impulse("collisions").values[-60:].min() > 0


def test_pairs_near_each_other_are_all_pairs_near_each_other():
    model = box_of_discs().build()
    source, y, p = gap_sources(model)[0], model.start.y, model.nominal
    shift = np.full((y.size, 1), 0.02)
    pairs = source.near(Configuration(0.0, y, p), shift)
    everything = source.near(Configuration(0.0, y, p), 100 * shift)
    assert everything.count == 12 * 11 // 2 + 3 * 12
    reach = 2 * np.hypot(0.02, 0.02)
    assert sorted(pairs.distance) == pytest.approx(
        sorted(everything.distance[everything.distance <= reach])
    )


@pytest.mark.parametrize("space", ["plane", "space"])
def test_velocities_of_gaps_are_rates_of_distances(space):
    """``g(y ⊕ ε v) − g(y) = ε W_N v``, whatever turns."""
    model = (box_of_discs() if space == "plane" else box_of_balls()).build()
    source = gap_sources(model)[0]
    y, p, rng = model.start.y, model.nominal, np.random.default_rng(0)
    v, go = rng.normal(size=model.equations.speed_count), model.equations.manifold.go
    far = np.full((v.size, 1), 10.0)
    ends = [source.near(Configuration(0.0, go(y, e * v), p), far).distance for e in (1e-6, -1e-6)]
    rates = source.near(Configuration(0.0, y, p), far).speeds(v)[:, 0]
    assert (ends[0] - ends[1]) / 2e-6 == pytest.approx(rates, abs=1e-7)


def box_of_balls() -> da.System:
    system = da.System("balls", gravity=(0.0, 0.0, -9.81))
    rng, balls = np.random.default_rng(2), []
    for k in range(6):
        place = (0.11 * (k % 2), 0.11 * (k // 2 % 2), 0.06 + 0.11 * (k // 4))
        ball = spatial.Sphere(
            f"ball_{k}",
            radius=RADIUS,
            mass=1.0,
            position=tuple(place + 0.004 * rng.random(3)),
            angular_velocity=tuple(rng.normal(size=3)),
        )
        balls.append(spatial.contact.Sphere(system.add(ball), RADIUS))
    floor = spatial.contact.HalfSpace(system.ground.frame())
    system.add(spatial.Collisions("collisions", [*balls, floor], restitution=0.3, friction=0.4))
    return system


@pytest.mark.thorough
def test_balls_in_space():
    motion = da.solve_nonsmooth(box_of_balls().build(), 0.3, step=2e-3)
    assert motion.status.success
    assert motion.data["penetration"].max() <= 1e-6 * RADIUS
    energy = motion.data["energy"].values
    assert np.diff(energy).max() <= 1e-12 * energy[0]


def test_parameters_are_run_time_inputs():
    """Less friction, another motion of the same model."""
    model = box_of_discs().build()
    rough = da.solve_nonsmooth(model, 0.3, step=2e-3)
    smooth = da.solve_nonsmooth(model, 0.3, step=2e-3, parameters={"friction": 0.0})
    assert float(rough.data["friction_impulse"].sum()) > 0
    assert float(smooth.data["friction_impulse"].sum()) < 1e-15
    assert not np.allclose(rough.trajectory.y, smooth.trajectory.y)


def test_discs_are_drawn():
    axes = da.solve_nonsmooth(box_of_discs(4).build(), 0.02, step=2e-3).draw()
    assert len(axes.lines) >= 4 + 3


@pytest.mark.parametrize(
    ("change", "wrong"),
    [
        ({"balls": [("disc", 0.1)]}, r"shapes\[0\]: is \('disc', 0.1\); give shapes"),
        ({"balls": [3]}, r"is 3; give shapes such as contact.Circle"),
        ({"radius": -0.1}, r"radius.*above 0"),
        ({"restitution": 1.2}, "restitution is 1.2"),
        ({"friction": -0.1}, "friction"),
        ({"normal": (0.0, 0.0)}, "needs a length"),
    ],
)
def test_bad_input(change, wrong):
    system = da.System("bad")
    body = system.add(planar.Body("disc", mass=1.0, inertia=1.0))
    ball = planar.contact.Circle(body, change.pop("radius", 0.1))
    balls = change.pop("balls", [ball])
    walls = [
        planar.contact.HalfPlane(system.ground.point(0.0, 0.0), change.pop("normal", (0.0, 1.0)))
    ]
    with pytest.raises(ModelError, match=wrong):
        system.add(planar.Collisions("collisions", [*balls, *walls], **change)) and system.build()


def test_walls_alone_do_not_touch():
    """Those of one body may wait for bodies; such a model is refused when it is to move."""
    system = da.System("walls", gravity=(0, -9.81))
    disc = system.add(planar.Body("disc", mass=1.0, inertia=1.0))
    kit = planar.contact
    floor, plate = kit.HalfPlane(system.ground.point(0, 0)), kit.HalfPlane(disc.center)
    with pytest.raises(ModelError, match="there is no ball"):
        planar.Collisions("collisions", [floor, plate])
    system.add(planar.Collisions("collisions", [floor]))
    with pytest.raises(da.AnalysisError, match=r"add a shape of another body.*Circle"):
        da.solve_nonsmooth(system.build(), 0.1, step=1e-2)


def test_nothing_to_touch_and_wrong_strategies():
    system = da.System("free")
    system.add(planar.Body("disc", mass=1.0, inertia=1.0))
    model = system.build()
    with pytest.raises(AnalysisError, match="nothing in the model may touch"):
        da.solve_nonsmooth(model, 1.0)
    with pytest.raises(AnalysisError, match="AnticipatedImpacts"):
        da.solve_nonsmooth(model, 1.0, integrator=da.RK4())


def stacked(single: bool) -> da.Model:
    """Two discs and a floor: contacts of one element, or of elements of three kinds."""
    system = da.System("stack", gravity=(0.0, -9.81))
    low = planar.Body("low", mass=1.0, inertia=0.005, position=(0, 0.15), angle=0.0)
    high = planar.Body("high", mass=2.0, inertia=0.01, position=(0.05, 0.42), angle=0.0)
    discs = [planar.contact.Circle(system.add(body), 0.1) for body in (low, high)]
    floor = planar.contact.HalfPlane(system.ground.center)
    law = {"restitution": 0.3, "friction": 0.2}
    if single:
        system.add(planar.Collisions("all", [*discs, floor], **law))
        return system.build()
    system.add(planar.Collisions("discs", discs, **law))
    rigid, rough = planar.contact.Restitution(0.3), planar.contact.Coulomb(0.2)
    system.add(planar.Contact("floor", floor, discs[0], law=rigid, friction=rough))
    slip = high.vx + 0.1 * high.angular_velocity  # of its surface
    system.add(planar.UnilateralConstraint("base", high.y - 0.1, slip, **law))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_contacts_of_several_elements_are_one_problem(scheme):
    motions = [
        da.solve_nonsmooth(stacked(single), 0.6, step=2e-3, integrator=scheme)
        for single in (True, False)
    ]
    assert all(motion.status.success for motion in motions)
    one, other = (motion.trajectory.y for motion in motions)
    assert np.abs(one - other).max() < 1e-6
