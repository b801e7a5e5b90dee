"""Translation of the C text of a function to LLVM IR.

The bulk, straight-line code of scalars, is translated line by line; other functions are parsed.
Only functions that the entry calls are translated.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from dalembert.symbolic.native.c_functions import function_lines, struct_lines
from dalembert.symbolic.native.c_instructions import INT, REAL, Declarations
from dalembert.symbolic.native.c_text import CFunction, CText
from dalembert.symbolic.native.calls import called_functions
from dalembert.symbolic.native.operations import slot_count
from dalembert.symbolic.native.piece import ZEROS
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.repeats import Pieces
from dalembert.symbolic.native.straight_line import longest_input, split, straight_line
from dalembert.symbolic.native.toolchain import FIRST, PIECES, NotTranslated

CALLED = re.compile(r"(casadi_f\d+)\(arg[^,()]*, res[^,()]*, iw[^,()]*, w(?:\+(\d+))?, ")
PLACED = re.compile(r"(?:\*w\d+=|\bm\.\w+ = )w\+(\d+)\b")
"""Work of a caller that persists across calls; other work is used between calls only."""
MAX_OPERATIONS = 200_000
"""Upper limit of distinct operations; code too large for the cache gains little over the virtual
machine, whose instructions are shorter."""


@dataclass(frozen=True)
class Module:
    """LLVM IR.

    Attributes
    ----------
    text : the module
    in_memory : names of the functions whose variables are not yet promoted to registers
    """

    text: str
    in_memory: tuple[str, ...]


def translate(
    source: str, entries: Sequence[str], lanes: int, short: int, uniform: tuple[int, ...] = ()
) -> Module:
    """The functions ``entries`` of a C text and all functions they call.

    Parameters
    ----------
    source : C
    entries : names of the functions; one for several lanes
    lanes : sets of arguments evaluated side by side
    short : upper limit of operations of a body that is compiled as a whole
    uniform : indices of arguments that are equal in all lanes

    Raises
    ------
    NotTranslated
        Unknown C, control flow that depends on lanes, or uniform arguments of a function that is
        not straight-line code.
    """
    text = CText.read(source)
    _check_work(text.needed(*entries))
    parts = [_Part(text, text.needed(*entries), Real(), short)]
    if lanes > 1:
        (entry,) = entries
        own, scalar = text.split_for_lanes(entry)
        in_lanes = _Part(text, own, Real(lanes), short, uniform)
        parts = [in_lanes, _Part(scalar, list(scalar.functions.values()), Real(), short)]
        if uniform and FIRST not in [function.name for function in in_lanes.straight]:
            raise NotTranslated("uniform arguments need straight-line code")
    cuts = [cut for part in parts for cut in part.cuts]
    if (distinct := sum(cut.distinct_operations for cut in cuts)) > MAX_OPERATIONS:
        raise NotTranslated(f"{distinct:,} different operations would gain little")
    longest = max([longest_input(f) for part in parts for f in part.straight], default=1)
    zeros = f"[{longest} x {parts[0].real.ir}] zeroinitializer"
    counts = sum(c.count for c in cuts), sum(len(c.distinct) for c in cuts)
    lines = [f"@{ZEROS} = internal constant {zeros}, align 8"]
    lines.append(f"@{PIECES} = constant [2 x i64] [i64 {counts[0]}, i64 {counts[1]}]")
    if sys.platform == "win32":  # required by its linkers for floating-point code
        lines.append("@_fltused = global i32 1")
    for part in parts:
        declared = set(lines)
        lines += [x for x in part.lines() if x not in declared or not x.startswith("declare ")]
    body = "\n".join(lines)
    for entry in entries:
        head = f"i64 @{entry}("
        body = body.replace(f"define internal {head}", f"define {head}")
    return Module(body + "\n", tuple(f.name for part in parts for f in part.parsed))


class _Part:
    """Functions of a text, scalar or in lanes."""

    def __init__(
        self,
        text: CText,
        functions: list[CFunction],
        real: Real,
        short: int,
        uniform: tuple[int, ...] = (),
    ):
        self.text, self.functions, self.real, self.uniform = text, functions, real, uniform
        self.straight = [function for function in functions if function.straight]
        self.parsed = [function for function in functions if not function.straight]
        self.cuts: list[Pieces] = [split(function, short) for function in self.straight]

    def lines(self) -> list[str]:
        """IR of the functions, with the arrays, structs and declarations they need."""
        module, arrays = Declarations(self.real), self.text.arrays
        names = sorted({name for f in self.functions for name in f.uses} & set(arrays))
        for name in names:
            module.arrays[name] = INT if arrays[name][0] == "int" else REAL
        used = {name for function in self.parsed for name in function.uses}
        structs = [s for s in self.text.structs if s.split()[1] in used]
        lines = function_lines(self.functions, structs, module)
        for function, cut in zip(self.straight, self.cuts, strict=True):
            uniform = self.uniform if function.name == FIRST else ()
            lines += straight_line(function, cut, self.real, uniform)
        constants = [_array(name, *arrays[name], self.real) for name in names]
        declarations = self.real.declarations("\n".join(lines))
        return [*struct_lines(module), *constants, *declarations, *lines]


def distinct_operations(source: str, entry: str, short: int) -> int:
    """Number of operations to compile, without repetitions."""
    needed = CText.read(source).needed(entry)
    cuts = (split(function, short) for function in needed if function.straight)
    return sum(cut.distinct_operations for cut in cuts)


def _array(name: str, kind: str, count: int, numbers: list[str], real: Real) -> str:
    ir = real.ir if kind == "real" else "i64"
    numbers = numbers + ["0"] * (count - len(numbers))  # C fills the rest with zeros
    values = [real.constant(n) if kind == "real" else n for n in numbers]
    inside = ", ".join(f"{ir} {value}" for value in values)
    return f"@{name} = internal constant [{count} x {ir}] [{inside}], align 8"


def _check_work(functions: list[CFunction]) -> None:
    """Check that slots of straight-line code do not overlap with work of their callers.

    Slots are stored in the part of the work vector that CasADi reserves for the function.
    """
    needs: dict[str, int] = {}
    for function in functions:
        if function.straight:
            calls = called_functions(function.lines)
            needs[function.name] = slot_count(function) + max(
                (at + needs.get(name, 0) for name, at in calls), default=0
            )
            continue
        text = "\n".join(function.lines)
        calls = [(name, int(at or 0)) for name, at in CALLED.findall(text)]
        places = [int(at) for at in PLACED.findall(text)]
        ends = [at + needs.get(name, 0) for name, at in calls]
        for (name, at), end in zip(calls, ends, strict=True):
            if any(at < place < end for place in places):
                raise NotTranslated(f"work of {name} overlaps with that of {function.name}")
        needs[function.name] = max([*ends, *places], default=0)
