"""Moments about fixed axes: balance with reactions, independent solutions, gradients, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import structures
from dalembert.errors import ModelError, UnsupportedError

FORCE, MOMENT = np.array([0.3, 1.0, -0.5]), np.array([0.9, 0.6, -0.45])
SECTION = {
    "area": 1.0,
    "second_moment_y": 0.02,
    "second_moment_z": 0.03,
    "torsion_constant": 0.04,
    "modulus": 100.0,
    "shear_modulus": 50.0,
    "orientation": (0, 1, 0),
}
DIRECTIONS = ("mx", "my", "mz")


def cantilever(moment, force=FORCE, count=4, fixed_axes=True, **section):
    s = da.Structure("cantilever")
    arguments = {d: s.parameter(d, m) for d, m in zip(DIRECTIONS, moment, strict=True)}
    modulus = s.parameter("modulus", 100.0)
    nodes = [s.node(f"n{k}", k / count, 0, 0) for k in range(count + 1)]
    numbers = SECTION | {"modulus": modulus} | section
    for k in range(count):
        s.add(structures.SpaceFrame(f"b{k}", *nodes[k : k + 2], **numbers))
    s.support(nodes[0])
    s.load(nodes[-1], fixed_axes=fixed_axes, **arguments)
    s.load(nodes[-1], **dict(zip(("fx", "fy", "fz"), force, strict=True)))
    return s.build()


def test_reactions_balance_moments_about_fixed_axes():
    result = da.solve_statics(cantilever(MOMENT), nonlinear=True)
    place = np.array([1.0, 0, 0]) + result.displacements[-6:-3, 0]
    assert np.linalg.norm(result.displacements[-3:, 0]) > 0.5
    left = MOMENT + np.cross(place, FORCE) + result.forces[3:6, 0]
    assert np.abs(left).max() < 1e-12
    vector = da.solve_statics(cantilever(MOMENT, fixed_axes=False), nonlinear=True)
    assert np.abs(vector.displacements - result.displacements).max() > 1e-2


def test_rolled_up_about_one_axis():
    moment = np.array([0.0, 0.0, 2 * np.pi * 3.0 / 4])  # E I = 3: a quarter of a circle
    one, other = (
        da.solve_statics(cantilever(moment, (0, 0, 0), fixed_axes=f), nonlinear=True)
        for f in (True, False)
    )
    assert one.status.success
    assert abs(one.displacements[-1, 0] - np.pi / 2) < 1e-9
    assert np.abs(one.displacements - other.displacements).max() < 1e-9


def test_gradients_of_statics():
    model = cantilever(MOMENT)
    result = da.solve_statics(model, nonlinear=True)
    names = ("n4.uy", "n4.rx", "b0.moment_y_i", "n0.mx")
    responses = [da.at(0, name) for name in names]
    direct, adjoint = (
        np.array(da.sensitivity(result, responses, method=m).values) for m in ("direct", "adjoint")
    )
    assert np.abs(direct - adjoint).max() < 1e-12

    def values(p):
        parameters = dict(zip(model.parameters, p, strict=True))
        result = da.solve_statics(model, parameters=parameters, nonlinear=True)
        return np.array([np.ravel(result[name])[0] for name in names])

    steps = 1e-5 * np.maximum(1.0, np.abs(model.nominal))
    for k, h in enumerate(steps):
        dp = h * np.eye(steps.size)[k]
        change = (values(model.nominal + dp) - values(model.nominal - dp)) / (2 * h)
        assert np.abs(change - direct[:, k]).max() < 1e-8


def spinning_body():
    s = da.Structure("body")
    node, share = s.node("a", 0, 0, 0), s.parameter("share", 1.0)
    s.add(structures.PointMass("mass", node, mass=1.0))
    s.add(structures.GroundSpring("held", node, stiffness_x=1, stiffness_y=1, stiffness_z=1))
    inertia = {"inertia_x": 1.0, "inertia_y": 2.0, "inertia_z": 1.5}
    s.add(structures.PointInertia("inertia", node, **inertia))
    s.load(node, mx=share, my=0.7, mz=-0.4 * share, fixed_axes=True)
    s.initial(node, vrx=0.5, vry=1.0)
    return s.build()


@pytest.mark.thorough
def test_body_turned_by_a_constant_moment():
    """Angular momentum grows by the moment; Euler's equations in fixed axes, past a half turn."""
    inertia, moment = np.array([1.0, 2.0, 1.5]), np.array([1.0, 0.7, -0.4])

    def rate(_, y):
        turned = Rotation.from_quat(y[:4])
        spin = turned.apply(turned.inv().apply(y[4:]) / inertia)
        return np.r_[0.5 * (y[3] * spin + np.cross(spin, y[:3])), -0.5 * spin @ y[:3], moment]

    begin = np.r_[0, 0, 0, 1, inertia * [0.5, 1.0, 0]]
    end = solve_ivp(rate, (0, 3), begin, rtol=1e-11, atol=1e-12).y[:4, -1]
    model, errors = spinning_body(), []
    for count in (400, 200):
        motion = da.solve_transient(model, 3.0, step=3.0 / count, nonlinear=True)
        vector = [float(np.ravel(motion[f"a.{d}"])[-1]) for d in ("rx", "ry", "rz")]
        apart = Rotation.from_rotvec(vector) * Rotation.from_quat(end).inv()
        errors.append(np.linalg.norm(apart.as_rotvec()))
    assert errors[0] < 1e-4
    assert abs(errors[1] / errors[0] - 4.0) < 0.1
    response = da.at(3.0, "a.vry")
    direct, adjoint = (
        float(np.ravel(da.sensitivity(motion, [response], method=m).values)[0])
        for m in ("direct", "adjoint")
    )
    assert abs(direct - adjoint) < 1e-10

    def at_end(share):
        motion = da.solve_transient(
            model, 3.0, step=3.0 / 200, nonlinear=True, parameters={"share": share}
        )
        return float(np.ravel(motion["a.vry"])[-1])

    assert abs((at_end(1 + 1e-5) - at_end(1 - 1e-5)) / 2e-5 - direct) < 1e-7


