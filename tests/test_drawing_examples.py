"""The walking leg from a drawing, against circles that are intersected one after the other."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import EXAMPLES, numbers

import dalembert as da


def meet(p: complex, r: float, q: complex, s: float, side: int) -> complex:
    """Intersection of two circles to the left (1) or right (-1) of the way from p to q."""
    distance = abs(q - p)
    along = (r * r - s * s + distance**2) / (2 * distance)
    return p + (along + 1j * side * math.sqrt(r * r - along**2)) * (q - p) / distance


def foot(angle: float) -> complex:
    """Foot of the leg [mm] with the published lengths; the crank turns about the origin."""
    fixed, crank = complex(-38, -7.8), 15 * np.exp(1j * angle)
    top = meet(crank, 50, fixed, 41.5, -1)
    knee = meet(crank, 61.9, fixed, 39.3, 1)
    hip = meet(fixed, 40.1, top, 55.8, 1)
    back = meet(hip, 39.4, knee, 36.7, -1)
    return meet(knee, 49, back, 65.7, 1)


def test_leg_walks_as_its_lengths_say(pictures: Path) -> None:
    printed = numbers("jansen_leg", pictures)
    path = np.array([foot(angle) for angle in np.linspace(0, 2 * np.pi, 721)])
    stance = path.imag < path.imag.min() + 1.5
    # the drawing has lengths with four decimals
    assert printed["step"] == pytest.approx(np.ptp(path.real[stance]), abs=0.05)
    assert printed["height"] == pytest.approx(np.ptp(path.imag), abs=1e-3)
    assert printed["share"] == pytest.approx(np.mean(stance), abs=0.01)


def test_foot_of_the_drawn_leg() -> None:
    imported = da.import_model(EXAMPLES / "jansen_leg.svg")
    assert imported.omissions == []
    model = imported.build()
    assert model.diagnosis.degrees_of_freedom == 1
    motion = da.solve_kinematics(model, 2.0, outputs=41)  # 30 rpm: one turn
    start = motion["crank.start.position"].values[0] * 1e3
    drawn = motion["shank.foot.position"].values * 1e3 - start
    wanted = np.array([foot(angle) for angle in np.linspace(0, 2 * np.pi, 41)])
    np.testing.assert_allclose(drawn, np.c_[wanted.real, wanted.imag], atol=2e-3)


@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "jansen_leg"])
def test_exported_positions_are_drawings_of_the_mechanism(tmp_path: Path, name: str) -> None:
    pytest.importorskip("ezdxf")
    drawing = EXAMPLES / f"{name}.svg"
    if drawing.exists():
        model = da.import_model(drawing).build()
    else:
        model = da.load_model(EXAMPLES / f"{name}.toml").build()
    (path,) = da.export(model, tmp_path / "position.dxf").files
    again = da.import_model(path).build()
    assert again.diagnosis.degrees_of_freedom == model.diagnosis.degrees_of_freedom
    ends = (("start.x", "start.y"), ("end.x", "end.y"))

    def lengths(mechanism: da.Model) -> dict[str, float]:
        motion = da.solve_dynamics(mechanism, 1e-9, step=1e-9)
        bars = [body.name for body in mechanism.bodies if type(body).__name__ == "Bar"]
        return {
            bar: math.dist(*([motion[f"{bar}.{c}"][0].item() for c in end] for end in ends))
            for bar in bars
        }

    drawn, original = lengths(again), lengths(model)
    for bar in drawn.keys() & original.keys():
        assert drawn[bar] == pytest.approx(original[bar], abs=1e-6)
    assert drawn.keys() & original.keys() >= {"crank"}
