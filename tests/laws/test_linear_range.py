"""Results beyond the validity range of linear elasticity carry a warning with their error."""

import re

import numpy as np
import pytest
from flexible_bodies import KINDS
from scipy.integrate import solve_bvp

import dalembert as da
from dalembert import planar
from dalembert.structures import Frame, SpaceFrame

COUNT = 8
AXIAL = 1e6
"""Axial rigidity by bending rigidity."""


def cantilever(dimension: int, clamped: bool = False) -> da.Structure:
    """Unit length, bending rigidity and mass."""
    s, zeros = da.Structure("cantilever"), (0.0,) * (dimension - 1)
    nodes = [s.node(f"n{k}", k / COUNT, *zeros) for k in range(COUNT + 1)]
    numbers = {"area": AXIAL, "modulus": 1.0, "density": 1 / AXIAL}
    more = {"second_moment": 1.0}
    if dimension == 3:
        more = {"second_moment_y": 1.0, "second_moment_z": 1.0, "torsion_constant": 1.0}
        more |= {"shear_modulus": 1.0}
    kind = Frame if dimension == 2 else SpaceFrame
    for k in range(COUNT):
        s.add(kind(f"e{k}", nodes[k], nodes[k + 1], **numbers, **more))
    if clamped:
        s.support(nodes[0])
    return s


def loaded(dimension: int, across: float, along: float = 0.0, **options) -> da.System:
    """The cantilever as one flexible body, with forces ``across`` and ``along`` at its end."""
    kinds = KINDS[dimension]
    system = da.System("loaded")
    across = system.parameter("across", across)
    options = {"interface": {"root": "n0", "tip": f"n{COUNT}"}, "reference": "root"} | options
    pose = {"angle": 0.0} if dimension == 2 else {"rotation": np.eye(3)}
    body = kinds.FlexibleBody("arm", cantilever(dimension).build(), modes=2, **pose, **options)
    system.add(body)
    if dimension == 2:
        system.add(planar.Weld("clamp", system.ground.center, body.point("root")))
    else:
        system.add(kinds.Weld("clamp", system.ground.frame(), body.frame("root")))
    force = (along, -across, 0.0)[:dimension]
    system.add(kinds.Force("load", body.point("tip"), force))
    return system


def elastica(load: float) -> np.ndarray:
    """End (2,) of the clamped elastica under a dead load across, ``θ'' = −α cos θ``."""
    s = np.linspace(0, 1, 101)
    y = np.stack([load * (s - s**2 / 2), load * (1 - s)])
    for part in np.linspace(0, load, 5)[1:]:

        def slopes(_, y, part=part):
            return np.stack([y[1], -part * np.cos(y[0])])

        solution = solve_bvp(slopes, lambda a, b: np.array([a[0], b[1]]), s, y, tol=1e-7)
        s, y = solution.x, solution.y
    return np.array([np.trapezoid(np.cos(y[0]), s), -np.trapezoid(np.sin(y[0]), s)])


def stated_error(warnings) -> float:
    """The error that a warning states, relative to the largest displacement; zero without one."""
    computed = [re.search(r"about (?:\S+ m, )?(\S+) % of the largest", text) for text in warnings]
    return max((float(match[1]) / 100 for match in computed if match), default=0.0)


@pytest.mark.parametrize(("dimension", "stiffening"), [(2, False), (2, True), (3, False)])
def test_bending(dimension, stiffening):
    """The stated error is that against the elastica, and small errors carry no warning."""
    model = loaded(dimension, 1.0, stiffening=stiffening).build()
    for load in (0.01, 0.2, 4.0, 10.0) if dimension == 2 else (0.2, 2.0):
        rest = da.solve_equilibrium(model, parameters={"across": load})
        end = np.array([rest["arm.tip.x"].values[0], rest["arm.tip.y"].values[0]])
        error = np.linalg.norm(end - elastica(load)) / np.linalg.norm(end - [1.0, 0.0])
        stated = stated_error(rest.warnings)
        assert (stated > 0) == (error > 0.05) and (not stated or abs(stated / error - 1) < 0.1)
        assert not stated or ("arm at t = 0 s" in rest.warnings[0] and "e7" in rest.warnings[0])


def test_axial_forces():
    """A beam in tension deflects by ``P (k − tanh k)/k³``; linear shapes do not see that."""
    for tension in (0.05, 5.0):
        k = tension**0.5
        error = 1 / (3 * (k - np.tanh(k)) / k**3) - 1
        share = error / (1 + error)  # of the linear deflection
        linear = da.solve_equilibrium(loaded(2, 1e-3, tension).build())
        stiff = da.solve_equilibrium(loaded(2, 1e-3, tension, stiffening=True).build())
        assert not stiff.warnings
        stated = stated_error(linear.warnings)
        assert (stated > 0) == (share > 0.05)
        if stated:
            assert abs(stated / share - 1) < 0.1
            assert "stiffening" in linear.warnings[0]


