"""``compare``: its table tells what single runs tell, and nothing is left out in silence."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.io.decisions.tasks import check_tasks
from dalembert.io.model_file import load_model_file
from dalembert.results.comparison.table import cells, notes

mpl.use("Agg")
FOUR_BAR = Path(__file__).parents[1] / "examples" / "four_bar.toml"
LENGTH, SPAN = 0.8, 2.0


@dataclass(frozen=True)
class Refusing(da.RangeSpace):
    """A formulation that cannot do anything."""

    def acceleration(self, *arguments, **keys):
        raise da.UnsupportedError("Refusing() never works; use formulation=RangeSpace()")


@cache
def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", LENGTH, "m")
    bar = system.add(planar.Bar("bar", length=length, mass=2.0, angle=0.3))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    return system.build()


@cache
def comparison() -> da.Comparison:
    return da.compare(
        pendulum(),
        SPAN,
        formulations=["RangeSpace", Refusing()],
        integrators=["Heun", da.RK4(), da.DormandPrince],
        steps=[0.02, 0.01, 0.005],
        tolerances=(1e-4, 1e-7),
        measure="bar.angle",
        outputs=21,
    )


def only(comparison: da.Comparison) -> dict:
    (row,) = comparison.table().to_dict("records")
    return row


def test_rows_equal_single_runs():
    row = only(comparison().sel(integrator="RK4", step=0.01, outcome="completed"))
    times = np.linspace(0, SPAN, 21)
    motion = da.solve_dynamics(pendulum(), SPAN, step=0.01, outputs=times)
    assert row["steps"] == motion.statistics["steps"] == 200
    for name in ("position_violation", "velocity_violation"):
        assert row[name] == float(motion.data[name].max())
    balance = float(abs(motion.data["balance_error"]).max())
    energy = comparison().data.attrs["kinetic_energy"]
    assert row["energy_error"] == pytest.approx(balance / energy, rel=1e-12)
    assert energy == pytest.approx(float(motion.data["kinetic_energy"].max()), rel=1e-5)
    assert row["time_per_step"] == pytest.approx(1e6 * row["time"] / 200)


def test_errors_are_those_against_the_equation_of_the_pendulum():
    """``θ̈ = −3 g cos θ / (2 l)`` for a uniform bar about its end, θ from the horizontal."""
    times = np.linspace(0, SPAN, 21)
    exact = solve_ivp(
        lambda t, s: (s[1], -1.5 * 9.81 * np.cos(s[0]) / LENGTH),
        (0, SPAN),
        (0.3, 0.0),
        method="DOP853",
        t_eval=times,
        rtol=1e-13,
        atol=1e-13,
    ).y
    motion = da.solve_dynamics(pendulum(), SPAN, step=0.02, outputs=times)
    row = only(comparison().sel(integrator="RK4", step=0.02, outcome="completed"))
    off = abs(motion["bar.angle"].values - exact[0])
    assert row["error_position"] == pytest.approx(off.max(), rel=1e-5)
    assert row["error_position_final"] == pytest.approx(off[-1], rel=1e-5)
    rate = abs(motion["bar.angular_velocity"].values - exact[1])
    assert row["error_velocity"] == pytest.approx(rate.max(), rel=1e-5)
    assert comparison().uncertainty < 1e-10


def test_orders_are_seen():
    orders = comparison().orders().set_index("integrator")["order"]
    assert orders["Heun"] == pytest.approx(2, abs=0.2)
    assert orders["RK4"] == pytest.approx(4, abs=0.3)
    loose, tight = comparison().sel(integrator="DormandPrince", outcome="completed").table().iloc
    assert tight["error_position"] < 0.01 * loose["error_position"]
    assert tight["steps"] > loose["steps"]


def test_failing_combinations_are_reported_once():
    result = comparison()
    refused = result.sel(formulation="Refusing")
    assert refused.data.sizes["run"] == 3  # one per integrator, not per step
    assert set(refused.data["outcome"].values) == {"UnsupportedError"}
    assert np.isnan(refused.data["error_position"]).all()
    assert notes(result).count("Refusing() never works; use formulation=RangeSpace()") == 1
    assert result.complete and result.finished.sum() == 8
    columns, rows = cells(result)
    status = [c.heading for c in columns].index("status")
    messages = [row[status].partition(" [")[0] for row in rows]
    assert messages == ["ok"] * 8 + ["unsupported"] * 3
    assert "3 of 11 runs did not finish" in result.summary()


def test_a_run_that_diverges_keeps_its_status():
    """Euler's method multiplies the amplitude by ``√(1 + (hω)²)``, here 6.4, in every step."""
    system = da.System("stiff")
    mass = system.add(planar.Body("mass", mass=1.0, inertia=1.0, position=(1.0, 0.0)))
    centre = mass.point(0, 0)
    ground = system.ground.point(0, 0)
    system.add(planar.Spring("spring", ground, centre, stiffness=1e7, free_length=0.999))
    options = {"formulations": "RangeSpace", "integrators": "Euler", "steps": 0.002, "outputs": 11}
    comparison = da.compare(system.build(), 0.5, **options)
    row = only(comparison)
    assert row["outcome"] == "diverged" and "finite" in row["message"]
    assert np.isnan(row["error_position"]) and row["steps"] < 250
    with pytest.raises(da.AnalysisError, match="no run finished"):
        comparison.plot()


