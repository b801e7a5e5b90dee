"""Files that are none, texts that do not show what they are, and names that would do harm."""

from __future__ import annotations

import contextlib
import json
import os
import re
import socket
from pathlib import Path

import h5py
import pytest
from good_model import GOOD, LAW, K, edited, load_or_refuse
from hostile_results import HOSTILE
from hypothesis import HealthCheck, given, settings, strategies as st

import dalembert as da
from dalembert.cli import main
from dalembert.errors import FileError, ModelError
from dalembert.results.files.inspection import SEAL
from dalembert.text.wording import HIDDEN, plain_text, visible

EXAMPLES = Path(__file__).parents[1] / "examples"
STRUCTURE = """\
format = 1
kind = "structure"
[meshes.plate]
type = "Quadrilateral"
file = "part.msh"
thickness = 0.01
modulus = 1e9
"""


def refused(capsys, *arguments: str) -> str:
    """What is told of a wrong input: one message, exit code 2, nothing that a terminal obeys."""
    assert main(list(arguments)) == 2
    output = capsys.readouterr()
    assert output.err.startswith("Error: ") and not output.out
    assert "Traceback" not in output.err
    assert not HIDDEN.search(output.err), output.err.encode()
    assert len(output.err) < 2000
    return output.err


# kinds of files --------------------------------------------------------------------------
def pipe(path: Path) -> None:
    os.mkfifo(path)


def plug(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # the name of a socket must be short
    with socket.socket(socket.AF_UNIX) as connection:
        connection.bind(path.name)
    os.chdir(here)


KINDS = {
    "named pipe": pipe,
    "socket": plug,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "made up by the system": lambda path: path.symlink_to("/proc/self/pagemap"),
    "loop of links": lambda path: path.symlink_to(path.name),
    "folder": Path.mkdir,
}
NAMES = {
    "model": ("part.toml", None),
    "model in JSON": ("part.json", None),
    "deck": ("part.dat", None),
    "table": ("part.csv", edited(LAW, 'law = { type = "Table", file = "part.csv" }')),
    "mesh": ("part.msh", STRUCTURE),
    "result": ("part.nc", None),
}


@pytest.mark.skipif(not Path("/proc/self/pagemap").exists(), reason="needs the files of Linux")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_only_regular_files_are_read(kind, name, tmp_path, capsys):
    file, model = NAMES[name]
    KINDS[kind](tmp_path / file)
    source = tmp_path / file
    if model is not None:
        source = tmp_path / "model.toml"
        source.write_text(model, encoding="utf-8")
    if name == "mesh":
        pytest.importorskip("meshio")
    message = refused(
        capsys, *(["report"] if name == "result" else ["run", "--quiet"]), str(source)
    )
    assert file in message


@pytest.mark.parametrize("name", NAMES)
def test_large_files_are_refused_by_their_size(name, tmp_path, capsys):
    file, model = NAMES[name]
    with (tmp_path / file).open("wb") as stream:
        stream.truncate(10**11)
    source = tmp_path / file
    if model is not None:
        source = tmp_path / "model.toml"
        source.write_text(model, encoding="utf-8")
    message = refused(capsys, "report" if name == "result" else "run", str(source))
    assert "100000000000 bytes" in message


def test_results_that_unpack_to_too_much_are_refused(tmp_path, capsys):
    path = tmp_path / "bomb.nc"
    with h5py.File(path, "w") as file:
        dataset = file.create_dataset("time", (10**11,), "f8", chunks=(10**6,), compression="gzip")
        dataset.make_scale("time")
    assert path.stat().st_size < 100_000
    assert "800 GB" in refused(capsys, "report", str(path))


@pytest.mark.skipif(os.name == "nt", reason="needs pipes")
@pytest.mark.parametrize("name", HOSTILE)
def test_results_read_nothing_but_themselves(name, tmp_path, capsys):
    """No other file of the user, no pipe that nobody writes to, no more than a task may take."""
    HOSTILE[name](tmp_path / "hostile.nc")
    message = refused(capsys, "report", str(tmp_path / "hostile.nc"))
    assert "secret of the user" not in message and "hostile.nc" in message


def test_a_bit_that_flips_is_noticed(tmp_path):
    """In values, names, attributes, the layout and the checksum itself."""
    path = tmp_path / "sound.nc"
    stone = da.System("fall", gravity=(0, -10))
    stone.add(da.planar.Particle("stone", mass=1.0))
    da.solve_dynamics(stone.build(), 1.0, step=0.1).save(path)
    expected, content = da.load_results(path), path.read_bytes()
    for at in range(7, len(content), len(content) // 120):
        path.write_bytes(content[:at] + bytes([content[at] ^ 1 << at % 8]) + content[at + 1 :])
        with contextlib.suppress(FileError):
            assert da.load_results(path).identical(expected), at
    damaged = bytearray(content)
    path.write_bytes(content)
    with h5py.File(path) as file:
        damaged[file["position"].id.get_offset()] ^= 0x40
    for appended in (b"\n", b"\0" * 1000):  # as transfers leave them
        path.write_bytes(content + appended)
        assert da.load_results(path).identical(expected)
        path.write_bytes(bytes(damaged) + appended)
        with pytest.raises(FileError, match="checksum"):
            da.load_results(path)
    path.write_bytes(content[: content.rfind(SEAL)])  # as earlier versions wrote it
    with pytest.warns(UserWarning, match="no checksum"):
        assert da.load_results(path).identical(expected)
    path.write_bytes(content)
    with h5py.File(path, "a") as file:  # who changes a file otherwise leaves no checksum
        file["time"][0] = 0.5
    with contextlib.suppress(FileError):
        assert float(da.load_results(path).time[0]) == 0.5


@pytest.mark.parametrize("report", ["[" * 10_000, "7", '{"kind": "x"}', '{"kind": [1]}', "{"])
def test_results_of_others_are_no_traceback(report, tmp_path, capsys):
    path = tmp_path / "other.nc"
    with h5py.File(path, "w") as file:
        file["report"] = report
    refused(capsys, "report", str(path))
    assert [p.name for p in tmp_path.iterdir()] == ["other.nc"]


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damaged_results_are_refused_or_read(tmp_path, data):
    path = tmp_path / "damaged.nc"
    with h5py.File(path, "w") as file:
        file["report"] = "{}"
        file["time"] = [0.0, 1.0]
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(1, len(content)))])
    with contextlib.suppress(FileError):
        da.load_results(path)


