"""Groups of shapes and their pairs, in Python and in files."""

import tomllib

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.cli import main
from dalembert.errors import ModelError
from dalembert.io import load

contact = planar.contact
FILE = """
format = 1
name = "groups"
gravity = [0, -9.81]
parameters = { mu = 0.3 }

[bodies.disc]
mass = 1
inertia = 0.005
position = [0, 0.1]

[bodies.crate]
mass = 1
inertia = 0.005
position = [0.5, 0.05]

[forces.box]
type = "Collisions"
restitution = 0.1
friction = 0.2
pairs = [
  { groups = ["crates", "walls"], friction = "mu" },
  { groups = ["discs", "crates"], touching = false },
]

[forces.box.shapes]
discs = [{ type = "Circle", point = "disc", radius = 0.1 }]
crates = [{ type = "Rectangle", point = "crate", size = [0.2, 0.1] }]
walls = [{ type = "HalfPlane", point = "ground" }]
"""

PAIRS = '  { groups = ["crates", "walls"], friction = "mu" },'
APART = """
  { groups = ["crates", "walls"], touching = false },
  { groups = ["discs", "walls"], touching = false },
"""


def read(tmp_path, text: str) -> da.System:
    path = tmp_path / "model.toml"
    path.write_text(text, encoding="utf-8")
    return load(path)


def gaps_of(model: da.Model, reach: float = 10.0):
    travels = np.full((model.equations.speed_count, 1), reach)
    return gap_sources(model)[0].near(Configuration(0.0, model.start.y, model.nominal), travels)


@pytest.mark.thorough
def test_files_have_groups_and_pairs(tmp_path, schema):
    system = read(tmp_path, FILE)
    element = system.elements["box"]
    assert list(element.groups) == ["discs", "crates", "walls"]
    gaps = gaps_of(system.build())  # disc on the wall; four corners of the crate on the wall
    assert sorted(gaps.laws.friction[:, 0]) == [0.2, 0.3, 0.3, 0.3, 0.3]
    assert gaps.laws.restitution == pytest.approx(0.1)
    schema.validate(tomllib.loads(FILE))


def test_laws_in_files_have_units(tmp_path, schema):
    """Lengths of rolling friction, static friction and the law of impact."""
    old = "friction = 0.2\n"
    new = 'friction = 0.2\nstatic_friction = 0.25\nrolling = "2 mm"\nimpact_law = "energetic"\n'
    pair = 'friction = "mu", static_friction = 0.4, rolling = 0.001'
    assert old in FILE
    text = FILE.replace(old, new).replace('friction = "mu"', pair)
    schema.validate(tomllib.loads(text))
    model = read(tmp_path, text).build()
    element = model.parts.elements["box"]
    assert element.friction_groups == (1, 1) and element.impact_law == "energetic"
    source = gap_sources(model)[0]
    travels = np.full((model.equations.speed_count, 1), 10.0)
    laws = source.near(Configuration(0.0, model.start.y, model.nominal), travels).laws
    assert sorted(laws.friction[:, 1]) == [0.001] * 4 + [0.002]
    assert sorted(laws.static_friction) == [0.25] + [0.4] * 4
    motion = da.solve_nonsmooth(model, 0.05, step=1e-3, integrator=da.MoreauJean())
    assert motion.status.success


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"crates", "walls"', '"crates", "wals"', r"box.pairs\[0\]: unknown group 'wals' \(did"),
        ('"crates", "walls"', '"crates"', r"box.pairs\[0\]: groups is \['crates'\]; give two"),
        ('"discs", "crates"', '"walls", "crates"', r"box.pairs\[1\]: walls and crates have"),
        ('friction = "mu"', 'fricton = "mu"', r"pairs\[0\].fricton: unknown key"),
        ("touching = false", "friction = -1", r"pairs\[1\].friction: is -1"),
        ("touching = false", "static_friction = 0.1", r"pairs\[1\]: static_friction is 0.1; it"),
        ("touching = false", "spinning = 0.1", r"box.pairs\[1\].spinning: nothing spins about"),
        ("touching = false", 'rolling = "1 s"', r"pairs\[1\].rolling: 1 s does not fit, exp"),
        ("friction = 0.2", 'impact_law = "brach"', "box.impact_law: unknown law 'brach'"),
        ("touching = false", "restitution = 1.5", r"pairs\[1\]: restitution is above 1: 1.5"),
        ("radius = 0.1", "radius = 0", r"shapes.discs\[0\].radius: is 0 m"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]',
         '"Outline", body = "crate", vertices = [[0, 0], [0, 1], [1, 0]]',
         r"shapes.crates\[0\]: its vertices run clockwise"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]',
         '"Outline", body = "crate", vertices = [[0, 0], [3, 0], [1, 1], [2, -1]]',
         r"shapes.crates\[0\]: its edges cross each other"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]', '"Prism", point = "crate"',
         r"crates\[0\]: unknown type 'Prism'; known: Vertex, Circle, Bore"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]',
         '"Polygon", body = "crate", vertices = [[0, 0], [0, 1], [1, 0]]',
         r"shapes.crates\[0\]: its vertices run clockwise; give them anticlockwise"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]',
         '"Polygon", body = "crate", vertices = [[0, 0], [4, 0], [1, 1], [0, 4]]',
         r"shapes.crates\[0\]: it has a dent, or edges that cross; give an Outline, or several"),
        ('"Rectangle", point = "crate", size = [0.2, 0.1]',
         '"Polygon", body = "crate", vertices = [[0, 0], [1, 0]]',
         r"box.shapes.crates\[0\]: needs at least 3 vertices"),
        ("radius = 0.1", 'radius = "1 kg"', r"box.shapes.discs\[0\].radius: 1 kg does not fit"),
        ('discs = [{ type = "Circle", point = "disc", radius = 0.1 }]', "discs = 3",
         "shapes.discs: expected a list"),
    ],
)  # fmt: skip
def test_errors_name_the_place(tmp_path, old, new, message):
    assert old in FILE
    with pytest.raises(ModelError, match=message):
        read(tmp_path, FILE.replace(old, new)).build()


