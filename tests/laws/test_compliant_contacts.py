"""Laws of contacts with normal force laws among many shapes."""

import tomllib

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.errors import ModelError, UnsupportedError
from dalembert.integrators.contact.mean_force import mean_force
from dalembert.io import load

contact = planar.contact
HUNT = contact.HuntCrossley(stiffness=1e6, damping=0.2)
FLORES = contact.Flores(stiffness=1.0, restitution=1.5, impact_speed=1.0)


def power(exponent: float, stiffness=1e6, damping=0.3):
    """Force ``K δⁿ (1 + c δ̇)``."""

    def force(depth, rate):
        elastic = stiffness * depth**exponent
        factor = np.maximum(0.0, 1 + damping * rate)
        slope = damping * (factor > 0)
        return elastic * factor, exponent * elastic / depth * factor, elastic * slope

    return force


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 2.5])
def test_mean_force_does_the_work_of_the_elastic_energy(exponent):
    rng = np.random.default_rng(0)
    start, end = rng.uniform(-1e-3, 1e-3, (2, 200))
    mean = mean_force(power(exponent, damping=0.0), start, end, 0 * start).value
    energies = [1e6 * np.maximum(d, 0) ** (exponent + 1) / (exponent + 1) for d in (start, end)]
    assert mean * (end - start) == pytest.approx(energies[1] - energies[0], rel=1e-11, abs=1e-14)
    same = mean_force(power(exponent), end, end, 0 * end).value
    assert same == pytest.approx(1e6 * np.maximum(end, 0) ** exponent, rel=1e-12)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 1.8])
def test_mean_force_has_exact_derivatives_and_increases(exponent):
    rng = np.random.default_rng(1)
    start, end = rng.uniform(-1e-3, 1e-3, (2, 200))
    rate, d = rng.uniform(-6, 6, 200), 1e-9
    force = power(exponent)
    mean = mean_force(force, start, end, rate)
    by_end, by_rate = (
        (mean_force(force, start, end + x, rate + r).value
         - mean_force(force, start, end - x, rate - r).value) / 2 / (x + r)
        for x, r in ((d, 0.0), (0.0, 1e-6))
    )  # fmt: skip
    smooth = np.abs(1 + 0.3 * rate) > 1e-5
    assert mean.by_end == pytest.approx(by_end, rel=1e-4, abs=1e-3)
    assert mean.by_rate[smooth] == pytest.approx(by_rate[smooth], rel=1e-6, abs=1e-9)
    assert (mean.value >= 0).all() and (mean.by_end >= 0).all() and (mean.by_rate >= 0).all()


def billiards(**options):
    """Three balls, two of which approach the third obliquely."""
    system = da.System("billiards")
    stiffness = system.parameter("k", 1e6)
    law = contact.HuntCrossley(stiffness=stiffness, damping=0.2)
    shapes = []
    for name, place, speed in (
        ("a", (0, 0), (1, 0.1)),
        ("b", (0.205, 0.05), (0, 0)),
        ("c", (0.4, -0.02), (-2, 0)),
    ):
        body = planar.Body(name, mass=1.0, inertia=0.005, position=place, velocity=speed)
        shapes.append(contact.Circle(system.add(body).center, 0.1))
    system.add(planar.Collisions("hits", shapes, law=law, **options))
    return system.build()


@pytest.mark.thorough
def test_energy_momentum_and_parameters():
    """Curved gaps: energy to 1e-8 of the exchanged one, momentum to rounding."""
    model = billiards(friction=0.2)
    motion = da.solve_nonsmooth(model, 0.06, step=2e-4)
    assert motion.status.success and not motion.warnings
    data = motion.data
    assert float(abs(data["balance_error"]).max()) < 1e-7
    assert float(data["contact_energy"].max()) > 0.1
    momentum = sum(motion[f"{name}.vx"].values for name in "abc")
    assert momentum == pytest.approx(-1.0, abs=1e-12)
    lost = motion.statistics["energy dissipated in contacts [J]"]
    assert float(data["dissipated_energy"][-1]) == pytest.approx(lost) and lost > 0.1
    softer = da.solve_nonsmooth(model, 0.06, step=2e-4, parameters={"k": 1e5})
    assert (softer.record.fraction.max() < 0.7 * motion.record.fraction.max()).item()


