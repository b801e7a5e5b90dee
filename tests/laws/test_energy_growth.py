"""Runs by ``MoreauJean`` whose energy grows in a step have a warning that states its size."""

from __future__ import annotations

import re

import numpy as np
import pytest
from rigid_contacts import other_warnings
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial

G = 9.81
LEAST = 1e-10
"""Growth in one step relative to the energy in the motion that is warned about [-]."""
RUN = {"step": 2e-3, "integrator": da.MoreauJean()}
EXACT = da.ContactSolver(tolerance=1e-11)
CONTACTS, LIFTED = "contacts gave", "corrections of positions, which lift bodies, did"


def discs_and_polygons(seed: int, gravity: float, **law) -> da.Model:
    """Discs with offsets, capsules and polygons that fly between four walls."""
    rng, system, contact = (
        np.random.default_rng(seed),
        da.System("s", (0, -gravity)),
        planar.contact,
    )
    shapes = []
    for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        shapes.append(contact.HalfPlane(system.ground.point(-0.4 * x, -0.4 * y), (x, y)))
    for k in range(6):
        body = planar.Body(
            f"b{k}",
            mass=rng.uniform(0.5, 2.0),
            inertia=rng.uniform(1e-3, 4e-3),
            position=(-0.2 + 0.2 * (k % 3), -0.15 + 0.25 * (k // 3)),
            angle=rng.uniform(0, 2 * np.pi),
            velocity=tuple(rng.normal(size=2)),
            angular_velocity=6 * rng.normal(),
        )
        system.add(body)
        angles = np.linspace(0, 2 * np.pi, 5, endpoint=False)
        kinds = [
            contact.Circle(body.point(0.02, 0.01), 0.05),
            contact.Polygon(body, [(0.07 * np.cos(a), 0.07 * np.sin(a)) for a in angles]),
            contact.Capsule(body.point(-0.04, 0.0), body.point(0.04, 0.0), 0.03),
        ]
        shapes.append(kinds[k % 3])
    system.add(planar.Collisions("all", shapes, **law))
    return system.build()


def spheres_and_boxes(seed: int, gravity: float, **law) -> da.Model:
    """Spheres, boxes and capsules that fly between six walls."""
    rng, contact = np.random.default_rng(seed), spatial.contact
    system, shapes = da.System("s", gravity=(0, 0, -gravity)), []
    for axis in np.vstack([np.eye(3), -np.eye(3)]):
        shapes.append(contact.HalfSpace(system.ground.frame(tuple(-0.3 * axis), axis=tuple(axis))))
    for k in range(6):
        body = spatial.Body(
            f"b{k}",
            mass=rng.uniform(0.5, 2.0),
            inertia=(2e-3, 3e-3, 4.5e-3),
            position=(-0.15 + 0.15 * (k % 3), 0.0, -0.1 + 0.25 * (k // 3)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0 + k),
            velocity=tuple(rng.normal(size=3)),
            angular_velocity=tuple(4 * rng.normal(size=3)),
        )
        system.add(body)
        kinds = [
            contact.Sphere(body.point(0.02, 0.01, 0.0), 0.05),
            contact.Box(body.center, tuple(rng.uniform(0.06, 0.1, 3))),
            contact.Capsule(body.point(-0.03, 0, 0), body.point(0.03, 0, 0), 0.04),
        ]
        shapes.append(kinds[k % 3])
    system.add(spatial.Collisions("all", shapes, **law))
    return system.build()


SCENES = [discs_and_polygons, spheres_and_boxes]


def growths(motion: da.Motion) -> np.ndarray:
    """Growth of the energy in each step, at least ``LEAST`` of that in the motion [J]."""
    data = motion.data
    potential = data["potential_energy"].values
    moved = data["kinetic_energy"].values.max() + np.ptp(potential)
    grown = np.diff(data["energy"].values)
    return np.where(grown > LEAST * moved, grown, 0.0)


@pytest.mark.few(2)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("gravity", [0.0, G])
@pytest.mark.parametrize(("friction", "restitution"), [(0.4, 0.0), (0.0, 1.0), (0.3, 1.0)])
def test_energy_grows_with_a_warning_only(seed, scene, gravity, friction, restitution):
    model = scene(seed, gravity, friction=friction, restitution=restitution)
    motion = da.solve_nonsmooth(model, 0.3, solver=EXACT, **RUN)
    assert motion.status.success
    own = [text for text in motion.warnings if text.startswith((CONTACTS, LIFTED))]
    assert bool(own) == growths(motion).any()


@pytest.mark.parametrize("scene", sampled(SCENES, 2))
def test_energy_given_by_contacts(scene):
    """Without gravity all growth is that by contacts, and none with the energetic law."""
    law = {"friction": 0.05, "restitution": 1.0}
    shares = []
    for seed in range(3):
        motion = da.solve_nonsmooth(scene(seed, 0.0, **law), 0.3, **RUN)
        grown = growths(motion)
        stated = [text for text in motion.warnings if text.startswith(CONTACTS)]
        assert bool(stated) == grown.any()
        if stated:
            assert float(stated[0].split()[2]) == pytest.approx(grown.sum(), rel=5e-3)
            assert "impacts with friction by Newton's law may do so" in stated[0]
            shares.append(grown.sum() / motion.data["kinetic_energy"].values.max())
        motion = da.solve_nonsmooth(scene(seed, 0.0, **law, impact_law="energetic"), 0.3, **RUN)
        assert not growths(motion).any()
    assert 0 < min(shares) < 0.02


@pytest.mark.parametrize("scene", sampled(SCENES, 2))
def test_energy_of_corrections_of_positions(scene):
    """Without restitution nor friction all growth is that by lifted bodies."""
    stated = []
    for seed in range(3):
        model = scene(seed, G)
        motion = da.solve_nonsmooth(model, 0.3, **RUN)
        grown, warnings = growths(motion), other_warnings(motion)
        lifted = [text for text in warnings if text.startswith(LIFTED)]
        assert bool(lifted) == grown.any()
        if lifted:
            value = re.search(r"let the energy grow by (\S+) J in", lifted[0]).group(1)
            assert float(value) == pytest.approx(grown.sum(), rel=5e-3)
            stated.append(float(value))
    assert stated


@pytest.mark.thorough
@pytest.mark.parametrize("scene", sampled(SCENES, 2))
def test_energy_given_by_inexact_impulses(scene):
    """Elastic impacts without friction give none with the default tolerance."""
    inexact = da.ContactSolver(tolerance=1e-3, acceptable=1e-3)
    total = 0.0
    for seed in range(4):
        model = scene(seed, 0.0, restitution=1.0)
        assert not growths(da.solve_nonsmooth(model, 0.3, **RUN)).any()
        motion = da.solve_nonsmooth(model, 0.3, solver=inexact, **RUN)
        grown, warnings = growths(motion).sum(), other_warnings(motion)
        stated = [text for text in warnings if text.startswith(CONTACTS)]
        assert bool(stated) == (grown > 0)
        if stated:
            assert "their impulses are within the tolerance only" in stated[0]
            assert float(stated[0].split()[2]) == pytest.approx(grown, rel=0.05)
        total += grown
    assert total > 0
