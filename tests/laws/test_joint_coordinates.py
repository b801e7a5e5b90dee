"""Joint coordinates: explicit and implicit joints agree, and so does everything found with them."""

from __future__ import annotations

import functools
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from joint_views import accelerations, assert_same
from registry import (
    CASES,
    FORMULATIONS,
    INTEGRATORS,
    PLANAR,
    RELATED,
    SPATIAL,
    Builder,
    Observer,
    model_of,
)
from spatial_trees import KINDS, hanging_in_space
from test_random_mechanisms import tree as random_tree
from thorough import crossed

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements.planar.joint import TreeJoint
from dalembert.io.decisions.tasks import make_analysis
from dalembert.io.model_file import load_model_file
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates
from dalembert.model.graph.tree.joint_view import JointView
from dalembert.model.graph.tree.link import planar_link
from dalembert.model.graph.tree.spanning_tree import Edge, spanning_tree

EXAMPLES = Path(__file__).parents[2] / "examples"
MECHANISMS = ("four_bar", "slider_crank", "quick_return_shaper", "n_four_bar", "sliding_pendulum")
VARIANTS = [
    JointCoordinates(angles=angles, reactions=reactions)
    for angles in ("relative", "absolute")
    for reactions in ("augmented", "projected")
]


@functools.cache
def mechanism(name: str) -> da.Model:
    return load_model_file(EXAMPLES / f"{name}.toml").model()


def chain(count: int) -> da.Model:
    """Bars that hang on each other, every length and mass a parameter."""
    system = da.System("chain", gravity=(0.0, -9.81))
    last = system.ground.center
    for k in range(count):
        bar = planar.Bar(
            f"bar{k}",
            length=system.parameter(f"l{k}", 0.5 + 0.05 * k),
            mass=system.parameter(f"m{k}", 1.0 + 0.1 * k),
            angle=0.3 * k - 1.2,
            angular_velocity=system.parameter(f"w{k}", 0.4 - 0.3 * k),
        )
        system.add(bar)
        system.add(planar.Revolute(f"R{k}", last, bar.start))
        last = bar.end
    return system.build()


def parallelogram() -> da.Model:
    """Three parallel cranks on one bar: one equation of the second loop is redundant."""
    system = da.System("parallelogram", gravity=(0.0, -9.81))
    beam = system.add(planar.Bar("beam", length=2.0, mass=3.0, angle=0.0, position=(1.3, 0.4)))
    for k in range(3):
        crank = planar.Bar(f"crank{k}", length=0.5, mass=1.0 + k, angle=1.0, angular_velocity=0.7)
        system.add(crank)
        system.add(planar.Revolute(f"O{k}", system.ground.point(k, 0.0), crank.start))
        system.add(planar.Revolute(f"A{k}", crank.end, beam.point(k - 1.0, 0.0)))
    return system.build()


def at_state(view: JointView, outputs: list, seed: int | None = 0) -> list[np.ndarray]:
    """Expressions of ``t, q, q̇, q̈, p`` at the start, or beside it."""
    model, e = view.model, view.equations
    start, p = model.start, model.nominal
    q, u = (x.full().ravel() for x in view.reduce.function(0.0, start.y, start.v, p))
    a = np.zeros(u.size)
    if seed is not None:
        rng = np.random.default_rng(seed)
        dq, du, a = (0.1 * rng.standard_normal(u.size) for _ in range(3))
        q, u = e.manifold.go(q, dq), u + du
    function = ca.Function("f", [e.t, e.y, e.v, e.a, e.p], [ca.densify(out) for out in outputs])
    return [out.full() for out in function.call([0.13, q, u, a, p])]


# one joint ----------------------------------------------------------------------------------


def between_bodies(kind: type, **numbers):
    def build(q: Builder):
        return q.add(kind("J", *q.points(), **{n: q.number(n, v) for n, v in numbers.items()}))

    return build


def with_particle(kind: type, first: bool, **numbers):
    """The joint ties a particle to a body, as its first or second part."""

    def build(q: Builder):
        body = q.point(q.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7)), "P", 0.31, 0.12)
        dot = q.body("b", (1.0, 0.4), (-0.2, 0.4), 0.8, kind=planar.Particle).center
        points = (dot, body) if first else (body, dot)
        return q.add(kind("J", *points, **{n: q.number(n, v) for n, v in numbers.items()}))

    return build