def test_refusals_and_small_displacements():
    model, plain = cantilever(MOMENT), cantilever(MOMENT, fixed_axes=False)
    small, same = da.solve_statics(model), da.solve_statics(plain)
    assert np.array_equal(small.displacements, same.displacements)
    assert np.array_equal(small.forces, same.forces)
    with pytest.raises(UnsupportedError, match=r"load path.*fixed axes"):
        da.solve_load_path(model, until=1.0)
    with pytest.raises(UnsupportedError, match=r"buckling.*fixed axes"):
        da.solve_buckling(model)
    with pytest.raises(UnsupportedError, match=r"vibration.*fixed axes"):
        da.solve_modes(model, about=da.solve_statics(model, nonlinear=True))
    s = da.Structure("body")
    node = s.node("a", 0, 0, 0)
    s.add(structures.PointInertia("inertia", node, inertia_x=1, inertia_y=1, inertia_z=1))
    s.add(structures.PointMass("mass", node, mass=1.0))
    with pytest.raises(ModelError, match="fixed_axes"):
        s.load(node, mx=1, fixed_axes="yes")
    s.load(node, mx=da.t, fixed_axes=True)
    with pytest.raises(UnsupportedError, match=r"fixed axes.*depend on time"):
        da.solve_transient(s.build(), 1.0, nonlinear=True)


def test_file_says_the_same(tmp_path):
    numbers = "".join(
        f"{key} = {list(value) if isinstance(value, tuple) else value}\n"
        for key, value in SECTION.items()
    )
    path = tmp_path / "beam.toml"
    path.write_text(
        'format = 1\nkind = "structure"\n[nodes]\na = [0, 0, 0]\nb = [1, 0, 0]\n'
        f'[elements.beam]\ntype = "SpaceFrame"\nconnect = ["a", "b"]\n{numbers}'
        '[[supports]]\nnodes = "a"\n'
        '[[loads]]\nnodes = "b"\nmx = 0.9\nmy = 0.6\nmz = -0.45\nfixed_axes = true\n'
    )
    model = da.load_model(path).build()
    result = da.solve_statics(model, nonlinear=True)
    same = da.solve_statics(cantilever(MOMENT, (0, 0, 0), count=1), nonlinear=True)
    assert np.abs(result.displacements - same.displacements).max() < 1e-9
