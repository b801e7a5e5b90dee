"""Warnings and errors of runs with contacts: steps as long as a fall, overlaps, lonely shapes."""

from __future__ import annotations

import functools
import re
from itertools import pairwise

import numpy as np
import pytest
from rigid_contacts import other_warnings
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial

contact, G = planar.contact, 9.81
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


@functools.cache
def ball(height: float, restitution: float = 0.8, **law) -> da.Model:
    system = da.System("ball", gravity=(0, -10))
    body = system.add(planar.Body("ball", mass=1.0, inertia=0.004, position=(0, height)))
    shapes = [contact.Circle(body, 0.1), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, restitution=restitution, **law))
    return system.build()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_step_as_long_as_the_fall_is_warned_about(scheme):
    """The ball hits at √(2 g 0.9 m), and e² of its energy are missing."""
    motion = da.solve_nonsmooth(ball(1.0), 2.0, step=1.0, integrator=scheme)
    (warning,) = other_warnings(motion)
    speed, energy = (18.0) ** 0.5, 0.8**2 * 9.0
    assert warning.startswith(f"floor closes a gap at {speed:.3g} m/s within the step at t = 0 s")
    assert f"{energy:.3g} J" in warning
    step = float(re.search("use step=([^ ]*) or shorter", warning).group(1))
    shorter = da.solve_nonsmooth(ball(1.0), 0.8, step=step, integrator=scheme)
    assert not other_warnings(shorter) and shorter["ball.y"][-1].item() > 0.5


@pytest.mark.few(2)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(
    ("height", "restitution", "law"),
    [(7.6e-3, 0.6, "newton"), (17.8e-3, 0.3, "newton"), (7.6e-3, 0.6, "poisson")],
)
def test_rebounds_with_a_wrong_energy_are_warned_about(scheme, height, restitution, law):
    """Of falls of 4 and 6 steps remain (1 − e²) m g of the gap at the start of the step."""
    step = 0.01
    model = ball(0.1 + height, restitution, impact_law=law)
    motion = da.solve_nonsmooth(model, 0.1, step=step, integrator=scheme)
    (warning,) = other_warnings(motion)
    k = int(motion.record.step[0])
    y, v = motion.record.ends.y[1, k + 1] - 0.1, motion.record.ends.v[1, k + 1]
    error = abs(v**2 / 2 + 10 * y - restitution**2 * 10 * height)
    assert error > 0.1 * 10 * height
    text = f"the energy after an impact of floor at t = {motion.record.t[k]:.9g} s differs by "
    assert warning.startswith(f"{text}{error:.3g} J from that by its restitution")
    shorter = float(re.search("use step=([^ ]*) or shorter", warning).group(1))
    fine = da.solve_nonsmooth(model, 0.1, step=shorter / 2, integrator=scheme)
    assert not other_warnings(fine)


def test_corrections_that_lift_a_body_are_warned_about():
    """A box without friction that falls on a corner and then on its face is lifted there."""
    system = da.System("dropped", gravity=(0, -9.81))
    start = {"position": (0, 0.5), "angle": 0.3}
    body = system.add(planar.Body("box", mass=2.0, inertia=2 * 0.2 / 12, **start))
    shapes = [contact.Rectangle(body, (0.2, 0.4)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes))
    model = system.build()
    lifted, exact = (
        da.solve_nonsmooth(model, 0.6, step=5e-3, integrator=scheme)
        for scheme in (da.MoreauJean(), da.AnticipatedImpacts())
    )
    work = lifted.statistics["work of corrections of positions [J]"]
    (warning,) = other_warnings(lifted)
    assert warning.startswith(f"corrections of positions, which lift bodies, did {work:.3g} J")
    assert ", and let the energy grow by " in warning
    assert warning.endswith("use a shorter step, or integrator=AnticipatedImpacts()")
    assert not other_warnings(exact)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_bounces_that_die_out_and_bodies_without_rebound_are_not(scheme, restitution):
    motion = da.solve_nonsmooth(ball(1.0, restitution), 5.0, step=5e-3, integrator=scheme)
    assert motion.status.success and not other_warnings(motion)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_overlaps_of_the_start_name_the_bodies_the_depth_and_the_remedy(scheme):
    text = refusal(ball(0.05), scheme)
    assert text.startswith("floor: ball and a fixed shape overlap by 0.05 m at the start")
    assert text.endswith("; move them apart by this depth along the normal of the contact")
    system = da.System("balls")
    shapes = [
        contact.Circle(planar.Body(name, mass=1.0, inertia=1.0, position=(x, 0)).center, 0.1)
        for name, x in (("a", 0.0), ("b", 0.15), ("c", 0.34))
    ]
    for shape in shapes:
        system.add(shape.point.body)
    system.add(planar.Collisions("hits", shapes))
    text = refusal(system.build(), scheme)
    assert text.startswith("hits: a and b overlap by 0.05 m at the start")
    assert text.endswith("; 1 other pair overlaps by less")


