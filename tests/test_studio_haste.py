"""Work in the studio that is faster than its pictures: keys, drags, and texts of other pages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from structure_desk import LOOK as STRUCTURE_LOOK
from studio_desk import WAIT, Desk, reset
from studio_runs import Studio
from studio_walk import drag_back
from test_studio_server import page, receive, send
from test_studio_structures import SQUARE

PENDULUMS = """format = 1
gravity = [0.0, -9.81]
[bodies]
a = { type = "Bar", length = 0.4, mass = 1.0, position = [0.3, 0.1], angle = 0.0 }
b = { type = "Bar", length = 0.4, mass = 1.0, position = [0.7, 0.1], angle = 0.0 }
[joints]
O = { type = "Revolute", connect = [{ body = "ground", at = [0.1, 0.1] }, "a.start"] }
A = { type = "Revolute", connect = ["a.end", "b.start"] }
"""


def hurry(visit: Desk, keys: list[str]) -> None:
    """Press keys without a pause, and wait until all of them are carried out."""
    for key in keys:
        visit.page.keyboard.press(key)
    visit.until("!studio.commands.waiting.length && studio.isAnswered", WAIT)
    visit.settle()


@pytest.mark.thorough
def test_steps_that_overtake_the_picture_all_count(desk: tuple[Desk, Studio]) -> None:
    """Positions of bodies and places of joints move by the same sum."""
    visit, _ = desk
    visit.show(PENDULUMS)
    visit.js("studio.drawing.select(['a', 'b'])")
    hurry(visit, 5 * ["ArrowUp"] + 3 * ["ArrowRight"])
    document = visit.document
    joint = np.subtract(document["joints"]["O"]["connect"][0]["at"], [0.1, 0.1])
    for name, before in (("a", [0.3, 0.1]), ("b", [0.7, 0.1])):
        assert np.subtract(document["bodies"][name]["position"], before) == pytest.approx(joint)
    assert joint[1] / joint[0] == pytest.approx(5 / 3)
    hurry(visit, ["Control+d", "Control+d", "Delete"])
    assert len(visit.document["bodies"]) == 4 and not visit.errors_shown()


@pytest.mark.thorough
def test_clicks_before_the_answer_are_carried_out_after_it(desk: tuple[Desk, Studio]) -> None:
    """Three bars, another change and an undo, while the server has not answered the first."""
    visit, _ = desk
    visit.show('format = 1\nname = "a"\n')
    visit.js("window.held = []; studio.link.receive = message => held.push(message); null")
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("b")
    for place in ((0.1, 0.1), (0.3, 0.1), (0.1, 0.4), (0.3, 0.4), (0.5, 0.4), (0.7, 0.4)):
        visit.click(*place)
    visit.js(
        "studio.change({ label: 'x', operations: [{ op: 'set', keys: ['name'], value: 'x' }] })"
    )
    visit.page.keyboard.press("Control+z")
    visit.js("studio.link.receive = (message) => studio.receive(message); null")
    visit.js("held.forEach((message) => studio.receive(message))")
    visit.until("!studio.commands.waiting.length && studio.isAnswered", WAIT)
    assert visit.document["name"] == "a"
    assert visit.js("document.getElementById('notice').textContent") == ""
    positions = [body["position"] for body in visit.document["bodies"].values()]
    assert positions == [[0.2, 0.1], [0.2, 0.4], [0.6, 0.4]]
    visit.page.keyboard.press("Control+y")
    visit.until("studio.file.document.name === 'x'", WAIT)
    revision = visit.revision
    visit.page.keyboard.press("Control+y")  # there is nothing to redo
    visit.until("studio.isAnswered", WAIT)
    assert visit.revision == revision


@pytest.mark.thorough
def test_a_point_that_is_dragged_back_is_shown_at_its_place(desk: tuple[Desk, Studio]) -> None:
    """The drag changes nothing in the text; the page that computed it shows the text again."""
    visit, _ = desk
    visit.show("\n".join(PENDULUMS.splitlines()[:4]) + "\n")
    drag_back(visit, (0.5, 0.1))


@pytest.mark.thorough
def test_a_drag_on_an_outdated_picture_keeps_the_drag_before(desk: tuple[Desk, Studio]) -> None:
    """Both ends of a bar are dragged before the picture of the first drag comes."""
    visit, _ = desk
    visit.show("\n".join(PENDULUMS.splitlines()[:4]) + "\n")
    visit.until("studio.pictures.live", WAIT)
    visit.js("studio.pictures.page.design = null")  # no page computes the first drag
    revision = visit.revision
    for start, end in (((0.1, 0.1), (0.1, 0.3)), ((0.5, 0.1), (0.5, 0.4))):
        visit.drag(start, end)
    visit.until(f"studio.file.revision >= {revision + 2} && studio.isAnswered", WAIT)
    bar = visit.document["bodies"]["a"]
    assert bar["position"] == pytest.approx([0.3, 0.35], abs=1e-6)
    assert bar["length"] == pytest.approx(np.hypot(0.4, 0.1))
    assert bar["angle"] == pytest.approx(np.arctan2(0.1, 0.4))


@pytest.mark.thorough
def test_a_press_in_the_picture_keeps_it_until_it_is_released(desk: tuple[Desk, Studio]) -> None:
    """A picture that comes during a drag replaces the shown one after it."""
    visit, studio = desk
    visit.show(PENDULUMS)
    start, end = visit.place(0.9, 0.1), visit.place(0.8, 0.4)
    mouse = visit.page.mouse
    mouse.move(*start)
    mouse.down()
    mouse.move(*end, steps=3)
    shown = visit.shown
    with page(studio) as other:
        state = receive(other, "text")
        text = state["text"] + "# of another page\n"
        send(other, kind="text", text=text, revision=state["revision"])
    visit.until(f"studio.described.revision > {state['revision']}", WAIT)
    visit.until("studio.pictures.next", WAIT)
    visit.page.wait_for_timeout(400)  # longer than a pause between two keys
    assert visit.shown == shown
    mouse.move(*visit.place(0.8, 0.45))
    mouse.up()
    visit.until(f"studio.file.revision > {state['revision'] + 1}", WAIT)
    visit.settle()
    bar = visit.document["bodies"]["b"]
    tip = np.add(
        bar["position"],
        np.multiply(bar["length"] / 2, [np.cos(bar["angle"]), np.sin(bar["angle"])]),
    )
    assert tip == pytest.approx([0.8, 0.45], abs=0.01)
    assert visit.text.endswith("# of another page\n")


@pytest.mark.thorough
def test_a_press_that_ends_outside_the_picture_is_over(desk: tuple[Desk, Studio]) -> None:
    """Pictures are replaced again, without another movement over the picture."""
    visit, _ = desk
    visit.show(SQUARE)
    visit.js(STRUCTURE_LOOK)
    mouse = visit.page.mouse
    mouse.move(*visit.place(*visit.js("[...studio.structure.plan.nodes.values()][0]")))
    mouse.down()
    assert visit.js("studio.pictures.held")
    visit.js("studio.structure.drag = null")  # as where a press selects one part more
    mouse.move(700, 5, steps=3)
    mouse.up()
    assert not visit.js("studio.pictures.held")
    visit.show(SQUARE + "# more\n")


@pytest.mark.thorough
@pytest.mark.parametrize(
    "before",
    [
        pytest.param({}, id="mechanism", marks=pytest.mark.thorough),
        pytest.param({"structure": True}, id="structure"),
    ],
)
def test_a_structure_is_drawn_by_keys_before_its_first_picture(
    desk: tuple[Desk, Studio], before: dict[str, bool]
) -> None:
    """The picture of the model before is still shown."""
    visit, studio = desk
    reset(studio, **before)
    visit.until(f"studio.structure.possible === {str(bool(before)).lower()}", 60)
    visit.settle()
    visit.js(
        """(() => {
            const { pictures } = studio;
            window.held = [];
            pictures.receive = (message) => held.push(message);
        })()"""
    )
    revision = visit.revision
    reset(studio, structure=True)
    visit.until(f"studio.file.revision > {revision} && studio.structure.possible", 60)
    visit.page.locator("#canvas").focus()
    visit.page.keyboard.press("b")
    for place in ("0, 0", "1, 0"):
        visit.page.keyboard.type(place)
        visit.page.keyboard.press("Enter")
    visit.until("Object.keys(studio.file.document?.elements ?? {}).length === 1", 20)
    visit.js("delete studio.pictures.receive; held.forEach((m) => studio.pictures.receive(m))")
    visit.settle()
    assert visit.document["nodes"] == {"n1": [0.0, 0.0], "n2": [1.0, 0.0]}


HOLD = """(() => {
    const { pictures } = studio;
    window.held = [];
    pictures.receive = (message) => held.push(message);
})()"""
BEFORE = [
    pytest.param({}, id="mechanism"),
    pytest.param({"structure": True}, id="structure", marks=pytest.mark.thorough),
    pytest.param({"dimension": 3}, id="spatial mechanism", marks=pytest.mark.thorough),
    pytest.param({"structure": True, "dimension": 3}, id="spatial", marks=pytest.mark.thorough),
]
RELEASE = "delete studio.pictures.receive; held.forEach((m) => studio.pictures.receive(m))"


@pytest.mark.thorough
@pytest.mark.parametrize("before", BEFORE)
def test_a_spatial_structure_is_drawn_by_keys_before_its_first_picture(
    desk: tuple[Desk, Studio], before: dict[str, bool]
) -> None:
    """The picture of the model before is still shown; a clamp is put on the first node."""
    visit, studio = desk
    reset(studio, **before)
    visit.until("!studio.pending", 60)
    visit.settle()
    visit.js(HOLD)
    revision = visit.revision
    reset(studio, structure=True, dimension=3)
    visit.until(f"studio.file.revision > {revision} && studio.spaceStructure.document", 60)
    shown = (
        "[...document.querySelectorAll('.palette')].filter((p) => p.offsetWidth).map((p) => p.id)"
    )
    assert visit.js(shown) == ["space-structure-palette"]
    visit.page.locator("#canvas").focus()
    visit.page.keyboard.press("e")
    for place in ("0, 0, 0", "0, 0, 2"):
        visit.page.keyboard.type(place)
        visit.page.keyboard.press("Enter")
    visit.until("Object.keys(studio.file.document?.elements ?? {}).length === 1", 20)
    visit.page.keyboard.press("c")
    visit.page.keyboard.type("0, 0, 0")
    visit.page.keyboard.press("Enter")
    visit.until("studio.file.document?.supports?.length === 1", 20)
    visit.js(RELEASE)
    visit.settle()
    assert visit.document["nodes"] == {"n1": [0, 0, 0], "n2": [0, 0, 2]}
    assert visit.document["supports"] == [{"nodes": "n1"}]
    assert visit.js("studio.pictures.page.motion.dimension") == 3


@pytest.mark.parametrize(
    ("before", "after"),
    [
        pytest.param({}, {"dimension": 3}, id="spatial"),
        pytest.param({"dimension": 3}, {}, id="planar", marks=pytest.mark.thorough),
    ],
)
def test_keys_of_a_mechanism_wait_for_its_first_picture(
    desk: tuple[Desk, Studio], before: dict[str, int], after: dict[str, int]
) -> None:
    """A bar of the plane was added to a spatial model, and the other way round."""
    visit, studio = desk
    reset(studio, **before)
    visit.until("!studio.pending", 60)
    visit.settle()
    visit.js(HOLD)
    revision = visit.revision
    reset(studio, **after)
    visit.until(f"studio.file.revision > {revision}", 60)
    empty = visit.text
    visit.page.locator("#canvas").focus()
    visit.page.keyboard.press("b")
    for place in ("0, 0, 0", "0.2, 0.4, 0", "0.3") if after else ("0.1, 0.2", "0.5, 0.2"):
        visit.page.keyboard.type(place)
        visit.page.keyboard.press("Enter")
    assert visit.text == empty
    revision = visit.revision
    visit.js(RELEASE)
    visit.until(f"studio.file.revision > {revision}", 60)
    visit.settle()
    (body,) = visit.document["bodies"].values()
    assert body["position"] == ([0.1, 0.2, 0.15] if after else [0.3, 0.2])
    assert not visit.errors_shown()


@pytest.mark.thorough
def test_a_picture_that_is_outdated_when_it_is_fetched_is_no_error(
    desk: tuple[Desk, Studio],
) -> None:
    """A slow page fetches its picture after others of a fast one have replaced it."""
    visit, _ = desk
    late: list[Any] = []
    is_slow = True
    visit.show(PENDULUMS)
    visit.page.route("**/picture/*", lambda r: late.append(r) if is_slow else r.continue_())
    for name in "abcdef":  # more than the server keeps
        revision = visit.revision
        operation = f"{{ op: 'set', keys: ['name'], value: '{name}' }}"
        visit.js(f"studio.change({{ label: 'name', operations: [{operation}] }})")
        visit.until(f"studio.described?.revision > {revision}", WAIT)
    visit.until(f"studio.pictures.wanted.number >= {visit.js('studio.described.number')}", WAIT)
    is_slow = False
    for route in late:
        route.continue_()
    visit.settle()
    assert visit.document["name"] == "f" and not visit.errors_shown()
