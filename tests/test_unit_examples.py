"""The example of coupled functional mock-up units, and its numbers."""

from __future__ import annotations

from pathlib import Path

import pytest
from example_runs import numbers, script

import dalembert as da


@pytest.mark.thorough
def test_coupled_units_converge_to_one_model(pictures: Path) -> None:
    """Signals of the start of a step: the error is of first order."""
    printed = numbers("fmu_control", pictures)
    errors = [printed[f"difference, coupled every {step:g} ms [rad/s]"] for step in (8, 4, 1)]
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
    assert printed["final speed [rad/s]"] == pytest.approx(
        printed["final speed in one model [rad/s]"], abs=2e-4
    )
    model, h = script("fmu_control").linkage(), 1e-4

    def acceleration(**values: float) -> float:
        motion = da.solve_dynamics(model, 1e-3, step=1e-3, parameters=values)
        return motion["crank.angular_acceleration"][0].item()

    by_torque = (acceleration(torque=h) - acceleration(torque=-h)) / (2 * h)
    by_length = (acceleration(length=0.3 + h) - acceleration(length=0.3 - h)) / (2 * h)
    assert printed["acceleration per torque [1/(kg m²)]"] == pytest.approx(by_torque, rel=1e-7)
    assert printed["acceleration per length [rad/(m s²)]"] == pytest.approx(by_length, rel=1e-5)
