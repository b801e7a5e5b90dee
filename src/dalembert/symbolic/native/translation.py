"""C text of a function → LLVM IR.

The bulk, straight lines of scalars, goes line by line; what stands around it is parsed. Only what
the entry calls is translated.
"""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.symbolic.native.c_expressions import Surroundings
from dalembert.symbolic.native.c_functions import struct_lines, written_functions
from dalembert.symbolic.native.c_text import CText
from dalembert.symbolic.native.c_types import INT, REAL
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.straight_line import ZEROS, longest_input, straight_line


@dataclass(frozen=True)
class Module:
    """LLVM IR.

    Attributes
    ----------
    text : the module
    looped : names of the functions whose variables are still in memory
    """

    text: str
    looped: tuple[str, ...]


def translated(source: str, entry: str, exported: str, lanes: int = 1) -> Module:
    """The function ``entry`` of a C text, and all it needs, under another name.

    Raises
    ------
    UnsupportedError
        There is C in it that is not known, or lanes do not agree on a choice.
    """
    text, real = CText.read(source), Real(lanes)
    functions = text.needed(entry)
    around = Surroundings(real)
    wanted = {name for function in functions for name in function.uses} & set(text.arrays)
    for name in sorted(wanted):
        around.arrays[name] = INT if text.arrays[name][0] == "int" else REAL
    straight = [function for function in functions if function.straight]
    parsed = [function for function in functions if not function.straight]
    structs = [s for s in text.structs if any(s.split()[1] in f.uses for f in parsed)]
    lines = written_functions(functions, structs, around)
    for function in straight:
        lines += straight_line(function, real)
    longest = max(map(longest_input, straight), default=1)
    arrays = [f"@{ZEROS} = internal constant [{longest} x {real.ir}] zeroinitializer, align 8"]
    arrays += [_array(name, *text.arrays[name], real) for name in sorted(wanted)]
    body = "\n".join(lines).replace(f"define internal {_head(entry)}", f"define {_head(entry)}")
    body = body.replace(f"@{entry}(", f"@{exported}(")
    everything = [*struct_lines(around), *arrays, *real.declarations(body), body, ""]
    looped = tuple(exported if f.name == entry else f.name for f in parsed)
    return Module("\n".join(everything), looped)


def _head(entry: str) -> str:
    return f"i64 @{entry}("


def _array(name: str, kind: str, count: int, numbers: list[str], real: Real) -> str:
    ir = real.ir if kind == "real" else "i64"
    numbers = numbers + ["0"] * (count - len(numbers))  # those not given
    values = [real.constant(n) if kind == "real" else n for n in numbers]
    inside = ", ".join(f"{ir} {value}" for value in values)
    return f"@{name} = internal constant [{count} x {ir}] [{inside}], align 8"