def refusal(model: da.Model, scheme) -> str:
    """Message of a run that is refused before its first step."""
    with pytest.raises(da.AnalysisError) as error:
        da.solve_nonsmooth(model, 0.1, step=0.01, integrator=scheme)
    return str(error.value)


def test_shapes_that_cannot_touch_are_refused():
    system = da.System("lonely")
    body = system.add(planar.Body("ball", mass=1.0, inertia=1.0))
    hits = system.add(planar.Collisions("hits", [contact.Circle(body, 0.1)]))
    text = r"hits: nothing can touch: its only shape is on ball; add a shape of another body"
    with pytest.raises(da.AnalysisError, match=text):
        da.solve_nonsmooth(system.build(), 0.1, step=0.01)
    del system.elements[hits.name]
    groups = {"all": [contact.Circle(body.point(x, 0), 0.1) for x in (0.0, 1.0)]}
    hits = system.add(planar.Collisions("hits", groups))
    with pytest.raises(da.AnalysisError, match="hits: nothing can touch: all of its 2 shapes are"):
        da.solve_nonsmooth(system.build(), 0.1, step=0.01)
    del system.elements[hits.name]
    groups |= {"floor": [contact.HalfPlane(system.ground)]}
    apart = [contact.Pair(("all", "floor"), touching=False)]
    system.add(planar.Collisions("hits", groups, pairs=apart))
    with pytest.raises(da.AnalysisError, match="its pairs have touching=False between all groups"):
        da.solve_nonsmooth(system.build(), 0.1, step=0.01)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_contact_schemes_do_not_locate_impacts(scheme):
    """The message names the analysis that takes them."""
    with pytest.raises(da.AnalysisError, match="or use solve_nonsmooth, to which contact schemes"):
        da.solve_dynamics(ball(1.0), 1.0, step=0.01, integrator=scheme)


