"""Coordinates that are left to their cost: the cheaper of two, and the motion of either."""

from typing import Any

import pytest
from test_joint_coordinates import mechanism

import dalembert as da
from dalembert import spatial
from dalembert.errors import UnsupportedError

AUTOMATIC = da.AutomaticCoordinates()
BOTH = [da.AbsoluteCoordinates(), da.JointCoordinates()]


def hanging(count: int, ball: bool) -> da.Model:
    """Rods from wall to wall on ball joints, or an arm of hinges."""
    system = da.System("rods", gravity=(0.0, 0.0, -9.81))
    last: Any = system.ground
    for k in range(count):
        rod = spatial.Body(
            f"rod{k}", mass=1.0, inertia=(0.1, 0.01, 0.1), position=(0.0, k + 0.5, 0.0)
        )
        system.add(rod)
        here, there = (0.0, 0.5 if k else 0.0, 0.0), (0.0, -0.5, 0.0)
        if ball:
            system.add(spatial.Spherical(f"J{k}", last.point(*here), rod.point(*there)))
        else:
            sides = (body.frame(at, axis=(1, 0, 0)) for body, at in ((last, here), (rod, there)))
            system.add(spatial.Revolute(f"J{k}", *sides))
        last = rod
    if ball:
        end = system.ground.point(0.0, count - 0.2, 0.0)
        system.add(spatial.Spherical("end", last.point(0.0, 0.5, 0.0), end))
    return system.build()


@pytest.mark.parametrize(
    ("ball", "kind"), [(False, da.JointCoordinates), (True, da.AbsoluteCoordinates)]
)
def test_arms_of_hinges_go_by_joints_and_loops_of_ball_joints_by_bodies(ball, kind):
    model = hanging(5, ball)
    analysis = da.Dynamics(0.1, step=0.01, coordinates=AUTOMATIC)
    kernel = analysis.kernel(model)
    assert type(kernel.coordinates) is kind
    costs = [da.Dynamics(0.1, step=0.01, coordinates=c).kernel(model).operations for c in BOTH]
    assert kernel.operations == min(costs)


@pytest.mark.parametrize("name", ["four_bar", "slider_crank"])
@pytest.mark.parametrize("formulation", [da.RangeSpace(), da.DAE()], ids=["fewest", "uncounted"])
def test_the_run_is_that_of_the_coordinates_it_names(name, formulation):
    options = {"step": 0.005, "outputs": 5, "backend": "vm", "formulation": formulation}
    if isinstance(formulation, da.DAE):
        options["integrator"] = da.GeneralizedAlpha()
    model = mechanism(name)
    motion = da.solve_dynamics(model, 0.05, coordinates=AUTOMATIC, **options)
    (same,) = (c for c in BOTH if type(c).__name__ == motion.statistics["coordinates"])
    expected = da.solve_dynamics(model, 0.05, coordinates=same, **options)
    assert (motion.trajectory.y == expected.trajectory.y).all()
    assert motion.record.kernel is expected.record.kernel


def test_what_counts_no_steps_is_not_chosen_for():
    with pytest.raises(UnsupportedError, match="give AbsoluteCoordinates"):
        da.linearize(hanging(2, False), coordinates=AUTOMATIC)