def test_a_doubtful_choice_is_marked():
    """A gain of 5700 1/s with steps of 1 ms makes violations grow: RK4 bears ``hs = −2.8``."""
    comparison = da.compare(
        pendulum(),
        0.003,
        formulations="RangeSpace",
        integrators="RK4",
        steps=[0.001, 0.0001],
        stabilizations=da.Baumgarte(alpha=5700.0),
        outputs=3,
    )
    long, short = comparison.table().to_dict("records")
    single = da.solve_dynamics(
        pendulum(), 0.003, step=0.001, stabilization=da.Baumgarte(alpha=5700.0), outputs=3
    )
    assert [long["warnings"]] == single.warnings and "use steps below" in long["warnings"]
    assert short["warnings"] == "" and notes(comparison) == single.warnings
    columns, rows = cells(comparison)
    status = [c.heading for c in columns].index("status")
    assert [row[status] for row in rows] == ["ok [1]", "ok"]


@pytest.mark.thorough
def test_choices_that_nobody_made_are_combined_where_they_can_work():
    result = da.compare(pendulum(), 0.1, steps=0.01, tolerances=1e-4, outputs=3)
    runs = result.table()
    assert result.finished.all()
    assert set(runs["integrator"][runs["formulation"] == "DAE"]) == {"Radau"}
    joint = runs[runs["coordinates"] == "JointCoordinates"]
    assert set(joint["formulation"]) == {"RangeSpace"}
    comparison = da.compare(
        pendulum(), 0.1, formulations=["DAE"], integrators="RK4", steps=0.01, outputs=3
    )
    assert only(comparison)["outcome"] == "UnsupportedError"  # who asks is answered


def test_errors_below_the_uncertainty_are_marked():
    same = da.DormandPrince853(max_step=SPAN / 200)  # as the reference
    comparison = da.compare(
        pendulum(),
        SPAN,
        formulations=da.RangeSpace(),
        integrators=[same, "RK4"],
        tolerances=1e-12,
        steps=0.02,
        outputs=11,
    )
    reference, rk4 = comparison.table().to_dict("records")
    assert reference["error_position"] == 0.0 and reference["below_uncertainty"]
    assert not rk4["below_uncertainty"]
    columns, rows = cells(comparison)
    error = [c.heading for c in columns].index("error")
    assert rows[0][error].startswith("≤") and not rows[1][error].startswith("≤")


def test_a_given_motion_is_the_reference():
    loose = da.solve_dynamics(pendulum(), SPAN, step=0.04)
    comparison = da.compare(
        pendulum(),
        SPAN,
        formulations="RangeSpace",
        integrators="RK4",
        steps=[0.04, 0.01],
        reference=loose,
        outputs=26,
    )
    same, better = comparison.data["error_position"].values
    assert same < 1e-14
    assert comparison.uncertainty == pytest.approx(
        better, rel=0.02
    )  # both see the error of the motion


