"""Gradients by what the structure of a flexible body is made of: all ways to them agree."""

import numpy as np
import pytest
from flexible_bodies import ENDS, KINDS, tapered
from thorough import crossed, sampled

import dalembert as da
from dalembert import planar, spatial

SPACES = pytest.mark.parametrize("dimension", [2, 3])
PLANE_OFTEN = pytest.mark.parametrize("dimension", sampled([2, 3], 2))
IMPLICIT = {2: da.Radau(fixed=True), 3: da.Trapezoidal()}
NAMES = ["thick", "E", "len", "ratio", "k"]


def swing(dimension: int, held=None, **options):
    """A tapered rod on a pin and a spring; what it is made of follows the system."""
    system = da.System("swing", gravity=(0.0, -9.81, 0.5)[:dimension])
    numbers = [0.032, 1.9e9, 1.02, 0.05, 30.0]
    thick, modulus, length, ratio, k = map(system.parameter, NAMES, numbers)
    zero = (0.0,) * dimension
    options = {"reference": "root", "position": zero, "modes": 1} | options
    options |= {"angle": 0.0} if dimension == 2 else {"rotation": np.eye(3)}
    follows = {"E": modulus, "h": thick, "L": 2 * length / 2, "rho": 1100.0}
    options.setdefault("parameters", follows)
    rod = KINDS[dimension].FlexibleBody(
        "rod",
        tapered(dimension),
        interface=ENDS,
        damping_ratio=ratio,
        rayleigh=(0.1, 1e-4),
        **options,
    )
    system.add(rod)
    if held is not None:
        held(system, rod)
    else:
        pin = planar.Revolute if dimension == 2 else spatial.Spherical
        system.add(pin("pin", system.ground.point(*zero), rod.point("root")))
    anchor = system.ground.point(*(1.0, 0.5, 0.2)[:dimension])
    system.add(KINDS[dimension].Spring("spring", anchor, rod.point("tip"), stiffness=k))
    return system.build()


def agree(result, responses, rtol: float = 1e-6) -> np.ndarray:
    """Direct = adjoint to round-off, both = differences of whole runs; gradient by 100 %."""
    direct, adjoint, differences = (
        da.sensitivity(result, responses, method=m).values * result.model.nominal[: len(NAMES)]
        for m in ("direct", "adjoint", "finite-difference")
    )
    size = np.abs(direct).max(axis=1, keepdims=True)
    assert np.all(size > 0)
    np.testing.assert_allclose(adjoint / size, direct / size, rtol=0, atol=1e-9)
    np.testing.assert_allclose(differences / size, direct / size, rtol=0, atol=rtol)
    return direct / size


TIP = [da.final("rod.tip.y"), da.integral("rod.tip.deflection.y"), da.final("rod.q1")]


@pytest.mark.thorough
@pytest.mark.parametrize(("dimension", "frame"), crossed([2, 3], ["mean", "root"]))
def test_explicit_steps(dimension, frame):
    place = {"position": None} if frame == "mean" else {}
    model = swing(dimension, reference=frame, modes=0, **place)
    motion = da.solve_dynamics(model, 5e-4, step=5e-5, integrator=da.RK4())
    gradient = agree(motion, TIP)
    assert np.abs(gradient[:, :3]).max(axis=0).min() > 1e-6  # each number of the structure counts


@PLANE_OFTEN
def test_implicit_steps(dimension):
    model = swing(dimension)
    agree(da.solve_dynamics(model, 1.5e-3, step=5e-4, integrator=IMPLICIT[dimension]), TIP)


@pytest.mark.thorough
def test_displacements_of_second_order():
    model = swing(2, stiffening=True, modes=0)
    agree(da.solve_dynamics(model, 2e-4, step=1e-5, integrator=da.RK4()), TIP)


def weld(system, rod):
    if rod.dimension == 2:
        system.add(planar.Weld("clamp", system.ground.center, rod.point("root")))
    else:
        system.add(spatial.Weld("clamp", system.ground.frame(), rod.point("root")))


