"""Spring structures of chapter 8: assembly, partition, solution, and gradients three ways."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert.analysis.equilibrium.statics import solve_statics
from dalembert.io.spring_deck import load_deck

EXAMPLES = Path(__file__).parents[2] / "examples"
TIES = [(1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (1, 2), (3, 5), (6, 7)]
STIFFNESS = [2.0, 3.0, 3.0, 3.0, 4.0, 4.0, 5.0, 5.0]
COMPLIANCE_DECK = """3, 2, 2, 1
3, 1, 0.
1, 2, 0.
1, 1.
2, 2.
3, 0.
2
'spring', 1, 1.0
'spring', 2, 2.0
"""


def by_hand() -> np.ndarray:
    """The unreduced stiffness matrix (8.7) of examples 8.1 to 8.5."""
    matrix = np.zeros((7, 7))
    for (i, j), k in zip(TIES, STIFFNESS, strict=True):
        ends = [i - 1, j - 1]
        matrix[np.ix_(ends, ends)] += k * np.array([[1, -1], [-1, 1]])
    return matrix


def test_seven_nodes_as_by_hand():
    """Examples 8.2, 8.4, 8.5, 8.7: matrix, partition, displacements and reactions."""
    model = load_deck(EXAMPLES / "springs.dat").build()
    matrix, force = by_hand(), np.array([0, 0, 10.0, 20, 30, 0, 0])
    computed = model.linearized.assembly.stiffness(np.zeros(7), model.nominal).toarray()
    np.testing.assert_array_equal(computed, matrix)
    free = [1, 2, 3, 4, 5]
    assert model.assembly.free.tolist() == free
    assert model.assembly.prescribed.tolist() == [0, 6]
    u = np.zeros(7)
    u[free] = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    result = solve_statics(model)
    np.testing.assert_allclose(result.displacements[:, 0], u, rtol=1e-14)
    np.testing.assert_allclose(result.forces[:, 0][[0, 6]], (matrix @ u)[[0, 6]], rtol=1e-13)
    assert result["n1.fx"] + result["n7.fx"] == pytest.approx(-60.0, abs=1e-12)


def test_internal_force_at_a_node():
    """Example 8.1: springs 2, 3 and 7 meet at node 3."""
    model = load_deck(EXAMPLES / "springs.dat").build()
    u = np.random.default_rng(1).standard_normal(7)
    held = model.assembly.internal_forces(u, model.nominal)[2]
    s = 3 * (u[2] - u[1]) - 3 * (u[3] - u[2]) - 5 * (u[4] - u[2])
    assert held == pytest.approx(s, abs=1e-14)


@pytest.fixture
def bridge(tmp_path: Path):
    path = tmp_path / "bridge.dat"
    path.write_text(COMPLIANCE_DECK)
    return load_deck(path).build()


def test_compliance_and_its_gradient_by_all_methods(bridge):
    """Examples 8.9 to 8.14: U = (3, 4), Θ = 11, ∇Θ = (−9, −1)."""
    result = solve_statics(bridge)
    assert (result["n1.ux"], result["n2.ux"]) == pytest.approx((3.0, 4.0), abs=1e-14)
    assert result["compliance"] == pytest.approx(11.0, abs=1e-13)
    for method, tolerance in (("direct", 1e-13), ("adjoint", 1e-13), ("finite-difference", 1e-8)):
        gradient = da.sensitivity(result, da.final("compliance"), method=method).values
        np.testing.assert_allclose(gradient, [[-9.0, -1.0]], atol=tolerance)


def test_pseudo_forces(bridge):
    """Example 8.15: ``D_i P − D_i K U`` element by element, for both springs."""
    result = solve_statics(bridge)
    u, model = result.displacements[:, 0], result.model
    for direction, free, held in (((1, 0), (-3, 0), 3), ((0, 1), (1, -1), 0)):
        pseudo = -model.assembly.push(u, model.nominal, np.array(direction, dtype=float))
        np.testing.assert_allclose(pseudo, [*free, held], atol=1e-14)


def test_gradients_of_displacements_and_reactions(tmp_path):
    """Example 8.16: stiffness, force and support as parameters, by hand from U and P."""
    deck = COMPLIANCE_DECK.rsplit("2\n'spring'", 1)[0]
    path = tmp_path / "all.dat"
    path.write_text(
        deck + "4\n'spring', 1, 1.0\n'spring', 2, 2.0\n'force', 2, 2.0\n'displacement', 1, 0.\n"
    )
    result = solve_statics(load_deck(path).build())
    responses = [da.final("n1.ux"), da.final("n2.ux"), da.final("n3.fx")]
    # u1 = u3 + (P1 + P2)/k1, u2 = u1 + P2/k2, reaction = −P1 − P2
    expected = [[-3, 0, 1, 1], [-3, -0.5, 1.5, 1], [0, 0, -1, 0]]
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(result, responses, method=method).values
        np.testing.assert_allclose(gradient, expected, atol=1e-13)


def test_design_with_the_program_of_the_book(tmp_path):
    """Example 8.17: parameters with bounds in the deck; least compliance for a given stiffness."""
    path = tmp_path / "design.dat"
    path.write_text(
        COMPLIANCE_DECK.replace("1, 1.0\n'", "1, 1.0, 0.5, 4.0\n'").replace(
            "2, 2.0", "2, 2.0, 0.5, 4"
        )
    )
    model = load_deck(path).build()
    assert model.parameters["d2"].bounds == (0.5, 4.0)
    total = da.Limit(da.final(model["d1"] + model["d2"], name="total"), upper=3.0)
    best = da.optimize(
        model, da.final("compliance"), subject_to=[total], analysis=da.Statics(), tolerance=1e-12
    )
    # 9/k1 + 4/k2 with k1 + k2 = 3: k1 : k2 = 3 : 2
    assert (best.x["d1"], best.x["d2"]) == pytest.approx((1.8, 1.2), abs=1e-6)
    assert best.fun == pytest.approx(25 / 3, abs=1e-9)


def test_difference_step_study(bridge):
    """Example 8.10: forward errors fall with h, central ones with h², until round-off."""
    result = solve_statics(bridge)

    def error(scheme: str, step: float) -> float:
        method = da.FiniteDifference(scheme, step)
        gradient = da.sensitivity(result, da.final("compliance"), wrt=["d1"], method=method)
        return abs(float(gradient.values[0, 0]) + 9.0)

    forward, central = ([error(s, h) for h in (1e-1, 1e-2, 1e-3)] for s in ("forward", "central"))
    np.testing.assert_allclose(np.diff(np.log10(forward)), -1.0, atol=0.05)
    np.testing.assert_allclose(np.diff(np.log10(central)), -2.0, atol=0.05)
    assert max(error("forward", h) for h in (1e-11, 1e-12, 1e-13)) > 1e-6  # round-off


@pytest.mark.parametrize(
    ("line", "text", "message"),
    [
        (1, "3, 2, 2", ":1: the line of counts needs 4 values"),
        (2, "3, x, 0.", ":2: element 1: 'x' is not a whole number"),
        (3, "1, 9, 0.", ":3: there is no node 9; there are 3"),
        (2, "3, 3, 1.", ":2: element 1 connects node 3 to itself"),
        (5, "3, 2.", ":5: node 3 has a prescribed displacement and a force"),
        (8, "'string', 1, 1.0", ":8: unknown type 'string'"),
        (9, "'spring', 7, 2.0", ":9: there is no spring 7; there are 2"),
        (9, "'spring', 1, 2.0", ":9: spring 1 has a parameter already"),
        (8, "'spring', 1, 1.0, 2.0, 4.0", ":8: .*outside"),
        (7, "3", "the deck ends before parameter 3"),
        (7, "1", ":9: more lines than the counts"),
    ],
)
def test_wrong_lines_are_named(tmp_path, line, text, message):
    lines = COMPLIANCE_DECK.splitlines()
    lines[line - 1] = text
    path = tmp_path / "wrong.dat"
    path.write_text("\n".join(lines))
    with pytest.raises(da.FileError, match=message):
        load_deck(path)


@given(text=st.text(alphabet="0123456789,. '-springe\n!", max_size=200))
@settings(max_examples=200, deadline=None)
def test_any_text_is_read_or_refused(tmp_path_factory, text):
    """No text makes anything but a structure or a refusal by name."""
    path = tmp_path_factory.mktemp("deck") / "any.dat"
    path.write_text(text)
    try:
        name_read = load_deck(path).build().name
    except (da.FileError, da.ModelError) as error:
        name_read = str(error)
    assert name_read


def test_deck_on_the_command_line(tmp_path, capsys):
    """Examples 8.5 and 8.13 by ``dalembert run``; wrong decks are wrong input."""
    from dalembert.cli.app import main

    assert main(["run", str(EXAMPLES / "springs.dat"), "--output", str(tmp_path)]) == 0
    assert "17.5145" in capsys.readouterr().out  # displacement of node 4
    assert (tmp_path / "springs.nc").exists()
    deck = tmp_path / "bridge.dat"
    deck.write_text(COMPLIANCE_DECK)
    assert main(["run", str(deck), "--output", str(tmp_path), "--csv", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["compliance gradient"] == pytest.approx({"d1": -9.0, "d2": -1.0})
    assert printed["reactions"] == pytest.approx({"n3": -3.0})
    deck.write_text(COMPLIANCE_DECK.replace("2, 2.\n", "2, two\n"))
    assert main(["run", str(deck), "--output", str(tmp_path / "new")]) == 2
    assert "bridge.dat:5: force 2: 'two' is not a number" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
    deck.write_text(COMPLIANCE_DECK)
    assert main(["run", str(deck), "--output", str(tmp_path), "--json", "--set", "d1=2"]) == 0
    assert json.loads(capsys.readouterr().out)["displacements"]["n1"] == pytest.approx(1.5)
    for wrong, message in (
        (["--set", "d9=1"], "unknown parameter 'd9' (did you mean 'd2'?); known: d1, d2"),
        (["--set", "d1=-1"], "s1.stiffness: is -1 N/m, but it must be above 0"),
        (["--set", "d1=x"], "--set d1: 'x' is not a number"),
        (["--analysis", "Kinematics"], "--analysis Kinematics: a deck is solved by linear statics"),
    ):
        assert main(["run", str(deck), "--output", str(tmp_path / "new"), *wrong]) == 2
        assert message in capsys.readouterr().err
        assert not (tmp_path / "new").exists()
    assert main(["check", str(deck)]) == 2
    assert "only 'dalembert run' and 'dalembert sensitivity' read" in capsys.readouterr().err
