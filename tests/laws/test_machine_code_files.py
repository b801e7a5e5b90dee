"""Files of machine code that cannot be compiled: a warning names them, and steps run without."""

import shutil
import warnings
from pathlib import Path

import pytest

from dalembert.integrators.contact import machine_code
from dalembert.symbolic.native.c_compiler import find_compiler
from dalembert.symbolic.native.llvm import find_llvm

SOURCES = Path(machine_code.__file__).parent / "sources"
LOOPS = "sweep.c", "sweeps.c"


class Folder:
    """Resources of a folder."""

    def __init__(self, folder: Path):
        self.files = lambda package: folder


@pytest.mark.few(4)
@pytest.mark.parametrize("find", [find_llvm, find_compiler])
@pytest.mark.parametrize(
    ("name", "line"),
    [("sweep.c", "casadi_int k = lost;"), ("sweep.c", "d = ;"), ("sweeps.c", "d = ;")],
)
def test_a_warning_names_the_file_that_cannot_be_compiled(find, name, line, tmp_path, monkeypatch):
    toolchain = find()
    if toolchain is None:
        pytest.skip("this toolchain is not installed")
    path = tmp_path / "sources" / name
    path.parent.mkdir()
    for file in (machine_code.COMMON, *LOOPS):
        shutil.copy(SOURCES / file, path.parent)
    text = path.read_text()
    path.write_text(text.replace(") {\n", f") {{\n  {line}\n", 1))
    monkeypatch.setattr(machine_code, "resources", Folder(tmp_path))
    monkeypatch.setattr(machine_code, "best_toolchain", lambda: toolchain)
    machine_code.machine_code.cache_clear()
    try:
        with pytest.warns(UserWarning, match="cannot be compiled") as caught:
            assert machine_code.machine_code(*LOOPS) is None
        assert len(caught) == 1
        message = str(caught[0].message)
        assert f"{path} cannot be compiled" in message
        assert "error" in message.lower() or "Invalid expression" in message
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            machine_code.machine_code.cache_clear()
            assert machine_code.machine_code(*LOOPS) is None  # the warning appears once
    finally:
        machine_code.machine_code.cache_clear()


def test_files_as_installed_compile_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert machine_code.machine_code(*LOOPS) is not None or not find_llvm()


def test_an_unknown_place_in_a_file_is_an_error(tmp_path, monkeypatch):
    folder = tmp_path / "sources"
    shutil.copytree(SOURCES, folder)
    text = (folder / "sweep.c").read_text()
    (folder / "sweep.c").write_text(text.replace("arg[MOBILITY]", "arg[STIFFNESS]"))
    monkeypatch.setattr(machine_code, "resources", Folder(tmp_path))
    monkeypatch.setattr(machine_code, "best_toolchain", lambda: find_llvm() or object())
    machine_code.machine_code.cache_clear()
    try:
        with pytest.raises(LookupError, match=r"sweep\.c: arg\[STIFFNESS\] is unknown"):
            machine_code.machine_code(*LOOPS)
    finally:
        machine_code.machine_code.cache_clear()