JOINTS = {
    "revolute": between_bodies(planar.Revolute),
    "weld": between_bodies(planar.Weld, angle=-0.8),
    "translational": between_bodies(planar.Prismatic, angle=-0.8),
    "pin in slot": between_bodies(planar.PinInSlot),
    "rigid link": between_bodies(planar.RigidLink, length=0.8),
}
for _first in (False, True):
    _where = "first" if _first else "second"
    JOINTS[f"revolute, particle {_where}"] = with_particle(planar.Revolute, _first)
    JOINTS[f"pin in slot, particle {_where}"] = with_particle(planar.PinInSlot, _first)
    JOINTS[f"rigid link, particle {_where}"] = with_particle(planar.RigidLink, _first, length=0.8)


def test_every_tree_joint_is_among_these():
    def kinds(cls):
        below = {c for sub in cls.__subclasses__() for c in kinds(sub)}
        return below if cls.__subclasses__() else {cls}

    tested = {type(build(Builder("any", False, Observer()))) for build in JOINTS.values()}
    assert kinds(TreeJoint) == tested


@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize("name", JOINTS)
def test_a_joint_says_the_same_explicitly_and_implicitly(name, forward, absolute):
    """Φ(g(q, z)) = z (7.7), and reading q off the poses gives q back, from either end."""
    builder = Builder("joint", False, Observer())
    joint = JOINTS[name](builder)
    ends = joint.ends() if forward else joint.ends()[::-1]
    link = planar_link(joint, *ends, absolute)
    assert link.space.pose.numel() == link.pose.numel() - joint.equations.numel()
    pose = ca.substitute(link.pose, link.own, link.own_value)
    placed = ca.substitute([joint.equations, link.space.reading], [link.group.pose], [pose])
    p = [x.sx for x in builder.system.parameters.values()]
    function = ca.Function("joint", [ends[0].pose, link.space.pose, link.z, ca.vertcat(*p)], placed)
    values = [x.value for x in builder.system.parameters.values()]
    rng = np.random.default_rng(3)
    for _ in range(3):
        base, q = (rng.uniform(-1, 1, x.numel()) for x in (ends[0].pose, link.space.pose))
        z = rng.uniform(-0.3, 0.3, link.z.numel())
        opened, _ = function(base, q, z, values)
        np.testing.assert_allclose(opened.full().ravel(), z, atol=1e-14)
        _, read = function(base, q, np.zeros(z.size), values)
        np.testing.assert_allclose(read.full().ravel(), q, atol=1e-14)


# a tree ---------------------------------------------------------------------------------------

TREES = {name: functools.partial(model_of, name) for name in CASES}
for _kind in KINDS:
    for _ends in ((0, 1), (1, 0)):
        _parts = _kind, _ends
        TREES[f"spatial {_kind} {_ends}"] = functools.partial(hanging_in_space, *_parts)
SEEN = crossed(PLANAR, ["relative", "absolute"])
SEEN += [(name, "relative") for name in TREES if name not in PLANAR]
"""In space there are no absolute angles."""


@pytest.mark.few(12)
@pytest.mark.parametrize(("name", "angles"), SEEN)
def test_tree_satisfies_its_joints_at_every_level(name, angles):
    """Φ_I(g(q)) = 0, C_I D = 0, C_I γ = ξ_I (4.18)–(4.19) and C_I E = I (7.9)."""
    view = JointCoordinates(angles=angles).view(TREES[name]())
    e, m, rows = view.bodies, view.motion, view.tree_rows
    phi, c, xi = view.moved(
        [x[rows, :] for x in (e.constraints, e.jacobian, e.constraint_acceleration)]
    )
    d = m.basis.times(ca.SX.eye(m.u.numel()))
    forced = m.basis.opened_times(ca.SX.eye(len(rows)))
    products = [phi, ca.mtimes(c, d), ca.mtimes(c, m.gamma) - xi, ca.mtimes(c, forced)]
    *zeros, unit = at_state(view, products)
    for zero in zeros:
        np.testing.assert_allclose(zero, 0, atol=1e-13)
    np.testing.assert_allclose(unit, np.eye(len(rows)), atol=1e-13)


