"""Law of heaps: gradients are those of differences, and do not grow without bounds."""

from __future__ import annotations

import numpy as np
import pytest
from free_body_scenes import falling_boxes

import dalembert as da
from dalembert import planar
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps


def pyramid() -> da.Model:
    """Six discs with a force law that fall onto each other as a pyramid."""
    system = da.System("pyramid", gravity=(0.0, -9.81))
    stiffness, push = system.parameter("stiffness", 1e5), system.parameter("push", 0.0)
    friction, size = system.parameter("friction", 0.3), 0.1
    shapes = [planar.contact.HalfPlane(system.ground)]
    for row in range(3):
        for k in range(3 - row):
            x, y = 1.02 * size * (2 * k + row), size * (1 + 3**0.5 * row) + 2e-3 * (row + 1)
            start = {"position": (x, y), "velocity": (push if row == 2 else 0.0, 0.0)}
            disc = system.add(planar.Body(f"disc{row}{k}", mass=1.0, inertia=0.005, **start))
            shapes.append(planar.contact.Circle(disc, size))
    law = planar.contact.HuntCrossley(stiffness=stiffness, damping=0.3)
    system.add(planar.Collisions("discs", shapes, law=law, friction=friction))
    return system.build()


@pytest.mark.thorough
def test_pyramid_of_compliant_discs():
    """Steps that are repeated with means over their path for one gap after the other."""
    motion = da.solve_nonsmooth(pyramid(), 0.07, step=1e-3)
    responses = [da.final(name) for name in ("disc20.y", "disc00.x", "disc10.y", "disc20.x")]
    gradient = da.sensitivity(motion, responses, method="direct").values
    adjoint = da.sensitivity(motion, responses, method="adjoint").values
    scales = abs(gradient).max(axis=0)
    np.testing.assert_allclose(adjoint / scales, gradient / scales, atol=1e-8)
    scheme = da.FiniteDifference("central", dict.fromkeys(("stiffness", "push", "friction"), 1e-6))
    values = da.sensitivity(motion, responses, method=scheme).values
    np.testing.assert_allclose(gradient / scales, values / scales, atol=1e-5)


