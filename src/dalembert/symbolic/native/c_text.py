"""Parser of C text written by CasADi: functions, constants and structs.

The text is regular: only preprocessor lines, constant arrays, structs and functions begin in the
first column. Names are taken as they are, as the macros only add a prefix.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from dalembert.symbolic.native.calls import SCALAR_SUFFIX, called_functions

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
    """A function by its lines, the first of which is its head.

    ``straight`` is true if its body is a list of scalar assignments, as for ``SX`` graphs.
    """

    name: str
    lines: list[str]
    straight: bool = False

    @property
    def uses(self) -> set[str]:
        """Names of CasADi used by the body; for straight-line code the called functions."""
        if self.straight:
            return {name for name, _ in called_functions(self.lines)}
        return set(NAME.findall("\n".join(self.lines))) - {self.name}


@dataclass
class CText:
    """Definitions of a text.

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
        """Parse a text."""
        parsed_text, lines = cls(), _relevant(text)
        for line in lines:
            if match := ARRAY.match(line):
                body = [line[match.end() :]]
                while ";" not in body[-1]:
                    body.append(next(lines))
                numbers = " ".join(body).replace(";", "")
                parsed_text.arrays[match[2]] = (match[1], int(match[3]), NUMBER.findall(numbers))
            elif line.startswith("struct"):
                parsed_text.structs.append("\n".join(_block(line, lines)))
            elif match := HEADER.match(line):
                function = _function(match[1], _block(line, lines))
                parsed_text.functions[function.name] = function
        return parsed_text

    def needed(self, *entries: str) -> list[CFunction]:
        """Entries and the functions that they call, in the order of definition."""
        done: dict[str, CFunction] = {}

        def visit(name: str) -> None:
            if name in self.functions and name not in done:
                for used in sorted(self.functions[name].uses):
                    visit(used)
                done[name] = self.functions[name]

        for entry in entries:
            visit(entry)
        return list(done.values())

    def split_for_lanes(self, entry: str) -> tuple[list[CFunction], CText]:
        """Functions to evaluate in lanes, and a text of scalar functions, renamed.

        Straight-line code in lanes calls scalar functions, one lane after the other.
        """
        own: dict[str, CFunction] = {}
        scalar: dict[str, CFunction] = {}
        for function in reversed(self.needed(entry)):
            users = [f for f in own.values() if not f.straight]
            if function.name == entry or any(function.name in f.uses for f in users):
                own[function.name] = function
        for function in own.values():
            for name in sorted(function.uses) if function.straight else ():
                scalar |= {used.name: used for used in self.needed(name)}
        names = {*scalar, *(n for f in scalar.values() for n in f.uses if n in self.arrays)}
        word = re.compile(rf"\b({'|'.join(sorted(names, key=len, reverse=True)) or '(?!)'})\b")

        def renamed(text: str) -> str:
            return word.sub(rf"\1{SCALAR_SUFFIX}", text)

        scalar_text = CText(
            {
                renamed(f.name): CFunction(renamed(f.name), [*map(renamed, f.lines)], f.straight)
                for f in scalar.values()
            },
            {renamed(name): self.arrays[name] for name in sorted(names & set(self.arrays))},
            self.structs,
        )
        return list(reversed(own.values())), scalar_text


def _relevant(text: str) -> Iterator[str]:
    """Lines without comments and preprocessor directives; of alternatives the newer C."""
    old = False
    for line in COMMENT.sub("", text).split("\n"):
        if line.startswith("#"):
            old = line == OLD_C or (old and not line.startswith("#else"))
        elif not old and line.strip() and not line.lstrip().startswith("#"):
            yield line


def _block(line: str, lines: Iterator[str]) -> list[str]:
    """Lines up to the brace that closes the first opened one."""
    block, depth, opened = [line], line.count("{") - line.count("}"), "{" in line
    while depth or not opened:
        line = next(lines)
        block.append(line)
        if not line.startswith(("  a", "  if (res")) or "{" in line:
            depth += line.count("{") - line.count("}")
            opened = opened or "{" in line
    return block


def _function(name: str, lines: list[str]) -> CFunction:
    inside = lines[1:-1]
    straight = len(lines) > 2 and all(STRAIGHT.match(line) for line in inside)
    return CFunction(name, lines, straight)