# hidden characters ------------------------------------------------------------------------
HIDDEN_ONES = ["\0", "\x1b[31m", "\x7f", "\x9b2J", "\u202e", "\u2066", "\u2028", "\ufeff", "\ud800"]
PLACES = {
    "name": lambda text, d: d.update(name=text),
    "description": lambda text, d: d.update(description=text),
    "unit": lambda text, d: d["parameters"]["l1"].update(unit=text),
    "parameter": lambda text, d: d["parameters"].update({text: 1.0}),
    "body": lambda text, d: d["bodies"].update({text: {"mass": 1.0, "inertia": 1.0}}),
    "formula": lambda text, d: d["forces"]["spring"].update(stiffness=f"k{text}"),
    "event": lambda text, d: d["analysis"].update(events={text: "crank.angle"}),
    "response": lambda text, d: d["responses"].update({text: {"type": "Final", "measure": "k"}}),
    "unknown key": lambda text, d: d.update({text: 1}),
}


def good() -> dict:
    import tomllib

    return tomllib.loads(GOOD)


@pytest.mark.few(40)
@pytest.mark.parametrize("text", HIDDEN_ONES, ids=ascii)
@pytest.mark.parametrize("place", PLACES)
def test_hidden_characters_are_refused(place, text, tmp_path, capsys):
    document = good()
    PLACES[place](f"a{text}b", document)
    source = tmp_path / "model.json"
    source.write_text(json.dumps(document), encoding="utf-8")
    message = refused(capsys, "run", str(source))
    assert f"U+{ord(text[0]):04X}" in message
    assert [p.name for p in tmp_path.iterdir()] == ["model.json"]