@pytest.mark.thorough
def test_forces_that_alternate_at_rest_are_warned_about():
    """Their mean is the weight; shorter steps, and Moreau and Jean's scheme, have it in each."""

    def resting(step: float, **options):
        system = da.System("rest", gravity=(0.0, -9.81))
        ball = system.add(planar.Particle("ball", mass=1.0, position=(0.3, 0.5)))
        floor = planar.contact.HalfPlane(system.ground.point(0.2, 0.1))
        shapes = [planar.contact.Circle(ball.center, 0.1), floor]
        system.add(planar.Collisions("hits", shapes, friction=0.3, restitution=0.2))
        return da.solve_nonsmooth(system.build(), 3.0, step=step, **options)

    rough = resting(0.01)
    forces = rough.impulse("hits").values[-2:] / 0.01
    assert forces.mean() == pytest.approx(9.81, rel=1e-6) and np.ptp(forces) > 1.0
    (warning,) = (text for text in rough.warnings if "alternates" in text)
    low, high = np.sort(forces)
    assert warning.startswith(
        f"a contact force of hits alternates between {low:.3g} and {high:.3g} N from step to step"
    )
    for fine in (resting(0.002), resting(0.01, integrator=da.MoreauJean())):
        assert not any("alternates" in text for text in fine.warnings)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_spins_do_not_turn_impulses(scheme):
    """A ball that slides, and then rolls straight on with 5/7 of its speed, whatever its spin about
    the vertical is; torques are weaker by ``(h ω)²/8`` to second order."""
    radius, mass, speed, spin, h = 0.03, 0.2, 2.0, 150.0, 1e-3
    system = da.System("ball", gravity=(0, 0, -9.81))
    ball = system.add(
        da.spatial.Body(
            "b",
            mass=mass,
            inertia=(2 / 5 * mass * radius**2,) * 3,
            position=(0, 0, radius),
            velocity=(speed, 0, 0),
            angular_velocity=(0, 0, spin),
        )
    )
    kit = da.spatial.contact
    shapes = [kit.Sphere(ball.point(0, 0, 0), radius), kit.HalfSpace(system.ground.frame())]
    system.add(da.spatial.Collisions("c", shapes, friction=0.2))
    model = system.build()
    motion = da.solve_nonsmooth(model, 0.5, step=h, integrator=scheme)
    assert not other_warnings(motion)
    along, across, up = motion["b.velocity"].values[-1]
    assert (across, up) == pytest.approx((0, 0), abs=1e-7)
    weaker = 1 / np.hypot(1, h * spin / 2)
    assert along == pytest.approx(speed * weaker / (weaker + 2 / 5), rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_the_estimate_is_that_of_a_coin_that_falls_flat(step: float):
    """In five or ten steps, as a pendulum about its rim; then it lies, also with longer steps."""
    radius, thick, mass, tilt = 0.1, 4e-3, 0.1, 1e-3
    inertia, half = mass * (3 * radius**2 + thick**2) / 12, thick / 2

    def height(q: np.ndarray) -> np.ndarray:
        return np.asarray(radius * np.sin(q) + half * np.cos(q))

    def rates(t: float, x: np.ndarray) -> list[float]:
        slope, bend = radius * np.cos(x[0]) - half * np.sin(x[0]), -height(x[0])
        pull = -mass * (G * slope + slope * bend * x[1] ** 2)
        return [x[1], float(pull / (inertia + mass * slope**2))]

    system = da.System("coin", gravity=(0, 0, -G))
    start = {
        "position": (0, 0, float(height(np.array(tilt)))),
        "rotation": da.rotation.axis_angle((1, 0, 0), tilt),
    }
    coin = system.add(spatial.Cylinder("coin", radius=radius, length=thick, mass=mass, **start))
    ends = coin.point(0, 0, -half), coin.point(0, 0, half)
    floor = spatial.contact.HalfSpace(system.ground.frame())
    system.add(spatial.Collisions("floor", [spatial.contact.Cylinder(*ends, radius), floor]))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=step)
    fall = solve_ivp(
        rates, (0, 5e-3), [tilt, 0.0], t_eval=motion.time[motion.time <= 5e-3], rtol=1e-10
    )
    exact = np.full(motion.time.size, half)
    exact[: fall.t.size] = height(fall.y[0])
    z = motion.values("coin.z")
    error = np.abs(z - exact).max() / np.ptp(z)
    assert error > 0.1 and error / 1.5 < motion.error_estimate.share < 1.5 * error
    assert any("their estimated error is" in text for text in motion.warnings)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_string_on_a_drum_holds_up_to_the_ratio_of_its_forces(scheme: da.AnticipatedImpacts):
    """Beads over half a drum: at each, ``T₂ − T₁`` is at most ``μ tan(δ/2) (T₂ + T₁)`` for its turn
    δ. Those at rest move by clearances, which are no errors to warn about."""
    count, rough, pull, radius, bead, hanging = 8, 0.3, 10.0, 0.5, 0.02, 0.2
    turn, around = np.pi / (count - 1), radius + bead
    growths = [(1 + rough * np.tan(d / 2)) / (1 - rough * np.tan(d / 2)) for d in (turn, turn / 2)]
    ratio = growths[0] ** (count - 2) * growths[1] ** 2
    angles = np.pi - turn * np.arange(count)
    places = [(around * float(np.cos(a)), around * float(np.sin(a))) for a in angles]
    places = [(-around, -hanging), *places, (around, -hanging)]
    for share, holds in ((0.99, True), (1.01, False)):
        system = da.System("capstan", gravity=(0, 0))
        beads = [
            system.add(planar.Particle(f"p{k}", mass=0.01, position=place))
            for k, place in enumerate(places)
        ]
        for k, (one, other) in enumerate(pairwise(beads)):
            length = float(np.hypot(*np.subtract(places[k], places[k + 1])))
            system.add(planar.RigidLink(f"d{k}", one.center, other.center, length=length))
        for k, force in ((0, pull), (count + 1, share * ratio * pull)):
            system.add(planar.Force(f"f{k}", beads[k].center, (0.0, -force)))
        shapes = [contact.Circle(each.center, bead) for each in beads[1:-1]]
        drum = contact.Circle(system.ground.center, radius)
        system.add(planar.Collisions("drum", [*shapes, drum], friction=rough))
        motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3, integrator=scheme)
        moved = abs(motion.values(f"p{count + 1}.y")[-1] + hanging)
        assert motion.status.success
        assert moved < 1e-6 if holds else moved > 1e-3
        assert not (holds and motion.warnings)