@pytest.mark.few(8)
@pytest.mark.parametrize(("name", "angles"), SEEN)
def test_operators_of_the_tree(name, angles):
    """D = ∂g/∂q by differentiation, DᵀMD, its products and solutions, and q read off the poses."""
    view = JointCoordinates(angles=angles).view(TREES[name]())
    m, inertia, k = view.motion, view.equations.inertia, view.motion.u.numel()
    e = view.bodies
    assert view.manifold.bounds.numel() == m.q.numel() - k - len(view.equations.states)
    x = ca.SX(np.random.default_rng(1).standard_normal((k, 2)))
    w = ca.SX(np.random.default_rng(2).standard_normal((e.speed_count, 2)))
    q, u = ca.substitute(view.reduce.outputs, [e.y, e.v], [m.pose, m.speed])
    (by_pose,) = view.moved([e.manifold.reading])
    d = ca.mtimes([by_pose, ca.jacobian(m.pose, m.q), view.equations.lift])
    rate = ca.jtimes(m.speed, ca.vertcat(m.q, m.u), ca.vertcat(view.equations.pose_rate, m.a))
    full = ca.mtimes([d.T, view.moved([e.mass])[0], d])
    pairs = [
        (q, m.q),
        (u, m.u),
        (m.acceleration, rate),
        (m.basis.times(x), ca.mtimes(d, x)),
        (m.basis.transposed(w), ca.mtimes(d.T, w)),
        (inertia.matrix, full),
        (inertia.times(x), ca.mtimes(full, x)),
    ]
    if not view.equations.massless:
        pairs.append((ca.mtimes(full, inertia.solve(x)), x))
    computed = at_state(view, [side for pair in pairs for side in pair])
    for one, other in zip(computed[::2], computed[1::2], strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12 * (1 + np.abs(other).max(initial=0)))


@pytest.mark.thorough
def test_cost_grows_with_the_number_of_bodies():
    """Operations of one acceleration of an open chain: linear, no quadratic part."""
    count = {}
    for n in (8, 16, 32):
        view = JointCoordinates().view(chain(n))
        e = view.equations
        acceleration = da.RangeSpace().acceleration(e, e.constraint_acceleration)
        count[n] = acceleration.frequent.function.n_nodes()
    assert count[32] - count[16] == pytest.approx(2 * (count[16] - count[8]), rel=0.01)


# the same mechanics ---------------------------------------------------------------------------


JOINED = [n for n in PLANAR if n in RELATED]
CHOSEN = crossed(JOINED, VARIANTS, 2) + crossed(SPATIAL, VARIANTS[:2])
CHOSEN += [(n, VARIANTS[k % 4]) for k, n in enumerate(n for n in PLANAR if n not in JOINED)]
"""All variants of all joints; in turn those of other laws of one driver, and of free bodies."""


@functools.cache
def expected(name: str):
    return accelerations(da.AbsoluteCoordinates().view(model_of(name)))


@pytest.mark.few(12)
@pytest.mark.parametrize(
    ("name", "choice"),
    CHOSEN,
    ids=lambda c: c if isinstance(c, str) else f"{c.angles}-{c.reactions}",
)
def test_accelerations_and_reactions_are_the_absolute_ones(name, choice):
    """Poses, speeds, v̇ and every λ at the start, also of joints in the tree (6.3), (7.13)."""
    assert_same(accelerations(choice.view(model_of(name)), da.RangeSpace()), expected(name))


@pytest.mark.few(2)
@pytest.mark.parametrize("choice", VARIANTS, ids=lambda c: f"{c.angles}-{c.reactions}")
@pytest.mark.parametrize("name", MECHANISMS)
def test_motion_of_mechanisms_is_the_absolute_one(name, choice):
    """Tight error control: y, v, v̇, λ to 1e-8, and the work, whose error nobody controls."""
    computed, expected = (
        da.solve_dynamics(
            mechanism(name),
            0.2,
            coordinates=coordinates,
            integrator=da.DormandPrince853(1e-12, 1e-12, max_step=0.005),
            outputs=4,
        )
        for coordinates in (choice, da.AbsoluteCoordinates())
    )
    assert computed.status.success
    one, other = computed.trajectory, expected.trajectory
    assert_same(
        [one.y, one.v, one.a, one.multiplier, one.work],
        [other.y, other.v, other.a, other.multiplier, other.work],
        1e-8,
    )


