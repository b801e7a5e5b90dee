"""Strategies that cannot work are one clear message of both commands."""

from __future__ import annotations

import pytest
from good_model import edited

from dalembert.cli import main

# (keys of [analysis], words the message must have)
CHOICES: dict[str, tuple[str, list[str]]] = {
    "basis unknown": (
        'formulation = { type = "NullSpace", basis = "foo" }',
        ["analysis.formulation", "'foo'", "gram-schmidt"],
    ),
    "basis a number": (
        'formulation = { type = "NullSpace", basis = 3 }',
        ["analysis.formulation.basis", "text in quotes", "3"],
    ),
    "index out of range": (
        'formulation = { type = "DAE", index = 4 }',
        ["analysis.formulation", "index=4", "3 (positions)"],
    ),
    "index not whole": (
        'formulation = { type = "DAE", index = 2.5 }',
        ["analysis.formulation.index", "whole number", "2.5"],
    ),
    "index 3 stabilised": (
        'formulation = { type = "DAE", stabilized = true }',
        ["analysis.formulation", "DAE(index=2, stabilized=True)"],
    ),
    "strategy without type": (
        'formulation = { basis = "qr" }',
        ["analysis.formulation", "type is missing", "NullSpace"],
    ),
    "strategy of another kind": (
        'formulation = "RK4"',
        ["analysis.formulation", "'RK4'", "known: RangeSpace"],
    ),
    "strategy a list": ('integrator = ["RK4"]', ["analysis.integrator", "name", "['RK4']"]),
    "partition unknown": (
        'formulation = { type = "VelocityPartitioning", independent = ["disc.angel"] }',
        ["analysis.formulation", "'disc.angel'", "disc.angle"],
    ),
    "partition too large": (
        'formulation = { type = "VelocityPartitioning", independent = ["disc.x", "disc.y"] }',
        ["analysis.formulation", "1 independent", "2 are named"],
    ),
    "partition a text": (
        'formulation = { type = "VelocityPartitioning", independent = "disc.x" }',
        ["analysis.formulation.independent", "list", "'disc.x'"],
    ),
    "penalty undamped": (
        'formulation = { type = "Penalty", eta = 1 }',
        ["analysis.formulation", "eta=1", "at least omega"],
    ),
    "iterations none": (
        'formulation = { type = "AugmentedLagrangian", iterations = 0 }',
        ["analysis.formulation", "iterations=0", "at least 1"],
    ),
    "coordinates unknown": (
        'coordinates = "JointCoordinate"',
        ["analysis.coordinates", "did you mean 'JointCoordinates'"],
    ),
    "cut unknown": (
        'coordinates = { type = "JointCoordinates", cut = ["nope"] }',
        ["analysis.coordinates", "'nope'", "A, B"],
    ),
    "angles unknown": (
        'coordinates = { type = "JointCoordinates", angles = "foo" }',
        ["analysis.coordinates", "'foo'", "'relative'"],
    ),
    "spectral radius": (
        'integrator = { type = "GeneralizedAlpha", rho_inf = 2 }',
        ["analysis.integrator", "rho_inf=2", "between 0 and 1"],
    ),
    "tolerance negative": (
        'integrator = { type = "Radau", rtol = -1e-3 }',
        ["analysis.integrator", "rtol=-0.001", "positive"],
    ),
    "tolerance a word": (
        'integrator = { type = "BDF", rtol = "small" }',
        ["analysis.integrator.rtol", "'small'", "number"],
    ),
    "order out of range": (
        'integrator = { type = "BDF", max_order = 9 }',
        ["analysis.integrator", "max_order=9", "1, 2, 3, 4 or 5"],
    ),
    "order of another name": (
        'integrator = { type = "BDF", order = 3 }',
        ["analysis.integrator.order", "did you mean 'max_order'"],
    ),
    "projection never": (
        'stabilization = { type = "Projection", every = 0 }',
        ["analysis.stabilization", "every=0", "at least 1"],
    ),
    "DAE explicit": (
        'formulation = "DAE"',
        ["analysis.integrator: RK4", "explicit", "Radau()", "RangeSpace()"],
    ),
    "DAE with Baumgarte": (
        'formulation = "DAE"\nstabilization = "Baumgarte"\nintegrator = "Radau"',
        ["analysis.stabilization: DAE(index=3)", "Projection()"],
    ),
    "DAE with Baumgarte, explicit": (
        'formulation = "DAE"\nstabilization = "Baumgarte"',
        ["analysis.stabilization: DAE(index=3)", "Projection()"],
    ),
    "DAE with IDA": (
        'formulation = "DAE"\nintegrator = "IDA"',
        ["analysis.integrator: IDA", "index 3", "DAE(index=1)"],
    ),
    "DAE with CVODES": (
        'formulation = "DAE"\nintegrator = "CVODES"',
        ["analysis.integrator: CVODES", "Radau()"],
    ),
    "iterated and implicit": (
        'formulation = "AugmentedLagrangian"\nintegrator = "Radau"',
        ["analysis.integrator: AugmentedLagrangian", "RK4()"],
    ),
    "partition with Baumgarte": (
        'formulation = "VelocityPartitioning"\nstabilization = "Baumgarte"',
        ["analysis.stabilization: VelocityPartitioning", "Projection()"],
    ),
    "energy with driver": (
        'stabilization = "EnergyProjection"',
        ["analysis.integrator: EnergyProjection", "driver", "Projection()"],
    ),
}


