"""Imported files: text of model files, formats, command."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert.cli import main
from dalembert.io.imports.toml_text import number_text, toml_text

EXAMPLES = Path(__file__).parents[1] / "examples"

numbers = st.floats(allow_nan=False, allow_infinity=False)
values = st.recursive(
    st.one_of(st.booleans(), st.integers(-(2**63), 2**63 - 1), numbers, st.text()),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.text(), inner, max_size=4)
    ),
    max_leaves=20,
)


@settings(deadline=None)
@given(st.dictionaries(st.text(), values, max_size=5), st.text(), st.text())
def test_text_is_read_as_the_same_document(document, heading, comment):
    comments = {"": heading} | dict.fromkeys(document, comment)
    assert tomllib.loads(toml_text(document, comments)) == document


@given(numbers)
def test_numbers_are_short_and_exact(number):
    text = number_text(number)
    assert float(text) == number
    assert len(text) <= max(len(repr(number)), 3)


def test_usual_numbers():
    usual = {0.1: "0.1", 2.0: "2.0", 7e10: "7e10", -1.5e8: "-1.5e8", 1e-7: "1e-7", -0.0: "0.0"}
    assert {number_text(number) for number in usual} == set(usual.values())


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_examples_keep_their_contents(path):
    document = tomllib.loads(path.read_text(encoding="utf-8"))
    text = da.Imported(path, document).text
    assert tomllib.loads(text) == document
    assert da.Imported(path, document).model_file().document


def test_other_files_are_relative_to_the_model_file(tmp_path):
    (tmp_path / "meshes").mkdir()
    document = {
        "format": 1,
        "bodies": {"a": {"type": "Mesh", "file": tmp_path / "meshes" / "a.stl"}},
    }
    imported = da.Imported(tmp_path / "arm.urdf", document)
    assert 'file = "meshes/a.stl"' in imported.text
    (tmp_path / "models").mkdir()
    text = imported.write(tmp_path / "models" / "arm.toml").read_text(encoding="utf-8")
    assert 'file = "../meshes/a.stl"' in text


def test_unknown_formats_are_refused(tmp_path, capsys):
    for name in ("arm.step", "arm", "arm.toml"):
        path = tmp_path / name
        path.write_text("", encoding="utf-8")
        assert main(["import", str(path), "--json"]) == 2
        message = json.loads(capsys.readouterr().out)["error"]["message"]
        assert str(path) in message and "\n" not in message
    assert not list(tmp_path.glob("*.toml-*"))
