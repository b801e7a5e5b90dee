"""Changes while the page has no connection: made once it has one, or given up by a message."""

from __future__ import annotations

import pytest
from studio_desk import WAIT, Desk
from studio_runs import Studio
from test_studio_server import page, receive, send

CUT = """(() => {
    window.tried = false;
    studio.link.connect = () => { window.tried = true; };
    studio.link.socket.close();
})()"""
"""The connection ends, and the attempt to make another one fails."""
AGAIN = "(() => { delete studio.link.connect; studio.link.connect(); })()"
DEAF = "(() => { studio.link.socket.send = () => {}; })()"
"""What the page sends does not arrive."""
EMPTY = 'format = 1\nname = "a"\n'
NAMED = (
    "studio.change({{ label: 'name', operations: [{{ op: 'set', keys: ['name'], value: '{}' }}] }})"
)


def cut(visit: Desk) -> None:
    visit.js(CUT)
    visit.until("!studio.joined", WAIT)


def joined(visit: Desk) -> None:
    visit.until("window.tried", WAIT)
    visit.js(AGAIN)
    visit.until("studio.isAnswered && !studio.commands.waiting.length", WAIT)


def test_what_is_drawn_without_a_connection_comes_after_it(desk: tuple[Desk, Studio]) -> None:
    """A bar, another change, an undo and a save, in this order."""
    visit, studio = desk
    path = studio.folder / "offline.toml"
    visit.show(EMPTY)
    visit.js(f"studio.request('save', {{ path: {str(path)!r}, replace: true }})")
    visit.until("studio.file.path && !studio.file.changed", WAIT)
    cut(visit)
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press("b")
    for place in ((0.1, 0.1), (0.3, 0.1)):
        visit.click(*place)
    link = visit.js("document.getElementById('link').textContent")
    assert "changes are sent when the program answers" in link
    visit.js(NAMED.format("b"))
    notice = visit.js("document.getElementById('notice').textContent")
    assert "carried out when the program answers" in notice
    visit.js(NAMED.format("c"))
    visit.page.keyboard.press("Control+z")
    visit.page.keyboard.press("Control+s")
    assert visit.text == EMPTY
    joined(visit)
    visit.until("!studio.file.changed", WAIT)
    visit.settle()
    assert visit.document["name"] == "b" and list(visit.document["bodies"]) == ["bar1"]
    assert path.read_text() == visit.text
    visit.press("Control+z")
    visit.press("Control+z")
    assert visit.text == EMPTY


@pytest.mark.thorough
def test_a_change_that_did_not_arrive_is_sent_again_and_none_twice(
    desk: tuple[Desk, Studio],
) -> None:
    visit, _ = desk
    visit.show(EMPTY)
    visit.js(DEAF)
    visit.js(NAMED.format("lost"))
    cut(visit)
    joined(visit)
    assert visit.document["name"] == "lost"
    visit.js("studio.link.receive = () => {}; null")  # the answer does not arrive
    append = "{ op: 'add', section: 'bodies', base: 'p', fields: { type: 'Particle', mass: 1 } }"
    visit.js(f"studio.change({{ label: 'add', operations: [{append}] }})")
    visit.js("new Promise((done) => setTimeout(done, 300))")
    visit.js(CUT)
    visit.until("!studio.joined", WAIT)
    visit.js("studio.link.receive = (message) => studio.receive(message); null")
    joined(visit)
    assert len(visit.document["bodies"]) == 1


@pytest.mark.thorough
def test_a_change_to_what_another_page_has_changed_is_given_up(desk: tuple[Desk, Studio]) -> None:
    visit, studio = desk
    visit.show(EMPTY)
    cut(visit)
    visit.js(NAMED.format("mine"))
    with page(studio) as other:
        state = receive(other, "text")
        send(other, kind="text", text=EMPTY + "# other\n", revision=state["revision"])
        receive(other, "text", revision=state["revision"] + 1)
    joined(visit)
    assert visit.text == EMPTY + "# other\n"
    assert "what was drawn without a connection" in visit.js(
        "document.getElementById('notice').textContent"
    )


@pytest.mark.thorough
def test_a_page_of_a_program_that_was_started_again_says_so(desk: tuple[Desk, Studio]) -> None:
    """Its address has another token; the page ends its attempts to connect."""
    visit, _ = desk
    visit.js("history.replaceState(null, '', '/former-token/'); studio.link.socket.close(); null")
    visit.until("studio.link.outdated", WAIT)
    link = visit.js("document.getElementById('link').textContent")
    assert link.startswith("the program was started again: open the address that it printed")
    attempts = visit.js("studio.link.attempts")
    visit.js("new Promise((done) => setTimeout(done, 1500))")
    assert visit.js("studio.link.attempts") == attempts
    for expected in (visit.requests, visit.console):
        assert expected and all("former-token" in text or "403" in text for text in expected)
        expected.clear()