def test_parameters_change_the_run_not_the_model():
    options = {"formulations": "RangeSpace", "integrators": "RK4", "steps": 0.02, "outputs": 11}
    long = da.compare(pendulum(), SPAN, parameters={"length": 1.6}, **options)
    short = da.compare(pendulum(), SPAN, **options)
    assert only(long)["error_position"] < 0.5 * only(short)["error_position"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"integrators": "RK5"}, "did you mean 'RK4'"),
        ({"formulations": ["Range"]}, "known: RangeSpace, KKT"),
        ({"stabilizations": []}, "at least one"),
        ({"integrators": da.RangeSpace()}, "integrators: RangeSpace"),
        ({"steps": [0.01, 0]}, "not a positive number"),
        ({"steps": 3.0}, "longer than the run"),
        ({"tolerances": "tight"}, "not a positive number"),
        ({"measure": "bar.angel"}, "bar.angle"),
        ({"repeat": 0}, "at least once"),
        ({"reference": 3}, "reference"),
        ({"duration": 0.0}, "after the start"),
    ],
)
def test_wrong_input(options, message):
    with pytest.raises((da.UnsupportedError, da.AnalysisError), match=message):
        da.compare(pendulum(), **({"duration": SPAN} | options))


# files and pictures ------------------------------------------------------------------
def test_saved_and_loaded(tmp_path):
    result = comparison()
    again = da.Comparison(da.load_results(result.save(tmp_path / "c.nc")))
    assert again.summary() == result.summary()
    assert again.table().equals(result.table())
    with result.to_csv(tmp_path / "c.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["integrator"] for row in rows] == list(result.data["integrator"].values)
    assert float(rows[0]["error_position"]) == result.data["error_position"].values[0]
    assert "Refusing() never works" in result._repr_html_()


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["work-precision", "violations", "energy"])
def test_pictures(kind):
    import matplotlib.pyplot as plt

    result = comparison()
    axes = np.atleast_1d(result.plot(kind))
    texts = [t.get_text() for t in axes[0].texts]
    assert {"Heun", "RK4", "DormandPrince"} <= set(texts)
    assert len(axes) == (2 if kind == "violations" else 1)
    line = axes[0].lines[0]
    rows = result.sel(integrator="Heun", outcome="completed").data
    assert np.allclose(line.get_xdata(), 1e3 * rows["time"].values)
    plt.close(axes[0].figure)
    with pytest.raises(da.AnalysisError, match="work-precision"):
        result.plot("pie")


# the command ---------------------------------------------------------------------------
@pytest.fixture
def model(tmp_path) -> Path:
    text = re.sub(r"(?m)^duration = .*$", "duration = 0.5", FOUR_BAR.read_text(encoding="utf-8"))
    text += """
[compare]
formulations = ["RangeSpace"]
stabilizations = ["Projection", { type = "Baumgarte", alpha = 20 }]
integrators = ["RK4", "DormandPrince"]
steps = [0.02, 0.01]
tolerances = [1e-6]
measure = "crank.angle"
"""
    path = tmp_path / "four_bar.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_command(model, tmp_path, capsys, monkeypatch):
    out = tmp_path / "o"
    monkeypatch.setenv("COLUMNS", "140")
    assert main(["compare", str(model), "--output", str(out)]) == 0
    text = capsys.readouterr().out
    for word in ("Baumgarte(alpha=20)", "h = 0.02 s", "tol 1e-6", "time [ms]", "crank.angle"):
        assert word in text
    assert sorted(p.name for p in out.iterdir()) == ["four_bar.compare.csv", "four_bar.compare.png"]


def test_a_narrow_table_keeps_what_matters():
    for width in (80, 100, 140):
        columns, rows = cells(comparison(), width)
        lines = [[c.heading for c in columns], *rows]
        widths = [max(map(len, column)) + 2 for column in zip(*lines, strict=True)]
        assert sum(widths) <= width
        assert {"setting", "time [ms]", "error", "status"} <= set(lines[0])
    assert len(columns) > 10