@pytest.mark.product
@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "chain"])
def test_every_formulation_takes_joint_coordinates(name, formulation):
    model = chain(4) if name == "chain" else mechanism(name)
    expected = accelerations(da.AbsoluteCoordinates().view(model))
    chosen = FORMULATIONS[formulation]
    view = JointCoordinates().view(model, chosen.every_equation)
    assert_same(accelerations(view, chosen), expected)


@pytest.mark.few(2)
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_every_integrator_takes_joint_coordinates(integrator):
    """Within the accuracy of the first-order methods at this step."""
    reached = [
        da.solve_dynamics(
            mechanism("four_bar"), 0.1, step=1e-3, integrator=method, coordinates=c, outputs=[0.1]
        ).trajectory.y
        for method, c in (
            (INTEGRATORS[integrator], JointCoordinates()),
            (da.DormandPrince853(1e-12, 1e-12), da.AbsoluteCoordinates()),
        )
    ]
    np.testing.assert_allclose(*reached, atol=5e-4)


@settings(max_examples=8, deadline=None)
@given(count=st.integers(2, 6), seed=st.integers(0, 10_000), pinned=st.booleans())
def test_random_trees(count, seed, pinned):
    model = random_tree(count, seed, pinned).build()
    view = JointCoordinates().view(model)
    assert view.equations.constraint_count == 0
    expected = accelerations(da.AbsoluteCoordinates().view(model))
    assert_same(accelerations(view, da.RangeSpace()), expected)


def light_rod() -> da.Model:
    """A rod without mass carries a particle: M̄ is regular though M is not."""
    system = da.System("light rod", gravity=(0.0, -9.81))
    rod = system.add(planar.Bar("rod", length=1.0, mass=0.0, angle=0.4, angular_velocity=0.7))
    dot = system.add(planar.Particle("dot", mass=1.3))
    system.add(planar.Revolute("O", system.ground.center, rod.start))
    system.add(planar.Revolute("A", rod.end, dot.center))
    return system.build()


def light_coupler() -> da.Model:
    """A coupler without mass, last in the tree: M̄ is singular, the loop holds it."""
    system = da.System("light coupler", gravity=(0.0, -9.81))
    crank = planar.Bar("crank", length=0.3, mass=1.0, angle=1.2, angular_velocity=2.0)
    coupler = planar.Bar("coupler", length=1.0, mass=0.0, angle=0.2)
    rocker = planar.Bar("rocker", length=0.6, mass=2.0, angle=1.2)
    for bar in (crank, coupler, rocker):
        system.add(bar)
    system.add(planar.Revolute("O1", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1.0, 0.0), rocker.start))
    return system.build()


@pytest.mark.few(6)
@pytest.mark.parametrize(("build", "massless"), [(light_rod, 0), (light_coupler, 1)])
@pytest.mark.parametrize("formulation", [da.RangeSpace(), da.KKT()])
@pytest.mark.parametrize("choice", VARIANTS, ids=lambda c: f"{c.angles}-{c.reactions}")
def test_bodies_without_mass(build, massless, formulation, choice):
    model = build()
    view = choice.view(model)
    assert len(view.equations.massless) == massless
    expected = accelerations(da.AbsoluteCoordinates().view(model))
    assert_same(accelerations(view, formulation), expected)


@pytest.mark.parametrize("formulation", [da.RangeSpace(), da.AugmentedLagrangian()])
def test_redundant_loops(formulation):
    """Left out or kept: motion and what the bodies feel are the absolute ones."""
    model = parallelogram()
    view = JointCoordinates().view(model, formulation.every_equation)
    assert view.equations.dropped.numel() == (0 if formulation.every_equation else 1)
    e = model.all_equations
    pull = ca.Function("f", [e.t, e.y, e.p, e.multiplier], [ca.mtimes(e.jacobian.T, e.multiplier)])
    results = []
    for v, method in ((view, formulation), (da.AbsoluteCoordinates().view(model), da.KKT())):
        y, speed, a, multiplier = accelerations(v, method)
        felt = pull(0.0, y, model.nominal, multiplier).full().ravel()
        results.append([y, speed, a, felt])
    assert_same(*results)


# gradients ------------------------------------------------------------------------------------


