"""Contacts among many shapes, drawn in the studio: they rest with the forces of their weight."""

from __future__ import annotations

import tomllib

import pytest
from studio_desk import UNTITLED, Desk
from studio_runs import Studio

from dalembert.errors import ModelError
from dalembert.studio.drawing_edits import apply

SQUARE = ((0.7, 0.4), (0.9, 0.4), (0.9, 0.6), (0.7, 0.6))
FORCES = """(() => {
    const { motion } = studio.pictures.page, cursor = { i: motion.n - 1, f: 0 };
    const contacts = motion.joints.filter(({ description }) => description === "contact");
    return contacts.map(({ force }) => force.map((values) => motion.sample(values, cursor)));
})()"""
"""Forces of the contacts at the end [N]; NaN of those that do not touch."""


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.mark.thorough
def test_shapes_are_attached_and_bodies_rest_on_the_floor(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.draw("a", (0.3, 0.5))
    visit.draw("D", (0.3, 0.5), (0.4, 0.5))
    visit.draw("F", (0.2, 0.1), (0.8, 0.1))
    visit.draw("p", *SQUARE, SQUARE[0])
    visit.draw("Y", *SQUARE, SQUARE[0])
    (collisions,) = visit.document["forces"].values()
    shapes = collisions["shapes"]
    assert [(name, len(group)) for name, group in shapes.items()] == [
        ("mass1", 1),
        ("ground", 1),
        ("plate1", 1),
    ]
    assert shapes["mass1"][0]["radius"] == pytest.approx(0.1)
    assert shapes["ground"][0]["normal"] == [0, 1]
    assert visit.errors_shown() == []
    places = visit.js(
        """["mass1.y", "plate1.y", "plate1.angle"].map((name) =>
            studio.pictures.page.motion.seriesByName.get(name).values.at(-1))"""
    )
    assert places == pytest.approx([0.2, 0.2, 0.0], abs=1e-4)
    forces = [force for force in visit.js(FORCES) if force[1] == force[1]]
    mass = visit.document["bodies"]["plate1"]["mass"] + 1.0
    assert abs(sum(force[1] for force in forces)) == pytest.approx(9.81 * mass, rel=1e-3)
    visit.page.keyboard.press("v")
    visit.page.keyboard.press("8")
    visit.until("studio.pictures.page.scene.show.forces", 5)

    visit.page.click("#tab-contacts")
    visit.page.fill("[name=friction-mass1-ground]", "0.9")
    visit.page.keyboard.press("Enter")
    visit.until("Object.values(studio.file.document.forces)[0].pairs?.length === 1", 10)
    visit.page.uncheck("[name=touch-mass1-plate1]")
    visit.until("Object.values(studio.file.document.forces)[0].pairs?.length === 2", 10)
    (entry,) = visit.document["forces"].values()
    assert entry["pairs"] == [
        {"groups": ["mass1", "ground"], "friction": 0.9},
        {"groups": ["mass1", "plate1"], "touching": False},
    ]
    visit.settle()
    assert visit.errors_shown() == []
    visit.page.click("[aria-label='Remove shape 1 of plate1']")
    visit.until("!Object.values(studio.file.document.forces)[0].shapes.plate1", 10)
    (entry,) = visit.document["forces"].values()
    assert [pair["groups"] for pair in entry["pairs"]] == [["mass1", "ground"]]


@pytest.mark.thorough
def test_a_floor_is_drawn_before_the_bodies_on_it(desk: tuple[Desk, Studio]) -> None:
    """The picture shows the first shape; the message names what is missing."""
    visit, _ = desk
    visit.draw("a", (0.3, 0.5))
    visit.draw("F", (0.2, 0.1), (0.8, 0.1))
    (error,) = visit.errors_shown()
    assert "its only shape is on ground; add a shape of another body" in error
    assert "contact.Circle(ball, 0.1)" in error
    assert not visit.js("studio.pictures.outdated")
    visit.draw("D", (0.3, 0.5), (0.4, 0.5))
    assert visit.errors_shown() == []


FLOOR = UNTITLED + (
    "[bodies]\n"
    'ball = { type = "Particle", mass = 1, position = [0.2, 0.5] }\n'
    'other = { type = "Particle", mass = 1, position = [0.3, 0.7] }\n'
    "[forces]\n"
    'touch = { type = "Collisions", friction = 0.3, shapes = {'
    ' ball = [{ type = "Circle", point = "ball", radius = 0.05 }],'
    ' other = [{ type = "Circle", point = "other", radius = 0.06 }],'
    ' ground = [{ type = "HalfPlane", point = { body = "ground", at = [0.2, 0.1] },'
    " normal = [0, 1] }] } }\n"
)


@pytest.mark.thorough
def test_shapes_of_copies_belong_to_the_same_contacts(desk: tuple[Desk, Studio]) -> None:
    """The copy of a body touches the floor and the other bodies as the body does."""
    visit, _ = desk
    lists = FLOOR.replace("shapes = {", "shapes = [", 1).replace("] } }\n", "] }\n", 1)
    for name in ("ball", "other", "ground"):
        lists = lists.replace(f" {name} = [", " ").replace("}],", "},")
    assert isinstance(tomllib.loads(lists)["forces"]["touch"]["shapes"], list)
    for text in (FLOOR, lists):
        visit.show(text)
        visit.js("studio.drawing.select(['ball', 'touch'])")
        visit.press("Control+d")
        assert list(visit.document["forces"]) == ["touch"]
        shapes = visit.document["forces"]["touch"]["shapes"]
        circle = {"type": "Circle", "point": "ball1", "radius": 0.05}
        before = tomllib.loads(text)["forces"]["touch"]["shapes"]
        added = [*before, circle] if isinstance(before, list) else before | {"ball1": [circle]}
        assert shapes == added
        assert visit.errors_shown() == []
        visit.press("Control+z")
        assert visit.text == text


@pytest.mark.thorough
def test_a_concave_polygon_is_refused(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("Y")
    for place in ((0.2, 0.2), (0.6, 0.2), (0.4, 0.3), (0.6, 0.6)):
        visit.click(*place)
    visit.page.keyboard.press("Enter")
    visit.until("document.getElementById('notice').textContent.includes('convex')", 5)
    assert visit.text == UNTITLED


SECOND = FLOOR + (
    'more = { type = "Collisions", law = { type = "HuntCrossley", stiffness = 1e6,'
    " restitution = 0.5, impact_speed = 1.0 }, "
    'shapes = { a = [{ type = "Circle", point = "ball", radius = 0.01 }],'
    ' b = [{ type = "Circle", point = "other", radius = 0.02 }] } }\n'
)


def enter(visit: Desk, name: str, text: str, number: int = 0) -> str:
    """Type into a field of the sheet; returns the message beside it."""
    field = visit.page.locator(f".contacts [name='{name}']").nth(number)
    field.fill(text)
    field.press("Enter")
    visit.until("studio.isAnswered", 20)
    message: str = field.evaluate("field => field.validationMessage")
    return message


@pytest.mark.thorough
def test_coefficients_of_contacts_are_numbers_or_formulas_or_removed(
    desk: tuple[Desk, Studio],
) -> None:
    visit, _ = desk
    text = FLOOR.replace("[bodies]", "parameters = { mu = 0.4 }\n[bodies]")
    visit.show(text)
    visit.page.click("#tab-contacts")
    assert enter(visit, "friction-ball-other", "0,5") == "Write a decimal point: 0.5"
    assert visit.text == text
    assert enter(visit, "friction-ball-other", "mu/2") == ""
    entry = visit.document["forces"]["touch"]
    assert entry["pairs"] == [{"groups": ["ball", "other"], "friction": "mu/2"}]
    visit.until("studio.described.revision >= studio.file.revision", 60)
    assert visit.errors_shown() == []
    enter(visit, "friction-ball-other", "")
    assert visit.text == text
    enter(visit, "friction", "mu")
    enter(visit, "friction", "0.5")
    assert visit.document["parameters"] == {"mu": 0.4}
    assert visit.document["forces"]["touch"]["friction"] == 0.5
    enter(visit, "friction", "")
    assert "friction" not in visit.document["forces"]["touch"]
    for _ in range(5):
        visit.press("Control+z")
    assert visit.text == text
    visit.page.click("#tab-text")


def test_all_elements_of_contacts_are_listed(desk: tuple[Desk, Studio]) -> None:
    """One with a normal force law has no coefficient of restitution."""
    visit, _ = desk
    visit.show(SECOND)
    assert visit.errors_shown() == []
    visit.page.click("#tab-contacts")
    assert visit.page.locator(".contacts h3").all_inner_texts() == ["touch", "more"]
    assert "Normal force: HuntCrossley" in visit.page.inner_text(".contacts")
    assert visit.page.locator(".contacts [name=restitution]").count() == 1
    assert visit.page.locator(".contacts [name=restitution-a-b]").is_disabled()
    enter(visit, "friction", "0.7", 1)
    assert visit.document["forces"]["more"]["friction"] == 0.7
    assert visit.js("document.activeElement.value") == "0.7"
    assert visit.document["forces"]["touch"]["friction"] == 0.3
    visit.page.click("#tab-text")


@pytest.mark.thorough
def test_contacts_of_spatial_models_have_coefficients(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(
        "format = 1\ndimension = 3\n[bodies]\n"
        'one = { type = "Particle", mass = 1, position = [0, 0, 0] }\n'
        'two = { type = "Particle", mass = 1, position = [1, 0, 0] }\n[forces.hits]\n'
        'type = "Collisions"\n[forces.hits.shapes]\n'
        'a = [{ type = "Sphere", point = "one", radius = 0.1 }]\n'
        'b = [{ type = "Sphere", point = "two", radius = 0.1 }]\n'
    )
    assert visit.errors_shown() == []
    visit.page.click("#tab-contacts")
    assert visit.page.locator(".contacts .chips").count() == 0  # no planar tools
    enter(visit, "restitution-a-b", "0.25")
    pairs = visit.document["forces"]["hits"]["pairs"]
    assert pairs == [{"groups": ["a", "b"], "restitution": 0.25}]
    visit.settle()
    assert visit.errors_shown() == []
    visit.page.click("#tab-text")


MODEL = """\
format = 1
[bodies]
one = { type = "Particle", mass = 1 }
two = { type = "Particle", mass = 1, position = [1, 0] }
[forces.hits]  # of both
type = "Collisions"
pairs = [{ groups = ["a", "b"], friction = 0.5 }]
[forces.hits.shapes]
a = [{ type = "Circle", point = "one", radius = 0.1 }]
b = [{ type = "Circle", point = "two", radius = 0.1 }, "one"]
"""


def test_a_removed_body_takes_its_own_shapes() -> None:
    text = apply(MODEL, [{"op": "remove", "section": "bodies", "name": "one"}])
    assert "one" not in text and 'b = [{ type = "Circle", point = "two", radius = 0.1 }]' in text
    assert "pairs" not in text
    last = apply(text, [{"op": "remove", "section": "bodies", "name": "two"}])
    assert "Collisions" not in last and "bodies" not in last


RUBBER = MODEL.replace("a = [", "# rubber\na = [").replace("radius = 0.1 }", "radius = 0.10 }")
TABLES = """\
format = 1
[bodies]
one = { type = "Particle", mass = 1 }
two = { type = "Particle", mass = 1, position = [1, 0] }
[forces.hits]  # of both
type = "Collisions"
[[forces.hits.shapes.a]]
type = "Circle"
point = "one"
radius = 0.10  # m
[[forces.hits.shapes.b]]
type = "Circle"
point = "two"
radius = 0.10
[[forces.hits.pairs]]
groups = ["a", "b"]
friction = 0.5
"""


@pytest.mark.parametrize("text", [RUBBER, TABLES], ids=["arrays", "tables"])
def test_changes_of_contacts_keep_the_rest_of_the_text(text: str) -> None:
    """Comments, order and spelling remain, of shapes and pairs in arrays and in tables."""
    lost = apply(text, [{"op": "remove group", "name": "hits", "group": "b"}])
    assert list(tomllib.loads(lost)["forces"]["hits"]["shapes"]) == ["a"]
    assert "pairs" not in tomllib.loads(lost)["forces"]["hits"]
    assert set(lost.splitlines()) <= set(text.splitlines())
    assert "[forces.hits]  # of both" in lost and "radius = 0.10" in lost
    keys = ["forces", "hits", "pairs"]
    operation = {"op": "set", "keys": [*keys, 0, "friction"], "value": "0.9", "written": True}
    changed = tomllib.loads(apply(text, [operation]))["forces"]["hits"]
    own = tomllib.loads(text)["forces"]["hits"]
    assert changed == own | {"pairs": [own["pairs"][0] | {"friction": "0.9"}]}
    kept = apply(text, [{"op": "remove", "section": "bodies", "name": "one"}])
    assert "[forces.hits]  # of both" in kept and "one" not in kept
    keys, shape = ["forces", "hits", "shapes", "a"], {"type": "Vertex"}
    more = apply(text, [{"op": "append_item", "keys": keys, "value": shape}])
    shapes = [*own["shapes"]["a"], shape]
    assert tomllib.loads(more)["forces"]["hits"]["shapes"]["a"] == shapes
    removal = {"op": "remove_item", "keys": [*keys, 1]}
    assert tomllib.loads(apply(more, [removal])) == tomllib.loads(text)
    with pytest.raises(ModelError, match="hits"):
        apply(text, [removal | {"keys": [*keys, 7]}])
