"""Trees and loops in space in joint coordinates: the same mechanics as in those of the bodies."""

from __future__ import annotations

import itertools

import casadi as ca
import numpy as np
import pytest
from joint_views import accelerations, assert_same
from spatial_trees import KINDS, SpatialTree
from thorough import sampled

import dalembert as da
from dalembert import spatial
from dalembert.elements.spatial.joint import TreeJoint
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates

REACTIONS = ("augmented", "projected")
SEEDS = sampled(itertools.product(range(6), REACTIONS), 3)


def test_every_tree_joint_is_among_these():
    kinds = {name for name in spatial.__all__ if issubclass(getattr(spatial, name), TreeJoint)}
    assert kinds == set(KINDS)


def assert_absolute(model: da.Model, reactions: str, formulation=None) -> None:
    """Poses, speeds, v̇ and every λ at the start are those of absolute coordinates."""
    view = JointCoordinates(reactions=reactions).view(model)
    expected = accelerations(da.AbsoluteCoordinates().view(model))
    assert_same(accelerations(view, formulation or da.RangeSpace()), expected)


@pytest.mark.few(2)
@pytest.mark.parametrize(("seed", "reactions"), SEEDS)
def test_random_trees(seed, reactions):
    """Fixed and floating, joints from either end, gravity, springs between any two bodies."""
    tree = SpatialTree(seed).grow(2 + seed % 4, list(KINDS), floating=bool(seed % 2)).springs()
    model = tree.system.build()
    assert JointCoordinates().view(model).equations.constraint_count == 0
    assert_absolute(model, reactions)


@pytest.mark.few(1)
@pytest.mark.parametrize(("seed", "reactions"), SEEDS)
def test_random_loops(seed, reactions):
    tree = SpatialTree(seed).grow(4, ["Spherical", "Revolute", *KINDS]).springs()
    tree.joint("Spherical", 4, seed % 2, "closing")
    model = tree.system.build()
    assert JointCoordinates().view(model).equations.constraint_count > 0
    assert_absolute(model, reactions)


def closed_chain(seed: int) -> da.Model:
    """A mass, a place of a joint and a stiffness are parameters."""
    tree = SpatialTree(seed, ("m2", "closing_x", "k0")).grow(3, ["Spherical", "Revolute"]).springs()
    tree.joint("Spherical", 3, 0, "closing")
    return tree.system.build()


def test_motion_is_the_absolute_one():
    """Tight error control: y, v, v̇ and λ to 1e-9, and the work, whose error nobody controls."""
    model = closed_chain(2)
    one, other = (
        da.solve_dynamics(
            model,
            0.3,
            coordinates=coordinates,
            integrator=da.DormandPrince853(1e-12, 1e-12),
            outputs=4,
        ).trajectory
        for coordinates in (JointCoordinates(), da.AbsoluteCoordinates())
    )
    assert_same(
        [one.y, one.v, one.a, one.multiplier], [other.y, other.v, other.a, other.multiplier]
    )
    assert_same([one.work], [other.work], 1e-8)


