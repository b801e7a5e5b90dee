"""Results: labels and units on everything, and the way to files and back."""

import matplotlib

matplotlib.use("Agg")

import numpy as np
import pytest
import xarray as xr

import dalembert as da
from dalembert import planar


@pytest.fixture(scope="module")
def motion() -> da.Motion:
    """A driven crank with a spring and a damper: every kind of variable."""
    system = da.System("everything", gravity=(0.0, -9.81))
    speed = system.parameter("speed", 6.0, unit="rad/s")
    crank = system.add(planar.Bar("crank", length=0.2, mass=1.0, angle=0.3))
    bob = system.add(planar.Particle("bob", mass=0.5, position=(0.5, 0.0)))
    system.add(planar.Revolute("pin", system.ground.center, crank.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 0.3 + speed * da.t))
    system.add(
        planar.Spring("spring", crank.end, bob.center, stiffness=80.0, damping=1.0, free_length=0.3)
    )
    return da.solve_dynamics(system.build(), 0.5, step=0.005)


def test_everything_has_a_unit_and_a_name(motion):
    for name, variable in motion.data.data_vars.items():
        assert variable.attrs.get("units"), name
        assert variable.attrs.get("long_name"), name
    assert motion.data["time"].attrs["units"] == "s"
    assert motion.data.attrs["parameter_speed"] == 6.0


def test_dataset_and_measures_are_the_same(motion):
    data = motion.data
    pairs = [
        (motion["crank.angle"], data["angle"].sel(body="crank")),
        (motion["crank.end.velocity"], data["point_velocity"].sel(point="crank.end")),
        (motion["pin.force"], data["reaction_force"].sel(joint="pin")),
        (motion["motor.effort"], data["effort"].sel(driver="motor")),
        (motion["spring.length"], data["element_length"].sel(element_length_of="spring")),
    ]
    for measure, variable in pairs:
        np.testing.assert_allclose(measure.values, variable.values, rtol=1e-13, atol=1e-15)


def test_tables_take_names_and_formulas(motion):
    name = motion.model.measure_names[0]
    table = motion.table([name, f"2*{name}"])
    np.testing.assert_array_equal(table, [motion.values(name), 2 * motion.values(name)])


def test_netcdf_round_trip(motion, tmp_path):
    path = motion.save(tmp_path / "run.nc")
    loaded = da.load_results(path)
    xr.testing.assert_identical(loaded.drop_vars("report"), motion.data)


def test_table_and_csv(motion, tmp_path):
    table = motion.to_dataframe()
    assert table.index.name == "time"
    assert table["crank.angle"].iloc[-1] == pytest.approx(0.3 + 6.0 * 0.5)
    written = np.genfromtxt(motion.to_csv(tmp_path / "run.csv"), delimiter=",", names=True)
    np.testing.assert_allclose(written["time_s"], motion.time)


def test_energy_balance_converges_with_the_integrator(motion):
    """Half the step, a sixteenth of the error (fourth order); motor and damper both work."""
    finer = da.solve_dynamics(motion.model, 0.5, step=0.0025)
    errors = [float(np.abs(m.data["balance_error"]).max()) for m in (motion, finer)]
    assert errors[0] / errors[1] > 12
    assert float(finer.data["dissipated_energy"][-1]) > 1e-3
    assert abs(float(finer.data["input_energy"][-1])) > 1e-3


def test_pictures(motion, tmp_path):
    import matplotlib.pyplot as plt

    axes = motion.plot("crank.angle", "spring.length")
    assert len(axes.lines) == 2
    film = motion.animate(fps=10)
    film.save(tmp_path / "film.gif", writer="pillow")
    assert (tmp_path / "film.gif").stat().st_size > 5000
    assert "<img" in film._repr_html_()
    plt.close("all")


def test_a_failed_write_leaves_nothing_behind(motion, tmp_path):
    with pytest.raises(da.FileError, match="cannot be written"):
        motion.save(tmp_path / "nowhere" / "run.nc")
    assert list(tmp_path.iterdir()) == []


