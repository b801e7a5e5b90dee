"""C text of a function → LLVM IR.

The bulk, straight lines of scalars, goes line by line; what stands around it is parsed. Only what
the entry calls is translated.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass

from dalembert.symbolic.native.c_functions import struct_lines, written_functions
from dalembert.symbolic.native.c_instructions import Surroundings
from dalembert.symbolic.native.c_text import CFunction, CText
from dalembert.symbolic.native.c_types import INT, REAL
from dalembert.symbolic.native.calls import called_from
from dalembert.symbolic.native.lines import slot_count
from dalembert.symbolic.native.loop import FIRST, PIECES
from dalembert.symbolic.native.piece import ZEROS
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.repeats import Pieces
from dalembert.symbolic.native.straight_line import cut_up, longest_input, straight_line
from dalembert.symbolic.native.toolchain import NotTranslated

CALLED = re.compile(r"(casadi_f\d+)\(arg[^,()]*, res[^,()]*, iw[^,()]*, w(?:\+(\d+))?, ")
PLACED = re.compile(r"(?:\*w\d+=|\bm\.\w+ = )w\+(\d+)\b")
"""Numbers of a caller that outlast calls; others in the work vector are made and used between."""


MOST = 200_000
"""Different operations from which machine code gains little over the virtual machine, whose
instructions are shorter: code that does not fit the caches is read from memory in every step."""


@dataclass(frozen=True)
class Module:
    """LLVM IR.

    Attributes
    ----------
    text : the module
    in_memory : names of the functions whose variables are not in registers yet
    """

    text: str
    in_memory: tuple[str, ...]


def translated(
    source: str, entry: str, lanes: int, short: int, alike: tuple[int, ...] = ()
) -> Module:
    """The function ``entry`` of a C text and all it calls.

    Parameters
    ----------
    source : C
    entry : name of the function
    lanes : numbers in the place of one
    short : operations up to which a body is compiled as a whole
    alike : numbers of arguments that are the same in all lanes

    Raises
    ------
    NotTranslated
        There is C in it that is not known, lanes do not agree on a choice, or arguments that are
        the same in all lanes go to what is no straight body.
    """
    text = CText.read(source)
    _check_work(text.needed(entry))
    parts = [_Part(text, text.needed(entry), Real(), short)]
    if lanes > 1:
        own, lone = text.parted(entry)
        others = list(lone.functions.values())
        parts = [_Part(text, own, Real(lanes), short, alike), _Part(lone, others, Real(), short)]
        if alike and FIRST not in [function.name for function in parts[0].straight]:
            raise NotTranslated("arguments are the same in all lanes for straight bodies only")
    cuts = [cut for part in parts for cut in part.cuts]
    if (different := sum(cut.different_operations for cut in cuts)) > MOST:
        raise NotTranslated(f"{different:,} different operations would gain little")
    longest = max([longest_input(f) for part in parts for f in part.straight], default=1)
    zeros = f"[{longest} x {parts[0].real.ir}] zeroinitializer"
    counts = sum(c.count for c in cuts), sum(len(c.different) for c in cuts)
    lines = [f"@{ZEROS} = internal constant {zeros}, align 8"]
    lines.append(f"@{PIECES} = constant [2 x i64] [i64 {counts[0]}, i64 {counts[1]}]")
    if sys.platform == "win32":  # its linkers want to know of numbers like these
        lines.append("@_fltused = global i32 1")
    head = f"i64 @{entry}("
    for part in parts:
        told = set(lines)
        lines += [x for x in part.lines() if x not in told or not x.startswith("declare ")]
    body = "\n".join(lines).replace(f"define internal {head}", f"define {head}")
    return Module(body + "\n", tuple(f.name for part in parts for f in part.parsed))


class _Part:
    """Functions of a text, for numbers or for lanes."""

    def __init__(
        self,
        text: CText,
        functions: list[CFunction],
        real: Real,
        short: int,
        alike: tuple[int, ...] = (),
    ):
        self.text, self.functions, self.real, self.alike = text, functions, real, alike
        self.straight = [function for function in functions if function.straight]
        self.parsed = [function for function in functions if not function.straight]
        self.cuts: list[Pieces] = [cut_up(function, short) for function in self.straight]

    def lines(self) -> list[str]:
        """Their IR and that of what they need."""
        around, arrays = Surroundings(self.real), self.text.arrays
        wanted = sorted({name for f in self.functions for name in f.uses} & set(arrays))
        for name in wanted:
            around.arrays[name] = INT if arrays[name][0] == "int" else REAL
        used = {name for function in self.parsed for name in function.uses}
        structs = [s for s in self.text.structs if s.split()[1] in used]
        lines = written_functions(self.functions, structs, around)
        for function, cut in zip(self.straight, self.cuts, strict=True):
            alike = self.alike if function.name == FIRST else ()
            lines += straight_line(function, cut, self.real, alike)
        told = [_array(name, *arrays[name], self.real) for name in wanted]
        return [*struct_lines(around), *told, *self.real.declarations("\n".join(lines)), *lines]


def different_operations(source: str, entry: str, short: int) -> int:
    """How many operations would be compiled, of which others are repetitions."""
    needed = CText.read(source).needed(entry)
    cuts = (cut_up(function, short) for function in needed if function.straight)
    return sum(cut.different_operations for cut in cuts)


def _array(name: str, kind: str, count: int, numbers: list[str], real: Real) -> str:
    ir = real.ir if kind == "real" else "i64"
    numbers = numbers + ["0"] * (count - len(numbers))  # those not given
    values = [real.constant(n) if kind == "real" else n for n in numbers]
    inside = ", ".join(f"{ir} {value}" for value in values)
    return f"@{name} = internal constant [{count} x {ir}] [{inside}], align 8"


def _check_work(functions: list[CFunction]) -> None:
    """Straight lines keep their slots in the part of the work vector that CasADi leaves them.

    That no caller has its own numbers there is seen from its text.
    """
    needs: dict[str, int] = {}
    for function in functions:
        if function.straight:
            behind = [at + needs.get(name, 0) for name, at in called_from(function.lines)]
            needs[function.name] = slot_count(function) + max(behind, default=0)
            continue
        text = "\n".join(function.lines)
        calls = [(name, int(at or 0)) for name, at in CALLED.findall(text)]
        places = [int(at) for at in PLACED.findall(text)]
        ends = [at + needs.get(name, 0) for name, at in calls]
        for (name, at), end in zip(calls, ends, strict=True):
            if any(at < place < end for place in places):
                raise NotTranslated(f"{name} has too little room in {function.name}")
        needs[function.name] = max([*ends, *places], default=0)
