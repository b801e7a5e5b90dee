"""LLVM IR of C values: types, memory, conversions and arithmetic.

Every variable is stored in memory; LLVM promotes variables to registers.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from pycparser import c_ast

from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.toolchain import NotTranslated


@dataclass(frozen=True)
class CType:
    """A C type.

    Attributes
    ----------
    kind : ``"real"``, ``"int"`` (``casadi_int``), ``"small"`` (``int``), ``"pointer"``,
        ``"array"``, ``"struct"`` or ``"void"``
    to : type of the target of a pointer, or of the elements of an array
    name : of a struct
    count : of an array
    """

    kind: str
    to: CType | None = None
    name: str = ""
    count: int = 0

    @property
    def target(self) -> CType:
        """Type of the target of a pointer, or of the elements of an array."""
        if self.to is None:
            raise NotTranslated(f"{self.kind} used as a pointer")
        return self.to

    def ir(self, real: Real) -> str:
        """Name of the type in LLVM IR."""
        if self.kind == "array":
            return f"[{self.count} x {self.target.ir(real)}]"
        if self.kind == "struct":
            return f"%struct.{self.name}"
        simple = {"real": real.ir, "int": "i64", "small": "i32", "pointer": "ptr", "void": "void"}
        return simple[self.kind]


REAL, INT, SMALL, VOID = CType("real"), CType("int"), CType("small"), CType("void")
WORDS = {"casadi_real": REAL, "double": REAL, "casadi_int": INT, "int": SMALL, "void": VOID}


def pointer(to: CType) -> CType:
    return CType("pointer", to)


def declared_type(node) -> CType:
    """The type of a declaration."""
    if isinstance(node, c_ast.PtrDecl):
        return pointer(declared_type(node.type))
    if isinstance(node, c_ast.ArrayDecl):
        return CType("array", declared_type(node.type), count=int(node.dim.value))
    if isinstance(node, c_ast.TypeDecl | c_ast.Typename | c_ast.Decl):
        return declared_type(node.type)
    if isinstance(node, c_ast.Struct):
        return CType("struct", name=node.name)
    if isinstance(node, c_ast.IdentifierType):
        word = " ".join(node.names)
        if word in WORDS:
            return WORDS[word]
        if "int" in node.names or "long" in node.names:
            return INT if "long" in node.names else SMALL
    raise NotTranslated(f"unknown type {type(node).__name__}")


Value = tuple[str, CType]
"""Name of a value, and its type."""
INT_OPERATIONS = {"+": "add", "-": "sub", "*": "mul", "/": "sdiv", "%": "srem"}
INT_OPERATIONS |= {"&": "and", "|": "or", "^": "xor", "<<": "shl", ">>": "ashr"}
REAL_OPERATIONS = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}


@dataclass
class Declarations:
    """Declarations of a module.

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
    """Writer of the instructions of a function."""

    def __init__(self, module: Declarations):
        self.module, self.real = module, module.real
        self.lines: list[str] = []
        self.allocations: list[str] = []
        self.names: dict[str, Value] = {}
        self.count = 0

    # instructions -------------------------------------------------------------------
    def new(self, right: str) -> str:
        """Append an instruction; the name of its value."""
        self.count += 1
        self.lines.append(f"  %v{self.count} = {right}")
        return f"%v{self.count}"

    def label(self, name: str) -> str:
        self.count += 1
        return f"{name}{self.count}"

    def begin(self, label: str) -> None:
        """Begin a block, which the previous one falls through to."""
        self.lines += [f"  br label %{label}", f"{label}:"]

    def jump(self, label: str) -> None:
        """Jump to a block; the code that follows is unreachable."""
        self.lines += [f"  br label %{label}", f"{self.label('dead')}:"]

    def branch(self, condition: str, yes: str, no: str) -> None:
        self.lines.append(f"  br i1 {condition}, label %{yes}, label %{no}")

    def allocate(self, kind: CType) -> str:
        """Allocate a variable at the beginning of the function; its address."""
        self.count += 1
        self.allocations.append(f"  %x{self.count} = alloca {kind.ir(self.real)}")
        return f"%x{self.count}"

    def load(self, address: str, kind: CType) -> Value:
        if kind.kind == "array":
            return address, pointer(kind.target)
        if kind.kind == "struct":
            return address, kind
        return self.new(f"load {kind.ir(self.real)}, ptr {address}{self._align(kind)}"), kind

    def store(self, value: Value, address: str, kind: CType) -> str:
        name = self.convert(value, kind)
        text = f"{kind.ir(self.real)} {name}, ptr {address}{self._align(kind)}"
        self.lines.append(f"  store {text}")
        return name

    def _align(self, kind: CType) -> str:
        return ", align 8" if kind.kind == "real" else ""

    def convert(self, value: Value, kind: CType) -> str:
        """A value as another type."""
        name, source = value
        if source == kind or (source.kind == kind.kind != "struct"):
            return name
        if kind.kind == "real":
            if name.lstrip("-").isdigit():
                return self.real.constant(name)
            return self._broadcast(self.new(f"sitofp {source.ir(self.real)} {name} to double"))
        if source.kind == "real" and kind.kind in ("int", "small"):
            if self.real.lanes > 1:
                raise NotTranslated("an integer from several lanes")
            return self.new(f"fptosi double {name} to {kind.ir(self.real)}")
        if kind.kind == "pointer" and name == "0":
            return "null"
        if {kind.kind, source.kind} == {"int", "small"}:
            if name.lstrip("-").isdigit():
                return name
            instruction = "sext" if kind.kind == "int" else "trunc"
            return self.new(f"{instruction} {source.ir(self.real)} {name} to {kind.ir(self.real)}")
        raise NotTranslated(f"conversion of {source.kind} to {kind.kind}")

    def _broadcast(self, number: str) -> str:
        """A double in all lanes."""
        if self.real.lanes == 1:
            return number
        ir, last = self.real.ir, "undef"
        for lane in range(self.real.lanes):
            last = self.new(f"insertelement {ir} {last}, double {number}, i32 {lane}")
        return last

    def _offset(self, base: str, kind: CType, by: Value) -> str:
        index = self.convert(by, INT)
        return self.new(f"getelementptr {kind.target.ir(self.real)}, ptr {base}, i64 {index}")

    def _promoted(self, left: Value, right: Value) -> tuple[str, str, CType]:
        """Two values in their common type."""
        kinds = {left[1].kind, right[1].kind}
        for kind in ("pointer", "real", "int", "small"):
            if kind in kinds:
                common = left[1] if left[1].kind == kind else right[1]
                return self.convert(left, common), self.convert(right, common), common
        raise NotTranslated(f"comparison of {' and '.join(kinds)}")

    def _combine(self, op: str, left: Value, right: Value) -> Value:
        """The value of a binary operation."""
        if left[1].kind == "pointer" and right[1].kind != "pointer":
            by = right if op == "+" else (self._negate(right), right[1])
            return self._offset(*left, by), left[1]
        if right[1].kind == "pointer" and left[1].kind != "pointer":
            return self._offset(*right, left), right[1]
        a, b, kind = self._promoted(left, right)
        if kind.kind == "pointer":
            raise NotTranslated("difference of pointers")
        operation = REAL_OPERATIONS[op] if kind.kind == "real" else INT_OPERATIONS[op]
        return self.new(f"{operation} {kind.ir(self.real)} {a}, {b}"), kind

    def _negate(self, value: Value) -> str:
        name, kind = value
        if kind.kind == "real":
            return self.new(f"fneg {kind.ir(self.real)} {name}")
        return self.new(f"sub {kind.ir(self.real)} 0, {name}")
