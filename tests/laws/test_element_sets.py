"""Sets of nodes and elements: the same structure as one by one, measures drawn from many."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

POINTS = np.array([[0, 0], [1, 0], [2.1, 0], [0, 1], [1.1, 0.9], [2, 1.2]], dtype=float)
CELLS = np.array([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])


@functools.cache
def plate(together: bool):
    s = da.Structure("plate")
    h = [s.parameter(f"h{k}", 0.01 * (k + 1)) for k in range(4)]
    x = s.parameter("x", POINTS[4, 0])
    modulus = s.parameter("E", 2e5)
    if together:
        points = POINTS.astype(object)
        points[4, 0] = x
        nodes = s.add_nodes("n", points)
        thickness = np.array(h, dtype=object)
        s.add_elements(
            "skin",
            structures.Triangle,
            nodes,
            CELLS,
            thickness=thickness,
            modulus=modulus,
            density=np.array([1.0, 2, 3, 4]),
        )
        s.support(nodes[[0, 3]])
        s.load(nodes[[2, 5]], fy=np.array([-1.0, -2.0]), fx=0.5)
    else:
        nodes = [s.node(f"n{k}", x if k == 4 else a, b) for k, (a, b) in enumerate(POINTS)]
        for k, cell in enumerate(CELLS):
            s.add(
                structures.Triangle(
                    f"t{k}",
                    [nodes[c] for c in cell],
                    thickness=h[k],
                    modulus=modulus,
                    density=k + 1.0,
                )
            )
        s.support(nodes[0])
        s.support(nodes[3])
        s.load(nodes[2], fx=0.5, fy=-1)
        s.load(nodes[5], fx=0.5, fy=-2)
    return s.build()


@pytest.mark.parametrize("nonlinear", [False, True])
def test_together_as_one_by_one(nonlinear):
    one, other = (da.solve_statics(plate(t), nonlinear=nonlinear) for t in (True, False))
    np.testing.assert_array_equal(one.displacements, other.displacements)
    names = [("skin[2].sxx", "t2.sxx"), ("n[4].ux", "n4.ux"), ("n[3].fx", "n3.fx")]
    names += [("mass", "mass"), ("strain_energy", "strain_energy")]
    for here, there in names:
        assert one[here] == pytest.approx(other[there], rel=1e-14)
        slopes = [
            da.sensitivity(r, da.final(n), method="adjoint").values
            for r, n in ((one, here), (other, there))
        ]
        np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-10, atol=1e-18)


@pytest.mark.parametrize("method", ["adjoint", "direct"])
@pytest.mark.parametrize("end", ["max", "min", "sum", "max(0.02)", "min(0.02)"])
def test_measures_of_all_elements(method, end):
    result = da.solve_statics(plate(True))
    single = np.array([result[f"skin[{k}].sxx"] for k in range(4)])
    smooth = 0.02
    expected = {
        "max": single.max(), "min": single.min(), "sum": single.sum(),
        "max(0.02)": np.log(np.exp(smooth * single).sum()) / smooth,
        "min(0.02)": -np.log(np.exp(-smooth * single).sum()) / smooth,
    }  # fmt: skip
    response = da.final(f"skin.sxx.{end}")
    assert result[f"skin.sxx.{end}"] == pytest.approx(expected[end], rel=1e-12)
    gradient = da.sensitivity(result, response, method=method).values
    near = da.sensitivity(result, response, method="finite-difference").values
    np.testing.assert_allclose(gradient, near, rtol=1e-6, atol=1e-9 * np.abs(near).max())


def test_selections():
    nodes = da.Structure("s").add_nodes("n", POINTS)
    assert nodes.where(x=0.0).index.tolist() == [0, 3]
    assert nodes.where(lambda x, y: y > 0.95).index.tolist() == [3, 5]
    assert nodes.nearest(1.05, 1.0).names == ["n[4]"]
    assert nodes.where(x=0.0).where(y=1.0).names == ["n[3]"]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda s, n: n.where(x=7.0), "no node fulfils x = 7"),
        (lambda s, n: n.where(z=0.0), "has no coordinate 'z'"),
        (lambda s, n: n[9], "has 6 nodes; there is no 9"),
        (lambda s, n: s.add_nodes("m", np.zeros((2, 3))), "has 3 coordinates, n has 2"),
        (lambda s, n: s.add_nodes("m", [1.0, 2.0]), r"got shape \(2,\)"),
        (lambda s, n: s.add_nodes("m", [[np.nan, 0.0]]), "is not finite"),
        (lambda s, n: cells(s, n, [[0, 1, 9]]), r"skin\[0\]: counts nodes \[0, 1, 9\]"),
        (lambda s, n: cells(s, n, [[0, 1]]), r"whole numbers \(count, 3\)"),
        (lambda s, n: cells(s, n, CELLS, thick=1.0), "has no thick"),
        (lambda s, n: cells(s, n, CELLS, thickness=[0.1, 0.2, -0.3, 0.1]), r"skin\[2\].thickness"),
        (lambda s, n: cells(s, n, CELLS, thickness=[0.1, 0.2]), "2|size|component"),
        (lambda s, n: s.load(n, fx=[1.0, 2.0]), "has 6 node"),
        (
            lambda s, n: s.support(n[0]) or s.support(n[0], ux=0.1) or cells(s, n, CELLS),
            "is fixed, and ux",
        ),
        (lambda s, n: cells(s, n, CELLS[:2]), r"n\[2\]: is not connected"),
    ],
)
def test_wrong_sets_are_refused(wrong, message):
    structure = da.Structure("s")
    nodes = structure.add_nodes("n", POINTS)
    with pytest.raises(da.DalembertError, match=message):
        wrong(structure, nodes)


def cells(structure, nodes, which, **numbers):
    arguments = {"thickness": 0.1, "modulus": 1.0} | numbers
    structure.add_elements("skin", structures.Triangle, nodes, which, **arguments)
    structure.build()
