"""Laws of measures of harmonic responses, and of batches of them."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

FREQUENCIES = [0.5, 1.0, 2.0, 3.0]


def chain() -> da.Model:
    """Two masses in a row, each with a force."""
    system = da.System("chain")
    damping = system.parameter("damping", 0.8, bounds=(0.1, 5))
    previous = system.ground.center
    for k in range(2):
        push = system.input(f"push{k}", unit="N")
        body = system.add(planar.Particle(f"m{k}", mass=1.0 + k, position=(0.5 * (k + 1), 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        spring = {"stiffness": 500.0 - 90 * k, "damping": damping, "free_length": 0.5}
        system.add(planar.Spring(f"s{k}", previous, body.center, **spring))
        system.add(planar.Force(f"f{k}", body.center, (push, 0)))
        previous = body.center
    system.output("gap", "m1.x - m0.x", unit="m")
    return system.build()


MODEL = chain()
GAP = MODEL.expression("m1.x") - MODEL.expression("m0.x")
FORMS = {"declared": "gap", "formula": "m1.x - m0.x", "expression": GAP}


@pytest.mark.thorough
@pytest.mark.parametrize("form", FORMS)
def test_outputs_of_any_form_have_all_outputs(form, tmp_path) -> None:
    """Names, formulas and expressions in tables, files, pages, pictures and gradients."""
    options = {"inputs": ["push0"], "outputs": [FORMS[form]]}
    response = da.frequency_response(MODEL, **options)
    (name,) = response.outputs
    parts = da.frequency_response(MODEL, response.frequencies, inputs=["push0"], outputs=["m0.x"])
    expected = parts["m1.x"].values - parts["m0.x"].values
    np.testing.assert_allclose(response[name].values, expected, rtol=1e-11)
    measure = response.keys()[0]
    np.testing.assert_allclose(response.values(measure), np.abs(expected), rtol=1e-11)
    assert len(response.peaks(name)) == 2 == len(response.summary()["states"]) + 1
    response.save(tmp_path / "response.nc")
    assert response.report(tmp_path / "page.html").stat().st_size > 50_000
    assert response.plot() is not None
    certificate = da.sensitivity(response, da.at(1.0, measure), certificate=True).attrs
    assert certificate["certificate"].passed
    vibration = da.RandomResponse(psd={"push0": 2.0}, outputs=[FORMS[form]]).run(MODEL)
    density = np.interp(response.frequencies, vibration.frequencies, vibration.psd(name))
    np.testing.assert_allclose(density, 2 * np.abs(expected) ** 2, rtol=1e-9)
    assert vibration.to_dataframe().shape[1] == 3
    assert vibration.plot() is not None and vibration.report(tmp_path / "page.html").exists()


def test_formulas_of_several_parts() -> None:
    response = da.frequency_response(MODEL, FREQUENCIES, inputs=["push0"], outputs=["m0.x"])
    h, g = response["m0.x"].values, response["gap"].values
    formula = "m0.x.amplitude*m0.x.real/gap.amplitude + (m1.x - m0.x).imag*damping"
    with pytest.raises(da.ExpressionError):  # brackets are for whole measures
        response.values(formula)
    values = response.values(formula.replace("(m1.x - m0.x)", "gap"))
    np.testing.assert_allclose(values, np.abs(h) * h.real / np.abs(g) + g.imag * 0.8, rtol=1e-12)
    np.testing.assert_allclose(response["(m1.x - m0.x).phase"], np.angle(g), rtol=1e-12)
    np.testing.assert_allclose(response["m1.x - m0.x"].values, g, rtol=1e-12)
    np.testing.assert_allclose(response[GAP].values, g, rtol=1e-12)
    product = da.at(1.0, "m0.x.amplitude*m0.x.real")
    certificate = da.sensitivity(response, product, certificate=True).attrs["certificate"]
    assert certificate.passed
    with pytest.raises(da.AnalysisError, match=r"complex: take response\[measure\]"):
        response.values(GAP)
    with pytest.raises(da.UnknownNameError, match="unknown name 't'"):
        response.values("t*m0.x.amplitude")


def test_formulas_of_densities() -> None:
    vibration = da.RandomResponse(psd={"push0": 2.0, "push1": 1.0}, outputs=["gap"]).run(MODEL)
    ratio = vibration["m1.x.psd/m0.x.psd"].values
    np.testing.assert_allclose(ratio, vibration.psd("m1.x") / vibration.psd("m0.x"), rtol=1e-12)
    difference = vibration.rms("m1.x - m0.x")
    assert difference == pytest.approx(vibration.rms("gap"), rel=1e-12)
    response = da.random_rms("m1.x - m0.x")
    assert da.evaluate(vibration, response) == pytest.approx(difference, rel=1e-12)


@pytest.mark.thorough
def test_batches_are_single_responses(tmp_path) -> None:
    values = [0.4, 0.8, 2.0]
    options = {"inputs": ["push0"], "outputs": ["gap"]}
    batch = da.frequency_response(MODEL, FREQUENCIES, parameters={"damping": values}, **options)
    responses = [da.maximum("gap.amplitude"), da.at(2.0, "gap.phase")]
    table = da.evaluate(batch, responses)
    gradients = da.sensitivity(batch, responses)
    for k, damping in enumerate(values):
        single = da.frequency_response(
            MODEL, FREQUENCIES, parameters={"damping": damping}, **options
        )
        assert np.array_equal(batch["gap"].values[k], single["gap"].values)
        assert np.array_equal(batch["gap.amplitude"].values[k], single["gap.amplitude"].values)
        for response in responses:
            assert table[response.label].values[k] == da.evaluate(single, response)
        np.testing.assert_allclose(gradients.values[k], da.sensitivity(single, responses).values)
    assert batch["gap"].dims == ("design", "frequency")
    assert da.load_results(batch.save(tmp_path / "batch.nc"))["amplitude"].shape == (3, 4, 1, 1)
    assert list(batch) and batch[1].parameters[0] == 0.8
    with pytest.raises(da.AnalysisError, match=r"give the batch frequencies="):
        da.frequency_response(MODEL, parameters={"damping": values}, **options)


def test_studies_of_frequency_and_random_responses() -> None:
    table = da.DesignTable.table({"damping": [0.4, 2.0]})
    harmonic = da.FrequencyResponse(inputs=["push0"], outputs=["gap"])
    random = da.RandomResponse(psd={"push0": 2.0}, outputs=["gap"])
    for analysis, response in (
        (harmonic, da.peak(2, "gap.amplitude")),
        (random, da.random_rms("gap")),
        (random, da.random_rms("m1.x - m0.x")),
    ):
        study = da.sweep(MODEL, table, analysis=analysis, responses=response, workers=1)
        for k, damping in enumerate((0.4, 2.0)):
            single = analysis.run(MODEL, {"damping": damping})
            assert study.values[k, 0] == pytest.approx(da.evaluate(single, response), rel=1e-12)
    study = da.sweep(MODEL, table, analysis=harmonic, responses=da.peak(5, "gap.amplitude"))
    assert np.isnan(study.values).all() and "no peak number 5" in study.reasons[0]


def test_parts_are_no_outputs() -> None:
    with pytest.raises(da.AnalysisError, match=r"part of a complex amplitude.*outputs=\['gap'\]"):
        da.frequency_response(MODEL, outputs=["gap.amplitude"])