@pytest.mark.few(1)
@SPACES
def test_equilibrium(dimension):
    agree(da.solve_equilibrium(swing(dimension, weld)), TIP[::2])


@pytest.mark.thorough
@PLANE_OFTEN
def test_linearisation(dimension):
    modes = da.linearize(swing(dimension, weld, modes=0))
    agree(modes, [da.at(1.0, "frequency"), da.at(2.0, "damping_ratio")])


@pytest.mark.thorough
def test_driven():
    def drive(system, rod):
        pin = planar.Revolute("pin", system.ground.center, rod.point("root"))
        system.add(pin)
        turn = planar.RotationalDriver("turn", system.ground, rod, da.sin(3 * da.t))
        system.add(turn)

    motion = da.solve_dynamics(swing(2, drive), 0.01, step=1e-3, integrator=da.Radau(fixed=True))
    agree(motion, [da.final("turn.moment"), da.final("pin.force.y")])


@pytest.mark.thorough
def test_the_remainder_falls_with_the_square():
    motion = da.solve_dynamics(swing(2), 1e-3, step=1e-4, integrator=da.Radau(fixed=True))
    table = da.sensitivity(motion, da.final("rod.tip.y"), ["thick", "E", "len"], certificate=True)
    certificate = table.attrs["certificate"]
    assert certificate.passed, str(certificate)


@pytest.mark.few(1)
@SPACES
def test_new_values_are_those_of_another_model(dimension):
    """Shapes that follow span what shapes chosen there span: the motion is the same."""
    values = {"thick": 0.035, "E": 1.5e9, "len": 0.95}
    fresh = {"h": 0.035, "E": 1.5e9, "L": 0.95, "rho": 1100.0}
    followed, fixed = swing(dimension, weld), swing(dimension, weld, parameters=fresh)
    run = {"duration": 2e-3, "step": 1e-3, "integrator": IMPLICIT[dimension]}
    motion = da.solve_dynamics(followed, parameters=values, **run)
    expected = da.solve_dynamics(fixed, **run)
    for measure in ("rod.tip.position", "potential_energy"):
        size = np.abs(expected[measure].values).max()
        np.testing.assert_allclose(motion[measure], expected[measure], rtol=0, atol=1e-9 * size)
    inside = [m.structure("rod")["e2.force"].values for m in (motion, expected)]
    np.testing.assert_allclose(*inside, rtol=0, atol=1e-7 * np.abs(inside[1]).max())


def test_shapes_follow_while_modes_keep_their_space():
    """In space the lowest mode bends one way or the other, as the section has it."""
    model = swing(3)
    with pytest.raises(da.AnalysisError, match=r"rod: of the 1 lowest modes .* changed places"):
        da.solve_equilibrium(model, parameters={"thick": 1e-3})


def test_limits_of_the_structure_hold():
    with pytest.raises(da.ModelError, match=r"rod: e0.area: is -0.0003"):
        da.solve_equilibrium(swing(2, weld), parameters={"thick": -0.03})


def test_a_structure_follows_parameters_alone():
    system = da.System("x")
    follows = {"E": 1e9 * (1 + da.t)}
    system.add(planar.FlexibleBody("rod", tapered(2), interface=ENDS, parameters=follows))
    with pytest.raises(da.ExpressionError, match="rod: depends on t"):
        system.build()


def test_unknown_parameters_of_the_structure_are_named():
    thick = da.System("x").parameter("thick", 0.01)
    with pytest.raises(da.ModelError, match="unknown parameter of the structure 'H'"):
        planar.FlexibleBody("rod", tapered(2), interface=ENDS, parameters={"H": thick})


def test_second_derivatives_are_refused():
    equilibrium = da.solve_equilibrium(swing(2, weld))
    with pytest.raises(da.UnsupportedError, match="depend on parameters"):
        da.hessian_product(equilibrium, TIP[0], {"thick": 1.0})