@pytest.mark.product
@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("case", CHOICES, ids=[name.replace(" ", "-") for name in CHOICES])
def test_choices_that_cannot_work(case, command, tmp_path, capsys):
    """Both commands say the same, and neither leaves anything behind."""
    keys, words = CHOICES[case]
    source, out = tmp_path / "wrong.toml", tmp_path / "out"
    source.write_text(edited("step = 0.01", f"step = 0.01\n{keys}"), encoding="utf-8")
    assert main([command, str(source), *(["--output", str(out)] if command == "run" else [])]) == 2
    output = capsys.readouterr()
    assert output.err.startswith(f"Error: {source}: ")
    for word in words:
        assert word in output.err, output.err
    assert len(output.err.splitlines()) == 1
    assert not output.out
    assert not out.exists()


def test_null_space_by_svd_is_for_few_bodies(tmp_path, capsys):
    bars = "".join(
        f'[bodies.bar{k}]\ntype = "Bar"\nlength = 1.0\nmass = 1.0\nangle = 0.{k}\n'
        f'[joints.pin{k}]\ntype = "Revolute"\n'
        f'connect = ["{f"bar{k - 1}.end" if k else "ground"}", "bar{k}.start"]\n'
        for k in range(5)
    )
    source = tmp_path / "long.toml"
    choice = 'formulation = { type = "NullSpace", basis = "svd" }'
    source.write_text(
        f'format = 1\n{bars}[analysis]\ntype = "Dynamics"\nduration = 1.0\n{choice}\n',
        encoding="utf-8",
    )
    assert main(["check", str(source)]) == 2
    message = capsys.readouterr().err
    for word in (str(source), "analysis.formulation", "15 speeds", "up to 12", "basis='qr'"):
        assert word in message, message


def test_a_run_that_cannot_begin_is_told_with_its_place(tmp_path, capsys):
    """A level pendulum: its centre has no speed along x, which therefore gives no other speed."""
    source, out = tmp_path / "level.toml", tmp_path / "out"
    source.write_text(
        'format = 1\n[bodies.bar]\ntype = "Bar"\nlength = 1.0\nmass = 1.0\nangle = 0.0\n'
        '[joints.pin]\ntype = "Revolute"\nconnect = ["ground", "bar.start"]\n'
        '[analysis]\ntype = "Dynamics"\nduration = 1.0\n'
        'formulation = { type = "VelocityPartitioning", independent = ["bar.x"] }\n',
        encoding="utf-8",
    )
    assert main(["check", str(source)]) == 0  # another start would do
    capsys.readouterr()
    assert main(["run", str(source), "--output", str(out)]) == 1
    message = capsys.readouterr().err
    for word in (f"Error: {source}: analysis", "bar.x", "name other coordinates"):
        assert word in message, message
    assert not list(out.iterdir())
