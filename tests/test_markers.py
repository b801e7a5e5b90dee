"""Markers of motion capture: C3D files written by ezc3d, read, and inverted to drives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert.design.identification.data_table import read_table

ezc3d = pytest.importorskip("ezc3d")
RATE = 60.0


def written(path: Path, markers: dict[str, np.ndarray], unit: str = "mm") -> Path:
    """A C3D file of (3, frames) places [m]; not a number where a marker is hidden."""
    file = ezc3d.c3d()
    file.add_parameter("POINT", "UNITS", [unit])
    file["parameters"]["POINT"]["RATE"]["value"] = [RATE]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(markers)
    places = np.stack(list(markers.values()), axis=1) * {"mm": 1e3, "m": 1.0, "ft": 3.3}[unit]
    file["data"]["points"] = np.concatenate([places, np.ones((1, *places.shape[1:]))])
    file.write(str(path))
    return path


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_markers_come_back(unit, tmp_path):
    rng = np.random.default_rng(0)
    knee, heel = rng.normal(size=(2, 3, 7))
    heel[:, 2] = np.nan
    table = read_table(written(tmp_path / "walk.c3d", {"KNEE": knee, "HEEL": heel}, unit))
    np.testing.assert_allclose(table["time"], np.arange(7) / RATE)
    for marker, places in (("KNEE", knee), ("HEEL", heel)):
        for axis, values in zip("xyz", places, strict=True):
            np.testing.assert_allclose(table[f"{marker}.{axis}"], values, atol=1e-6)


def test_what_is_no_c3d(tmp_path):
    path = tmp_path / "walk.c3d"
    path.write_text("time,x\n0,1\n", encoding="utf-8")
    with pytest.raises(da.AnalysisError, match=r"walk\.c3d: cannot be read as C3D"):
        read_table(path)
    feet = written(tmp_path / "feet.c3d", {"A": np.zeros((3, 4))}, "ft")
    with pytest.raises(da.AnalysisError, match="points in 'ft'; known units: mm, cm, m"):
        read_table(feet)
    with pytest.raises(da.AnalysisError, match="does not exist"):
        read_table(tmp_path / "none.c3d")


def test_drives_from_markers(tmp_path, monkeypatch):
    """The leg of the examples, a synthetic gait, whose joint angles are known."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "examples"))
    import gait_torques as leg

    times = np.arange(0, 0.7, 1 / RATE)
    data = leg.seen(times, leg.NOISE)
    markers = {
        name.upper(): np.stack([data[f"{name}.x"], 0 * times, data[f"{name}.y"]])  # z is up
        for name in ("knee", "ankle")
    }
    path = written(tmp_path / "gait.c3d", markers)
    ends = {"KNEE": "thigh.end", "ANKLE": "shank.end"}
    measures = {f"{m}.{a}": f"{end}.{b}" for m, end in ends.items() for a, b in ("xx", "zy")}
    system, histories = leg.build(np.linspace(0, times[-1], 7))
    inversion = da.invert(
        *(system.build(), str(path), measures, histories),
        analysis=da.Kinematics(float(times[-1]), outputs=12),
        noise=dict.fromkeys(measures, leg.NOISE),
        smoothing=1e-7,
        order=3,
    )
    for name, true in zip(("hip", "knee"), leg.angles(histories[0].knots), strict=True):
        np.testing.assert_allclose(inversion.values[name], true, atol=0.03)
