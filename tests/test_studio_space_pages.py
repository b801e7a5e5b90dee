"""Pictures of spatial models: their contexts of WebGL are freed, and photos are refused."""

from __future__ import annotations

import pytest
from test_studio_space import BOXES, SpaceDesk, desk

__all__ = ["desk"]

COUNT = """(() => {
    const { getContext } = HTMLCanvasElement.prototype, { top } = window;
    top.contexts ??= [];
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
        const context = getContext.call(this, kind, ...more);
        if (kind === "webgl2" && !top.contexts.includes(context)) top.contexts.push(context);
        return context;
    };
})()"""
"""Keep each context of a page that is loaded from now on."""
DROP = """(() => {
    const inner = studio.pictures.frame.contentWindow, data = new DataTransfer();
    data.items.add(new File(["x"], "x.png", { type: "image/png" }));
    const options = { dataTransfer: data, cancelable: true, bubbles: true };
    const event = new inner.DragEvent("drop", options);
    if (studio.pictures.page.scene.canvas.dispatchEvent(event)) throw new Error("not handled");
})()"""
"""Drop an image on the picture, which the browser would open in its place."""


@pytest.mark.thorough
def test_the_contexts_of_replaced_pictures_are_freed(desk: SpaceDesk) -> None:
    """Each at once: of more than about sixteen, browsers lose the oldest one for a new one."""
    desk.show(BOXES)
    desk.page.add_init_script(COUNT)
    for k in range(8):
        desk.show(BOXES.replace("500.0", f"{501 + k}.0"))
    made, alive = desk.js("[contexts.length, contexts.filter((c) => !c.isContextLost()).length]")
    assert made >= 7
    assert alive <= 2
    assert not desk.js("contexts.at(-1).isContextLost()")


@pytest.mark.thorough
def test_a_spatial_model_refuses_photos_and_says_why(desk: SpaceDesk) -> None:
    desk.show(BOXES)
    photo = desk.page.locator("#actions >> text=Photo…")
    assert photo.is_disabled()
    assert "planar" in str(photo.get_attribute("title"))
    desk.js(DROP)
    desk.until("document.body.textContent.includes('this model is spatial')", 10)
    desk.page.click("text=Open…")
    desk.page.get_by_text("New model", exact=True).click()
    desk.until("studio.pictures.page && 's' in studio.pictures.page.scene.view", 20)
    assert photo.is_enabled()
