"""Identification: true parameters come back, intervals hold what they say, bad data are refused."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.errors import AnalysisError
from dalembert.sensitivity.gradient import history_gradients, history_rates

TRUE = {"r": 0.11, "l": 0.33, "off": 0.02}
KINEMATICS = da.Kinematics(3.0, outputs=31)
DYNAMICS = da.Dynamics(1.0, step=0.02)


@pytest.fixture(scope="module")
def crank() -> da.Model:
    system = da.System("slider-crank")
    r = system.parameter("r", 0.1, "m", bounds=(0.05, 0.2))
    length = system.parameter("l", 0.3, "m")
    off = system.parameter("off", 0.0, "m")
    speed = system.parameter("speed", 2.0, "rad/s")
    crank = system.add(planar.Bar("crank", length=r, mass=1.0))
    rod = system.add(planar.Bar("rod", length=length, mass=1.0))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=1.0, position=(0.4, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("rail", system.ground.point(0, off), slider.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, speed * da.t))
    return system.build()


@pytest.fixture(scope="module")
def oscillator() -> da.Model:
    system = da.System("oscillator")
    k1, k2 = (system.parameter(n, 50.0, "N/m", bounds=(1, 500)) for n in ("k1", "k2"))
    c, x0 = system.parameter("c", 0.5, bounds=(0, 9)), system.parameter("x0", 0.5, "m")
    mass = system.add(planar.Particle("mass", mass=2.0, position=(x0, 0)))
    system.add(planar.CoordinateDriver("guide", mass.center, 0.0, direction=(0, 1)))
    wall = system.ground.point(-1, 0)
    spring = planar.Spring("s", wall, mass.center, stiffness=k1 + k2, damping=c, free_length=1.0)
    system.add(spring)
    return system.build()


def measured(model, analysis=KINEMATICS, true=TRUE, noise=0.0, seed=0, **columns):
    motion, rng = analysis.run(model, true), np.random.default_rng(seed)
    results = {"time": motion.time}
    for column, measure in columns.items():
        results[column] = motion.values(measure) + noise * rng.normal(size=motion.time.size)
    return results


@pytest.mark.parametrize("kind", ["crank", "oscillator"])
def test_gradients_of_histories_are_those_of_each_instant(kind, request):
    model = request.getfixturevalue(kind)
    measure, analysis = {
        "crank": ("slider.x", KINEMATICS),
        "oscillator": ("mass.vx", DYNAMICS),
    }[kind]
    times = np.array([0.0, 0.113, 0.509, 0.97])  # also inside of steps
    motion, names = analysis.run(model), list(model.parameters)
    (computed,) = history_gradients(motion.at(times), [measure], names)
    every = [da.at(float(time), measure) for time in times]
    np.testing.assert_allclose(
        computed, da.sensitivity(motion, every, names, "adjoint"), atol=1e-11
    )
    rates = history_rates(motion.at(times[1:-1]), measure)
    moved = [motion.at(times[1:-1] + h).values(measure) for h in (-1e-5, 1e-5)]
    np.testing.assert_allclose(rates, (moved[1] - moved[0]) / 2e-5, rtol=1e-6)


def test_perfect_data_give_the_true_parameters(crank, tmp_path):
    table = pd.DataFrame(measured(crank, x="slider.x", a="rod.angle"))
    table.loc[3:7, "x"] = np.nan
    table["comment"] = "as made"
    table.to_csv(tmp_path / "run.csv", index=False)
    identification = da.identify(
        crank, tmp_path / "run.csv", {"x": "slider.x", "a": "rod.angle"}, TRUE, analysis=KINEMATICS
    )
    assert identification.success and identification.samples == 2 * 31 - 5
    for name, value in TRUE.items():
        assert identification.x[name] == pytest.approx(value, abs=1e-9)


@pytest.mark.thorough
def test_intervals_hold_what_they_say(crank):
    """By chance alone 60 repetitions of three parameters leave 95 % by less than 4.1 %, mostly."""
    clean, hits = measured(crank, x="slider.x"), 0
    for seed in range(60):
        noise = np.random.default_rng(seed).normal(0, 1e-3, clean["x"].size)
        data = clean | {"x": clean["x"] + noise}
        identification = da.identify(crank, data, {"x": "slider.x"}, TRUE, analysis=KINEMATICS)
        hits += sum(a <= TRUE[n] <= b for n, (a, b) in identification.interval().items())
    assert 0.95 - 3 * np.sqrt(0.05 * 0.95 / 60) < hits / 180 <= 1


def test_noise_is_found_column_by_column(crank):
    clean, rng = measured(crank, x="slider.x", a="rod.angle"), np.random.default_rng(5)
    clean["x"] += rng.normal(0, 1e-4, clean["x"].size)
    clean["a"] += rng.normal(0, 1e-2, clean["a"].size)
    columns = {"x": "slider.x", "a": "rod.angle"}
    identification = da.identify(crank, clean, columns, TRUE, analysis=KINEMATICS)
    assert identification.noise["x"] == pytest.approx(1e-4, rel=0.4)
    assert identification.noise["a"] == pytest.approx(1e-2, rel=0.4)
    result = da.identify(
        crank, clean, columns, TRUE, analysis=KINEMATICS, noise={"x": 1e-4, "a": 1e-2}
    )
    assert result.noise_specified and result.x["r"] == pytest.approx(
        identification.x["r"], abs=1e-4
    )
    ratio = result.deviation["r"] / identification.deviation["r"]
    assert 0.6 < ratio < 1.6


def test_noise_may_stand_in_a_column(crank):
    """Half of the samples are said to be useless, and are."""
    data = measured(crank, x="slider.x")
    data["x"][::2] += 0.3
    data["spread"] = np.where(np.arange(data["x"].size) % 2, 1e-5, 1e3)
    identification = da.identify(
        *(crank, data, {"x": "slider.x"}, TRUE), analysis=KINEMATICS, noise={"x": "spread"}
    )
    for name, value in TRUE.items():
        assert identification.x[name] == pytest.approx(value, abs=1e-6)


def test_a_step_to_where_nothing_can_be_is_shortened(oscillator):
    """Gravity far off: the first step would make the mass negative, which no bound forbids."""
    system = da.System("hung")
    m = system.parameter("m", 0.2, "kg")
    mass = system.add(planar.Particle("mass", mass=m, position=(0.0, 0)))
    system.add(planar.CoordinateDriver("guide", mass.center, 0.0, direction=(0, 1)))
    system.add(planar.Force("force", mass.center, (3.0, 0.0)))
    model, analysis = system.build(), da.Dynamics(1.0, step=0.05)
    data = measured(model, analysis, {"m": 5.0}, x="mass.x")
    identification = da.identify(model, data, {"x": "mass.x"}, ["m"], analysis=analysis)
    assert identification.x["m"] == pytest.approx(5.0, rel=1e-8)
    assert identification.sentence.startswith("1 unknown from ")


@pytest.mark.thorough
def test_robust_losses_forgive_outliers(crank):
    off = {}
    data = measured(crank, true={"r": 0.11}, noise=1e-3, x="slider.x")
    data["x"][[4, 13, 22]] += 0.2
    for loss in ("linear", "huber", "soft_l1", "cauchy", "arctan"):
        identification = da.identify(
            crank, data, {"x": "slider.x"}, ["r"], analysis=KINEMATICS, loss=loss
        )
        off[loss] = abs(identification.x["r"] - 0.11)
    assert all(off[loss] < 2e-3 and off[loss] < off["linear"] / 3 for loss in list(off)[1:])


@pytest.mark.thorough
def test_far_starts_end_in_other_minima():
    """A sine of an unknown frequency: of several starts the best counts, and each is told."""
    system = da.System("swing")
    w = system.parameter("w", 9.0, "rad/s", bounds=(1, 20))
    cart = system.add(planar.Particle("cart", mass=1.0))
    driven = planar.CoordinateDriver("x", cart.center, da.sin(w * da.t), direction=(1, 0))
    system.add(driven)
    system.add(planar.CoordinateDriver("y", cart.center, 0.0, direction=(0, 1)))
    model, analysis = system.build(), da.Kinematics(2.0, outputs=21)
    data = measured(model, analysis, {"w": 5.0}, x="cart.x")
    arguments = {"measures": {"x": "cart.x"}, "vary": ["w"], "analysis": analysis}
    assert abs(da.identify(model, data, **arguments).x["w"] - 5) > 1
    best = da.identify(model, data, **arguments, starts=6)
    assert best.x["w"] == pytest.approx(5, rel=1e-6)
    assert len(best.minima) > 1 and any("minima from several starts" in n for n in best.notes)
    with pytest.raises(AnalysisError, match="starts is 0"):
        da.identify(model, data, **arguments, starts=0)


def test_a_delay_is_found(crank):
    exact = KINEMATICS.run(crank, {"r": 0.11})
    times = np.linspace(0.4, 2.9, 40)
    data = {"t": times, "x": exact.at(times - 0.137).values("slider.x")}
    lag = {"x": (0.0, 0.3)}
    identification = da.identify(
        crank, data, {"x": "slider.x"}, ["r", "l"], analysis=KINEMATICS, delays=lag
    )
    assert identification.x["delay(x)"] == pytest.approx(0.137, abs=1e-8)
    assert identification.x["r"] == pytest.approx(0.11, abs=1e-8)


def test_runs_have_unknowns_of_their_own(oscillator):
    runs = [
        da.Experiment(
            data=measured(oscillator, DYNAMICS, {"k1": 70.0, "x0": x0}, x="mass.x"),
            own=["x0"],
            name=name,
        )
        for name, x0 in (("a", 0.3), ("b", -0.2))
    ]
    identification = da.identify(oscillator, runs, {"x": "mass.x"}, ["k1", "c"], analysis=DYNAMICS)
    expected = {"k1": 70.0, "c": 0.5, "x0[a]": 0.3, "x0[b]": -0.2}
    assert identification.x == pytest.approx(expected, abs=1e-8)


def test_what_the_data_cannot_tell(oscillator):
    data = measured(oscillator, DYNAMICS, {"k1": 70.0}, noise=1e-3, x="mass.x")
    identification = da.identify(
        oscillator, data, {"x": "mass.x"}, ["k1", "k2", "c"], analysis=DYNAMICS
    )
    worst = identification.combinations[0]
    assert np.isinf(worst.deviation) and abs(worst.direction["c"]) < 1e-6
    deviation = identification.deviation
    assert np.isinf(deviation["k1"]) and np.isinf(deviation["k2"]) and np.isfinite(deviation["c"])
    assert identification.x["k1"] + identification.x["k2"] == pytest.approx(120, rel=0.02)
    assert "not determined" in identification._repr_html_()


def test_residuals_that_are_no_noise_are_told(oscillator):
    """Noise alone, or what a model with too little damping cannot follow."""
    analysis = da.Dynamics(4.0, step=0.02)
    true = {"k1": 50.0, "k2": 50.0, "c": 1.0, "x0": 0.4}
    data = measured(oscillator, analysis, true, 0.01, **{"mass.x": "mass.x"})
    for vary, reported in ((["k1", "c", "x0"], False), (["k1", "x0"], True)):
        identification = da.identify(oscillator, data, vary=vary, analysis=analysis)
        assert (
            any("mass.x: neighbouring residuals agree" in n for n in identification.notes)
            is reported
        )


def test_advice_prefers_what_tells_more(oscillator):
    data = measured(oscillator, DYNAMICS, {"k1": 70.0}, noise=1e-3, x="mass.x")
    identification = da.identify(oscillator, data, {"x": "mass.x"}, ["k1"], analysis=DYNAMICS)
    candidates = {"still": {"x0": 0.01}, "far": {"x0": 2.0}}
    far, still = identification.advise(candidates)
    assert far["name"] == "far" and far["gain"] > 10 * still["gain"] > 0
    assert far["deviation"]["k1"] < identification.deviation["k1"] / 2
    with pytest.raises(da.AnalysisError, match="'k1', which is unknown"):
        identification.advise({"wrong": {"k1": 1.0}})


@pytest.mark.parametrize(
    ("data", "more", "message"),
    [
        ({"time": [], "slider.x": []}, {}, "no rows"),
        ({"clock": [0, 1], "slider.x": [0, 1]}, {}, "no column 'time' or 't'"),
        ({"time": [0, 1], "slide.x": [0, 1]}, {}, "matches no measure"),
        ({"time": [0, 1], "x": [0, 1]}, {"measures": {"y": "slider.x"}}, "no column 'y'"),
        ({"time": [0, 1], "slider.x": [np.nan] * 2}, {}, "holds no numbers"),
        ({"time": [0, 1], "slider.x": [np.inf, 1]}, {}, "infinite"),
        ({"time": [0, np.nan], "slider.x": [0, 1]}, {}, "not all numbers"),
        ({"time": [0, 1], "slider.x": [0, 1, 2]}, {}, "differ in length"),
        ({"time": [0, 1], "slider.x": [0, 1]}, {}, "2 sample.s. for 3 unknowns"),
        ({"time": [0, 9, 10], "slider.x": [0, 1, 2]}, {}, "outside the run"),
        ({"time": [0, 1, 2], "slider.position": [0, 1, 2]}, {}, "2 components"),
        ("nowhere.csv", {}, "does not exist"),
        (3.0, {}, "give a DataFrame"),
    ],
)
def test_bad_data_are_told(crank, data, more, message):
    with pytest.raises(da.AnalysisError, match=message):
        da.identify(crank, data, vary=list(TRUE), analysis=KINEMATICS, **more)


def test_the_command_line(tmp_path, capsys):
    (tmp_path / "fall.toml").write_text(
        'format = 1\ngravity = ["0", "-g"]\n'
        "[parameters]\ng = { value = 9.0, bounds = [1, 20] }\n"
        '[bodies]\nball = { type = "Particle", mass = 1.0, position = [0, 0] }\n'
        '[analysis]\ntype = "Dynamics"\nduration = 1.0\nstep = 0.1\n'
        '[identify]\ndata = "fall.csv"\nvary = ["g"]\nmeasures = { height = "ball.y" }\n'
    )
    times = np.linspace(0, 1, 11)
    rows = pd.DataFrame({"time": times, "height": -9.81 * times**2 / 2})
    assert main(["identify", str(tmp_path / "fall.toml")]) == 2  # no data yet
    assert "no such file" in capsys.readouterr().err
    rows.to_csv(tmp_path / "fall.csv", index=False)
    out = tmp_path / "o"
    assert main(["identify", str(tmp_path / "fall.toml"), "--json", "--output", str(out)]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["x"]["g"] == pytest.approx(9.81, rel=1e-10)
    assert (out / "fall.identified.png").exists() and (out / "fall.covariance.csv").exists()
    rows.height *= 2
    rows.to_csv(tmp_path / "other.csv", index=False)
    again = ["identify", str(tmp_path / "fall.toml"), "--data", str(tmp_path / "other.csv")]
    assert main([*again, "--quiet"]) == 0
    assert "19.62" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "fall.toml")]) == 0


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('data = "a.csv"\nvary = ["gg"]', ["identify.vary[0]", "did you mean 'g'"]),
        ('data = "a.csv"\nvary = ["g"]\nloss = "hubert"', ["identify.loss", "huber"]),
        ('data = "a.csv"\nvary = ["g"]\nmeasures = { h = "bal.y" }', ["identify.measures.h"]),
        ('vary = ["g"]', ["identify.data", "give data, or a list of experiments"]),
        (
            'vary = ["g"]\nexperiments = [{ data = "a.csv", own = ["q"] }]',
            ["identify.experiments[0].own", "unknown parameter 'q'"],
        ),
        ('data = "a.csv"\nvary = ["g"]\ndelays = { h = [2, 1] }', ["delays"]),
        ('data = "a.csv"\nvary = ["g"]\nwary = 1', ["wary", "did you mean 'vary'"]),
        ('data = "empty.csv"\nvary = ["g"]', ["empty.csv", "cannot be read"]),
    ],
)
def test_a_file_that_asks_wrongly(tmp_path, capsys, table, message):
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "fall.toml").write_text(
        'format = 1\ngravity = [0, "-g"]\n[parameters]\ng = { value = 9.0, bounds = [1, 20] }\n'
        '[bodies]\nball = { type = "Particle", mass = 1.0, position = [0, 0] }\n'
        f'[analysis]\ntype = "Dynamics"\nduration = 1.0\nstep = 0.1\n[identify]\n{table}\n'
    )
    assert main(["identify", str(tmp_path / "fall.toml")]) in (1, 2)
    message = capsys.readouterr().err
    for text in message:
        assert text in message
