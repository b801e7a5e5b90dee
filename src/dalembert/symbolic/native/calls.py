"""Calls among straight lines: the C that CasADi writes where a graph calls a function.

The called function gets numbers, one of each lane after the other: its course may depend on them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.toolchain import NotTranslated

SET = re.compile(r"  (arg|res)\[(\d+)\]=(?:w\+(\d+)|0);$")
PUT = re.compile(r"  w\[(\d+)\] = (a\d+|-?\d+\.\d*(?:e[+-]?\d+)?);$")
CALL = re.compile(r"  if \((\w+)\(arg\+(\d+), res\+(\d+), iw, w\+(\d+), 0\)\) return 1;$")
TAKE = re.compile(r"  (a\d+) = w\[(\d+)\];$")
BEGUN = ("  arg[", "  res[", "  w[")
"""How the lines of a call begin."""
LONE = "_lone"
"""Ends the names of functions of numbers in a module of lanes."""


@dataclass
class Called:
    """A call and what goes in and out.

    Attributes
    ----------
    name : of the function
    arg, res, w : where its arguments, results and work begin
    given : place in the work vector → operand
    taken : place in the work vector → slot
    places : ``("arg", 3)`` → place in the work vector of what is pointed to; None for nothing
    """

    name: str = ""
    arg: int = 0
    res: int = 0
    w: int = 0
    given: dict[int, str] = field(default_factory=dict)
    taken: dict[int, str] = field(default_factory=dict)
    places: dict[tuple[str, int], int | None] = field(default_factory=dict)

    @property
    def way(self) -> str:
        """What calls that differ in slots only have in common."""
        return f"{self.name} {self.arg} {self.res} {self.w} {self.places} {[*self.taken]}"


def read_call(line: str, lines: Iterator[str]) -> tuple[Called, str]:
    """The call that begins with a line, and the line after it.

    Raises
    ------
    NotTranslated
        It is written in another way.
    """
    made = Called()
    while found := SET.match(line) or PUT.match(line):
        if found.re is SET:
            made.places[found[1], int(found[2])] = int(found[3]) if found[3] else None
        else:
            made.given[int(found[1])] = found[2]
        line = next(lines)
    call = CALL.match(line)
    if call is None:
        raise NotTranslated(f"{line.strip()!r} is no call that it knows")
    made.name, made.arg, made.res, made.w = call[1], int(call[2]), int(call[3]), int(call[4])
    line = next(lines)
    while found := TAKE.match(line):
        made.taken[int(found[2])] = found[1]
        line = next(lines)
    return made, line


def called_from(lines: list[str]) -> list[tuple[str, int]]:
    """Names of the functions that straight lines call, and where their work begins."""
    found = (CALL.match(line) for line in lines if line.startswith("  if (casadi_"))
    return [(call[1], int(call[4])) for call in found if call]


def written_call(
    call: Called,
    real: Real,
    room: int,
    values: dict[int, str],
    new: Callable[[str], str],
    write: Callable[[str], None],
) -> dict[int, str]:
    """IR of a call that ends at the label ``failed`` where the function fails.

    Parameters
    ----------
    room : slots of the work vector that are the caller's own
    values : place in the work vector → value of what is given
    new : writes what makes a value, and names it
    write : writes a line

    Returns
    -------
    dict
        Place in the work vector → value of what is taken.
    """
    own = new(f"getelementptr {real.ir}, ptr %w, i64 {room}")
    work = new(f"getelementptr double, ptr {own}, i64 {call.w}")
    for (which, index), place in call.places.items():
        into = new(f"getelementptr ptr, ptr %{which}, i64 {index}")
        what = "null" if place is None else new(f"getelementptr double, ptr {own}, i64 {place}")
        write(f"  store ptr {what}, ptr {into}")
    arg, res = (
        new(f"getelementptr ptr, ptr %{which}, i64 {at}")
        for which, at in (("arg", call.arg), ("res", call.res))
    )
    taken = dict.fromkeys(call.taken, "undef")
    for lane in range(real.lanes):
        for place, value in values.items():
            one = value if real.lanes == 1 else new(f"extractelement {real.ir} {value}, i32 {lane}")
            into = new(f"getelementptr double, ptr {own}, i64 {place}")
            write(f"  store double {one}, ptr {into}, align 8")
        given = f"ptr {arg}, ptr {res}, ptr %iw, ptr {work}, i32 0"
        ended = new(f"call i32 @{call.name}{LONE if real.lanes > 1 else ''}({given})")
        bad, after = new(f"icmp ne i32 {ended}, 0"), f"on{ended[2:]}"
        write(f"  br i1 {bad}, label %failed, label %{after}")
        write(f"{after}:")
        for place in call.taken:
            one = new(f"getelementptr double, ptr {own}, i64 {place}")
            one = new(f"load double, ptr {one}, align 8")
            if real.lanes > 1:
                one = new(f"insertelement {real.ir} {taken[place]}, double {one}, i32 {lane}")
            taken[place] = one
    return taken