@pytest.mark.thorough
def test_forces_of_compliant_contacts_have_places():
    """Contacts of pictures: the normal force on the ball, halfway between the surfaces."""
    system = da.System("rest", gravity=(0, -10))
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.005, position=(0, 0.1)))
    shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    law = contact.KelvinVoigt(stiffness=1e4, damping=200.0)
    system.add(planar.Collisions("floor", shapes, law=law))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3)
    contacts = motion.contact_forces(0.5)
    assert contacts.names.tolist() == ["floor"]
    assert contacts.places == pytest.approx(np.array([[0, -0.0005]]), abs=1e-6)
    assert contacts.forces == pytest.approx(np.array([[0, 10.0]]), rel=1e-6)
    assert motion.impulse("floor").sum().item() == pytest.approx(5.0, rel=1e-2)


def shapes_of(system):
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.2)))
    return {
        "balls": [contact.Circle(ball.center, 0.1)],
        "floor": [contact.HalfPlane(system.ground.center)],
    }


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"law": 3.0}, r"c.law: is 3.0; give a law such as contact.HuntCrossley\("),
        ({"law": HUNT, "restitution": 0.5}, r"c.restitution: restitution and law=HuntCrossley"),
        ({"law": HUNT, "tangential": 0.5}, r"c.tangential: tangential and law=HuntCrossley"),
        ({"law": HUNT, "impact_law": "poisson"}, r"c.impact_law: is 'poisson', and a force law"),
        (
            {"law": HUNT, "pairs": [{"restitution": 0.5}]},
            r"c.pairs\[0\].restitution: has no effect beside law=HuntCrossley\(…\) of c; give this "
            r"pair law=contact.Restitution",
        ),
        ({"pairs": [{"law": HUNT, "restitution": 0.5}]}, r"Pair.restitution: restitution and law="),
        ({"pairs": [{"law": "Hertz"}]}, r"Pair.law: is 'Hertz'; give a law"),
        ({"law": contact.Hertz(stiffness=-1.0)}, r"c.law.stiffness: is -1"),
        ({"pairs": [{"law": FLORES}]}, r"pairs\[0\].law: restitution is above 1: 1.5"),
    ],
)
def test_wrong_laws_name_place_value_and_remedy(options, message):
    def build():
        system, entries = da.System("wrong"), options.get("pairs", [])
        pairs = [contact.Pair(("balls", "floor"), **entry) for entry in entries]
        system.add(planar.Collisions("c", shapes_of(system), **options | {"pairs": pairs}))
        system.build()

    with pytest.raises(ModelError, match=message):
        build()


def test_law_depends_on_parameters_only():
    system = da.System("aging")
    shapes = shapes_of(system)
    law = contact.Hertz(stiffness=1e6 * (1 + da.t))
    system.add(planar.Collisions("c", shapes, law=law))
    with pytest.raises(ModelError, match=r"c.law.stiffness: depends on t; only parameters"):
        da.solve_nonsmooth(system.build(), 0.1, step=1e-3)