@pytest.mark.thorough
def test_command_as_json(model, tmp_path, capsys):
    arguments = ["compare", str(model), "--output", str(tmp_path), "--json", "--svg"]
    arguments += ["--integrators", "RK4,Heun", "--steps", "0.01", "--duration", "0.2"]
    assert main([*arguments, "--set", "l2=0.9"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["ok"] and document["complete"] and document["end"] == 0.2
    assert [(r["integrator"], r["stabilization"]) for r in document["runs"]] == [
        ("RK4", "Projection"),
        ("Heun", "Projection"),
        ("RK4", "Baumgarte(alpha=20)"),
        ("Heun", "Baumgarte(alpha=20)"),
    ]
    assert all(r["steps"] == 20 and r["tolerance"] is None for r in document["runs"])
    assert document["reference"]["uncertainty"]["position"] < 1e-9
    assert document["files"][1].endswith("four_bar.compare.svg")
    assert all(Path(f).exists() for f in document["files"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--integrators", "RK5"], "did you mean 'RK4'"),
        (["--steps", "0.01,fast"], "'fast' is not a positive number"),
        (["--measure", "crank.angel"], "crank.angle"),
        (["--duration", "-1"], "after the start"),
        (["--formulations", ","], "at least one of RangeSpace"),
        (["--formulations", "NullSpace(basis=qr)"], "a table with its type"),
        (["--coordinates", "JointCoordinate"], "did you mean 'JointCoordinates'"),
        (["--steps", ""], "give at least one"),
        (["--steps", "-0.01"], "'-0.01' is not a positive number"),
        (["--steps", "1"], "longer than the run of 0.5 s"),
        (["--tolerances", "0"], "'0' is not a positive number"),
        (["--measure", "crank.angle +"], "measure: in formula"),
        (["--repeat", "0"], "at least once"),
    ],
)
def test_command_with_wrong_input(arguments, message, model, tmp_path, capsys):
    out = tmp_path / "o"
    assert main(["compare", str(model), "--output", str(out), *arguments]) == 2
    errors = capsys.readouterr().err
    assert message in errors and errors.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('"RK4"', '"RK5"', "compare.integrators"),
        ("alpha = 20", "alpha = -1", "compare.stabilizations"),
        ("[1e-6]", "[-1.0]", "compare: tolerances"),
        ("[1e-6]", "[]", "compare: tolerances"),
        ("steps = [0.02, 0.01]", "repeat = 0", "compare: repeat"),
        ("steps = [0.02, 0.01]", "steps = [100.0]", "compare: step 100 s"),
        ('formulations = ["RangeSpace"]', "formulations = []", "compare: formulations"),
        ('["RangeSpace"]', '[{ type = "DAE", index = 4 }]', "compare.formulations: DAE(index=4)"),
        (
            'formulations = ["RangeSpace"]',
            'coordinates = [{ type = "JointCoordinates", cut = ["nope"] }]',
            "compare.coordinates: cut 'nope'",
        ),
        ('1e-6]\nmeasure = "crank.angle"', '1e-6]\nmeasure = "angel"', "compare.measure"),
    ],
)
def test_slips_in_the_file_are_told_with_their_place(old, new, place, model):
    model.write_text(model.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    with pytest.raises(da.DalembertError, match=re.escape(place)):
        check(model)


def test_slips_in_the_file_keep_their_place_with_options(model, tmp_path, capsys):
    model.write_text(model.read_text(encoding="utf-8").replace("[1e-6]", "[]"), encoding="utf-8")
    out = tmp_path / "o"
    assert main(["compare", str(model), "--duration", "0.1", "--output", str(out)]) == 2
    assert f"Error: {model}: compare: tolerances" in capsys.readouterr().err
    assert not out.exists()


def test_without_a_duration(model, tmp_path, capsys):
    text = re.sub(r"(?ms)^\[analysis\].*?(?=^\[)", "", model.read_text(encoding="utf-8"))
    model.write_text(text, encoding="utf-8")
    assert main(["compare", str(model), "--output", str(tmp_path / "o")]) == 2
    assert "give a duration" in capsys.readouterr().err


@pytest.mark.thorough
def test_an_interruption_keeps_the_rows_so_far(model, tmp_path, capsys, monkeypatch):
    """Ctrl-C comes while the third row is timed again."""
    plain, calls = da.Dynamics.run, []

    def run(self, *arguments, **keys):
        calls.append(self)
        if len(calls) == 8:  # the reference, its check, three rows twice
            raise KeyboardInterrupt
        return plain(self, *arguments, **keys)

    monkeypatch.setattr(da.Dynamics, "run", run)
    assert main(["compare", str(model), "--json", "--output", str(tmp_path)]) == 130
    document = json.loads(capsys.readouterr().out)
    assert not document["ok"] and not document["complete"] and len(document["runs"]) == 2
    assert len((tmp_path / "four_bar.compare.csv").read_text(encoding="utf-8").splitlines()) == 3


def check(path: Path) -> None:
    file = load_model_file(path)
    check_tasks(file, file.model())
