"""Random edits in the studio; ``pytest -m thorough tests/test_studio_walks.py`` makes 1,000.

Text and picture describe the same model after them, and undo returns the original byte for byte.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from structure_desk import LOOK as STRUCTURE_LOOK
from studio_desk import LOOK, opened, reset
from studio_runs import Studio
from studio_walk import FREE, Edit, Walk, walk_randomly, walking
from test_studio_editing import MECHANISM
from test_studio_space import BOXES, HANDLE, LOOK as SPACE_LOOK
from test_studio_structures import SQUARE

PARTS = 100
"""Edits of one case."""


def place_near(walk: Walk, script: str, box: list[tuple[float, float]]) -> tuple[float, ...]:
    """A named place of the picture, or any within a box."""
    names = walk.visit.js(script)
    if names and walk.rng.random() < 0.7:
        return tuple(walk.rng.choice(names))
    return tuple(round(walk.rng.uniform(*ends), 3) for ends in box)


# Planar mechanisms -------------------------------------------------------------------------------

KEYS = ("h", "H", "r", "R", "ArrowUp", "ArrowLeft", "Control+d")
"""Mirrored, rotated, moved and copied."""
TOOLS = "bpatosuiwlgGcfqkdyjJzxCmnN"
"""Keys of all tools but that of beams, whose motion takes long to compute."""
MOST = 10
"""Bodies beyond which some are removed."""
POINTS = """(() => {
    const { motion } = studio.pictures.page, cursor = { i: 0, f: 0 };
    return motion.points.map(({ body, point }) => motion.at(body, point, cursor));
})()"""


def planar(walk: Walk) -> None:
    walk.ready()
    walk.visit.js("studio.drawing.rest()")


def elements(walk: Walk) -> list[str]:
    document = walk.visit.document or {}
    sections = ("bodies", "beams", "joints", "drivers", "forces")
    return [name for section in sections for name in document.get(section, {})]


def draw(walk: Walk) -> None:
    """Draw with any tool, at points and elsewhere."""
    planar(walk)
    key = walk.rng.choice(TOOLS)
    walk.visit.page.keyboard.press(key)
    clicks = walk.visit.js("studio.drawing.tool.clicks")
    for _ in range(clicks or walk.rng.randint(2, 5)):
        walk.click(*place_near(walk, POINTS, [(-0.2, 1.2), (-0.1, 0.7)]))
    if not clicks:
        walk.visit.page.keyboard.press("Enter")
    walk.changed(f"draw {key}")


def transform(walk: Walk) -> None:
    """Move, mirror, rotate or copy bodies."""
    bodies = list((walk.visit.document or {}).get("bodies", {}))
    if bodies and len(bodies) < MOST:
        planar(walk)
        names = bodies if walk.rng.random() < 0.7 else walk.rng.sample(bodies, 1)
        walk.visit.js(f"studio.drawing.select({names})")
        key = walk.rng.choice(KEYS)
        walk.visit.page.keyboard.press(key)
        walk.changed(f"{key} of {names}")


def delete(walk: Walk) -> None:
    """Delete one element, or two."""
    names = elements(walk)
    if names:
        planar(walk)
        chosen = walk.rng.sample(names, min(len(names), walk.rng.randint(1, 2)))
        walk.visit.js(f"studio.drawing.select({chosen})")
        walk.visit.page.keyboard.press("Delete")
        walk.changed(f"delete {chosen}")


def drag(walk: Walk) -> None:
    """Drag a point."""
    planar(walk)
    start = place_near(walk, POINTS, [(-0.2, 1.2), (-0.1, 0.7)])
    end = place_near(walk, "[]", [(-0.2, 1.2), (-0.1, 0.7)])
    if walk.is_free(start) and walk.is_free(end):
        walk.visit.drag(start, end)
        walk.changed(f"drag {start} to {end}")


def rename(walk: Walk) -> None:
    """Give an element another name."""
    names = elements(walk)
    if names:
        planar(walk)
        name = walk.rng.choice(names)
        walk.visit.js(f"studio.drawing.select(['{name}'])")
        walk.visit.page.keyboard.press("F2")
        new = walk.rng.choice([f"{name}x", "new", "é", "l", "a b", "A"])
        walk.visit.page.locator("#ask input").fill(new)
        walk.visit.page.keyboard.press("Enter")
        walk.changed(f"rename {name} to {new}")


def parameter(walk: Walk) -> None:
    """Turn a number of an element into a parameter, or write another one."""
    names = elements(walk)
    if not names:
        return
    planar(walk)
    walk.visit.js(f"studio.drawing.select(['{walk.rng.choice(names)}'])")
    if walk.rng.random() < 0.5:
        buttons = walk.visit.page.locator(".properties:visible .rows .make:enabled")
        if buttons.count():
            buttons.nth(walk.rng.randrange(buttons.count())).click()
    else:
        fields = walk.visit.page.locator(".properties:visible .rows input")
        if fields.count():
            field = fields.nth(walk.rng.randrange(fields.count()))
            value = walk.rng.choice(["0.3", "200 mm", "-0.1", "2*", "1e400", "l", "'"])
            field.fill(value)
            field.press("Enter")
    walk.changed("parameter")


PLANAR: dict[Edit, float] = {
    draw: 4,
    transform: 2,
    delete: 2,
    drag: 1.5,
    rename: 0.7,
    parameter: 1,
    Walk.retype: 1.5,
    Walk.back: 1.5,
}

# Spatial mechanisms ------------------------------------------------------------------------------

SPACE_POINTS = """(() => {
    const { motion } = studio.pictures.page, cursor = { i: 0, f: 0 };
    return motion.points.map(({ body, point }) => [...motion.at(body, point, cursor)]);
})()"""
SPACE_BOX = [(-0.4, 0.5), (-0.3, 0.6), (0.0, 0.3)]


def draw_in_space(walk: Walk) -> None:
    walk.ready()
    key = walk.rng.choice("bcsrnjlkftm")
    if key == "j":
        kinds = "[...document.querySelectorAll('#joint-kind option')].map((o) => o.value)"
        kind = walk.rng.choice(walk.visit.js(kinds))
        walk.visit.js(f"studio.space.palette.kind = '{kind}'")
    walk.visit.page.keyboard.press(key)
    for _ in range(walk.visit.js("studio.space.tool.clicks")):
        if walk.rng.random() < 0.3:
            walk.visit.page.keyboard.type(walk.rng.choice(["0.1,0.2,0.1", "0.15", "-0.1 0 0.2"]))
            walk.visit.page.keyboard.press("Enter")
        walk.click(*place_near(walk, SPACE_POINTS, SPACE_BOX))
    walk.changed(f"draw {key}")


def chosen_in_space(walk: Walk) -> str:
    """Select an element by the tree of the model."""
    walk.ready()
    document = walk.visit.document or {}
    pairs = [(s, n) for s in ("bodies", "joints", "drivers", "forces") for n in document.get(s, {})]
    if not pairs:
        return ""
    section, name = walk.rng.choice(pairs)
    walk.visit.page.evaluate(
        "choice => studio.space.select(choice)", {"section": section, "name": name}
    )
    return name


def delete_in_space(walk: Walk) -> None:
    name = chosen_in_space(walk)
    if name:
        walk.visit.page.keyboard.press("Delete")
        walk.changed(f"delete {name}")


def pull(walk: Walk) -> None:
    """Drag a handle of the gizmo."""
    name = chosen_in_space(walk)
    handles = walk.visit.js("studio.space.handles.map(({ kind, axis }) => [kind, axis])")
    if not handles:
        return
    kind, axis = walk.rng.choice(handles)
    x, y = walk.visit.place(*walk.visit.page.evaluate(HANDLE, [kind, axis, 1]))
    mouse = walk.visit.page.mouse
    if not walk.visit.page.evaluate(FREE, [x, y]):
        return
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + walk.rng.randint(-60, 60), y + walk.rng.randint(-60, 60), steps=3)
    if walk.rng.random() < 0.3:
        walk.visit.page.keyboard.type(walk.rng.choice(["0.1", "-30", "15"]))
        walk.visit.page.keyboard.press("Enter")
    mouse.up()
    walk.changed(f"{kind} {axis} of {name}")


SPATIAL: dict[Edit, float] = {
    draw_in_space: 4,
    delete_in_space: 1.5,
    pull: 2,
    Walk.retype: 1.5,
    Walk.back: 1.5,
}

# Structures --------------------------------------------------------------------------------------

HANDLES = "studio.structure.plan?.handles.map(({ at }) => at)"
CORNERS = """studio.structure.plan?.handles
    .filter(({ kind }) => kind === "vertex").map(({ name }) => name)"""
STRUCTURE_BOX = [(-0.3, 2.0), (-0.2, 1.2)]


def draw_structure(walk: Walk) -> None:
    walk.ready()
    key = walk.rng.choice("bbbeephHorcdffq")
    walk.visit.page.keyboard.press(key)
    clicks = walk.visit.js("studio.structure.tool.clicks")
    for _ in range(clicks or walk.rng.randint(3, 5)):
        walk.click(*place_near(walk, HANDLES, STRUCTURE_BOX))
    if not clicks:
        walk.visit.page.keyboard.press("Enter")
    walk.changed(f"draw {key}")


def change_parts(walk: Walk) -> None:
    """Delete or move what is selected."""
    walk.ready()
    document = walk.visit.document or {}
    pairs = [("points", n) for n in document.get("nodes", {})]
    pairs += [(s, n) for s in ("elements", "meshes") for n in document.get(s, {})]
    if not pairs:
        return
    chosen = walk.rng.sample(pairs, min(len(pairs), walk.rng.randint(1, 3)))
    corners = walk.visit.js(CORNERS)
    if corners and walk.rng.random() < 0.4:
        chosen = [("points", walk.rng.choice(corners))]
    parts = [{"section": section, "name": name} for section, name in chosen]
    walk.visit.page.evaluate("parts => studio.structure.select(parts)", parts)
    key = walk.rng.choice(["Delete", "ArrowUp", "ArrowLeft", "ArrowDown", "ArrowRight"])
    walk.visit.page.keyboard.press(key)
    walk.changed(f"{key} of {chosen}")


def drag_node(walk: Walk) -> None:
    walk.ready()
    start, end = (place_near(walk, at, STRUCTURE_BOX) for at in (HANDLES, "[]"))
    if walk.is_free(start) and walk.is_free(end):
        walk.visit.drag(start, end)
        walk.changed(f"drag {start} to {end}")


STRUCTURE: dict[Edit, float] = {
    draw_structure: 5,
    change_parts: 2,
    drag_node: 1.5,
    Walk.retype: 1.5,
    Walk.back: 1.5,
}

# -------------------------------------------------------------------------------------------------

KINDS: dict[str, tuple[dict[str, Any], str, str, dict[Edit, float]]] = {
    "planar": ({}, MECHANISM, LOOK, PLANAR),
    "spatial": ({"dimension": 3}, BOXES, SPACE_LOOK, SPATIAL),
    "structure": ({"structure": True}, SQUARE, STRUCTURE_LOOK, STRUCTURE),
}
"""Kind of model → request of a new one, its text, where the picture is looked at, and the edits."""
CASES = [(kind, seed, PARTS) for seed in range(1, 9) for kind in KINDS]
"""Kinds, seeds and numbers of edits of the parts."""


@pytest.mark.thorough
@pytest.mark.parametrize(("kind", "seed", "count"), CASES)
def test_a_walk_of_random_edits_is_shown_and_undone(
    kind: str, seed: int, count: int, browser: Any, studio_server: Studio, tmp_path: Path
) -> None:
    request, text, look, edits = KINDS[kind]
    reset(studio_server, **request)
    with opened(browser, studio_server, "0") as visit:
        visit.show(text)
        visit.js(look)
        with walking(visit, studio_server, seed, tmp_path / "edited.toml") as walk:
            walk_randomly(walk, count, edits)
