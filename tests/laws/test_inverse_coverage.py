"""Intervals of inverse problems hold the truth as often as stated, over many repetitions."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.signal import cont2discrete

import dalembert as da
from dalembert import planar
from dalembert.design.inverse.input_history import InputHistory
from dalembert.design.inverse.invert import _covariance, _RegularisedProblem

TIMES = np.linspace(0, 2, 101)
KNOTS = np.linspace(0, 2, 17)
FINE = np.linspace(0, 2, 2001)
REPETITIONS = 200


def responses(values: np.ndarray) -> np.ndarray:
    """Displacements of an oscillator (2 kg, 1 N s/m, 30 N/m) under forces at ``FINE``: NumPy twin.

    The forces are linear between their samples.
    """
    a, b = np.array([[0, 1], [-15, -0.5]]), np.array([[0], [0.5]])
    ad, bd, c, d, _ = cont2discrete((a, b, np.eye(1, 2), [[0]]), FINE[1], method="foh")
    x, results = np.zeros((2, values.shape[1])), []
    for force in values:
        results.append(c @ x + d * force)
        x = ad @ x + bd * force
    return np.array(results)[:: (FINE.size - 1) // (TIMES.size - 1), 0]


BASIS = CubicSpline(KNOTS, np.eye(KNOTS.size))
PUSH = responses(BASIS(FINE))
"""(samples, knots) displacements by the force of each knot."""


class Linear:
    """A linear misfit, its least squares, and the interface of both."""

    interrupted = False

    def __init__(self, matrix: np.ndarray, data: np.ndarray):
        self.matrix, self.data, self.misfit = matrix, data, self
        self.penalty = np.zeros((0, matrix.shape[1])), np.zeros(0)

    def jacobian(self, _x):
        return self.matrix

    def residual(self, x):
        return self.matrix @ x - self.data

    def solve(self, _x):
        rows, aims = self.penalty
        both = np.vstack([self.matrix, rows]), np.r_[self.data, aims]
        return SimpleNamespace(x=np.linalg.lstsq(*both, rcond=None)[0])


def blocks(count: int, order: int) -> list[np.ndarray]:
    rough = InputHistory("f", KNOTS, (), None).roughness(order)
    return [np.kron(np.eye(count)[k : k + 1], rough) for k in range(count)]


def coverage(matrix, exact, wanted, noise, order=2, seen=None, **more) -> tuple[np.ndarray, list]:
    """Whether each interval holds the truth, repetition by repetition, and the errors raised."""
    rng, held, failed = np.random.default_rng(3), [], []
    seen = np.eye(matrix.shape[1]) if seen is None else seen
    rough = blocks(matrix.shape[1] // KNOTS.size, order)
    for _ in range(REPETITIONS):
        data = exact + noise * rng.normal(size=exact.size)
        noise_known = more.get("noise_known", False)
        level = noise if noise_known else 1e-3
        problem = Linear(matrix / level, data / level)
        chosen = _RegularisedProblem(
            problem, rough, more.get("smoothing", "likelihood"), noise_known
        )
        try:
            fit, mu, _ = chosen.solve(np.zeros(matrix.shape[1]))
        except da.AnalysisError as error:
            failed.append(error)
            continue
        spread = _covariance(problem.matrix, problem.residual(fit.x), fit.x, mu, chosen)
        deviation = np.sqrt(np.einsum("ki,ij,kj->k", seen, spread, seen))
        held.append(abs(seen @ fit.x - wanted) < 1.96 * deviation)
    return np.array(held), failed


FORCES = {
    "smooth": (lambda t: 8 * np.sin(2.5 * t) + 4 * t, 2, 0.95),
    "pulse": (lambda t: 10 * np.exp(-(((t - 1) / 0.2) ** 2)), 2, 0.93),
    "constant": (lambda t: 3 + 0 * t, 2, 0.92),
    "step": (lambda t: 5.0 * (t > 0.8), 1, 0.9),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FORCES)
def test_forces(name):
    force, order, least = FORCES[name]
    exact = responses(force(FINE)[:, None])[:, 0]
    held, _ = coverage(PUSH, exact, force(KNOTS), 2e-3, order, noise_known=name == "smooth")
    assert held.mean() > least


@pytest.mark.thorough
def test_forces_of_different_size():
    """1,000 N and 1 N m, each seen by a sensor of its own kind; one is rough, one is smooth."""
    first = 1e3 * np.sin(7 * FINE)
    second = 1 + 0.5 * FINE
    exact = np.concatenate(
        [responses(f[:, None])[:, 0] * s for f, s in ((first, 1e-3), (second, 1))]
    )
    zero = np.zeros_like(PUSH)
    matrix = np.block([[1e-3 * PUSH, zero], [zero, PUSH]])
    wanted = np.r_[1e3 * np.sin(7 * KNOTS), 1 + 0.5 * KNOTS]
    held = coverage(matrix, exact, wanted, 5e-4)[0].mean(axis=0)
    assert held[:17].mean() > 0.92 and held[17:].mean() > 0.92


def test_accelerations_of_a_measured_drive():
    """The second derivative of a measured angle, which is what joint forces follow from."""
    matrix, inside = BASIS(TIMES), TIMES[5:-5]
    held, _ = coverage(
        *(matrix, np.sin(3 * TIMES) + TIMES**2, 2 - 9 * np.sin(3 * inside), 2e-3),
        order=3,
        seen=BASIS(inside, 2),
    )
    assert held.mean() > 0.92


def test_the_true_noise_is_no_error():
    """Discrepancy: residuals scatter about the noise, so that half of them exceed it."""
    force = FORCES["smooth"][0]
    exact = responses(force(FINE)[:, None])[:, 0]
    _, failed = coverage(PUSH, exact, force(KNOTS), 2e-3, smoothing="discrepancy", noise_known=True)
    assert len(failed) <= 1


def test_bands_of_joint_forces():
    """The force of a drive, ``m s̈``, from its measured path: intervals that hold the truth."""
    system = da.System("slide")
    way = da.input_history(system, "way", np.linspace(0, 1, 25), unit="m")
    mass = system.add(planar.Particle("mass", mass=2.0))
    system.add(planar.CoordinateDriver("guide", mass.center, 0.0, direction=(0, 1)))
    system.add(planar.CoordinateDriver("motor", mass.center, way.law, direction=(1, 0)))
    model, times = system.build(), np.linspace(0, 1, 41)
    share = []
    for seed in range(4):
        noise = 1e-4 * np.random.default_rng(seed).normal(size=41)
        data = {"t": times, "mass.x": np.sin(3 * times) + noise}
        paths = da.Kinematics(1.0, outputs=41)
        inversion = da.invert(model, data, histories=[way], analysis=paths, order=3)
        band = inversion.band("motor.effort", da.InverseDynamics(1.0, outputs=41))
        low, high = band.interval.T
        exact = -18 * np.sin(3 * band.time)
        share.append(np.mean((low < exact) & (exact < high)))
    assert np.mean(share) > 0.9 and band.deviation.max() < 2
    assert (
        inversion.summary()["histories"]["way"]["interval"] == inversion.intervals["way"].tolist()
    )
