"""Drawings that are none, grow without limit, contain other files, or have absurd numbers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from drawings import Linkage
from hypothesis import HealthCheck, given, settings, strategies as st

import dalembert as da
from dalembert.cli import main
from dalembert.io.imports.registry import import_model

ezdxf = pytest.importorskip("ezdxf")
ARM = Linkage([np.array([0.0, 0.0]), np.array([30.0, 0.0])], 1, {"arm": (0, 1)})
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 90">'
BAR = '<circle cx="10" cy="10" r="2"/><line x1="10" y1="10" x2="50" y2="10"/>'


def refused(path: Path, capsys, *options: str) -> str:
    """The message of ``dalembert import``: exit code 2, nothing written."""
    target = path.with_suffix(".toml")
    assert main(["import", str(path), "-o", str(target), *options]) == 2
    output = capsys.readouterr()
    assert output.err.startswith("Error: ") and path.name in output.err
    assert "Traceback" not in output.err and len(output.err) < 2000
    assert not target.exists() and not list(path.parent.glob(".*dalembert*"))
    return output.err


def svg(tmp_path: Path, content: str, head: str = HEAD) -> Path:
    path = tmp_path / "drawn.svg"
    path.write_text(f"{head}{content}</svg>", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('<line x1="nan" x2="3"/>', "drawn.svg:1: <line>: x1 is 'nan', expected a number"),
        ('<line x1="1e999" x2="3"/>', "x1 is '1e999', which is no usable number"),
        ('<line x1="2%" x2="3"/>', "x1 is '2%'"),
        ('<polyline points="1 2 3"/>', "3 numbers, expected pairs"),
        ('<path d="M 1 2 L 3"/>', "the path is wrong at character"),
        ('<path d="L 1 2"/>', "the path is wrong at character 1"),
        ('<path d="M1 2 L3 4 5;x"/>', "the path is wrong at character"),
        ('<g transform="rotate(a)"><line x2="3"/></g>', "transform is 'rotate(a)'"),
        ('<g transform="scale(1e300) scale(1e300)"><line x2="3"/></g>', "transform is"),
        ('<g transform="scale(1e200)"><line x2="3"/></g>', "is no usable number"),
        ('<g transform="scale(1e-40)"><line x2="3"/></g>', "mm large"),
        ('<text x="1" y="2">A</text>', "has no line that could move"),
        ('<circle cx="3" cy="4" r="2"/>', "has no line that could move"),
        ('<g transform="scale(1e9)"><line x2="3"/></g>', "correct its scale, or give its unit"),
    ],
)
def test_wrong_numbers_of_svg(tmp_path, capsys, content, message) -> None:
    assert message in refused(svg(tmp_path, content), capsys)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        ("<html/>", "begins with <html>, not with <svg>"),
        (f"{HEAD}<line></svg>", "not valid XML"),
        ("\x89PNG\r\n\x1a\n", "not valid XML"),
        ("<svg>" * 3000, "nested more than"),
        ('<!DOCTYPE svg [<!ENTITY a "b">]><svg>&a;</svg>', "entities"),
        ('<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/passwd">]><svg>&a;</svg>', "entities"),
        ('<!DOCTYPE svg SYSTEM "http://example.org/a.dtd"><svg>&a;</svg>', "entit"),
        ('<svg viewBox="0 0 0 1"/>', "viewBox"),
        (f"{HEAD}{BAR * 4000}</svg>", "more than 4000"),
    ],
)
def test_no_svg(tmp_path, capsys, text, message) -> None:
    path = tmp_path / "drawn.svg"
    path.write_text(text, encoding="utf-8")
    assert message in refused(path, capsys)


def test_document_type_of_drawing_programs(tmp_path) -> None:
    """The usual document type is accepted, and never fetched."""
    path = svg(tmp_path, BAR)
    public = '"-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd"'
    path.write_text(f"<!DOCTYPE svg PUBLIC {public}>{path.read_text('utf-8')}", encoding="utf-8")
    assert import_model(path).build().diagnosis.degrees_of_freedom == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(200), "cannot be read as DXF"),
        (b"0\nSECTION\n2\nENTITIES\n0\nLINE\n", "DXF"),
        (b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(range(256)), "cannot be read as DXF"),
        (b"<svg/>", "cannot be read as DXF"),
    ],
)
def test_no_dxf(tmp_path, capsys, content, message) -> None:
    path = tmp_path / "drawn.dxf"
    path.write_bytes(content)
    assert message in refused(path, capsys)


def test_wrong_numbers_of_dxf(tmp_path, capsys) -> None:
    for values, message in (
        ((float("nan"), 0.0), "LINE"),
        ((1e200, 0.0), "is no usable number"),
        ((1e12, 0.0), "mm large"),
    ):
        document = ezdxf.new()
        document.header["$INSUNITS"] = 4
        document.modelspace().add_line((0, 0), values)
        document.saveas(tmp_path / "drawn.dxf")
        assert message in refused(tmp_path / "drawn.dxf", capsys)


def test_blocks_in_blocks(tmp_path, capsys) -> None:
    """Ten blocks of ten blocks, seven deep, would be ten million lines."""
    document = ezdxf.new()
    block = document.blocks.new("B0")
    block.add_line((0, 0), (1, 1))
    for depth in range(1, 8):
        outer = document.blocks.new(f"B{depth}")
        for _ in range(10):
            outer.add_blockref(f"B{depth - 1}", (0, 0))
    document.modelspace().add_blockref("B7", (0, 0))
    document.saveas(tmp_path / "drawn.dxf")
    assert "more than" in refused(tmp_path / "drawn.dxf", capsys)


def test_too_large_and_wrong_suffix(tmp_path, capsys, monkeypatch) -> None:
    path = ARM.dxf(tmp_path / "drawn.dxf")
    monkeypatch.setenv("DALEMBERT_BUDGET", "1e-6")
    assert "memory" in refused(path, capsys)
    monkeypatch.delenv("DALEMBERT_BUDGET")
    assert "not valid XML" in refused(path.rename(tmp_path / "drawn.svg"), capsys)
    assert "unknown format '.dwg'" in refused(Path(tmp_path / "drawn.dwg"), capsys)


def test_nothing_else_is_read(tmp_path, monkeypatch) -> None:
    """References to files and servers are listed, not followed."""
    path = svg(
        tmp_path,
        BAR + '<image href="file:///etc/passwd"/><use href="../other.svg#a"/>'
        '<style>@import url("http://example.org/a.css");</style><script>x</script>',
    )
    opened = []
    real = Path.open

    def recorded(self, *arguments, **keywords):
        opened.append(self)
        return real(self, *arguments, **keywords)

    monkeypatch.setattr(Path, "open", recorded)
    imported = import_model(path)
    assert opened == [path]
    listed = [o.content for o in imported.omissions]
    assert listed == ["unit of length", "<image>", "<use>", "<script>"]


def test_options_are_checked(tmp_path) -> None:
    path = ARM.dxf(tmp_path / "drawn.dxf")
    for options, message in (
        ({"tolerance": -1}, "tolerance: is -1; give a number above 0"),
        ({"tolerance": "1 kg"}, "tolerance: 1 kg does not fit"),
        ({"unit": "kg"}, "does not fit"),
        ({"unit": "parrots"}, "parrots"),
        ({"mass_per_length": "1 m"}, "mass_per_length"),
        ({"speed": float("nan")}, "speed: is nan"),
        ({"scale": 2}, "unknown option 'scale'"),
    ):
        with pytest.raises(da.DalembertError, match=message):
            import_model(path, **options)


GOOD = {".svg": (HEAD + BAR + "</svg>").encode()}


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data(), st.sampled_from([".svg", ".dxf"]))
def test_random_bytes(tmp_path_factory, data, suffix) -> None:
    """Random and damaged files raise the errors of this package only."""
    folder = tmp_path_factory.mktemp("drawing")
    if suffix not in GOOD:
        GOOD[suffix] = ARM.dxf(folder / "good.dxf").read_bytes()
    content = bytearray(GOOD[suffix])
    for _ in range(data.draw(st.integers(1, 6))):
        start = data.draw(st.integers(0, len(content)))
        end = min(len(content), start + data.draw(st.integers(0, 30)))
        content[start:end] = data.draw(st.binary(max_size=12))
    if data.draw(st.integers(0, 9)) == 0:
        content = bytearray(data.draw(st.binary(max_size=300)))
    path = folder / f"drawn{suffix}"
    path.write_bytes(content)
    message = ""
    try:
        import_model(path)
    except da.DalembertError as error:
        message = str(error)
    assert not message or path.name in message
    json.dumps(message)