def check_gradients(model: da.Model, duration: float, responses: list) -> None:
    """Direct = adjoint to 1e-9, Richardson differences to 1e-6."""
    motion = da.solve_dynamics(model, duration, step=0.01, coordinates=JointCoordinates())
    direct, adjoint, differences = (
        da.sensitivity(motion, responses, method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    )
    scale = np.abs(direct).max(axis=1, keepdims=True)
    assert np.abs((direct - adjoint) / scale).max() < 1e-9
    assert np.abs((direct - differences) / scale).max() < 1e-6


def test_gradients_of_a_closed_loop():
    """Through the multiplier of a joint in the tree, too."""
    check_gradients(mechanism("four_bar"), 0.3, [da.mean("A.force_norm"), da.final("crank.angle")])


def test_gradients_of_an_open_chain():
    check_gradients(chain(3), 0.3, [da.mean("R0.force_norm"), da.final("bar2.angle")])


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "name", ["translational", "pin in slot", "weld", "rigid link", "point on formula curve"]
)
def test_gradients_with_every_number_a_parameter(name):
    check_gradients(model_of(name), 0.05, [da.final("b.x"), da.mean("J.force_norm")])


# which joints are cut -------------------------------------------------------------------------


@pytest.mark.parametrize("joint", ["O1", "A", "B", "O2"])
def test_any_joint_of_a_loop_can_be_cut(joint):
    model = mechanism("four_bar")
    view = JointCoordinates(cut=(joint,)).view(model)
    assert not any(name.startswith(f"{joint}.") for name in view.names)
    expected = accelerations(da.AbsoluteCoordinates().view(model))
    assert_same(accelerations(view, da.RangeSpace()), expected)


def test_joints_with_many_equations_are_in_the_tree():
    """A link to the ground is cut rather than two pins: two coordinates, one equation."""
    system = da.System("braced", gravity=(0.0, -9.81))
    first = system.add(planar.Bar("first", length=1.0, mass=1.0, angle=0.4))
    second = system.add(planar.Bar("second", length=1.0, mass=1.0, angle=-0.2))
    brace = planar.RigidLink("brace", system.ground.point(2.0, 1.0), second.end, length=1.2)
    system.add(brace)
    system.add(planar.Revolute("O", system.ground.center, first.start))
    system.add(planar.Revolute("A", first.end, second.start))
    view = JointCoordinates().view(system.build())
    assert view.names == ["O.angle", "A.angle"]
    assert view.equations.constraint_count == 1


@pytest.mark.parametrize(
    ("name", "cut", "message"),
    [
        ("four_bar", ("Z",), "cut 'Z' is not a joint; joints that can be cut: O1, A, B, O2"),
        ("four_bar", ("O1", "A"), "cut 'O1', 'A': nothing would carry crank"),
        ("slider_crank", ("motor",), "'motor' is always a loop equation"),
        ("sliding_pendulum", "hinge", "cut 'hinge': nothing would carry pendulum"),
    ],
)
def test_cuts_that_make_no_sense_are_refused(name, cut, message):
    with pytest.raises(da.ModelError, match=message):
        JointCoordinates(cut=cut).view(mechanism(name))


def test_a_file_chooses_joint_coordinates(tmp_path):
    text = (EXAMPLES / "four_bar.toml").read_text()
    table = '[analysis.coordinates]\ntype = "JointCoordinates"\ncut = ["A"]\nangles = "absolute"\n'
    path = tmp_path / "four_bar.toml"
    path.write_text(text.replace("[responses.peak]", table + "\n[responses.peak]"))
    file = load_model_file(path)
    assert make_analysis(file, file.model()).coordinates == JointCoordinates(("A",), "absolute")


@pytest.mark.parametrize("field", ["angles", "reactions"])
def test_unknown_words_are_refused(field):
    with pytest.raises(da.UnsupportedError, match=rf"{field}='sideways'.*choose '"):
        JointCoordinates(**{field: "sideways"})


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_spanning_trees_of_random_graphs(seed):
    """Parents first, every node once, lightest edges, and each chord closes one loop."""
    rng = np.random.default_rng(seed)
    nodes = [f"n{k}" for k in range(rng.integers(1, 9))]
    edges = [
        Edge(f"e{k}", *rng.choice(nodes, 2, replace=False), weight=int(rng.integers(-3, 0)))
        for k in range(rng.integers(0, 14) if len(nodes) > 1 else 0)
    ]
    tree = spanning_tree(nodes, edges)
    assert sorted(visit.node for visit in tree.visits) == nodes
    assert len(tree.chords) == len(edges) - len(nodes) + len(tree.roots)
    by_name = {edge.name: edge for edge in edges}
    for chord in tree.chords:
        loop = [by_name[name] for name in tree.loop(chord)]
        assert max(edge.weight for edge in loop) == chord.weight
        degree = {n: sum(n in (e.i, e.j) for e in loop) for n in nodes}
        assert set(degree.values()) <= {0, 2}


