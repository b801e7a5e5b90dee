"""Random vibration under correlated inputs, by matrices written by hand."""

from __future__ import annotations

import functools
import json

import numpy as np
import pytest
from scipy.integrate import simpson
from scipy.linalg import solve_continuous_lyapunov

import dalembert as da
from dalembert import planar
from dalembert.cli import main

MASS = np.diag([1.0, 2.0])
STIFFNESS = np.array([[910.0, -410.0], [-410.0, 410.0]])
DAMPING = np.array([[1.7, -0.9], [-0.9, 0.9]])
OUTPUTS = ["m0.x", "m1.x", "m1.vx"]


@functools.cache
def chain() -> da.Model:
    """Two masses in a row, each with a force."""
    system = da.System("chain")
    damping = system.parameter("damping", 0.8, bounds=(0.1, 5))
    previous = system.ground.center
    for k in range(2):
        push = system.input(f"push{k}", unit="N")
        body = system.add(planar.Particle(f"m{k}", mass=1.0 + k, position=(0.5 * (k + 1), 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        spring = {"stiffness": 500.0 - 90 * k, "damping": damping + 0.1 * k, "free_length": 0.5}
        system.add(planar.Spring(f"s{k}", previous, body.center, **spring))
        system.add(planar.Force(f"f{k}", body.center, (push, 0)))
        previous = body.center
    return system.build()


def receptance(frequencies: np.ndarray) -> np.ndarray:
    """(K, outputs, inputs) of displacements and of the second speed."""
    s = 2j * np.pi * frequencies[:, None, None]
    h = np.linalg.inv(MASS * s**2 + DAMPING * s + STIFFNESS)
    return np.concatenate([h, s * h[:, 1:]], axis=1)


@pytest.mark.parametrize("cross", [0.0, 0.6, -np.sqrt(3.0)])
def test_correlated_white_noise_by_the_lyapunov_equation(cross) -> None:
    psd = {"push0": 2.0, "push1": 1.5, ("push0", "push1"): cross}
    vibration = da.RandomResponse(psd=psd, outputs=OUTPUTS).run(chain())
    inverse = np.linalg.inv(MASS)
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ STIFFNESS, -inverse @ DAMPING]])
    b = np.vstack([np.zeros((2, 2)), inverse])
    intensity = np.array([[2.0, cross], [cross, 1.5]]) / 2  # two-sided
    covariance = solve_continuous_lyapunov(a, -b @ intensity @ b.T)
    exact = np.sqrt(np.diag(covariance)[[0, 1, 3]])
    np.testing.assert_allclose([vibration.rms(name) for name in OUTPUTS], exact, rtol=1e-11)


