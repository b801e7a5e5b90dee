"""Loops over contacts in machine code, whose arrays are described in ``places``."""

from __future__ import annotations

import re
import tempfile
import warnings
from collections.abc import Iterable, Sequence
from functools import lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.place_names import with_numbers
from dalembert.symbolic.evaluation.switching import best_toolchain
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.toolchain import ENTRY, FIRST, LOOP, Call, Toolchain

COMMON = "contacts.c"
"""File of the functions that all loops use."""
HEAD = re.compile(r"^static \w+\*? (\w+)\(([^)]*)\) \{$", re.MULTILINE)
"""Name and parameters of a function."""


class Loop:
    """A loop with its arrays, which stay in place from call to call.

    Parameters
    ----------
    code : machine code
    inputs, outputs : contiguous arrays
    counts : (c,) integers
    work : memory of the loop
    """

    def __init__(
        self,
        code: Call,
        inputs: list[np.ndarray],
        outputs: list[np.ndarray],
        counts: list[int],
        work: int,
    ):
        self._code, self._sizes = code, (1, len(inputs), len(outputs))
        self.counts = np.array(counts, dtype=np.int64)
        source, target = (
            np.array([array.ctypes.data for array in part], dtype=np.uint64)
            for part in (inputs, outputs)
        )
        steps = np.zeros(len(inputs) + len(outputs), dtype=np.int64)
        pointers = np.empty((2, steps.size), dtype=np.uint64)
        memory = source, steps, target, steps, *pointers, self.counts, np.empty(max(work, 1))
        self._memory = *memory, *inputs, *outputs
        self._begins = source, source.copy(), target, target.copy()
        self._addresses = tuple(array.ctypes.data for array in memory)

    def shift(self, inputs: np.ndarray, outputs: np.ndarray) -> None:
        """Let the arrays begin later, by numbers of bytes of each."""
        source, first, target, start = self._begins
        source[:], target[:] = first + inputs, start + outputs

    def __call__(self) -> bool:
        """Run the loop once; false if it failed."""
        return self._code(*self._sizes, *self._addresses) == 1


@lru_cache
def machine_code(*names: str, constants: tuple[tuple[int, int], ...] = ()) -> Call | None:
    """Machine code of files of this package after the common one; None without a toolchain.

    Parameters
    ----------
    names : of the files
    constants : places among the counts, and their values, with which the compiler unrolls loops
    """
    toolchain = best_toolchain()
    if toolchain is None:
        return None
    files = [_source(name) for name in (COMMON, *names)]
    texts = [with_numbers(file.read_text(encoding="utf-8"), file.name) for file in files]
    for place, value in constants:
        texts = [text.replace(f"iw[{place}]", str(value)) for text in texts]
    try:
        return compiled_loop(_whole(texts), toolchain.for_loops())
    except (UnsupportedError, OSError):  # an optional acceleration
        _warn_of_errors(zip((COMMON, *names), texts, strict=True), toolchain.for_loops())
        return None


def _source(name: str) -> Traversable:
    """A file of machine code."""
    return resources.files(__package__) / "sources" / name


def _whole(texts: Sequence[str]) -> str:
    return "".join(texts) + LOOP.format(entry=ENTRY, function=FIRST)


def _warn_of_errors(files: Iterable[tuple[str, str]], toolchain: Toolchain) -> None:
    """Warn of the first file that cannot be compiled after those before it; not of a cache that
    cannot be used.

    Parameters
    ----------
    files : names and texts
    toolchain : Toolchain
    """
    texts: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files:
            texts.append(text)
            end = [] if f" {FIRST}(" in text else [_calls_of_all(text)]
            try:
                toolchain.build(_whole([*texts, *end]), Path(folder) / "loop")
            except UnsupportedError as error:
                _warn(f"{_source(name)} cannot be compiled ({error})")
                return


@lru_cache
def _warn(reason: str) -> None:
    """Warn once of a reason for which there is no machine code."""
    cure = "which takes longer. Mend the file, or install dalembert again"
    warnings.warn(f"{reason}; steps with contacts run without machine code, {cure}", stacklevel=5)


def _calls_of_all(text: str) -> str:
    """A function that calls all functions of a text, so that none is left out."""
    calls = []
    for name, parameters in HEAD.findall(text):
        declared = [part.strip() for part in parameters.split(",")]
        values = ", ".join(part.split(" ")[-1] for part in declared)
        calls.append(f"{{ {'; '.join(declared)}; {name}({values}); }}")
    head = "const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem"
    return f"static int {FIRST}({head}) {{\n{''.join(calls)}\nreturn 0;\n}}\n"
