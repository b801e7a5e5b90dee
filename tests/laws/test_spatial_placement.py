"""Bodies in space without poses go where their joints close."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from spatial_twins import about, rotation

import dalembert as da
from dalembert import spatial
from dalembert.model.graph.assembly.placement import placed_guesses

TURN = da.rotation.axis_angle((1, 2, -0.5), 0.7)
MASS = {"mass": 1.0, "inertia": (0.1, 0.2, 0.15), "center_of_mass": (0.1, -0.05, 0.02)}
FIRST = {"axis": (0.2, 1.0, 0.1), "x": (1.0, 0.1, 0.3)}
SECOND = {"axis": (0.1, 0.3, 1.0), "x": (0.9, -0.4, 0.2)}


def chain(turned: bool, kinds, angle: float | None = None) -> da.Model:
    """Three bodies that hang on the ground, the second joint written from either end."""
    system = da.System("chain")
    last = system.ground.frame((0.4, 0.1, -0.2), **FIRST)
    for k, (kind, backward) in enumerate(kinds):
        rotation = TURN if turned else None
        body = system.add(spatial.Body(f"b{k}", rotation=rotation, **MASS))
        ends = last, body.frame((-0.3, 0.1, 0.2), **SECOND)
        more = {"angle": angle} if angle is not None else {}
        system.add(kind(f"J{k}", *(reversed(ends) if backward else ends), **more))
        last = body.frame((0.5, 0.2, 0.1), **FIRST)
    return system.build()


def opened(model: da.Model) -> float:
    """By how much the joints are open before assembly moves anything."""
    e, guess = model.all_equations, ca.DM(placed_guesses(model.parts))
    closed = ca.Function("closed", [e.t, e.y, e.p], [e.constraints])
    return float(ca.norm_inf(closed(0.0, guess, model.nominal)))


@pytest.mark.parametrize("backward", [False, True])
def test_bodies_of_known_orientation_are_put_where_points_meet(backward):
    model = chain(True, [(spatial.Spherical, False), (spatial.Spherical, backward)] * 2)
    assert opened(model) < 1e-12


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("kind", [spatial.Weld, spatial.Prismatic])
def test_orientations_go_through_welds_and_sliders(kind, backward):
    """R_j = R_i A_i R_z(angle) A_jᵀ, from either end."""
    model = chain(False, [(kind, False), (kind, backward), (kind, False)], angle=0.6)
    assert opened(model) < 1e-12
    axes = [_axes(**arguments) for arguments in (FIRST, SECOND)]
    first = axes[0] @ rotation(about((0, 0, 1), 0.6)) @ axes[1].T
    names = model.guesses.names
    euler = [model.start.y[names.index(f"b0.e{k}")] for k in range(4)]
    np.testing.assert_allclose(rotation(np.array(euler)), first, atol=1e-12)


def _axes(axis, x) -> np.ndarray:
    z = np.array(axis) / np.linalg.norm(axis)
    across = np.array(x) - (np.array(x) @ z) * z
    across /= np.linalg.norm(across)
    return np.column_stack([across, np.cross(z, across), z])