CROSS = {
    "complex": (0.6 - 0.9j, lambda f: np.full(f.size, 0.6 - 0.9j)),
    "formula": ("0.5*exp(-f/5)", lambda f: 0.5 * np.exp(-f / 5)),
    "function": (lambda f: 1j * np.exp(-f), lambda f: 1j * np.exp(-f)),
    "parts": ({"real": "cos(f)", "imag": -0.3}, lambda f: np.cos(f) - 0.3j),
    "delay": (
        {"coherence": 0.8, "delay": 0.21},
        lambda f: np.sqrt(0.8 * 2.0 * 1.5) * np.exp(-2j * np.pi * f * 0.21),
    ),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", CROSS)
def test_densities_and_mean_squares(kind) -> None:
    """``S_y = H* S Hᵀ``; the mean square by Simpson's rule over a fine grid."""
    entry, values = CROSS[kind]
    psd = {"push0": 2.0, "push1": 1.5, ("push0", "push1"): entry}
    vibration = da.RandomResponse(psd=psd, outputs=OUTPUTS, band=(0.05, 20.0)).run(chain())
    swapped = psd | {("push1", "push0"): lambda f: np.conj(values(f))}
    del swapped["push0", "push1"]
    other = da.RandomResponse(psd=swapped, outputs=OUTPUTS, band=(0.05, 20.0)).run(chain())

    def exact(f: np.ndarray) -> np.ndarray:
        h, matrix = receptance(f), np.empty((f.size, 2, 2), complex)
        matrix[:, 0, 0], matrix[:, 1, 1] = 2.0, 1.5
        matrix[:, 0, 1], matrix[:, 1, 0] = values(f), np.conj(values(f))
        return np.einsum("koi,kij,koj->ok", h.conj(), matrix, h).real

    densities = np.array([vibration.psd(name) for name in OUTPUTS])
    expected = exact(vibration.frequencies)
    np.testing.assert_allclose(densities, expected, rtol=1e-10)
    grid = np.linspace(0.05, 20.0, 80_001)
    rms = np.sqrt(simpson(exact(grid), x=grid))
    np.testing.assert_allclose([vibration.rms(name) for name in OUTPUTS], rms, rtol=1e-9)
    np.testing.assert_allclose([other.rms(name) for name in OUTPUTS], rms, rtol=1e-9)
    certificate = da.sensitivity(vibration, da.random_rms("m1.x"), certificate=True).attrs
    assert certificate["certificate"].passed


WRONG = [
    ({("push0", "push1"): 1.8}, r"psd\[push0, push1\] has the magnitude 1.8 .* 1.73205"),
    ({("push0", "pusch"): 1}, r"psd\[push0, pusch\] needs psd.pusch"),
    ({("push0", "push0"): 1}, "cross density, \\('a', 'b'\\)"),
    ({("push0", "push1"): None}, r"psd\[push0, push1\] is None; give a number"),
    ({"push0, push1": {"delay": 0.1}}, r"has a delay.*give band="),
    ({"push0, push1": {"delays": 0.1}}, r"psd\[push0, push1\] is \{'delays"),
    ({"push0, push1": 1, ("push1", "push0"): 1}, "twice"),
    ({"push0, push1": {"coherence": 1.2}}, "between 0 and 1"),
]


@pytest.mark.parametrize(("more", "message"), WRONG)
def test_wrong_densities_are_named(more, message) -> None:
    psd = {"push0": 2.0, "push1": 1.5} | more
    with pytest.raises(da.AnalysisError, match=message):
        da.RandomResponse(psd=psd, outputs=OUTPUTS).run(chain()).psd("m0.x")


def test_three_inputs_that_contradict_each_other() -> None:
    """Two perfect correlations and a contradicting third one."""
    system = da.System("mass")
    body = system.add(planar.Particle("body", mass=1.0, position=(1, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    ends = system.ground.center, body.center
    system.add(planar.Spring("spring", *ends, stiffness=10.0, damping=1.0, free_length=1.0))
    pushes = [system.input(f"p{k}", unit="N") for k in range(3)]
    system.add(planar.Force("force", body.center, (sum(pushes[1:], pushes[0]), 0)))
    own = {"p0": 1.0, "p1": 1.0, "p2": 1.0}
    cross = {("p0", "p1"): 0.9, ("p1", "p2"): 0.9, ("p0", "p2"): -0.9}
    model = system.build()
    with pytest.raises(da.AnalysisError, match="contradict each other"):
        da.RandomResponse(psd=own | cross, outputs=["body.x"]).run(model).psd("body.x")
    together = dict.fromkeys(cross, 1.0)
    rms = da.RandomResponse(psd=own | together, outputs=["body.x"]).run(model).rms("body.x")
    assert rms**2 == pytest.approx(9 / (4 * 1.0 * 10.0), rel=1e-10)  # of thrice the force


@pytest.mark.thorough
def test_files_have_cross_densities(tmp_path, capsys) -> None:
    text = """
format = 1
[inputs]
left = {value = 0, unit = "N"}
right = {value = 0, unit = "N"}
[bodies.body]
type = "Particle"
mass = 1.0
position = [1, 0]
[joints.rail]
type = "PinInSlot"
connect = ["ground", "body"]
[forces.spring]
type = "Spring"
connect = ["ground", "body"]
stiffness = 10
damping = 1
free_length = 1
[forces.push]
type = "Force"
connect = ["body"]
vector = ["left + right", 0]
[outputs]
place = "body.x"
[analysis]
type = "RandomResponse"
psd = { left = 1, right = 1, "left, right" = CROSS }
"""
    path = tmp_path / "noise.toml"
    for entry, share in (("0.5", 3.0), ("{ real = -0.5 }", 1.0), ("{ coherence = 0.25 }", 3.0)):
        path.write_text(text.replace("CROSS", entry), encoding="utf-8")
        assert main(["run", str(path), "--output", str(tmp_path), "--json"]) == 0
        (row,) = json.loads(capsys.readouterr().out)["states"]
        assert row["root mean square"] == pytest.approx(np.sqrt(share / 40), rel=1e-9)
    path.write_text(text.replace("CROSS", "{ coherense = 0.25 }"), encoding="utf-8")
    assert main(["run", str(path), "--output", str(tmp_path)]) == 2
    assert "coherense" in capsys.readouterr().err