def test_buckling():
    """A straight column beyond its critical load π²/4 has no stable equilibrium."""
    for share, wrong in ((0.5, False), (1.2, True)):
        push = -share * np.pi**2 / 4
        rest = da.solve_equilibrium(loaded(2, 0.0, push).build())
        assert rest.status.success
        assert any("no stable equilibrium" in text for text in rest.warnings) is wrong


def test_every_analysis_announces_it():
    model = loaded(2, 4.0).build()
    rest = da.solve_equilibrium(model)
    assert stated_error(rest.warnings) > 0.5
    assert stated_error(da.linearize(model, rest).warnings) > 0.5
    assert (
        stated_error(da.solve_equilibrium(model, parameters={"across": [0.1, 4.0]}).warnings) > 0.5
    )
    options = {"step": 0.02, "integrator": da.Radau(fixed=True)}
    motion = da.solve_dynamics(model, 0.4, **options)
    assert stated_error(motion.warnings) > 0.1
    many = da.solve_dynamics(model, 0.4, parameters={"across": [0.01, 4.0]}, **options)
    assert any(text.startswith("design 1: arm") for text in many.warnings)
    assert not stated_error(
        da.solve_dynamics(model, 0.4, parameters={"across": 0.02}, **options).warnings
    )


def test_mean_axes():
    """The error is measured up to rigid motions."""
    model = loaded(2, 1.0, reference="mean").build()
    quiet, wrong = (da.solve_equilibrium(model, parameters={"across": a}) for a in (0.1, 4.0))
    assert not quiet.warnings and stated_error(wrong.warnings) > 0.2


def test_linear_structures():
    """Linear statics and transients state their error of second order."""
    s = cantilever(2, clamped=True)
    s.load(s.nodes[f"n{COUNT}"], fy=-s.parameter("across", 1.0))
    model = s.build()
    for load in (0.01, 0.2, 0.5, 1.0):
        rest = da.solve_statics(model, parameters={"across": load})
        end = np.array([1.0, -load / 3])
        error = np.linalg.norm(end - elastica(load)) / (load / 3)
        stated = stated_error(rest.warnings)
        assert (stated > 0) == (error > 0.05) and (not stated or abs(stated / error - 1) < 0.1)
    assert rest.summary()["warnings"] == rest.warnings
    motion = da.solve_transient(model, 1.0, step=0.05)
    assert stated_error(motion.warnings) > 0.1
    quiet = da.solve_transient(model, 1.0, step=0.05, parameters={"across": 0.05})
    assert not quiet.warnings


@pytest.mark.thorough
def test_strains_of_beams():
    """Strains beyond those of a linear law, at the edge of a solid section."""

    def rest(moment: float) -> da.Motion:
        system = da.System("bent")
        rigid = {"axial_rigidity": 12e4, "shear_rigidity": 5e4, "bending_rigidity": 1.0}
        beam = system.add(planar.Beam("beam", length=1.0, elements=2, angle=0.0, **rigid))
        system.add(planar.Weld("clamp", system.ground.center, beam.start.center))
        system.add(planar.Torque("M", beam.end, moment))
        return da.solve_equilibrium(system.build())

    assert not rest(6.0).warnings  # a full turn of a thin strip, h = 1/100
    depth = 0.01
    warned = rest(25.0)
    assert "strain 0.13" in warned.warnings[0] and abs(25 * depth / 2 - 0.125) < 1e-12


def test_unstable_equilibria_of_structures():
    """Beyond Euler's load the straight column is an equilibrium, and not a stable one."""
    s = cantilever(2, clamped=True)
    s.load(s.nodes[f"n{COUNT}"], fx=-s.parameter("push", 1.0))
    model, critical = s.build(), np.pi**2 / 4
    for share in (0.9, 1.1):
        rest = da.solve_equilibrium(model, parameters={"push": share * critical})
        assert rest.status.success
        assert rest.statistics["stable"] is (share < 1)
        assert any("not stable" in text for text in rest.warnings) is (share > 1)
        assert ("not a stable position" in rest.status.message) is (share > 1)
    notes = da.sensitivity(rest, da.final(f"n{COUNT}.ux")).notes
    assert any("not stable" in note for note in notes)
