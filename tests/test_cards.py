"""What notebooks show of systems, models, diagnoses and results by themselves."""

from __future__ import annotations

import html.parser
from typing import Any

import pytest
from test_structure_pictures import cantilever

import dalembert as da
from dalembert import planar
from dalembert.report.page import InlinePage

HOSTILE = "<img src=x onerror=alert(1)>"


class Tags(html.parser.HTMLParser):
    """The tags of a text, in order."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)


def pendulum() -> da.System:
    system = da.System(HOSTILE, gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, None), description=HOSTILE)
    bar = system.add(planar.Bar("bar", length=length, mass=1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return system


@pytest.fixture(scope="module")
def things() -> dict[str, Any]:
    system = pendulum()
    model = system.build()
    motion = da.solve_dynamics(model, 0.05, step=0.01)
    structure = cantilever().build()
    return {
        "system": system,
        "model": model,
        "diagnosis": model.diagnosis,
        "motion": motion,
        "structure": structure,
        "statics": da.solve_statics(structure),
        "gradient": da.sensitivity(motion, da.final("bar.angle")),
    }


NAMES = ("system", "model", "diagnosis", "motion", "structure", "statics", "gradient")


@pytest.mark.parametrize("name", NAMES)
def test_things_show_themselves(things: dict[str, Any], name: str) -> None:
    text = things[name]._repr_html_()
    assert len(text) > 100
    assert "img" not in Tags(text).tags


def test_cards_show_the_main_results(things: dict[str, Any]) -> None:
    assert "1 degree of freedom" in things["model"]._repr_html_()
    assert "0.5 … " in things["system"]._repr_html_()
    assert "completed" in things["motion"]._repr_html_()


def test_show_is_the_report(things: dict[str, Any]) -> None:
    shown = things["motion"].show(height=300, plots=[["bar.angle"]])
    assert isinstance(shown, InlinePage) and shown.payload["default_plots"] == [["bar.angle"]]
    assert Tags(shown._repr_html_()).tags == ["iframe"]
    assert "structure" in things["statics"].show().payload["kind"]


def test_films_are_short_unless_asked(things: dict[str, Any]) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    system = pendulum()
    motion = da.solve_dynamics(system.build(), 60.0, step=0.05)
    assert motion.animate()._save_count <= 100
    assert motion.animate(speed=10.0)._save_count == 120
