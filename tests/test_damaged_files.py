"""Random formulas, damage and noise are read, or refused by one error."""

from __future__ import annotations

import pytest
from good_model import GOOD, load_or_refuse
from hypothesis import HealthCheck, given, settings, strategies as st

from dalembert.errors import DalembertError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS
from dalembert.symbolic.formulas.parser import parse_formula

WORDS = st.sampled_from(
    [
        "l1",
        "t",
        "x",
        "crank.angle",
        "1",
        "2.5",
        "1e300",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "**",
        ",",
        "<",
        ">=",
        "==",
        "[",
        "]",
        "lambda",
        ":",
        "if",
        "else",
        "'a'",
        "_",
        ".",
        "0",
        " ",
        "pi",
        "e",
        "\\",
        "not",
        "and",
        *FORMULA_FUNCTIONS,
    ]
)


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=60), st.lists(WORDS, max_size=25).map("".join)))
def test_any_formula_is_read_or_refused(text):
    def lookup(name):
        return Expression(2.0) if name in ("l1", "t", "crank.angle") else None

    try:
        formula = parse_formula(text, lookup)
    except DalembertError:
        return
    assert isinstance(formula, Expression)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_damage_is_a_dalembert_error(tmp_path, data):
    lines = GOOD.splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        k = data.draw(st.integers(0, len(lines) - 1))
        kind = data.draw(st.sampled_from(["drop", "twice", "value", "swap"]))
        if kind == "drop":
            del lines[k]
        elif kind == "twice":
            lines.insert(data.draw(st.integers(0, len(lines))), lines[k])
        elif kind == "value" and "=" in lines[k]:
            value = data.draw(
                st.sampled_from(
                    [
                        "1",
                        "-1",
                        "0",
                        "nan",
                        "true",
                        '""',
                        '"x"',
                        '"crank.x"',
                        '"l1"',
                        "[]",
                        "{}",
                        "[1, 2]",
                        '["crank", "disc"]',
                        '"t"',
                        "1e300",
                        '"1/(l1-0.3)"',
                        '"ground"',
                    ]
                )
            )
            lines[k] = lines[k].partition("=")[0] + "= " + value
        else:
            j = data.draw(st.integers(0, len(lines) - 1))
            lines[k], lines[j] = lines[j], lines[k]
    path = tmp_path / "damaged.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    load_or_refuse(path)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(content=st.one_of(st.binary(max_size=200), st.text(max_size=200).map(str.encode)))
@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_any_bytes_are_a_dalembert_error(tmp_path, suffix, content):
    path = tmp_path / f"noise{suffix}"
    path.write_bytes(content)
    load_or_refuse(path)
