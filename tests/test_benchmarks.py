"""The command of the benchmarks: everyone reaches the error, the table goes where it belongs."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import __main__ as command
from benchmarks.cases import falling_bodies
from benchmarks.cases.base import Effort
from benchmarks.falling_bodies import FallingBodies
from benchmarks.mechanisms import slider_crank
from benchmarks.picture import speed_chart
from benchmarks.sample import Row, Sample
from benchmarks.solvers import ours
from benchmarks.table import BEGIN, END, markdown, update


def test_a_quick_run_makes_a_table_and_a_picture(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("DALEMBERT_CACHE", str(tmp_path))  # the command sets it for its process
    inputs = ["pendulum", "--quick", "--rounds", "1", "--output", str(tmp_path)]
    assert command.main(inputs) == 0
    table = (tmp_path / "table.md").read_text(encoding="utf-8")
    assert "| pendulum | time to an error of 1e-04 m |" in table
    assert "only" not in table  # everyone has reached the error
    assert (tmp_path / "pendulum.svg").stat().st_size > 1000
    assert table.strip() in capsys.readouterr().out


def test_the_neutral_slider_crank_is_the_published_one():
    mechanism, reference = slider_crank()
    assert ours.runner(mechanism, 1.0, "vm")(400)[1] == pytest.approx(reference, abs=1e-6)


def test_falling_bodies_penetrate_only_peers(monkeypatch):
    """Three spheres reach the floor; compliant contacts penetrate more than rigid ones."""
    monkeypatch.setattr(falling_bodies, "COUNTS", (3,))
    monkeypatch.setattr(falling_bodies, "QUICK", 60)
    rows = list(falling_bodies.measure("sphere", Effort(rounds=1, quick=True, limit=0.2)))
    assert {"dalembert", "dalembert, MoreauJean"} <= set(rows[0].samples)
    for name, sample in rows[0].samples.items():
        deepest = float(sample.note.split()[1])
        assert (deepest < 1e-9) == name.startswith("dalembert")
    bodies = FallingBodies.of("disc", 3)
    places = np.array([(0.0, 0.5), (0.0, 0.69), (0.0, 0.095)])
    assert bodies.penetration(places) == pytest.approx(0.01)


def test_unknown_cases_are_refused(capsys):
    with pytest.raises(SystemExit):
        command.main(["pendulums"])
    assert "no case pendulums" in capsys.readouterr().err


def test_the_table_tells_losses_and_stands_between_its_markers(tmp_path):
    row = Row("race", "one step")
    row.samples["Peer"] = Sample(1e-6, 0.9e-6, 1.1e-6, "s")
    row.samples["dalembert"] = Sample(4e-6, 4e-6, 4e-6, "s", "20 steps")
    table = markdown([row], ["a machine"])
    assert "| race | one step | 4 µs (20 steps) | 1 µs ± 10 % | 0.25 |" in table
    page = tmp_path / "benchmarks.md"
    page.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n", encoding="utf-8")
    update(page, table)
    text = page.read_text(encoding="utf-8")
    assert table in text and "old" not in text
    assert text.startswith("before") and text.endswith("after\n")
    page.write_text("nothing", encoding="utf-8")
    with pytest.raises(SystemExit, match="has no lines"):
        update(page, table)


def test_cases_with_the_same_solvers_share_a_table(tmp_path):
    def row(case, **seconds):
        return Row(case, "one step", {n: Sample(s, s, s, "s") for n, s in seconds.items()})

    rows = [
        row("a", dalembert=1.0, Peer=1500.0),
        row("b", dalembert=2.0, Peer=1.0),
        row("c", dalembert=1.0),
    ]
    table = markdown(rows, [])
    assert table.count("| case | quantity | dalembert |") == 2
    assert "| 1,500 |" in table and "| 0.5 |" in table and table.endswith("| c | one step | 1 s |")
    speed_chart([row("four-bar", dalembert=1.0, Peer=14.0)], tmp_path / "speed.svg")
    assert "14 (Peer)" in (tmp_path / "speed.svg").read_text(encoding="utf-8")


def test_every_case_is_named_once():
    from benchmarks.cases.all import CASES

    assert len({case.name for case in CASES}) == len(CASES)
    assert Effort().backends == ("vm",)
