"""Types of the C that CasADi writes."""

from __future__ import annotations

from dataclasses import dataclass

from pycparser import c_ast

from dalembert.symbolic.native.real import Real
from dalembert.symbolic.native.toolchain import NotTranslated


@dataclass(frozen=True)
class CType:
    """A type.

    Attributes
    ----------
    kind : ``"real"``, ``"int"`` (``casadi_int``), ``"small"`` (``int``), ``"pointer"``,
        ``"array"``, ``"struct"`` or ``"void"``
    to : what a pointer points to, an array consists of
    name : of a struct
    count : of an array
    """

    kind: str
    to: CType | None = None
    name: str = ""
    count: int = 0

    @property
    def target(self) -> CType:
        """What it points to or consists of."""
        if self.to is None:
            raise NotTranslated(f"a {self.kind} is used as a pointer")
        return self.to

    def ir(self, real: Real) -> str:
        """Its name in LLVM IR."""
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


def declared(node) -> CType:
    """The type that a declaration states."""
    if isinstance(node, c_ast.PtrDecl):
        return pointer(declared(node.type))
    if isinstance(node, c_ast.ArrayDecl):
        return CType("array", declared(node.type), count=int(node.dim.value))
    if isinstance(node, c_ast.TypeDecl | c_ast.Typename | c_ast.Decl):
        return declared(node.type)
    if isinstance(node, c_ast.Struct):
        return CType("struct", name=node.name)
    if isinstance(node, c_ast.IdentifierType):
        word = " ".join(node.names)
        if word in WORDS:
            return WORDS[word]
        if "int" in node.names or "long" in node.names:
            return INT if "long" in node.names else SMALL
    raise NotTranslated(f"a type that it does not know, {type(node).__name__}")
