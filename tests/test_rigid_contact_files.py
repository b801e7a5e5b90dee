"""Rigid contacts in model files: what ``check`` message, and slips in one or two directions."""

from __future__ import annotations

import numpy as np
import pytest

from dalembert.cli import main
from dalembert.io.model_file import load_model_file

BALL = """
format = 1
name = "ball"
gravity = [0, -9.81]
[bodies.ball]
type = "Particle"
mass = 1.0
position = [0, {height}]
[forces.floor]
type = "UnilateralConstraint"
distance = "ball.y + 0.1*t"
restitution = 0.5
poisson = true
[analysis]
type = "Dynamics"
step = 0.01
{more}
"""

PUCK = """
format = 1
name = "puck"
gravity = [0, 0, -9.81]
[bodies.puck]
type = "Particle"
mass = 1.0
position = [0, 0, 0]
velocity = [0.3, 0.4, 0]
[forces.ice]
type = "UnilateralConstraint"
distance = "puck.z"
slip = {slip}
restitution = 0.0
friction = 0.1
[analysis]
type = "Dynamics"
duration = 1.0
integrator = "DormandPrince"
"""


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("height", "more", "message"),
    [
        (-0.1, "duration = 1.0", "analysis: floor: its gap is -0.1 m at the start"),
        (0.1, "t_span = [-2.0, 1.0]", "analysis: floor: its gap is -0.1 m at the start"),
        (
            0.1,
            'duration = 1.0\nformulation = "AugmentedLagrangian"',
            "analysis.formulation: AugmentedLagrangian does not hold the rigid contact floor",
        ),
    ],
)
def test_models_that_cannot_run_are_refused_by_check(
    command, height, more, message, tmp_path, capsys
):
    path = tmp_path / "ball.toml"
    path.write_text(BALL.format(height=height, more=more), encoding="utf-8")
    output = ["--output", str(tmp_path / "out")] if command == "run" else []
    assert main([command, str(path), *output]) == 2
    assert message in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("slip", "force"), [('["puck.vx", "puck.vy"]', [-0.6, -0.8]), ('"puck.vx"', [-1.0])]
)
def test_slip_in_two_directions_or_one(slip, force, tmp_path):
    path = tmp_path / "puck.toml"
    path.write_text(PUCK.format(slip=slip), encoding="utf-8")
    from dalembert.io.analyses import make_analysis

    file = load_model_file(path)
    model = file.model()
    motion = make_analysis(file, model).run(model)
    rubbed = np.atleast_2d(motion.values("ice.friction_force").T).T[0]
    np.testing.assert_allclose(rubbed, 0.1 * 9.81 * np.array(force), rtol=1e-12)