def heap() -> da.Model:
    """Twenty discs that fall into a box and come to rest."""
    rng, system = np.random.default_rng(1), da.System("heap", gravity=(0.0, -9.81))
    friction, size = system.parameter("friction", 0.4), system.parameter("size", 0.1)
    shapes = []
    for k in range(20):
        place = 0.25 * np.array([k % 5, k // 5]) + (0.0, 0.15) + rng.uniform(-0.02, 0.02, 2)
        disc = system.add(planar.Body(f"disc{k}", mass=1.0, inertia=0.005, position=tuple(place)))
        shapes.append(planar.contact.Circle(disc, 0.1 if k else size))
    for x, normal in ((0.0, (0.0, 1.0)), (-0.15, (1.0, 0.0)), (1.15, (-1.0, 0.0))):
        shapes.append(planar.contact.HalfPlane(system.ground.point(x, 0.0), normal))
    system.add(planar.Collisions("heap", shapes, friction=friction))
    return system.build()


def first_rest(motion: da.Motion) -> int:
    """Number of the instant at which the lower disc first rests at its wall."""
    x, vx, turn = (motion[f"disc0.{name}"].values for name in ("x", "vx", "angular_velocity"))
    rests = (abs(x + 0.05) < 1e-9) & (abs(vx) < 1e-8) & (abs(turn) < 1e-7)
    first = int(np.argmax(rests))
    assert rests[first] and motion.time[first] < 0.6
    return first


def tangential_speeds(motion: da.Motion) -> np.ndarray:
    """(K,) largest relative speed along tangents of two discs that touch, at each instant."""
    parts = [(f"disc{k}.{name}", f"disc{k}.v{name}") for k in range(20) for name in ("x", "y")]
    x, v = (
        np.stack([motion[names[i]].values for names in parts]).reshape(20, 2, -1) for i in (0, 1)
    )
    x, v = x[:, None] - x, v[:, None] - v
    distance = np.linalg.norm(x, axis=2)
    distance[np.arange(20), np.arange(20)] = np.inf
    along = abs(x[:, :, 0] * v[:, :, 1] - x[:, :, 1] * v[:, :, 0]) / distance
    return np.where(distance < 0.2 + 1e-6, along, 0.0).max(axis=(0, 1))


@pytest.mark.thorough
def test_discs_at_rest_in_a_heap():
    """Two discs rest at the walls of the box, ``x = size − 0.15``. Impacts in the heap above make
    the lower one roll away from its wall, by up to 0.1 mm, and otherwise it remains there: from
    its first rest on, the speed of ``x + size φ`` is zero, whatever the friction. The corrections
    of the gaps displace it, in each step by less than the turning of the normals changes the gap of
    two discs that touch: ``(h v)² / (2 · 2 size)``, with their relative tangential speed ``v``."""
    options = {"step": 2e-3, "integrator": da.MoreauJean()}
    model = heap()
    motion = da.solve_nonsmooth(model, 1.0, **options)
    first, angle = first_rest(motion), motion["disc0.angle"].values
    rest = float(motion.time[first])
    responses = [da.at(rest, "disc0.x"), da.at(rest, "disc0.angle")]
    responses += [da.final("disc0.x"), da.final("disc0.angle"), da.final("disc19.x")]
    gradient = da.sensitivity(motion, responses).values
    np.testing.assert_allclose(gradient[0], [0.0, 1.0], atol=1e-9)
    singular = 1e-7 * np.abs(gradient).max()  # error of the solutions of singular equations
    np.testing.assert_allclose(gradient[4], [0.0, 0.0], atol=singular)
    rolled = gradient[[0, 2]] + 0.1 * gradient[[1, 3]]
    rolled[:, 1] += angle[[first, -1]]  # by the size in the product
    np.testing.assert_allclose(rolled[1], rolled[0], rtol=0, atol=2e-3)  # of terms of 1.5
    for friction in np.linspace(0.39, 0.41, 5):
        moved = da.solve_nonsmooth(model, 1.0, parameters={"friction": friction}, **options)
        last = slice(first_rest(moved), None)
        rolled = moved["disc0.x"].values + 0.1 * moved["disc0.angle"].values
        slip = moved["disc0.vx"].values + 0.1 * moved["disc0.angular_velocity"].values
        np.testing.assert_allclose(slip[last], 0.0, atol=1e-9)
        fastest = tangential_speeds(moved)[last]
        bound = (2e-3 * np.maximum(fastest[1:], fastest[:-1])) ** 2 / 0.4
        assert (abs(np.diff(rolled[last])) <= bound + 1e-12).all()


@pytest.mark.thorough
def test_recorded_paths():
    """The maps of steps with means over their paths reproduce the motion, and each solution before
    the last one."""
    motion = da.solve_nonsmooth(heap(), 0.3, step=2e-3)
    steps, paths = ContactSteps(motion), motion.record.paths
    repeated = [k for k, path in enumerate(paths) if path.solutions]
    assert repeated
    for k in repeated:
        final = steps.at(k)[0]
        for solution in paths[k].solutions[::-1]:
            final = final.path
            np.testing.assert_allclose(final.z[: solution.v.size], solution.v, atol=1e-9)
        assert final.path is None


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, 5, 15, 26])
def test_gradients_of_falling_boxes(seed):
    """Adjoint and direct gradients agree, also where the general step has another solution than the
    recorded one, and where the largest change of a normal speed by forces is a mean over a path."""
    motion = da.solve_nonsmooth(falling_boxes(10, seed), 0.5, step=1e-3)
    response = da.final("box3.x")
    adjoint, direct = (
        da.sensitivity(motion, response, method=method).values for method in ("adjoint", "direct")
    )
    np.testing.assert_allclose(adjoint, direct, rtol=1e-6, atol=1e-9)
