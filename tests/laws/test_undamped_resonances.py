"""Undamped resonances: infinite amplitudes are reported, never numbers that depend on the grid."""

from __future__ import annotations

import json

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.errors import AnalysisError, SingularityError

PLACE = np.sqrt(100.0) / (2 * np.pi)


def oscillator(damping: float = 0.0) -> da.Model:
    """A mass on a spring with a force, and one that no input moves."""
    system = da.System("oscillator")
    push = system.input("push", unit="N")
    for name, stiffness in (("body", 100.0), ("idle", 144.0)):
        body = system.add(planar.Particle(name, mass=1.0, position=(0.5, 0)))
        system.add(planar.PinInSlot(f"rail_{name}", system.ground.center, body.center))
        ends, numbers = (system.ground.center, body.center), {"stiffness": stiffness}
        spring = planar.Spring(f"spring_{name}", *ends, damping=damping, free_length=0.5, **numbers)
        system.add(spring)
        if name == "body":
            system.add(planar.Force("force", body.center, (push, 0)))
    system.output("place", "body.x", unit="m")
    return system.build()


def beam(supported: bool = True) -> da.StructuralModel:
    """A beam of aluminium."""
    beam, count = da.Structure("beam"), 8
    nodes = [beam.node(f"n{k}", k / count, 0) for k in range(count + 1)]
    section = {"area": 4e-4, "second_moment": 1.333e-8, "modulus": 7e10, "density": 2700.0}
    for k in range(count):
        beam.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    if supported:
        beam.support(nodes[0])
    beam.load(nodes[count], case="push", fy=1.0)
    beam.output("place", f"n{count}.uy")
    return beam.build()


MODELS = {"mechanism": oscillator, "structure": beam}


def first_resonance(kind: str) -> float:
    return PLACE if kind == "mechanism" else da.solve_modes(beam(), 1).frequencies[0]


@pytest.mark.thorough
@pytest.mark.parametrize("kind", MODELS)
def test_default_frequencies_leave_them_out_and_warn(kind, tmp_path) -> None:
    response = da.frequency_response(MODELS[kind](), outputs=["place"])
    place = first_resonance(kind)
    (text,) = [w for w in response.warnings if "no damping acts" in w]
    assert f"{place:.6g} Hz" in text and (
        kind == "structure" or f"{12 / 2 / np.pi:.6g}" not in text
    )
    (first, height), *_ = response.peaks("place")
    assert first == pytest.approx(place, rel=1e-9) and height == np.inf
    assert response.summary()["states"][0]["highest peak"] == np.inf
    assert response.report(tmp_path / "page.html").stat().st_size > 50_000
    for measure in (da.maximum("place.amplitude"), da.peak(1, "place.amplitude")):
        with pytest.raises(SingularityError, match=r"infinite at .* no damping acts"):
            da.evaluate(response, measure)
    below = da.frequency_response(MODELS[kind](), place * np.linspace(0.1, 0.9, 9))
    assert not below.warnings
    top = da.evaluate(below, da.maximum("place.amplitude"))
    assert top == pytest.approx(below.values("place.amplitude")[-1])


@pytest.mark.parametrize("kind", MODELS)
@pytest.mark.parametrize("method", ["direct", "modal"])
def test_close_to_a_resonance_the_response_is_exact(kind, method) -> None:
    """``H ≈ φ_o φ_i/(ω_1² − ω²)`` near the resonance; at it an error that names the frequency."""
    model, place = MODELS[kind](), first_resonance(kind)
    options = {"outputs": ["place"], "method": method}
    share = 1.0
    if kind == "structure":
        far = da.frequency_response(model, [place * (1 + 1e-4)], **options)["place"].values[0]
        share = abs(far) * abs(1 - (1 + 1e-4) ** 2) * (2 * np.pi * place) ** 2
    for distance in (1e-5, -1e-6, 1e-7):
        h = da.frequency_response(model, [place * (1 + distance)], **options)["place"].values[0]
        expected = share / (1 - (1 + distance) ** 2) / (2 * np.pi * place) ** 2
        assert h.real == pytest.approx(expected, rel=1e-4 if kind == "structure" else 1e-7)
    with pytest.raises(SingularityError, match="no finite response"):
        da.frequency_response(model, [place], **options)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", MODELS)
def test_mean_squares_are_infinite(kind) -> None:
    model, place = MODELS[kind](), first_resonance(kind)
    vibration = da.RandomResponse(psd={"push": 1.0}, outputs=["place"]).run(model)
    assert vibration.rms("place") == np.inf
    below = da.RandomResponse(psd={"push": 1.0}, outputs=["place"], band=(0.0, 0.9 * place))
    assert np.isfinite(below.run(model).rms("place"))
    with pytest.raises(AnalysisError, match=r"no damping acts|no finite response"):
        da.evaluate(vibration, da.random_rms("place"))
    if kind == "mechanism":  # no input moves it
        assert vibration.rms("idle.x") < 1e-12


def test_light_damping_is_finite() -> None:
    response = da.frequency_response(oscillator(1e-6), outputs=["place"])
    assert not response.warnings
    ratio = 1e-6 / 20
    top = da.evaluate(response, da.maximum("place.amplitude"))
    assert top == pytest.approx(1 / (100 * 2 * ratio), rel=1e-6)


def test_rigid_motions_of_a_free_beam() -> None:
    """Receptance of the end at low frequencies, ``−4/(m ω²)``; resonances are those of bending."""
    model = beam(supported=False)
    response = da.frequency_response(model, loss_factor=0.01)
    bending = 22.3733 / (2 * np.pi) * np.sqrt(7e10 * 1.333e-8 / (2700.0 * 4e-4))
    (first, _), *_ = response.peaks("place")
    assert first == pytest.approx(bending, rel=1e-3)
    slow = da.frequency_response(model, [1e-2, 1e-1], loss_factor=0.01)
    rigid = -4 / (2700.0 * 4e-4 * slow.omega**2)
    np.testing.assert_allclose(slow["place"].values.real, rigid, rtol=1e-4)
    modal = da.frequency_response(model, [0.1, 30.0], loss_factor=0.01, method="modal", count=27)
    direct = da.frequency_response(model, [0.1, 30.0], loss_factor=0.01)
    np.testing.assert_allclose(modal["place"].values, direct["place"].values, rtol=1e-6)


def test_infinite_peaks_are_written_as_json(tmp_path, capsys) -> None:
    from dalembert.cli import main

    text = """
format = 1
[inputs]
push = {value = 0, unit = "N"}
[bodies.body]
type = "Particle"
mass = 1.0
position = [0.5, 0]
[joints.rail]
type = "PinInSlot"
connect = ["ground", "body"]
[forces.spring]
type = "Spring"
connect = ["ground", "body"]
stiffness = 100
free_length = 0.5
[forces.drive]
type = "Force"
connect = ["body"]
vector = ["push", 0]
[outputs]
place = "body.x"
[analysis]
type = "FrequencyResponse"
"""
    path = tmp_path / "undamped.toml"
    path.write_text(text, encoding="utf-8")
    assert main(["run", str(path), "--output", str(tmp_path), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out, parse_constant=lambda name: name)
    (row,) = summary["states"]
    assert row["highest peak"] in (None, "inf", "Infinity")
    assert any("no damping acts" in text for text in summary["warnings"])
