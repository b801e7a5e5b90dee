"""Random edits of a model in the studio, with the history of its text that they should leave.

A walk draws, deletes, moves, mirrors, copies, renames, types, undoes and repeats as a user does,
with the mouse and the keyboard. A second page reports every text of the server. After each edit the
editor, the document of the drawing and the server have the same text, undo and redo return former
texts byte for byte, and the picture shows the model of the text, or its errors.
"""

from __future__ import annotations

import json
import random
import re
import time
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from studio_desk import WAIT, Desk
from studio_runs import Studio
from websockets.sync.client import ClientConnection, connect

import dalembert as da
from dalembert.errors import DalembertError
from dalembert.io import load_model_file
from dalembert.studio.loose_nodes import parts_of
from dalembert.studio.pictures import result_of

BARRIER = """() => new Promise(async (done) => {
    studio.editor.flush();
    while (studio.commands.waiting.length) await new Promise((go) => setTimeout(go, 10));
    const { socket } = studio.link, mark = "unknown request";
    socket.addEventListener("message", function answered({ data }) {
        const { kind, text } = JSON.parse(data);
        if (kind !== "failure" || !text.startsWith(mark)) return;
        socket.removeEventListener("message", answered);
        done();
    });
    socket.send(JSON.stringify({ kind: "barrier" }));
})"""
"""Everything that was done before is sent and answered."""
CLOSE = """() => {
    for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close();
    document.activeElement?.blur();
}"""
FREE = """([x, y]) => document.elementFromPoint(x, y) === studio.pictures.frame"""
"""Whether nothing covers the picture at a place of the screen."""
POSES = """() => {
    const { motion, player } = studio.pictures.page, { bodies } = motion;
    const named = bodies.filter(({ name }) => name in (studio.file.document.bodies ?? {}));
    player.pause();
    player.seek(motion.start);
    return Object.fromEntries(named.map((body) => [body.name, motion.pose(body)]));
}"""
"""Poses of the picture at the start."""
NODES = """() => {
    const { mesh } = studio.pictures.page.motion;
    const parts = (k) => mesh.components(k).filter(Boolean);
    return mesh && Object.fromEntries(mesh.nodes.map((name, k) => [name, parts(k)]));
}"""
"""Components of the displacements of all nodes, where there are some."""
PAUSE = 1.1
"""Time that separates typed changes, which are undone together otherwise [s]."""
NUMBER = re.compile(r"(?<![\w.\"])-?\d+\.\d+(?![\w.\"])")
CHECKED = 0.3
"""Share of the edits whose picture is awaited and compared; the text is compared after all."""
LOOSE = "not in the picture; connect or remove it"


