"""Motion of structures: laws that every integrator and kind of element keeps, and its gradients."""

from __future__ import annotations

import functools
import itertools

import numpy as np
import pytest
from cell_meshes import places_of
from scipy.integrate import solve_ivp
from thorough import crossed

import dalembert as da
from dalembert import structures
from dalembert.analysis.transient import step as transient_step
from dalembert.analysis.transient.equation import Motions
from dalembert.elements.fem.cells import CELLS
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.integrators.marching import steps as marching_steps
from dalembert.sensitivity.checks.finite_difference import Replays

INTEGRATORS = {
    "average acceleration": da.Newmark(),
    "linear acceleration": da.Newmark(beta=1 / 6),
    "HHT": da.HHT(alpha=0.2),
    "generalised-alpha": da.GeneralizedAlpha(rho_inf=0.6),
    "asymptotic annihilation": da.GeneralizedAlpha(rho_inf=0.0),
}
NUMBERS = {
    "area": 0.5,
    "second_moment": 0.04,
    "modulus": 3.0,
    "density": 2.0,
    "shear_area": 0.3,
    "shear_modulus": 1.3,
    "poisson": 0.3,
    "thickness": 0.4,
    "expansion": 0.05,
}
"""Quantities of elements that cannot be 0.3."""


def chain(sudden: bool = False) -> da.Structure:
    """Two bars in space of one dimension: forced, damped, on a support that moves."""
    s = da.Structure("chain")
    force, width = s.parameter("force", 1.5), s.parameter("width", 0.05)
    a, b, c = (s.node(n, x) for n, x in (("a", 0.0), ("b", 1.0), ("c", 2.5)))
    s.add(structures.Truss("ab", a, b, area=2.0, modulus=s.parameter("E", 4.0), density=1.0))
    s.add(structures.Truss("bc", b, c, area=1.0, modulus=9.0, density=s.parameter("rho", 2.0)))
    s.support(a, ux=0.0 if sudden else width * da.sin(3 * da.t))
    s.load(c, fx=force if sudden else force * da.cos(2 * da.t))
    s.initial(c, ux=s.parameter("u0", 0.1), vx=s.parameter("v0", 0.3))
    return s


def arch() -> da.Structure:
    """Two bars that meet at an angle; their forces are not linear in the displacements."""
    s = da.Structure("arch")
    a, b, c = (s.node(n, *x) for n, x in (("a", (-1, 0)), ("b", (0, 0.5)), ("c", (1, 0))))
    for name, end in (("ab", a), ("cb", c)):
        s.add(structures.Truss(name, end, b, area=1.0, modulus=s.parameter(f"E_{name}", 5.0)))
        s.elements[name].density = da.Expression(2.0)
    s.support(a, ux=0.1 * da.sin(da.t), uy=0.0)
    s.support(c)
    s.load(b, fx=0.3 * da.cos(da.t), fy=-0.2)
    s.initial(b, vy=-0.4)
    return s


