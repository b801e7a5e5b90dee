"""The C text that CasADi writes for a function, taken apart into functions and constants.

The text is regular: what begins in the first column is a preprocessor line, a constant array, a
struct or a function. Names stand for themselves, for the macros only put a prefix before them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

ARRAY = re.compile(r"static const casadi_(int|real) (\w+)\[(\d+)\] =")
HEADER = re.compile(r"(?:static )?[\w *]*?(\w+)\((?!\()")
NAME = re.compile(r"\bcasadi_\w+")
STRAIGHT = re.compile(r"  (?:a\d+=|if \(res\[\d+\]!=0\) |casadi_real a\d|return 0;)")
NUMBER = re.compile(r"[^\s{},]+")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
OLD_C = "#if __STDC_VERSION__ < 199901L"


@dataclass
class CFunction:
    """A function: its lines, the first with its head.

    ``straight`` tells that its body is one list of assignments of scalars, as for ``SX`` graphs.
    """

    name: str
    lines: list[str]
    straight: bool = False

    @property
    def uses(self) -> set[str]:
        """Names of CasADi's that are mentioned."""
        if self.straight:
            return set()
        return set(NAME.findall("\n".join(self.lines))) - {self.name}


@dataclass
class CText:
    """Everything that a text defines.

    Attributes
    ----------
    functions : name → CFunction
    arrays : name → kind, ``"int"`` or ``"real"``, count, and the numbers as text
    structs : texts of their definitions
    """

    functions: dict[str, CFunction] = field(default_factory=dict)
    arrays: dict[str, tuple[str, int, list[str]]] = field(default_factory=dict)
    structs: list[str] = field(default_factory=list)

    @classmethod
    def read(cls, text: str) -> CText:
        """Take a text apart."""
        made, lines = cls(), _relevant(text)
        for line in lines:
            if found := ARRAY.match(line):
                body = [line[found.end() :]]
                while ";" not in body[-1]:
                    body.append(next(lines))
                numbers = " ".join(body).replace(";", "")
                made.arrays[found[2]] = (found[1], int(found[3]), NUMBER.findall(numbers))
            elif line.startswith("struct"):
                made.structs.append("\n".join(_block(line, lines)))
            elif found := HEADER.match(line):
                function = _function(found[1], _block(line, lines))
                made.functions[function.name] = function
        return made

    def needed(self, entry: str) -> list[CFunction]:
        """The functions that an entry calls, and itself, those called first."""
        done: dict[str, CFunction] = {}

        def visit(name: str) -> None:
            if name in self.functions and name not in done:
                for used in sorted(self.functions[name].uses):
                    visit(used)
                done[name] = self.functions[name]

        visit(entry)
        return list(done.values())


def _relevant(text: str) -> Iterator[str]:
    """Lines without comments and preprocessor; of two ways to write a thing the newer C."""
    old = False
    for line in COMMENT.sub("", text).split("\n"):
        if line.startswith("#"):
            old = line == OLD_C or (old and not line.startswith("#else"))
        elif not old and line.strip() and not line.lstrip().startswith("#"):
            yield line


def _block(line: str, lines: Iterator[str]) -> list[str]:
    """Lines up to the brace that closes the first one opened."""
    taken, depth, opened = [line], line.count("{") - line.count("}"), "{" in line
    while depth or not opened:
        line = next(lines)
        taken.append(line)
        if not line.startswith(("  a", "  if (res")) or "{" in line:
            depth += line.count("{") - line.count("}")
            opened = opened or "{" in line
    return taken


def _function(name: str, lines: list[str]) -> CFunction:
    inside = lines[1:-1]
    straight = len(lines) > 2 and all(STRAIGHT.match(line) for line in inside)
    return CFunction(name, lines, straight)
