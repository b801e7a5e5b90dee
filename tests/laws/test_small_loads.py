"""Linear results keep their digits however small the loads are, and so do their gradients."""

import numpy as np
import pytest

import dalembert as da
from dalembert import structures


def askew(seed: int) -> da.Structure:
    """A steel frame of space in a random pose, whose numbers and one place are parameters."""
    draws, s = np.random.default_rng(seed), da.Structure("askew")
    count, b = int(draws.integers(2, 4)), 10 ** draws.uniform(-2, -1.2)
    places = np.cumsum(np.vstack([np.zeros(3), draws.normal(size=(count, 3))]), axis=0)
    names = ("area", "second_moment_y", "second_moment_z", "torsion_constant")
    sizes = (b**2, b**4 / 12, b**4 / 10, b**4 / 7)
    numbers = {name: s.parameter(name, size) for name, size in zip(names, sizes, strict=True)}
    numbers |= {"modulus": s.parameter("modulus", 2e11), "shear_modulus": 8e10, "density": 7800.0}
    x = s.parameter("x", places[1, 0])
    nodes = [
        s.node(f"n{k}", *([x, *place[1:]] if k == 1 else place)) for k, place in enumerate(places)
    ]
    for k in range(count):
        s.add(structures.SpaceFrame(f"e{k}", nodes[k], nodes[k + 1], **numbers))
    s.support(nodes[0])
    force = s.parameter("force", 1.0)
    s.load(nodes[-1], fx=force, fy=0.3 * force, fz=-0.5 * force, mx=0.2 * force)
    return s


@pytest.mark.parametrize("seed", [1, 2])
def test_gradients_of_linear_transients(seed):
    """Products of states and weights are as small as displacements, forces at rest are not."""
    s = askew(seed)
    end = list(s.nodes)[-1]
    motion = da.solve_transient(s.build(), 0.006, step=1e-4)
    responses = [da.final(f"{end}.uy"), da.integral(f"{end}.uz"), da.final("n0.fx")]
    direct, adjoint = (
        da.sensitivity(motion, responses, method=method).values for method in ("direct", "adjoint")
    )
    values = np.array([p.value for p in motion.model.parameters.values()])
    sizes = np.abs(direct * values).max(axis=1, keepdims=True)
    assert (np.abs(adjoint - direct) * values / sizes).max() < 1e-9


def test_displacements_are_proportional_to_loads():
    model = askew(0).build()
    end = list(model.structure.nodes)[-1]
    results = []
    for force in (1.0, 1e-9):
        rest = da.solve_statics(model, parameters={"force": force})
        slopes = da.sensitivity(rest, da.final(f"{end}.uy"), method="adjoint").values[0]
        results.append(np.append(rest[f"{end}.uy"], slopes[:-1]) / force)
    np.testing.assert_allclose(*results, rtol=1e-9)


def test_nothing_is_done_silently():
    """Heat without expansion, and the last of several load cases or modes, are errors."""
    for expansion, works in ((0.0, False), (1e-5, True), (np.array([0.0, 1e-5]), True)):
        s = da.Structure("heated")
        nodes = s.add_nodes("n", [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
        arguments = {"area": 1e-4, "modulus": 2e11, "expansion": expansion}
        bars = s.add_elements("bar", structures.Truss, nodes, [(0, 1), (1, 2)], **arguments)
        if works:
            s.heat(bars, temperature=10.0)
            continue
        with pytest.raises(da.ModelError, match="bar: has no thermal expansion"):
            s.heat(bars, temperature=10.0)
        with pytest.raises(da.ModelError, match="own: has no thermal expansion"):
            s.add_elements("own", structures.Truss, nodes, [(0, 1)], temperature=5.0, **arguments)

    s = da.Structure("spring")
    end, stiffness = s.node("end", 0), s.parameter("k", 10.0)
    s.add(structures.GroundSpring("spring", end, stiffness_x=stiffness))
    for name, force in (("light", 1.0), ("heavy", 5.0)):
        s.load(end, case=name, fx=force)
    rest = da.solve_statics(s.build())
    for take in (da.evaluate, da.sensitivity):
        with pytest.raises(da.AnalysisError, match=r"2 load cases, 0, 1 \('light', 'heavy'\)"):
            take(rest, da.final("end.ux"))
    assert da.evaluate(rest.at(1), da.final("end.ux")) == da.evaluate(rest, da.at(1, "end.ux"))


def test_double_load_factors_are_told_by_their_value():
    s = da.Structure("column")
    nodes = [s.node(f"n{k}", 0.0, 0.0, k / 2) for k in range(3)]
    bending = s.parameter("I", 1e-8)
    numbers = {"area": 1e-4, "modulus": 2e11, "shear_modulus": 8e10, "torsion_constant": 2e-8}
    for k in range(2):
        own = {"second_moment_y": bending, "second_moment_z": bending}
        s.add(structures.SpaceFrame(f"e{k}", nodes[k], nodes[k + 1], **own, **numbers))
    s.support(nodes[0])
    s.load(nodes[2], fz=-1.0)
    modes = da.solve_buckling(s.build(), count=2)
    with pytest.raises(da.SingularityError, match=rf"load factor {modes.load_factors[0]:.9g}"):
        da.sensitivity(modes, da.at(1, "load_factor"))
