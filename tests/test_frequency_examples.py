"""Vibration absorber against the closed forms, from Python and from the file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from example_runs import EXAMPLES, numbers, script

from dalembert.cli.app import main


@pytest.mark.thorough
def test_equal_peaks_and_white_noise(pictures: Path) -> None:
    printed = numbers("den_hartog_absorber", pictures)
    for name in ("height", "frequency", "damping"):
        assert printed[name] == pytest.approx(printed[f"exact {name}"], rel=1e-9)
    frequency, damping = script("den_hartog_absorber").least_noise(0.05)
    assert printed["quiet frequency"] == pytest.approx(frequency, rel=1e-8)
    assert printed["quiet damping"] == pytest.approx(damping, rel=1e-7)
    assert printed["rules"] == pytest.approx((1 + 2 / 0.05) ** 0.5, rel=1e-3)  # Den Hartog


def test_the_file_runs_and_optimises(tmp_path: Path, capsys) -> None:
    path = str(EXAMPLES / "den_hartog_absorber.toml")
    assert main(["run", path, "--output", str(tmp_path), "--csv", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    (row,) = summary["states"]
    assert row["output"] == "gain" and row["highest peak"] == pytest.approx(6.4, abs=0.3)
    assert main(["optimize", path, "--output", str(tmp_path), "--json", "--quiet"]) == 0
    best = json.loads(capsys.readouterr().out)
    exact = script("den_hartog_absorber").equal_peaks(0.05)[2]
    assert best["x"]["bound"] == pytest.approx(exact, rel=1e-6)