def exact(motion, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities at the end by a method of eighth order."""
    e = motion.record.march.equation
    inverse, free = np.linalg.inv(e.mass[e.free][:, e.free].toarray()), e.free

    def whole(time, x):
        u, v, a = (np.zeros(e.assembly.size) for _ in range(3))
        u[free], v[free] = x.reshape(2, -1)
        u[e.held], v[e.held], a[e.held] = e.support_motion(time)
        return u, v, a

    def rate(time, x):
        u, v, a = whole(time, x)
        rest = e.loads(time) - e.forces(Motions(u, v, a))
        return np.concatenate([v[free], inverse @ rest[free]])

    start = np.concatenate([motion.displacements[free, 0], motion.velocities[free, 0]])
    reference = solve_ivp(rate, (0.0, end), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return whole(end, reference.y[:, -1])[:2]


@pytest.mark.few(1)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("integrator", INTEGRATORS.values(), ids=INTEGRATORS)
def test_order_two_in_displacements_and_velocities(integrator, nonlinear):
    model = (arch() if nonlinear else chain()).build()
    options = {"integrator": integrator, "nonlinear": nonlinear, "damping": da.Rayleigh(0.1, 0.02)}
    errors = []
    for step in (0.02, 0.01):
        motion = da.solve_transient(model, 2.0, step=step, outputs=[0.0, 2.0], **options)
        u, v = exact(motion, 2.0)
        computed = (motion.displacements[:, -1] - u, motion.velocities[:, -1] - v)
        errors.append([np.abs(error).max() for error in computed])
    ratios = np.array(errors[0]) / np.array(errors[1])
    assert (ratios > 3.6).all()
    assert (np.array(errors[1]) < 5e-3).all()


@pytest.mark.parametrize("integrator", INTEGRATORS.values(), ids=INTEGRATORS)
def test_between_steps_the_motion_has_the_same_order(integrator):
    """A shorter step from the last one; at the ends of steps it is what was recorded."""
    motion = da.solve_transient(chain().build(), 1.0, step=0.01, integrator=integrator)
    again = motion.at(motion.time)
    np.testing.assert_array_equal(again.displacements, motion.displacements)
    inside = motion.at([0.5041])
    u, v = exact(motion, 0.5041)
    np.testing.assert_allclose(inside.displacements[:, 0], u, atol=2e-4)
    np.testing.assert_allclose(inside.velocities[:, 0], v, atol=1e-3)


def test_average_acceleration_conserves_energy():
    model = chain(sudden=True).build()
    motion = da.solve_transient(model, 50.0, step=0.3)
    work = motion.values("c.fx") * motion.values("c.ux")
    total = motion.values("kinetic_energy") + motion.values("strain_energy") - work
    np.testing.assert_allclose(total, total[0], rtol=1e-10)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["average acceleration", "HHT", "generalised-alpha"])
def test_no_step_is_too_long(name):
    """Steps of a hundred periods leave oscillations bounded."""
    model = chain(sudden=True).build()
    motion = da.solve_transient(model, 1e6, step=500.0, integrator=INTEGRATORS[name])
    energy = motion.values("strain_energy") + motion.values("kinetic_energy")
    assert energy.max() < 20 * energy[:10].max()


def test_momentum_follows_from_the_external_forces():
    """Reactions included: their sum is what accelerates the mass."""
    motion = da.solve_transient(chain().build(), 1.0, step=0.05, lumped=True)
    momentum = motion.mass.sum(axis=0) @ motion.accelerations
    np.testing.assert_allclose(np.asarray(momentum).ravel(), motion.forces.sum(axis=0), atol=1e-12)


def test_supports_move_exactly():
    motion = da.solve_transient(chain().build(), 1.0, step=0.1)
    time = motion.time
    for name, value in (
        ("a.ux", 0.05 * np.sin(3 * time)),
        ("a.vx", 0.15 * np.cos(3 * time)),
        ("a.ax", -0.45 * np.sin(3 * time)),
    ):
        np.testing.assert_allclose(motion.values(name), value, atol=1e-14)


# gradients -------------------------------------------------------------------------------------
def agree(motion, responses) -> None:
    """Direct and adjoint derivatives to 1e-9; where all parameters move, differences to 1e-6."""
    adjoint, direct = (
        da.sensitivity(motion, responses, method=m).values for m in ("adjoint", "direct")
    )
    scale = np.maximum(np.abs(direct).max(axis=1, keepdims=True), 1e-12)
    assert (np.abs(adjoint - direct) / scale).max() < 1e-9
    p, at = motion.parameters, Replays(motion, responses)
    way = np.where(p, np.abs(p), 1.0) * np.random.default_rng(1).uniform(0.5, 1.5, p.size)
    near, far = (at(p + h * way) - at(p - h * way) for h in (1.6e-4, 3.2e-4))
    slope = (8 * near - far) / (12 * 1.6e-4)
    assert (np.abs(slope - direct @ way) / np.maximum(np.abs(direct) @ way, 1e-12)).max() < 1e-6


@pytest.mark.few(1)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("integrator", INTEGRATORS.values(), ids=INTEGRATORS)
def test_gradients_of_every_integrator(integrator, nonlinear):
    """Damping, support motion, initial motion and loads are parameters; every kind of response."""
    structure = arch() if nonlinear else chain()
    damping = da.Rayleigh(structure.parameter("alpha", 0.1), structure.parameter("beta", 0.03))
    model = structure.build()
    motion = da.solve_transient(
        model, 1.0, step=0.05, integrator=integrator, nonlinear=nonlinear, damping=damping
    )
    free = "b.uy" if nonlinear else "c.ux"
    moving = free.replace("u", "v"), free.replace("u", "a")
    agree(
        motion,
        [
            da.final(free),
            da.at(0.777, moving[0]),
            da.at(0.333, moving[1]),
            da.integral("a.fx"),
            da.rms("ab.stress") if not nonlinear else da.mean("cb.stress"),
            da.maximum(free, smooth=0.02),
            da.mean("strain_energy"),
            da.final("kinetic_energy"),
            da.final(model[free] * da.t * model["a.fx"], "product"),
        ],
    )


@functools.cache
def model_of(name: str, dimension: int):
    """One element of a class among bars that have mass, every number of it a parameter."""
    cls = ELEMENTS[name]
    structure = da.Structure(f"{name} in {dimension}-D")
    corners = places_of(CELLS[cell_of(cls)])[:, :dimension]
    points = np.vstack([-np.ones(dimension), corners]).astype(object)
    points[-1, 0] = structure.parameter("place", corners[-1, 0])
    nodes = structure.add_nodes("n", points)
    numbers = {
        f.name: structure.parameter(f.name, NUMBERS.get(f.name, 0.3))
        for f in cls.quantity_fields()
        if f.metadata["size"] == 1
    }
    structure.add_elements("e", cls, nodes, [range(1, len(nodes))], **numbers)
    pairs = [(i, j) for i in range(len(nodes)) for j in range(i)]
    structure.add_elements(
        "bar", structures.Truss, nodes, pairs, area=0.1, modulus=2.0, density=1.0
    )
    structure.support(nodes[0], ux=structure.parameter("width", 0.1) * da.sin(2 * da.t))
    last = nodes[len(nodes) - 1]
    structure.load(last, fx=structure.parameter("force", 0.2) * da.t)
    structure.initial(last, ux=structure.parameter("u0", 0.05), vx=0.1)
    return structure.build()


KINDS = [(name, d) for name, cls in ELEMENTS.items() for d in cls.dimensions]


@pytest.mark.few(2)
@pytest.mark.parametrize(("name", "dimension", "nonlinear"), crossed(KINDS, [False, True]))
def test_gradients_of_every_kind_of_element(name, dimension, nonlinear):
    model = model_of(name, dimension)
    motion = da.solve_transient(
        model, 0.4, step=0.1, nonlinear=nonlinear, damping=da.Rayleigh(0.2, 0.05)
    )
    assert motion.status.success
    last = f"n[{len(model.structure.nodes['n']) - 1}]"
    responses = [da.final(f"{last}.ux"), da.at(0.25, f"{last}.vx"), da.mean("strain_energy")]
    agree(motion, [*responses, da.final("kinetic_energy"), da.integral("n[0].fx")])


@pytest.mark.parametrize("nonlinear", [False, True])
def test_from_static_equilibrium(nonlinear):
    """Nothing moves until a load changes, and the gradient knows where it started."""
    s = da.Structure("hanger")
    a, b, c = (s.node(n, *x) for n, x in (("a", (-1, 1)), ("b", (0, 0)), ("c", (1, 1.5))))
    width = s.parameter("width", 0.02)
    for name, end in (("ab", a), ("cb", c)):
        area = s.parameter(f"A_{name}", 0.5)
        s.add(structures.Truss(name, end, b, area=area, modulus=3.0, density=1.0))
    s.support(a, ux=width + 0.1 * width * da.where(da.t > 0.5, (da.t - 0.5) ** 3, 0.0), uy=0.0)
    s.support(c)
    s.load(b, fy=-s.parameter("weight", 0.1))
    s.initial(b, vx=0.0 * width)
    options = {"step": 0.05, "nonlinear": nonlinear, "start": "statics"}
    model = s.build()
    rest = da.solve_transient(model, 0.5, **options)
    still = da.solve_statics(model, nonlinear=nonlinear)
    np.testing.assert_allclose(rest.displacements[:, -1], still.displacements[:, 0], rtol=1e-9)
    np.testing.assert_allclose(rest.velocities, 0.0, atol=1e-12)
    motion = da.solve_transient(model, 1.0, **options)
    agree(motion, [da.final("b.uy"), da.final("b.vx"), da.mean("a.fy"), da.at(0.0, "b.ux")])


def test_rotations_without_mass():
    """Lumped masses leave rotations without any; gradients are as exact."""
    s = da.Structure("mast")
    nodes = s.add_nodes("n", np.linspace([0.0, 0.0], [0.0, 2.0], 5))
    cells = [(k, k + 1) for k in range(4)]
    density, rigidity = s.parameter("density", 3.0), s.parameter("second_moment", 0.02)
    numbers = {"area": 0.3, "modulus": 50.0, "density": density, "second_moment": rigidity}
    s.add_elements("e", structures.Frame, nodes, cells, **numbers)
    s.support(nodes[0])
    s.load(nodes[4], fx=s.parameter("force", 0.1) * da.sin(da.t))
    motion = da.solve_transient(s.build(), 1.0, step=0.05, lumped=True)
    assert motion.status.success
    agree(motion, [da.final("n[4].ux"), da.maximum("n[4].rz"), da.final("n[0].mz")])


@pytest.mark.thorough
@pytest.mark.parametrize("lumped", [False, True])
def test_gradients_of_a_body_that_tumbles(lumped):
    """Through the replacement of rotation vectors longer than π, on supports that react."""
    s = da.Structure("body")
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0.2, 0.8, 0.1]])
    nodes = s.add_nodes("n", points)
    numbers = {"area": 0.3, "torsion_constant": 0.02, "shear_modulus": 20.0, "modulus": 50.0}
    numbers |= {"second_moment_y": s.parameter("iy", 0.01), "second_moment_z": 0.02}
    density, spin = s.parameter("density", 1.0), s.parameter("spin", 8.0)
    s.add_elements("e", structures.SpaceFrame, nodes, [(0, 1), (0, 2)], density=density, **numbers)
    inertia = {"inertia_x": 0.1, "inertia_y": s.parameter("jy", 0.3), "inertia_z": 0.2}
    s.add_elements("j", structures.PointInertia, nodes, [(2,)], **inertia)
    s.support(nodes[0], ux=0.0, uy=0.1 * da.sin(da.t), uz=0.0)
    rates = np.cross([0.5, -0.3, 1.0], points)
    for k in range(3):
        arguments = dict(zip(("vx", "vy", "vz"), spin * rates[k], strict=True)) if k else {}
        s.initial(nodes[k], vrx=0.5 * spin, vry=-0.3 * spin, vrz=spin, **arguments)
    damping = da.Rayleigh(s.parameter("alpha", 0.1))
    options = {"nonlinear": True, "lumped": lumped, "damping": damping}
    motion = da.solve_transient(s.build(), 0.45, step=0.05, **options)
    assert motion.status.success
    assert motion.record.march.shortened
    responses = [
        da.final("n[2].rx"),
        da.final("n[1].vrz"),
        da.integral("n[0].fx"),
        da.at(0.43, "n[1].uy"),
    ]
    agree(motion, [*responses, da.final("kinetic_energy")])


def test_steps_are_found_however_fine_the_elements_under_a_load_are():
    """A node under a load has hardly any mass: its acceleration alone would carry it far away."""

    def tip(count: int) -> np.ndarray:
        s = da.Structure("strip")
        nodes = [s.node(f"n{k}", k / count, 0.0) for k in range(count + 1)]
        numbers = {"area": 1e-4, "second_moment": 1e-9, "modulus": 2e9, "density": 1e3}
        for k, (i, j) in enumerate(itertools.pairwise(nodes)):
            s.add(structures.Frame(f"f{k}", i, j, **numbers))
        s.support(nodes[0], ux=0.0, uy=0.0)
        s.load(nodes[-1], fy=-1.0)
        motion = da.solve_transient(s.build(), 0.02, step=1e-3, nonlinear=True)
        assert motion.status.success and not motion.warnings
        return motion[f"{nodes[-1].name}.uy"].values

    np.testing.assert_allclose(tip(60), tip(20), rtol=0.02, atol=1e-5)


# what goes wrong ---------------------------------------------------------------------------------
def swung(fast: float, monkeypatch):
    """A strip of frames that falls about its pin, and how often its equations were factorised."""
    s = da.Structure("strip")
    nodes = [s.node(f"n{k}", 0.25 * k, 0.0) for k in range(5)]
    for k, (i, j) in enumerate(itertools.pairwise(nodes)):
        numbers = {"area": 0.01, "second_moment": 1e-6, "modulus": 1e7, "density": 1e3}
        s.add(structures.Frame(f"f{k}", i, j, **numbers))
    s.support(nodes[0], ux=0.0, uy=0.0)
    s.gravity(0.0, -9.81)
    monkeypatch.setattr(transient_step, "FAST", fast)
    results, factors = [], transient_step.factors
    monkeypatch.setattr(
        transient_step, "factors", lambda *a, **k: results.append(1) or factors(*a, **k)
    )
    return da.solve_transient(s.build(), 0.4, step=0.005, nonlinear=True), len(results)


def test_factors_that_are_taken_again_change_nothing(monkeypatch):
    """Newton's method with the factors of the step before ends where it ends with new ones."""
    with monkeypatch.context() as patch:
        every, often = swung(0.0, patch)
    with monkeypatch.context() as patch:
        reused, seldom = swung(transient_step.FAST, patch)
    assert every.status.success and reused.status.success
    scale = abs(every.displacements).max()
    np.testing.assert_allclose(reused.displacements, every.displacements, atol=1e-10 * scale)
    assert 2 * seldom < often


def test_a_failed_step_keeps_what_it_had(monkeypatch):
    monkeypatch.setattr(marching_steps, "HALVINGS", 0)
    integrator = da.Newmark(max_iterations=1, tolerance=1e-14)
    motion = da.solve_transient(
        arch().build(), 1.0, step=0.1, nonlinear=True, integrator=integrator
    )
    assert motion.status.outcome is da.Outcome.NOT_CONVERGED
    assert motion.time.tolist() == [0.0]
    with pytest.raises(da.AnalysisError, match="no gradient of a run that failed"):
        da.sensitivity(motion, da.final("b.uy"))


def test_displacements_with_neither_mass_nor_stiffness_are_told():
    s = da.Structure("loose")
    a, b = s.node("a", 0.0, 0.0), s.node("b", 1.0, 0.0)
    s.add(structures.AxialSpring("spring", a, b, stiffness=1.0))
    s.support(a)
    with pytest.raises(da.SingularityError, match="neither mass nor stiffness"):
        da.solve_transient(s.build(), 1.0, step=0.1)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"integrator": da.RK4()}, da.UnsupportedError, "accept Newmark"),
        ({"damping": 0.1}, da.AnalysisError, "give Rayleigh"),
        ({"start": "moving"}, da.AnalysisError, "'rest' or 'statics'"),
        ({"start": "statics"}, da.ModelError, "drop one"),
        ({"case": "wind"}, da.AnalysisError, "no load case 'wind'"),
        ({"step": -1.0}, da.AnalysisError, "positive number of seconds"),
        ({"mass": True}, da.AnalysisError, "solve_transient"),
        ({"damping": da.Rayleigh(mass=da.t)}, da.ModelError, "depends on t"),
    ],
)
def test_wrong_choices_are_refused(options, error, message):
    with pytest.raises(error, match=message):
        da.solve_transient(chain().build(), 1.0, **({"step": 0.1} | options))


@pytest.mark.parametrize(
    ("set_motion", "message"),
    [
        (lambda s: s.initial(s.nodes["a"], ux=1.0), "is prescribed"),
        (lambda s: s.initial(s.nodes["c"], vx=1.0), "given twice"),
        (lambda s: s.initial(s.nodes["b"], vz=1.0), "unknown direction 'vz'"),
        (lambda s: s.initial(s.nodes["b"], vx=da.t), "depends on t"),
    ],
)
def test_wrong_initial_motions_are_refused(set_motion, message):
    structure = chain()

    def build():
        set_motion(structure)
        structure.build()

    with pytest.raises(da.ModelError, match=message):
        build()


def test_velocities_are_those_of_motions():
    with pytest.raises(da.AnalysisError, match="solve_transient"):
        da.solve_statics(chain().build()).values("c.vx")
