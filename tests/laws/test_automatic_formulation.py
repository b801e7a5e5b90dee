"""A formulation that is left to its cost: the cheapest accurate one, and the motion of it."""

import numpy as np
import pytest
from registry import model_of
from test_joint_coordinates import mechanism
from test_short_corrections import ladder

import dalembert as da
from dalembert.analysis.dynamics.kernel_choice import cost_and_error
from dalembert.errors import UnsupportedError
from dalembert.formulations.automatic_formulation import CANDIDATES, LONG
from dalembert.formulations.base import Performance

AUTOMATIC = da.AutomaticFormulation()
VIEWS = [da.AbsoluteCoordinates(), da.JointCoordinates()]


def analysis(formulation, **more):
    return da.Dynamics(0.1, step=0.01, formulation=formulation, **more)


@pytest.mark.parametrize("coordinates", VIEWS, ids=["bodies", "joints"])
@pytest.mark.parametrize("name", ["four_bar", "slider_crank"])
def test_fewest_operations_of_those_that_are_accurate(name, coordinates):
    model = mechanism(name)
    chosen = analysis(AUTOMATIC, coordinates=coordinates).kernel(model)
    merits = [
        cost_and_error(analysis(f, coordinates=coordinates).kernel(model)) for f in CANDIDATES
    ]
    assert max(m.error for m in merits) < 1e-10
    assert chosen.operations == min(m.operations for m in merits)
    assert chosen.formulation in CANDIDATES


def test_the_choice_differs_between_coordinates():
    """Of few coordinates few are dependent; of many bodies, sparse factors are cheapest."""
    model = ladder(3)
    kinds = {type(analysis(AUTOMATIC, coordinates=c).kernel(model).formulation) for c in VIEWS}
    assert len(kinds) == 2


def test_the_run_is_that_of_the_formulation_it_names():
    model = mechanism("four_bar")
    options = {"step": 0.005, "outputs": 5, "backend": "vm"}
    both = {"coordinates": da.AutomaticCoordinates(), "formulation": AUTOMATIC}
    motion = da.solve_dynamics(model, 0.05, **both, **options)
    (same,) = (f for f in CANDIDATES if type(f).__name__ == motion.statistics["formulation"])
    (view,) = (c for c in VIEWS if type(c).__name__ == motion.statistics["coordinates"])
    expected = da.solve_dynamics(model, 0.05, coordinates=view, formulation=same, **options)
    assert motion.record.kernel is expected.record.kernel
    assert (motion.trajectory.y == expected.trajectory.y).all()


def test_gradients_of_both_directions_agree():
    """Those of the formulation that was chosen."""
    motion = da.solve_dynamics(model_of("revolute"), 0.05, step=0.01, formulation=AUTOMATIC)
    direct, adjoint = (
        da.sensitivity(motion, da.final(motion.model["b.angle"]), method=m).values
        for m in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9, atol=1e-12)


def test_implicit_integrators_eliminate_themselves():
    kernel = analysis(AUTOMATIC, integrator=da.GeneralizedAlpha()).kernel(mechanism("four_bar"))
    assert isinstance(kernel.formulation, da.RangeSpace)


@pytest.mark.parametrize(
    ("merits", "kind"),
    [
        ({"RangeSpace": (9, 1e-3), "NullSpace": (20, 1e-12)}, da.NullSpace),
        ({"RangeSpace": (9, 1e-3), "NullSpace": (20, 1e-4)}, da.KKT),
        ({"RangeSpace": (9, float("inf"))}, da.KKT),
        ({"RangeSpace": (LONG + 1, 0.0), "NullSpace": (1, 0.0)}, da.RangeSpace),
        ({}, da.RangeSpace),
    ],
    ids=["inaccurate", "all inaccurate", "no value", "long", "all refuse"],
)
def test_accuracy_comes_before_operations(merits, kind):
    merits |= {"KKT": (100, 1e-12)} if merits else {}

    def performance(formulation):
        name = type(formulation).__name__
        if name not in merits:
            raise UnsupportedError("not on this mechanism")
        return Performance(*merits[name])

    assert isinstance(AUTOMATIC.select(performance, False), kind)


def test_it_is_told_where_no_choice_is_made():
    with pytest.raises(UnsupportedError, match=r"give RangeSpace\(\)"):
        AUTOMATIC.saddle(mechanism("four_bar").equations)