@pytest.mark.thorough
@pytest.mark.parametrize("forward", [True, False])
def test_ball_joints_between_turned_frames(forward):
    """The start is the absolute one, also where the frames of a ball joint are turned."""
    system = da.System("pendulum", gravity=(0.0, 0.0, -9.81))
    start = {"position": (0.3, 0.1, -0.2), "angular_velocity": (1, -2, 3)}
    inertia = {"mass": 2.0, "inertia": (0.1, 0.2, 0.25)}
    tilt = da.rotation.axis_angle((1, 2, 3), 0.8)
    base = system.add(spatial.Body("base", **inertia, rotation=tilt))
    bob = system.add(spatial.Body("bob", **inertia, **start))
    system.add(spatial.Revolute("hinge", system.ground.frame(axis=(0, 1, 0)), base.frame()))
    frames = [
        base.frame((0.1, 0, 0), axis=(1, 1, 0)),
        bob.frame((0, 0.2, 0.1), rotation=da.rotation.axis_angle((0, 1, 1), 2.0)),
    ]
    system.add(spatial.Spherical("ball", *(frames if forward else frames[::-1])))
    model = system.build()
    runs = [
        da.solve_dynamics(model, 0.2, integrator=da.DormandPrince(1e-10, 1e-12), coordinates=c)
        for c in (da.AbsoluteCoordinates(), JointCoordinates())
    ]
    for measure in ("bob.position", "bob.angular_velocity", "base.position"):
        absolute, joint = (run[measure].values for run in runs)
        assert np.allclose(joint[0], absolute[0], atol=1e-12)
        assert np.allclose(joint[-1], absolute[-1], atol=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("closing", ["hinge", "ball"])
def test_planar_loops_on_a_turntable(closing):
    """A row of C that vanishes at the start, and is redundant everywhere, is left out."""
    system = da.System("turntable", gravity=(0, 0, -9.81))
    body = {"mass": 1.0, "inertia": (0.1, 0.1, 0.1), "angular_velocity": (0, 0, 1.0)}
    base = system.add(spatial.Body("base", **body))
    crank = system.add(spatial.Body("crank", **body, position=(0, 0, 0.65)))
    rocker = system.add(spatial.Body("rocker", **body, position=(1, 0, 0.75)))
    coupler = system.add(spatial.Body("coupler", **body, position=(0.5, 0, 0.9)))
    upright = system.ground.frame(axis=(0, 0, 1)), base.frame(axis=(0, 0, 1))
    system.add(spatial.Revolute("turntable", *upright))

    def across(of: spatial.Body, x: float, z: float) -> spatial.Frame:
        return of.frame((x, 0, z), axis=(0, 1, 0))

    system.add(spatial.Revolute("A", across(base, 0, 0.5), across(crank, 0, -0.15)))
    system.add(spatial.Revolute("B", across(crank, 0, 0.15), across(coupler, -0.5, -0.1)))
    system.add(spatial.Revolute("D", across(base, 1, 0.5), across(rocker, 0, -0.25)))
    if closing == "hinge":
        last = spatial.Revolute("C", across(coupler, 0.5, 0.1), across(rocker, 0, 0.25))
    else:
        last = spatial.Spherical("C", coupler.point(0.5, 0, 0.1), rocker.point(0, 0, 0.25))
    system.add(last)
    model = system.build()
    absolute, joint = (
        da.solve_dynamics(model, 1.8, step=4e-3, coordinates=c)  # turns by more than 90°
        for c in (da.AbsoluteCoordinates(), JointCoordinates())
    )
    assert joint.status.success
    for measure in ("base.angular_velocity", "crank.position", "rocker.angular_velocity"):
        assert np.allclose(joint[measure][-1], absolute[measure][-1], atol=1e-6)
