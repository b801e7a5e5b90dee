"""Instructions of LLVM IR for values of the C that CasADi writes: memory, conversions, arithmetic.

Every variable has a place in memory; LLVM turns these into registers.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from dalembert.symbolic.native.c_types import INT, CType, pointer
from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.toolchain import NotTranslated

Value = tuple[str, CType]
"""What an instruction gave, and its type."""
SIMPLE = {"+": "add", "-": "sub", "*": "mul", "/": "sdiv", "%": "srem"}
SIMPLE |= {"&": "and", "|": "or", "^": "xor", "<<": "shl", ">>": "ashr"}
REALS = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}


@dataclass
class Surroundings:
    """What functions see of their file.

    Attributes
    ----------
    real : Real
    functions : name → type of the result, types of the arguments
    arrays : name → type
    structs : name → names and types of the fields
    """

    real: Real
    functions: dict[str, tuple[CType, list[CType]]] = field(default_factory=dict)
    arrays: dict[str, CType] = field(default_factory=dict)
    structs: dict[str, list[tuple[str, CType]]] = field(default_factory=dict)


class Instructions:
    """Writes the instructions of one function."""

    def __init__(self, around: Surroundings):
        self.around, self.real = around, around.real
        self.lines: list[str] = []
        self.places: list[str] = []
        self.names: dict[str, Value] = {}
        self.count = 0

    # instructions -------------------------------------------------------------------
    def new(self, right: str) -> str:
        """The value of an instruction."""
        self.count += 1
        self.lines.append(f"  %v{self.count} = {right}")
        return f"%v{self.count}"

    def label(self, name: str) -> str:
        self.count += 1
        return f"{name}{self.count}"

    def begin(self, label: str) -> None:
        """Begin a block; the one before runs on into it."""
        self.lines += [f"  br label %{label}", f"{label}:"]

    def jump(self, label: str) -> None:
        """Go elsewhere; what follows in the text is reached from nowhere else."""
        self.lines += [f"  br label %{label}", f"{self.label('dead')}:"]

    def branch(self, condition: str, yes: str, no: str) -> None:
        self.lines.append(f"  br i1 {condition}, label %{yes}, label %{no}")

    def place(self, kind: CType) -> str:
        """Room for a variable, made when the function begins."""
        self.count += 1
        self.places.append(f"  %x{self.count} = alloca {kind.ir(self.real)}")
        return f"%x{self.count}"

    def load(self, place: str, kind: CType) -> Value:
        if kind.kind == "array":
            return place, pointer(kind.target)
        if kind.kind == "struct":
            return place, kind
        return self.new(f"load {kind.ir(self.real)}, ptr {place}{self._align(kind)}"), kind

    def store(self, value: Value, place: str, kind: CType) -> str:
        made = self.converted(value, kind)
        text = f"{kind.ir(self.real)} {made}, ptr {place}{self._align(kind)}"
        self.lines.append(f"  store {text}")
        return made

    def _align(self, kind: CType) -> str:
        return ", align 8" if kind.kind == "real" else ""

    def converted(self, value: Value, kind: CType) -> str:
        """A value as another type."""
        name, given = value
        if given == kind or (given.kind == kind.kind != "struct"):
            return name
        if kind.kind == "real":
            if name.lstrip("-").isdigit():
                return self.real.constant(name)
            one = self.new(f"sitofp {given.ir(self.real)} {name} to double")
            return self._in_all_lanes(one)
        if given.kind == "real" and kind.kind in ("int", "small"):
            if self.real.lanes > 1:
                raise NotTranslated("lanes do not tell one whole number")
            return self.new(f"fptosi double {name} to {kind.ir(self.real)}")
        if kind.kind == "pointer" and name == "0":
            return "null"
        if {kind.kind, given.kind} == {"int", "small"}:
            if name.lstrip("-").isdigit():
                return name
            how = "sext" if kind.kind == "int" else "trunc"
            return self.new(f"{how} {given.ir(self.real)} {name} to {kind.ir(self.real)}")
        raise NotTranslated(f"a {given.kind} is no {kind.kind}")

    def _in_all_lanes(self, one: str) -> str:
        if self.real.lanes == 1:
            return one
        ir, last = self.real.ir, "undef"
        for lane in range(self.real.lanes):
            last = self.new(f"insertelement {ir} {last}, double {one}, i32 {lane}")
        return last

    def _moved(self, base: str, kind: CType, by: Value) -> str:
        index = self.converted(by, INT)
        return self.new(f"getelementptr {kind.target.ir(self.real)}, ptr {base}, i64 {index}")

    def _alike(self, left: Value, right: Value) -> tuple[str, str, CType]:
        """Two values in the type that holds both."""
        kinds = {left[1].kind, right[1].kind}
        for kind in ("pointer", "real", "int", "small"):
            if kind in kinds:
                common = left[1] if left[1].kind == kind else right[1]
                return self.converted(left, common), self.converted(right, common), common
        raise NotTranslated(f"{' and '.join(kinds)} are not compared")

    def _combined(self, op: str, left: Value, right: Value) -> Value:
        if left[1].kind == "pointer" and right[1].kind != "pointer":
            by = right if op == "+" else (self._negative(right), right[1])
            return self._moved(*left, by), left[1]
        if right[1].kind == "pointer" and left[1].kind != "pointer":
            return self._moved(*right, left), right[1]
        a, b, kind = self._alike(left, right)
        if kind.kind == "pointer":
            raise NotTranslated("pointers are not subtracted")
        how = REALS[op] if kind.kind == "real" else SIMPLE[op]
        return self.new(f"{how} {kind.ir(self.real)} {a}, {b}"), kind

    def _negative(self, value: Value) -> str:
        name, kind = value
        if kind.kind == "real":
            return self.new(f"fneg {kind.ir(self.real)} {name}")
        return self.new(f"sub {kind.ir(self.real)} 0, {name}")
