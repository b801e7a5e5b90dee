"""Features of hulls by machine code: the same as those of the search in Python."""

from functools import partial

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls import compiled_features
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps

REACH = 0.3


def planar_scene(seed: int) -> da.Model:
    """Polygons, circles and capsules that overlap or are near, some of them parallel."""
    rng, contact = np.random.default_rng(seed), planar.contact
    system, shapes = da.System("planar shapes"), []
    for k in range(9):
        place = tuple(rng.uniform(-0.3, 0.3, 2))
        angle = rng.normal() if k % 2 else 0.0
        body = planar.Body(f"b{k}", mass=1.0, inertia=0.01, position=place, angle=angle)
        system.add(body)
        if k % 3 == 0:
            turns = 2 * np.pi * np.arange(3 + k % 4) / (3 + k % 4)
            corners = np.column_stack([0.12 * np.cos(turns), 0.1 * np.sin(turns)])
            shapes.append(contact.Polygon(body, [tuple(corner) for corner in corners]))
        elif k % 3 == 1:
            shapes.append(contact.Circle(body.center, 0.1))
        else:
            shapes.append(contact.Capsule(body.center, body.point(0.1, 0.2), 0.06))
    system.add(planar.Collisions("hits", shapes))
    return system.build()


def spatial_scene(seed: int) -> da.Model:
    """Boxes, spheres, capsules and polyhedra that overlap or are near, some of them parallel."""
    rng, contact = np.random.default_rng(seed), spatial.contact
    system, shapes = da.System("spatial shapes"), []
    for k in range(12):
        turn = da.rotation.axis_angle(tuple(rng.normal(size=3)), rng.uniform(0, 3))
        pose = {"position": tuple(rng.uniform(-0.3, 0.3, 3)), "rotation": turn}
        if k % 3 == 0:
            pose["rotation"] = np.eye(3)
        body = spatial.Body(f"b{k}", mass=1.0, inertia=(0.01, 0.01, 0.01), **pose)
        system.add(body)
        if k % 4 == 0:
            shapes.append(contact.Box(body.center, tuple(rng.uniform(0.1, 0.3, 3))))
        elif k % 4 == 1:
            shapes.append(contact.Sphere(body.center, 0.1))
        elif k % 4 == 2:
            shapes.append(contact.Capsule(body.center, body.point(0.1, 0.2, 0.05), 0.06))
        else:
            corners = rng.normal(size=(7, 3))
            corners *= 0.15 / np.linalg.norm(corners, axis=1)[:, None]
            shapes.append(contact.Polyhedron(body, [tuple(corner) for corner in corners]))
    system.add(spatial.Collisions("hits", shapes))
    return system.build()


def features(source: HullGaps, configuration: Configuration) -> dict[tuple[int, ...], float]:
    """Gaps within reach, by the kind of features, shapes and numbers of features."""
    at = source.geometry.positions(configuration)
    gaps = {}
    for pairs in source._search(at, REACH, partial(source._normals, at)):
        columns = pairs.first, pairs.second, pairs.own, pairs.other
        for gap, *numbers in zip(source._evaluate(pairs, at)[0], *columns, strict=True):
            key = int(pairs.feature), *map(int, numbers)
            assert key not in gaps  # each once
            gaps[key] = gap
    return {key: gap for key, gap in gaps.items() if gap <= REACH}


@pytest.mark.few(3)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("scene", [planar_scene, spatial_scene])
def test_features_are_those_of_the_search_in_python(scene, seed, monkeypatch):
    model = scene(seed)
    values = model.values(None)
    configuration = Configuration(0.0, model.assemble(values, 0.0).y, values)
    (joined,) = gap_sources(model)
    (source,) = (part for part in joined.sources if isinstance(part, HullGaps))
    compiled = features(source, configuration)
    monkeypatch.setattr(
        compiled_features.CompiledFeatures, "available", property(lambda self: False)
    )
    searched = features(source, configuration)
    assert len(searched) > 20 and len({key[0] for key in searched}) >= 2
    assert compiled == searched
