"""Every design of a batch is its own single run, whoever computes it and whoever stands beside."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.batch.marches import FixedSteps
from dalembert.results.status import Outcome

LENGTHS = [0.2, 0.35, 0.5, 0.7, 0.9]
BAD = [3.0, float("nan"), -1.0]
"""Cranks that cannot be assembled, are no number, or no length."""
OUTCOMES = [Outcome.NOT_ASSEMBLED, Outcome.REFUSED, Outcome.REFUSED]
MEASURES = ["crank.angle", "A.force", "rocker.angular_velocity"]
RUN = {"duration": 0.3, "step": 0.01}


def four_bar() -> da.Model:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1, m2 = system.parameter("l1", 0.3, unit="m"), system.parameter("m2", 5.0)
    crank = system.add(planar.Bar("crank", length=l1, mass=1.5, angle=1.57, angular_velocity=1.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=m2))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system.build()


@pytest.fixture(scope="module")
def model() -> da.Model:
    return four_bar()


def same(batch: da.Batch, k: int, single: da.Motion, measures: list[str]) -> None:
    """Design ``k`` of a batch is this run."""
    assert batch.statuses[k].outcome is single.status.outcome
    np.testing.assert_array_equal(batch.time, single.time)
    for measure in measures:
        expected = single.values(measure)
        computed = batch.values(measure)[k]
        np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


CHOICES = {
    "usual": {},
    "few outputs": {"outputs": [0.033, 0.1, 0.3]},
    "lanes": {"backend": "jit", "workers": 2},
    "virtual machine": {"backend": "vm"},
    "joint coordinates": {"coordinates": da.JointCoordinates()},
    "null space": {"formulation": da.NullSpace()},
    "partitioned speeds": {"formulation": da.VelocityPartitioning(), "workers": 1},
    "implicit": {"integrator": da.Newmark()},
    "with memory": {"integrator": da.BDF(), "outputs": 4},
    "error control": {"integrator": da.DormandPrince(), "outputs": 4},
    "fed back": {"stabilization": da.Baumgarte(5.0, 5.0)},
}


@pytest.mark.few(1)
@pytest.mark.parametrize("choice", CHOICES.values(), ids=CHOICES)
def test_designs_are_their_single_runs(model, choice):
    batch = da.solve_dynamics(model, parameters={"l1": [*LENGTHS, *BAD]}, **RUN, **choice)
    alone = {name: value for name, value in choice.items() if name != "workers"}
    for k in (0, 3):
        single = da.solve_dynamics(model, parameters={"l1": LENGTHS[k]}, **RUN, **alone)
        same(batch, k, single, MEASURES)
    assert [s.outcome for s in batch.statuses[len(LENGTHS) :]] == OUTCOMES
    assert batch.succeeded.sum() == len(LENGTHS)
    assert np.isnan(batch.values("A.force")[len(LENGTHS) :]).all()


def test_neither_workers_nor_neighbours_change_a_number(model):
    """Lanes only the last digits of sines and cosines."""
    rng = np.random.default_rng(1)
    designs = {"l1": rng.uniform(0.2, 0.9, 13), "m2": rng.uniform(2, 8, 13)}
    motions = [
        da.solve_dynamics(model, parameters=designs, workers=w, backend=b, outputs=5, **RUN)
        for w, b in [(1, "jit"), (3, "jit"), (2, "vm")]
    ]
    fewer = {name: column[3:6] for name, column in designs.items()}
    part = da.solve_dynamics(model, parameters=fewer, backend="jit", outputs=5, **RUN)
    values = motions[0].values("A.force")
    np.testing.assert_array_equal(motions[1].values("A.force"), values)
    np.testing.assert_allclose(motions[2].values("A.force"), values, rtol=1e-11)
    np.testing.assert_array_equal(part.values("A.force"), values[3:6])


def test_all_forms_of_designs_mean_the_same(model):
    lengths, masses = [0.25, 0.4], [3.0, 4.0]
    forms = [
        {"l1": lengths, "m2": masses},
        np.column_stack([lengths, masses]),
        pd.DataFrame({"m2": masses, "l1": lengths}),
        [{"l1": a, "m2": b} for a, b in zip(lengths, masses, strict=True)],
    ]
    computed = [
        da.solve_dynamics(model, parameters=form, **RUN)["A.force"].values for form in forms
    ]
    for other in computed[1:]:
        np.testing.assert_array_equal(other, computed[0])


WRONG = {
    "lengths": ({"l1": [0.3, 0.4], "m2": [1.0, 2.0, 3.0]}, "one length: l1 has 2, m2 has 3"),
    "name": ({"l2": [0.3]}, "unknown parameter 'l2' .*; known: l1, m2"),
    "table": (np.ones((3, 5)), "a column for each of the 2 parameters"),
    "grid": ({"l1": np.ones((2, 2))}, "ravel"),
    "none": ([], "no design"),
    "empty": ({"l1": []}, "no design"),
    "text": ({"l1": ["a", "b"]}, "give name"),
    "rows": ([{"l1": 0.3}, {"m2": 1.0}], "design 0 gives no m2"),
}


@pytest.mark.parametrize(("parameters", "message"), WRONG.values(), ids=WRONG)
def test_wrong_designs_are_one_clear_message(model, parameters, message):
    with pytest.raises(da.AnalysisError, match=message):
        da.solve_dynamics(model, parameters=parameters, **RUN)


def test_errors_of_all_designs_are_raised(model):
    with pytest.raises(da.AnalysisError, match="duration is -1"):
        da.solve_dynamics(model, -1.0, parameters={"l1": LENGTHS})
    with pytest.raises(da.AnalysisError, match="workers is 0"):
        da.solve_dynamics(model, parameters={"l1": LENGTHS}, workers=0, **RUN)
    with pytest.raises(da.AnalysisError, match="the drivers leave"):
        da.solve_kinematics(model, 1.0, parameters={"l1": LENGTHS})


def test_designs_with_steps_of_their_own_have_common_outputs(model):
    controlled = {"integrator": da.DormandPrince(), "workers": 1}
    batch = da.solve_dynamics(model, 0.3, parameters={"l1": LENGTHS}, **controlled)
    assert batch.succeeded.all() and batch.time == pytest.approx(np.linspace(0, 0.3, 201))


def test_a_run_that_blows_up_is_marked_and_disturbs_nobody():
    system = da.System("mass on a spring")
    stiffness = system.parameter("k", 10.0)
    mass = system.add(planar.Body("mass", mass=1.0, inertia=1.0, position=(1.0, 0.0)))
    anchor, centre = system.ground.point(0.0, 0.0), mass.point(0.0, 0.0)
    system.add(planar.Spring("spring", anchor, centre, stiffness=stiffness, free_length=0.5))
    model, run = system.build(), {"duration": 5.0, "step": 0.02, "outputs": 11}
    batch = da.solve_dynamics(model, parameters={"k": [10.0, 1e6, 20.0]}, **run)
    for k, value in enumerate([10.0, 1e6, 20.0]):
        single = da.solve_dynamics(model, parameters={"k": value}, **run)
        assert batch.statuses[k].outcome is single.status.outcome
        assert batch.statuses[k].message == single.status.message
        if single.status.success:
            same(batch, k, single, ["mass.position"])
    assert batch.succeeded.tolist() == [True, False, True]


def test_in_space():
    system = da.System("top", gravity=(0.0, 0.0, -9.81))
    spin = system.parameter("spin", 100.0)
    arm = system.parameter("arm", 0.5)
    rotor = system.add(
        spatial.Body(
            "rotor",
            mass=2.0,
            inertia=(0.1, 0.1, 0.02),
            rotation=da.rotation.axis_angle((1, 0, 0), 0.4),
            angular_velocity=(0, 0, spin),
        )
    )
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor.point(0, 0, -1.0 * arm)))
    model = system.build()
    designs = {"spin": [50.0, 100.0, 150.0], "arm": [0.5, 0.6, 0.7]}
    batch = da.solve_dynamics(model, parameters=designs, duration=0.1, step=1e-3, outputs=5)
    assert FixedSteps.serves(batch.analysis, model)
    for k in range(3):
        one = {name: column[k] for name, column in designs.items()}
        single = da.solve_dynamics(model, parameters=one, duration=0.1, step=1e-3, outputs=5)
        same(batch, k, single, ["rotor.position", "rotor.euler_parameters", "O.force"])


def test_responses_of_all_designs(model):
    responses = [
        da.maximum("A.force_norm"),
        da.integral("crank.angle"),
        da.at(0.123, "crank.angle"),
        da.final("kinetic_energy"),
    ]
    batch = da.solve_dynamics(model, parameters={"l1": [*LENGTHS, *BAD]}, outputs=4, **RUN)
    table = da.evaluate(batch, responses)
    for response in responses:
        single = da.solve_dynamics(model, parameters={"l1": 0.5}, outputs=4, **RUN)
        expected = da.evaluate(single, response)
        computed = table[response.label]
        assert abs(float(computed[2]) - expected) <= 1e-12 * abs(expected)
        assert np.isnan(computed[len(LENGTHS) :]).all()
        np.testing.assert_array_equal(computed, da.evaluate(batch, response))


def test_a_design_alone_and_files(model, tmp_path):
    batch = da.solve_dynamics(model, parameters={"l1": [*LENGTHS, *BAD]}, outputs=4, **RUN)
    motion = batch[2]
    assert isinstance(motion, da.Motion)
    assert motion.parameters[0] == 0.5
    with pytest.raises(da.AnalysisError, match="cannot be assembled"):
        batch[len(LENGTHS)]
    with pytest.raises(da.AnalysisError, match="design 99"):
        batch[99]
    assert len(list(batch)) == len(LENGTHS)
    loaded = da.load_results(batch.save(tmp_path / "batch.nc"))
    np.testing.assert_array_equal(loaded["reaction_force"], batch.data["reaction_force"])
    assert loaded["status"].values.tolist() == [s.outcome.value for s in batch.statuses]
    assert loaded["l1"].dims == ("design",)
    frame = batch.to_dataframe("crank.angle")
    assert len(frame) == len(batch) * 4
    assert "5 completed" in repr(batch)
    assert "l1" in batch._repr_html_()


def test_interruption_keeps_what_is_finished(model):
    def stop(fraction: float) -> None:
        if fraction > 0.3:
            raise KeyboardInterrupt

    batch = da.solve_dynamics(
        model, parameters={"l1": np.linspace(0.2, 0.9, 30)}, progress=stop, workers=1, **RUN
    )
    assert 0 < batch.succeeded.sum() < 30
    assert {s.outcome for s in batch.statuses} == {Outcome.COMPLETED, Outcome.INTERRUPTED}


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("method", "choice"),
    [
        ("adjoint", {}),
        ("adjoint", {"backend": "jit", "outputs": 4}),
        ("direct", {"backend": "jit", "outputs": 4}),
        ("adjoint", {"integrator": da.DormandPrince(), "outputs": 4}),
    ],
    ids=["together", "in lanes", "direct in lanes", "one by one"],
)
def test_gradients_are_those_of_single_runs(model, method, choice):
    responses = [da.maximum("A.force_norm"), da.integral("crank.angle")]
    batch = da.solve_dynamics(model, parameters={"l1": [*LENGTHS, *BAD]}, **RUN, **choice)
    gradient = da.sensitivity(batch, responses, method=method)
    assert gradient.dims == ("design", "response", "parameter")
    assert np.isnan(gradient[len(LENGTHS) :]).all()
    for k in (0, 3):
        single = da.solve_dynamics(model, parameters={"l1": LENGTHS[k]}, **RUN, **choice)
        expected = da.sensitivity(single, responses, method=method)
        size = np.abs(expected.values).max(axis=1, keepdims=True)
        np.testing.assert_allclose(gradient[k] / size, expected.values / size, rtol=0, atol=1e-12)
        np.testing.assert_allclose(gradient.response_value[k], expected.response_value, rtol=1e-12)


def driven() -> da.Model:
    system = da.System("driven four-bar", gravity=(0.0, -9.81))
    a = system.parameter("a", 0.3)
    crank = system.add(planar.Bar("crank", length=a, mass=1.0, angle=1.5))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=1.0))
    rocker = system.add(planar.Bar("rocker", length=0.8, mass=1.0, angle=1.2))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.add(planar.RotationalDriver("drive", system.ground, crank, 1.5 + 6 * da.t))
    return system.build()


def hanging() -> da.Model:
    system = da.System("held pendulum", gravity=(0.0, -9.81))
    stiffness = system.parameter("k", 50.0)
    bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, angle=0.3))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    system.add(planar.TorsionSpring("hinge", system.ground, bar, stiffness=stiffness))
    return system.build()


def truss() -> da.StructuralModel:
    structure = da.Structure("two bars")
    area = structure.parameter("area", 1e-4)
    nodes = [structure.node(n, *at) for n, at in {"a": (0, 0), "b": (1, 0), "c": (0.5, 1)}.items()]
    for k, (i, j) in enumerate([(0, 2), (1, 2)]):
        structure.add(da.structures.Truss(f"bar{k}", nodes[i], nodes[j], modulus=2e11, area=area))
    structure.support(nodes[0])
    structure.support(nodes[1])
    structure.load(nodes[2], fy=-1000.0, case="weight")
    structure.load(nodes[2], fx=500.0, case="wind")
    return structure.build()


OTHERS = {
    "kinematics": (driven, da.solve_kinematics, {"duration": 1.0, "outputs": 21}, "rocker.angle"),
    "inverse dynamics": (
        driven,
        da.solve_inverse_dynamics,
        {"duration": 1.0, "step": 0.02},
        "drive.effort",
    ),
    "equilibrium": (hanging, da.solve_equilibrium, {}, "bar.angle"),
    "statics": (truss, da.solve_statics, {}, "c.uy"),
    "large displacements": (truss, da.solve_statics, {"nonlinear": True}, "c.uy"),
}
VALUES = {"a": [0.2, 0.3, 0.9], "k": [20.0, 40.0, 60.0], "area": [1e-4, -1.0, 2e-4]}


@pytest.mark.few(2)
@pytest.mark.parametrize(("build", "verb", "options", "measure"), OTHERS.values(), ids=OTHERS)
def test_other_analyses_take_designs(build, verb, options, measure, tmp_path):
    model = build()
    (name,) = model.parameters
    batch = verb(model, parameters={name: VALUES[name]}, **options)
    gradients = da.sensitivity(batch, da.maximum(measure))
    table = da.load_results(batch.save(tmp_path / "batch.nc", measure))
    for k, value in enumerate(VALUES[name]):
        if value < 0:
            with pytest.raises(da.ModelError) as error:
                verb(model, parameters={name: value}, **options)
            assert batch.statuses[k].message == str(error.value)
            continue
        single = verb(model, parameters={name: value}, **options)
        computed, expected = batch.statuses[k], single.status
        texts = [re.sub(r"residual \S+ N", "", s.message) for s in (computed, expected)]
        assert computed.outcome == expected.outcome and texts[0] == texts[1]
        assert abs(computed.residual - expected.residual) < 1e-12
        if single.status.success:
            wanted = single.values(measure)
            np.testing.assert_allclose(batch.values(measure)[k], wanted, rtol=1e-13)
            np.testing.assert_allclose(table[measure][k], wanted, rtol=1e-13)
            expected = da.sensitivity(single, da.maximum(measure))
            np.testing.assert_allclose(gradients[k], expected, rtol=1e-12)
    assert batch.succeeded[0]
    assert not batch.succeeded.all() or name == "k"
    assert batch.statistics.get("designs run on their own", 0) <= 1  # structures do not tell