@pytest.mark.parametrize("text", HIDDEN_ONES, ids=ascii)
def test_hidden_characters_are_refused_in_python(text):
    system, structure = da.System("plain"), da.Structure("plain")
    for make in (
        lambda: da.System(text),
        lambda: da.System("plain", description=text),
        lambda: da.Structure(text),
        lambda: system.parameter(text, 1.0),
        lambda: system.parameter("a", 1.0, unit=text),
        lambda: system.parameter("a", 1.0, description=text),
        lambda: structure.node(text, 0.0),
        lambda: structure.parameter("a", 1.0, unit=text),
        lambda: da.final("x", name=text).label,
        lambda: plain_text(1, "x"),
    ):
        with pytest.raises(ModelError):
            make()


@pytest.mark.thorough
@given(text=st.text())
def test_what_is_visible_can_be_shown(text):
    assert not HIDDEN.search(visible(text))
    visible(text).encode()
    assert visible(text) == text or HIDDEN.search(text)


@pytest.mark.thorough
def test_names_of_files_are_escaped_where_they_are_shown(tmp_path, capsys):
    """The file may be called anything; the terminal, the results and the page do not obey it."""
    name = os.fsdecode(b"\x1b[31m\xe2\x80\xae\xff[bold]") + ".toml"
    source = tmp_path / name
    text = GOOD.replace('name = "pendulum pair"\n', "")
    try:
        source.write_text(text, encoding="utf-8")
    except OSError:
        pytest.skip("this disk does not take such names")
    for extra in ([], ["--json"]):
        assert main(["run", str(source), "--output", str(tmp_path / "o"), *extra]) == 0
        output = capsys.readouterr()
        assert not HIDDEN.search(output.out + output.err)
        assert "[31m" in output.out and "[bold]" in output.out
    json.loads(output.out)
    (page,) = (tmp_path / "o").glob("*.html")
    assert not HIDDEN.search(page.read_text(encoding="utf-8"))
    (result,) = (tmp_path / "o").glob("*.nc")
    assert not HIDDEN.search(str(da.load_results(result).attrs))
    source.write_text("x", encoding="utf-8")
    refused(capsys, "check", str(source))


def test_names_with_marks_of_the_terminal_library(tmp_path, capsys):
    source = tmp_path / "model.toml"
    source.write_text(edited('"pendulum pair"', '"[/bold] [red]x"'), encoding="utf-8")
    assert main(["check", str(source)]) == 0
    assert "[/bold] [red]x: " in capsys.readouterr().out


# outputs ------------------------------------------------------------------------------------
def test_devices_are_not_replaced(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe")
    message = refused(capsys, "schema", "--output", str(tmp_path / "pipe"))
    assert "no regular file" in message
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.thorough
def test_what_is_read_is_not_replaced(tmp_path, capsys):
    source = tmp_path / "model.nc"
    source.write_text(GOOD, encoding="utf-8")
    assert "would be replaced" in refused(capsys, "run", str(source), "--output", str(tmp_path))
    assert source.read_text(encoding="utf-8") == GOOD
    (tmp_path / "model.toml").write_text(GOOD, encoding="utf-8")
    out = tmp_path / "o"
    assert main(["run", str(tmp_path / "model.toml"), "--output", str(out), "--no-report"]) == 0
    capsys.readouterr()
    result = str(out / "model.nc")
    assert "would be replaced" in refused(capsys, "report", result, "--output", result)
    da.load_results(result)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "--output", "a\0b"], ["null"]),
        (["run", "--analysis", ""], ["unknown type ''", "Dynamics"]),
        (["sensitivity", "--output", "a\0b"], ["null"]),
        (["check", "--set", "l1=\x1b"], ["parameters.l1"]),
        (["run", "--\u202e"], ["u202e"]),
    ],
)
def test_options_that_cannot_be(arguments, words, tmp_path, capsys):
    source = tmp_path / "model.toml"
    source.write_text(GOOD, encoding="utf-8")
    message = refused(capsys, arguments[0], str(source), *arguments[1:])
    for word in words:
        assert word in message
    assert [p.name for p in tmp_path.iterdir()] == ["model.toml"]


