"""The C text that CasADi writes for a function, taken apart into functions and constants.

The text is regular: what begins in the first column is a preprocessor line, a constant array, a
struct or a function. Names stand for themselves, for the macros only put a prefix before them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from dalembert.symbolic.native.calls import LONE, called_from

ARRAY = re.compile(r"static const casadi_(int|real) (\w+)\[(\d+)\] =")
HEADER = re.compile(r"(?:static )?[\w *]*?(\w+)\((?!\()")
NAME = re.compile(r"\bcasadi_\w+")
STRAIGHT = re.compile(
    r"  (?:a\d+ ?=|if \(res\[\d+\]!=0\) |casadi_real a\d|return 0;"
    r"|(?:arg|res)\[\d+\]=(?:w\+\d+|0);$|w\[\d+\] = |if \(casadi_f\d+\(.* return 1;$)"
)
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
        """Names of CasADi's that are mentioned, of straight lines those that they call."""
        if self.straight:
            return {name for name, _ in called_from(self.lines)}
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

    def parted(self, entry: str) -> tuple[list[CFunction], CText]:
        """What an entry needs but for the calls of straight lines, and what these need, renamed."""
        own: dict[str, CFunction] = {}
        lone: dict[str, CFunction] = {}
        for function in reversed(self.needed(entry)):
            users = [f for f in own.values() if not f.straight]
            if function.name == entry or any(function.name in f.uses for f in users):
                own[function.name] = function
        for function in own.values():
            for name in sorted(function.uses) if function.straight else ():
                lone |= {one.name: one for one in self.needed(name)}
        names = {*lone, *(n for f in lone.values() for n in f.uses if n in self.arrays)}
        word = re.compile(rf"\b({'|'.join(sorted(names, key=len, reverse=True)) or '(?!)'})\b")

        def renamed(text: str) -> str:
            return word.sub(rf"\1{LONE}", text)

        made = CText(
            {
                renamed(f.name): CFunction(renamed(f.name), [*map(renamed, f.lines)], f.straight)
                for f in lone.values()
            },
            {renamed(name): self.arrays[name] for name in sorted(names & set(self.arrays))},
            self.structs,
        )
        return list(reversed(own.values())), made


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
