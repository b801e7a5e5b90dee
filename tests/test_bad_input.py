"""Every wrong input is one clear message: file, place, value, cure; nothing is left behind."""

from __future__ import annotations

import json
import os

import pytest
from good_model import GOOD, MASS, K, edited
from wrong_models import BAD
from wrong_parts import PARTS

from dalembert.cli import main

WRONG = BAD | PARTS


@pytest.mark.parametrize("case", WRONG, ids=[name.replace(" ", "-") for name in WRONG])
def test_one_message(case, tmp_path, capsys):
    text, words = WRONG[case]
    source, out = tmp_path / "wrong.toml", tmp_path / "out"
    source.write_text(text, encoding="utf-8")
    code = main(["run", str(source), "--output", str(out)])
    output = capsys.readouterr()
    assert code == 2, output
    assert output.err.startswith("Error: ")
    assert output.err.count(str(source)) == 1, output.err
    for word in words:
        assert word in output.err, output.err
    assert len(output.err) < 900
    assert "Traceback" not in output.err
    assert not output.out
    assert sorted(p.name for p in tmp_path.iterdir() if p != out) == ["wrong.toml"]
    drawn = ["wrong.assembly.html"] if case == "not to be assembled" else []
    assert [p.name for p in out.iterdir()] == drawn if out.exists() else not drawn


def test_response_with_unknown_measure(tmp_path, capsys):
    source = tmp_path / "wrong.toml"
    source.write_text(edited('"A.force_norm"', '"A.force_nrm"'), encoding="utf-8")
    assert main(["check", str(source)]) == 2
    message = capsys.readouterr().err
    assert "responses.peak.measure" in message
    assert "no measure 'A.force_nrm'; nearest: A.force_norm" in message


def test_several_slips_are_listed(tmp_path, capsys):
    source = tmp_path / "wrong.toml"
    source.write_text(edited(MASS, "mass = nan").replace(K, "stiffness = true"), encoding="utf-8")
    assert main(["check", str(source)]) == 2
    message = capsys.readouterr().err
    assert "bodies.crank.mass" in message
    assert "forces.spring.stiffness" in message


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"format": 1, "format": 1}', ["'format'", "twice"]),
        ('{"format": 1,}', ["JSON", "line 1", "column"]),
        ("[1, 2]", ["table", "list"]),
        ("[" * 100_000, ["JSON"]),
        ('{"format": 1, "bodies": {"b": {"mass": NaN, "inertia": 1}}}', ["bodies.b.mass", "nan"]),
        ('{"format": 1, "bodies": {"b": {"mass": null}}}', ["bodies.b.mass", "None"]),
    ],
)
def test_json(text, words, tmp_path, capsys):
    source = tmp_path / "wrong.json"
    source.write_text(text, encoding="utf-8")
    assert main(["check", str(source)]) == 2
    message = capsys.readouterr().err
    assert str(source) in message
    for word in words:
        assert word in message, message


def test_files_that_are_none(tmp_path, capsys):
    (tmp_path / "latin.toml").write_bytes("name = 'Öl'".encode("latin-1"))
    (tmp_path / "zero.toml").write_bytes(b"a = 1\x00")
    big = tmp_path / "big.toml"
    with big.open("wb") as stream:
        stream.truncate(30_000_000)
    for name, word in {
        "nothing.toml": "no such file",
        "": "folder",
        "latin.toml": "UTF-8",
        "big.toml": "bytes",
        "zero.toml": "TOML",
        "x" * 5000: "cannot be read",
        "a\0b": "null",
    }.items():
        assert main(["check", str(tmp_path / name)]) == 2
        message = capsys.readouterr().err
        assert word in message, message
        assert "Traceback" not in message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_pipe_is_refused(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe.toml")
    assert main(["check", str(tmp_path / "pipe.toml")]) == 2
    assert "regular file" in capsys.readouterr().err


def test_output_that_cannot_be_written(tmp_path, capsys):
    source = tmp_path / "good.toml"
    source.write_text(GOOD, encoding="utf-8")
    assert main(["run", str(source), "--output", str(source / "inside")]) == 2
    message = capsys.readouterr().err
    assert str(source / "inside") in message
    assert "--output" in message


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("l1", ["--set", "l1=0.25"]),
        ("l9=1", ["l9", "did you mean 'l1'"]),
        ("l1=long", ["parameters.l1", "long"]),
        ("l1=nan", ["parameters.l1"]),
        ("l1=0.9", ["parameters.l1", "0.9", "bounds"]),
    ],
)
def test_settings(setting, words, tmp_path, capsys):
    source = tmp_path / "good.toml"
    source.write_text(GOOD, encoding="utf-8")
    assert main(["check", str(source), "--set", setting]) == 2
    message = capsys.readouterr().err
    for word in words:
        assert word in message, message


def test_errors_as_json(tmp_path, capsys):
    assert main(["check", str(tmp_path / "no.toml"), "--json"]) == 2
    document = json.loads(capsys.readouterr().out)
    assert not document["ok"]
    assert document["error"]["kind"] == "FileError"
    assert "no.toml" in document["error"]["message"]


@pytest.mark.parametrize(
    "arguments", [["chek"], ["check"], ["run", "a.toml", "--wat"], ["check", "--json"]]
)
def test_wrong_arguments(arguments, capsys):
    assert main(arguments) == 2
    output = capsys.readouterr()
    assert "Traceback" not in output.err + output.out
    assert "--help" in output.err + output.out
