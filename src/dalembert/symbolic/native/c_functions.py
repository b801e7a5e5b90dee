"""Translation of C functions that are not straight-line code to LLVM IR."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pycparser import c_ast, c_parser

from dalembert.symbolic.native.c_expressions import Expressions
from dalembert.symbolic.native.c_instructions import (
    INT,
    REAL,
    SMALL,
    VOID,
    CType,
    Declarations,
    declared_type,
    pointer,
)
from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.toolchain import NotTranslated

TYPES = "typedef double casadi_real; typedef long long int casadi_int;\n"
EVALUATION = (SMALL, [pointer(pointer(REAL)), pointer(pointer(REAL)), pointer(INT), pointer(REAL)])
"""Result and argument types of a graph function, without the index of its memory."""


def function_lines(
    functions: Sequence[CFunction], structs: Sequence[str], module: Declarations
) -> list[str]:
    """IR of functions; their types are added to the declarations of the module."""
    for function in functions:
        if function.straight:
            module.functions[function.name] = (EVALUATION[0], [*EVALUATION[1], SMALL])
    bodies = ["\n".join(f.lines) for f in functions if not f.straight]
    definitions = [f for f in _parse("\n".join([*structs, *bodies])) if not _declare(f, module)]
    return [line for node in definitions for line in _Function(node, module).text()]


def struct_lines(module: Declarations) -> list[str]:
    """IR of the structs."""
    lines = []
    for name, fields in module.structs.items():
        types = ", ".join(kind.ir(module.real) for _, kind in fields)
        lines.append(f"%struct.{name} = type {{ {types} }}")
    return lines


def _parse(text: str) -> list[Any]:
    text = TYPES + text.replace("CASADI_CAST(casadi_real,", "((casadi_real)")
    try:
        return c_parser.CParser().parse(text.replace("CASADI_SYMBOL_EXPORT ", "")).ext
    except c_parser.ParseError as error:
        raise NotTranslated(f"C that cannot be parsed ({error})") from None


def _declare(node: Any, module: Declarations) -> bool:
    """Add the types of a definition to the declarations; true unless it is a function."""
    if isinstance(node, c_ast.Typedef):
        return True
    if isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.Struct):
        fields = [(part.name, declared_type(part.type)) for part in node.type.decls]
        module.structs[node.type.name] = fields
        return True
    if not isinstance(node, c_ast.FuncDef):
        raise NotTranslated(f"{type(node).__name__} outside of functions")
    result = declared_type(node.decl.type.type)
    module.functions[node.decl.name] = (result, _argument_types(node))
    return False


def _argument_types(node: Any) -> list[CType]:
    """Types of the arguments; an array is passed as a pointer to its first element."""
    arguments = node.decl.type.args
    kinds = [declared_type(argument) for argument in (arguments.params if arguments else ())]
    return [pointer(k.target) if k.kind == "array" else k for k in kinds if k is not VOID]


class _Function(Expressions):
    """Writer of the definition of a function."""

    def __init__(self, node: Any, module: Declarations):
        super().__init__(module)
        self.node = node
        self.result, self.kinds = module.functions[node.decl.name]
        self.breaks: list[str] = []
        self.continues: list[str] = []

    def text(self) -> list[str]:
        """IR of the definition."""
        heads = []
        for number, kind in enumerate(self.kinds):
            name = self.node.decl.type.args.params[number].name
            address = self.allocate(kind)
            self.names[name] = (address, kind)
            self.store((f"%g{number}", kind), address, kind)
            heads.append(f"{kind.ir(self.real)} %g{number}")
        self.statement(self.node.body)
        head = f"define internal {self.result.ir(self.real)} @{self.node.decl.name}"
        last = "  ret void" if self.result is VOID else "  unreachable"
        return [
            f"{head}({', '.join(heads)}) nounwind {{",
            *self.allocations,
            *self.lines,
            last,
            "}",
        ]

    def statement(self, node: Any) -> None:
        """Write a statement."""
        if type(node) in self._statements:
            self._statements[type(node)](self, node)
        else:
            self.value(node)

    def _compound(self, node: Any) -> None:
        outer = dict(self.names)
        for item in node.block_items or ():
            self.statement(item)
        self.names = outer

    def _declaration(self, node: Any) -> None:
        kind = declared_type(node.type)
        address = self.allocate(kind)
        self.names[node.name] = (address, kind)
        if isinstance(node.init, c_ast.InitList):
            for number, expression in enumerate(node.init.exprs):
                element = f"getelementptr {kind.ir(self.real)}, ptr {address}, i64 0, i64 {number}"
                self.store(self.value(expression), self.new(element), kind.target)
        elif node.init is not None:
            self.store(self.value(node.init), address, kind)

    def _declarations(self, node: Any) -> None:
        for declaration in node.decls:
            self._declaration(declaration)

    def _if(self, node: Any) -> None:
        yes, no, end = self.label("yes"), self.label("no"), self.label("end")
        self.branch(self.condition(node.cond), yes, no if node.iffalse else end)
        self.lines.append(f"{yes}:")
        self.statement(node.iftrue)
        if node.iffalse:
            self.lines += [f"  br label %{end}", f"{no}:"]
            self.statement(node.iffalse)
        self.begin(end)

    def _loop(self, node: Any) -> None:
        """``for`` and ``while``, and ``do … while``, which tests last."""
        test, body = self.label("test"), self.label("body")
        following, end = self.label("next"), self.label("end")
        outer = dict(self.names)
        if isinstance(node, c_ast.For) and node.init:
            self.statement(node.init)
        if isinstance(node, c_ast.DoWhile):
            self.lines.append(f"  br label %{body}")
            self.lines.append(f"{test}:")
        else:
            self.begin(test)
        if node.cond is None:
            self.lines.append(f"  br label %{body}")
        else:
            self.branch(self.condition(node.cond), body, end)
        self.lines.append(f"{body}:")
        self.breaks.append(end)
        self.continues.append(following)
        self.statement(node.stmt)
        self.begin(following)
        if isinstance(node, c_ast.For) and node.next:
            self.value(node.next)
        self.lines += [f"  br label %{test}", f"{end}:"]
        self.breaks.pop()
        self.continues.pop()
        self.names = outer

    def _switch(self, node: Any) -> None:
        value = self.convert(self.value(node.cond), INT)
        end, cases, default = self.label("end"), list[tuple[str, str]](), ""
        parts = []
        for item in node.stmt.block_items or ():
            label = self.label("case")
            if isinstance(item, c_ast.Case):
                cases.append((self.convert(self.value(item.expr), INT), label))
            elif isinstance(item, c_ast.Default):
                default = label
            else:
                raise NotTranslated("a switch with statements before its cases")
            parts.append((label, item.stmts or ()))
        choices = " ".join(f"i64 {number}, label %{label}" for number, label in cases)
        self.lines.append(f"  switch i64 {value}, label %{default or end} [ {choices} ]")
        self.lines.append(f"{self.label('dead')}:")
        self.breaks.append(end)
        for label, statements in parts:
            self.begin(label)
            for statement in statements:
                self.statement(statement)
        self.begin(end)
        self.breaks.pop()

    def _return(self, node: Any) -> None:
        if node.expr is None:
            self.lines.append("  ret void")
        else:
            value = self.convert(self.value(node.expr), self.result)
            self.lines.append(f"  ret {self.result.ir(self.real)} {value}")
        self.lines.append(f"{self.label('dead')}:")

    def _break(self, node: Any) -> None:
        self.jump(self.breaks[-1])

    def _continue(self, node: Any) -> None:
        self.jump(self.continues[-1])

    def _empty(self, node: Any) -> None:
        """An empty statement writes no code."""

    _statements: dict[type, Callable[[Any, Any], None]] = {
        c_ast.Compound: _compound,
        c_ast.Decl: _declaration,
        c_ast.DeclList: _declarations,
        c_ast.If: _if,
        c_ast.For: _loop,
        c_ast.While: _loop,
        c_ast.DoWhile: _loop,
        c_ast.Switch: _switch,
        c_ast.Return: _return,
        c_ast.Break: _break,
        c_ast.Continue: _continue,
        c_ast.EmptyStatement: _empty,
    }
