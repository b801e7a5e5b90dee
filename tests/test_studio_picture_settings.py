"""What is chosen in a picture of the studio stays chosen; another file is shown as it comes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from studio_desk import Desk, opened, reset
from studio_runs import Studio
from test_studio_space import BOXES

EXAMPLES = Path(__file__).parents[1] / "examples"
ROOT = "studio.pictures.frame.contentDocument"
CUT = """(() => {
    const { materials, view } = studio.pictures.page.scene.painter;
    return [materials.cut.normal.toArray(), materials.cut.constant];
})()"""


def shown(desk: Desk, identifier: str) -> Any:
    """State of a control of the picture."""
    return desk.js(
        f"""(() => {{
            const node = {ROOT}.getElementById("{identifier}");
            const [option] = node.selectedOptions ?? [];
            return node.getAttribute("aria-pressed") ?? option?.text ?? node.value;
        }})()"""
    )


def press(desk: Desk, identifier: str) -> None:
    desk.js(f'{ROOT}.getElementById("{identifier}").click()')


def set_value(desk: Desk, identifier: str, value: str) -> None:
    """Choose an option by its text, or move a slider."""
    desk.page.evaluate(
        f"""([id, value]) => {{
            const node = {ROOT}.getElementById(id);
            node.value = [...node.options ?? []].find((o) => o.text === value)?.value ?? value;
            for (const type of ["input", "change"]) node.dispatchEvent(new Event(type));
        }}""",
        [identifier, value],
    )


def test_parts_and_speed_of_a_mechanism(browser: Any, studio_server: Studio) -> None:
    reset(studio_server, path=str(EXAMPLES / "four_bar.toml"))
    with opened(browser, studio_server) as desk:
        for identifier in ("labels", "grid", "reactions"):
            press(desk, identifier)
        set_value(desk, "speed", "0.2×")
        desk.show(desk.text + "# a comment\n")
        assert [shown(desk, key) for key in ("labels", "grid", "reactions")] == [
            "false",
            "false",
            "true",
        ]
        assert desk.js("studio.pictures.page.scene.show.labels") is False
        assert shown(desk, "speed") == "0.2×"
        press(desk, "labels")  # as at first
        desk.show(desk.text + "# another one\n")
        assert shown(desk, "labels") == "true"
        assert shown(desk, "grid") == "false"
        reset(studio_server, path=str(EXAMPLES / "slider_crank.toml"))
        desk.until("studio.file.name.includes('slider_crank')", 20)
        desk.settle()
        assert shown(desk, "grid") == "true"


@pytest.mark.thorough
@pytest.mark.parametrize("scale", ["0.5", "1 : 1"])
def test_colours_and_scale_of_a_structure(scale: str, browser: Any, studio_server: Studio) -> None:
    reset(studio_server, path=str(EXAMPLES / "truss.toml"))
    with opened(browser, studio_server, "0") as desk:
        set_value(desk, "field", "none")
        if scale == "1 : 1":
            press(desk, "true-scale")
        else:
            set_value(desk, "scale", scale)
        desk.show(desk.text + "# a comment\n")
        assert shown(desk, "field") == "none"
        assert desk.js("studio.pictures.page.motion.mesh.field") is None
        mesh = "studio.pictures.page.motion.mesh"
        value = desk.js(f"{mesh}.{'scale' if scale == '1 : 1' else 'factor'}")
        assert value == pytest.approx(1.0 if scale == "1 : 1" else 0.5)


@pytest.mark.thorough
def test_section_of_a_spatial_model(browser: Any, studio_server: Studio) -> None:
    """The plane stays where it is in space, also where the extent of the model changes."""
    reset(studio_server, dimension=3)
    with opened(browser, studio_server, "0") as desk:
        desk.show(BOXES)
        press(desk, "section")
        set_value(desk, "section-axis", "y")
        set_value(desk, "section-place", "0.4")
        press(desk, "clear")
        normal, constant = desk.js(CUT)
        desk.show(desk.text.replace("[-0.2, 0.0, 0.1]", "[-0.3, 0.7, 0.1]"))
        assert shown(desk, "section") == shown(desk, "clear") == "true"
        after, value = desk.js(CUT)
        assert after == normal
        radius = desk.js("studio.pictures.page.scene.view.radius")
        assert value == pytest.approx(constant, abs=0.005 * radius)  # of the slider's step