# names and numbers --------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[optimize]\nminimize = "peak"\nvary = ["l1", "l1"]\n', ["optimize.vary[1]", "twice"]),
        ('[sensitivity]\nwrt = ["k", "k"]\n', ["sensitivity.wrt[1]", "twice"]),
        ('[sensitivity]\nresponses = ["peak", "peak"]\n', ["sensitivity.responses[1]", "twice"]),
    ],
)
def test_named_twice(text, words, tmp_path, capsys):
    source = tmp_path / "model.toml"
    source.write_text(GOOD + text, encoding="utf-8")
    message = refused(capsys, "check", str(source))
    for word in words:
        assert word in message


def test_varied_twice_in_python():
    model = da.load_model(EXAMPLES / "four_bar.toml").build()
    with pytest.raises(ModelError, match=r"l1.*twice"):
        da.optimize(model, da.final("crank.x"), vary=["l1", "l1"], analysis=da.Dynamics(0.1))


@pytest.mark.parametrize(
    "formula",
    [
        "(" * 40 + "k" + ")" * 40,
        "(" * 10**6,
        "k**k**k**k**k**k",
        "9**9**9**9",
        "x" * 1900,
        "-" * 1900 + "k",
        "k+" * 900 + "k",
        "k" + "*k" * 900,
        "sin(" * 45 + "k" + ")" * 45,
        "k.k" + ".k" * 800,
        "1e308*1e308*k",
        "1" * 1900,
        "0x" + "f" * 1900,
        "k if k else k",
        "[k for k in k]",
        "'a'*10**9",
        "1_000",
    ],
    ids=lambda text: text[:20],
)
def test_formulas_that_would_grow(formula, tmp_path):
    source = tmp_path / "model.toml"
    source.write_text(edited(K, f'stiffness = "{formula}"'), encoding="utf-8")
    load_or_refuse(source)


NUMBERS = st.sampled_from(["nan", "-1", "0", "1e308", "-1e308", "5e-324", "1e9"])
TEXTS = st.sampled_from(['""', '"t"', '"."', '"l1 - l1"'])


@settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_damage_to_an_example_is_told(tmp_path, capsys, data):
    """Numbers, texts and lines of the examples replaced at random: success, or one message."""
    path = data.draw(st.sampled_from(sorted(EXAMPLES.glob("*.toml"))))
    lines = path.read_text(encoding="utf-8").splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        k = data.draw(st.integers(0, len(lines) - 1))
        act = data.draw(st.sampled_from(["number", "text", "drop", "twice", "swap", "cut"]))
        j = data.draw(st.integers(0, len(lines) - 1))
        if act == "number":
            lines[k] = re.sub(r"(?<=[ =\[,])[\d.]+(?=[ ,\]}]|$)", data.draw(NUMBERS), lines[k])
        elif act == "text":
            lines[k] = re.sub(r'"[^"]*"', data.draw(TEXTS), lines[k])
        elif act == "drop":
            lines[k] = ""
        elif act == "twice":
            lines.insert(j, lines[k])
        elif act == "swap":
            lines[k], lines[j] = lines[j], lines[k]
        else:
            lines[k] = lines[k][: len(lines[k]) // 2]
    source = tmp_path / "damaged.toml"
    source.write_text("\n".join(lines), encoding="utf-8")
    code = main(["check", str(source)])
    output = capsys.readouterr()
    assert code in (0, 2)
    assert "Traceback" not in output.err
    assert output.err.count("Error: ") == (1 if code else 0)
    assert not code or str(source) in output.err, output.err


@pytest.mark.parametrize("count", [10**9, 10**30, 60_000])
def test_decks_with_too_many_nodes_are_refused_at_once(count, tmp_path, capsys):
    """Nodes that no line can hold, and more than can be solved in a reasonable time."""
    lines = [f"{k + 1} {k + 2} 100." for k in range(count - 1 if count < 10**6 else 1)]
    head = f"{count} {len(lines)} 1 1"
    path = tmp_path / "part.dat"
    path.write_text("\n".join([head, *lines, "2 1.0", "1 0.0"]), encoding="utf-8")
    message = refused(capsys, "run", str(path))
    assert "part.dat:1: " in message and "nodes" in message and len(message) < 400