@dataclass
class Walk:
    """A page, the texts of the server, and the history that they should have.

    Attributes
    ----------
    visit : the page
    observer : a second page, which is sent all texts
    rng : that selects the edits
    path : of a file for the text
    text : of the server
    undo, redo : texts that these return
    edits : number of edits that changed the text
    older : whether there are changes before the walk
    typed_at : time of the last typed change
    """

    visit: Desk
    observer: ClientConnection
    rng: random.Random
    path: Path
    text: str
    undo: list[str] = field(default_factory=list)
    redo: list[str] = field(default_factory=list)
    edits: int = 0
    older: bool = False
    typed_at: float = field(default_factory=time.monotonic)

    # The server ----------------------------------------------------------------------------------

    def texts(self) -> list[str]:
        """Texts of the server since the last call."""
        self.visit.page.evaluate(BARRIER)
        self.observer.send(json.dumps({"kind": "barrier"}))
        texts = []
        while True:
            message = json.loads(self.observer.recv(timeout=WAIT))
            if message["kind"] == "text":
                texts.append(message["text"])
            elif message["kind"] == "failure" and message["text"].startswith("unknown request"):
                return texts

    def changed(self, label: str) -> None:
        """Add the texts of an edit to the history."""
        for text in self.texts():
            if text != self.text:
                self.undo.append(self.text)
                self.redo.clear()
                self.text = text
                self.edits += 1
        self.agree(label)

    def moved(self, source: list[str], target: list[str], key: str, label: str) -> None:
        """Undo or repeat the last change."""
        self.visit.page.keyboard.press(key)
        expected = source.pop()
        target.append(self.text)
        (self.text,) = self.texts()
        self.edits += 1
        assert self.text == expected, label
        self.agree(label)

    def agree(self, label: str) -> None:
        """Editor, document and buttons are those of the text of the server."""
        visit = self.visit
        assert visit.text == self.text, label
        try:
            data = json.loads(json.dumps(tomllib.loads(self.text)))
        except (tomllib.TOMLDecodeError, TypeError):
            data = None
        assert visit.document == data, label
        file = visit.js("(({ undo, redo }) => [Boolean(undo), Boolean(redo)])(studio.file)")
        assert file == [bool(self.undo) or self.older, bool(self.redo)], label

    # Edits of all models -------------------------------------------------------------------------

    def ready(self) -> None:
        """Leave fields, dialogs and tools."""
        self.visit.page.evaluate(CLOSE)
        for _ in range(2):
            self.visit.page.keyboard.press("Escape")

    def type(self, start: int, end: int, new: str, label: str) -> None:
        """Type into the text."""
        time.sleep(max(0.0, self.typed_at + PAUSE - time.monotonic()))
        self.visit.page.evaluate(
            "([from, to, text]) => studio.editor.replace(from, to, text)", [start, end, new]
        )
        self.changed(label)
        self.typed_at = time.monotonic()

    def retype(self) -> None:
        """Another number, a comment, or nonsense that is removed at once."""
        choice = self.rng.random()
        numbers = [m for m in NUMBER.finditer(self.text) if "law" not in line_of(self.text, m)]
        if choice < 0.6 and numbers:
            match = self.rng.choice(numbers)
            value = float(match[0]) * self.rng.choice([0.9, 1.1]) + 0.01
            self.type(match.start(), match.end(), f"{value:.4f}", f"number {match[0]}")
        elif choice < 0.8:
            lines = [m.end() for m in re.finditer("\n", self.text)]
            at = self.rng.choice(lines)
            self.type(at, at, self.rng.choice(["# é\u202e<b>\n", "\n", "#\t'\"\n"]), "comment")
        else:
            at, text = self.rng.randrange(len(self.text)), self.text
            self.type(at, at, self.rng.choice(["[", '"', "= =", "\n]x", "é"]), f"nonsense at {at}")
            end = at + len(self.text) - len(text)
            self.type(at, end, "", "without nonsense")
            assert self.text == text

    def back(self) -> None:
        """Some steps back, and some of them forth."""
        self.ready()
        for k in range(min(self.rng.randint(1, 4), len(self.undo))):
            self.moved(self.undo, self.redo, "Control+z", f"undo {k}")
        for k in range(min(self.rng.randint(0, 4), len(self.redo))):
            self.moved(self.redo, self.undo, "Control+y", f"redo {k}")

    def clear(self) -> None:
        """Undo until the model can be built."""
        self.ready()
        for k in range(len(self.undo)):
            self.moved(self.undo, self.redo, "Control+z", f"back to a model {k}")
            self.settle()
            if not self.visit.errors_shown():
                return

    # The picture ---------------------------------------------------------------------------------

    def settle(self) -> None:
        """Wait for the picture of the text."""
        visit, revision = self.visit, self.visit.revision
        visit.until(f"studio.described?.revision >= {revision}", WAIT)
        shown = "studio.pictures.shown === studio.described.number"
        visit.until(f"!studio.described.page || {shown}", WAIT)

    def check(self, label: str) -> bool:
        """The picture shows the model of the text; returns whether it has no errors."""
        self.settle()
        errors = self.visit.errors_shown()
        assert not any("internal error" in error for error in errors), (label, errors)
        self.path.write_text(self.text, encoding="utf-8")
        if errors:
            if not all(LOOSE in error for error in errors):
                assert not builds(self.path), (label, errors, self.text)
            return False
        if not has_parts(self.path):
            assert self.visit.js("studio.pictures.page.motion.bodies.length") <= 1, label
            return True
        model = load_model_file(self.path).model()
        if self.visit.js("Boolean(studio.pictures.page.motion.mesh)"):
            same_nodes(self.visit.page.evaluate(NODES), model, label)
        elif model.diagnosis.degrees_of_freedom is not None:
            same_poses(self.visit.page.evaluate(POSES), model, label)
        return True

    def take_all_back(self, original: str) -> None:
        """Undo everything."""
        self.ready()
        while self.undo:
            self.moved(self.undo, self.redo, "Control+z", "to the original")
        assert self.text == original

    # Places --------------------------------------------------------------------------------------

    def is_free(self, place: tuple[float, ...]) -> bool:
        """Whether a place is on the screen, and nothing covers it."""
        x, y = self.visit.place(*place)
        return bool(np.isfinite([x, y]).all() and self.visit.page.evaluate(FREE, [x, y]))

    def click(self, *place: float) -> None:
        if self.is_free(place):
            self.visit.click(*place)