def test_files_without_shapes_are_refused(tmp_path):
    start, end = FILE.index("pairs"), FILE.index("[forces.box.shapes]")
    text = FILE[:start] + "[forces.box.shapes]\n"
    assert end > start
    with pytest.raises(
        ModelError, match=r"forces\.box\.shapes: there are no shapes; give contact.Circle"
    ):
        read(tmp_path, text)


def test_empty_groups_are_refused(tmp_path):
    text = FILE.replace('discs = [{ type = "Circle", point = "disc", radius = 0.1 }]', "discs = []")
    assert text != FILE
    with pytest.raises(ModelError, match=r"box\.shapes\.discs: there are no shapes; give"):
        read(tmp_path, text)
    with pytest.raises(ModelError, match=r"hits\.shapes: there are no shapes; give"):
        planar.Collisions("hits", [])


def test_rows_that_are_no_lists_are_refused(tmp_path):
    text = FILE.replace(
        '"Rectangle", point = "crate", size = [0.2, 0.1]',
        '"Polygon", body = "crate", vertices = [[0, 0], 1, [1, 1]]',
    )
    assert text != FILE
    with pytest.raises(ModelError, match=r"crates\[0\].vertices\[1\]: expected a list of numb"):
        read(tmp_path, text)


U = da.curves.u


@pytest.mark.parametrize(
    ("curve", "message"),
    [
        ((0.1 * da.cos(U / 2), 0.1 * da.sin(U / 2)), r"its closed curve are 0\.2 m apart; close"),
        ((0 * U, 0 * U), "its curve is a point"),
        ((U, da.log(-1 - U)), "has points that are not finite"),
    ],
)
def test_profiles_that_bound_no_material_are_refused(curve, message):
    """The half circle let bodies fall through floors."""
    system = da.System("profile")
    body = system.add(planar.Body("body", mass=1.0, inertia=1.0))
    profile = contact.Profile(body, da.FormulaCurve(*curve))
    system.add(planar.Collisions("touch", [profile, contact.HalfPlane(system.ground)]))
    with pytest.raises(ModelError, match=message):
        system.build()


def test_polygons_that_cross_themselves_are_refused():
    """All corners of a pentagram are left turns."""
    system = da.System("star")
    body = system.add(planar.Body("star", mass=1.0, inertia=1.0))
    angles = 4 * np.pi / 5 * np.arange(5)
    star = contact.Polygon(body, np.column_stack([np.cos(angles), np.sin(angles)]).tolist())
    system.add(planar.Collisions("touch", [star, contact.HalfPlane(system.ground)]))
    with pytest.raises(ModelError, match="its edges cross each other"):
        system.build()


@pytest.mark.thorough
def test_polygons_may_have_corners_on_an_edge():
    """Rounding makes some of these corners a dent of 1e-17 m."""
    for angle in np.linspace(0.1, 3, 30):
        system = da.System("plate")
        body = system.add(planar.Body("plate", mass=1.0, inertia=1.0))
        c, s = np.cos(angle), np.sin(angle)
        corners = np.array([[0, 0], [0.1, 0], [0.3, 0], [0.3, 0.2], [0, 0.2]]) @ [[c, s], [-s, c]]
        plate = contact.Polygon(body, corners.tolist())
        system.add(planar.Collisions("touch", [plate, contact.HalfPlane(system.ground)]))
        system.build()


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("position = [0.5, 0.05]", "position = [0.5, 0.04]", "crate and a fixed shape overlap"),
        (PAIRS, APART, "nothing can touch"),
    ],
)
def test_starts_that_cannot_run_are_wrong_input(command, old, new, message, tmp_path, capsys):
    """Exit code 2, of ``check``, too."""
    assert old in FILE
    path = tmp_path / "model.toml"
    path.write_text(
        FILE.replace(old, new) + '[analysis]\ntype = "Nonsmooth"\nduration = 0.1\n',
        encoding="utf-8",
    )
    output = ["--output", str(tmp_path / "out")] if command == "run" else []
    assert main([command, str(path), *output]) == 2
    assert f"analysis: box: {message}" in " ".join(capsys.readouterr().err.split())