@pytest.mark.thorough
def test_gradients():
    """Of a closed chain, through a reaction in the tree too: direct = adjoint = differences."""
    model = closed_chain(1)
    motion = da.solve_dynamics(model, 0.2, step=0.01, coordinates=JointCoordinates())
    responses = [da.final("b3.x"), da.mean(f"{model.constraints[0].name}.force_norm")]
    direct, adjoint, differences = (
        da.sensitivity(motion, responses, method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    )
    scale = np.abs(direct).max(axis=1, keepdims=True)
    assert np.abs((direct - adjoint) / scale).max() < 1e-9
    assert np.abs((direct - differences) / scale).max() < 1e-6


def test_a_particle_on_a_string_of_bodies():
    """A particle at either end of a ball joint, which leaves it no rotation."""
    tree = SpatialTree(3).grow(2, ["Revolute"])
    for k, end in enumerate((tree.system.elements["b2"], tree.system.ground)):
        place = end.point(0.3, 0.1, -0.2)
        at = np.array([0.3, 0.1, -0.2])
        if k == 0:
            at = tree.places[2][1] + tree.places[2][2] @ at
        dot = tree.system.add(spatial.Particle(f"dot{k}", mass=0.7, position=tuple(at)))
        ends = (place, dot.center)[:: 1 if k else -1]
        tree.system.add(spatial.Spherical(f"P{k}", *ends))
    bob = tree.system.add(
        spatial.Body("bob", mass=0.4, inertia=(0.1, 0.2, 0.15), position=(0.3, 0.3, -0.2))
    )
    tree.system.add(spatial.Spherical("Q", dot.center, bob.point(0, -0.2, 0)))
    assert_absolute(tree.system.build(), "augmented")


def test_a_cross_without_mass():
    """Two hinges on a massless body in the middle of a tree: M̄ is regular though M is not."""
    system = da.System("cross", gravity=(0.2, 0.1, -9.81))
    first, cross, last = (
        system.add(
            spatial.Body(
                name, mass=mass, inertia=(0.1 * mass, 0.2 * mass, 0.15 * mass), position=(0, 0, z)
            )
        )
        for name, mass, z in (("first", 1.0, -0.5), ("cross", 0.0, -1.0), ("last", 0.7, -1.5))
    )
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), first.point(0, 0, 0.5)))
    hinge = first.frame((0, 0, -0.5), axis=(1, 0, 0)), cross.frame(axis=(1, 0, 0))
    system.add(spatial.Revolute("R", *hinge))
    hinge = last.frame((0, 0, 0.5), axis=(0, 1, 0)), cross.frame(axis=(0, 1, 0))
    system.add(spatial.Revolute("Q", *hinge))
    assert_absolute(system.build(), "augmented")


def arm(count: int, full_turns: float = 0.0) -> da.System:
    """Hinges about z and y in turn."""
    system = da.System("arm", gravity=(0.0, 0.0, -9.81))
    last, at, place = system.ground, (0.0, 0.0, 0.0), np.zeros(3)
    for k in range(count):
        axis = (0, k % 2, 1 - k % 2)
        link = spatial.Body(
            f"b{k}",
            mass=1.0,
            inertia=(0.02, 0.03, 0.01),
            center_of_mass=(0, 0, 0.15),
            position=tuple(place),
            rotation=da.rotation.axis_angle((0, 0, 1), 0.0),
            angular_velocity=(0, 0, full_turns),
        )
        system.add(link)
        hinge = spatial.Revolute(f"J{k}", last.frame(at, axis=axis), link.frame(axis=axis))
        system.add(hinge)
        last, at = link, (0.0, 0.05, 0.3)
        place = place + at
    return system


@pytest.mark.thorough
def test_cost_grows_with_the_number_of_bodies():
    """Operations of one acceleration: linear, and fewer than in absolute coordinates."""
    count = {}
    for n in (5, 10, 20):
        model = arm(n).build()
        for coordinates in (JointCoordinates(), da.AbsoluteCoordinates()):
            e = coordinates.view(model).equations
            function = da.RangeSpace().acceleration(e, e.constraint_acceleration).function
            count[type(coordinates), n] = function.n_nodes()
    own, all_bodies = JointCoordinates, da.AbsoluteCoordinates
    first, second = count[own, 10] - count[own, 5], count[own, 20] - count[own, 10]
    assert second == pytest.approx(2 * first, rel=0.01)
    assert count[own, 20] < 2 / 3 * count[all_bodies, 20]


def test_angles_go_round():
    """A joint coordinate counts turns; its first reading is in (−π, π]."""
    system = arm(1, full_turns=30.0)
    motion = da.solve_dynamics(system.build(), 1.0, step=0.01, coordinates=JointCoordinates())
    assert motion.status.success
    turned = float(motion["b0.euler_parameters"][-1][0])
    assert turned == pytest.approx(np.cos(15.0), abs=1e-9)


