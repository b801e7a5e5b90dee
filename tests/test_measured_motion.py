"""Measured motion in files as tables: laws of drivers, inputs, and records."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert.cli import main
from dalembert.design.identification.data_table import read_table

TIMES = np.linspace(0.0, 0.5, 26)
ANGLES = 30 * np.sin(4 * TIMES)
LAW = """
format = 1
[tables.measured]
file = "FILE"
x = "time"
y = "crank.x"
[bodies.crank]
type = "Bar"
length = 1
mass = 1
[joints.pin]
type = "Revolute"
connect = [{ body = "ground", at = [0, 0] }, "crank.start"]
[analysis]
type = "Kinematics"
duration = 0.5
outputs = 26
"""
DRIVER = '[drivers.motor]\ntype = "RotationalDriver"\njoint = "pin"\nlaw = "DRIVE"\n'


def measured(folder: Path, kind: str, angles=ANGLES, times=TIMES) -> Path:
    """The angle in degrees, or the marker of a C3D file in millimetres."""
    path = folder / f"angle.{kind.partition('-')[0]}"
    if kind == "parquet":
        arrow = pytest.importorskip("pyarrow")
        columns = {"time [s]": list(times), "crank.x [deg]": list(angles), "note": ["a"] * 26}
        pytest.importorskip("pyarrow.parquet").write_table(arrow.table(columns), path)
    elif kind == "c3d":
        ezc3d = pytest.importorskip("ezc3d")
        file = ezc3d.c3d()
        file.add_parameter("POINT", "UNITS", ["mm"])
        file["parameters"]["POINT"]["RATE"]["value"] = [50.0]
        file["parameters"]["POINT"]["LABELS"]["value"] = ["crank"]
        points = np.zeros((4, 1, len(angles)))
        points[0, 0], points[3] = np.radians(angles) * 1000, 1
        file["data"]["points"] = points
        file.write(str(path))
    else:
        mark, point = {"csv": (",", "."), "csv-german": (";", ","), "csv-tab": ("\t", ".")}[kind]
        rows = [
            f"{a!r}{mark}{b!r}".replace(".", point)
            for a, b in zip(times.tolist(), angles, strict=True)
        ]
        rows = [row.replace("nan", "") for row in rows]
        heading = f"time [s]{mark}crank.x [deg]"
        path.write_text("\n".join([heading, *rows]), encoding="utf-8")
    return path


def model_file(folder: Path, path: Path, text: str = "", drive: str = "") -> Path:
    drive = drive or ("interp(t, measured)" if path.suffix != ".c3d" else "interp(t, measured)/m")
    target = folder / "crank.toml"
    law = LAW.replace("FILE", path.name) + DRIVER.replace("DRIVE", drive)
    target.write_text(law + text, encoding="utf-8")
    return target


KINDS = ("csv", "csv-german", "csv-tab", "parquet", "c3d")


@pytest.mark.parametrize("kind", KINDS)
def test_law_of_a_driver(tmp_path, kind) -> None:
    """The joint follows the measured angle at the measured times, in every format."""
    path = measured(tmp_path, kind, angles=[float(a) for a in ANGLES])
    drive = "interp(t, measured)" + ("/(1 m)" if kind == "c3d" else "")
    model = da.load_model(model_file(tmp_path, path, drive=drive)).build()
    motion = da.solve_kinematics(model, 0.5, outputs=26)
    # a C3D file holds single precision
    np.testing.assert_allclose(motion["crank.angle"], np.radians(ANGLES), atol=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_records_for_identification(tmp_path, kind) -> None:
    table = read_table(measured(tmp_path, kind, angles=[float(a) for a in ANGLES]))
    np.testing.assert_allclose(table["time"], TIMES, atol=1e-12)
    np.testing.assert_allclose(table["crank.x"], np.radians(ANGLES), atol=1e-7)


def test_input(tmp_path) -> None:
    """A measured torque as the value of an input accelerates the bar as its formula does."""
    path = measured(tmp_path, "csv", angles=[float(a) for a in 3.0 * TIMES])
    path.write_text(path.read_text("utf-8").replace("[deg]", "[N m]"), encoding="utf-8")
    text = LAW.replace("FILE", path.name).replace('"Kinematics"', '"Dynamics"')
    text += '[inputs.torque]\nvalue = "interp(t, measured)"\nunit = "N m"\n'
    text += '[forces.motor]\ntype = "JointActuator"\njoint = "pin"\nvalue = "torque"\n'
    (tmp_path / "crank.toml").write_text(f"gravity = [0, 0]\n{text}", encoding="utf-8")
    motion = da.solve_dynamics(da.load_model(tmp_path / "crank.toml").build(), 0.5)
    # (1/3) α = 3 t, φ = 3 t³ / 2
    assert motion["crank.angle"].values[-1] == pytest.approx(1.5 * 0.5**3, rel=1e-5)


def refused(folder: Path, path: Path, capsys) -> str:
    target = model_file(folder, path)
    assert main(["check", str(target)]) == 2
    error = capsys.readouterr().err
    assert "Traceback" not in error and "tables.measured" in error
    return error


@pytest.mark.parametrize("kind", KINDS)
def test_gaps_are_listed(tmp_path, capsys, kind) -> None:
    angles = [float(a) for a in ANGLES]
    angles[3] = angles[7] = float("nan")
    error = refused(tmp_path, measured(tmp_path, kind, angles=angles), capsys)
    assert "column 'crank.x' has no value in 2 of 26 rows (4, 8)" in error


def test_times_that_do_not_increase(tmp_path, capsys) -> None:
    times = TIMES.copy()
    times[5] = times[4]
    path = measured(tmp_path, "csv", angles=[float(a) for a in ANGLES], times=times)
    assert "increas" in refused(tmp_path, path, capsys)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("angle.csv", b"time,crank.x\n0,1\n1,5,2,5\n", "line 3: has 4 columns"),
        ("angle.csv", b"zeit;wert [\xb0]\n0;1\n", "is not UTF-8 text; save the file as UTF-8"),
        ("angle.csv", b"time;crank.x\n0;a\n", "line 2: expected numbers, got '0;a'"),
        ("angle.csv", b"time;crank.x\n", "has no rows of numbers"),
        ("angle.parquet", b"PAR1 nothing", "cannot be read as Parquet"),
        ("angle.c3d", b"nothing", "cannot be read as C3D"),
    ],
)
def test_wrong_files(tmp_path, capsys, name, content, message) -> None:
    (tmp_path / name).write_bytes(content)
    assert message in refused(tmp_path, tmp_path / name, capsys)