def test_events_are_labelled_and_saved(tmp_path):
    """A pendulum passes its lowest position to and fro; energy gives its speed there."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bob = system.add(planar.Particle("bob", mass=2.0, position=(0.6, -0.8)))
    system.add(planar.RigidLink("rod", system.ground.point(0, 0), bob.center, length=1.0))
    arguments = {"below": "bob.x", "ends": da.Event("bob.vx", direction=-1, terminal=True)}
    motion = da.solve_dynamics(system.build(), 5.0, step=0.001, outputs=3, events=arguments)
    names = [event.name for event in motion.events]
    assert names == ["below", "below", "ends"]
    assert [event.direction for event in motion.events] == [-1, 1, -1]
    speed = np.sqrt(2 * 9.81 * (1.0 - 0.8))
    for event, sign in zip(motion.events, (-1, 1), strict=False):
        assert event.y == pytest.approx([0.0, -1.0], abs=1e-9)
        assert event.v == pytest.approx([sign * speed, 0.0], abs=1e-8)
    motion.save(tmp_path / "run.nc")
    for data in (motion.data, da.load_results(tmp_path / "run.nc")):
        assert data["event"].values.tolist() == names
        assert data["event_time"].values.tolist() == [event.time for event in motion.events]
        assert data["event_direction"].values.tolist() == [-1, 1, -1]
        computed = data["event_coordinates"].sel(event="below", coordinate="bob.y").values
        assert computed == pytest.approx([-1.0, -1.0], abs=1e-9)
        assert data["event_speeds"].dims == ("event", "coordinate")


def test_no_events_have_the_same_shape(tmp_path):
    system = da.System("mass")
    system.add(planar.Particle("bob", mass=2.0, velocity=(1.0, 0.0)))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.05)
    motion.save(tmp_path / "run.nc")
    for data in (motion.data, da.load_results(tmp_path / "run.nc")):
        assert data["event_time"].shape == (0,) and data["event_coordinates"].shape == (0, 2)


VERBS = [name for name in da.__all__ if name.startswith("solve_")] + ["linearize"]


@pytest.mark.parametrize("name", [name for name in VERBS if name != "solve_assembly"])
def test_verbs_tell_the_nearest_option(name):
    with pytest.raises(da.AnalysisError, match=rf"^{name}: unknown option 'qqqqq'; known: "):
        getattr(da, name)(None, qqqqq=1)
    with pytest.raises(da.AnalysisError, match=r"unknown option 'stp' \(did you mean 'step'\?\)"):
        da.solve_dynamics(None, 1.0, stp=0.1)


def test_modes_are_written_as_other_results_are(tmp_path):
    system = da.System("swing", gravity=(0.0, -9.81))
    bob = system.add(planar.Bar("bob", length=1.0, mass=2.0, angle=-1.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bob.start))
    modes = da.linearize(system.build())
    files = modes.write(tmp_path / "swing", report=True, csv=True)
    assert [f.name for f in files] == ["swing.nc", "swing.csv", "swing.report.html"]
    assert all(f.exists() for f in files)
    computed = da.load_results(files[0])["frequency"].values
    assert computed == pytest.approx(modes.frequencies)


def test_a_state_brings_its_own_parameters():
    """``about`` is a motion with parameters and options: others are refused, not passed over."""
    system = da.System("swing", gravity=(0.0, -9.81))
    mass = system.parameter("m", 2.0)
    bob = system.add(planar.Bar("bob", length=1.0, mass=mass, angle=-1.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bob.start))
    model = system.build()
    rest = da.solve_equilibrium(model)
    for arguments in ({"parameters": {"m": 1.0}}, {"time": 1.0}):
        with pytest.raises(da.AnalysisError, match=r"(m|time) cannot be given with about="):
            da.linearize(model, rest, **arguments)


def test_invalid_requests_are_refused(motion, tmp_path):
    """Lists of measures, and files whose names promise another format."""
    for ask in (motion.plot, motion.values, lambda names: da.evaluate(motion, da.final(names))):
        with pytest.raises(da.DalembertError, match="each by itself"):
            ask(["time", "energy"])
    with pytest.raises(da.FileError, match="to_csv writes"):
        motion.save(tmp_path / "run.csv")