def test_a_driver_between_neighbours_moves_their_joint_alone():
    """However many bodies come before, from either end: its row of C has no other entries."""
    tree = SpatialTree(4).grow(1, ["Revolute"])
    for k, ends in enumerate(((1, 2), (3, 2)), 2):
        tree.body()
        tree.joint("Cylindrical", *ends, f"C{k}")
        joint = tree.system.elements[f"C{k}"]
        tree.system.add(spatial.RotationalDriver(f"turn{k}", joint, 0.4 * da.sin(2 * da.t)))
        tree.system.add(spatial.TranslationalDriver(f"slide{k}", joint, 0.1 * da.t**2))
    model = tree.system.build()
    view = JointCoordinates().view(model)
    pattern = view.equations.jacobian.sparsity()
    rows = zip(*pattern.get_triplet(), strict=True)
    moved = {(int(row) // 2, view.names[column].split(".")[0]) for row, column in rows}
    assert moved == {(0, "C2"), (1, "C3")}
    assert_absolute(model, "augmented")


@pytest.mark.parametrize("formulation", [da.RangeSpace(), da.AugmentedLagrangian()])
def test_redundant_hinges(formulation):
    """A parallelogram of hinges: rows left out or kept, what the bodies feel is the absolute."""
    system = da.System("parallelogram", gravity=(0.3, -9.81, 0.0))
    beam = spatial.Body("beam", mass=3.0, inertia=(0.1, 0.9, 1.0), position=(1.3, 0.4, 0.0))
    system.add(beam)
    for k in range(3):
        crank = spatial.Body(
            f"crank{k}",
            mass=1.0 + k,
            inertia=(0.01, 0.02, 0.02),
            center_of_mass=(0.25, 0, 0),
            position=(k, 0, 0),
            rotation=da.rotation.axis_angle((0, 0, 1), 1.0),
            angular_velocity=(0, 0, 0.7),
        )
        system.add(crank)
        at = (float(k), 0.0, 0.0)
        system.add(spatial.Revolute(f"O{k}", system.ground.frame(at), crank.frame()))
        system.add(spatial.Revolute(f"A{k}", crank.frame((0.5, 0, 0)), beam.frame((k - 1.0, 0, 0))))
    model = system.build()
    e = model.all_equations
    pull = ca.Function("f", [e.t, e.y, e.p, e.multiplier], [ca.mtimes(e.jacobian.T, e.multiplier)])
    view = JointCoordinates().view(model, formulation.every_equation)
    results = []
    for seen, method in ((view, formulation), (da.AbsoluteCoordinates().view(model), da.KKT())):
        y, speed, a, multiplier = accelerations(seen, method)
        felt = pull(0.0, y, model.nominal, multiplier).full().ravel()
        results.append([y, speed, a, felt])
    assert_same(*results)


def test_modes_are_the_absolute_ones():
    """A ball joint's coordinates have one direction more than it can move."""
    system = da.System("hanging", gravity=(0, 0, -9.81))
    bodies = [
        system.add(spatial.Body(f"b{k}", mass=1.0, inertia=(0.1, 0.12, 0.05), position=(0, 0, z)))
        for k, z in enumerate((-0.5, -1.5))
    ]
    top, tip = system.ground.frame(), bodies[0].frame((0, 0, 0.5))
    hinge = [
        body.frame((0, 0, z), axis=(1, 0, 0)) for body, z in zip(bodies, (-0.5, 0.5), strict=True)
    ]
    system.add(spatial.Spherical("S", top, tip))
    system.add(spatial.Revolute("R", *hinge[::-1]))
    system.add(spatial.TorsionSpring("T", top, tip, stiffness=1.0))
    model = system.build()
    computed, expected = (
        np.sort(np.abs(da.linearize(model, coordinates=c).eigenvalues))
        for c in (JointCoordinates(), da.AbsoluteCoordinates())
    )
    np.testing.assert_allclose(computed, expected, rtol=1e-9)