def test_schemes_and_laws_that_do_not_combine():
    system = da.System("both")
    shapes = shapes_of(system)
    system.add(planar.Collisions("soft", shapes, law=HUNT))
    model = system.build()
    with pytest.raises(UnsupportedError, match=r"soft: contacts with a force law need theta from"):
        da.solve_nonsmooth(model, 0.1, step=1e-3, integrator=da.MoreauJean(theta=0.2))
    other = system.add(planar.Particle("other", mass=1.0, position=(1, 0.2)))
    hard = [contact.Circle(other.center, 0.1), contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hard", hard, restitution=0.5, impact_law="poisson"))
    with pytest.raises(UnsupportedError, match="hard has the poisson law of impact and soft a for"):
        da.solve_nonsmooth(system.build(), 0.1, step=1e-3, integrator=da.MoreauJean())


def test_rigid_pair_in_compliant_collisions():
    """``Restitution`` as the law of a pair: the ball returns at its height by ``e²``."""
    system = da.System("rigid pair", gravity=(0, -10))
    shapes = shapes_of(system)
    pair = contact.Pair(("balls", "floor"), law=contact.Restitution(0.5))
    hits = planar.Collisions("hits", shapes, law=HUNT, pairs=[pair])
    system.add(hits)
    assert hits.force_laws == (HUNT, None)
    motion = da.solve_nonsmooth(system.build(), 0.25, step=1e-3)  # falls for √0.02 s, at √2 m/s
    rises = 0.25 - 0.02**0.5
    height = 0.1 + 0.5 * 2**0.5 * rises - 5 * rises**2
    assert motion["ball.y"][-1].item() == pytest.approx(height, abs=2e-3)
    assert float(motion.data["contact_energy"].max()) == 0.0
    assert motion.statistics["maximum penetration of compliant contacts [m]"] == 0.0


def test_compression_of_a_resting_ball():
    """``K δ^{3/2} = m g`` at rest, and ``V = 2/5 K δ^{5/2}``; no rigid contact penetrates."""
    depth, system = (10.0 / 1e6) ** (2 / 3), da.System("rest", gravity=(0, -10))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.1 - depth)))
    shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    law = contact.HuntCrossley(stiffness=1e6, damping=1.0)
    system.add(planar.Collisions("hits", shapes, law=law))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-3)
    assert motion.data["compression"].values == pytest.approx(depth, rel=1e-9)
    assert motion.data["contact_energy"].values == pytest.approx(0.4e6 * depth**2.5, rel=1e-9)
    deepest = motion.statistics["maximum penetration of compliant contacts [m]"]
    assert deepest == pytest.approx(depth, rel=1e-9)
    assert motion.statistics["maximum penetration [m]"] == 0.0


FILE = """
format = 1
name = "drop"
gravity = [0, -10]

[parameters]
k = 1e6

[bodies.ball]
type = "Particle"
mass = 1
position = [0, 0.11]

[forces.floor]
type = "Collisions"
friction = 0.2
law = { type = "HuntCrossley", stiffness = "k", damping = 0.2 }
pairs = [{ groups = ["balls", "walls"], law = { type = "Hertz", stiffness = 1e7 } }]

[forces.floor.shapes]
balls = [{ type = "Circle", point = "ball", radius = 0.1 }]
floors = [{ type = "HalfPlane", point = "ground" }]
walls = [{ type = "HalfPlane", point = { body = "ground", at = [-1, 0] }, normal = [1, 0] }]

[analysis]
type = "Nonsmooth"
duration = 0.06
step = 1e-4
"""


def test_laws_in_files(tmp_path, schema):
    path = tmp_path / "drop.toml"
    path.write_text(FILE, encoding="utf-8")
    schema.validate(tomllib.loads(FILE))
    system = load(path)
    laws = system.elements["floor"].force_laws
    assert [type(law).__name__ for law in laws] == ["HuntCrossley", "Hertz"]
    motion = da.solve_nonsmooth(system.build(), 0.06, step=1e-4)
    assert motion.status.success and float(motion.data["contact_energy"].max()) > 0.05


def test_wrong_laws_in_files(tmp_path):
    for old, new, message in (
        ("damping = 0.2", "dampng = 0.2", r"floor.law.*dampng: unknown key"),
        ('"Hertz"', '"Herz"', r"pairs\[0\].law.*unknown type 'Herz'"),
        ("stiffness = 1e7", "stiffness = -1e7", r"floor.pairs\[0\].law.stiffness: is -"),
        ("damping = 0.2", 'damping = "1 kg"', r"floor.law.damping: 1 kg does not fit, expected s"),
    ):
        path = tmp_path / "wrong.toml"
        path.write_text(FILE.replace(old, new), encoding="utf-8")
        with pytest.raises(ModelError, match=message):
            load(path).build()