def pucks(**options) -> da.Model:
    """Three pucks in a row; the left one moves."""
    system, groups = da.System("pucks"), {}
    for k, name in enumerate(["left", "middle", "right"]):
        speed = 1.0 if k == 0 else 0.0
        puck = planar.Body(
            name, mass=1.0, inertia=1.0, position=(0.3 * k, 0.0), velocity=(speed, 0.0)
        )
        groups[name] = [contact.Circle(system.add(puck), 0.1)]
    system.add(planar.Collisions("hits", groups, **options))
    return system.build()


def test_pairs_have_their_own_restitution():
    pairs = [contact.Pair(("right", "middle"), restitution=0.5)]
    motion = da.solve_nonsmooth(pucks(restitution=1.0, pairs=pairs), 0.5, step=1e-3)
    speeds = [motion[f"{name}.vx"][-1].item() for name in ("left", "middle", "right")]
    assert speeds == pytest.approx([0.0, 0.25, 0.75], abs=1e-12)


def test_groups_that_do_not_touch_pass_through_each_other():
    pairs = [
        contact.Pair(("left", "middle"), touching=False),
        contact.Pair(("middle", "right"), touching=False),
    ]
    motion = da.solve_nonsmooth(pucks(restitution=1.0, pairs=pairs), 0.7, step=1e-3)
    assert motion["middle.vx"][-1] == 0
    assert motion["right.vx"][-1] == pytest.approx(1.0)  # hit by the left one


def test_shapes_of_one_body_do_not_touch():
    system = da.System("compound")
    body = system.add(planar.Body("cross", mass=1.0, inertia=1.0))
    bars = [
        contact.Rectangle(body.center, (1.0, 0.1)),
        contact.Rectangle(body.center, (0.1, 1.0)),
        contact.Circle(body.center, 0.2),
    ]
    system.add(planar.Collisions("none", bars))
    assert gaps_of(system.build()).count == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pairs": [3]}, r"pairs\[0\]: is 3; give pairs such as contact.Pair"),
        ({"pairs": [contact.Pair(("left", "top"))]}, "unknown group 'top'"),
    ],
)
def test_wrong_pairs_are_refused(options, message):
    with pytest.raises(ModelError, match=message):
        pucks(**options)


@pytest.mark.parametrize("name", ["friction", "restitution", "impact_law", "law"])
def test_pairs_that_do_not_touch_have_no_coefficients(name):
    laws = {"impact_law": "poisson", "law": contact.KelvinVoigt(stiffness=1e3)}
    with pytest.raises(ModelError, match=f"touching=False have no {name}; leave it out"):
        contact.Pair(("left", "right"), touching=False, **{name: laws.get(name, 0.3)})


def test_wrong_shapes_are_refused():
    body = planar.Body("b", mass=1.0, inertia=1.0)
    disc = contact.Circle(body, 0.1)
    with pytest.raises(ModelError, match=r"there is no group 'a'; give shapes=\{'a'"):
        planar.Collisions("c", [disc], pairs=[contact.Pair(("a", "b"))])
    with pytest.raises(ModelError, match="touching is 3"):
        contact.Pair(("a", "b"), touching=3)
    ball = spatial.Body("b", mass=1.0, inertia=(1, 1, 1))
    with pytest.raises(
        ModelError, match=r"Socket is not available here; give shapes such as contact\.Sphere"
    ):
        spatial.Collisions("c", [spatial.contact.Socket(ball.center, 1.0)])


def test_outlines_may_have_edges_on_one_line():
    """Feet of opposite teeth of a gear are on a line through its axis, but for rounding."""
    for teeth in range(8, 40, 2):
        system = da.System("gear")
        gear = system.add(planar.Body("gear", mass=1.0, inertia=1.0))
        tooth = [(0.055, -0.066), (0.0564, -0.066), (0.064, -0.02)]
        tooth += [(radius, -angle) for radius, angle in tooth[::-1]]
        corners = [
            (radius * np.cos(angle + middle), radius * np.sin(angle + middle))
            for middle in 2 * np.pi / teeth * np.arange(teeth)
            for radius, angle in tooth
        ]
        outline = contact.Outline(gear, corners)
        system.add(planar.Collisions("touch", [outline, contact.HalfPlane(system.ground)]))
        assert system.build().diagnosis.degrees_of_freedom == 3