def builds(path: Path) -> bool:
    """Whether the model of a file can be built and its analysis be carried out."""
    try:
        file = load_model_file(path)
        return bool(result_of(file, file.model()).status.success)
    except DalembertError:
        return False


def has_parts(path: Path) -> bool:
    """Whether the text of a file describes more than an empty drawing."""
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    return any(data.get(section) for section in parts_of(data))


def line_of(text: str, match: re.Match[str]) -> str:
    """Line of a match."""
    start, end = text.rfind("\n", 0, match.start()) + 1, text.find("\n", match.end())
    return text[start : end if end >= 0 else len(text)]


def same_poses(shown: dict[str, dict[str, Any]], model: Any, label: str) -> None:
    """Poses of a picture are those of the assembled model."""
    start = da.solve_assembly(model)
    for name, pose in shown.items():
        exact = start.pose(name)
        place = pose.get("p", pose)
        for axis in "xyz":
            if axis in exact:
                assert np.isclose(place[axis], exact[axis], atol=3e-6), (label, name, pose, exact)


def same_nodes(shown: dict[str, list[dict[str, Any]]], model: Any, label: str) -> None:
    """Displacements of a picture are those of the solved structure."""
    result = da.solve_statics(model)
    exact = {
        (name, part["name"]): (part["value"], float(result[f"{name}.{part['name']}"]))
        for name, parts in shown.items()
        for part in parts
        if part["name"] in ("ux", "uy")
    }
    size = max((abs(value) for _, value in exact.values()), default=0.0)
    for key, (value, wanted) in exact.items():
        assert abs(value - wanted) <= 1e-5 * size + 1e-15, (label, key, value, wanted)


@contextmanager
def walking(visit: Desk, studio: Studio, seed: int, path: Path) -> Iterator[Walk]:
    """A walk from the present text of a page."""
    address = studio.address.replace("http:", "ws:") + "socket"
    origin: Any = f"http://{studio.host}"
    with connect(address, origin=origin, max_size=None, close_timeout=1) as observer:
        walk = Walk(visit, observer, random.Random(seed), path, visit.text)
        walk.texts()
        walk.older = visit.js("Boolean(studio.file.undo)")
        yield walk


Edit = Callable[[Walk], None]


def walk_randomly(walk: Walk, count: int, edits: dict[Edit, float]) -> None:
    """Make a number of edits, and take all of them back.

    Parameters
    ----------
    count : of changes of the text
    edits : edit → its share
    """
    original, failed, calls = walk.text, 0, 0
    while walk.edits < count:
        calls += 1
        assert calls < 20 * count + 50, "the edits change nothing"
        (edit,) = walk.rng.choices(list(edits), list(edits.values()))
        edit(walk)
        print(walk.edits, edit.__name__)
        if walk.rng.random() < CHECKED:
            failed = 0 if walk.check(edit.__name__) else failed + 1
        if failed > 2:
            walk.clear()
            failed = 0
    walk.take_all_back(original)
    walk.check("the original")


def drag_back(visit: Desk, at: tuple[float, float]) -> None:
    """Drag from a place of the picture and back: a page that computes shows the drag, and then the
    text again, in which nothing has changed."""
    visit.until("studio.pictures.live", WAIT)
    values = "[...studio.pictures.page.design.values]"
    before, revision, mouse = visit.js(values), visit.revision, visit.page.mouse
    x, y = visit.place(*at)
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 40, y - 40, steps=3)
    assert visit.js(values) != before
    mouse.move(x, y)
    mouse.up()
    visit.page.evaluate(BARRIER)
    assert visit.revision == revision and visit.js(values) == before
